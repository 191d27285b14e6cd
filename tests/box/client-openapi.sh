#!/bin/sh
# Goal: a client that is generated from /openapi.json compiles, strictly, and what it says of the
# responses' members is so.  By openapi-typescript and tsc.
. tests/box/lib.sh
needs node
npm_packages openapi-typescript@7.13.0 typescript@5.9.3
cp tests/box/client-openapi.ts "$T/client.ts"
ctl init
token=$(new_token client --scope enroll,verify,identify,read)
start_daemon
scan 1 0 "$T/a.ply"
scan 1 1 "$T/again.ply"
req GET /openapi.json
cp "$T/body" "$T/openapi.json"
ok "types are generated" sh -c "'$T/node_modules/.bin/openapi-typescript' '$T/openapi.json' -o '$T/api.d.ts' >'$T/out' 2>&1"
ok "they compile" sh -c "cd '$T' && node_modules/.bin/tsc --strict --lib es2022,dom --target es2022 \
    --module es2022 --moduleResolution bundler client.ts >out || { cat out; false; }"
cat >"$T/run.mjs" <<'END'
import { readFile } from "node:fs/promises";
import { client } from "./client.js";
const [url, token, ...scans] = process.argv.slice(2);
const [a, b] = await Promise.all(scans.map(async (path) => new Blob([await readFile(path)])));
console.log((await client(url, token, a, b)).join("\n"));
END
echo '{"type": "module"}' >"$T/package.json"
node "$T/run.mjs" "$URL" "$token" "$T/a.ply" "$T/again.ply" >"$T/out" 2>&1
is "what it does" "$(paste -sd '|' "$T/out")" \
    'enrollable true|label first, quality true|match|above true|match alice of 1, alice|not_found'
finish
