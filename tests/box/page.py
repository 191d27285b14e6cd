"""The pages of tests/box/page.sh in a browser: page.py file://FOLDER FOLDER - CREATED HOSTILE-NAME (browser.py)."""
import base64
import sys
import time

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

from browser import FOLDER, ROOT, browser, check, look, one, quiet, run, still

CREATED, HOSTILE = sys.argv[4:]


# The picture: shares of its pixels that are drawn, blue, orange; in all, to the left, to the right.
PICTURE = """
const c = document.querySelector("canvas"), to = document.createElement("canvas");
c.frameTime();
[to.width, to.height] = [c.width, c.height];
const context = to.getContext("2d");
context.drawImage(c, 0, 0);
const { data } = context.getImageData(0, 0, c.width, c.height);
const out = { drawn: 0, blue: [0, 0], orange: [0, 0], sum: 0 };
for (let i = 0; i < data.length; i += 4) {
  if (!data[i + 3]) continue;
  const side = (i / 4) % c.width < c.width / 2 ? 0 : 1;
  out.drawn++;
  if (data[i + 2] > data[i] + 25) out.blue[side]++;
  if (data[i] > data[i + 2] + 50) out.orange[side]++;
  out.sum = (out.sum * 31 + data[i] + data[i + 1] * 7) % 1000000007;
}
out.drawn /= data.length / 4;
return out;
"""

# Texts in the picture and on the gauge that lie on each other, or on the tabs.
COLLIDE = """
const boxes = [...document.querySelectorAll(".legend text, .gauge text, .tabs:not([hidden]) button, .about")]
  .map((e) => [e.textContent, e.getBoundingClientRect()]).filter(([, b]) => b.width);
const bad = [];
boxes.forEach(([name, a], i) => boxes.slice(i + 1).forEach(([other, b]) => {
  if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1)
    bad.push(`${name} / ${other}`);
}));
return bad;
"""


def text(driver, selector):
    return [e.text for e in driver.find_elements(By.CSS_SELECTOR, selector)]


def show(driver, name, width=1280, dark=True):
    look(driver, width, dark)
    driver.get(ROOT + name + ".html")
    one(driver, ".verdict h2")
    still(driver)
    driver.save_screenshot("%s/page-%s-%d.png" % (FOLDER, name, width))
    quiet(name, driver)
    check(name + ": no text lies on another", driver.execute_script(COLLIDE) == [], driver.execute_script(COLLIDE))
    check(name + ": as wide as the screen", driver.execute_script("return document.documentElement.scrollWidth") == width)
    return driver.execute_script(PICTURE)


def says(title, driver, selector, *parts):
    found = " | ".join(text(driver, selector))
    for part in parts:
        check("%s: %s" % (title, part), part in found, found)


def curve(driver, title):
    check("%s: the curve of other people's scores" % title, len(driver.find_elements(By.CSS_SELECTOR, ".gauge .others")) == 1)


def test_pages(d):
    picture = show(d, "match")
    says("match", d, ".verdict h2", "Same face")
    says("match", d, ".slot", "alice", "enrolled " + CREATED, HOSTILE, "file of 20")
    check("match: a hostile name is no element", not d.find_elements(By.CSS_SELECTOR, ".slot img"))
    check("match: its title", d.title == "alice and " + HOSTILE, d.title)
    curve(d, "match")
    says("match", d, ".regions", "nose")
    check("match: something is drawn", picture["drawn"] > 0.08, picture)
    ActionChains(d).drag_and_drop_by_offset(d.find_element(By.TAG_NAME, "canvas"), 120, 20).perform()
    turned = d.execute_script(PICTURE)
    check("match: a drag turns it", turned["sum"] != picture["sum"], turned)
    for width in (1280, 360):
        look(d, width, True)
        one(d, ".stage button", "Section").click()
        says("match, %d px" % width, d, ".section .said", "B lies at most")
        still(d)
        d.save_screenshot("%s/page-section-%d.png" % (FOLDER, width))
        check("match, %d px: the cut lies on nothing" % width, d.execute_script(COLLIDE) == [], d.execute_script(COLLIDE))
        one(d, ".stage button", "Section").click()
    look(d, 1280, True)
    d.execute_script("addEventListener('beforeprint', () => window.sheet = document.querySelector('.paper').textContent)")
    pdf = base64.b64decode(d.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})["data"])
    check("match: printed it is one sheet", pdf.count(b"/Type /Page") - pdf.count(b"/Type /Pages") == 1)
    sheet = d.execute_script("return window.sheet")
    check("match: with who, what and when", all(part in sheet for part in ("alice", HOSTILE, "Same face", CREATED, "surfaced/", "UTC", "B lies at most")), sheet)
    calm = picture["orange"]
    picture = show(d, "differ", dark=False)
    says("differ", d, ".verdict h2", "Different faces")
    check("differ: what speaks against is orange, much more than in a match",
          sum(picture["orange"]) > 5 * sum(calm) + 1000, (picture, calm))
    d.find_elements(By.CSS_SELECTOR, ".tabs button")[3].click()
    d.find_elements(By.CSS_SELECTOR, ".poses button")[0].click()
    halves = d.execute_script(PICTURE)
    check("differ: A is blue and to the left, B orange and to the right",
          halves["blue"][0] > 5000 > 200 > halves["blue"][1] and halves["orange"][1] > 5000 > 200 > halves["orange"][0], halves)
    show(d, "differ", 360)
    picture = show(d, "files")
    says("two files", d, ".slot", "a.ply", "a2.ply")
    says("two files", d, ".verdict h2", "Same face")
    curve(d, "two files")
    check("two files: something is drawn", picture["drawn"] > 0.08, picture)
    picture = show(d, "scan")
    says("scan", d, ".verdict h2", "Good to enroll")
    says("scan", d, ".slot", "bust.ply")
    says("scan", d, ".about", "Dots: what else the scan has")
    check("scan: something is drawn", picture["drawn"] > 0.08, picture)
    check("scan: also dots", picture["blue"][0] + picture["blue"][1] > 300, picture)
    picture = show(d, "plane")
    says("no face", d, ".verdict h2", "Not usable")
    check("no face: has no quality", text(d, ".badge") == [], text(d, ".badge"))
    check("no face: the dots alone", 0.002 < picture["drawn"] < 0.05, picture)
    d.get(ROOT + "changed.html")
    time.sleep(1)
    lines = [entry["message"] for entry in d.get_log("browser")]
    check("a script that was changed does not run", not d.find_elements(By.TAG_NAME, "main")
          and any("Content Security Policy" in line for line in lines), lines)


run(browser(), test_pages)
