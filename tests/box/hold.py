#!/usr/bin/env python3
"""Many slow connections: hold.py IPv4:PORT N [--drip MS] [--deaf] [--from ADDRESS] < TEXT
Opens N connections and sends TEXT on each.  --drip: then sends an "x" every MS milliseconds;
--deaf: reads nothing; --from: the connections' own address.  Prints "sent" once TEXT is sent on all of them, "answered" once all have
received something, and "closed K" whenever the number of connections that the other side has
closed grows to K.  Ends when all are closed."""
import resource
import select
import socket
import sys
import time

host, port = sys.argv[1].split(":")
n, deaf = int(sys.argv[2]), "--deaf" in sys.argv
every = int(sys.argv[sys.argv.index("--drip") + 1]) / 1000 if "--drip" in sys.argv else None
own = sys.argv[sys.argv.index("--from") + 1] if "--from" in sys.argv else None
text = sys.stdin.buffer.read()
try:
    resource.setrlimit(resource.RLIMIT_NOFILE, (4050, 4050))
except (OSError, ValueError):
    pass  # the limit may be enough
conn, answered = {}, set()
poll = select.poll()
for _ in range(n):
    s = socket.socket()
    s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)  # so that little of a response fits in
    if own is not None:
        s.bind((own, 0))
    s.connect((host, int(port)))
    try:
        s.send(text)
    except OSError:
        pass  # closed already
    s.setblocking(False)
    conn[s.fileno()] = s
    poll.register(s, 0 if deaf else select.POLLIN)
print("sent", flush=True)


def end(fd):
    poll.unregister(fd)
    conn.pop(fd).close()


due = time.monotonic() + (every or 0)
while conn:
    before = len(conn)
    for fd, event in poll.poll(None if every is None else max(0, due - time.monotonic()) * 1000):
        try:
            if deaf or not conn[fd].recv(4096):
                end(fd)
                continue
        except BlockingIOError:
            continue
        except OSError:
            end(fd)
            continue
        if fd not in answered:
            answered.add(fd)
            if len(answered) == n:
                print("answered", flush=True)
    if every is not None and time.monotonic() >= due:
        due += every
        for fd in list(conn):
            try:
                conn[fd].send(b"x")
            except BlockingIOError:
                pass
            except OSError:
                end(fd)
    if len(conn) < before:
        print("closed", n - len(conn), flush=True)
