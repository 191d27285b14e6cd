"""The console's viewer in a real browser, against a running daemon: console-view.py URL FOLDER TOKEN (browser.py)."""
import base64
import itertools
import math
import os
import random
import re
import shutil
import time

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import (ALL, FOLDER, browser, check, choose, color_at, contrast, decoded, difference, focused,
                     go, gone, is_, look, one, pixels, press, quiet, run, send, some, still, token, unlock,
                     wait, within)


def test_no_webgl(d):
    unlock(d, ALL)
    some("without WebGL", d, ".samples button", "Two people").click()
    some("the decision", d, ".verdict h2", "Different faces")
    some("and why there is no picture", d, ".about", "WebGL2")
    check("nor a scale of it", gone(d, ".legend"))
    some("a section there is", d, ".section .said", "B lies at most")
    one(d, ".stage [role=radio]", "Nose").click()
    check("of both", all(curves(d)), curves(d))
    is_("and a report", one(d, "header button", "Report").is_enabled(), True)
    quiet("without WebGL", d)


def test_try(d):
    unlock(d, ALL)
    some("the samples", d, ".samples button", "Two people")
    one(d, ".samples button", "Two people").click()
    some("two people", d, ".verdict h2", "Different faces")
    some("what each region adds", d, ".regions li", "nose")
    canvas = d.find_element(By.TAG_NAME, "canvas")
    still(d)
    front = pixels(d, canvas)
    ActionChains(d).drag_and_drop_by_offset(canvas, 120, 30).perform()
    still(d)
    turned = pixels(d, canvas)
    check("a drag turns the surfaces", difference(front, turned) > 0.05, difference(front, turned))
    ActionChains(d).move_to_element_with_offset(canvas, 60, -40).perform()
    some("what is under the pointer", d, ".tip", "to the score here")
    check("in mm", "mm" in one(d, ".tip").text)
    # by keyboard alone
    d.execute_script("document.querySelector('.tabs [aria-checked=true]').focus()")
    titles = []
    for _ in range(3):
        d.switch_to.active_element.send_keys(Keys.ARROW_RIGHT)
        titles.append(one(d, ".tabs [aria-checked=true]").text)
    is_("the layers", titles, ["Without change", "As measured", "A | B"])
    still(d)
    apart = pixels(d, canvas)
    left, right = color_at(apart, 0.42, 0.55), color_at(apart, 0.58, 0.55)
    check("A is blue", left[2] > left[0] + 20, left)
    check("B is orange", right[0] > right[2] + 20, right)
    handle = one(d, ".handle span")
    ActionChains(d).drag_and_drop_by_offset(handle, -200, 0).perform()
    still(d)
    moved = color_at(pixels(d, canvas), 0.42, 0.55)
    check("the line moves with the pointer", moved[0] > moved[2] + 20, moved)
    d.find_element(By.CSS_SELECTOR, ".handle").send_keys(Keys.ARROW_RIGHT * 16)
    still(d)
    back = color_at(pixels(d, canvas), 0.42, 0.55)
    check("and by keys", back[2] > back[0] + 20, back)
    d.execute_script("arguments[0].focus()", canvas)
    ActionChains(d).key_down(" ").perform()
    still(d)
    swapped = color_at(pixels(d, canvas), 0.42, 0.55)
    ActionChains(d).key_up(" ").perform()
    check("Space shows the other", swapped[0] > swapped[2] + 20, swapped)
    ActionChains(d).click_and_hold(one(d, ".blink")).perform()
    still(d)
    held = color_at(pixels(d, canvas), 0.42, 0.55)
    ActionChains(d).release().perform()
    check("so does a finger", held[0] > held[2] + 20, held)
    before = pixels(d, canvas)
    canvas.send_keys(Keys.ARROW_LEFT * 3)
    still(d)
    check("arrows turn the surfaces", difference(before, pixels(d, canvas)) > 0.02)
    # the same person
    choose(d, "a", os.path.join(FOLDER, "a.ply"))
    choose(d, "b", os.path.join(FOLDER, "a2.ply"))
    some("the same person", d, ".verdict h2", "Same face")
    check("the 3D file can be saved", one(d, "header button", "Save 3D file").is_enabled())
    one(d, "summary", "The same with curl").click()
    some("the command", d, "pre", "/v1/compare")
    # a name that is hostile is a text
    hostile = os.path.join(FOLDER, "<img src=x onerror=alert(1)>'$(id).ply")
    with open(os.path.join(FOLDER, "a.ply"), "rb") as f, open(hostile, "wb") as to:
        to.write(f.read())
    choose(d, "a", hostile)
    some("a hostile name", d, ".slot.a strong", "<img src=x")
    is_("is no element", d.find_elements(By.CSS_SELECTOR, ".slot img"), [])
    some("nor the shell's", d, ".verdict h2", "Same face")
    # what is no scan
    with open(os.path.join(FOLDER, "broken.ply"), "w", encoding="ascii") as f:
        f.write("not a scan")
    choose(d, "b", os.path.join(FOLDER, "broken.ply"))
    some("a file that is none", d, ".verdict h2", "That did not work")
    some("can be tried again", d, ".side button", "Try again")
    with open(os.path.join(FOLDER, "depth.png"), "wb") as f:
        f.write(b"\x89PNG\r\n\x1a\n" + bytes(64))
    choose(d, "b", os.path.join(FOLDER, "depth.png"))
    some("a depth image asks for its camera", d, ".camera label", "Focal length")
    one(d, ".slot.b .out").click()
    check("nothing else does", gone(d, ".camera"))
    some("the first is left", d, ".verdict h2", "Good to enroll")
    # one scan, by a token that may enroll alone
    unlock(d, token("desk", ["enroll"])["secret"])
    is_("no samples to compare", d.find_elements(By.CSS_SELECTOR, ".samples"), [])
    choose(d, "a", os.path.join(FOLDER, "bust.ply"))
    some("one scan", d, ".verdict h2", "Good to enroll")
    some("its face", d, ".facts", "Points on the face")
    quiet("Try", d)


# ---- the section

# The plane's segments by section.js, and as every triangle by itself gives them; of a bumpy surface of 20,000 triangles.
BRUTE = """
const done = arguments[arguments.length - 1];
import("./console/section.js").then(({ createCutter, createSection, cutOf, planeOf }) => {
  let seed = 7;
  const random = () => ((seed = (seed * 1103515245 + 12345) % 2147483648) / 2147483648);
  const N = 101, at = new Float32Array(3 * N * N), index = new Uint32Array(6 * (N - 1) * (N - 1));
  for (let i = 0; i < N * N; i++) at.set([(i % N) - 50 + 0.3 * random(), Math.floor(i / N) - 50 + 0.3 * random(), 20 * random()], 3 * i);
  for (let y = 0, k = 0; y < N - 1; y++)
    for (let x = 0; x < N - 1; x++, k += 6) index.set([y * N + x, y * N + x + 1, y * N + N + x, y * N + x + 1, y * N + N + x + 1, y * N + N + x], k);
  at.set([0, 0, 0], 3 * 5000); // planes through a corner
  const cutter = createCutter({ at, index }), out = { planes: 0, segments: 0, wrong: 0, lost: 0, turned: 0 };
  for (let run = 0; run < 60; run++) {
    const n = [random() - 0.5, random() - 0.5, run % 3 ? 0 : random() - 0.5], long = Math.hypot(...n);
    const plane = [...n.map((v) => v / long), run % 4 ? 60 * (random() - 0.5) : 0];
    const height = (v) => plane[0] * at[3 * v] + plane[1] * at[3 * v + 1] + plane[2] * at[3 * v + 2] + plane[3];
    const brute = [];
    for (let t = 0; t < index.length; t += 3) {
      const ends = [];
      for (const [a, b] of [[0, 1], [1, 2], [2, 0]].map((e) => e.map((c) => index[t + c]).sort((p, q) => p - q))) {
        const [ha, hb] = [height(a), height(b)];
        if (ha >= 0 === hb >= 0) continue;
        ends.push([0, 1, 2].map((k) => at[3 * a + k] + (ha / (ha - hb)) * (at[3 * b + k] - at[3 * a + k])).join());
      }
      if (ends.length) brute.push(ends.sort().join(" "));
    }
    const fast = cutter.segments(plane).map((s) => [s.slice(2, 5).join(), s.slice(5, 8).join()].sort().join(" "));
    out.planes++;
    out.segments += brute.length;
    brute.sort();
    fast.sort();
    if (brute.length !== fast.length || brute.some((s, i) => s !== fast[i])) out.wrong++;
    const joined = cutter.curves(plane).reduce((sum, points) => sum + points.length / 3 - 1, 0);
    if (joined !== brute.length) out.lost++;
    const again = planeOf(cutOf(plane)), sign = Math.sign(again[0] * plane[0] + again[1] * plane[1] + again[2] * plane[2]);
    if (again.some((v, i) => Math.abs(v - sign * plane[i]) > 1e-9)) out.turned++;
  }
  const flat = (z) => ({ at: Float32Array.from([-50, -50, z, 50, -50, z, 50, 50, z, -50, 50, z]), index: Uint32Array.from([0, 1, 2, 0, 2, 3]) });
  const drawing = createSection();
  drawing.draw([createCutter(flat(0)), createCutter(flat(2))], [0, 1, 0, -10], 600, 200);
  out.said = drawing.said.textContent;
  drawing.draw([createCutter(flat(0)), createCutter(flat(2))], [0, 1, 0, -90], 600, 200);
  out.missed = drawing.said.textContent;
  done(out);
});
"""


def curves(d):
    return d.execute_script("return [...document.querySelectorAll('.stage .cuts path')].map((p) => p.getAttribute('d'))")


def test_section(d):
    unlock(d, ALL)
    one(d, ".samples button", "Two people").click()
    some("two people", d, ".verdict h2", "Different faces")
    found = d.execute_async_script(BRUTE)
    is_("as every triangle by itself gives it (%d segments)" % found["segments"],
        [found["planes"], found["wrong"], found["lost"], found["turned"], found["segments"] > 5000], [60, 0, 0, 0, True])
    is_("of two planes", found["said"], "B lies at most 2.0 mm in front of A, 0.0 mm behind it; 2.00 mm on average along 100 mm.")
    is_("beside them", found["missed"], "The cut misses the face.")
    canvas = d.find_element(By.TAG_NAME, "canvas")
    one(d, ".poses button", "Front").click()
    one(d, ".stage button", "Section").click()
    still(d)
    some("what the cut says", d, ".section .said", "B lies at most")
    profile = curves(d)
    check("A, B, the gap to both sides and a ruler", all(profile), profile)
    is_("a profile", one(d, ".stage [aria-label='Where it is cut'] [aria-checked=true]").text, "Profile")
    before = pixels(d, canvas)
    one(d, ".stage button", "Eyes").click()
    still(d)
    check("its line is on the face", 0.001 < difference(before, pixels(d, canvas)) < 0.1)
    # a real drag over the face
    line = ActionChains(d).move_to_element_with_offset(canvas, -130, -20).click_and_hold().move_by_offset(130, 8).move_by_offset(130, 8)
    still(d)
    before = pixels(d, canvas)
    line.release().perform()
    still(d)
    drawn = curves(d)
    check("follows the drag", drawn[2] != profile[2] and drawn[3] != profile[3] and all(drawn))
    after = pixels(d, canvas)
    middle = [i for i in range(before[1]) if color_at(before, 0.5, i / before[1]) != color_at(after, 0.5, i / before[1])]
    check("the face stays and the line moves", 0 < difference(before, after) < 0.1 and 0 < len(middle) < 12, (difference(before, after), middle))
    is_("no preset", d.find_elements(By.CSS_SELECTOR, ".stage [aria-label='Where it is cut'] [aria-checked=true]"), [])
    # with Shift it turns
    ActionChains(d).key_down(Keys.SHIFT).drag_and_drop_by_offset(canvas, 60, 0).key_up(Keys.SHIFT).perform()
    still(d)
    check("Shift turns the face", difference(after, pixels(d, canvas)) > 0.05)
    is_("and keeps the cut", curves(d), drawn)
    # by keys alone
    d.execute_script("document.querySelector('[aria-label=\"Where it is cut\"] [tabindex=\"0\"]').focus()")
    press(d, Keys.ARROW_RIGHT)
    is_("by keys: the nose", focused(d), "button Nose")
    nose = curves(d)
    press(d, Keys.TAB)
    is_("then the place", focused(d), "input Place of the cut, mm from the middle of the face")
    press(d, *[Keys.ARROW_RIGHT] * 6)
    moved = curves(d)
    check("is moved by them", moved[2] != nose[2] and d.switch_to.active_element.get_attribute("aria-valuetext").endswith("mm"))
    press(d, Keys.TAB, *[Keys.ARROW_LEFT] * 9)
    check("and turned", curves(d)[2] != moved[2])
    some("another person", d, "header button", "Report")
    one(d, ".stage button", "Section").click()
    check("closed again", gone(d, ".section"))
    quiet("the section", d)


# ---- labels, values by keys, scales

def test_pins(d):
    unlock(d, ALL)
    one(d, ".samples button", "Two people").click()
    some("two people", d, ".verdict h2", "Different faces")
    canvas = d.find_element(By.TAG_NAME, "canvas")
    one(d, ".poses button", "Front").click()
    still(d)
    labels = lambda: d.execute_script("return [...document.querySelectorAll('.pin')].map((p) => p.textContent)")
    good, last = [], []
    for x, y in itertools.product((-72, 72), range(-168, 200, 48)):  # some of these places were not compared
        if len(good) == 7:
            break
        ActionChains(d).move_to_element_with_offset(canvas, x, y).click().perform()
        if labels() != last:
            good, last = good + [(x, y)], labels()
            is_("label %d" % len(good), len(last), min(len(good), 6))
    words = one(d, ".pin button").text
    check("in mm, part and region", re.fullmatch(r"\d+\.\d mm (in front|behind)\n[+−]\d\.\d\d · (nose|eyes|forehead|mouth|chin|cheeks)", words), words)
    place = d.execute_script("return document.querySelector('.pin').getBoundingClientRect().x")
    ActionChains(d).drag_and_drop_by_offset(canvas, 60, 0).perform()
    still(d)
    is_("a drag sets none", len(d.find_elements(By.CSS_SELECTOR, ".pin")), 6)
    check("they turn with the face", abs(d.execute_script("return document.querySelector('.pin').getBoundingClientRect().x") - place) > 5)
    one(d, ".pin button").click()
    is_("a click removes one", len(d.find_elements(By.CSS_SELECTOR, ".pin")), 5)
    # by keys
    is_("what the picture is", [canvas.get_attribute("role"), d.execute_script(
        "return document.getElementById(arguments[0].getAttribute('aria-describedby')).textContent.includes('Enter labels')", canvas)], ["application", True])
    d.execute_script("arguments[0].focus()", canvas)
    press(d, Keys.ESCAPE)
    is_("Escape removes all", d.find_elements(By.CSS_SELECTOR, ".pin"), [])
    one(d, ".poses button", "Front").click()
    d.execute_script("arguments[0].focus()", canvas)
    x, y = (n // 12 for n in good[0])
    ActionChains(d).key_down(Keys.SHIFT).send_keys((Keys.ARROW_RIGHT if x > 0 else Keys.ARROW_LEFT) * abs(x)
                                                   + (Keys.ARROW_DOWN if y > 0 else Keys.ARROW_UP) * abs(y)).key_up(Keys.SHIFT).perform()
    some("a cross", d, ".cross")
    some("what is under it", d, ".tip", "to the score here")
    said = d.execute_script("return document.querySelector('.stage [role=status]').textContent")
    check("is told", " mm " in said, said)
    press(d, Keys.ENTER)
    is_("Enter labels it", len(d.find_elements(By.CSS_SELECTOR, ".pin")), 1)
    ActionChains(d).key_down(Keys.SHIFT).send_keys(Keys.ARROW_LEFT * 40).key_up(Keys.SHIFT).perform()
    is_("beside the face", d.execute_script("return document.querySelector('.stage [role=status]').textContent"), "No surface here.")
    # a finger
    press(d, Keys.ESCAPE)
    x, y = d.execute_script("const b = arguments[0].getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]", canvas)
    d.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [{"x": x + good[1][0], "y": y + good[1][1]}]})
    d.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    is_("a tap labels, too", len(d.find_elements(By.CSS_SELECTOR, ".pin")), 1)
    # the second scale
    one(d, ".tabs button", "As measured").click()
    still(d)
    narrow = pixels(d, canvas)
    some("the legend", d, ".legend text", "+3")
    one(d, ".stage button", "±10 mm").click()
    still(d)
    some("the wider one", d, ".legend.wide text", "+10")
    some("is said", d, ".about", "wider")
    check("is paler", difference(narrow, pixels(d, canvas)) > 0.05)
    # both beside each other
    one(d, ".tabs button", "A and B").click()
    one(d, ".poses button", "Front").click()
    still(d)
    apart = pixels(d, canvas)
    left, right = color_at(apart, 0.25, 0.6), color_at(apart, 0.75, 0.6)
    check("A to the left, B to the right", left[2] > left[0] + 20 and right[0] > right[2] + 20, (left, right))
    ActionChains(d).drag_and_drop_by_offset(canvas, 120, 0).perform()
    still(d)
    turned = pixels(d, canvas)
    half = [difference(*[(p[0] // 2, p[1], b"".join(p[2][(y * p[0] + side) * p[3]:(y * p[0] + side + p[0] // 2) * p[3]] for y in range(p[1])), p[3])
                         for p in (apart, turned)]) for side in (0, apart[0] // 2)]
    check("they turn together", min(half) > 0.05, half)
    quiet("labels", d)


# ---- what is no face, the verdict's words, a slot that is emptied

def egg():
    """An egg with a ridge like a nose, as a scanner sees it."""
    at = random.Random(1)
    while True:
        x, y = at.uniform(-75, 75), at.uniform(-100, 100)
        if math.hypot(x / 75, y / 100) <= 1:
            yield "%.2f %.2f %.2f" % (x, y, -50 * ((x / 72) ** 2 + (y / 92) ** 2) + 19 * math.exp(-((x / 9) ** 2 + (y / 27) ** 2) / 2)
                                      + at.uniform(0, 0.4))


def test_verdict(d):
    with open(os.path.join(FOLDER, "egg.xyz"), "w", encoding="ascii") as f:
        f.write("\n".join(itertools.islice(egg(), 4000)))
    unlock(d, ALL)
    choose(d, "a", os.path.join(FOLDER, "egg.xyz"))
    some("an egg", d, ".verdict.no h2", "Hardly a face")
    check("has no quality", gone(d, ".badge"))
    check("and is not good for anything", "Good" not in one(d, ".verdict").text, one(d, ".verdict").text)
    one(d, ".slot.a .out").click()
    some("the slot is empty", d, ".slot.a", "Drop a file")
    some("and the page as it was", d, ".samples button", "Two people").click()
    some("two people", d, ".verdict.no p", "Strong: the shape speaks against")
    is_("a non-match has no rate", [e.text for e in d.find_elements(By.CSS_SELECTOR, ".verdict p") if "1 in" in e.text or "in 100" in e.text], [])
    check("two hills and a tick", all(d.find_elements(By.CSS_SELECTOR, ".gauge ." + k) for k in ("others", "same", "expected")))
    press(d, Keys.TAB)
    one(d, ".slot.b .out").send_keys(Keys.ENTER)
    some("one is left", d, ".verdict h2", "Good to enroll")
    is_("the focus is where the next is chosen", focused(d), "input Scan B")
    one(d, ".slot.a .out").click()
    one(d, ".samples button", "twice").click()
    some("one person", d, ".verdict.ok p", "Strong: the shape speaks for")
    some("above the last knot", d, ".verdict p", "Fewer than 1 in")
    words = d.execute_async_script("""const done = arguments[0]; import("./console/verdict.js").then(({ decided }) => {
        const knots = [{ score: -100, rate: 1 }, { score: 10, rate: 1e-4 }];
        const r = { decision: "match", threshold: 8, disparity_mm: 0.3, overlap: 0.9, calibration: { knots } };
        done([[9, 2e-4], [10, 1e-4], [11, 1e-4], [20, 1e-4], [24, 1e-4]].map(([score, fmr_at_score]) => decided({ ...r, score, fmr_at_score }).textContent)
          .concat(decided({ ...r, score: 20, fmr_at_score: 1e-4, calibration: undefined }).textContent)); });""")
    for text, strength, how in zip(words, ("Marginal", "Marginal", "Marginal", "Clear", "Strong", "Clear"),
                                   ("About 1 in 5,000", "Fewer than 1 in 10,000", "Fewer than 1 in 10,000", "Fewer than 1 in 10,000", "Fewer than 1 in 10,000", "At most 1 in 10,000")):
        check("%s, %s" % (strength, how), strength in text and how in text, text)
    quiet("verdicts", d)


# ---- the report, and the picture

def pages_of(pdf):
    return pdf.count(b"/Type /Page") - pdf.count(b"/Type /Pages")


def printed(d):
    return base64.b64decode(d.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})["data"])


def test_report(d):
    unlock(d, ALL)
    one(d, ".samples button", "Two people").click()
    some("two people", d, ".verdict h2", "Different faces")
    d.execute_script("""for (const when of ["beforeprint", "afterprint"])
        addEventListener(when, () => window.sheet = document.querySelector(".paper")?.cloneNode(true) ?? window.sheet);""")
    pdf = printed(d)
    is_("one A4", [pages_of(pdf), b"/MediaBox [0 0 594.9" in pdf], [1, True])
    text = d.execute_script("return window.sheet.textContent")
    for part in ("Two scans compared", "one.ply", "other.ply", "Different faces", "What each region adds", "B lies at most", "surfaced/", "UTC", "What decided"):
        check("the report has %s" % part, part in text, text)
    is_("three pictures", d.execute_script("return window.sheet.querySelectorAll('canvas').length"), 3)
    request = re.search(r"Request([0-9a-f]{16})", text)
    check("and the request's id", request, text)
    with open(os.path.join(FOLDER, "log"), encoding="utf-8") as f:
        check("which the daemon's log has", request and request.group(1) in f.read())
    is_("nothing of it stays", d.find_elements(By.CSS_SELECTOR, ".paper"), [])
    # as a picture of it, to be looked at
    d.execute_script("dispatchEvent(new Event('beforeprint'))")
    d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    d.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": 703, "height": 1032, "deviceScaleFactor": 1, "mobile": False})
    still(d)
    drawn = pixels(d, d.find_element(By.CSS_SELECTOR, ".paper .shots"))
    check("A blue, B orange, and what decided", len({color_at(drawn, x, 0.4) for x in (0.16, 0.5, 0.83)}) == 3)
    d.save_screenshot(os.path.join(FOLDER, "report.png"))
    d.execute_script("dispatchEvent(new Event('afterprint'))")
    d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    look(d, 1280, True)
    one(d, "header button", "Picture").click()
    path = os.path.join(FOLDER, "picture.png")
    check("the picture is saved", wait(None, lambda _: os.path.getsize(path) > 0))
    size = d.execute_script("const c = document.querySelector('canvas'); return [2 * c.clientWidth, 2 * c.clientHeight]")
    with open(path, "rb") as f:
        width, height, data, depth = decoded(f.read())
    is_("twice as large, with transparency", [[width, height], depth, data[3]], [size, 4, 0])
    check("and opaque where there is a face", data[(height // 2 * width + width // 2) * 4 + 3] == 255)
    choose(d, "a", os.path.join(FOLDER, "bust.ply"))
    one(d, ".slot.b .out").click()
    some("one scan", d, ".verdict h2", "Good to enroll")
    is_("is one A4, too", pages_of(printed(d)), 1)
    check("with its figures", "Points on the face" in d.execute_script("return window.sheet.textContent"))
    long = os.path.join(FOLDER, "%s.ply" % ("a-name-that-is-long-" * 8))
    shutil.copy(os.path.join(FOLDER, "bust.ply"), long)
    choose(d, "a", long)
    some("a long name", d, ".slot.a", "a-name-that-is-long")
    some("of a good scan", d, ".verdict h2", "Good to enroll")
    is_("is one A4 as well", pages_of(printed(d)), 1)
    # a verification
    is_("somebody is enrolled", send("/v1/subjects/filed/templates", "a.ply"), 201)
    go(d, "people?subject=filed")
    one(d, "main button", "Verify a scan").click()
    one(d, "dialog h2", "Verify")
    d.find_element(By.CSS_SELECTOR, "dialog input[type=file]").send_keys(os.path.join(FOLDER, "a2.ply"))
    some("a scan to verify", d, "dialog .verdict h2", "Good to verify")
    one(d, "dialog [type=submit]").click()
    some("the decision", d, "dialog .verdict h2", "Same face")
    is_("a verification is one A4", pages_of(printed(d)), 1)
    d.execute_script("dispatchEvent(new Event('beforeprint'))")
    d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    d.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": 703, "height": 1032, "deviceScaleFactor": 1, "mobile": False})
    still(d)
    d.save_screenshot(os.path.join(FOLDER, "report-verification.png"))
    d.execute_script("dispatchEvent(new Event('afterprint'))")
    d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    look(d, 1280, True)
    text = d.execute_script("return window.sheet.textContent")
    for part in ("A verification of filed", "a2.ply", "Same face", "Template", "Request", "surfaced/", "B lies at most"):
        check("its report has %s" % part, part in text, text)
    press(d, Keys.ESCAPE)
    go(d, "try")
    some("Try again", d, ".samples button", "Two people")
    choose(d, "a", os.path.join(FOLDER, "bust.ply"))
    some("one scan once more", d, ".verdict h2", "Good to enroll")
    # dots outside the solid face alone
    one(d, ".poses button", "Front").click()
    still(d)
    drawn = pixels(d, d.find_element(By.TAG_NAME, "canvas"))
    face = [color_at(drawn, x / 100, y / 100) for x in range(44, 57) for y in range(40, 61)]
    check("no dot lies on the face", all(r > b for r, _, b in face), [c for c in face if c[0] <= c[2]][:5])
    one(d, ".slot.a .out").click()
    some("an empty page", d, ".samples button", "Two people")
    go(d, "people")
    one(d, "header button", "Enroll").click()
    d.find_element(By.CSS_SELECTOR, "dialog input[type=file]").send_keys(os.path.join(FOLDER, "a.ply"))
    some("a dialog with a scan", d, "dialog .verdict h2", "Good to enroll")
    one(d, "dialog .out").click()
    is_("is emptied, too", [gone(d, "dialog .verdict"), one(d, "dialog [type=submit]").is_enabled()], [True, False])
    press(d, Keys.ESCAPE)
    go(d, "identify")
    wait(d, lambda d: d.find_element(By.CSS_SELECTOR, ".slot input")).send_keys(os.path.join(FOLDER, "a.ply"))
    some("a search", d, ".verdict h2")
    one(d, ".slot .out").click()
    check("as well", gone(d, ".verdict"))
    go(d, "try")
    some("back again", d, ".samples button")
    is_("has no report", one(d, "header button", "Report").is_enabled(), False)
    quiet("the report", d)


def test_looks(d):
    unlock(d, ALL)
    for width in (1280, 360):
        look(d, width, True)
        go(d, "live")
        go(d, "try")
        one(d, ".samples button", "Two people" if width == 1280 else "twice").click()
        shown = one(d, ".verdict .gauge")
        check("at %d px the verdict comes %s the picture" % (width, "beside" if width > 500 else "before"),
              (shown.location["y"] < d.find_element(By.TAG_NAME, "canvas").location["y"]) == (width < 500))
        still(d)
        for dark in (True, False):
            look(d, width, dark)
            time.sleep(0.3)  # the canvas, and colours that fade
            title = "try-%d-%s" % (width, "dark" if dark else "light")
            contrast(title, d)
            is_(title + ": nothing is wider than the screen", d.execute_script("return document.documentElement.scrollWidth"), width)
            d.save_screenshot(os.path.join(FOLDER, title + ".png"))
    look(d, 1280, True)
    for _ in range(18):  # a browser has not so many contexts of WebGL
        go(d, "live")
        go(d, "try")
        one(d, "canvas")
    quiet("every size", d)


def test_frames(d):
    unlock(d, ALL)
    choose(d, "a", os.path.join(FOLDER, "dense.ply"))
    choose(d, "b", os.path.join(FOLDER, "dense2.ply"))
    some("two surfaces of 7,000 points", d, ".verdict h2", "face")
    within("a frame of two surfaces of 7,000 points", d.execute_script("""
        const c = document.querySelector("canvas"); let best = 1e9;
        for (let i = 0; i < 40; i++) best = Math.min(best, c.frameTime()); return best;"""), 33)
    one(d, ".stage button", "Section").click()
    still(d)
    within("a frame with a section that moves", d.execute_script("""
        const c = document.querySelector("canvas"); let best = 1e9;
        for (let i = 0; i < 40; i++) best = Math.min(best, c.cutTime(i, i - 20)); return best;"""), 33)


run(browser(), test_try, test_section, test_pins, test_verdict, test_report, test_looks, test_frames)
run(browser(webgl=False), test_no_webgl)
