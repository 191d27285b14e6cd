#!/bin/sh
# embed.sh NAME < FILE > NAME.h: FILE as the NUL-terminated C array NAME, to be compiled into a
# program.  An array of numbers, because C11 guarantees string literals of 4095 characters only.
set -eu
name=$1
printf '/* Made by scripts/embed.sh; do not edit. */\n'
printf 'static const char %s[] = {\n' "$name"
od -An -v -td1 | sed 's/  */ /g; s/^ //; s/ $//; s/ /, /g; s/$/,/'
printf '0};\n'
