#!/usr/bin/env python3
"""A request as a proxy forwards it: proxy.py URL HEADER PATH [OPTION...]
URL is http://IPv4:PORT, https://IPv4:PORT or unix:SOCKET.  HEADER, of the PROXY protocol, version 2:
an address, whose connection it is; local, unspec, none; tlvs:ADDRESS, with some; or the bytes in
hex.
--from ADDRESS  the proxy's own one; 127.0.0.2
--token TOKEN   of the request
--cut N         send N bytes of the header alone
--by N          send the header N bytes at a time, with a pause of 10 ms
--wait FILE     send the second half of the request when there is FILE
--ca FILE       of the daemon's certificate
--times N       send it N times, each on a connection of its own
Prints for each the status of the response and, where it is another than application/json or
application/problem+json, its media type; or "closed", and where it was closed without a byte of a
response later than in half a second, after how many seconds."""
import argparse
import ipaddress
import os
import socket
import ssl
import struct
import time

SIGNATURE = b"\r\n\r\n\0\r\nQUIT\n"
TLVS = b"\x02\0\x0bexample.org" + b"\x04\0\x03abc"


def header(kind):
    if kind == "none":
        return b""
    if kind == "local":
        return SIGNATURE + b"\x20\0\0\0"
    if kind == "unspec":
        return SIGNATURE + b"\x21\0\0\0"
    tlvs = TLVS if kind.startswith("tlvs:") else b""
    try:
        client = ipaddress.ip_address(kind.removeprefix("tlvs:"))
    except ValueError:
        return bytes.fromhex(kind)
    to = ipaddress.ip_address("198.51.100.1" if client.version == 4 else "2001:db8::1")
    body = client.packed + to.packed + struct.pack(">HH", 50000, 443) + tlvs
    family = 0x11 if client.version == 4 else 0x21
    return SIGNATURE + struct.pack(">BBH", 0x21, family, len(body)) + body


def connect():
    if arg.url.startswith("unix:"):
        s = socket.socket(socket.AF_UNIX)
        s.connect(arg.url[5:])
    else:
        host, port = arg.url.split("//")[1].split(":")
        s = socket.create_connection((host, int(port)), source_address=(getattr(arg, "from"), 0))
    s.settimeout(20)
    return s


def send_header(s):
    text = header(arg.header)
    text = text[: len(text) if arg.cut is None else arg.cut]
    step = arg.by or len(text) or 1
    for at in range(0, len(text), step):
        s.sendall(text[at : at + step])
        if arg.by:
            time.sleep(0.01)


def talk(s):
    send_header(s)
    if arg.cut is not None:
        return s.recv(1)
    if arg.url.startswith("https:"):
        s = ssl.create_default_context(cafile=arg.ca).wrap_socket(s, server_hostname="localhost")
    token = f"Authorization: Bearer {arg.token}\r\n" if arg.token else ""
    text = f"GET {arg.path} HTTP/1.1\r\nHost: localhost\r\n{token}Connection: close\r\n\r\n".encode()
    s.sendall(text[: len(text) // 2])
    if arg.wait:
        open(arg.wait + ".half", "w", encoding="ascii").close()
        while not os.path.exists(arg.wait):
            time.sleep(0.02)
    s.sendall(text[len(text) // 2 :])
    got = b""
    while part := s.recv(65536):
        got += part
    return got


def said(got):
    head = got.split(b"\r\n\r\n")[0].decode().split("\r\n")
    media = [h.split(": ")[1] for h in head if h.lower().startswith("content-type:")]
    words = [head[0].split()[1]] + [m for m in media if m.split("+")[0] not in KNOWN]
    return " ".join(words)


KNOWN = ("application/json", "application/problem")
parser = argparse.ArgumentParser()
for name in "url", "header", "path":
    parser.add_argument(name)
for name in "--token", "--wait", "--ca":
    parser.add_argument(name)
parser.add_argument("--from", default="127.0.0.2")
for name in "--cut", "--by", "--times":
    parser.add_argument(name, type=int, default=1 if name == "--times" else None)
arg = parser.parse_args()
for _ in range(arg.times):
    begin = time.monotonic()
    with connect() as conn:
        try:
            answer = talk(conn)
        except ConnectionError:  # also of TLS, ssl.SSLEOFError is none of these
            answer = b""
        except ssl.SSLError:
            answer = b""
    took = time.monotonic() - begin
    print(said(answer) if answer else "closed" + (f" {took:.0f}" if took > 0.5 else ""))
