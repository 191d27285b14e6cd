#!/usr/bin/env python3
"""Runs a program as a service manager would: manager.py NOTES [--socket] [--watchdog USEC] COMMAND...
The program's notifications are appended to the file NOTES, one line each (line breaks become
spaces).  --socket: the program gets a socket that listens on 127.0.0.1.  It is started by exec()
and has this process's id."""
import os
import socket
import sys

notes, command = sys.argv[1], sys.argv[2:]
listening = None
inbox = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
if os.path.exists(notes + ".socket"):
    os.unlink(notes + ".socket")
inbox.bind(notes + ".socket")
program = os.getpid()
if os.fork() == 0:
    inbox.settimeout(0.1)
    with open(notes, "a", buffering=1) as out:
        while True:  # until the program has ended
            try:
                out.write(inbox.recv(1000).decode().replace("\n", " ") + "\n")
            except TimeoutError:
                if os.getppid() != program:
                    os._exit(0)
inbox.close()
os.environ["NOTIFY_SOCKET"] = notes + ".socket"
if command[0] == "--socket":
    listening = socket.create_server(("127.0.0.1", 0), backlog=100)
    os.dup2(listening.fileno(), 3)  # the first that is passed, by sd_listen_fds(3)
    os.set_inheritable(3, True)
    os.environ.update(LISTEN_FDS="1", LISTEN_PID=str(program))
    command = command[1:]
if command[0] == "--watchdog":
    os.environ["WATCHDOG_USEC"] = command[1]
    command = command[2:]
os.execvp(command[0], command)
