"""Requests to the daemon, by the names that they have in /openapi.json."""

from __future__ import annotations

import base64
import hashlib
import http.client
import json
import logging
import os
import random
import secrets
import socket
import ssl
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, overload
from urllib.parse import quote, urlencode, urlsplit

from .types import Asymmetry, Burst, Check, Erased, Event, Identification, Listed, Nonce, OwnToken, Pairs, Subject, Template, Verdict

log = logging.getLogger("surfaced")

#: A scanner's file: its path, or its bytes; or points, (n, 3).
Cloud = str | os.PathLike[str] | bytes | Sequence[Sequence[float]]
Detail = Literal["measure", "heatmap"]
Query = str | float | bool | None


class SurfacedError(Exception):
    """What the daemon refused, or that it cannot be reached.

    status       of HTTP; 0: there was no response
    code         a stable word: "low_quality"; "unreachable" where there was no response
    detail       what was wrong and what to do, in words
    retry_after  seconds after which it may be sent again, or None
    request_id   names the request in the daemon's log, or None
    problem      the whole problem document
    """

    def __init__(self, status: int, code: str, detail: str, retry_after: int | None = None,
                 request_id: str | None = None, problem: Mapping[str, Any] | None = None) -> None:
        super().__init__(f"{status} {code}: {detail}" if status else f"{code}: {detail}")
        self.status = status
        self.code = code
        self.detail = detail
        self.retry_after = retry_after
        self.request_id = request_id
        self.problem = problem or {}


@dataclass(frozen=True)
class Capture:
    """A scanner that signs what it sends (surfaced(8), SIGNED CAPTURES).  sign: the Ed25519 signature
    (64 bytes) of the message that it is given; the client asks for the nonce."""

    device: str
    sign: Callable[[bytes], bytes]
    liveness: Literal["pass", "fail", "none"] = "none"

    def header(self, target: str, nonce: str, body: bytes, content_type: str) -> str:
        digest = hashlib.sha256(body).hexdigest()
        coding = ""  # this client sends no Content-Encoding
        lines = ["surfaced capture 2", f"POST {target}", self.device, nonce, self.liveness, digest, content_type,
                 coding, ""]
        signature = base64.b64encode(self.sign("\n".join(lines).encode())).decode()
        return f"device={self.device}; nonce={nonce}; liveness={self.liveness}; sig={signature}"


#: Seconds after which a stream of events is lost: three of the daemon's heartbeats.
STREAM_SILENCE = 45.0


def _blocks(lines: Iterable[bytes]) -> Iterator[tuple[str, Event | None]]:
    """The blocks of a text/event-stream that have an id.  One that is cut off is none."""
    fields: dict[str, str] = {}
    for line in lines:
        name, _, value = line.decode().rstrip("\n").partition(": ")
        if line == b"\n":
            if "id" in fields:
                yield fields["id"], json.loads(fields["data"]) if "data" in fields else None
            fields = {}
        elif line.endswith(b"\n"):
            fields[name] = value


class _UnixConnection(http.client.HTTPConnection):
    def __init__(self, path: str, timeout: float) -> None:
        super().__init__("localhost", timeout=timeout)
        self._path = path

    def connect(self) -> None:
        self.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.sock.settimeout(self.timeout)
        self.sock.connect(self._path)


def _file(cloud: Cloud) -> tuple[str, bytes, str]:
    """Name, bytes and type of a cloud."""
    if isinstance(cloud, bytes):
        return "scan", cloud, "application/octet-stream"
    if isinstance(cloud, (str, os.PathLike)):
        with open(cloud, "rb") as file:
            return os.path.basename(os.fspath(cloud)), file.read(), "application/octet-stream"
    points = [[float(x) for x in point] for point in cloud]
    return "scan.json", json.dumps({"points": points}).encode(), "application/json"


def _form(clouds: Mapping[str, Cloud] | Sequence[Cloud]) -> tuple[bytes, str]:
    """A form with a file for each cloud: its bytes and its type."""
    named = clouds.items() if isinstance(clouds, Mapping) else [("file", c) for c in clouds]
    boundary = secrets.token_hex(16)
    parts = []
    for field, cloud in named:
        name, data, kind = _file(cloud)
        # As browsers write it: the name of a file is not the form's to break.
        name = name.replace('"', "%22").replace("\r", "%0D").replace("\n", "%0A")
        parts.append((f'--{boundary}\r\nContent-Disposition: form-data; name="{field}"; filename="{name}"\r\n'
                      f"Content-Type: {kind}\r\n\r\n").encode() + data + b"\r\n")
    return b"".join(parts) + f"--{boundary}--\r\n".encode(), f"multipart/form-data; boundary={boundary}"


class Client:
    """A daemon.  May be used by several threads: each has a connection of its own.

    url      "http://HOST:PORT", "https://HOST:PORT", both with a proxy's path if there is one, or
             "unix:PATH"; by default $SURFACED_URL, or http://127.0.0.1:8787
    token    by default $SURFACED_TOKEN; none where there is none
    timeout  seconds for connecting, and for each wait for bytes
    retries  how often a request is sent again after 429 or 503, each time after the Retry-After of
             the response; one that would wait for more than max_wait seconds is not
    ca       a file of the CAs to trust instead of the system's (PEM)
    cert     files of the client's certificate and key (PEM), where the daemon wants one
    """

    def __init__(self, url: str | None = None, token: str | None = None, *, timeout: float = 30.0,
                 retries: int = 3, max_wait: float = 10.0, ca: str | None = None,
                 cert: tuple[str, str] | None = None) -> None:
        self.url = url or os.environ.get("SURFACED_URL") or "http://127.0.0.1:8787"
        token = (token or os.environ.get("SURFACED_TOKEN") or "").strip()
        # http.client's own complaint would quote it.
        if not all("!" <= c <= "~" for c in token):
            raise ValueError("the token has characters that no token has")
        self.__token = token
        self.timeout, self.retries, self.max_wait = timeout, retries, max_wait
        parts = urlsplit(self.url)
        if parts.scheme not in ("http", "https", "unix") or parts.username or parts.query or parts.fragment:
            raise ValueError(f"{self.url}: not an address like https://HOST:PORT or unix:PATH")
        if parts.scheme != "unix" and not parts.hostname:
            raise ValueError(f"{self.url}: no host")
        self._parts = parts
        self._prefix = "" if parts.scheme == "unix" else parts.path.rstrip("/")
        self._tls = None
        if parts.scheme == "https":
            self._tls = ssl.create_default_context(cafile=ca)
            if cert:
                self._tls.load_cert_chain(*cert)
        self._local = threading.local()
        self._lock = threading.Lock()
        self._open: list[http.client.HTTPConnection] = []

    def __repr__(self) -> str:
        return f"Client({self.url!r})"

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connections; a later request opens one again."""
        with self._lock:
            for connection in self._open:
                connection.close()

    # ---- scans

    @overload
    def check(self, cloud: Cloud, *, detail: None = None, **how: Query) -> Check: ...
    @overload
    def check(self, cloud: Cloud, *, detail: Literal["surface"], **how: Query) -> bytes: ...

    def check(self, cloud: Cloud, *, detail: str | None = None, **how: Query) -> Any:
        """Whether a scan can be enrolled and verified, and what to change at the scanner; nothing is
        stored.  detail="surface": binary glTF.  how, here and below: units, axes, and of a depth
        image fx, fy, cx, cy, depth_scale, width, height."""
        return self._post("/v1/check", [cloud], {**how, "detail": detail})

    def enroll(self, subject: str, *frames: Cloud, label: str | None = None, force: bool | None = None,
               capture: Capture | None = None, **how: Query) -> Template:
        """A template of this scan, or of several (up to 20) that are frames of one capture session and
        are fused; the same again: the template that is there.  force: also where it does not match the
        subject's others (takes the scope manage)."""
        return self._post(f"/v1/subjects/{quote(subject, safe='')}/templates", frames,
                          {**how, "label": label, "force": force}, capture)

    def enroll_each(self, subject: str, *clouds: Cloud, label: str | None = None, force: bool | None = None,
                    capture: Capture | None = None, **how: Query) -> Burst:
        """A template of each of up to 20 scans that match the first: what became of each."""
        return self._post(f"/v1/subjects/{quote(subject, safe='')}/templates", clouds,
                          {**how, "label": label, "force": force, "fuse": False}, capture, form=True)

    @overload
    def verify(self, subject: str, *frames: Cloud, detail: Detail | None = None,
               capture: Capture | None = None, **how: Query) -> Verdict: ...
    @overload
    def verify(self, subject: str, *frames: Cloud, detail: Literal["surface"],
               capture: Capture | None = None, **how: Query) -> bytes: ...

    def verify(self, subject: str, *frames: Cloud, detail: str | None = None,
               capture: Capture | None = None, **how: Query) -> Any:
        """Is this the subject?  Several scans (up to 10) are frames of one capture session: one probe.
        detail: "measure", "heatmap" or "surface" (takes the scope detail)."""
        return self._post(f"/v1/subjects/{quote(subject, safe='')}/verify", frames,
                          {**how, "detail": detail}, capture)

    def verify_template(self, template_id: str, *frames: Cloud, detail: Detail | None = None,
                        capture: Capture | None = None, **how: Query) -> Verdict:
        """As verify, by one template alone."""
        return self._post(f"/v1/templates/{quote(template_id, safe='')}/verify", frames,
                          {**how, "detail": detail}, capture)

    def identify(self, *frames: Cloud, group: str | None = None, candidates: int | None = None,
                 capture: Capture | None = None, **how: Query) -> Identification:
        """Who of all who may be found is it, or of a group?  Several scans (up to 10) are frames of one
        capture session: one probe.  candidates: lists so many of the most alike, for a person to review
        (takes the scope read); only "decision": "match" names somebody."""
        return self._post("/v1/identify", frames, {**how, "group": group, "candidates": candidates}, capture)

    @overload
    def compare(self, a: Cloud, b: Cloud, *, detail: Detail | None = None,
                capture: Capture | None = None, **how: Query) -> Verdict: ...
    @overload
    def compare(self, a: Cloud, b: Cloud, *, detail: Literal["surface"],
                capture: Capture | None = None, **how: Query) -> bytes: ...

    def compare(self, a: Cloud, b: Cloud, *, detail: str | None = None,
                capture: Capture | None = None, **how: Query) -> Any:
        """Two scans; nothing is stored.  detail: as of verify, with the scope verify alone."""
        return self._post("/v1/compare", {"a": a, "b": b}, {**how, "detail": detail}, capture)

    def asymmetry(self, cloud: Cloud, **how: Query) -> Asymmetry:
        """A face against its own mirror image."""
        return self._post("/v1/asymmetry", [cloud], how)

    def challenge(self) -> Nonce:
        """A nonce for a signed capture; Capture asks for one by itself."""
        return self.request("POST", "/v1/challenge")

    # ---- subjects and templates

    def _pages(self, path: str, rows: str, query: Mapping[str, Query], cursor: str) -> Iterator[Any]:
        while True:
            page = self.request("GET", path, query=query)
            yield from page[rows]
            if page["next_cursor"] in (None, query.get(cursor)):  # the latter: after the last there is
                return
            query = {**query, cursor: page["next_cursor"]}

    def list_subjects(self, **query: Query) -> Iterator[Listed]:
        """Subjects, page by page.  query: q (a part of the id), state, group, limit (the rows of a page)."""
        return self._pages("/v1/subjects", "subjects", query, "cursor")

    def add_subject(self, subject: str, *, consent: str | None = None, purpose: str | None = None,
                    expires_at: str | None = None, groups: Sequence[str] = (), identify: bool = True) -> Subject:
        """A subject without a template, before the first scan.  Without groups: those of a token that is bound."""
        return self.request("POST", "/v1/subjects", json_body={
            "subject": subject, "consent": consent, "purpose": purpose, "expires_at": expires_at,
            "groups": list(groups), "identify": identify})

    def show_subject(self, subject: str) -> Subject:
        return self.request("GET", f"/v1/subjects/{quote(subject, safe='')}")

    def change_subject(self, subject: str, **changes: str | bool | Sequence[str] | None) -> Subject:
        """changes: consent, purpose, expires_at, groups (None: takes it away), hold, disabled, identify."""
        return self.request("PATCH", f"/v1/subjects/{quote(subject, safe='')}", json_body=changes,
                            content_type="application/merge-patch+json")

    def erase_subject(self, subject: str) -> Erased:
        """Erases the subject with all templates; returns the signed receipt: keep it."""
        return self.request("DELETE", f"/v1/subjects/{quote(subject, safe='')}")

    def show_template(self, template_id: str) -> Template:
        return self.request("GET", f"/v1/templates/{quote(template_id, safe='')}")

    def compare_templates(self, subject: str) -> Pairs:
        """Each two of the subject's templates: which of them does not fit the others?"""
        return self.request("GET", f"/v1/subjects/{quote(subject, safe='')}/templates/compare")

    def delete_template(self, template_id: str) -> None:
        self.request("DELETE", f"/v1/templates/{quote(template_id, safe='')}")

    def show_surface(self, template_id: str, *, format: Literal["glb", "ply"] = "glb") -> bytes:
        """The enrolled surface (takes the scope detail)."""
        return self.request("GET", f"/v1/templates/{quote(template_id, safe='')}/surface", query={"format": format})

    def show_own_token(self) -> OwnToken:
        """What this token may do."""
        return self.request("GET", "/v1/token")

    # ---- of whoever runs the daemon: tokens with manage, tokens or audit

    def list_tokens(self) -> list[dict[str, Any]]:
        return self.request("GET", "/v1/tokens")["tokens"]

    def create_token(self, name: str, scopes: Sequence[str], *, groups: Sequence[str] = (),
                     **end: str | None) -> dict[str, Any]:
        """The new token and its secret, which is shown once.  groups: of subjects, to which it is bound; () is those
        of this token.  end: expires_at (None: never)."""
        return self.request("POST", "/v1/tokens", json_body={
            "name": name, "scopes": list(scopes), "groups": list(groups), **end})

    def rotate_token(self, token_id: str, *, grace_s: int = 0) -> dict[str, Any]:
        """The token with another secret; the old one is good for grace_s seconds."""
        return self.request("POST", f"/v1/tokens/{quote(token_id, safe='')}/rotate", json_body={"grace_s": grace_s})

    def revoke_token(self, token_id: str) -> None:
        self.request("DELETE", f"/v1/tokens/{quote(token_id, safe='')}")

    def reset_attempts(self, subject: str) -> None:
        """Ends the subject's lock-out."""
        self.request("DELETE", f"/v1/subjects/{quote(subject, safe='')}/attempts")

    def reset_token_attempts(self, token_id: str) -> None:
        """End a token's lock-out, on all subjects."""
        self.request("DELETE", f"/v1/tokens/{token_id}/attempts")

    def recent(self, **query: Query) -> dict[str, Any]:
        """The last verifications and enrolments.  query: after, limit."""
        return self.request("GET", "/v1/recent", query=query)

    def events(self, after: str | None = None, *, last: int | None = None) -> Iterator[Event]:
        """What happens, as it happens, without an end (takes the scope events): after a cursor ("0-0": all
        of the log), with the last events, or from now on.  A connection that is lost is made again, and the
        events go on behind the last one; SurfacedError: the daemon refuses (401: the token has ended; 410:
        the cursor is not one of this database)."""
        waits = 0
        while True:
            try:
                for after, event in self._stream(after, last):
                    waits, last = 0, None
                    if event is not None:
                        yield event
            except SurfacedError as error:
                if error.status not in (0, 429, 503):
                    raise
                log.warning("events: %s", error)
            time.sleep(min(2.0 ** waits, 30) * random.uniform(0.1, 1))
            waits += 1

    def _stream(self, after: str | None, last: int | None) -> Iterator[tuple[str, Event | None]]:
        """One response: each id, with its event if there is one."""
        headers = self._headers() | {"Accept": "text/event-stream"}
        if after is not None:
            headers["Last-Event-ID"] = after
        target = f"{self._prefix}/v1/events" + (f"?last={last}" if after is None and last is not None else "")
        connection = self._connect(max(self.timeout, STREAM_SILENCE))
        try:
            connection.request("GET", target, headers=headers)
            response = connection.getresponse()
            if response.status != 200:
                self._result(response, response.read())
            yield from _blocks(response)
        except (OSError, http.client.HTTPException) as error:
            raise SurfacedError(0, "unreachable", f"{self.url}: {error or type(error).__name__}") from None
        finally:
            connection.close()

    def list_audit(self, **query: Query) -> Iterator[dict[str, Any]]:
        """The audit log, newest first; with after (a page's next_cursor; "0-0": all), what came later,
        oldest first.  query: subject, kind, actor, since, until, limit (of a page)."""
        return self._pages("/v1/audit", "entries", query, "after" if "after" in query else "before")

    def verify_audit(self) -> dict[str, Any]:
        """Verifies every entry of the audit log, and every row."""
        return self.request("POST", "/v1/audit/verify")

    def export_audit(self, *, format: Literal["jsonl", "csv"] = "jsonl", **query: Query) -> bytes:
        """The whole log, signed; as csv what the query of list_audit() leaves."""
        return self.request("GET", "/v1/audit/export", query={**query, "format": format})

    def stats(self) -> dict[str, Any]:
        return self.request("GET", "/v1/stats")

    # ---- requests

    def _post(self, path: str, clouds: Mapping[str, Cloud] | Sequence[Cloud], query: Mapping[str, Query],
              capture: Capture | None = None, *, form: bool = False) -> Any:
        """A form, also of one cloud, or the one cloud itself."""
        if isinstance(clouds, Mapping) or form or len(clouds) != 1:
            body, content_type = _form(clouds)
        else:
            _, body, content_type = _file(clouds[0])
        return self.request("POST", path, query=query, body=body, content_type=content_type, capture=capture)

    def request(self, method: str, path: str, *, query: Mapping[str, Query] | None = None,
                body: bytes | None = None, json_body: Any = None, content_type: str = "application/json",
                capture: Capture | None = None) -> Any:
        """Any other route: the response's JSON, its bytes if it has none, None if it is empty.  Raises
        SurfacedError."""
        given = {k: str(v).lower() if isinstance(v, bool) else v for k, v in (query or {}).items() if v is not None}
        target = self._prefix + path + (f"?{urlencode(given)}" if given else "")
        if json_body is not None:
            body = json.dumps(json_body).encode()
        headers = self._headers()
        if body is not None:
            headers["Content-Type"] = content_type
        for left in range(self.retries, -1, -1):
            if capture is not None:  # a nonce is good once
                headers["Capture-Signature"] = capture.header(target, self.challenge()["nonce"], body or b"",
                                                              headers.get("Content-Type", ""))
            try:
                return self._once(method, target, body, headers)
            except SurfacedError as error:
                if (left == 0 or error.status not in (0, 429, 503) or error.retry_after is None
                        or error.retry_after > self.max_wait):
                    raise
                time.sleep(error.retry_after * random.uniform(1, 1.5))
        raise AssertionError("unreachable")

    def _headers(self) -> dict[str, str]:
        headers = {"Accept": "*/*", "User-Agent": "surfaced-python"}
        if self.__token:
            headers["Authorization"] = f"Bearer {self.__token}"
        return headers

    def _connect(self, timeout: float) -> http.client.HTTPConnection:
        if self._parts.scheme == "unix":
            return _UnixConnection(self._parts.path, timeout)
        if self._tls is not None:
            return http.client.HTTPSConnection(self._parts.hostname or "", self._parts.port, timeout=timeout,
                                               context=self._tls)
        return http.client.HTTPConnection(self._parts.hostname or "", self._parts.port, timeout=timeout)

    def _connection(self) -> http.client.HTTPConnection:
        connection: http.client.HTTPConnection | None = getattr(self._local, "connection", None)
        if connection is None:
            connection = self._connect(self.timeout)
            self._local.connection = connection
            with self._lock:
                self._open.append(connection)
        return connection

    def _exchange(self, method: str, target: str, body: bytes | None,
                  headers: Mapping[str, str]) -> tuple[http.client.HTTPResponse, bytes]:
        connection = self._connection()
        reused = connection.sock is not None
        try:
            connection.request(method, target, body, dict(headers))
            response = connection.getresponse()
            return response, response.read()
        except (ConnectionError, http.client.BadStatusLine):
            connection.close()
            if not reused:
                raise
            # The daemon has closed a connection that was idle, before it read the request.
            return self._exchange(method, target, body, headers)
        except BaseException:
            connection.close()
            raise

    def _once(self, method: str, target: str, body: bytes | None, headers: Mapping[str, str]) -> Any:
        try:
            response, data = self._exchange(method, target, body, headers)
        except (OSError, http.client.HTTPException) as error:
            # Refused: nobody listens, as while the daemon is started anew.
            wait = 1 if isinstance(error, ConnectionRefusedError) else None
            raise SurfacedError(0, "unreachable", f"{self.url}: {error or type(error).__name__}", wait) from None
        return self._result(response, data, method)

    def _result(self, response: http.client.HTTPResponse, data: bytes, method: str = "GET") -> Any:
        request_id = response.headers["X-Request-Id"]
        # No path: it has the subject.
        log.debug("%s: %d, request id %s", method, response.status, request_id)
        kind = response.headers.get_content_type()
        if 200 <= response.status < 300:
            return None if not data else json.loads(data) if kind == "application/json" else data
        problem: dict[str, Any] = {}
        if kind == "application/problem+json":
            problem = json.loads(data)
        after = response.headers["Retry-After"] or ""
        raise SurfacedError(response.status, problem.get("code", "unknown"),
                            problem.get("detail", response.reason), int(after) if after.isdecimal() else None,
                            request_id, problem)
