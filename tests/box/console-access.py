"""What axe-core finds on the console's pages, against a running daemon: console-access.py URL FOLDER TOKEN (browser.py).
FOLDER has axe-core in node_modules."""
import json
import time

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import ALL, FOLDER, ROOT, browser, check, go, one, quiet, run, unlock, wait

AXE = open(FOLDER + "/node_modules/axe-core/axe.min.js").read()
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
PAGES = ["try", "identify", "live", "people", "people?subject=person-a", "people?tab=groups", "audit", "health",
         "health?tab=scans", "health?tab=tokens", "health?tab=calibration"]
# name, CSS pixels across, device pixels for each, colours
LOOKS = [("dark, 1440 px", 1440, 1, "dark", False), ("light, 1280 px", 1280, 1, "light", False),
         ("forced colours", 1280, 1, "dark", True), ("768 px", 768, 1, "light", False),
         ("360 px", 360, 1, "dark", False), ("320 px", 320, 1, "light", False), ("200 %", 640, 2, "dark", False)]


def set_look(d, width, ratio, colors, forced):
    d.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": 860, "deviceScaleFactor": ratio, "mobile": False})
    d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
        {"name": "prefers-color-scheme", "value": colors},
        {"name": "forced-colors", "value": "active" if forced else "none"},
        {"name": "prefers-reduced-motion", "value": "reduce"}]})


def faults(d, forced):
    """A line for each element in which axe-core finds one.  Forced colours have the user's contrast, whatever a
    page asks for; axe-core sees what it asks for."""
    if not d.execute_script("return !!window.axe"):
        d.execute_script(AXE)
    found = d.execute_async_script("""
        const done = arguments[arguments.length - 1];
        axe.run(document, {runOnly: arguments[0], resultTypes: ["violations"],
                            rules: {"color-contrast": {enabled: !arguments[1]}}}).then(
            (r) => done(r.violations.flatMap((v) => v.nodes.map((n) => `${v.id}: ${n.target} ${n.failureSummary}`))),
            (e) => done([`axe-core failed: ${e}`]))""", RULES, forced)
    return [" ".join(line.split())[:300] for line in found]


def moving(d):
    return d.execute_script("return document.getAnimations().length")


def wide(d):
    """Elements that make the page scroll sideways."""
    return d.execute_script("""
        const root = document.documentElement;
        return root.scrollWidth <= root.clientWidth ? [] : [...document.querySelectorAll("body *")]
            .filter((e) => e.getBoundingClientRect().right > root.clientWidth + 1)
            .map((e) => `${e.localName}.${e.className}`).slice(0, 5)""")


def cut(d):
    """Texts that their own box cuts: of a control, of the choice of a select, in a chart."""
    return d.execute_script("""
        const found = [], pen = document.createElement("canvas").getContext("2d");
        const tell = (e, text) => found.push(`${e.localName}.${e.getAttribute("class") ?? ""} "${text.trim().slice(0, 40)}"`);
        for (const e of document.querySelectorAll("button, summary, a, label, input, select, h1, h2, h3, p, th, td, strong, .error")) {
          if (!e.checkVisibility()) continue;
          const style = getComputedStyle(e);
          if (e.localName === "select") {
            pen.font = style.font;
            const room = e.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight) - 18; // of the arrow
            const text = e.selectedOptions[0]?.textContent ?? "";
            if (pen.measureText(text).width > room + 1) tell(e, text);
          } else if (e.localName === "input") {
            pen.font = style.font;
            const room = e.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
            if (e.value === "" && pen.measureText(e.placeholder).width > room + 1) tell(e, e.placeholder);
          } else if (e.clientWidth > 1 && e.scrollWidth > e.clientWidth + 1 && (e.localName === "button" || style.overflowX !== "visible") && style.textOverflow !== "ellipsis") {
            tell(e, e.textContent);
          }
        }
        for (const e of document.querySelectorAll("button, select, input, a, summary")) { // in a bar that does not move
          const a = e.getBoundingClientRect();
          if (e.checkVisibility() && e.closest("aside") && (a.left < -1 || a.right > document.documentElement.clientWidth + 1)) tell(e, e.textContent);
        }
        for (const e of document.querySelectorAll("svg text")) {
          const a = e.getBoundingClientRect(), svg = e.ownerSVGElement;
          const b = (getComputedStyle(svg).overflow === "visible" ? document.documentElement : svg).getBoundingClientRect();
          if (a.width && (a.left < b.left - 1 || a.right > b.right + 1 || a.top < b.top - 1 || a.bottom > b.bottom + 1)) tell(e, e.textContent);
        }
        return found""")


def look_at(d, page):
    for name, *rest in LOOKS:
        set_look(d, *rest)
        # What is too wide becomes cards only once it is drawn: none may stay.
        wait(d, lambda _: not wide(d) and not faults(d, rest[-1]), 5)
        found = faults(d, rest[-1])
        check("%s, %s: axe-core finds nothing" % (page, name), not found, json.dumps(found[:6], indent=1))
        check("%s, %s: no sideways scrolling" % (page, name), not wide(d), wide(d))
        check("%s, %s: nothing is cut" % (page, name), not cut(d), cut(d))
        check("%s, %s: nothing moves" % (page, name), moving(d) == 0, moving(d))
    set_look(d, 1280, 1, "dark", False)


def test_locked(d):
    d.get(ROOT + "console")
    one(d, "#token").send_keys("0" * 64 + Keys.ENTER)
    one(d, ".error", "token")
    look_at(d, "the lock")


def test_pages(d):
    unlock(d, ALL)
    for page in PAGES:
        go(d, page)
        wait(d, lambda x: x.find_element(By.CSS_SELECTOR, "main h1").text)
        time.sleep(0.5)
        look_at(d, page)


def test_pairs(d):
    unlock(d, ALL, "people?subject=person-a")
    one(d, "button", "Compare them with each other").click()
    one(d, ".matrix")
    look_at(d, "the templates with each other")


def test_compared(d):
    unlock(d, ALL)
    one(d, ".samples button", "Two people").click()
    one(d, ".verdict h2", "Different faces")
    look_at(d, "two people compared")
    one(d, ".stage button", "Section").click()
    canvas = d.find_element(By.TAG_NAME, "canvas")
    for _ in range(2):
        d.execute_script("arguments[0].focus()", canvas)
        canvas.send_keys(Keys.ENTER)
    look_at(d, "with a section and a label")
    for name, *rest in LOOKS:
        set_look(d, *rest)
        d.save_screenshot("%s/access, %s.png" % (FOLDER, name.replace(" %", " percent")))


def test_scan(d):
    unlock(d, ALL)
    one(d, ".samples button", "One scan").click()
    one(d, ".side h2")
    look_at(d, "one scan")
    quiet("all pages", d)


run(browser(), test_locked, test_pages, test_pairs, test_compared, test_scan)
