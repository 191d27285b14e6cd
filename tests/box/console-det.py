"""The error trade-off on the page of the calibration, in a real browser: see browser.py.  The last argument is the
command for the daemon's database."""
import os
import subprocess
import sys

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import *

COMMAND = sys.argv[4].split()
PAGE = "health?tab=calibration"


def ctl(*arguments):
    subprocess.run(COMMAND + list(arguments), check=True, stdout=subprocess.DEVNULL)


def percent(rate):
    return "%g %%" % float("%.2g" % (100 * rate))


def test_none(d):
    """Why there is no curve."""
    unlock(d, ALL, PAGE)
    some("the shipped one has no scores of one person", d, "section.card p", "The shipped model keeps no scores of one person's scans")
    ctl("calibrate", "--fmr", "0.05", "--yes")
    press(d, Keys.F5)
    some("with too few people it says how many there are", d, "section.card p", "Only 29 of the people who were compared have two templates or more; 30 are needed.")
    is_("and draws nothing", d.find_elements(By.CSS_SELECTOR, ".chart .unknown"), [])
    quiet("none", d)


def test_curve(d):
    ctl("enroll", "p1", os.path.join(FOLDER, "foreign.ply"), "--force")
    ctl("calibrate", "--fmr", "0.05", "--yes")
    det = api("GET", "/v1/stats")[1]["calibration"]["det"]
    unlock(d, ALL, PAGE)
    some("the rate at the threshold, with its interval", d, ".key.own", "%s (%s to %s)" % tuple(percent(det["own"][k]) for k in ("fnmr", "low", "high")))
    some("and at the shipped one", d, ".key.ring", percent(det["shipped"]["fnmr"]))
    some("that scans at a door are worse", d, "section p", "scans at a door are refused more often")
    points = d.execute_script("""return document.querySelector('.chart:has(.unknown) .curve').getAttribute('points').split(' ').map((p) => p.split(',').map(Number))""")
    is_("a point each", len(points), len(det["points"]))
    check("fewer others match to the left", all(a[0] > b[0] for a, b in zip(points, points[1:])), points)
    check("where more of the own are refused", all(a[1] >= b[1] for a, b in zip(points, points[1:])), points)
    # normal deviates: from 50 to 20 % it is 0.8416 of them, from 20 to 10 % 0.4399
    check("on axes of normal deviates", abs((points[0][0] - points[1][0]) / (points[1][0] - points[2][0]) - 0.8416 / 0.4399) < 0.01, points)
    band = d.execute_script("const b = document.querySelector('.chart .band').getBBox(); return [b.y, b.y + b.height]")
    check("the band is about the curve", band[0] < min(p[1] for p in points) and max(p[1] for p in points) <= band[1] + 0.1, band)
    check("the chart is told to who cannot see it", percent(det["own"]["fnmr"]) in d.find_element(By.CSS_SELECTOR, ".chart:has(.unknown)").get_attribute("aria-label"))
    summary = [e for e in d.find_elements(By.CSS_SELECTOR, "section:has(.unknown) summary")][0]
    summary.send_keys(Keys.ENTER)
    is_("a row each in the table", len(d.find_elements(By.CSS_SELECTOR, "section:has(.unknown) tbody tr")), len(det["points"]) + 2)
    some("with its numbers", d, "section:has(.unknown) tbody tr", "%s to %s" % (percent(det["points"][-1]["low"]), percent(det["points"][-1]["high"])))
    for width in (1280, 360):
        for dark in (True, False):
            look(d, width, dark)
            go(d, "try")
            go(d, PAGE)
            chart = one(d, ".chart:has(.unknown)")
            d.execute_script("const s = arguments[0].closest('section'); s.querySelector('details').open = true; s.scrollIntoView()", chart)
            title = "det-%d-%s" % (width, "dark" if dark else "light")
            is_(title + ": nothing is wider than the screen", d.execute_script("return document.documentElement.scrollWidth"), width)
            contrast(title, d)
            d.save_screenshot(os.path.join(FOLDER, title + ".png"))
    look(d, 703, False)
    d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    contrast("on paper", d)
    d.save_screenshot(os.path.join(FOLDER, "det-print.png"))
    d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    look(d, 1280, True)
    quiet("the curve", d)


run(browser(), test_none, test_curve)
