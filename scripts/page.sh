#!/bin/sh
# page.sh STYLE MODULE...: prints the page that scan/page.c completes: the modules of the console
# joined to one script, the styles, and a policy that allows these two alone.  A page that is opened
# from a file cannot load modules.  STYLE: one file, or several in one word.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
# shellcheck disable=SC2086 # several files
cat $1 >"$dir/style"
shift
sed -e '/^import .*;$/d' -e 's/^export //' "$@" >"$dir/script"
if grep -nE '^(import|export) |</script|<!--' "$dir/script" >&2; then
    exit 1 # it would not be one script
fi

# hash FILE: its source expression.
hash() {
    for byte in $(sha256sum <"$1" | sed 's/ .*//; s/../0x& /g'); do
        # shellcheck disable=SC2059 # the byte itself
        printf "\\$(printf %03o "$byte")"
    done | base64 | sed "s/.*/'sha256-&'/"
}

cat <<END
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="dark light">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src $(hash "$dir/script"); style-src $(
    hash "$dir/style"); img-src data:; base-uri 'none'; form-action 'none'; require-trusted-types-for 'script'; trusted-types 'none'">
<meta name="referrer" content="no-referrer">
<title>surfaced</title>
<link rel="icon" href="data:,">
END
printf '<style>'
cat "$dir/style"
printf '</style>\n<script type="module">'
cat "$dir/script"
printf '</script>\n</head>\n<body>\n<noscript>This page needs JavaScript.</noscript>\n%s' \
    '<script type="application/octet-stream" id="data">'
