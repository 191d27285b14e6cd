#!/usr/bin/env python3
"""Sends a daemon requests with changed bytes: request line, headers, chunks, bodies.
Usage: http_fuzz.py PORT COUNT SEED FILE...   each FILE one or more valid requests, raw
The same seed gives the same requests.  Prints the number of responses of each status.  Exit
status: 1 if a response is not HTTP or is a 500, or a request is neither read nor rejected."""
import collections
import random
import re
import select
import socket
import struct
import sys

MOST = 1 << 20  # bytes of a request, changed or not
PATIENCE, STUCK = 0.03, 60  # seconds without a byte once all is sent, and before

# What has a meaning in HTTP or in bodies.
WORDS = [w.encode("latin-1") for w in [
    "\r\n", "\n", "\r", "\r\n\r\n", " ", "\t", ":", ";", ",", "%", "%00", "%2F", "%zz", "/", "/../",
    "//", "?", "&", "=", "#", '"', "\\", "{", "}", "[[[[", "null", "1e999", "-1", "0", "0x10", "+5",
    "99999999999999999999", "18446744073709551615", "ffffffffffffffff", "HTTP/1.0", "HTTP/0.9",
    "HTTP/2.0", "HEAD", "OPTIONS", "CONNECT", "*", "GET", "\r\nContent-Length: 5\r\n",
    "\r\nContent-Length: -1\r\n", "\r\nTransfer-Encoding: chunked\r\n",
    "\r\nTransfer-Encoding: gzip, chunked\r\n", "\r\nExpect: 100-continue\r\n",
    "\r\nConnection: keep-alive\r\n", "\r\nConnection: close\r\n", "\r\nContent-Encoding: gzip\r\n",
    "\r\nContent-Encoding: zstd\r\n", "\r\nHost:\r\n", "\r\n folded: line\r\n",
    "\r\nX-Request-Id: a\tb\r\n", '\r\nPrefer: return="minimal\r\n', "\r\nCookie: a=b; c\r\n",
    "\r\nUpgrade: h2c\r\n", "\r\n0\r\n\r\n", "\r\n1;x=y\r\nz\r\n", "\r\nffffffff\r\n",
    "\r\nAuthorization: Bearer \r\n", "\xff\xfe", "\xc0\x80", "nan", "element vertex 4294967295\n",
    "property list uchar int x\n"]]


def change(b, files, draw):
    """Most changes hit the head: it is short, and most of the parsing is there."""
    if not b:
        return b
    p = draw.randrange(min(len(b), 400) if draw.random() < 0.7 else len(b))
    what = draw.randrange(9)
    if what == 0:  # a bit, a byte, a byte more
        return b[:p] + bytes([b[p] ^ 1 << draw.randrange(8)]) + b[p + 1:]
    if what < 3:
        return b[:p] + bytes([draw.randrange(256)]) + b[p + (what == 1):]
    if what == 3:  # less
        return b[:p] + b[p + 1 + draw.randrange(len(b) if draw.random() < 0.25 else 16):]
    if what == 4:  # twice
        return b[:p] + b[p:p + 1 + draw.randrange(200)] + b[p:]
    if what == 5:  # cut off
        return b[:p] if draw.random() < 0.25 else b
    if what == 6:  # a piece of another request
        other = draw.choice(files)
        at = draw.randrange(len(other))
        return b[:p] + other[at:at + draw.randrange(len(other))] + b[p + draw.randrange(100):]
    if what == 7:  # many
        n = 70000 if draw.random() < 0.125 else draw.randrange(300)
        return b[:p] + bytes([draw.randrange(256)]) * n + b[p:]
    word = draw.choice(WORDS)
    return b[:p] + word + b[p + (len(word) if draw.random() < 0.33 else 0):]


def exchange(s, request, draw):
    """Sends it in pieces while the response is read.  A partial request gets no response before the
    daemon's time-out, which is not waited for.  Returns the response's beginning; None: the daemon
    neither reads the request nor closes the connection."""
    got, sent, everything = b"", 0, False
    piece = 1 + draw.randrange(50) if draw.random() < 0.33 else MOST
    while True:
        r, w, _ = select.select([s], [] if everything else [s], [], PATIENCE if everything else STUCK)
        if not r and not w:
            return got if everything else None
        try:
            if r:
                more = s.recv(4096)
                if not more:
                    return got
                got = (got + more)[:512]
            if w:
                sent += s.send(request[sent:sent + piece])
                if sent >= 400:  # small pieces for the head alone
                    piece = MOST
                everything = sent == len(request)
                if everything:
                    s.shutdown(socket.SHUT_WR)
        except BlockingIOError:
            continue
        except OSError:
            return got


def run(port, request, draw):
    """Returns the status, 0 for no response, or what is wrong."""
    s = socket.create_connection(("127.0.0.1", port))
    s.setblocking(False)
    got = b""
    if draw.randrange(16) == 0:  # closed before the response
        try:
            s.send(request)
        except OSError:
            pass
    else:
        got = exchange(s, request, draw)
    # A reset: after a mere close the daemon may wait for its time-out and run out of connections.
    s.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    s.close()
    if got is None:
        return "not taken"
    status = re.match(rb"HTTP/1\.[01] ([1-5]\d\d) ", got)
    if got and not status:
        return "not a response: %r" % got
    return "internal error: %r" % got if status and status[1] == b"500" else int(status[1] if got else 0)


def main():
    port, count, seed = map(int, sys.argv[1:4])
    files = [open(path, "rb").read() for path in sys.argv[4:]]
    draw, statuses, bad = random.Random(seed), collections.Counter(), 0
    for serial in range(count):
        request = draw.choice(files)
        for _ in range(0 if draw.randrange(20) == 0 else 1 + draw.randrange(4)):
            request = change(request, files, draw)[:MOST]
        status = run(port, request, draw)
        if isinstance(status, str):
            print("request %d: %s; sent %d bytes: %r" % (serial, status, len(request), request[:600]))
            bad += 1
            if bad == 5:
                break
        else:
            statuses[status] += 1
    print("seed %d, %d requests, unanswered: %d; by status: %s" % (seed, count, statuses.pop(0, 0), " ".join(
        "%d: %d" % one for one in sorted(statuses.items()))))
    sys.exit(bad > 0)


main()
