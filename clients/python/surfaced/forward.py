"""python3 -m surfaced.forward --to URL: sends what happens to another system, each event as a POST with JSON.

At least once: an event is sent until the receiver answers with 2xx, and only then the cursor goes on.  The daemon
itself opens no connection to anyone.  docs/clients.md has a receiver.
"""

from __future__ import annotations

import argparse
import hashlib
import hmac
import http.client
import json
import logging
import os
import random
import ssl
import sys
import time
from urllib.parse import urlsplit

from .client import Client, SurfacedError
from .types import Event

log = logging.getLogger("surfaced.forward")

#: The longest pause between two attempts, seconds.
PAUSE = 60.0


def sign(secret: bytes, body: bytes, at: int) -> str:
    """Surfaced-Signature: the HMAC-SHA256 of the time, a point and the body."""
    mac = hmac.new(secret, b"%d." % at + body, hashlib.sha256).hexdigest()
    return f"t={at},v1={mac}"


def verify(secret: bytes, body: bytes, signature: str, tolerance: float = 300.0) -> bool:
    """For the receiver: whether the signature is of this body and secret, and not older than tolerance seconds."""
    fields = dict(part.partition("=")[::2] for part in signature.split(","))
    at = fields.get("t", "")
    if not at.isascii() or not at.isdecimal() or len(at) > 12 or abs(time.time() - int(at)) > tolerance:
        return False
    return hmac.compare_digest(sign(secret, body, int(at)).encode(), f"t={at},v1={fields.get('v1')}".encode())


class Receiver:
    """Where the events go.  No proxy, no redirect: what is sent is about people."""

    def __init__(self, url: str, secret: bytes | None, ca: str | None, timeout: float) -> None:
        parts = urlsplit(url)
        if parts.scheme not in ("http", "https") or not parts.hostname or parts.username or parts.fragment:
            raise ValueError(f"--to {url}: not an address like https://HOST/PATH")
        self._url, self._secret = url, secret
        self._target = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
        self._connection: http.client.HTTPConnection
        if parts.scheme == "https":
            self._connection = http.client.HTTPSConnection(parts.hostname, parts.port, timeout=timeout,
                                                           context=ssl.create_default_context(cafile=ca))
        else:
            self._connection = http.client.HTTPConnection(parts.hostname, parts.port, timeout=timeout)

    def _post(self, body: bytes) -> float | None:
        """None: it was taken.  Else the pause that the receiver asks for, seconds; 0: none.  Raises ConnectionError."""
        headers = {"Content-Type": "application/json", "User-Agent": "surfaced-forward"}
        if self._secret is not None:
            headers["Surfaced-Signature"] = sign(self._secret, body, int(time.time()))
        try:
            self._connection.request("POST", self._target, body, headers)
            response = self._connection.getresponse()
            response.read()
        except (OSError, http.client.HTTPException) as error:
            self._connection.close()
            raise ConnectionError(f"{error or type(error).__name__}") from None
        if 200 <= response.status < 300:
            return None
        after = response.headers["Retry-After"] or ""
        log.warning("%s: %d %s", self._url, response.status, response.reason)
        return min(float(after), 10 * PAUSE) if after.isdecimal() else 0.0

    def send(self, event: Event) -> None:
        """Returns when it was taken."""
        body = json.dumps(event, separators=(",", ":")).encode()
        pause = 0.5
        while True:
            wait: float | None = 0.0
            try:
                wait = self._post(body)
            except ConnectionError as error:
                log.warning("%s: %s", self._url, error)
            if wait is None:
                return
            time.sleep(wait + pause * random.uniform(0.5, 1))
            pause = min(2 * pause, PAUSE)


class Cursor:
    """A file with the cursor of the last event that was taken."""

    def __init__(self, path: str | None) -> None:
        self._path = path
        self.value: str | None = None
        if path is not None and os.path.exists(path):
            with open(path, encoding="ascii") as file:
                self.value = file.read().strip() or None

    def write(self, value: str) -> None:
        """Whole or not at all, also if the power fails."""
        self.value = value
        if self._path is None:
            return
        part = f"{self._path}.part"
        with open(part, "w", encoding="ascii", opener=lambda p, flags: os.open(p, flags, 0o600)) as file:
            file.write(value + "\n")
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, self._path)
        folder = os.open(os.path.dirname(os.path.abspath(self._path)), os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def _read(path: str | None) -> str | None:
    if path is None:
        return None
    with open(path, encoding="utf-8") as file:
        text = file.read().strip()
    if not text:
        raise ValueError(f"{path} is empty")
    return text


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python3 -m surfaced.forward", allow_abbrev=False, description=(
        "Sends each event of a surfaced to another system, at least once, as a POST with JSON."))
    parser.add_argument("--to", required=True, metavar="URL", help="where to: http:// or https://")
    parser.add_argument("--cursor", metavar="FILE", help=(
        "keeps how far it has come; without it, or as long as the file is missing, it begins with what comes from now on"))
    parser.add_argument("--all", action="store_true", help="begins, without a cursor, with the oldest event of the log")
    parser.add_argument("--secret-file", metavar="FILE", help="signs each body with this secret (Surfaced-Signature)")
    parser.add_argument("--token-file", metavar="FILE", help="the daemon's token, instead of $SURFACED_TOKEN")
    parser.add_argument("--url", help="the daemon, instead of $SURFACED_URL or http://127.0.0.1:8787")
    parser.add_argument("--ca", metavar="FILE", help="the CAs to trust for the daemon, instead of the system's")
    parser.add_argument("--to-ca", metavar="FILE", help="the CAs to trust for the receiver")
    parser.add_argument("--timeout", type=float, default=10.0, metavar="S", help="of a wait for the receiver; 10")
    return parser.parse_args()


def _begin(client: Client, cursor: Cursor, everything: bool) -> None:
    """The place is kept at once: what happens before the first event is taken is not lost."""
    while cursor.value is None:
        try:
            page = client.request("GET", "/v1/events", query={"last": 0})
            cursor.write("0-0" if everything else page["next_cursor"])
        except SurfacedError as error:
            if error.status not in (0, 429, 503):
                raise
            log.warning("%s", error)
            time.sleep(random.uniform(1, 3))


def main() -> int:
    given = _arguments()
    logging.basicConfig(format="%(levelname)s: %(message)s", level=logging.INFO)
    try:
        secret = _read(given.secret_file)
        receiver = Receiver(given.to, secret.encode() if secret else None, given.to_ca, given.timeout)
        client = Client(given.url, _read(given.token_file), ca=given.ca)
        cursor = Cursor(given.cursor)
        _begin(client, cursor, given.all)
        for event in client.events(cursor.value):
            receiver.send(event)
            cursor.write(event["cursor"])
    except SurfacedError as error:
        log.error("%s", error)
    except (OSError, ValueError) as error:
        log.error("%s", error)
    except KeyboardInterrupt:
        return 130
    return 2


if __name__ == "__main__":
    sys.exit(main())
