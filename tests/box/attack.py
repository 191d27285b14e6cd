"""attack.py prepare BUILD DATABASE FOLDER -- makes the files and tokens for the next, and a subject.
attack.py ADDRESS:PORT FOLDER COUNT [NAME]... -- verifies beside each attack, or those named.

Runs each attack in a process of its own, from 127.0.0.2, and beside it an ordinary client that
verifies COUNT times, one after the other, each time on a new connection.  Prints a line of JSON for the idle daemon and for each attack:
the milliseconds of half and of 99 % of the verifications, how many got no response (lost), how many
another than a match (refused), and what the attacker was told."""
import collections
import http.client
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time

HOST, PORT = None, None
FOLDER, TOKENS = None, {}


def read(name):
    with open(os.path.join(FOLDER, name), "rb") as f:
        return f.read()


# ---- the ordinary client


def verify_once(body):
    """Returns None, or the status code and whether it is a match."""
    c = http.client.HTTPConnection(HOST, PORT, timeout=60)
    try:
        c.request("POST", "/v1/subjects/alice/verify", body,
                  {"Content-Type": "model/x-ply",
                   "Authorization": "Bearer " + TOKENS["ordinary"]})
        r = c.getresponse()
        text = r.read()
        return r.status, r.status == 200 and json.loads(text)["decision"] == "match"
    except (OSError, http.client.HTTPException):
        return None
    finally:
        c.close()


def verify(count):
    body = read("probe.ply")
    took, lost, refused = [], 0, collections.Counter()
    for _ in range(count):
        start = time.monotonic()
        got = verify_once(body)
        took.append(1000 * (time.monotonic() - start))
        if got is None:
            lost += 1
        elif not got[1]:
            refused[str(got[0])] += 1
    took.sort()
    return {"p50_ms": round(took[len(took) // 2], 1),
            "p99_ms": round(took[min(len(took) - 1, int(0.99 * len(took)))], 1),
            "lost": lost, "refused": dict(refused)}


# ---- what attackers do; each runs until it is killed


def connect():
    s = socket.socket()
    s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    s.bind(("127.0.0.2", 0))
    s.settimeout(60)
    s.connect((HOST, PORT))
    return s


def head(method, path, length, *more, token="attacker"):
    lines = ["%s %s HTTP/1.1" % (method, path), "Host: localhost",
             "Authorization: Bearer " + TOKENS[token]]
    if length is not None:
        lines.append("Content-Length: %d" % length)
    return "\r\n".join(lines + list(more) + ["", ""]).encode()


VERIFY = "/v1/subjects/alice/verify"
PLY, XYZ = "Content-Type: model/x-ply", "Content-Type: text/plain"


def told(out, s):
    """Counts the status code of the response that is there, or that comes."""
    try:
        line = s.recv(64)
    except OSError:
        line = b""
    out[line[9:12].decode() if line.startswith(b"HTTP/1.") else "closed"] += 1
    return line


def in_threads(n, function, *args):
    def again():
        while True:
            try:
                function(*args)
            except OSError:
                time.sleep(0.1)
    for _ in range(n):
        threading.Thread(target=again, daemon=True).start()
    while True:
        time.sleep(1)


def held(n, first, drip=b"", every=0.1):
    """n connections that send first, and then drip as long as they may; made again when closed."""
    conns = []
    while True:
        while len(conns) < n:
            try:
                s = connect()
                s.sendall(first)
                s.setblocking(False)
                conns.append(s)
            except OSError:
                time.sleep(0.05)
                break
        for s in list(conns):
            try:
                if drip:
                    s.send(drip)
                elif s.recv(1, socket.MSG_PEEK) == b"":
                    raise ConnectionError
            except BlockingIOError:
                pass
            except OSError:
                s.close()
                conns.remove(s)
        time.sleep(every)


def again(out, n, request, before=0, tell=True, after=0):
    """n threads, each on one connection after the other: a request, whose response is told or not read."""
    def one():
        s = connect()
        try:
            s.sendall(request)
        except OSError:
            pass  # it was refused before its end
        time.sleep(before)
        if tell:
            told(out, s)
        s.close()
        time.sleep(after)
    in_threads(n, one)


def post(path, body, *more):
    return head("POST", path, len(body), *more) + body


def deaf_heat_maps(out):
    request = post(VERIFY + "?detail=heatmap", read("heat.zst"), XYZ, "Content-Encoding: zstd")

    def one():
        s = connect()
        s.sendall(request)
        if told(out, s).startswith(b"HTTP/1.1 200"):
            time.sleep(60)
        time.sleep(0.2)
        s.close()
    in_threads(80, one)


def bombs(out, name, coding):
    again(out, 8, post(VERIFY, read(name), XYZ, "Content-Encoding: " + coding))


def endless_form(out):
    part = b'--b\r\nContent-Disposition: form-data; name="x%d"\r\n\r\n\r\n'
    again(out, 8, post(VERIFY, b"".join(part % i for i in range(15000)),
                       "Content-Type: multipart/form-data; boundary=b"))


def open_pages(out):
    def page():
        c = http.client.HTTPConnection(HOST, PORT, timeout=60, source_address=("127.0.0.2", 0))
        while True:
            c.request("GET", "/v1/recent?limit=50", headers={"Authorization": "Bearer " + TOKENS["page"]})
            r = c.getresponse()
            r.read()
            out[str(r.status)] += 1
            time.sleep(2)
    in_threads(40, page)


HEALTHZ = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n"
ATTACKS = {
    # 33 MiB of a body, and then nothing
    "half_bodies": lambda out: again(out, 8, head("POST", VERIFY, 60 << 20, PLY) + bytes(33 << 20), after=0.05),
    # large responses that are not read
    "deaf_heat_maps": deaf_heat_maps,
    # scans of 1,000,000 points that are hard to find a face in, one after the other
    "million_points": lambda out: again(out, 4, post(VERIFY, read("million.ply"), PLY)),
    "slow_headers": lambda out: held(500, HEALTHZ + b"A: ", b"x"),
    "slow_bodies": lambda out: held(200, head("POST", VERIFY, 900000, PLY) + b"ply\n", b"x"),
    "chunked_trickles": lambda out: held(
        200, head("POST", VERIFY, None, PLY, "Transfer-Encoding: chunked"), b"1\r\nx\r\n"),
    # many requests on a connection, whose responses are not read
    "deaf_pipelines": lambda out: held(
        100, b"GET /openapi.json HTTP/1.1\r\nHost: localhost\r\n\r\n" * 200, b"", 0.5),
    # many requests on a connection, whose responses are read
    "pipelines": lambda out: again(out, 4, (HEALTHZ + b"\r\n") * 500, before=0.2),
    # as many connections as fit, each closed at once
    "connections": lambda out: again(out, 4, b"", tell=False, after=0.002),
    # more connections than there may be, idle after a request
    "idle_hoard": lambda out: held(400, HEALTHZ + b"\r\n", b"", 0.5),
    # clients that go while the daemon works for them
    "gone": lambda out: again(out, 16, post(VERIFY, read("probe.ply"), PLY), before=0.02, tell=False),
    "gone_million": lambda out: again(out, 4, post(VERIFY, read("million.ply"), PLY), before=0.3, tell=False),
    "gzip_bombs": lambda out: bombs(out, "bomb.gz", "gzip"),
    "zstd_bombs": lambda out: bombs(out, "bomb.zst", "zstd"),
    # a form with part after part
    "endless_form": endless_form,
    # ordinary verifications of one token, as many as it can
    "flood": lambda out: again(out, 64, post(VERIFY, read("probe.ply"), PLY)),
    # forty consoles that were left open at Live, which ask every two seconds
    "open_pages": open_pages,
    # walks over both logs, and a digest of all rows, as many as it can
    "audit_walks": lambda out: again(out, 4, head("POST", "/v1/audit/verify", 0, token="page")),
    # the last: its address may send no more for a while
    "wrong_tokens": lambda out: again(out, 8, head("GET", "/v1/subjects", None, token="wrong")),
}
# Which take more than half a second to take hold, as the daemon works or waits for them.
HEAVY = ["half_bodies", "deaf_heat_maps", "million_points", "gone_million", "gzip_bombs"]


# ---- all of it


class Told(dict):
    """Counts, written to a pipe a line each."""

    def __init__(self, fd):
        super().__init__()
        self.fd = fd

    def __getitem__(self, key):
        return 0

    def __setitem__(self, key, value):
        os.write(self.fd, (key + "\n").encode())


def begin(attack):
    """Returns the process and the end of its pipe to read from."""
    ours, its = os.pipe()
    pid = os.fork()
    if pid == 0:
        os.nice(10)  # what is measured is the daemon, not how much the attacker computes
        os.close(ours)
        attack(Told(its))
        os._exit(0)
    os.close(its)
    return pid, ours


def end(pid, fd):
    os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    with os.fdopen(fd) as f:
        return dict(collections.Counter(f.read().split()))


def prepare(build, db, folder):
    def run(program, *args, **how):
        subprocess.run([os.path.join(build, program), *args], check=True, **how)

    def scan(name, n, *more):
        run("facegen", "--subject", "1", "--scan", n, *more, "-o", os.path.join(folder, name))

    def ctl(*args, **how):
        run("surfacectl", "--db", db, *args, stderr=subprocess.DEVNULL, **how)

    def pack(name, data, *command):
        with open(os.path.join(folder, name), "wb") as f:
            p = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=f)
            for part in data:
                p.stdin.write(part)
            p.stdin.close()
            p.wait()

    global FOLDER
    FOLDER = folder
    scan("enroll.ply", "0")
    scan("probe.ply", "1", "--pose", "8", "--shift", "10")
    scan("million.ply", "2", "--pose", "25", "--spikes", "0.02", "--points", "1000000")
    scan("one.xyz", "3")
    pack("heat.zst", [read("one.xyz")] * 100, "zstd", "-q", "-12")
    pack("bomb.zst", [bytes(1 << 20)] * 256, "zstd", "-q")
    pack("bomb.gz", [bytes(1 << 20)] * 256, "gzip", "-1")
    ctl("init", stdout=subprocess.DEVNULL)
    ctl("enroll", "alice", os.path.join(folder, "enroll.ply"), stdout=subprocess.DEVNULL)
    for who, scope in (("ordinary", "verify"), ("attacker", "verify,detail"), ("page", "read,manage")):
        with open(os.path.join(folder, who + ".token"), "wb") as f:
            ctl("token", "create", who, "--scope", scope, stdout=f)


def main():
    if sys.argv[1] == "prepare":
        prepare(*sys.argv[2:])
        return
    global HOST, PORT, FOLDER
    HOST, port = sys.argv[1].rsplit(":", 1)
    PORT, FOLDER, count = int(port), sys.argv[2], int(sys.argv[3])
    wanted = sys.argv[4:]
    for who in ("ordinary", "attacker", "page"):
        TOKENS[who] = read(who + ".token").decode().strip()
    TOKENS["wrong"] = "0" * 64
    verify(5)  # warm
    print(json.dumps({"attack": "idle", **verify(count)}), flush=True)
    for name in wanted or ATTACKS:
        pid, fd = begin(ATTACKS[name])
        time.sleep(1.5 if name in HEAVY else 0.5)
        got = verify(count)
        said = end(pid, fd)
        print(json.dumps({"attack": name, **got, "attacker": said}), flush=True)
        time.sleep(0.2)


main()
