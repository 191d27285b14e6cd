"""The pages of tests/box/page.sh in a browser: page.py FOLDER CREATED HOSTILE-NAME.  Prints a line for
each check."""
import json
import sys
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

FOLDER, CREATED, HOSTILE = sys.argv[1:]


def check(title, holds, got=""):
    print("%s %s%s" % ("ok" if holds else "FAIL", title, "" if holds else ": %s" % (got,)), flush=True)


def browser():
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars",
                     "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--window-size=1280,860"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))


def logged(driver):
    """What is on the console, and what was asked for but the page itself."""
    lines = [e["message"] for e in driver.get_log("browser") if "GPU stall" not in e["message"]]
    asked = set()
    for entry in driver.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            asked.add(message["params"]["request"]["url"])
    return lines, asked


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
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": 860, "deviceScaleFactor": 1, "mobile": width < 500})
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
        {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})
    url = "file://%s/%s.html" % (FOLDER, name)
    driver.get(url)
    end = time.monotonic() + 15
    while not text(driver, ".verdict h2") and time.monotonic() < end:
        time.sleep(0.05)
    time.sleep(0.3)
    driver.save_screenshot("%s/page-%s-%d.png" % (FOLDER, name, width))
    lines, asked = logged(driver)
    check(name + ": nothing on the console", lines == [], lines)
    check(name + ": no request but for itself", asked <= {url, "data:,"}, asked)
    check(name + ": no text lies on another", driver.execute_script(COLLIDE) == [], driver.execute_script(COLLIDE))
    check(name + ": as wide as the screen", driver.execute_script("return document.documentElement.scrollWidth") == width)
    return driver.execute_script(PICTURE)


def says(title, driver, selector, *parts):
    found = " | ".join(text(driver, selector))
    for part in parts:
        check("%s: %s" % (title, part), part in found, found)


def curve(driver, title):
    check("%s: the curve of other people's scores" % title, len(driver.find_elements(By.CSS_SELECTOR, ".gauge .others")) == 1)


def main():
    d = browser()
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
    says("scan", d, ".about", "Dots: the scan as it came")
    check("scan: something is drawn", picture["drawn"] > 0.08, picture)
    check("scan: also dots", picture["blue"][0] + picture["blue"][1] > 300, picture)
    picture = show(d, "plane")
    says("no face", d, ".verdict h2", "Not usable")
    check("no face: has no quality", text(d, ".badge") == [], text(d, ".badge"))
    check("no face: the dots alone", 0.002 < picture["drawn"] < 0.05, picture)
    d.get("file://%s/changed.html" % FOLDER)
    time.sleep(1)
    lines, _ = logged(d)
    check("a script that was changed does not run", not d.find_elements(By.TAG_NAME, "main")
          and any("Content Security Policy" in line for line in lines), lines)
    d.quit()
    print("-- done")


main()
