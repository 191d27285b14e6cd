#!/usr/bin/env python3
"""A proxy between Unix sockets of PostgreSQL: server_proxy.py FROM TO ACTION WORD FLAG
Listens in the folder FROM and connects to the server in the folder TO.  The next time that a client
sends WORD while the file FLAG exists, the proxy removes FLAG, passes WORD on, and to this client's
connection does what ACTION says:
cut   the replies are dropped, and the connection is closed 0.2 s later
hold  the replies are passed on 1 s later
mute  the replies are dropped, and the connection stays open
A statement's text is sent once a connection: prepared again, it has a name."""
import os
import socket
import sys
import threading
import time

folder, server, action, word, flag = sys.argv[1:]
NAME = ".s.PGSQL." + os.environ.get("PGPORT", "5432")


def disarm():
    try:
        os.remove(flag)
    except FileNotFoundError:
        return False
    return True


def close(*ends):
    for s in ends:
        try:
            s.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass


def requests(client, backend, state):
    try:
        while data := client.recv(65536):
            acts = word.encode() in data and disarm()
            if acts:
                state["acts"] = True
            backend.sendall(data)
            if acts and action == "cut":
                time.sleep(0.2)
                break
    except OSError:
        pass
    close(client, backend)


def replies(client, backend, state):
    try:
        while data := backend.recv(65536):
            if state["acts"] and action == "hold":
                time.sleep(1)
                state["acts"] = False
            if not state["acts"]:
                client.sendall(data)
    except OSError:
        pass
    close(client, backend)


listener = socket.socket(socket.AF_UNIX)
listener.bind(os.path.join(folder, NAME))
listener.listen(64)
while True:
    ends = [listener.accept()[0], socket.socket(socket.AF_UNIX)]
    ends[1].connect(os.path.join(server, NAME))
    state = {"acts": False}
    for pump in requests, replies:
        threading.Thread(target=pump, args=(*ends, state), daemon=True).start()
