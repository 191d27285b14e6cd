"""Pages of another site against a daemon without tokens, in a real browser: site.py URL FOLDER.

FOLDER is served as http://attacker.example, which the browser is told means this machine; so are its
other names.  a.ply in it is enrolled, if that works.  Prints a line for each check; http-site.sh counts
them."""
import functools
import http.server
import sys
import threading

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

URL, FOLDER = sys.argv[1:3]
PORT = URL.rsplit(":", 1)[1]


def check(title, holds, got=""):
    print("%s %s%s" % ("ok" if holds else "FAIL", title, "" if holds else ": %s" % (got,)), flush=True)


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *args):
        pass


def browser():
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage",
                     "--host-resolver-rules=MAP *.example 127.0.0.1",
                     # older rules of the browser's own would stop some of it before the daemon does
                     "--disable-features=BlockInsecurePrivateNetworkRequests,PrivateNetworkAccessSendPreflights,LocalNetworkAccessChecks"):
        options.add_argument(argument)
    return webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))


# What is sent and whether it arrived is seen in the response's status; 0: the page may not read it.
FETCH = """
const [url, options, done] = arguments;
(async () => {
  const scan = await (await fetch("/a.ply").catch(() => new Response(new Blob([])))).blob();
  if (options.body === "scan") options.body = scan;
  if (options.body === "form") { options.body = new FormData(); options.body.append("f", scan, "a.ply"); }
  const r = await fetch(url, options);
  done([r.status, await r.text()]);
})().catch((e) => done([-1, String(e)]));
"""


def send(driver, path, **options):
    return driver.execute_async_script(FETCH, path, options)


def main():
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=FOLDER))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    d = browser()
    d.set_script_timeout(20)
    # by a name of its own: the browser sees one site, and lets the page read everything
    d.get("http://attacker.example:%s/docs" % PORT)
    for title, path, options in (("list", "/v1/subjects", {}),
                                 ("enrol", "/v1/subjects/evil/templates", {"method": "POST", "body": "scan"}),
                                 ("make a token", "/v1/tokens", {"method": "POST", "body": '{"name":"x","scopes":["verify"]}',
                                                                  "headers": {"Content-Type": "application/json"}})):
        status, text = send(d, path, **options)
        check("rebinding: " + title, status == 403 and "other_site" in text, (status, text))
    # from another site: what takes no preflight is sent, and the page may not read the response
    d.get("http://attacker.example:%d/" % server.server_port)
    for title, path, options in (("a form", "/v1/subjects/evil/templates", {"body": "form"}),
                                 ("a form by force", "/v1/subjects/alice/templates?force=true", {"body": "form"}),
                                 ("text", "/v1/subjects/evil/templates", {"body": "scan"}),
                                 ("the log", "/v1/audit/verify", {})):
        status, text = send(d, URL + path, method="POST", mode="no-cors", **options)
        check("another site: %s, not read" % title, status == 0, (status, text))
    # the console's own page
    d.get(URL + "/docs")
    status, text = send(d, "/v1/subjects")
    check("its own page lists", status == 200, (status, text))
    status, text = send(d, "/v1/subjects", method="POST", body='{"subject":"alice"}', headers={"Content-Type": "application/json"})
    check("and posts", status == 409, (status, text))
    d.quit()


main()
