"""What the tests share that run in a real browser, against a running daemon.  Such a test is started
as NAME.py URL FOLDER TOKEN.

TOKEN: one with every scope; others are made with it.  FOLDER has scans; pictures of the pages and
files that are saved go there too.  Prints a line for each check; the test's shell script counts them."""
import base64
import io
import json
import os
import struct
import sys
import time
import urllib.error
import urllib.request
import zlib

from selenium import webdriver
from selenium.common.exceptions import StaleElementReferenceException
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

URL, FOLDER, ALL = sys.argv[1:4]
ROOT = URL + "/"


def check(title, holds, got=""):
    print("%s %s%s" % ("ok" if holds else "FAIL", title, "" if holds else ": %s" % (got,)), flush=True)


def is_(title, got, wanted):
    check(title, got == wanted, "got %r, wanted %r" % (got, wanted))


def browser(webgl=True):
    options = webdriver.ChromeOptions()
    # Another user name space is not to be had in a container or by root.
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars",
                     "--window-size=1280,860"):
        options.add_argument(argument)
    for argument in (("--use-angle=swiftshader", "--enable-unsafe-swiftshader") if webgl else
                     ("--disable-3d-apis",)):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
    driver.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": FOLDER})
    look(driver, 1280, True)
    return driver


def look(driver, width, dark):
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": 780 if width < 500 else 860, "deviceScaleFactor": 1, "mobile": width < 500})
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
        {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})


def wait(driver, what, seconds=15):
    """What a function of the driver returns, as soon as that is true; else None."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            found = what(driver)
        except Exception:  # the page is being changed
            found = None
        if found:
            return found
        time.sleep(0.05)
    return None


def one(driver, selector, text=None, seconds=40):
    def found(d):
        for e in d.find_elements(By.CSS_SELECTOR, selector):
            if e.is_displayed() and (text is None or text in e.text):
                return e
        return None
    element = wait(driver, found, seconds)
    if element is not None:
        click_once = element.click

        def click_again():
            """Also if the page has drawn it anew since."""
            try:
                click_once()
            except StaleElementReferenceException:
                wait(driver, found, seconds).click()
        element.click = click_again
    return element


def gone(driver, selector):
    """True once nothing that the selector finds can be seen."""
    return wait(driver, lambda d: not any(e.is_displayed() for e in d.find_elements(By.CSS_SELECTOR, selector))) is True


def click(driver, selector):
    """Click on it, also where the page is just being changed."""
    def clicked(d):
        d.find_element(By.CSS_SELECTOR, selector).click()
        return True
    check("%s can be clicked on" % selector, wait(driver, clicked))


def some(title, driver, selector, text=None):
    element = one(driver, selector, text)
    check(title, element is not None, "%s with %r; the page has: %s" % (
        selector, text, driver.find_element(By.TAG_NAME, "body").text[:300]))
    return element


def pixels(driver, element):
    """The picture of an element, at a quarter of its size, as decoded() has it."""
    box = driver.execute_script("const b = arguments[0].getBoundingClientRect();"
                                "return {x: b.x + scrollX, y: b.y + scrollY, width: b.width, height: b.height}", element)
    return decoded(base64.b64decode(driver.execute_cdp_cmd(
        "Page.captureScreenshot", {"format": "png", "clip": {**box, "scale": 0.25}})["data"]))


def decoded(png):
    """A PNG that Chromium made, without interlacing: width, height, bytes of RGB or RGBA, bytes a pixel."""
    data = io.BytesIO(png)
    data.read(8)
    packed, size, depth = b"", None, None
    while True:
        length, kind = struct.unpack(">I4s", data.read(8))
        body = data.read(length)
        data.read(4)
        if kind == b"IHDR":
            size, depth = struct.unpack(">II", body[:8]), {2: 3, 6: 4}[body[9]]
        elif kind == b"IDAT":
            packed += body
        elif kind == b"IEND":
            break
    raw, stride, out, before = zlib.decompress(packed), size[0] * depth, bytearray(), bytearray(size[0] * depth)
    for y in range(size[1]):
        method, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a = line[i - depth] if i >= depth else 0
            b, c = before[i], before[i - depth] if i >= depth else 0
            p = a + b - c
            paeth = a if abs(p - a) <= abs(p - b) and abs(p - a) <= abs(p - c) else b if abs(p - b) <= abs(p - c) else c
            line[i] = (line[i] + (0, a, b, (a + b) // 2, paeth)[method]) & 255
        out += line
        before = line
    return size[0], size[1], bytes(out), depth


def color_at(picture, x, y):
    width, height, data, depth = picture
    at = (int(y * height) * width + int(x * width)) * depth
    return tuple(data[at:at + 3])


def difference(a, b):
    """The share of pixels that differ."""
    changed = sum(a[2][i] != b[2][i] or a[2][i + 1] != b[2][i + 1] or a[2][i + 2] != b[2][i + 2]
                  for i in range(0, len(a[2]), a[3]))
    return changed / (a[0] * a[1])


def still(driver):
    time.sleep(0.3)  # the frame that is drawn once nothing moves


def unlock(driver, token, page="try"):
    driver.get("about:blank")  # so that the next is loaded, not only moved in
    driver.get(ROOT + "console#" + page)
    one(driver, "#token").send_keys(token + Keys.ENTER)
    wait(driver, lambda d: d.find_elements(By.CSS_SELECTOR, "aside"))


def go(driver, page):
    """To a page, by its address; once the one before is gone."""
    driver.execute_script("""
        if (location.hash !== "#" + arguments[0])
            document.querySelector("main > *")?.setAttribute("data-before", "");
        location.hash = arguments[0]""", page)
    wait(driver, lambda d: not d.find_elements(By.CSS_SELECTOR, "main > [data-before], main > .waiting"))


def press(driver, *keys):
    for key in keys:
        ActionChains(driver).send_keys(key).perform()


def focused(driver):
    """The role, and the name, of what has the focus."""
    return driver.execute_script("""const e = document.activeElement;
        return `${e.tagName.toLowerCase()} ${e.getAttribute("aria-label") ?? e.textContent.trim()}`;""")


def tab_to(driver, name, most=60):
    """Tab until an element of this name has the focus, once there is one that can."""
    wait(driver, lambda d: d.execute_script("""
        return [...document.querySelectorAll("a, button, summary, [tabindex]")].some(e =>
            !e.disabled && (e.getAttribute("aria-label") ?? e.textContent.trim()).endsWith(arguments[0]))""", name))
    for _ in range(most):
        press(driver, Keys.TAB)
        if focused(driver).endswith(name):
            return
    check("Tab reaches %s" % name, False, focused(driver))


def quiet(title, driver):
    """No error on the console but that of a refusal, and no request to anywhere else."""
    lines = [entry["message"] for entry in driver.get_log("browser")
             if entry["level"] in ("SEVERE", "WARNING") and "GPU stall" not in entry["message"]
             and not ("Failed to load resource" in entry["message"] and "status of 4" in entry["message"])]
    is_(title + ": nothing on the console", lines, [])
    elsewhere = set()
    for entry in driver.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            url = message["params"]["request"]["url"]
            if not url.startswith((ROOT, "data:", "about:", "blob:" + URL)):
                elsewhere.add(url)
    is_(title + ": no request elsewhere", elsewhere, set())


def api(method, path, body=None, token=None, kind="application/json"):
    """The status, and the JSON of a response."""
    data = body if isinstance(body, bytes) else None if body is None else json.dumps(body).encode()
    ask = urllib.request.Request(URL + path, data, {"Authorization": "Bearer " + (token or ALL), "Content-Type": kind},
                                 method=method)
    try:
        with urllib.request.urlopen(ask) as response:
            return response.status, json.loads(response.read() or b"null")
    except urllib.error.HTTPError as e:
        return e.code, json.loads(e.read() or b"null")


def send(path, name):
    with open(os.path.join(FOLDER, name), "rb") as f:
        return api("POST", path, f.read(), kind="model/ply")[0]


def token(name, scopes, groups=()):
    return api("POST", "/v1/tokens", {"name": name, "scopes": scopes, "groups": list(groups)})[1]


def saved(name, seconds=10):
    """The text of a file that the browser saved."""
    path = os.path.join(FOLDER, name)
    found = wait(None, lambda _: os.path.exists(path) and os.path.getsize(path) > 0, seconds)
    check("%s is saved" % name, found)
    with open(path, encoding="utf-8") as f:
        return f.read()


def choose(driver, letter, path):
    place = wait(driver, lambda d: d.find_element(By.CSS_SELECTOR, ".slot.%s input" % letter))
    driver.execute_script("arguments[0].value = ''", place)  # else it is added
    place.send_keys(path)


# ---- contrast, from the styles that the browser computed

CONTRAST = r"""
const lum = (c) => c.slice(0, 3).map((v) => v / 255).map((v) => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
  .reduce((s, v, i) => s + v * [0.2126, 0.7152, 0.0722][i], 0);
const pen = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
const known = new Map();
const parse = (text) => {
  if (!known.has(text)) {
    pen.clearRect(0, 0, 1, 1); pen.fillStyle = text; pen.fillRect(0, 0, 1, 1);
    known.set(text, [...pen.getImageData(0, 0, 1, 1).data]);
  }
  return known.get(text);
};
// What a text may stand on: a colour, or each of a gradient's.
const behind = (e) => {
  for (; e; e = e.parentElement) {
    const s = getComputedStyle(e), c = parse(s.backgroundColor);
    const some = s.backgroundImage.includes("gradient") ? (s.backgroundImage.match(/(rgba?|color|oklab|oklch)\([^()]*\)/g) ?? []).map(parse) : [];
    if (some.length && some.every((x) => x[3] === 255)) return some;
    if (c[3] === 255) return [c];
  }
  return [[255, 255, 255, 255]];
};
const ratio = (a, b) => (Math.max(lum(a), lum(b)) + 0.05) / (Math.min(lum(a), lum(b)) + 0.05);
const bad = [];
const hold = (e, what, color, least) => {
  const worst = Math.min(...behind(what === "border" ? e.parentElement : e).map((b) => ratio(parse(color), b)));
  if (worst < least) bad.push(`${e.tagName}.${e.getAttribute("class")} ${what} ${e.textContent.trim().slice(0, 30)}: ${worst.toFixed(2)}`);
};
const top = document.querySelector("dialog") ?? document.body;
for (const e of top.querySelectorAll("*")) {
  if (!e.checkVisibility() || e.closest(":disabled, .sr")) continue;
  const s = getComputedStyle(e);
  if (e.placeholder) hold(e, "placeholder", getComputedStyle(e, "::placeholder").color, 4.5);
  if (e.matches("input:not([type=file], [type=range], [type=checkbox]), select")) hold(e, "border", s.borderTopColor, 3);
  if ([...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim()))
    hold(e, "text", e.closest("svg") ? s.fill : s.color, 4.5);
}
return bad;
"""


def contrast(title, driver):
    is_(title + ": contrast of at least 4.5", driver.execute_script(CONTRAST), [])


def within(what, ms, most):
    """A measured time.  It depends on what else the machine does: only on an idle one, IDLE=1, it is a check."""
    print("-- %s: %.1f ms, of %d" % (what, ms, most))
    check(what, ms <= most if "IDLE" in os.environ else ms < 1e9, ms)


def run(driver, *tests):
    for test in tests:
        start = time.monotonic()
        try:
            test(driver)
        except Exception as e:  # so that the next is run
            check(test.__name__, False, "%s: %s" % (type(e).__name__, str(e).split("Stacktrace")[0][:300]))
            try:
                driver.get_log("browser")
                look(driver, 1280, True)
            except Exception:
                pass
        print("-- %s: %.1f s" % (test.__name__, time.monotonic() - start))
    driver.quit()
