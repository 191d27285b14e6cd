#!/bin/sh
# Goal: bad input gets an error with a code and a clear detail, and changes nothing; the daemon keeps
# running and loses no data.
. tests/box/lib.sh

scan 1 1 "$T/enrolled.ply"
scan 1 0 "$T/a.ply"
scan 1 0 "$T/a.json"
scan 1 1 "$T/a.xyz"
start_daemon --max-body 40000000
AUTH=$(new_token all)
gives 201 enroll send POST /v1/subjects/alice/templates "$PLY" "$T/enrolled.ply"
id=$(get .template_id)
req GET /v1/token
token=$(get .id)

# stored: what the database has.
stored() {
    sql "SELECT (SELECT count(*) FROM tokens), (SELECT count(*) FROM subjects), (SELECT count(*) FROM templates)"
    req GET /v1/subjects/alice
    cat "$T/body"
}
before=$(stored)

# ---- the bodies that do not fit in a line
: >"$T/empty"
printf '{"points": []}\0{}' >"$T/nul.json"
printf '{"points": [%s,[1e300,2,3]]}' "$(seq -s, -f '[%.0f,1,2]' 1 200)" >"$T/far.json"
printf '1 2 3\n4 5 \001\002\377\n' >"$T/binary.xyz"
head -c 20000 /dev/zero >"$T/zeros"
awk 'BEGIN { for (i = 0; i < 300; i++) print 1, 2, 3 }' >"$T/equal.xyz"
printf -- '--b\r\nContent-Disposition: form-data; name="file"\r\n\r\n{"points": []}\r\n--b' >"$T/cut.form"
jq -c '{a: ., b: .}' "$T/a.json" >"$T/ab.json"
long=$(printf '%0129d' 1)

# ---- requests: METHOD PATH [TYPE BODY...] -> STATUS CODE [DETAIL-PATTERN]
# TYPE: a word of media(), or a media type; with form, each word of BODY is a part as curl's -F has it.
# BODY: a text, or @FILE, a file in $T.
{
    cat <<END
POST /v1/subjects/alice/verify json {"points": [[1,2,3], -> 400 malformed ends too early
POST /v1/subjects/alice/verify json {"points": [["1",2,3]]} -> 400 malformed points\[0\] is not three finite numbers
POST /v1/subjects/alice/verify json {"units": "mm"} -> 400 malformed points is missing
POST /v1/subjects/alice/verify json {"pts": []} -> 400 malformed the JSON: unknown member "pts"; allowed: points, units and axes
POST /v1/subjects/alice/verify json {"points": [], "threshold": -1000} -> 400 malformed unknown member "threshold"
POST /v1/subjects/alice/verify json {"points": []} -> 422 too_few_points 100
POST /v1/subjects/alice/verify json @far.json -> 422 out_of_range point 201 of 201
POST /v1/subjects/alice/verify json @nul.json -> 400 malformed byte 14
POST /v1/subjects/alice/verify json @empty -> 400 malformed empty
POST /v1/subjects/alice/verify ply @empty -> 400 malformed empty
POST /v1/subjects/alice/verify ply @a.json -> 400 malformed
POST /v1/subjects/alice/verify text @binary.xyz -> 400 malformed line 2
POST /v1/subjects/alice/verify text @equal.xyz -> 422 degenerate at one place
POST /v1/subjects/alice/verify bytes @zeros -> 400 malformed
POST /v1/subjects/alice/verify merge @a.json -> 415 unsupported_media_type ^Content-Type must be model/ply, 
POST /v1/subjects/alice/verify?$(printf 'u%05000d' 0)=1 ply @a.ply -> 400 invalid_parameter unknown query parameter u0{63};
POST /v1/subjects/alice/verify form file=@a.json units=mm -> 400 malformed the parts file, units: send 1 to 10 files
POST /v1/subjects/alice/verify form file=@empty -> 400 malformed the file is empty
POST /v1/subjects/alice/verify form file=@a.json;headers="Content-Encoding:br" -> 415 unsupported_content_encoding
POST /v1/subjects/alice/verify multipart/form-data @a.json -> 400 malformed boundary of 1 to 70
POST /v1/subjects/alice/verify multipart/form-data;boundary=b @a.json -> 400 malformed byte 0: no line of the body is the boundary
POST /v1/subjects/alice/verify multipart/form-data;boundary=b @cut.form -> 400 malformed ends before the last boundary
POST /v1/subjects/alice/templates?force=maybe ply @a.ply -> 400 invalid_parameter
POST /v1/check json @a.ply -> 400 malformed this is PLY, not JSON
POST /v1/compare json {"a": {"points": []}} -> 400 malformed b is not an object
POST /v1/compare json {"a": {"points": []}, "b": {"points": []}, "threshold": -1000} -> 400 malformed threshold
POST /v1/compare json {"a": {"points": []}, "b": {"points": [], "threshold": -1000}} -> 400 malformed threshold
POST /v1/compare ply @a.ply -> 415 unsupported_media_type
POST /v1/compare urlencoded @a.json -> 415 unsupported_media_type ^Content-Type must be application/json, or multipart/form-data with the files a and b$
POST /v1/compare none @a.json -> 415 unsupported_media_type ^Content-Type must be application/json, 
POST /v1/compare form file=@ab.json -> 400 malformed a and b
POST /v1/compare form a=@a.ply -> 400 malformed a and b
POST /v1/compare form a=@a.ply c=@a.ply -> 400 malformed named a and b
POST /v1/compare?detail=all json @ab.json -> 400 invalid_parameter ^detail must be measure, heatmap or surface, not 'all'
POST /v1/subjects/bob/templates?fuse=false form file=@a.ply units=mm -> 400 malformed the parts file, units: send 1 to 20 files
POST /v1/subjects/bob/templates?fuse=false form file=@a.ply file=<a.xyz -> 400 malformed each with a file name
POST /v1/subjects json {"subject": "."} -> 400 malformed and not \. or \.\.
POST /v1/subjects json {"subject": ".."} -> 400 malformed and not \. or \.\.
POST /v1/subjects form file=@ab.json -> 415 unsupported_media_type
POST /v1/subjects json {"subject": "alice"} -> 409 exists
PATCH /v1/subjects/alice merge @empty -> 400 malformed
PATCH /v1/subjects/alice merge {"on_hold": true} -> 400 malformed unknown member "on_hold"
PATCH /v1/subjects/alice merge {"expires_at": "2020-01-01"} -> 400 malformed in the past
GET /v1/subjects/$(printf '%0128d' 1) -> 404 not_found
GET /v1/audit?since=soon -> 400 malformed a time is like
GET /v1/audit?subject=a%20b -> 400 malformed a subject id
GET /v1/audit/export?subject=alice -> 400 invalid_parameter
GET /v1/audit/export?format=csv&since=soon -> 400 malformed a time is like
GET /healthz?$(printf '%08000d' 1) -> 400 invalid_parameter unknown query parameter 0{64};
POST /v1/tokens json {"name": "a", "scopes": ["verify"], "expires_at": "2020-01-01"} -> 400 malformed ^expires_at 2020-01-01 is in the past
GET /index.html -> 404 no_such_route /docs .* /openapi.json
END
    printf 'POST /v1/subjects/alice/verify?%s ply @a.ply -> 400 invalid_parameter unknown query parameter .*; this path accepts units, axes, fx, fy, cx, cy, depth_scale, width, height, detail$\n' \
        unknown=1 'units=mm&unknown' '&unknown=1&' unit=mm unitss=mm Units=mm %75nits=mm unknown=%zz \
        =mm units,%20detail=mm force=true threshold=-1000 Threshold=0 decision=match
    printf 'POST /v1/subjects/alice/verify?%s=%s ply @a.ply -> 400 invalid_parameter ^%s must be\n' \
        units inch units units '' units units MM units units yd units units mm%00 units \
        axes camera axes axes '' axes axes Scanner axes \
        detail all detail detail Heatmap detail detail '' detail detail measure,heatmap detail detail %ff detail \
        detail "$long" detail
    printf 'POST /v1/subjects/alice/verify?%s=%s ply @a.ply -> 400 invalid_parameter %s is not a number\n' \
        fx 0 fx fx -1 fx fx nan fx fy 1e999 fy cx '' cx cy 1px cy depth_scale 0 depth_scale depth_scale inf depth_scale
    printf 'POST /v1/subjects/alice/verify?%s ply @a.ply -> 400 invalid_parameter width and height are given together\n' \
        width=240 height=320 'fx=600&width=1'
    for side in 0 -1 65536 1.5 1px ''; do
        printf 'POST /v1/subjects/alice/verify?%s ply @a.ply -> 400 invalid_parameter is not an integer from 1 to 65535$\n' \
            "height=1&width=$side" "width=1&height=$side"
    done
    for member in '"units": "yd"' '"units": 1' '"axes": "camera"' '"axes": null' '"axes": true'; do
        name=${member#\"} name=${name%%\"*}
        echo "POST /v1/subjects/alice/verify json {\"points\": [], $member} -> 400 malformed ^$name must be"
        echo "POST /v1/compare json {\"a\": {\"points\": []}, \"b\": {\"points\": [], $member}} -> 400 malformed ^b\.$name must be"
    done
    printf 'POST /v1/subjects/bob/templates?label=%s ply @a.ply -> 400 invalid_parameter\n' "$long$long" %00 %
    printf 'POST /v1/subjects/bob/templates?label=%s ply @a.ply -> 400 malformed a label is\n' \
        %01 %FF a%E2%80%AEply.exe %E2%80%8Bx a%D8%9C
    printf 'PATCH /v1/subjects/alice merge %s -> 400 malformed\n' '[]' null '{' '{"hold": 1}' '{"disabled": null}' \
        '{"consent": 17}' '{"hold": true, "subject": "bob"}' '{"hold": true, "hold": false}' \
        '{"hold": true, "expires_at": "tomorrow"}' "{\"hold\": true, \"consent\": \"$long\"}" \
        '{"hold": true, "purpose": "a\nb"}' '{"hold": true, "purpose": "a\u0000b"}' \
        "{\"hold\": true, \"purpose\": \"$long$long$long\"}"
    printf 'POST /v1/subjects json %s -> 400 malformed\n' '{}' '{"subject": null}' '{"subject": "a b"}' \
        '{"subject": "x", "hold": true}' "{\"subject\": \"x\", \"consent\": \"$long\"}" \
        '{"subject": "x", "expires_at": "soon"}' "{\"subject\": \"x$long\"}" '{"subject": "x", "purpose": "a\nb"}'
    printf 'GET /v1/subjects/%s -> 400 invalid_parameter subject id\n' a%2Fb a%00 %zz "$long" %C3%A9 a%20b
    printf 'GET /v1/templates/%s -> 404 not_found\n' x ..%2f..%2fetc%2fpasswd "${id}0"
    printf 'GET /v1/subjects?%s -> 400 invalid_parameter\n' limit=0 limit=1001 limit=x limit=-1 cursor=%20 cursor=%zz \
        cursor=x cursor=99999999999999999999 state=gone state= q= "q=$long"
    printf 'GET /v1/audit?%s -> 400 invalid_parameter\n' before=x before=1 before=0-5 after=1-1- after=-1-2 after=01-1 \
        'before=1-1&after=1-1' limit=0 kind= actor= "kind=$long$long"
    printf 'GET /v1/events?%s -> 400 invalid_parameter\n' after=x after=1 after=-1-0 after=1-0- after=01-0 after=1.-0 \
        after=1.0-0 after=1.00000000-0 after=1.g0000000-0 after=1.ABCDEF01-0 after=1-+0 after=%201-0 after= after=1-0%0a \
        after=1-9999999999999999999 "after=1$(printf '%0140d' 0 | sed 's/0/-0/g')" last=101 last=-1 last=x limit=0 limit=1001 \
        wait=61 wait=1.5 'after=1-0&last=1' score=true
    printf 'GET /v1/events?after=%s -> 410 cursor_unknown\n' 1.00000001-0 999999999999999999-0 1-999999999999999999 1-0-0-1
    printf 'GET /v1/audit/export?format=%s -> 400 invalid_parameter\n' xml 'jsonl&kind=verify'
    printf 'GET /%s -> 404 no_such_route\n' v1 v1/ v1/subjects/ v1/subjects//verify v1/identity v2/subjects \
        v1/subjects/x/y healthz/ v1/subjects/x/templates/y v1/subjects/../../etc/passwd
    printf 'POST /v1/tokens json %s -> 400 malformed\n' '{}' '{"name": "a"}' '{"name": "a", "scopes": []}' \
        '{"name": "a", "scopes": "verify"}' '{"name": "a", "scopes": ["root"]}' \
        '{"name": "a", "scopes": ["verify,manage"]}' '{"name": "a", "scopes": [1]}' '{"scopes": ["verify"]}' \
        '{"name": "", "scopes": ["verify"]}' '{"name": "a\nb", "scopes": ["verify"]}' \
        '{"name": "ä", "scopes": ["verify"]}' '{"name": "a", "scopes": ["verify"], "id": "x"}' \
        '{"name": "a", "scopes": ["verify"], "expires_at": "soon"}' \
        '{"name": "a", "scopes": ["verify"], "expires_at": "9000-01-01"}'
    printf 'POST /v1/tokens/%s/rotate json %s -> 400 malformed\n' "$token" '{"grace_s": -1}' "$token" '{"grace_s": 1.5}' \
        "$token" '{"grace_s": "1d"}' "$token" '{"grace": 1}' "$token" '[]' "$token" '{"grace_s": 99999999999}'
    for one in 0123 00000000000000000000000000000000; do
        printf '%s /v1/tokens/%s -> 404 not_found\n' DELETE $one POST "$one/rotate json {}"
    done
} >"$T/requests"

# media TYPE: the media type that a row means by it.
media() {
    case $1 in
    json) echo application/json ;;
    merge) echo application/merge-patch+json ;;
    ply) echo model/x-ply ;;
    text) echo text/plain ;;
    bytes) echo application/octet-stream ;;
    urlencoded) echo application/x-www-form-urlencoded ;;
    none) ;;
    *) echo "$1" ;;
    esac
}
while IFS= read -r row; do
    read -r verb path type body <<END
${row%% -> *}
END
    read -r status code detail <<END
${row#* -> }
END
    case $type in
    '') set -- ;;
    form)
        set --
        for part in $body; do
            set -- "$@" -F "$(echo "$part" | sed "s|[@<]|&$T/|")"
        done
        ;;
    *)
        case $body in @*) body=@$T/${body#@} ;; esac
        set -- -H "Content-Type: $(media "$type")" --data-binary "$body"
        ;;
    esac
    req "$verb" "$path" --path-as-is "$@"
    problem "$(printf %.200s "$row")" "$status" "$code" "$detail"
done <"$T/requests"
send POST /v1/subjects/alice/verify "$JSON" "$T/empty" -H 'Transfer-Encoding: chunked'
problem "empty, in chunks" 400 malformed empty
gives 414 "a query that is too long" req GET "/healthz?$(printf '%020000d' 1)"
is "nothing was changed" "$(stored)" "$before"

# ---- what is taken
# A type that says nothing, as curl's own, leaves it to the content; but JSON is said to be that.
for scan in a.json a.ply; do
    for type in 'Content-Type:' 'Content-Type: application/x-www-form-urlencoded'; do
        send POST /v1/subjects/alice/verify "$type" "$T/$scan"
        is "$scan, $type" "$STATUS $(get .decision)" '200 match'
    done
done
awk '{ print -$1, -$2, $3 }' "$T/a.xyz" >"$T/x"
send POST '/v1/subjects/alice/verify?axes=scanner' 'Content-Type: text/plain' "$T/x"
is "a face upside down, the axes told" "$STATUS $(get .decision)" "200 no_match"
send POST /v1/subjects/alice/verify 'Content-Type: text/plain' "$T/x"
is "the axes not told" "$STATUS $(get .decision)" "200 match"

# ---- over the limit: rejected before the whole body is read
head -c 60000000 /dev/zero >"$T/big"
for how in 'Expect: 100-continue' 'Expect:' 'Transfer-Encoding: chunked'; do
    send POST /v1/subjects/alice/verify "$BYTES" "$T/big" -H "$how"
    problem "over the limit, $how" 413 body_too_large 40000000
done
sent=$(curl -sS -m 5 --limit-rate 2M -o "$T/body" -w '%{http_code} %{size_upload}' -H "$BYTES" \
    -H 'Expect:' -H "Authorization: Bearer $AUTH" --data-binary "@$T/big" "$URL/v1/subjects/alice/verify" 2>/dev/null)
ok "rejected by the headers alone: $sent" test "${sent% *}" = 413 -a "${sent#* }" -lt 20000000
rm "$T/big"

# ---- a damaged database
restart() {
    stop_daemon
    start_daemon
}
damage_faces 1
restart
gives "500 internal" "a damaged model" send POST /v1/subjects/alice/verify "$PLY" "$T/a.ply"
ok "the response reveals no internals" sh -c "! grep -Eiq 'model|checksum|sqlite|corrupt|/tmp' '$T/body'"
ok "the log has the cause" grep -Eq 'status=500 .*fault="' "$LOG"
alive "a damaged model"
gives 200 "its description is served" req GET "/v1/templates/$id"
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
ok "enrolling while it is damaged: $STATUS" test "$STATUS" = 500 -o "$STATUS" = 200
gives 200 "it can be erased" req DELETE /v1/subjects/alice
gives 201 "and enrolled again" send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
finish
