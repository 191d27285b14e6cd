"""The console's pages where a person is stopped, in a real browser: see browser.py.  The last arguments
are the daemon's process, which is stopped and goes on, and the command for its database."""
import datetime
import os
import signal
import sqlite3
import subprocess
import sys
import time

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import *

DAEMON, COMMAND = int(sys.argv[4]), sys.argv[5].split()


def file_at(name):
    return os.path.join(FOLDER, "in", name)


def give(d, path):
    """A file, to the place of a scan that is on the page."""
    place = wait(d, lambda _: d.find_element(By.CSS_SELECTOR, "dialog input[type=file], main .slot input"))
    d.execute_script("arguments[0].value = ''", place)  # else it is added
    place.send_keys(path)


def texts(d, selector):
    return [e.text for e in d.find_elements(By.CSS_SELECTOR, selector)]


def test_landing(d):
    """A token opens with the page of its work, and is told what another one takes."""
    for scopes, title in ((["events", "manage"], "Live"), (["read", "enroll", "manage", "delete"], "People"), (["audit", "read"], "People"),
                          (["audit"], "Audit"), (["tokens"], "Health"), (["identify"], "Identify"), (["verify", "score"], "Compare two scans")):
        unlock(d, token("lands", scopes)["secret"], "")
        some("with %s" % scopes, d, "main h1", title)
    unlock(d, token("auditor", ["audit"])["secret"], "people")
    some("a page that it may not see", d, "main", "This takes a token with the scope read or enroll")
    d.get("about:blank")
    d.get(ROOT)
    check("the root is the console", wait(d, lambda _: d.current_url == ROOT + "console"), d.current_url)
    one(d, "#token").send_keys("0" * 64 + Keys.ENTER)
    some("a token that is none", d, ".error", "mistyped, has expired, or was revoked")


def test_reload(d):
    """F5 loads what is shown, and the token is not asked for again."""
    api("POST", "/v1/subjects", {"subject": "before"})
    unlock(d, ALL, "people?q=fore")
    some("the list", d, "tbody th", "before")
    api("POST", "/v1/subjects", {"subject": "fore-2"})
    for keys in (Keys.F5, Keys.CONTROL + "r"):
        d.execute_script("document.querySelector('tbody').dataset.old = '1'")
        d.find_element(By.TAG_NAME, "body").send_keys(keys)
        check("is loaded again", wait(d, lambda _: d.execute_script("const b = document.querySelector('tbody'); return b && !b.dataset.old")))
        some("with what is new, and no token is asked for", d, "tbody", "fore-2")
    is_("whoever leaves is asked", d.execute_script("""const e = new Event("beforeunload", { cancelable: true });
        dispatchEvent(e); return e.defaultPrevented;"""), True)
    one(d, "aside button", "Lock").click()
    one(d, "#token")
    is_("but not if there is no token", d.execute_script("""const e = new Event("beforeunload", { cancelable: true });
        dispatchEvent(e); return e.defaultPrevented;"""), False)


def test_formats(d):
    """A browser's guess at a type is not sent; a depth image's camera is asked for."""
    unlock(d, ALL, "people")
    one(d, "main button", "Enroll").click()
    for name in ("plain.obj", "binary.pcd"):
        give(d, file_at(name))
        some("%s is read" % name, d, "dialog .verdict h2", "Good to enroll")
    press(d, Keys.ESCAPE)
    for page in ("identify", "people"):
        check("the dialog is closed", wait(d, lambda _: not d.find_elements(By.TAG_NAME, "dialog")))
        go(d, page)
        one(d, "main h1", page.capitalize())
        if page == "people":
            one(d, "main button", "Enroll").click()
        give(d, file_at("depth.png"))
        camera = some("a depth image's camera is asked for", d, ".camera")
        check("and has the focus", wait(d, lambda _: d.execute_script("return document.activeElement.closest('.camera') !== null")), focused(d))
        for field, value in zip(camera.find_elements(By.TAG_NAME, "input"), ("600", "600", "119.5", "159.5", "10000")):
            field.send_keys(value)
        press(d, Keys.TAB)
        some("then it is read", d, ".verdict h2", "Good to enroll" if page == "people" else "Nobody")
        give(d, file_at("plain.obj"))
        check("another file has none", wait(d, lambda _: not d.find_element(By.CSS_SELECTOR, ".camera").is_displayed()))
        some("and is read", d, ".verdict h2", "Good to enroll" if page == "people" else "Nobody")
    press(d, Keys.ESCAPE)


def test_words(d):
    """A reason of the daemon's reads as words, without its name of the scan."""
    with open(os.path.join(FOLDER, "few.ply"), "w", encoding="ascii") as f:
        f.write("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n")
    unlock(d, ALL)
    slots = wait(d, lambda _: d.find_elements(By.CSS_SELECTOR, "main .slot input[type=file]"))
    slots[0].send_keys(os.path.join(FOLDER, "few.ply"))
    some("of one scan", d, ".verdict p", "3 points, fewer than")
    check("without a name before it", not d.find_element(By.CSS_SELECTOR, ".verdict p").text.startswith("points"))
    slots = wait(d, lambda _: d.find_elements(By.CSS_SELECTOR, "main .slot input[type=file]"))
    slots[1].send_keys(os.path.join(FOLDER, "a.ply"))
    some("of two it says which", d, ".verdict p", "Scan A: 3 points, fewer than")


def test_id(d):
    unlock(d, ALL, "people")
    one(d, "main button", "Enroll").click()
    field = one(d, "dialog input[type=text]")
    field.send_keys("müller")
    some("which character an id cannot have", d, "dialog .error", "no “ü”")
    field.clear()
    field.send_keys("anna b")
    some("also a space", d, "dialog .error", "no space")
    field.clear()
    field.send_keys("anna-b")
    check("nothing is said of a good one", wait(d, lambda _: "An id has" not in " ".join(texts(d, "dialog .error"))))
    press(d, Keys.ESCAPE)


def test_states(d):
    """What is said of a person is true."""
    send("/v1/subjects/locked/templates", "a.ply")
    for _ in range(3):
        send("/v1/subjects/locked/verify", "other.ply")
    is_("a lock-out", send("/v1/subjects/locked/verify", "a2.ply"), 429)
    unlock(d, ALL, "people?subject=locked")
    some("who is locked out is not active", d, ".verdict h2", "Locked out")
    some("until when", d, ".verdict p", "UTC")
    d.execute_script("arguments[0].focus()", one(d, "section button", "End the lock-out"))
    press(d, Keys.ENTER)
    some("then active", d, ".verdict h2", "Active")
    check("the focus is on the page, and not lost", wait(d, lambda _: focused(d).startswith("main")), focused(d))
    some("what was refused, in words", d, "tbody tr", "Locked out: too many verifications failed.")
    go(d, "people?subject=before")
    some("who has no scan is not active", d, ".verdict h2", "No scan yet")
    consent = some("without a consent", d, "section", "None is recorded").text
    check("there is no end of it, nor a beginning", "never" not in consent and "Since" not in consent, consent)
    time.sleep(1.1)
    api("PATCH", "/v1/subjects/locked", {"consent": "C-1", "expires_at": "2031-05-01"})
    go(d, "people?subject=locked")
    some("a consent has its last day", d, "section time", "2031-05-01")
    some("and when it was recorded", d, "section dd", "just now")


def test_zones(d):
    d.execute_cdp_cmd("Emulation.setTimezoneOverride", {"timezoneId": "America/New_York"})
    unlock(d, ALL, "people?subject=locked")
    title = wait(d, lambda _: one(d, "section time", "2031-05-01").get_attribute("title"))
    is_("the viewer's time and UTC", title, "2031-05-01 19:59:59 GMT-4 (2031-05-01 23:59:59 UTC)")
    d.execute_cdp_cmd("Emulation.setTimezoneOverride", {"timezoneId": "UTC"})


def test_erased(d):
    """What was done about an erased person is found by the number on the receipt."""
    send("/v1/subjects/gone/templates", "other.ply")
    uid = api("DELETE", "/v1/subjects/gone")[1]["subject_uid"]
    unlock(d, ALL, "audit?subject=gone")
    some("an id that was overwritten", d, ".verdict p", "look for the number on the receipt")
    field = one(d, "form [type=search]")
    field.clear()
    field.send_keys(uid)
    some("the number finds them", d, "tbody tr", "Person erased")
    some("alone", d, ".row.end [role=status]", "4 entries")
    check("as the address says", "subject_uid=" + uid in d.current_url, d.current_url)
    one(d, "a.clear").click()
    one(d, "tbody a", "erased since").click()
    some("and so does a click", d, ".row.end [role=status]", "4 entries")


def test_back(d):
    unlock(d, ALL, "people?q=before&state=active")
    one(d, "tbody a", "before").click()
    some("a person", d, "h1", "before")
    one(d, "a.back").click()
    check("back to what was looked for", wait(d, lambda _: "q=before&state=active" in d.current_url), d.current_url)
    is_("with what was typed", one(d, "[type=search]").get_attribute("value"), "before")


def test_people(d):
    """Who is locked out, who has no consent; in an order; all of them, as a table."""
    for _ in range(3):
        send("/v1/subjects/locked/verify", "other.ply")
    api("POST", "/v1/subjects", {"subject": "formula", "consent": "=1+1", "groups": ["staff"]})
    for k in range(70):
        api("POST", "/v1/subjects", {"subject": "z-%02d" % (69 - k)})
    unlock(d, ALL, "people?state=locked")
    some("who is locked out", d, "tbody tr", "Locked out")
    check("alone", wait(d, lambda _: texts(d, "tbody th") == ["locked"]), texts(d, "tbody th"))
    api("DELETE", "/v1/subjects/locked/attempts")
    go(d, "people?state=no_consent")
    some("who has no consent", d, "tbody th", "before")
    is_("and nobody else", [t for t in texts(d, "tbody th") if t in ("locked", "formula")], [])
    go(d, "people")
    some("a page of them", d, ".row.end [role=status]", "there are more")
    select = one(d, "[aria-label=Order]")
    select.send_keys("By id")
    check("in the order of the ids, all of them", wait(d, lambda _: len(texts(d, "tbody th")) > 70 and texts(d, "tbody th") == sorted(texts(d, "tbody th"))))
    check("as the address says", "order=subject" in d.current_url, d.current_url)
    one(d, "[aria-label='Save as CSV']").click()
    rows = saved("people.csv").splitlines()
    check("a table of them all", len(rows) == 1 + len(texts(d, "tbody th")), len(rows))
    check("without a formula", any("\"'=1+1\"" in row for row in rows), rows[:3])
    one(d, ".chip", "staff").click()
    some("of a group", d, "main strong", "staff")
    check("its people alone", wait(d, lambda _: texts(d, "tbody th") == ["formula"]), texts(d, "tbody th"))


def test_health(d):
    api("PATCH", "/v1/subjects/locked", {"disabled": True})
    send("/v1/subjects/locked/verify", "a2.ply")
    send("/v1/subjects/nobody/verify", "a2.ply")
    api("PATCH", "/v1/subjects/locked", {"disabled": False})
    unlock(d, ALL, "health")
    some("a refusal of who is disabled", d, ".bars li", "This person is disabled")
    some("and of who is not there", d, ".bars li", "Nobody is enrolled under this id")
    some("comparisons count as such", d, "h2", "Verifications and comparisons since the start")
    go(d, "health?tab=calibration")
    slider = one(d, "[type=range]")
    slider.send_keys(Keys.END)
    some("what another threshold would have done", d, "output", "fewer would have passed")
    some("beyond the table there is no rate", d, "output", "fewer than 1 in")


def test_many(d):
    """The groups of more than 100,000 people, whom the page's own fetch() makes up: it asks before it counts on."""
    unlock(d, ALL, "people")
    d.execute_script("""
        const real = window.fetch, people = 130500;
        window.asked = 0;
        window.fetch = (to, how) => {
          const url = new URL(to, location.href), from = Number(url.searchParams.get("cursor") ?? 0), n = Number(url.searchParams.get("limit"));
          if (!url.pathname.endsWith("/v1/subjects") || n !== 1000) return real(to, how); // of the list
          window.asked++;
          const subjects = Array.from({ length: Math.min(n, people - from) }, (_, i) => ({ subject: `p${from + i}`, groups: [[], ["day"], ["day", "night"]][(from + i) % 3] }));
          return Promise.resolve(Response.json({ subjects, next_cursor: from + n < people ? String(from + n) : null }));
        };""")
    d.execute_script("arguments[0].focus()", one(d, ".choices a", "Groups"))
    press(d, Keys.ENTER)
    rows = lambda: [[e.text for e in tr.find_elements(By.CSS_SELECTOR, "th, td")][:2] for tr in d.find_elements(By.CSS_SELECTOR, "tbody tr")]
    some("it has not counted all", d, "[role=status]", "Counted of the first 100,000 people; there are more.")
    is_("after a hundred requests", d.execute_script("return window.asked"), 100)
    check("and says what it has", [r for r in rows() if r[0] in ("day", "night")] == [["day", "66,666"], ["night", "33,333"]], rows())
    one(d, "button", "Count on").click()
    check("it counts on, where it was", wait(d, lambda _: [r for r in rows() if r[0] in ("day", "night")] == [["day", "87,000"], ["night", "43,500"]]), rows())
    some("to the end", d, "[role=status]", "groups.")
    is_("and asks no more than it must", d.execute_script("return window.asked"), 131)
    is_("nothing is left to count", [e.text for e in d.find_elements(By.CSS_SELECTOR, "main button") if "Count on" in e.text], [])
    some("how many are in none", d, "main p", "In no group: 43,500 people")


def test_groups(d):
    """The groups in use, a way to the people and to the tokens of each; of a token that is bound to groups, its own alone."""
    for subject, groups in (("g-1", ["door-3", "night"]), ("g-2", ["door-3"]), ("g-3", ["night"])):
        api("POST", "/v1/subjects", {"subject": subject, "groups": groups})
    api("POST", "/v1/tokens", {"name": "door three", "scopes": ["verify"], "groups": ["door-3"]})
    api("POST", "/v1/tokens", {"name": "nobody yet", "scopes": ["verify"], "groups": ["visitors"]})
    api("POST", "/v1/tokens", {"name": "match", "scopes": ["verify"], "groups": ["visitors-2"]})
    ended = api("POST", "/v1/tokens", {"name": "was of door three", "scopes": ["verify"], "groups": ["door-3"]})[1]
    api("DELETE", "/v1/tokens/" + ended["id"])
    rows = lambda: [[e.text for e in tr.find_elements(By.CSS_SELECTOR, "th, td")] for tr in d.find_elements(By.CSS_SELECTOR, "tbody tr")]
    unlock(d, ALL, "people")
    d.execute_script("arguments[0].focus()", one(d, ".choices a", "Groups"))
    press(d, Keys.ENTER)
    some("the groups", d, "tbody th", "door-3")
    check("with their people and valid tokens", all(r in rows() for r in (["door-3", "2", "1"], ["night", "2", "none"], ["visitors", "none", "1"])), rows())
    some("how many are in none", d, "main p", "people. Only a token that is bound to no group sees them")
    d.execute_script("arguments[0].focus()", one(d, "[aria-label='2 in the group door-3']"))
    press(d, Keys.ENTER)
    check("to its people", wait(d, lambda _: texts(d, "tbody th") == ["g-1", "g-2"]), texts(d, "tbody th"))
    go(d, "people?tab=groups")
    d.execute_script("arguments[0].focus()", one(d, "[aria-label='1 bound to the group door-3']"))
    press(d, Keys.ENTER)
    check("to its tokens, the valid first", wait(d, lambda _: texts(d, "tbody th") == ["door three", "was of door three"]), texts(d, "tbody th"))
    one(d, "main button", "Make a token").click()
    is_("a new one is of the group", wait(d, lambda _: one(d, "dialog input[placeholder^=door-3]").get_property("value")), "door-3")
    press(d, Keys.ESCAPE)

    go(d, "audit?kind=create_token")
    check("a token's name is no decision", wait(d, lambda _: "match" in texts(d, "tbody td.why")), texts(d, "tbody td.why"))
    unlock(d, token("narrow", ["read", "manage", "tokens", "verify"], groups=["door-3", "empty"])["secret"], "people?tab=groups")
    some("a bound token", d, "main p", "sees these, and their people, alone")
    is_("its groups alone, also one without people", rows(), [["door-3", "2", "2"], ["empty", "none", "1"]])
    go(d, "people?subject=g-1")
    some("a person has no other", d, "section .chip", "door-3")
    is_("of them", texts(d, "section .chips .chip"), ["door-3"])
    d.execute_script("arguments[0].focus()", one(d, "[aria-label='Change the groups']"))
    press(d, Keys.ENTER)
    field = one(d, "dialog input[type=text]")
    field.send_keys(Keys.CONTROL + "a")
    press(d, *"night", Keys.ENTER)
    some("it gives its own alone", d, "dialog .error", "bound to groups")
    field.send_keys(Keys.CONTROL + "a")
    press(d, *"empty", Keys.ENTER)
    check("which is done", wait(d, lambda _: not d.find_elements(By.TAG_NAME, "dialog") and texts(d, "section .chips .chip") == ["empty"]), texts(d, "section .chip"))
    is_("and the others stay", sorted(api("GET", "/v1/subjects/g-1")[1]["groups"]), ["empty", "night"])
    go(d, "health?tab=tokens")
    d.execute_script("arguments[0].focus()", one(d, "main button", "Make a token"))
    press(d, Keys.ENTER)
    one(d, "dialog input[type=text]")
    press(d, *"of night")
    d.execute_script("arguments[0].focus()", one(d, "dialog [name=scope][value=verify]"))
    press(d, Keys.SPACE)
    field = one(d, "dialog input[placeholder^=door-3]")
    is_("its groups are given", field.get_property("value"), "door-3, empty")
    field.clear()
    field.send_keys("night" + Keys.ENTER)
    some("a token of another group is refused", d, "dialog .error", "bound to groups")
    field.clear()
    field.send_keys("door-3" + Keys.ENTER)
    some("one of its own is made", d, "dialog code.shown")
    press(d, Keys.ESCAPE)
    some("and is in the list", d, "tbody th", "of night")
    quiet("groups", d)


def test_gone(d):
    """A daemon that does not answer: something is shown, and a button tries again."""
    pages = (("people", "tbody th"), ("people?tab=groups", "tbody th"), ("people?subject=before", ".verdict h2"), ("audit", "tbody tr"), ("health", ".tile"),
             ("health?tab=scans", "svg.weeks"), ("health?tab=tokens", "tbody tr"), ("health?tab=calibration", "output"))
    for page, there in pages:
        unlock(d, ALL, page)
        one(d, there)
        go(d, "try")
        one(d, ".welcome")
        os.kill(DAEMON, signal.SIGSTOP)
        go(d, page)
        some("%s: not blank while it waits" % page, d, "main .waiting")
        os.kill(DAEMON, signal.SIGCONT)
        some("%s: then the page" % page, d, there)
        go(d, "try")
        one(d, ".welcome")
        d.execute_cdp_cmd("Network.enable", {})
        d.execute_cdp_cmd("Network.setBlockedURLs", {"urls": ["*/v1/*"]})
        go(d, page)
        again = some("%s: a way out" % page, d, "main button", "Try again")
        d.execute_cdp_cmd("Network.setBlockedURLs", {"urls": []})
        again.click()
        some("%s: which works" % page, d, there)
        check("%s: and the problem is gone" % page, wait(d, lambda _: "Try again" not in texts(d, "main button")))


def test_upload(d):
    unlock(d, ALL, "identify")
    big = os.path.join(FOLDER, "big.ply")
    with open(os.path.join(FOLDER, "a.ply"), "rb") as f, open(big, "wb") as to:
        to.write(f.read() + b"\0" * 8000000)
    one(d, ".welcome")
    d.execute_cdp_cmd("Network.enable", {})
    d.execute_cdp_cmd("Network.emulateNetworkConditions", {"offline": False, "latency": 0, "downloadThroughput": -1, "uploadThroughput": 2000000})
    give(d, big)
    check("how much was sent", wait(d, lambda _: 0 < float(one(d, ".sending").get_property("value")) < 1))
    d.execute_cdp_cmd("Network.emulateNetworkConditions", {"offline": False, "latency": 0, "downloadThroughput": -1, "uploadThroughput": -1})
    check("until it was", wait(d, lambda _: not d.find_element(By.CSS_SELECTOR, ".sending").is_displayed()))


PAGES = (("people", "tbody th"), ("people?tab=groups", "tbody th"), ("people?subject=locked", ".verdict h2"), ("audit", "tbody tr"), ("health", ".tile"),
         ("health?tab=scans", "svg.weeks"), ("health?tab=tokens", "tbody tr"), ("health?tab=calibration", "output"))

OVER = """return [...document.querySelectorAll("main *")].filter((e) => e.checkVisibility() && !e.closest("svg, .sr, thead, pre") &&
    e.scrollWidth > e.clientWidth + 1 && ["auto", "scroll"].includes(getComputedStyle(e).overflowX)).map((e) => e.className)"""


def unscaled(title, d):
    """The texts of a chart are as large as others."""
    check(title + ": no chart is enlarged or reduced", wait(d, lambda _: d.execute_script("""return [...document.querySelectorAll("svg.chart")]
        .every((s) => Math.abs(s.getBoundingClientRect().width - s.viewBox.baseVal.width) <= 1)""")))


def test_narrow(d):
    """Nothing is scrolled out sideways."""
    unlock(d, ALL)
    for width in (1280, 1024, 768, 320):
        look(d, width, width != 768)
        for page, there in PAGES:
            go(d, page)
            one(d, there)
            time.sleep(0.3)
            title = "pages-%s-%d" % (page.replace("?", "-").replace("=", "-"), width)
            check(title + ": all is in sight", wait(d, lambda _: d.execute_script(OVER) == []), d.execute_script(OVER))
            is_(title + ": nothing is wider than the screen", d.execute_script("return document.documentElement.scrollWidth"), width)
            unscaled(title, d)
            contrast(title, d)
            d.save_screenshot(os.path.join(FOLDER, title + ".png"))
    one(d, ".chart .curve")
    for width in (1280, 768, 320):
        look(d, width, True)
        unscaled("in a window made %d wide" % width, d)
    look(d, 1280, True)


def test_print(d):
    unlock(d, ALL)
    for page, there in PAGES:
        go(d, page)
        one(d, there)
        d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        is_("%s: paper has no controls" % page, d.execute_script(
            "return [...document.querySelectorAll('aside, button, input[type=search]')].filter((e) => e.checkVisibility()).length"), 0)
        is_("%s: and is white" % page, d.execute_script("return getComputedStyle(document.body).backgroundColor"), "rgb(255, 255, 255)")
        contrast("on paper", d)
        unscaled("on paper", d)
        d.save_screenshot(os.path.join(FOLDER, "print-%s.png" % page.replace("?", "-").replace("=", "-")))
        d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    look(d, 1280, True)


def test_forced(d):
    """With colours of the reader's own the bars are still there."""
    d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "forced-colors", "value": "active"}]})
    unlock(d, ALL, "health")
    one(d, ".bars li")
    is_("bars", d.execute_script("""const c = (e) => getComputedStyle(e).backgroundColor;
        const bar = document.querySelector(".bars .track i"); return c(bar) !== c(bar.parentElement) && c(bar) !== c(document.body);"""), True)
    d.save_screenshot(os.path.join(FOLDER, "forced-health.png"))
    d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    look(d, 1280, True)


def test_focus(d):
    """A dialog gives the focus back to what opened it, also where that was made anew."""
    unlock(d, ALL, "people?subject=locked")
    one(d, ".verdict h2")
    for name in ("Change the consent", "Change the groups"):
        d.execute_script("arguments[0].focus()", one(d, "[aria-label='%s']" % name))
        press(d, Keys.ENTER)
        one(d, "dialog")
        press(d, *("staff" if "groups" in name else "C-2"), Keys.ENTER)
        check("it is saved", wait(d, lambda _: not d.find_elements(By.TAG_NAME, "dialog")))
        check("the focus is where it was", wait(d, lambda _: focused(d) == "button " + name), focused(d))
    quiet("focus", d)


def test_calibrated(d):
    """What a calibration of one's own was learned from, in words; the interval of its threshold, also as a band."""
    unlock(d, ALL, "health?tab=calibration")
    one(d, ".chart .curve")
    is_("of the shipped one there is none", d.find_elements(By.CSS_SELECTOR, ".chart .interval"), [])
    for i in range(1, 13):
        is_("enrolled", send("/v1/subjects/learn-%d/templates" % i, "s%d.ply" % i), 201)
    subprocess.run(COMMAND + ["calibrate", "--fmr", "0.05", "--yes"], check=True, stdout=subprocess.DEVNULL)
    c = api("GET", "/v1/stats")[1]["calibration"]
    check("the interval holds the threshold", c["low"] <= c["threshold"] <= c["high"], c)
    press(d, Keys.F5)
    some("in words", d, ".side p", "Learned from scans of %d people" % c["subjects"])
    some("the comparisons", d, ".side p", "%s comparisons of two of them" % format(c["non_mated"], ","))
    some("the interval", d, ".side dd", ("%.1f to %.1f" % (c["low"], c["high"])).replace("-", "−"))
    band, at = (d.execute_script("const b = document.querySelector(arguments[0]).getBBox(); return [b.x, b.x + b.width]", ".chart ." + e) for e in ("interval", "limit"))
    check("a band about the threshold", band[0] <= at[0] <= band[1] and band[0] < band[1], (band, at))
    for width in (1280, 360):
        for dark in (True, False):
            look(d, width, dark)
            go(d, "try")
            go(d, "health?tab=calibration")
            one(d, ".chart .interval")
            title = "pages-calibrated-%d-%s" % (width, "dark" if dark else "light")
            is_(title + ": nothing is wider than the screen", d.execute_script("return document.documentElement.scrollWidth"), width)
            contrast(title, d)
            d.save_screenshot(os.path.join(FOLDER, title + ".png"))
    look(d, 1280, True)
    quiet("calibrated", d)


def sent(name, noise_um, first, last, weekly=1):
    """Forty scans a day by this token, from so many days ago until so many."""
    db = sqlite3.connect(COMMAND[-1])
    with db:
        for i in range(last, first + 1, weekly):
            day = datetime.datetime.now(datetime.timezone.utc).date() - datetime.timedelta(i)
            db.execute("INSERT OR REPLACE INTO scans SELECT ?, id, 0, 40, 1, 40 * ?, 40 * ? FROM tokens WHERE name = ?",
                       (str(day), noise_um + 20 * (i % 3), max(0, 960 - noise_um // 3), name))
    db.close()


def test_scans(d):
    """A door whose scanner has become worse is told, in a sentence, and first; one that has not is not."""
    for name in ("east", "north", "<b>west"):
        token(name, ["verify"])
    sent("east", 290, 70, 0)
    sent("north", 310, 80, 0)
    sent("north", 620, 2, 0)
    sent("<b>west", 450, 60, 30)
    unlock(d, token("watch", ["audit"])["secret"], "health")
    since = datetime.datetime.now(datetime.timezone.utc).date() - datetime.timedelta(2)
    said = "noise doubled since %s, %s: 0.6" % (since.strftime("%A"), since)
    some("among what is to be mended", d, ".findings li.unsure", "north: " + said)
    one(d, ".choices a", "Scans").click()
    some("the change", d, "tbody .state.unsure", said[0].upper() + said[1:])
    is_("what has changed is first", texts(d, ".card.table:not(details *) tbody th")[:1], ["north"])
    is_("nothing else has", len(d.find_elements(By.CSS_SELECTOR, "tbody .state.unsure")), 1)
    check("a name is a text", "<b>west" in texts(d, "tbody th"), texts(d, "tbody th"))
    lines = d.find_elements(By.CSS_SELECTOR, "svg.weeks")
    check("a line for each, with its weeks for whoever does not see it", len(lines) >= 3 and all(
        e.get_attribute("aria-label").startswith("Noise by week: 20") for e in lines))
    north = d.find_element(By.CSS_SELECTOR, "svg.weeks.unsure")
    is_("one point a week", len(north.find_elements(By.TAG_NAME, "circle")), 12)
    check("it rises to the end", d.execute_script("""const y = [...arguments[0].querySelectorAll("circle")].map((c) => Number(c.getAttribute("cy")));
        return y.at(-1) < y.at(-3) - 4 || y.at(-2) < y.at(-3) - 4""", north))
    d.find_element(By.TAG_NAME, "summary").send_keys(Keys.ENTER)
    some("all weeks, by the keyboard", d, "details tbody td", "0.31 mm")
    d.find_element(By.TAG_NAME, "summary").send_keys(Keys.ENTER)
    for width in (1280, 360):
        for dark in (True, False):
            look(d, width, dark)
            time.sleep(0.3)
            title = "pages-scans-%d-%s" % (width, "dark" if dark else "light")
            is_(title + ": nothing is wider than the screen", d.execute_script("return document.documentElement.scrollWidth"), width)
            contrast(title, d)
            d.save_screenshot(os.path.join(FOLDER, title + ".png"))
    look(d, 1280, True)
    one(d, "tbody th a", "north").click()
    some("what this token did", d, "main h1", "Audit")
    quiet("scans", d)


run(browser(), test_landing, test_reload, test_formats, test_words, test_id, test_states, test_zones, test_erased, test_back, test_people, test_groups, test_many, test_health, test_gone,
    test_upload, test_narrow, test_print, test_forced, test_focus, test_calibrated, test_scans)
