"""The console's screen at a door, in a real browser: see browser.py.  The token of the arguments is the door's: north."""
import os
import socket
import threading
import time
from urllib.parse import urlsplit

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

import browser as shared
from browser import *

DAY_MS = 24 * 3600 * 1000


class Line:
    """A connection to the daemon that can be cut: the page is loaded through it."""

    def __init__(self):
        self.ends, self.whole = [], True
        self.door = socket.create_server(("127.0.0.1", 0))
        self.root = "http://127.0.0.1:%d/" % self.door.getsockname()[1]
        threading.Thread(target=self.take, daemon=True).start()

    def take(self):
        while True:
            near = self.door.accept()[0]
            if not self.whole:
                near.close()
                continue
            far = socket.create_connection((urlsplit(URL).hostname, urlsplit(URL).port))
            self.ends += [near, far]
            for one_end, other in ((near, far), (far, near)):
                threading.Thread(target=self.carry, args=(one_end, other), daemon=True).start()

    @staticmethod
    def carry(one_end, other):
        try:
            while data := one_end.recv(65536):
                other.sendall(data)
            other.shutdown(socket.SHUT_RDWR)
        except OSError:  # it was cut
            pass

    def cut(self):
        self.whole = False
        for end in self.ends:
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
        self.ends = []

    def mend(self):
        self.whole = True


def passes(d, ms):
    """So much time passes for the page; then its clock stands still."""
    end = d.execute_script("return Date.now()") + ms
    d.execute_cdp_cmd("Emulation.setVirtualTimePolicy", {"policy": "advance", "budget": ms})
    wait(d, lambda _: d.execute_script("return Date.now()") >= end, 120)


def in_time(d, what):
    """As wait(), with a page whose clock stands still between."""
    def found(_):
        passes(d, 1000)
        return what(d)
    return wait(d, found, 40)


def until_shown(d, name):
    """Seconds from the response of the door's request until the page has the id large."""
    begin = time.monotonic()
    wait(d, lambda _: d.find_element(By.CSS_SELECTOR, ".live .big").text == name)
    return time.monotonic() - begin


def test_door(d):
    send("/v1/subjects/alice/templates", "a.ply")
    send("/v1/subjects/bob/templates", "other.ply")
    guard = token("guard", ["events", "manage"])
    unlock(d, guard["secret"], "live?door=north")
    some("what came before is there", d, ".live .big", "bob")
    some("the door", d, "h1", "north")
    is_("it fills the screen", [e.is_displayed() for e in d.find_elements(By.TAG_NAME, "aside")], [False])
    send("/v1/subjects/alice/verify", "a2.ply")
    within("a decision is shown", 1000 * until_shown(d, "alice"), 500)
    some("its word", d, ".live h2", "Same face")
    some("its reason", d, ".live .reason", "speaks for them")
    some("its time", d, ".live", "UTC")
    is_("an id is large", d.execute_script("return parseFloat(getComputedStyle(document.querySelector('.big')).fontSize)"), 64)
    is_("no score is", d.find_elements(By.CSS_SELECTOR, ".gauge"), [])
    check("it is read aloud", wait(d, lambda _: d.find_element(By.ID, "news").get_attribute("textContent").startswith("alice: Same face.")))
    sound = one(d, "header button", "Sound is off")
    sound.click()
    some("sound is there if it is wanted", d, "header button", "Sound is on")
    # of another door
    other = token("south", ["verify"])["secret"]
    with open(os.path.join(FOLDER, "a2.ply"), "rb") as f:
        api("POST", "/v1/subjects/bob/verify", f.read(), token=other, kind="model/ply")
    go(d, "live?door=south")
    some("another door", d, ".live .big", "bob")
    some("which can be chosen", d, "select option", "north")
    go(d, "live?door=north")
    some("this one has not seen it", d, ".live .big", "alice")
    quiet("a door", d)


def test_lockout(d):
    """A lock-out stays in sight until it ends, whoever comes next."""
    for _ in range(3):
        send("/v1/subjects/alice/verify", "other.ply")
    some("a lock-out", d, ".lockouts li", "alice")
    some("at the decision", d, ".live .reason", "Until")
    send("/v1/subjects/bob/verify", "other.ply")
    some("the next person", d, ".live .big", "bob")
    some("the lock-out is still there", d, ".lockouts li", "alice")
    contrast("with a lock-out", d)
    for width in (1280, 360):
        for dark in (True, False):
            look(d, width, dark)
            time.sleep(0.3)
            d.save_screenshot(os.path.join(FOLDER, "door-%d-%s.png" % (width, "dark" if dark else "light")))
            is_("nothing is wider than the screen", d.execute_script("return document.documentElement.scrollWidth"), width)
            contrast("at %d px" % width, d)
    look(d, 1280, True)
    one(d, ".lockouts button", "End").click()
    some("its end is asked about", d, "dialog h2", "alice")
    press(d, Keys.ENTER)
    check("then it is gone", wait(d, lambda _: not d.find_elements(By.CSS_SELECTOR, ".lockouts li")))
    is_("for the door, too", send("/v1/subjects/alice/verify", "a2.ply"), 200)
    for _ in range(3):
        send("/v1/subjects/bob/verify", "a2.ply")
    some("another one", d, ".lockouts li", "bob")
    api("DELETE", "/v1/subjects/bob/attempts")
    check("goes if somebody else ends it", wait(d, lambda _: not d.find_elements(By.CSS_SELECTOR, ".lockouts li")))
    d.execute_script("location.hash = 'live'")
    some("on Live, too", d, "tbody tr", "Lock-out ended")


def test_lost(d):
    """Without a connection the last decision stays, dimmed; with it, nothing is missed."""
    line, direct = Line(), shared.ROOT
    shared.ROOT = line.root
    unlock(d, token("over a line", ["events"])["secret"], "live?door=north")
    shared.ROOT = direct
    send("/v1/subjects/alice/verify", "a2.ply")
    some("before", d, ".live .big", "alice")
    line.cut()
    some("that it was lost", d, ".advice", "No connection since")
    some("the last decision stays", d, ".live .big", "alice")
    is_("dimmed", d.execute_script("const c = (v) => getComputedStyle(document.querySelector(v)).color; return c('.live h2') === c('.dim')"), True)
    contrast("without a connection", d)
    d.save_screenshot(os.path.join(FOLDER, "door-offline.png"))
    send("/v1/subjects/bob/verify", "other.ply")
    line.mend()
    some("what was missed", d, ".live .big", "bob")
    check("and no warning", wait(d, lambda _: not d.find_element(By.CSS_SELECTOR, ".advice").is_displayed()))
    send("/v1/subjects/alice/verify", "a2.ply")
    within("a decision is shown after it was cut", 1000 * until_shown(d, "alice"), 500)
    d.get_log("browser")
    d.get_log("performance")


def size(d):
    d.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
    found = {m["name"]: m["value"] for m in d.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]}
    return found["Nodes"], found["JSHeapUsedSize"] / 1e6


def test_day(d):
    """A day without a key or a pointer, with many who come."""
    d.execute_cdp_cmd("Performance.enable", {})
    screen = token("screen", ["events"])
    unlock(d, screen["secret"], "live?door=")
    some("all doors", d, "h1", "All doors")
    for _ in range(120):
        send("/v1/subjects/alice/verify", "a2.ply")
    time.sleep(1)
    nodes, heap = size(d)
    for _ in range(400):
        send("/v1/subjects/alice/verify", "a2.ply")
    for _ in range(24):
        passes(d, DAY_MS / 24)
    time.sleep(1)
    later, grown = size(d)
    check("nodes do not grow: %d, then %d" % (nodes, later), later < 1.3 * nodes + 200)
    check("nor does memory: %.1f MB, then %.1f MB" % (heap, grown), grown < 1.3 * heap + 2)
    some("it is not locked", d, ".live .big", "alice")
    send("/v1/subjects/bob/verify", "other.ply")
    check("and shows who comes", in_time(d, lambda _: d.find_element(By.CSS_SELECTOR, ".live .big").text == "bob"))


def test_rest(d):
    """A token that may do more: when nobody is there the page shows, and does nothing else."""
    unlock(d, ALL, "live")
    for _ in range(3):
        send("/v1/subjects/alice/verify", "other.ply")
    some("a lock-out, and its end", d, ".lockouts button", "End")
    passes(d, 16 * 60 * 1000)
    check("it still shows", in_time(d, lambda _: one(d, ".live .big", "alice", 1)))
    check("and ends nothing", in_time(d, lambda _: not d.find_elements(By.CSS_SELECTOR, ".lockouts button")))
    is_("nor opens another page", [e.text for e in d.find_elements(By.CSS_SELECTOR, "aside nav a")], ["Live"])
    go(d, "people")
    check("also by its address", in_time(d, lambda _: one(d, "main", "takes a token with the scope", 1)))
    one(d, "aside button", "Unlock").click()
    check("until the token is typed", one(d, "#token"))
    api("DELETE", "/v1/subjects/alice/attempts")


def test_revoked(d):
    gone = token("gone", ["events"])
    unlock(d, gone["secret"], "live?door=")
    one(d, ".live .big")
    api("DELETE", "/v1/tokens/" + gone["id"])
    some("a token that is revoked locks", d, ".error", "not valid any more")


run(browser(), test_door, test_lockout, test_lost, test_revoked)
# whose clock stands still afterwards
run(browser(), test_day)
run(browser(), test_rest)
