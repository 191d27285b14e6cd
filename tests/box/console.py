"""The console in a real browser, against a running daemon: console.py URL FOLDER TOKEN (browser.py)."""
import json
import os
import time

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import (ALL, FOLDER, ROOT, api, browser, check, click, color_at, contrast, focused, go, is_, look, one,
                     pixels, press, quiet, run, saved, send, some, still, tab_to, token, unlock, wait, within)

SCOPES = ["verify", "enroll", "identify", "read", "delete", "manage", "tokens", "audit", "events", "score", "detail"]


# ---- unlocking and locking

def test_lock(d):
    paints = []
    for _ in range(5):  # a browser that has just begun is slow
        d.get("about:blank")
        d.get(ROOT + "console")
        paints.append(wait(d, lambda _: d.execute_script("return performance.getEntriesByType('paint')[0]?.startTime"), 5))
    best = min(p or 1e9 for p in paints)
    within("first paint", best, 1000)
    one(d, "#token").send_keys("sfd_wrong" + Keys.ENTER)
    some("a wrong token is refused", d, ".error", "mistyped, has expired")
    contrast("locked", d)
    one(d, "#token").send_keys(ALL + Keys.ENTER)
    some("the right one is not", d, "nav a", "Try")
    is_("it is nowhere in the page", ALL in d.page_source, False)
    is_("nor stored", d.execute_script(
        "return localStorage.length + sessionStorage.length + document.cookie.length"), 0)
    one(d, "aside button", "Lock").click()
    check("locked by the button", one(d, "#token") is not None)
    unlock(d, ALL, "people")
    one(d, "main button", "Enroll").click()
    some("a dialog", d, "dialog h2", "Enroll somebody")
    d.refresh()
    check("locked by loading it again", one(d, "#token") is not None)
    is_("with nothing left of it", d.find_elements(By.CSS_SELECTOR, "aside, dialog, main header"), [])
    # a token that is revoked in the middle of work
    gone = token("gone", ["verify", "read"])
    unlock(d, gone["secret"], "people")
    api("DELETE", "/v1/tokens/" + gone["id"])
    go(d, "people?state=active")
    some("locked once the token is revoked", d, ".error", "not valid any more")
    # time passes
    unlock(d, ALL)
    some("unlocked again", d, "nav a", "Try")
    d.execute_cdp_cmd("Emulation.setVirtualTimePolicy", {"policy": "advance", "budget": 14 * 60 * 1000})
    time.sleep(1)
    check("not locked after 14 minutes", one(d, "nav a", "Try", 1) is not None)
    d.execute_cdp_cmd("Emulation.setVirtualTimePolicy", {"policy": "advance", "budget": 2 * 60 * 1000})
    some("locked after 16 minutes without use", d, ".error", "15 minutes")
    quiet("unlocking", d)


# ---- Live

def test_live(d):
    unlock(d, ALL, "live")
    some("nobody yet", d, "h2", "Nobody yet")
    is_("an enrolment", send("/v1/subjects/alice/templates?label=front", "a.ply"), 201)
    some("appears by itself", d, ".live h2", "Enrolled")
    is_("a verification", send("/v1/subjects/alice/verify", "a2.ply"), 200)
    some("appears, too", d, ".live h2", "Same face")
    some("whose it was", d, ".live .big", "alice")
    for _ in range(3):
        send("/v1/subjects/alice/verify", "other.ply")
    is_("a lock-out", send("/v1/subjects/alice/verify", "a2.ply"), 429)
    some("is said in a sentence", d, ".live p", "Locked out")
    some("with those before it", d, "tbody tr", "Different faces")
    contrast("Live", d)
    one(d, ".lockouts button", "End").click()
    one(d, "dialog button", "End it").click()
    some("a click ends it", d, "tbody tr", "Lock-out ended")
    is_("for the door as well", send("/v1/subjects/alice/verify", "a2.ply"), 200)
    some("as the page shows", d, ".live h2", "Same face")
    one(d, "tbody a", "alice").click()
    some("from there to the person", d, "h1", "alice")
    quiet("Live", d)


# ---- People

def subject(name):
    return api("GET", "/v1/subjects/" + name)[1]


def test_enroll(d):
    """By keyboard alone, but for the file, which a browser's own window asks for."""
    unlock(d, ALL)
    tab_to(d, "People")
    press(d, Keys.ENTER)
    some("the people", d, "tbody th", "alice")
    tab_to(d, "Enroll")
    press(d, Keys.ENTER)
    some("a dialog", d, "dialog h2", "Enroll somebody")
    is_("has the focus", d.execute_script("return document.activeElement.closest('dialog') !== null"), True)
    press(d, Keys.ESCAPE)
    check("Escape closes it", wait(d, lambda _: not d.find_elements(By.TAG_NAME, "dialog")))
    is_("and gives the focus back", focused(d), "button Enroll")
    press(d, Keys.ENTER)
    press(d, *"bob")
    is_("nothing is checked yet", one(d, "dialog [type=submit]").is_enabled(), False)
    d.find_element(By.CSS_SELECTOR, "dialog input[type=file]").send_keys(os.path.join(FOLDER, "other.ply"))
    some("checked first", d, "dialog .verdict h2", "Good to enroll")
    is_("nothing is stored by that", subject("bob").get("code"), "not_found")
    tab_to(d, "Label, consent")
    press(d, Keys.ENTER)
    press(d, Keys.TAB, *"desk", Keys.TAB, *"C-17")
    tab_to(d, "Enroll bob")
    press(d, Keys.ENTER)
    some("then enrolled", d, "dialog .verdict h2", "Enrolled")
    press(d, Keys.ENTER)  # Done
    some("in the list", d, "tbody th", "bob")
    bob = subject("bob")
    is_("with consent and label", [bob["consent"], bob["templates"][0]["label"]], ["C-17", "desk"])
    # found
    for k in range(60):
        api("POST", "/v1/subjects", {"subject": "visitor-%02d" % k})
    search = one(d, "[type=search]")
    search.send_keys("SITOR-4")
    some("found by a part of the id", d, "tbody th", "visitor-49")
    check("alone", wait(d, lambda _: len(d.find_elements(By.CSS_SELECTOR, "tbody tr")) == 10))
    check("as the address says", "q=SITOR-4" in d.current_url, d.current_url)
    search.send_keys(Keys.BACKSPACE * 7)
    some("more than a page", d, "[role=status]", "there are more")
    one(d, "button", "Show more").click()
    check("are shown on demand", wait(d, lambda _: len(d.find_elements(By.CSS_SELECTOR, "tbody tr")) == 62))
    api("PATCH", "/v1/subjects/visitor-07", {"disabled": True})
    one(d, ".choices a", "Disabled").click()
    some("by state", d, "tbody tr", "visitor-07")
    check("one alone", wait(d, lambda _: len(d.find_elements(By.CSS_SELECTOR, "tbody tr")) == 1))
    # the wrong person's scan
    go(d, "people?subject=bob")
    one(d, "header button", "Enroll a scan").click()
    d.find_element(By.CSS_SELECTOR, "dialog input[type=file]").send_keys(os.path.join(FOLDER, "a.ply"))
    some("a scan of another", d, "dialog .verdict h2", "Good to enroll")
    one(d, "dialog [type=submit]").click()
    some("does not fit", d, "dialog .error", "does not")
    check("who has manage may insist", one(d, "dialog button", "Enroll anyway"))
    press(d, Keys.ESCAPE)
    quiet("enrolling", d)


def confirm(d, button, verb=None):
    """Press a button that asks first, and confirm it, both by keys."""
    d.execute_script("arguments[0].focus()", one(d, "main button", button))
    press(d, Keys.ENTER)
    check("%s asks first" % button, one(d, "dialog .buttons"))
    is_("%s: the focus is on it" % button, focused(d), "button " + (verb or button))
    press(d, Keys.ENTER)
    wait(d, lambda _: not d.find_elements(By.TAG_NAME, "dialog"))


def test_person(d):
    unlock(d, ALL, "people")
    tab_to(d, "alice")
    press(d, Keys.ENTER)
    some("a person", d, ".verdict h2", "Active")
    some("what happened lately", d, "tbody tr", "Lock-out ended")
    confirm(d, "Disable")
    some("disabled", d, ".verdict h2", "Disabled")
    check("the focus is on the page, since the button is gone", wait(d, lambda _: focused(d).startswith("main ")), focused(d))
    is_("for doors, too", subject("alice")["disabled"], True)
    confirm(d, "Enable")
    some("enabled", d, ".verdict h2", "Active")
    confirm(d, "Hold", "Put on hold")
    some("on hold", d, ".states", "On hold")
    some("nobody can erase her", d, "section", "cannot be erased")
    confirm(d, "Release the hold", "Release")
    # consent
    d.execute_script("arguments[0].focus()", one(d, "main button", "Change"))
    press(d, Keys.ENTER, *"<b>C-9</b>", Keys.TAB, *"door", Keys.TAB, *"12312031", Keys.ENTER)
    some("consent, as a text", d, "dd", "<b>C-9</b>")
    alice = subject("alice")
    is_("and its end", [alice["consent"], alice["purpose"], alice["expires_at"][:10]], ["<b>C-9</b>", "door", "2031-12-31"])
    one(d, "main button", "Change").click()
    one(d, "dialog label.box input").click()
    one(d, "dialog [type=submit]").click()
    some("she has opted out of searches", d, "dd", "opted out")
    is_("for the daemon, too", subject("alice")["identify"], False)
    click(d, "[aria-label='Change the groups']")
    press(d, *"Staff", Keys.ENTER)
    some("what is no group is refused", d, "dialog .error", "a group is 1 to 64 characters")
    press(d, *([Keys.BACKSPACE] * 5), *"staff, door-3", Keys.ENTER)
    some("her groups", d, "a.chip", "door-3")
    is_("as the daemon has them", subject("alice")["groups"], ["door-3", "staff"])
    one(d, "a.chip", "staff").click()
    some("the people of a group", d, "main strong", "staff")
    check("her alone", wait(d, lambda _: [e.text for e in d.find_elements(By.CSS_SELECTOR, "tbody th")] == ["alice"]))
    go(d, "people?subject=alice")
    # verifying
    for _ in range(2):
        send("/v1/subjects/alice/verify", "other.ply")
    d.refresh()
    unlock(d, ALL, "people?subject=alice")
    some("the attempts", d, "section", "2 verifications in a row failed")
    one(d, "header button", "Verify a scan").click()
    some("the count is said before", d, "dialog", "2 attempts failed already")
    d.find_element(By.CSS_SELECTOR, "dialog input[type=file]").send_keys(os.path.join(FOLDER, "other.ply"))
    some("looked at first", d, "dialog .verdict h2", "Good to verify")
    one(d, "dialog [type=submit]").click()
    some("then verified", d, "dialog .verdict h2", "Different faces")
    some("with the layers", d, "dialog .tabs button", "A | B")
    press(d, Keys.ENTER)
    some("it counts, and locks out", d, ".advice", "Locked out until")
    one(d, "section button", "End the lock-out").click()
    some("which ends", d, "section", "No verification has failed lately")
    # in 3D
    one(d, "td button", "Look").click()
    some("the enrolled face", d, ".looked", "recorded")
    still(d)
    drawn = pixels(d, one(d, "canvas"))
    check("is drawn", len({color_at(drawn, 0.3 + 0.02 * i, 0.5) for i in range(20)}) > 6)
    # templates: a hostile label is a text
    is_("a second one", send("/v1/subjects/alice/templates?label=%3Cimg%20src%3Dx%20onerror%3Dalert(1)%3E", "a2.ply"), 201)
    go(d, "people?subject=bob")
    go(d, "people?subject=alice")
    some("a hostile label is a text", d, "tbody th", "<img src=x")
    is_("and no element", d.find_elements(By.CSS_SELECTOR, "main img"), [])
    d.find_elements(By.CSS_SELECTOR, "td button[title]")[1].click()
    some("deleting asks", d, "dialog h2", "Delete this template?")
    press(d, Keys.ENTER)
    check("one template is left", wait(d, lambda _: len(subject("alice")["templates"]) == 1))
    # erased
    wait(d, lambda _: not d.find_elements(By.TAG_NAME, "dialog"))
    d.execute_script("arguments[0].focus()", one(d, "button.danger", "Erase"))
    press(d, Keys.ENTER, *"alic")
    is_("another id does not", one(d, "dialog [type=submit]").is_enabled(), False)
    press(d, "e", Keys.ENTER)
    some("erased", d, "dialog .verdict h2", "Erased")
    uid = d.execute_script("return document.activeElement.textContent")
    is_("the receipt is offered", uid, "Save the receipt")
    press(d, Keys.ENTER)
    name = wait(d, lambda _: next((n for n in os.listdir(FOLDER) if n.startswith("erased-")), None))
    receipt = json.loads(saved(name))
    is_("it names her", receipt["subject"], "alice")
    os.rename(os.path.join(FOLDER, name), os.path.join(FOLDER, "receipt.json"))
    press(d, Keys.ESCAPE)
    some("back among the people", d, "h1", "People")
    is_("she is gone", subject("alice").get("code"), "not_found")
    go(d, "people?subject=%3Cimg%20src%3Dx%20onerror%3Dalert(1)%3E")
    some("a hostile address is a text", d, "h1", "<img src=x")
    quiet("a person", d)


# ---- Audit

def test_audit(d):
    unlock(d, ALL, "audit")
    some("who did what", d, "tbody tr", "Person erased")
    some("an erased person has no name", d, "tbody tr", "erased since")
    one(d, "select option", "Token made").click()
    some("a kind", d, "tbody tr", "Token made")
    check("alone", wait(d, lambda _: all("Token made" in e.text for e in d.find_elements(By.CSS_SELECTOR, "tbody tr:not(.day)"))))
    check("as the address says", "kind=create_token" in d.current_url, d.current_url)
    unlock(d, ALL, d.current_url.split("#")[1] + "&subject=bob")
    some("the address filters", d, "[role=status]", "No entries")
    one(d, "a", "Show all").click()
    some("all of it again", d, "tbody tr", "Person erased")
    one(d, "button", "Show older ones").click()
    check("and older ones", wait(d, lambda _: len(d.find_elements(By.CSS_SELECTOR, "tbody tr")) > 60))
    d.execute_script("arguments[0].focus()", one(d, "button", "Verify the chain"))
    press(d, Keys.ENTER)
    some("the chain is whole", d, ".verdict h2", "The log is whole")
    contrast("Audit", d)
    go(d, "audit?subject=bob")
    some("of one person", d, "tbody tr", "Scan enrolled")
    one(d, "button", "Export").click()
    one(d, "dialog button", "Save CSV").click()
    lines = saved("audit.csv").splitlines()
    check("with the filters", len(lines) > 2 and all("bob" in line for line in lines[1:]), lines[:3])
    one(d, "button", "Export").click()
    one(d, "dialog button", "Save signed log").click()
    check("a line an entry", json.loads(saved("audit.jsonl").splitlines()[0]))
    go(d, "audit?kind=%3Cimg%20src%3Dx%3E")
    some("a hostile filter is a text", d, "select option", "<img src=x>")
    quiet("Audit", d)


# ---- Health

def test_tokens(d):
    unlock(d, ALL, "health?tab=tokens")
    some("its own token", d, "tbody tr", "(this one)")
    own = next(e for e in d.find_elements(By.CSS_SELECTOR, "tbody tr") if "(this one)" in e.text)
    check("cannot be revoked by itself", "Revoke" not in own.text)
    tab_to(d, "Make a token")
    press(d, Keys.ENTER, *"<i>gate</i>")
    is_("what it may is asked", one(d, "dialog [type=submit]").is_enabled(), False)
    d.execute_script("document.querySelector('dialog [value=verify]').focus()")
    press(d, " ")
    tab_to(d, "Make it")
    press(d, Keys.ENTER)
    secret = some("the secret", d, "code.shown").text
    is_("is a token's", api("GET", "/v1/token", token=secret)[1]["scopes"], ["verify"])
    press(d, Keys.ENTER)
    some("a hostile name is a text", d, "tbody th", "<i>gate</i>")
    is_("the secret is not shown again", secret in d.page_source, False)
    click(d, "[aria-label='Rotate <i>gate</i>']")
    one(d, "dialog option", "at once").click()
    one(d, "dialog [type=submit]").click()
    other = some("another secret", d, "code.shown").text
    is_("the old one is not valid", [api("GET", "/v1/token", token=t)[0] for t in (secret, other)], [401, 200])
    press(d, Keys.ENTER)
    click(d, "[aria-label='Revoke <i>gate</i>']")
    some("revoking asks", d, "dialog h2", "Revoke <i>gate</i>?")
    press(d, Keys.ENTER)
    check("revoked", wait(d, lambda _: api("GET", "/v1/token", token=other)[0] == 401))
    some("as the list shows", d, "tbody tr", "Revoked")
    # one that is bound to a group
    one(d, "button", "Make a token").click()
    press(d, *"bound")
    d.execute_script("for (const s of ['read', 'tokens', 'manage']) document.querySelector(`dialog [value=${s}]`).click()")
    d.find_element(By.CSS_SELECTOR, "dialog [placeholder='door-3, staff']").send_keys("staff")
    one(d, "dialog [type=submit]").click()
    secret = some("its secret", d, "code.shown").text
    is_("bound", api("GET", "/v1/token", token=secret)[1]["groups"], ["staff"])
    press(d, Keys.ENTER)
    some("the list has its group", d, "tbody a.chip", "staff")
    unlock(d, secret, "people?subject=bob")
    some("another person is nobody", d, ".verdict h2", "Nobody")
    some("it says what it is for", d, ".who", "only staff")
    unlock(d, token("maker", ["tokens", "read"])["secret"], "health?tab=tokens")
    one(d, "button", "Make a token").click()
    is_("never more than the maker's own", [e.get_attribute("value") for e in
        d.find_elements(By.CSS_SELECTOR, "dialog [name=scope]")], ["read", "tokens"])
    press(d, Keys.ESCAPE)
    quiet("tokens", d)


def test_health(d):
    unlock(d, ALL, "health")
    stats = api("GET", "/v1/stats")[1]
    some("how many people", d, ".tile", str(stats["counts"]["subjects"]))
    some("why some were refused", d, ".bars li", "Locked out")
    some("what doctor finds", d, ".findings li", stats["findings"][0]["what"])
    one(d, ".choices a", "Calibration").click()
    some("the threshold", d, "output", "At 8.0")
    d.find_element(By.CSS_SELECTOR, "[type=range]").send_keys(Keys.ARROW_RIGHT * 4)
    some("what if it were another", d, "output", "At 10.0")
    check("the scores of this week", one(d, ".chart rect.ok"))
    quiet("Health", d)


# ---- Identify

def test_identify(d):
    """bob is the only one who has a template."""
    def give(*names):
        files = wait(d, lambda d: d.find_elements(By.CSS_SELECTOR, ".slot input"))[0]  # it is never displayed
        d.execute_script("arguments[0].value = ''", files)  # else they are added
        files.send_keys("\n".join(os.path.join(FOLDER, n) for n in names))

    unlock(d, ALL, "identify")
    some("what it is for", d, "h2", "Who is it?")
    give("other2.ply")
    some("a name", d, ".verdict.ok h2", "bob")
    some("of how many, and why", d, ".verdict p", "among 1 person 8.0 is enough")
    is_("no list unless it is asked for", d.find_elements(By.TAG_NAME, "table"), [])
    contrast("Identify", d)
    most = one(d, "[type=number]")
    most.clear()
    most.send_keys("3" + Keys.TAB)
    some("candidates", d, "tbody th", "bob")
    some("are to be reviewed", d, "h2", "To be reviewed by a person")
    for width in (1280, 360):
        look(d, width, True)
        for dark in (True, False):
            look(d, width, dark)
            time.sleep(0.3)
            title = "identified-%d-%s" % (width, "dark" if dark else "light")
            contrast(title, d)
            is_(title + ": nothing is wider than the screen", d.execute_script("return document.documentElement.scrollWidth"), width)
            d.save_screenshot(os.path.join(FOLDER, title + ".png"))
    look(d, 1280, True)
    most.clear()
    give("a2.ply")
    some("a stranger has no name", d, ".verdict.no h2", "Nobody who was searched")
    some("by how much", d, ".verdict p", "would be needed")
    d.save_screenshot(os.path.join(FOLDER, "identify-stranger.png"))
    give("other2.ply", "other3.ply")
    some("several scans are one probe", d, ".verdict.ok h2", "bob")
    some("of one person", d, ".slot strong", "2 scans of one person")
    group = one(d, "[list=groups]")
    group.send_keys("door-3" + Keys.TAB)
    some("a group", d, ".verdict p", "There is nobody to search.")
    group.clear()
    group.send_keys("Door 3" + Keys.TAB)
    is_("a group that cannot be is said at once", d.execute_script("return arguments[0].validity.patternMismatch", group), True)
    group.clear()
    give("other.ply")
    some("a scan that was used before", d, ".verdict h2", "Not usable")
    go(d, "audit?kind=candidate")
    some("who was listed is in the log", d, "tbody tr", "Listed as a candidate")
    some("by what score", d, "tbody .why", " among 1 person")
    go(d, "audit?kind=identify")
    some("what a search found, in words", d, "tbody .why", "Same face\n3")
    some("or not", d, "tbody .why", "Nobody found\namong 0 people in door-3")
    go(d, "live")
    some("and it is live", d, "tbody tr", "Nobody who was searched is alike enough")
    some("in a word, too", d, "tbody tr", "Nobody found")
    unlock(d, token("hall", ["identify"])["secret"], "identify")
    give("a2.ply")
    some("a token with identify alone", d, ".verdict.no h2", "Nobody who was searched")
    some("gets no numbers", d, ".verdict p", "scope score")
    is_("nor candidates", d.find_elements(By.CSS_SELECTOR, "main .row [type=number], .gauge, table"), [])
    give("other2.ply")
    some("but a name", d, ".verdict.ok h2", "bob")
    quiet("Identify", d)


# ---- who sees what

def test_scopes(d):
    pages = {"enroll": "Try People", "verify": "Try", "identify": "Try Identify", "read": "People", "delete": "",
             "manage": "", "tokens": "Health", "audit": "Audit Health", "events": "Live", "score": "", "detail": ""}
    for scope in SCOPES:
        unlock(d, token("only " + scope, [scope])["secret"], "")
        is_("with %s alone" % scope, " ".join(a.text for a in d.find_elements(By.CSS_SELECTOR, "aside nav a")), pages[scope])
    some("a token without a page", d, "main", "no scope that a page needs")
    enroll = token("desk alone", ["enroll"])
    unlock(d, enroll["secret"], "people")
    some("who may enroll and not read", d, "main", "may not see who is enrolled")
    api("DELETE", "/v1/subjects/bob/attempts")
    buttons = {"read": [], "enroll": ["Enroll a scan"], "verify": ["Verify a scan"], "delete": ["Delete", "Erase"],
               "manage": ["Disable", "Hold", "Change", "Change"], "detail": ["Look"]}
    for scope, wanted in buttons.items():
        unlock(d, token("read and " + scope, sorted({"read", scope}))["secret"], "people?subject=bob")
        one(d, ".verdict h2", "Active")
        names = [e.get_attribute("aria-label") or e.text for e in d.find_elements(By.CSS_SELECTOR, "main button")]
        is_("buttons with read and " + scope, sorted(n.split(" ")[0] for n in names), sorted(w.split(" ")[0] for w in wanted))
    quiet("scopes", d)


# ---- every page, wide and narrow, dark and light

def test_looks(d):
    send("/v1/subjects/bob/verify", "other2.ply")
    api("PATCH", "/v1/subjects/bob", {"groups": ["door-3", "staff"]})
    unlock(d, ALL)
    pages = [("identify", ".welcome"), ("people", "tbody tr"), ("people?subject=bob", ".verdict"), ("audit", "tbody tr"), ("health", ".tile"),
             ("health?tab=tokens", "tbody tr"), ("health?tab=calibration", "output"), ("live", ".live")]
    for width in (1280, 360):
        look(d, width, True)
        for page, there in pages:
            go(d, page)
            one(d, there)
            if page == "health?tab=calibration":
                one(d, ".chart .curve")
            still(d)
            for dark in (True, False):
                look(d, width, dark)
                time.sleep(0.3)  # the canvas, and colours that fade
                title = "%s-%d-%s" % (page.replace("?", "-").replace("=", "-"), width, "dark" if dark else "light")
                contrast(title, d)
                is_(title + ": nothing is wider than the screen", d.execute_script("return document.documentElement.scrollWidth"), width)
                with open(os.path.join(FOLDER, title + ".png"), "wb") as f:
                    f.write(d.get_screenshot_as_png())
    for dark in (True, False):
        look(d, 360, dark)
        go(d, "people?subject=bob")
        one(d, "header button", "Enroll a scan").click()
        d.find_element(By.CSS_SELECTOR, "dialog input[type=file]").send_keys(os.path.join(FOLDER, "other.ply"))
        one(d, "dialog .verdict h2", "Good to enroll")
        still(d)
        contrast("a dialog", d)
        d.save_screenshot(os.path.join(FOLDER, "enroll-360-%s.png" % ("dark" if dark else "light")))
        press(d, Keys.ESCAPE)
    look(d, 1280, True)
    quiet("every page", d)


run(browser(), test_live, test_enroll, test_person, test_audit, test_tokens, test_health, test_identify, test_scopes,
    test_looks)
run(browser(webgl=False), test_lock)
