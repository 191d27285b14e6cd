"""Several scans of one sitting, in a real browser: see browser.py."""
import base64
import os

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import *


def give(d, *names):
    """These files, at once, to the place of a scan that is on the page."""
    place = wait(d, lambda _: d.find_element(By.CSS_SELECTOR, "dialog input[type=file], main .slot input"))
    d.execute_script("arguments[0].value = ''", place)  # else they are added
    place.send_keys("\n".join(os.path.join(FOLDER, name) for name in names))


def rows(d):
    """Of each scan in the list: its name, and what is said of it."""
    return d.execute_script("""return [...document.querySelectorAll(".burst li")].filter((e) => e.checkVisibility())
        .map((e) => [e.querySelector(".name").textContent, e.querySelector("p").textContent])""")


def listed(title, d, *wanted):
    """The list has these scans, in any order, and of each this is said."""
    def as_wanted(_):
        got = dict(rows(d))
        return len(got) == len(wanted) and all(text in got.get(name, "") for name, text in wanted)
    check(title, wait(d, as_wanted, 40), rows(d))


def pictures(d, name):
    """As people see it: wide and narrow, dark and light; and that nothing is wider than a phone."""
    for width, dark in ((1280, True), (1280, False), (360, True), (360, False)):
        look(d, width, dark)
        still(d)
        with open(os.path.join(FOLDER, "burst-%s-%d-%s.png" % (name, width, "dark" if dark else "light")), "wb") as f:
            f.write(base64.b64decode(d.execute_cdp_cmd("Page.captureScreenshot", {"format": "png", "captureBeyondViewport": not d.find_elements(
                By.TAG_NAME, "dialog")})["data"]))
        contrast("%s at %d px" % (name, width), d)
        is_("%s is no wider than %d px" % (name, width), d.execute_script("""return [document.documentElement, ...document.querySelectorAll("dialog, dialog .body")]
            .filter((e) => e.scrollWidth > e.clientWidth).map((e) => e.tagName)"""), [])
    look(d, 1280, True)


SITTING = ["a6.ply", "a7.ply", "a8.ply"]  # no scan is taken twice


def stored(subject):
    return len(api("GET", "/v1/subjects/" + subject)[1].get("templates", []))


def test_enroll(d):
    unlock(d, ALL, "people")
    one(d, "main button", "Enroll").click()
    one(d, "dialog input[type=text]").send_keys("anna")
    give(d, "a0.ply", "none.ply", "a1.ply", "other.ply", "plane.xyz")
    listed("each is looked at by itself", d, ("a0.ply", "Good"), ("none.ply", "Not usable"), ("a1.ply", "Good"), ("other.ply", "Good"), ("plane.xyz", "Not usable"))
    some("how many are good", d, "dialog .verdict h2", "3 of 5 scans good")
    check("each has its quality", len(d.find_elements(By.CSS_SELECTOR, ".burst .track")) == 3)
    pictures(d, "checked")
    is_("nothing is stored", api("GET", "/v1/subjects/anna")[0], 404)
    one(d, "dialog button.primary", "Enroll anna").click()
    some("another person's scan", d, "dialog .error", "Scan other.ply shows another person than")
    listed("is told where it is", d, ("a0.ply", "Good"), ("none.ply", "Left out: "), ("a1.ply", "Good"), ("other.ply", "Left out: "), ("plane.xyz", "Left out: "))
    pictures(d, "refused")
    is_("and nothing was stored", api("GET", "/v1/subjects/anna")[0], 404)
    tab_to(d, "Take other.ply out")
    press(d, Keys.ENTER)
    listed("it is taken out by keys", d, ("a0.ply", "Good"), ("none.ply", "Not usable"), ("a1.ply", "Good"), ("plane.xyz", "Not usable"))
    is_("the focus is not lost", focused(d), "input Scan")
    wait(d, lambda _: one(d, "dialog button.primary", "Enroll anna").is_enabled())
    one(d, "dialog button.primary", "Enroll anna").click()
    some("then it is enrolled", d, "dialog .verdict h2", "Enrolled")
    listed("and what became of each is told", d, ("a0.ply", "Used"), ("none.ply", "Left out: this is no list"), ("a1.ply", "Used"), ("plane.xyz", "Left out: the surface"))
    some("of how many", d, "dialog .gains h2", "2 of 4 scans used")
    cells = [e.text for e in d.find_elements(By.CSS_SELECTOR, "dialog .gains tbody tr")[1].find_elements(By.CSS_SELECTOR, "th, td")]
    check("together they have less noise", cells[0] == "Noise" and float(cells[2].split()[0]) < 0.9 * float(cells[1].split()[0]), cells)
    is_("what was stored can no more be taken out", d.find_elements(By.CSS_SELECTOR, ".burst button[aria-label^=Take]"), [])
    is_("one template", stored("anna"), 1)
    is_("of that quality", round(api("GET", "/v1/subjects/anna")[1]["templates"][0]["quality"]["noise_mm"], 2), float(cells[2].split()[0]))
    pictures(d, "enrolled")
    press(d, Keys.ESCAPE)


def test_adds(d):
    """Two that lack a side each, and a copy: each adds what those before it have not."""
    unlock(d, ALL, "people")
    one(d, "main button", "Enroll").click()
    one(d, "dialog input[type=text]").send_keys("berta")
    give(d, "left.xyz", "right.xyz", "copy.xyz")
    listed("each is looked at", d, ("left.xyz", "Good"), ("right.xyz", "Good"), ("copy.xyz", "Good"))
    one(d, "dialog button.primary", "Enroll berta").click()
    some("enrolled", d, "dialog .gains h2", "3 of 3 scans used")
    said = rows(d)
    sides = {"left.xyz": "left half of eyes, forehead, cheeks, mouth, chin", "right.xyz": "right half of eyes, forehead, cheeks, mouth, chin"}
    sides["copy.xyz"] = sides["right.xyz"]
    check("first the one that the others were laid on", "Used: has " in said[0][1] and "The others were laid on it." in said[0][1], said)
    second, third = [(name, text.split("Used:")[1].strip()) for name, text in said[1:]]
    copies = {"right.xyz", "copy.xyz"}
    other, none = (second, third) if {said[0][0], third[0]} == copies or {second[0], third[0]} == copies else (third, second)
    check("then what the other side adds", other[1].startswith("adds ") and sides[other[0]] in other[1].split(".")[0] and "no other" not in other[1], said)
    check("a copy adds nothing", none[1].startswith("adds no other part of the face. Noise "), said)
    noise = [float(n) for n in none[1].replace(" mm", "").replace(",", "").split() if n.replace(".", "", 1).isdigit()]
    check("and hardly lowers the noise", noise[1] > 0.93 * noise[0], none)
    bars = d.execute_script("return [...document.querySelectorAll('.burst li > .track')].map((t) => [...t.children].map((i) => Math.round(100 * i.offsetWidth / t.offsetWidth)))")
    check("the bars go on where those before end", bars[0][0] == 0 and abs(bars[1][0] - bars[0][1]) < 2 and abs(sum(bars[-1]) - 100) < 2, bars)
    pictures(d, "adds")
    press(d, Keys.ESCAPE)


def test_try(d):
    """Two at once are compared; of more none is taken, and this is said."""
    unlock(d, ALL, "try")
    give(d, "a0.ply", "a1.ply")
    some("two at once are compared", d, "main .verdict h2", "Same face")
    is_("each in its place", [e.text for e in d.find_elements(By.CSS_SELECTOR, "main .slot strong")], ["a0.ply", "a1.ply"])
    give(d, "a0.ply", "a1.ply", "other.ply")
    some("three are not", d, "main .error", "3 files are too many: two are compared.")
    is_("and what was there stays", [e.text for e in d.find_elements(By.CSS_SELECTOR, "main .slot strong")], ["a0.ply", "a1.ply"])
    give(d, "a0.ply", "other.ply")
    some("two others", d, "main .verdict h2", "Different faces")
    check("nothing is said of too many", gone(d, "main .error"))


def test_each(d):
    """A template of each; on a person's page they are dropped anywhere."""
    unlock(d, ALL, "people?subject=anna")
    some("the person", d, "h1", "anna")
    one(d, "tbody tr")
    files = {name: base64.b64encode(open(os.path.join(FOLDER, name), "rb").read()).decode() for name in ("a2.ply", "a3.ply", "none.ply")}
    d.execute_script("""const data = new DataTransfer();
        for (const [name, text] of Object.entries(arguments[0])) data.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
        document.querySelector("main table").dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));""", files)
    listed("dropped on the page", d, ("a2.ply", "Good"), ("a3.ply", "Good"), ("none.ply", "Not usable"))
    one(d, "dialog select").send_keys("A template of each")
    one(d, "dialog button.primary", "Enroll").click()
    listed("what became of each", d, ("a2.ply", "Enrolled"), ("a3.ply", "Enrolled"), ("none.ply", "Not enrolled: "))
    some("is two templates", d, "dialog .verdict p", "a template of each of 2 scans")
    is_("and they are there", stored("anna"), 3)
    press(d, Keys.ESCAPE)


def test_verify(d):
    unlock(d, ALL, "people?subject=anna")
    one(d, "main button", "Verify a scan").click()
    give(d, *["a4.ply"] + ["a%d.ply" % (k % 4) for k in range(4)] + ["none.ply", "plane.xyz", "other.ply", "a5.ply"])
    some("nine are taken", d, "dialog .slot strong", "9 scans of one person")
    give(d, "a4.ply", "none.ply", "a5.ply")
    listed("others in their place", d, ("a4.ply", "Good"), ("none.ply", "Not usable"), ("a5.ply", "Good"))
    one(d, "dialog button.primary", "Verify").click()
    some("one decision", d, "dialog .verdict h2", "Same face")
    listed("of what was used", d, ("a4.ply", "Used"), ("none.ply", "Left out: "), ("a5.ply", "Used"))
    some("and what it gives", d, "dialog .gains h2", "2 of 3 scans used")
    pictures(d, "verified")
    press(d, Keys.ESCAPE)


def test_identify(d):
    unlock(d, ALL, "identify")
    give(d, *SITTING, "other.ply", "none.ply", "plane.xyz")
    some("a stranger among them", d, "main .verdict", "other.ply shows another person")
    listed("is told where it is", d, *[(name, "Good") for name in SITTING], ("other.ply", "Left out: "), ("none.ply", "Left out: "), ("plane.xyz", "Left out: "))
    for name in ("other.ply", "plane.xyz"):
        click(d, '[aria-label="Take %s out"]' % name)
    some("without it a name", d, "main .verdict h2", "anna")
    listed("by these", d, *[(name, "Used") for name in SITTING], ("none.ply", "Left out: "))
    some("how many", d, "main .gains h2", "3 of 4 scans used")
    pictures(d, "identified")
    for k in range(11):
        with open(os.path.join(FOLDER, "more%d.ply" % k), "w", encoding="ascii") as f:
            f.write("no scan")
    give(d, *["more%d.ply" % k for k in range(11)])
    some("more than the daemon takes", d, "main .error", "11 files are too many: send up to 10")
    is_("those before are kept", len(rows(d)), 4)
    some("and so is what they said", d, "main .verdict h2", "anna")
    give(d, "a9.ply")
    check("one scan has no list", wait(d, lambda _: not rows(d)), rows(d))
    some("and a name", d, "main .verdict h2", "anna")
    check("nothing is said of too many", gone(d, "main .error"))
    quiet("several scans", d)


run(browser(), test_enroll, test_adds, test_try, test_each, test_verify, test_identify)
