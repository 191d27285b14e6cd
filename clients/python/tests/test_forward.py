"""The events, and the forwarder against receivers that misbehave; daemons as in test_client."""

import contextlib
import http.server
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from surfaced import Client
from surfaced.forward import Cursor, sign, verify
from test_client import Served, daemon, new_token

SECRET = "collector's secret"


class Collector(http.server.ThreadingHTTPServer):
    """Keeps what it takes.  plan: what it does with the first requests: a status, "cut", "slow"; then 204."""

    def __init__(self, plan=(), port=0):
        super().__init__(("127.0.0.1", port), Collecting)
        self.plan, self.got, self.headers, self.seen = list(plan), [], [], 0
        self.url = f"http://127.0.0.1:{self.server_port}/events?site=1"
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def stop(self):
        self.shutdown()
        self.server_close()


class Collecting(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.server.seen += 1
        then = self.server.plan.pop(0) if self.server.plan else 204
        if then == "cut":
            self.close_connection = True
            return
        if then == "slow":
            time.sleep(2)
            then = 204
        if 200 <= then < 300:
            self.server.got.append(json.loads(body))
            self.server.headers.append((self.headers, body))
        self.send_response(then)
        if then == 302:
            self.send_header("Location", "/elsewhere")
        self.send_header("Content-Length", "0")
        self.end_headers()

    def log_message(self, *_):
        pass


class TestForward(Served):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.url = cls.stack.enter_context(daemon(cls.folder))
        cls.client = cls.stack.enter_context(Client(cls.url, cls.token))
        cls.events = new_token(cls.folder, "events", "events")
        with open(cls.path("secret"), "w") as file:
            file.write(SECRET + "\n")
        with open(cls.path("token"), "w") as file:
            file.write(cls.events + "\n")
        with open(cls.path("wrong"), "w") as file:
            file.write("f" * 64 + "\n")

    def setUp(self):
        self.here = contextlib.ExitStack()
        self.addCleanup(self.here.close)
        self.cursor = self.path(f"cursor-{self.id()}")

    def collector(self, *plan, port=0):
        collector = Collector(plan, port)
        self.here.callback(collector.stop)
        return collector

    def forward(self, to, *options):
        # A proxy that would take it, were it asked.
        process = subprocess.Popen(
            [sys.executable, "-m", "surfaced.forward", "--to", to, "--url", self.url, "--cursor", self.cursor,
             "--token-file", self.path("token"), *options], stderr=subprocess.PIPE, text=True,
            env={**os.environ, "http_proxy": "http://127.0.0.1:1", "HTTP_PROXY": "http://127.0.0.1:1", "no_proxy": ""})
        self.here.callback(process.communicate)
        self.here.callback(process.kill)
        return process

    def until(self, true, seconds=30):
        end = time.monotonic() + seconds
        while not true():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)

    def change(self, n):
        """n events of a subject of its own; their types."""
        subject = f"s{time.monotonic_ns()}"
        self.client.add_subject(subject)
        for i in range(n - 1):
            self.client.change_subject(subject, disabled=i % 2 == 0)
        return [(subject, "subject_added")] + [
            (subject, "subject_disabled" if i % 2 == 0 else "subject_enabled") for i in range(n - 1)]

    def told(self, collector):
        return [(event["subject"], event["type"]) for event in collector.got]

    def test_events(self):
        with Client(self.url, self.events) as client:
            stream = client.events("0-0")
            first = next(stream)
            wanted = self.change(5)
            got = [first]
            while [(e["subject"], e["type"]) for e in got][-5:] != wanted:
                got.append(next(stream))
            self.assertEqual([next(client.events(got[i]["cursor"])) for i in range(len(got) - 1)], got[1:])
            again = client.events(last=2)
            self.assertEqual([next(again), next(again)], got[-2:])
            self.refused(410, "cursor_unknown", next, client.events("999999-0"))
            self.refused(400, "invalid_parameter", next, client.events("tomorrow"))
        self.refused(401, "unauthorized", next, Client(self.url, "f" * 64).events())

    def test_daemon_gone(self):
        """A stream over a daemon that is stopped and started again."""
        got = []
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(tempfile.TemporaryDirectory())
            subprocess.run([os.path.join(os.environ["BUILD"], "surfacectl"), "--db", os.path.join(folder, "faces.db"),
                            "init"], check=True, capture_output=True)
            token = new_token(folder, "all")
            with daemon(folder) as url, Client(url, token) as client:
                stream = client.events()
                threading.Thread(target=lambda: got.extend(iter(lambda: next(stream), None)), daemon=True).start()
                self.until(lambda: "surfaced_event_streams 1\n" in client.request("GET", "/metrics").decode())
                client.add_subject("one")
                self.until(lambda: len(got) == 1)
            with daemon(folder, listen=url.removeprefix("http://")), Client(url, token, retries=10) as client:
                client.add_subject("two")
                self.until(lambda: len(got) == 2)
        self.assertEqual([e["subject"] for e in got], ["one", "two"])

    def test_each_once(self):
        collector = self.collector(500, "cut", 302, 404, 503)
        self.forward(collector.url, "--secret-file", self.path("secret"))
        self.until(lambda: os.path.exists(self.cursor))
        wanted = self.change(7)
        self.until(lambda: len(collector.got) == 7)
        self.assertEqual(self.told(collector), wanted)
        self.assertEqual(collector.seen, 5 + 7)
        for headers, body in collector.headers:
            self.assertTrue(verify(SECRET.encode(), body, headers["Surfaced-Signature"]))
            self.assertFalse(verify(b"another", body, headers["Surfaced-Signature"]))
            self.assertEqual(headers["Content-Type"], "application/json")
            self.assertNotIn("Authorization", headers)
        self.until(lambda: Cursor(self.cursor).value == collector.got[-1]["cursor"])
        self.assertEqual(os.stat(self.cursor).st_mode & 0o777, 0o600)

    def test_killed(self):
        """Nothing is lost where either end is killed; what was taken and not yet noted comes again."""
        collector = self.collector()
        forwarder = self.forward(collector.url)
        self.until(lambda: os.path.exists(self.cursor))
        wanted = self.change(3)
        self.until(lambda: len(collector.got) == 3)
        forwarder.kill()
        forwarder.wait()
        wanted += self.change(3)
        port = collector.server_port
        collector.stop()
        before = collector.got
        forwarder = self.forward(collector.url)
        time.sleep(1)
        wanted += self.change(2)
        collector = Collector(["slow"], port)
        try:
            self.until(lambda: len(collector.got) >= 5)
            forwarder.kill()
            forwarder.wait()
            self.forward(collector.url)
            wanted += self.change(1)
            self.until(lambda: self.told(collector)[-1] == wanted[-1])
            everything = before + collector.got
            unique = {event["cursor"]: event for event in everything}
            self.assertEqual([(e["subject"], e["type"]) for e in unique.values()], wanted)
            self.assertLessEqual(len(everything), len(wanted) + 2)
        finally:
            collector.stop()

    def test_all(self):
        collector = self.collector()
        self.change(2)
        self.forward(collector.url, "--all")
        wanted = []
        for event in self.client.events("0-0"):
            wanted.append(event)
            if len(wanted) == 2:
                break
        self.until(lambda: len(collector.got) >= 2)
        self.assertEqual(collector.got[:2], wanted)

    def test_refused(self):
        for options, cursor, message in (
                (("--token-file", self.path("wrong")), None, "401 unauthorized"),
                ((), "999999-0", "410 cursor_unknown"),
                (("--secret-file", self.path("none")), None, "No such file"),
                (("--to", "ftp://x/"), None, "not an address")):
            if cursor:
                Cursor(self.cursor).write(cursor)
            process = self.forward("http://127.0.0.1:1/", *options)
            _, said = process.communicate(timeout=30)
            self.assertEqual((process.returncode, message in said), (2, True), said)
            self.assertNotIn(SECRET, said.replace(self.path("secret"), ""))

    def test_signature(self):
        now = int(time.time())
        good = sign(b"s", b"{}", now)
        self.assertRegex(good, r"^t=\d+,v1=[0-9a-f]{64}$")
        self.assertTrue(verify(b"s", b"{}", good))
        for bad in ("", "t=", "v1=" + good[-64:], good.replace("v1=", "v0="), good[:-1], good + "0", f"t={now}",
                    sign(b"s", b"{ }", now), sign(b"x", b"{}", now), sign(b"s", b"{}", now - 400), "t=é,v1=é",
                    "t=-1,v1=" + good[-64:], "t=" + "9" * 99 + ",v1=" + good[-64:]):
            self.assertFalse(verify(b"s", b"{}", bad), bad)


if __name__ == "__main__":
    unittest.main()
