"""The client against daemons of its own, and against servers that misbehave.

BUILD names the folder of surfaced, surfacectl and facegen; run by tests/box/client-python.sh."""

import contextlib
import http.server
import importlib.resources
import json
import logging
import os
import re
import socket
import subprocess
import tempfile
import threading
import time
import typing
import unittest

import surfaced
from surfaced import Capture, Client, SurfacedError, enroll_folder, types

BUILD = os.path.abspath(os.environ["BUILD"])
ALL = "verify,enroll,identify,read,delete,manage,tokens,audit,events,score,detail"


def run(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout


@contextlib.contextmanager
def daemon(folder, *options, listen="127.0.0.1:0"):
    """Serves folder/faces.db; yields the address."""
    with open(os.path.join(folder, "log"), "w") as log:
        process = subprocess.Popen([os.path.join(BUILD, "surfaced"), "--db", os.path.join(folder, "faces.db"),
                                    "--listen", listen, *options], stderr=log)
    try:
        for _ in range(300):
            with open(log.name) as lines:
                found = re.search(r'listening on ([^"\s]+)', lines.read())
            if found:
                break
            time.sleep(0.1)
        yield found[1]
    finally:
        process.terminate()
        process.wait()


def new_token(folder, name, scope=ALL):
    return run(os.path.join(BUILD, "surfacectl"), "--db", os.path.join(folder, "faces.db"),
               "token", "create", name, "--scope", scope).strip()


def key(path):
    run("openssl", "genpkey", "-algorithm", "ed25519", "-out", path)


class Served(unittest.TestCase):
    """One daemon for all tests of a class."""

    @classmethod
    def setUpClass(cls):
        cls.stack = contextlib.ExitStack()
        cls.addClassCleanup(cls.stack.close)
        cls.folder = cls.stack.enter_context(tempfile.TemporaryDirectory())
        run(os.path.join(BUILD, "surfacectl"), "--db", cls.path("faces.db"), "init")
        for name, subject, scan in (("a1.ply", 1, 0), ("a2.ply", 1, 1), ("a3.ply", 1, 2), ("b1.ply", 2, 0), ("a1.json", 1, 0)):
            run(os.path.join(BUILD, "facegen"), "--subject", str(subject), "--scan", str(scan), "-o", cls.path(name))
        cls.token = new_token(cls.folder, "test")

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    def refused(self, status, code, call, *arguments, **named):
        with self.assertRaises(SurfacedError) as caught:
            call(*arguments, **named)
        self.assertEqual((caught.exception.status, caught.exception.code), (status, code))
        self.assertTrue(caught.exception.detail)
        return caught.exception


class TestRequests(Served):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.url = cls.stack.enter_context(daemon(cls.folder))
        cls.client = cls.stack.enter_context(Client(cls.url, cls.token))

    def test_subject(self):
        client, a1, a2, b1 = self.client, self.path("a1.ply"), self.path("a2.ply"), self.path("b1.ply")
        check = client.check(a1)
        self.assertTrue(check["usable"] and check["enrollable"])
        template = client.enroll("alice@example:1", a1, label="first")
        self.assertEqual((template["subject"], template["label"]), ("alice@example:1", "first"))
        with open(a1, "rb") as file:  # its bytes are the same scan
            self.assertEqual(client.enroll("alice@example:1", file.read())["template_id"], template["template_id"])
        verdict = client.verify("alice@example:1", a2)
        self.assertEqual((verdict["decision"], verdict["template_id"]), ("match", template["template_id"]))
        self.assertGreaterEqual(verdict["score"], verdict["threshold"])
        self.assertNotIn("regions", verdict)
        self.assertIn("regions", client.verify("alice@example:1", a2, detail="measure"))
        self.assertEqual(client.verify("alice@example:1", a2, detail="surface")[:4], b"glTF")
        self.assertEqual(client.verify_template(template["template_id"], b1)["decision"], "no_match")
        self.assertEqual(client.show_template(template["template_id"])["digest"], template["digest"])
        self.assertEqual(client.show_surface(template["template_id"], format="ply")[:3], b"ply")
        self.assertEqual(client.change_subject("alice@example:1", consent="C-17", hold=True)["consent"], "C-17")
        self.refused(409, "on_hold", client.erase_subject, "alice@example:1")
        client.change_subject("alice@example:1", consent=None, hold=False)
        self.assertIsNone(client.show_subject("alice@example:1")["consent"])
        self.refused(409, "sample_mismatch", client.enroll, "alice@example:1", b1)
        second = client.enroll("alice@example:1", b1, force=True)
        pairs = client.compare_templates("alice@example:1")
        self.assertEqual([t["fits"] for t in pairs["templates"]], [False, False])
        self.assertEqual([(p["b"], p["decision"]) for p in pairs["pairs"]], [(second["template_id"], "no_match")])
        client.delete_template(second["template_id"])
        self.refused(404, "not_found", client.show_template, second["template_id"])
        receipt = client.erase_subject("alice@example:1")
        self.assertEqual((receipt["subject"], receipt["template_ids"]), ("alice@example:1", [template["template_id"]]))
        with open(self.path("receipt.json"), "w") as file:
            json.dump(receipt, file)
        run(os.path.join(BUILD, "surfacectl"), "audit", "verify", self.path("receipt.json"),
            "--public-key", receipt["public_key"])
        self.refused(404, "not_found", client.show_subject, "alice@example:1")

    def test_scans(self):
        with open(self.path("a1.json")) as file:
            points = json.load(file)["points"]
        self.assertEqual(self.client.check(points, units="mm")["scan"]["format"], "json")
        self.assertEqual(self.client.check(tuple(map(tuple, points)))["scan"]["units"], "mm")
        verdict = self.client.compare(points, self.path("a2.ply"), detail="heatmap")
        self.assertEqual(verdict["decision"], "match")
        self.assertEqual(verdict["scan"]["a"]["format"], "json")
        self.assertIn("heatmap", verdict)
        self.assertEqual(self.client.compare(self.path("a1.ply"), self.path("b1.ply"), detail="surface")[:4], b"glTF")
        self.assertEqual(self.client.check(self.path("a1.ply"), detail="surface")[:4], b"glTF")
        self.assertTrue(self.client.asymmetry(self.path("a1.ply"))["conclusive"])
        error = self.refused(422, "too_few_points", self.client.compare, points[:3], points)
        self.assertIn("3 points", error.detail)
        self.refused(400, "malformed", self.client.compare, b"no scan", points)
        self.refused(400, "invalid_parameter", self.client.check, points, unit="mm")
        with self.assertRaises(FileNotFoundError):
            self.client.check(self.path("none.ply"))

    def test_name_of_a_file_is_not_the_forms(self):
        hostile = self.path('a"; name="b\r\n\r\n.ply')
        os.link(self.path("a1.ply"), hostile)
        self.assertEqual(self.client.compare(hostile, self.path("a2.ply"))["decision"], "match")

    def test_burst(self):
        burst = self.client.enroll_each("burst", self.path("a1.ply"), self.path("b1.ply"), self.path("a2.ply"))
        self.assertEqual([f["file"] for f in burst["templates"]], ["a1.ply", "b1.ply", "a2.ply"])
        self.assertEqual([f["new"] for f in burst["templates"]], [True, False, True])
        self.assertEqual(burst["templates"][1]["refusal"]["code"], "sample_mismatch")
        self.client.erase_subject("burst")

    def test_frames(self):
        made = self.client.enroll("frames", self.path("a1.ply"), self.path("a2.ply"))
        self.assertEqual([f["used"] for f in made["frames"]], [True, True])
        with self.assertRaises(SurfacedError) as raised:
            self.client.verify("frames", self.path("a1.ply"), self.path("b1.ply"))
        self.assertEqual(raised.exception.code, "several_people")
        self.client.erase_subject("frames")

    def test_identify(self):
        self.assertEqual(self.client.identify(self.path("a2.ply"), group="door-9")["searched"], 0)
        self.client.add_subject("ida", groups=["door-9"])
        self.client.enroll("ida", self.path("a1.ply"))
        found = self.client.identify(self.path("a2.ply"), group="door-9", candidates=3)
        self.assertEqual((found["decision"], found["subject"], found["searched"]), ("match", "ida", 1))
        self.assertEqual([(c["subject"], c["score"]) for c in found["candidates"]], [("ida", found["score"])])
        frames = self.client.identify(self.path("a2.ply"), self.path("a3.ply"), group="door-9")["frames"]
        self.assertEqual([f["used"] for f in frames], [True, True])
        with Client(self.url, new_token(self.folder, "hall", "identify")) as hall:
            nobody = hall.identify(self.path("b1.ply"), group="door-9")
            self.assertEqual((nobody["decision"], nobody["subject"]), ("no_match", None))
            self.assertNotIn("score", nobody)
            self.refused(403, "insufficient_scope", hall.identify, self.path("b1.ply"), candidates=1)
        self.refused(400, "invalid_parameter", self.client.identify, self.path("a2.ply"), candidates=51)
        self.client.erase_subject("ida")

    def test_subjects(self):
        names = [f"s{i}" for i in range(7)]
        for name in names:
            self.client.add_subject(name, consent="C-1", expires_at="2099-01-31")
        self.refused(409, "exists", self.client.add_subject, "s0")
        listed = {row["subject"]: row["templates"] for row in self.client.list_subjects(limit=3)}
        self.assertEqual({name: listed.get(name) for name in names}, dict.fromkeys(names, 0))
        for name in names:
            self.client.erase_subject(name)

    def test_lock_out_is_raised_at_once(self):
        self.client.enroll("carl", self.path("a1.ply"))
        for _ in range(3):
            self.assertEqual(self.client.verify("carl", self.path("b1.ply"))["decision"], "no_match")
        start = time.monotonic()
        error = self.refused(429, "too_many_attempts", self.client.verify, "carl", self.path("a2.ply"))
        self.assertLess(time.monotonic() - start, 5)
        self.assertTrue(20 < error.retry_after <= 35, error.retry_after)
        self.assertRegex(error.request_id, "^[A-Za-z0-9._-]+$")
        self.assertEqual(error.problem["request_id"], error.request_id)
        self.client.erase_subject("carl")

    def test_tokens(self):
        self.assertIn("verify", self.client.show_own_token()["scopes"])
        secret = "sfd_not-a-token"
        with Client(self.url, secret) as client:
            error = self.refused(401, "unauthorized", client.show_own_token)
        self.assertNotIn(secret, str(error) + repr(error) + repr(error.problem))
        with Client(self.url, new_token(self.folder, "door", "verify")) as door:
            self.refused(403, "insufficient_scope", door.erase_subject, "alice")
        os.environ["SURFACED_TOKEN"], os.environ["SURFACED_URL"] = self.token, self.url
        try:
            with Client() as client:
                self.assertEqual(client.show_own_token()["name"], "test")
        finally:
            del os.environ["SURFACED_TOKEN"], os.environ["SURFACED_URL"]

    def test_token_is_nowhere_to_be_read(self):
        with self.assertLogs("surfaced", logging.DEBUG) as logged:
            self.client.show_own_token()
        self.assertNotIn(self.token, "\n".join(logged.output) + repr(self.client) + str(self.client))
        with self.assertRaises(ValueError) as caught:
            Client(self.url, self.token + "\nX-Other: 1")
        self.assertNotIn(self.token, str(caught.exception))

    def test_addresses(self):
        for bad in ("ftp://127.0.0.1", "127.0.0.1:8787", "http://", "http://user@127.0.0.1"):
            with self.assertRaises(ValueError):
                Client(bad)
        with socket.create_server(("127.0.0.1", 0)) as nobody:
            port = nobody.getsockname()[1]
        self.refused(0, "unreachable", Client(f"http://127.0.0.1:{port}").show_own_token)

    def test_folder(self):
        folder = self.path("scans")
        os.mkdir(folder)
        for to, of in (("dora_1.ply", "a1"), ("dora_2.ply", "a2"), ("emil_1.ply", "b1"), ("emil_2.ply", "a1")):
            os.link(self.path(of + ".ply"), os.path.join(folder, to))
        with open(os.path.join(folder, "fritz.ply"), "w") as file:
            file.write("no scan")
        seen = []
        for _ in range(2):  # again: what is enrolled stays as it is
            result = enroll_folder(self.client, folder, progress=seen.append)
            self.assertEqual([(e.subject, e.error and e.error.code) for e in result], [
                ("dora", None), ("dora", None), ("emil", None), ("emil", "sample_mismatch"), ("fritz", "malformed")])
        self.assertEqual([e.done for e in seen], [1, 2, 3, 4, 5] * 2)
        self.assertEqual({e.all for e in seen}, {5})
        self.assertEqual(len(self.client.show_subject("dora")["templates"]), 2)

    def test_threads(self):
        faults = []

        def work():
            for _ in range(10):
                if self.client.show_own_token()["name"] != "test":
                    faults.append(1)
        threads = [threading.Thread(target=work) for _ in range(4)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        self.assertEqual(faults, [])

    def test_manage(self):
        client = self.client
        client.add_subject("managed")
        self.assertEqual([row["subject"] for row in client.list_subjects(q="MANAGE", state="active", limit=1)], ["managed"])
        self.assertEqual(client.change_subject("managed", groups=["staff", "door"], identify=False)["groups"],
                         ["door", "staff"])
        self.assertEqual(client.add_subject("other", groups=["staff"])["groups"], ["staff"])
        self.assertEqual([row["subject"] for row in client.list_subjects(group="door")], ["managed"])
        made = client.create_token("door", ["verify", "read"], groups=["door"], expires_at=None)
        self.assertIsNone(made["expires_at"])
        with Client(self.url, made["secret"]) as door:
            self.assertEqual(door.show_own_token()["groups"], ["door"])
            self.assertEqual([row["groups"] for row in door.list_subjects()], [["door"]])
            self.refused(404, "not_found", door.show_subject, "other")
            self.refused(403, "insufficient_scope", door.list_tokens)
            again = client.rotate_token(made["id"])
            self.refused(401, "unauthorized", door.show_own_token)
        self.assertNotEqual(again["secret"], made["secret"])
        client.revoke_token(made["id"])
        self.assertTrue([t["revoked_at"] for t in client.list_tokens() if t["id"] == made["id"]][0])
        client.reset_attempts("managed")
        self.assertGreaterEqual(client.recent(limit=1)["last"], 0)
        kinds = [entry["kind"] for entry in client.list_audit(kind="rotate_token,revoke_token", limit=1)]
        self.assertEqual(kinds, ["revoke_token", "rotate_token"])
        later = client.list_audit(after="0-0", kind="rotate_token,revoke_token", limit=1)
        self.assertEqual([entry["kind"] for entry in later], kinds[::-1])
        self.assertTrue(client.verify_audit()["ok"])
        self.assertIn(b"revoke_token", client.export_audit(format="csv"))
        self.assertGreaterEqual(client.stats()["counts"]["subjects"], 1)


class TestCaptures(Served):
    def test_signed(self):
        key(self.path("door.key"))
        run("openssl", "pkey", "-in", self.path("door.key"), "-pubout", "-out", self.path("door.pem"))
        run(os.path.join(BUILD, "surfacectl"), "--db", self.path("faces.db"),
            "device", "add", "door-1", self.path("door.pem"))

        def sign(message):
            with tempfile.NamedTemporaryFile() as file:
                file.write(message)
                file.flush()
                return subprocess.run(["openssl", "pkeyutl", "-sign", "-rawin", "-inkey", self.path("door.key"),
                                       "-in", file.name], check=True, capture_output=True).stdout
        with daemon(self.folder, "--require-signed-captures") as url, Client(url, self.token) as client:
            self.refused(403, "capture_required", client.enroll, "alice", self.path("a1.ply"))
            door = Capture("door-1", sign, "pass")
            client.enroll("alice", self.path("a1.ply"), label="a b", units="mm", capture=door)
            self.assertEqual(client.verify("alice", self.path("a2.ply"), capture=door)["decision"], "match")
            self.assertEqual(client.compare(self.path("a1.ply"), self.path("a2.ply"), capture=door)["decision"], "match")
            self.refused(403, "liveness_failed", client.verify, "alice", self.path("a2.ply"),
                         capture=Capture("door-1", sign, "fail"))
            self.refused(403, "capture_invalid", client.verify, "alice", self.path("a2.ply"),
                         capture=Capture("door-1", lambda m: bytes(64)))


class TestConnections(Served):
    def test_unix_socket(self):
        path = self.path("socket")
        with daemon(self.folder, listen="unix:" + path), Client("unix:" + path, self.token) as client:
            self.assertEqual(client.show_own_token()["name"], "test")

    def test_tls(self):
        def openssl(*arguments):
            run("openssl", *arguments, cwd=self.folder)

        def issue(name, purpose, *more):
            openssl("req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout", name + ".key",
                    "-out", name + ".csr", "-subj", "/CN=" + name)
            with open(self.path("ext"), "w") as file:
                file.write(f"subjectAltName=IP:127.0.0.1\nextendedKeyUsage={purpose}\n")
            openssl("x509", "-req", "-in", name + ".csr", "-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial",
                    "-extfile", "ext", "-days", "2", "-out", name + ".pem")
        openssl("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout", "ca.key",
                "-out", "ca.pem", "-subj", "/CN=ca", "-days", "2", "-addext", "keyUsage=critical,keyCertSign")
        issue("server", "serverAuth")
        issue("client", "clientAuth")
        os.chmod(self.path("server.key"), 0o600)
        with daemon(self.folder, "--tls-cert", self.path("server.pem"), "--tls-key", self.path("server.key"),
                    "--tls-client-ca", self.path("ca.pem")) as url:
            own = (self.path("client.pem"), self.path("client.key"))
            with Client(url, self.token, ca=self.path("ca.pem"), cert=own) as client:
                self.assertEqual(client.show_own_token()["name"], "test")
            self.refused(0, "unreachable", Client(url, self.token, cert=own).show_own_token)
            self.refused(0, "unreachable", Client(url, self.token, ca=self.path("ca.pem")).show_own_token)


class TestOddServers(unittest.TestCase):
    """Responses that are scripted: (status, headers, body) each; None: the connection ends."""

    @contextlib.contextmanager
    def server(self, *script):
        left, seen = list(script), []

        class Handler(http.server.BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_GET(self):
                seen.append(self.path)
                answer = left.pop(0)
                if answer is None:
                    self.close_connection = True
                    return
                status, headers, body = answer
                self.send_response(status)
                for name, value in {"Content-Length": len(body), **headers}.items():
                    self.send_header(name, str(value))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, *_):
                pass
        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
            server.daemon_threads = True
            threading.Thread(target=server.serve_forever, daemon=True).start()
            with Client(f"http://127.0.0.1:{server.server_address[1]}", "t", retries=2, max_wait=2) as client:
                yield client, seen
            server.shutdown()

    FINE = (200, {"Content-Type": "application/json"}, b'{"name": "x"}')
    BUSY = (503, {"Retry-After": 0}, b"")

    def test_again_after_its_wait(self):
        with self.server((429, {"Retry-After": 1}, b""), self.BUSY, self.FINE) as (client, seen):
            start = time.monotonic()
            self.assertEqual(client.show_own_token()["name"], "x")
            self.assertGreaterEqual(time.monotonic() - start, 1)
            self.assertEqual(len(seen), 3)

    def refused(self, script, times, status, code):
        with self.server(*script) as (client, seen):
            with self.assertRaises(SurfacedError) as caught:
                client.show_own_token()
            self.assertEqual((len(seen), caught.exception.status, caught.exception.code), (times, status, code))

    def test_not_for_ever(self):
        self.refused([self.BUSY] * 3, 3, 503, "unknown")

    def test_not_after_a_long_wait(self):
        self.refused([(503, {"Retry-After": 3}, b"")], 1, 503, "unknown")
        self.refused([(503, {}, b"")], 1, 503, "unknown")
        self.refused([(503, {"Retry-After": "soon"}, b"")], 1, 503, "unknown")

    def test_not_after_another_refusal(self):
        self.refused([(500, {"Retry-After": 0}, b"<html>")], 1, 500, "unknown")

    def test_idle_connection_that_was_closed(self):
        with self.server(self.FINE, None, self.FINE) as (client, seen):
            client.show_own_token()
            client.show_own_token()
            self.assertEqual(len(seen), 3)

    def test_again_while_nobody_listens(self):
        with socket.create_server(("127.0.0.1", 0)) as nobody:
            port = nobody.getsockname()[1]

        def answer():
            time.sleep(0.5)
            with socket.create_server(("127.0.0.1", port)) as server, server.accept()[0] as connection:
                connection.recv(9999)
                connection.sendall(b'HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: 13\r\n'
                                   b'Connection: close\r\n\r\n{"name": "x"}')

        threading.Thread(target=answer, daemon=True).start()
        with Client(f"http://127.0.0.1:{port}", "t", retries=2) as client:
            self.assertEqual(client.show_own_token()["name"], "x")

    def test_new_connection_that_is_closed(self):
        self.refused([None], 1, 0, "unreachable")

    def test_no_redirect_is_followed(self):
        self.refused([(302, {"Location": "http://127.0.0.1:1/"}, b"")], 1, 302, "unknown")

    def test_proxys_path(self):
        with self.server(self.FINE) as (client, seen):
            with Client(client.url + "/faces/") as behind:
                behind.show_own_token()
            self.assertEqual(seen, ["/faces/v1/token"])


class TestContract(unittest.TestCase):
    """The names are the API's."""

    @classmethod
    def setUpClass(cls):
        with open(os.path.join(os.path.dirname(__file__), "../../../server/openapi.json")) as file:
            cls.api = json.load(file)

    def test_types(self):
        schemas = self.api["components"]["schemas"]
        rows = {"Listed": schemas["SubjectPage"]["properties"]["subjects"]["items"],
                "Candidate": schemas["Identification"]["properties"]["candidates"]["items"],
                "BurstFile": schemas["Burst"]["properties"]["templates"]["items"]}
        rows["Paired"] = schemas["Pairs"]["properties"]["templates"]["items"]
        rows["Pair"] = schemas["Pairs"]["properties"]["pairs"]["items"]
        rows["Frame"] = schemas["Frames"]["items"]
        rows["FrameAdds"] = rows["Frame"]["properties"]["adds"]
        rows["FramePart"] = rows["FrameAdds"]["properties"]["parts"]["items"]
        rows["Refusal"] = rows["BurstFile"]["properties"]["refusal"]
        rows["Attempts"] = schemas["Subject"]["properties"]["attempts"]
        rows["AuditEntry"] = schemas["Erased"]["properties"]["audit"]
        for name, kind in vars(types).items():
            if typing.is_typeddict(kind):
                schema = schemas.get(name) or rows[name]
                # Annotations are texts, so that __required_keys__ cannot tell.
                optional = {k for k, v in kind.__annotations__.items() if "NotRequired" in str(v)}
                self.assertEqual(set(kind.__annotations__), set(schema["properties"]), name)
                self.assertEqual(set(kind.__annotations__) - optional, set(schema["required"]), name)

    def test_methods(self):
        operations = {re.sub("[A-Z]", lambda c: "_" + c[0].lower(), operation["operationId"])
                      for path, methods in self.api["paths"].items() if path.startswith("/v1")
                      for operation in methods.values() if isinstance(operation, dict) and "operationId" in operation}
        own = {"close", "request", "enroll_each"}  # the latter another body of enroll
        methods = {name for name, of in vars(Client).items() if not name.startswith("_") and callable(of)} - own
        self.assertEqual(methods, operations)

    def test_typed(self):
        self.assertTrue(importlib.resources.files(surfaced).joinpath("py.typed").is_file())


if __name__ == "__main__":
    unittest.main()
