#!/bin/sh
# example.sh LANGUAGE DOCUMENT: prints the program in that language of a Markdown document, for the
# tests that run it.
awk -v begin="\`\`\`$1" '$0 == begin { inside = 1; found = 1; next } /^```/ { inside = 0 } inside
    END { exit !found }' "$2"
