#!/bin/sh
# Goal: requests that are malformed on purpose get one response or none: never a second one for
# a smuggled request, a file, or a header of the attacker's; and the daemon keeps running.
. tests/box/lib.sh
start_daemon --no-auth --timeout 2

# raw FORMAT: sends the bytes of printf's FORMAT; the responses are in $T/answer.
raw() {
    # shellcheck disable=SC2059 # with \r\n in it
    printf "$1" | curl -sS -m 60 "telnet://${URL#http://}" >"$T/answer" 2>/dev/null
    ok "no page of libmicrohttpd's own" sh -c "! grep -aqi '<html' '$T/answer'"
}

# statuses: of the responses, in order.
statuses() {
    tr -d '\r' <"$T/answer" | sed -n 's/.*HTTP\/1\.[01] \([0-9]*\) .*/\1/p' | tr '\n' ' '
}

# is_problem TITLE STATUS: there is one response, a problem document, and the log has its id.
is_problem() {
    is "$1" "$(statuses)" "$2 "
    tr -d '\r' <"$T/answer" | sed '1,/^$/d' >"$T/body"
    # shellcheck disable=SC2016 # the variable is jq's
    ok "$1: a problem document" jq_true --arg status "$2" '(.status | tostring) == $status
        and (.code | type) == "string" and .type == "urn:surfaced:problem:" + .code' "$T/body"
    ok "$1: its media type" grep -aq '^Content-Type: application/problem+json' "$T/answer"
    ok "$1: in the log" grep -q "request_id=$(jq -r .request_id "$T/body") .* status=$2 " "$LOG"
}

# refused TITLE STATUS FORMAT: the same, or no response if STATUS is empty; and the request behind
# this one is not served.
refused() {
    raw "$3$next"
    if [ -n "$2" ]; then is_problem "$1" "$2"; else is "$1" "$(statuses)" ''; fi
    ok "$1: the request behind it is not served" sh -c "! grep -aq '\"status\":\"ok\"' '$T/answer'"
}
# served TITLE FORMAT: it is read as it is meant, and the request behind it is another one.
served() {
    raw "$2${get}Connection: close\r\n\r\n"
    is "$1" "$(statuses)" '404 200 '
}
get='GET /healthz HTTP/1.1\r\nHost: localhost\r\n'
next="$get\r\n"
post='POST /v1/subjects/a/verify HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n'
chunks='2\r\n{}\r\n0\r\n\r\n'

# ---- where does the body end?
refused "two lengths" 400 "${post}Content-Length: 2\r\nContent-Length: 40\r\n\r\n{}"
refused "the first of them 0" 400 "${post}Content-Length: 0\r\nContent-Length: 40\r\n\r\n"
refused "the same length twice" 400 "${post}Content-Length: 2\r\nContent-Length: 2\r\n\r\n{}"
refused "length and chunks" 400 "${post}Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n$chunks"
refused "chunks and length" 400 "${post}Transfer-Encoding: chunked\r\nContent-Length: 2\r\n\r\n$chunks"
refused "two codings" 400 "${post}Transfer-Encoding: chunked\r\nTransfer-Encoding: identity\r\n\r\n$chunks"
for length in '2, 2' +2 -2 0x2 '2 2' ''; do
    refused "Content-Length '$length'" 400 "${post}Content-Length: $length\r\n\r\n{}"
done
refused "a length of 23 digits" 413 "${post}Content-Length: 99999999999999999999999\r\n\r\n{}"
refused "a negative chunk" 400 "${post}Transfer-Encoding: chunked\r\n\r\n-1\r\n{}\r\n0\r\n\r\n"
refused "a chunk size as in C" 400 "${post}Transfer-Encoding: chunked\r\n\r\n0x2\r\n{}\r\n0\r\n\r\n"
refused "an endless chunk" 413 "${post}Transfer-Encoding: chunked\r\n\r\nffffffffffffffffff\r\n{}"
refused "a chunk longer than its size" 400 "${post}Transfer-Encoding: chunked\r\n\r\n2\r\n{}XX0\r\n\r\n"
for coding in 'gzip, chunked' 'chunked, gzip' 'chunked, chunked' gzip identity xchunked \
    '"chunked"' 'chunked;q=1' 'chunked ' ''; do
    refused "Transfer-Encoding '$coding'" 501 "${post}Transfer-Encoding: $coding\r\n\r\n$chunks"
done
refused "chunked twice" 400 "${post}Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n\r\n$chunks"
refused "identity and chunked" 400 "${post}Transfer-Encoding: identity\r\nTransfer-Encoding: chunked\r\n\r\n$chunks"
refused "identity and a length" 400 "${post}Transfer-Encoding: identity\r\nContent-Length: 2\r\n\r\n{}"
refused "no length and chunks" 400 "${post}Content-Length: 0\r\nTransfer-Encoding: chunked\r\n\r\n$chunks"
refused "a GET in chunks" 400 "${get}Transfer-Encoding: chunked\r\n\r\n$chunks"
refused "a GET of another coding" 501 "${get}Transfer-Encoding: gzip\r\n\r\n$chunks"
old="POST /v1/subjects/a/verify HTTP/1.0\r\nContent-Type: application/json\r\nConnection: keep-alive\r\n"
refused "chunks in HTTP/1.0" 400 "${old}Transfer-Encoding: chunked\r\n\r\n$chunks"
served "a length in HTTP/1.0" "${old}Content-Length: 2\r\n\r\n{}"
served "CHUNKED" "${post}Transfer-Encoding: CHUNKED\r\n\r\n$chunks"
served "chunked behind a tab" "${post}Transfer-Encoding:\tchunked\r\n\r\n$chunks"
served "an extension of a chunk" "${post}Transfer-Encoding: chunked\r\n\r\n2;a=\"b\r\n{}\r\n0;c\r\n\r\n"
served "a size with zeros" "${post}Transfer-Encoding: chunked\r\n\r\n0000000000000000000002\r\n{}\r\n0\r\n\r\n"
served "a length in the trailer" "${post}Transfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\nContent-Length: 40\r\n\r\n"

# ---- folded lines, which libmicrohttpd takes for the rest of the name
refused "a folded length" 400 "${post}Content-Length:\r\n 2\r\n\r\n{}"
refused "a length and a fold" 400 "${post}Content-Length: 2\r\n 0\r\n\r\n{}"
refused "a folded coding" 400 "${post}Transfer-Encoding: gzip,\r\n chunked\r\n\r\n$chunks"
refused "a length made of two lines" 400 "${get}Content-: 40\r\n Length\r\n\r\n"
refused "a coding made of two lines" 400 "${post}Transfer-: chunked\r\n\tEncoding\r\n\r\n$chunks"
refused "a token made of two lines" 400 "${get}Author: Bearer x\r\n ization\r\n\r\n"
refused "another header" 400 "${get}A: b\r\n c\r\n\r\n"
refused "the first line is folded" 400 "GET /healthz HTTP/1.1\r\n Host: localhost\r\n\r\n"
refused "a blank before the colon" 400 "${post}Transfer-Encoding : chunked\r\n\r\n$chunks"
refused "a blank in a name" 400 "${post}Content Length: 2\r\n\r\n{}"
refused "a control character" 400 "${post}Transfer-Encoding: \013chunked\r\n\r\n$chunks"
refused "a carriage return" 400 "${get}A: b\rTransfer-Encoding: chunked\r\n\r\n"

# ---- to which host, and by whose token?
refused "no host" 400 "GET /healthz HTTP/1.1\r\n\r\n"
refused "two hosts" 400 "${get}Host: y\r\n\r\n"
refused "the same host twice" 400 "${get}host: x\r\n\r\n"
refused "a host and a path" 400 "GET /healthz HTTP/1.1\r\nHost: x/v1\r\n\r\n"
refused "a host and another" 400 "GET /healthz HTTP/1.1\r\nHost: x y\r\n\r\n"
refused "two tokens" 400 "${get}Authorization: Bearer x\r\nAuthorization: Bearer y\r\n\r\n"
refused "the same token twice" 400 "${post}Authorization: Bearer x\r\nContent-Length: 2\r\nauthorization: Bearer x\r\n\r\n{}"
for host in '' x:8787 127.0.0.1:1 '[::1]:8787' a-b.example; do
    raw "GET /healthz HTTP/1.1\r\nHost: $host\r\nConnection: close\r\n\r\n"
    is "Host '$host'" "$(statuses)" '200 '
done
raw "GET /healthz HTTP/1.0\r\n\r\n"
is "no host in HTTP/1.0" "$(statuses)" '200 '

# ---- paths and headers
for id in . .. %%2e %%2E. ..%%3Fa; do
    raw "DELETE /v1/subjects/$id HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"
    is_problem "the subject $id" 400
    ok "$id: it is said why" grep -q 'and not \. or \.\.' "$T/body"
done
for path in /../../etc/passwd /docs/..%%2f..%%2fetc/passwd //etc/passwd /docs/../../etc/passwd; do
    raw "GET $path HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"
    ok "$path: $(statuses)" grep -aq '^HTTP/1.1 404 ' "$T/answer"
done
for path in /v1/subjects/a%%00b /v1/subjects/a%%0d%%0aSet-Cookie:%%20x=1; do
    raw "GET $path HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"
    ok "$path: $(statuses)" grep -aq '^HTTP/1.1 400 ' "$T/answer"
    ok "$path: no injected header" sh -c "! grep -aiq '^Set-Cookie' '$T/answer'"
done
raw "GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Request-Id: a\tb<script>\r\nConnection: close\r\n\r\n"
ok "an invalid request id is not sent back" sh -c "! grep -aq script '$T/answer'"
raw "TRACE / HTTP/1.1\r\nHost: localhost\r\nCookie: secret\r\nConnection: close\r\n\r\n"
ok "TRACE sends nothing back" sh -c "! grep -aq secret '$T/answer'"
for line in 'GET /healthz' 'GET /healthz HTTX/1.1' 'GET /healthz HTTP/2.0' 'PRI * HTTP/2.0' \
    'CONNECT a:1 HTTP/1.1'; do
    raw "$line\r\nHost: localhost\r\nConnection: close\r\n\r\n"
    ok "$line: $(statuses)" sh -c "! grep -aq 'HTTP/1.1 200' '$T/answer'"
done
for bytes in '\001\002\003\r\n\r\n' '\026\003\001\002\000\001\000\001' '\000\000\000\000' '\r\n\r\n'; do
    raw "$bytes"
    alive "junk"
done
raw "GET /healthz HTTP/1.1\r\nHost: localhost\r\nA: $(printf '%030000d' 1)\r\n\r\n"
is_problem "too many headers" 431

# many TITLE BEFORE ONE BEHIND: with so many of one that libmicrohttpd has no memory left for them.
# Of parameters it went on with memory that it had freed.
many() {
    n=150
    while [ "$n" -le 240 ]; do
        raw "$2$(one=$3 awk -v n="$n" 'BEGIN { while (n-- > 0) printf "%s", ENVIRON["one"] }')$4"
        n=$((n + 10))
    done
    alive "$1"
}
close='Host: localhost\r\nConnection: close\r\n'
many "many parameters" 'GET /healthz?' 'a&' " HTTP/1.1\r\n$close\r\n"
many "many headers" "GET /healthz HTTP/1.1\r\n$close" 'a: b\r\n' '\r\n'
many "many cookies" "GET /healthz HTTP/1.1\r\n${close}Cookie: " 'a=b;' '\r\n\r\n'
many "many trailers" "POST /v1/check HTTP/1.1\r\n${close}Transfer-Encoding: chunked\r\n\r\n0\r\n" 'a: b\r\n' '\r\n'
raw "POST /v1/check HTTP/1.1\r\n${close}Transfer-Encoding: chunked\r\n\r\n2;$(printf '%030000d' 1)\r\nab\r\n0\r\n\r\n"
is_problem "a chunk's extension that is too long" 400
raw "GET /$(printf '%030000d' 1) HTTP/1.1\r\nHost: localhost\r\n\r\n"
is_problem "a path that is too long" 414
raw "GET /healthz HTTP/1.1\r\nHost x\r\n\r\n"
is_problem "a header without a colon" 400
raw "GET /healthz HTTP/3.0\r\nHost: localhost\r\n\r\n"
is_problem "another HTTP" 505
stop_daemon
finish
