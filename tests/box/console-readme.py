"""The picture of README, from the live console: two faces of the samples, the map, the verdict and the section,
each as the console draws it, on one sheet, dark and light."""
import base64
import os

from browser import (ALL, FOLDER, By, browser, check, is_, look, one, run, some, still, unlock)

WIDTH = 880  # of the sheet, as wide as README is shown

SHEET = """
const [shots, said, dark] = arguments;
const line = dark ? "#252b34" : "#dfe3e9", dim = dark ? "#98a2b0" : "#5a6573";
document.body.style.cssText = `margin:0;width:880px;padding:12px;box-sizing:border-box;display:grid;gap:12px;align-content:start;
  grid-template-columns:336px 1fr 278px;background:${dark ? "#0c0e12" : "#f4f5f7"};font:14px/20px system-ui,sans-serif;color:${dim}`;
const put = (columns, name, text) => {
  const box = document.createElement("figure"), img = new Image(), note = document.createElement("figcaption");
  box.style.cssText = `margin:0;grid-column:${columns};border-radius:10px;overflow:hidden;
    background:${dark ? "#13161b" : "#fff"};${text ? `border:1px solid ${line}` : ""}`;
  img.src = `data:image/png;base64,${shots[name]}`;
  img.style.cssText = "width:100%;display:block";
  note.textContent = text;
  note.style.cssText = text && "padding:6px 16px 8px;font-size:13px";
  box.append(img, note);
  document.body.append(box);
};
put("1 / 3", "faces", "Two scans, A and B");
put("3 / 4", "map", "Blue for one person, orange against");
put("1 / 2", "verdict", "");
put("2 / 4", "section", said);
return Promise.all([...document.images].map((i) => i.decode())).then(() => document.body.lastChild.getBoundingClientRect().bottom + 12);
"""


def box_of(d, selector):
    return d.execute_script("""const b = document.querySelector(arguments[0]).getBoundingClientRect();
        return {x: b.x + scrollX, y: b.y + scrollY, width: b.width, height: b.height}""", selector)


def shot(d, clip, **format_):
    return d.execute_cdp_cmd("Page.captureScreenshot", {"format": "png", **format_, "clip": {**clip, "scale": 1}})["data"]


def sized(d, width, height, dark):
    look(d, width, dark)
    d.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": height, "deviceScaleFactor": 2, "mobile": False})
    still(d)


def press(d, text):
    one(d, ".stage button", text).click()
    still(d)


def hide(d, selector):
    d.execute_script("document.querySelectorAll(arguments[0]).forEach((e) => { e.style.visibility = 'hidden'; })", selector)


def part(clip, left, top, width, height):
    return {"x": clip["x"] + left * clip["width"], "y": clip["y"] + top * clip["height"],
            "width": width * clip["width"], "height": height * clip["height"]}


def sheet(d, dark):
    sized(d, 1280, 860, dark)
    unlock(d, ALL)
    one(d, ".samples button", "Two people").click()
    some("two people", d, ".verdict h2", "Different faces")
    shots = {}
    press(d, "A and B")
    shots["faces"] = shot(d, part(box_of(d, ".scene"), 0, 0.12, 1, 0.76))
    hide(d, ".legend")
    press(d, "What decided")
    shots["map"] = shot(d, part(box_of(d, ".scene"), 0.195, 0, 0.64, 1))
    shots["verdict"] = shot(d, box_of(d, ".verdict"))
    press(d, "Section")
    hide(d, ".section input, .section label")
    shots["section"] = shot(d, part(box_of(d, ".section svg"), 0.12, 0, 0.745, 1))
    said = one(d, ".section .said").text
    d.get("about:blank")
    height = d.execute_script(SHEET, shots, said, dark)
    name = "readme-%s" % ("dark" if dark else "light")
    clip = {"x": 0, "y": 0, "width": WIDTH, "height": height}
    with open(os.path.join(FOLDER, name + ".png"), "wb") as f:
        f.write(base64.b64decode(shot(d, clip, captureBeyondViewport=True)))
    small = base64.b64decode(shot(d, clip, format="webp", quality=75, captureBeyondViewport=True))
    with open(os.path.join(FOLDER, name + ".webp"), "wb") as f:
        f.write(small)
    check("%s is small" % name, len(small) <= 150000, len(small))


def test_sheets(d):
    for dark in (True, False):
        sheet(d, dark)


run(browser(), test_sheets)
