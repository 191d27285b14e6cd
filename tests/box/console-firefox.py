"""The console in Firefox, against a running daemon: console-firefox.py URL FOLDER TOKEN (browser.py).  By Marionette,
Firefox's own protocol: Debian has no geckodriver."""
import base64
import json
import os
import re
import socket
import subprocess
import time
import zlib

from browser import ALL, FOLDER, ROOT, check, is_

PORT = int(os.environ["MARIONETTE_PORT"])
PREFS = {"marionette.port": PORT, "webgl.force-enabled": True, "gfx.x11-egl.force-enabled": True,
         "app.normandy.enabled": False, "datareporting.policy.dataSubmissionEnabled": False,
         "browser.startup.page": 0, "network.captive-portal-service.enabled": False}
PAGES = {"try": "Compare", "identify": "", "live": "Live", "people": "People", "audit": "Audit", "health": ""}


class Firefox:
    def __init__(self):
        profile = FOLDER + "/firefox"
        os.makedirs(profile)
        with open(profile + "/user.js", "w", encoding="utf-8") as f:
            f.writelines("user_pref(%s, %s);\n" % (json.dumps(k), json.dumps(v)) for k, v in PREFS.items())
        # In a window that nobody sees WebGL draws by Mesa's software, if it is told to.  Firefox has an SQLite too,
        # which is not to be recorded as the store's.
        env = dict(os.environ, MOZ_WEBGL_FORCE_EGL="1", LIBGL_ALWAYS_SOFTWARE="1")
        env.pop("RECORD_STATEMENTS", None)
        self.process = subprocess.Popen(
            ["firefox-esr", "--headless", "--marionette", "--remote-allow-system-access", "--no-remote",
             "--window-size=1280,860", "--profile", profile],
            env=env,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.last = 0
        self.socket = self.connect()
        self.receive()  # a greeting
        self.ask("WebDriver:NewSession")

    @staticmethod
    def connect():
        end = time.monotonic() + 60
        while True:
            try:
                return socket.create_connection(("127.0.0.1", PORT))
            except OSError:
                if time.monotonic() > end:
                    raise
                time.sleep(0.1)

    def receive(self):
        """A message: its length, a colon, JSON."""
        length, data = b"", b""
        while not length.endswith(b":"):
            length += self.socket.recv(1) or self.closed()
        while len(data) < int(length[:-1]):
            data += self.socket.recv(int(length[:-1]) - len(data)) or self.closed()
        return json.loads(data)

    @staticmethod
    def closed():
        raise ConnectionError("Firefox has closed the connection")

    def ask(self, command, **arguments):
        self.last += 1
        message = json.dumps([0, self.last, command, arguments]).encode()
        self.socket.sendall(b"%d:" % len(message) + message)
        _, _, error, result = self.receive()
        if error:
            raise RuntimeError("%s: %s" % (command, error["message"]))
        return result

    def run(self, script, *arguments):
        return self.ask("WebDriver:ExecuteScript", script=script, args=list(arguments))["value"]

    def wait(self, script, *arguments, seconds=40):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            found = self.run(script, *arguments)
            if found:
                return found
            time.sleep(0.1)
        return None

    def picture(self, name):
        with open("%s/%s.png" % (FOLDER, name), "wb") as f:
            f.write(base64.b64decode(self.ask("WebDriver:TakeScreenshot", full=False)["value"]))

    def messages(self, where=ROOT):
        """Errors of our pages, and all that their policy has refused."""
        self.ask("Marionette:SetContext", value="chrome")
        lines = self.run("return Services.console.getMessageArray().map(String)")
        self.ask("Marionette:SetContext", value="content")
        return [line for line in lines if where in line and (
            "Error:" in line or "JavaScript Error" in line or "Content-Security-Policy" in line)]


def text(firefox, selector, part):
    return firefox.wait("""return [...document.querySelectorAll(arguments[0])].map((e) => e.textContent)
                               .find((t) => t.includes(arguments[1])) ?? null""", selector, part)


def section(firefox, title):
    """A section follows a drag over the face."""
    firefox.run("[...document.querySelectorAll('.stage button')].find((b) => b.textContent === 'Section').click()")
    first = text(firefox, ".section .said", "B lies at most")
    x, y = firefox.run("const b = document.querySelector('canvas').getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2].map(Math.round)")
    firefox.ask("WebDriver:PerformActions", actions=[{"type": "pointer", "id": "mouse", "actions": [
        {"type": "pointerMove", "x": x - 90, "y": y - 30}, {"type": "pointerDown", "button": 0},
        {"type": "pointerMove", "x": x, "y": y - 10, "duration": 50}, {"type": "pointerMove", "x": x + 90, "y": y - 20, "duration": 50},
        {"type": "pointerUp", "button": 0}]}])
    check("%s: a section that follows a drag" % title, first and firefox.wait("""
        const t = document.querySelector(".section .said").textContent; return t !== arguments[0] && t.startsWith("B lies at most")""", first))


def objects(pdf):
    """The file with what is packed in it."""
    packed = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.S)
    return pdf + b"".join(zlib.decompressobj().decompress(data) for data in packed if data[:1] == b"x")


def report(firefox, title):
    """The report is one A4; returns its file."""
    pdf = base64.b64decode(firefox.ask("WebDriver:Print", page={"width": 21.0, "height": 29.7}, background=True)["value"])
    path = "%s/firefox-%s.pdf" % (FOLDER, title)
    with open(path, "wb") as f:
        f.write(pdf)
    whole = objects(pdf)
    is_("%s: on paper one page" % title, len(re.findall(rb"/Type\s*/Page\b", whole)), 1)
    size = re.search(rb"/MediaBox\s*\[\s*0 0 ([0-9.]+) ([0-9.]+)", whole)
    check("%s: an A4" % title, size and [round(float(n)) for n in size.groups()] in ([595, 842], [596, 842]), size and size.group(0))
    check("%s: with pictures" % title, len(re.findall(rb"/Subtype\s*/Image", whole)) >= 3, len(whole))
    return path


def main():
    firefox = Firefox()
    firefox.ask("WebDriver:Navigate", url=ROOT + "console")
    firefox.wait("return document.querySelector('#token') !== null")
    field = firefox.ask("WebDriver:FindElement", using="css selector", value="#token")["value"]
    firefox.ask("WebDriver:ElementSendKeys", id=next(iter(field.values())), text=ALL + "\ue007")
    check("a token unlocks", firefox.wait("return document.querySelector('aside') !== null"))
    for page, title in PAGES.items():
        firefox.run("location.hash = arguments[0]", page)
        check("the page %s" % page, text(firefox, "main h1", title) is not None)
    firefox.run("location.hash = 'try'")
    text(firefox, ".samples button", "Two people")
    firefox.run("[...document.querySelectorAll('.samples button')].find((b) => b.textContent.includes('Two people')).click()")
    check("two people are compared", text(firefox, ".verdict h2", "Different faces"))
    check("by a picture", firefox.wait("""
        const c = document.querySelector("canvas");
        return c !== null && c.width > 100 && c.getContext("webgl2") !== null"""))
    section(firefox, "two people")
    firefox.picture("firefox-try")
    report(firefox, "report")
    is_("no error, and nothing that the policy refused", firefox.messages(), [])
    firefox.run("[...document.querySelectorAll('aside button')].find((b) => b.textContent.includes('Lock')).click()")
    check("locked again", firefox.wait("return document.querySelector('#token') !== null"))
    page = "file://%s/explanation/explain.html" % FOLDER
    firefox.ask("WebDriver:Navigate", url=page)
    check("the page of a file", text(firefox, ".verdict h2", "Different faces"))
    section(firefox, "of a file")
    firefox.picture("firefox-page")
    is_("no error there", firefox.messages(page), [])
    firefox.ask("WebDriver:Navigate", url="file://" + report(firefox, "file-report"))
    check("as Firefox shows it", text(firefox, ".textLayer span", "other.ply"))
    firefox.picture("firefox-file-report")
    firefox.process.terminate()
    firefox.process.wait()


main()
