"""A request whose body comes in two halves: late.py HOST:PORT METHOD PATH TOKEN TYPE FILE HEAD BODY.

Once the daemon has accepted the token and asked for the body (100 Continue), prints a line; after a line
on standard input the second half is sent.  HEAD and BODY receive the response."""
import http.client
import socket
import sys

address, method, path, token, kind, file, head, body = sys.argv[1:]
host, port = address.rsplit(":", 1)
with open(file, "rb") as f:
    scan = f.read()
c = socket.create_connection((host, int(port)), timeout=20)
c.sendall(("%s %s HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer %s\r\n%s\r\nContent-Length: %d\r\n"
           "Expect: 100-continue\r\nConnection: close\r\n\r\n" % (method, path, token, kind, len(scan))).encode())
told = c.recv(25)
print("accepted" if told.startswith(b"HTTP/1.1 100") else told, flush=True)
c.sendall(scan[:len(scan) // 2])
sys.stdin.readline()
c.sendall(scan[len(scan) // 2:])
response = http.client.HTTPResponse(c, method=method)
response.begin()
with open(body, "wb") as f:
    f.write(response.read())
with open(head, "w", encoding="ascii") as f:
    f.write("HTTP/1.1 %d\r\n" % response.status + "".join("%s: %s\r\n" % h for h in response.getheaders()))
