#!/bin/sh
# Goal: this build gives the digits of tests/golden/digits.txt.  Other compilers, other machines: scripts/check_digits.sh.
. tests/box/lib.sh
"$BUILD/digits" >"$T/out"
is "exit status" $? 0
ok "the same digits" diff tests/golden/digits.txt "$T/out"
finish
