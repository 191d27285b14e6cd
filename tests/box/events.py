"""Readers of GET /v1/events, for http-events.sh and http-tls.sh.  The token is in $TOKEN, over TLS the daemon's CA in
$CA."""
import http.client
import json
import os
import signal
import socket
import ssl
import statistics
import sys
import threading
import time
import urllib.parse

MEMBERS = {"cursor", "at", "type", "outcome", "subject", "template_id", "token", "token_id"}


def connect(url, timeout=30):
    host = urllib.parse.urlsplit(url)
    return http.client.HTTPConnection(host.hostname, host.port, timeout=timeout)


def get(url, path, headers=None, token=None):
    c = connect(url)
    c.request("GET", path, headers={"Authorization": "Bearer " + (token or os.environ["TOKEN"]), **(headers or {})})
    return c.getresponse()


def check(event):
    assert set(event) - {"until"} == MEMBERS, event
    assert ("until" in event) == (event["type"] == "locked_out"), event


def stream(url, last=None, query="", token=None, comments=None):
    """Yields (id, event); event is None for an id alone."""
    headers = {"Accept": "text/event-stream"}
    if last:
        headers["Last-Event-ID"] = last
    response = get(url, "/v1/events" + query, headers, token)
    if response.status != 200:
        raise ConnectionRefusedError(f"{response.status} {response.read()!r}")
    assert response.headers["Content-Type"] == "text/event-stream"
    fields = {}
    for line in response:
        line = line.rstrip(b"\n").decode()
        if line.startswith(":"):
            if comments is not None:
                comments.append(time.monotonic())
        elif line:
            name, value = line.split(": ", 1)
            fields[name] = value
        elif fields:
            event = json.loads(fields["data"]) if "data" in fields else None
            if event is not None:
                check(event)
                assert event["cursor"] == fields["id"] and event["type"] == fields["event"], fields
            yield fields["id"], event
            fields = {}


def follow(out, urls, last=None):
    """Writes each event to a file, a line each, and goes on where it was at the next of the addresses."""
    with open(out, "w", buffering=1) as to:
        print("ready", file=sys.stderr, flush=True)
        n = 0
        while True:
            try:
                for last, event in stream(urls[n % len(urls)], last):
                    if event is not None:
                        to.write(json.dumps(event, sort_keys=True) + "\n")
            except (OSError, http.client.HTTPException):
                pass
            n += 1
            time.sleep(0.05)


def pages(url, limit="7"):
    """Prints all events, read by pages."""
    after = "0-0"
    while True:
        page = json.load(get(url, f"/v1/events?after={after}&limit={limit}"))
        for event in page["events"]:
            check(event)
            print(json.dumps(event, sort_keys=True))
        if not page["events"]:
            return
        after = page["next_cursor"]


def resumed(url):
    """From each event on there come those behind it, in a page and in a stream."""
    everything = json.load(get(url, "/v1/events?last=100"))["events"]
    assert len(everything) >= 10
    for i, event in enumerate(everything):
        rest = json.load(get(url, f"/v1/events?after={event['cursor']}&limit=1000"))["events"]
        assert rest == everything[i + 1:], (event, rest)
    middle = len(everything) // 2
    got = []
    for _, event in stream(url, everything[middle]["cursor"]):
        got += [event] if event else []
        if len(got) == len(everything) - middle - 1:
            break
    assert got == everything[middle + 1:]
    for last in (0, 1, 5):
        assert json.load(get(url, f"/v1/events?last={last}"))["events"] == everything[len(everything) - last:]


def ends(url, seconds):
    """A stream that ends within these seconds."""
    begin = time.monotonic()
    print("open", flush=True)
    for _ in stream(url):
        pass
    took = time.monotonic() - begin
    print(f"ended after {took:.2f} s", file=sys.stderr)
    assert took <= float(seconds), took


def beats(url):
    """Heartbeats, while nothing happens."""
    comments, ids = [], []
    begin = time.monotonic()
    for last, event in stream(url, comments=comments):
        assert event is None
        ids.append(last)
        if comments:
            break
    assert 14 <= time.monotonic() - begin <= 25 and len(ids) == 2 and ids[0] == ids[1], (ids, comments)


def hold(url, count, query, *tokens):
    """Opens streams, and reads nothing of them until the input ends."""
    host = urllib.parse.urlsplit(url)
    held, refused = [], 0
    for i in range(int(count)):
        s = socket.socket()
        s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        s.connect((host.hostname, host.port))
        if host.scheme == "https":
            s = ssl.create_default_context(cafile=os.environ["CA"]).wrap_socket(s, server_hostname=host.hostname)
        s.sendall((f"GET /v1/events{query} HTTP/1.1\r\nHost: {host.netloc}\r\nAccept: text/event-stream\r\n"
                   f"Authorization: Bearer {tokens[i % len(tokens)]}\r\n\r\n").encode())
        status = s.recv(12)
        if status == b"HTTP/1.1 200":
            held.append(s)
        else:
            assert status == b"HTTP/1.1 503", status
            refused += 1
    print(f"open {len(held)} refused {refused}", flush=True)
    sys.stdin.read()


def verify(url, scan, subject):
    c = connect(url)
    c.request("POST", f"/v1/subjects/{subject}/verify", scan,
              {"Authorization": "Bearer " + os.environ["TOKEN"], "Content-Type": "model/x-ply"})
    response = json.load(c.getresponse())
    c.close()
    return response


def latency(url, watched, scan, subject, count):
    """The time from a decision's response to its event at another or the same daemon."""
    came, ready = [], threading.Event()

    def watch():
        for _, event in stream(watched):
            ready.set()
            if event:
                came.append(time.monotonic())

    threading.Thread(target=watch, daemon=True).start()
    assert ready.wait(10)
    body = open(scan, "rb").read()
    took, verified = [], []
    for _ in range(int(count)):
        n = len(came)
        begin = time.monotonic()
        assert "decision" in verify(url, body, subject)
        decided = time.monotonic()
        verified.append(decided - begin)
        while len(came) == n:
            assert time.monotonic() - decided < 5, "no event within 5 s"
            time.sleep(0.001)
        took.append(max(0.0, came[n] - decided))
    print(f"event after decision: median {1e3 * statistics.median(took):.0f} ms, at most {1e3 * max(took):.0f} ms; "
          f"a verification: median {1e3 * statistics.median(verified):.0f} ms")


def speed(url, scan, subject, count):
    """The time of verifications, one after the other."""
    body = open(scan, "rb").read()
    took = []
    for _ in range(int(count)):
        begin = time.monotonic()
        assert "decision" in verify(url, body, subject)
        took.append(time.monotonic() - begin)
    print(f"median {1e3 * statistics.median(took):.1f} ms, at most {1e3 * max(took):.1f} ms")


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: os._exit(0))
    if sys.argv[1] == "follow":
        follow(sys.argv[2], sys.argv[3:])
    else:
        globals()[sys.argv[1]](*sys.argv[2:])
