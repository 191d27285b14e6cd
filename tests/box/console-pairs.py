"""The templates of a person with each other, in a real browser: see browser.py."""
import os

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import *

BUTTON = "Compare them with each other"


def enrol(subject, *names):
    for name in names:
        is_("%s of %s" % (name, subject), send("/v1/subjects/%s/templates?force=true&label=%s" % (subject, name), name + ".ply"), 201)


def compared(d, subject, with_token=ALL):
    """The sentence about the person's templates."""
    unlock(d, with_token, "people?subject=" + subject)
    d.execute_script("arguments[0].scrollIntoView({ block: 'center' })", one(d, "button", BUTTON))  # not below the bar of a phone
    one(d, "button", BUTTON).click()
    return one(d, ".pairs .said").text


def today():
    return api("GET", "/v1/subjects/alice")[1]["templates"][0]["created"][:10]


def test_sentences(d):
    enrol("alice", "a0")
    unlock(d, ALL, "people?subject=alice")
    one(d, "tbody th", "a0")
    is_("one template is compared with none", one(d, "button", BUTTON, 0.5), None)
    enrol("alice", "a1", "a2")
    is_("all fit", compared(d, "alice"), "All fit each other.")
    enrol("alice", "b0")
    said = compared(d, "alice")
    check("the one that does not fit is named", said.startswith("The template b0 of %s fits none of the others." % today()), said)
    cells = [e.text for e in d.find_elements(By.CSS_SELECTOR, ".matrix tbody tr:last-child > *")]
    check("its row, for who cannot see it", cells[0].startswith("4 b0") and "does not fit" in cells[0]
          and all(c.startswith("Different faces") for c in cells[1:4]) and cells[4] == "", cells)
    is_("each column has a name", d.find_element(By.CSS_SELECTOR, ".matrix thead th").get_attribute("aria-label"), "a0 of " + today())
    score = api("GET", "/v1/subjects/alice/templates/compare")[1]["pairs"][0]["score"]
    check("a match has its score", d.find_element(By.CSS_SELECTOR, ".matrix tbody tr td:nth-child(3)").text.endswith("%.0f" % score))
    enrol("two", "a0", "b0")
    check("of two neither is named", compared(d, "two").startswith("The two templates do not fit each other."))
    said = compared(d, "alice", token("reads", ["read"])["secret"])
    check("a token that reads is told the same", said.startswith("The template b0"), said)
    is_("without a score", [e.text for e in d.find_elements(By.CSS_SELECTOR, ".matrix td.no")], ["Different faces"] * 6)
    some("and why", d, ".pairs", "to a token with the scope score")
    unlock(d, token("enrols", ["enroll", "read", "audit"])["secret"], "audit?subject=alice")
    some("the audit log has it", d, "tbody tr", "Templates compared")
    quiet("sentences", d)


def test_keys(d):
    unlock(d, ALL, "people?subject=alice")
    one(d, "button", BUTTON)
    tab_to(d, BUTTON)
    press(d, Keys.ENTER)
    one(d, ".matrix")
    check("the focus is on the matrix, which can be scrolled", wait(d, lambda _: focused(d).endswith("Each template with each other")), focused(d))
    is_("what is said is read aloud", d.find_element(By.CSS_SELECTOR, ".pairs .said").get_attribute("role"), "status")
    # another consent leaves it, another template does not
    one(d, "button[aria-label='Change the consent']").click()
    one(d, "dialog input").send_keys("C-1")
    one(d, "dialog button", "Save").click()
    check("the dialog is closed", gone(d, "dialog"))
    check("it is still there", one(d, ".matrix") is not None)
    d.find_element(By.CSS_SELECTOR, "[aria-label='Delete template b0']").click()
    one(d, "dialog button", "Delete").click()
    check("it is gone with the template", gone(d, ".matrix"))
    one(d, "button", BUTTON).click()
    some("and asked for again", d, ".pairs .said", "All fit each other.")


def test_twenty(d):
    enrol("many", *("m%d" % i for i in range(19)), "b0")
    for width in (1280, 360):
        for dark in (True, False):
            look(d, width, dark)
            said = compared(d, "many")
            title = "pairs-%d-%s" % (width, "dark" if dark else "light")
            check(title + ": the foreign one", said.startswith("The template b0"), said)
            is_(title + ": a cell for each", len(d.find_elements(By.CSS_SELECTOR, ".matrix td:not(:empty)")), 380)
            is_(title + ": nothing is wider than the screen", d.execute_script("return document.documentElement.scrollWidth"), width)
            contrast(title, d)
            d.execute_script("document.querySelector('.pairs').scrollIntoView()")
            d.save_screenshot(os.path.join(FOLDER, title + ".png"))
            if width == 360:
                press(d, Keys.ARROW_RIGHT)
                check(title + ": scrolled by keys", wait(d, lambda _: d.execute_script("return document.querySelector('.matrix').scrollLeft") > 0))
    look(d, 703, False)  # A4 less its margins
    d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    is_("on paper nothing is cut off", d.execute_script(
        "const m = document.querySelector('.matrix table'); return m.getBoundingClientRect().right <= document.querySelector('.pairs').getBoundingClientRect().right"), True)
    d.execute_script("document.querySelector('.pairs').scrollIntoView()")
    d.save_screenshot(os.path.join(FOLDER, "pairs-print.png"))
    d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    look(d, 1280, True)
    quiet("twenty", d)


run(browser(), test_sentences, test_keys, test_twenty)
