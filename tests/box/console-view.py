"""The console's viewer in a real browser, against a running daemon: console-view.py URL FOLDER TOKEN (browser.py)."""
import os
import time

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import (ALL, FOLDER, browser, check, choose, color_at, contrast, difference, go, is_, look, one,
                     pixels, quiet, run, some, still, token, unlock, within)


def test_no_webgl(d):
    unlock(d, ALL)
    some("without WebGL", d, ".samples button", "Two people").click()
    some("the decision", d, ".verdict h2", "Different faces")
    some("and why there is no picture", d, ".about", "WebGL2")
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
    # one scan, by a token that may enroll alone
    unlock(d, token("desk", ["enroll"])["secret"])
    is_("no samples to compare", d.find_elements(By.CSS_SELECTOR, ".samples"), [])
    choose(d, "a", os.path.join(FOLDER, "bust.ply"))
    some("one scan", d, ".verdict h2", "Good to enroll")
    some("its face", d, ".facts", "Points on the face")
    quiet("Try", d)


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


run(browser(), test_try, test_looks, test_frames)
run(browser(webgl=False), test_no_webgl)
