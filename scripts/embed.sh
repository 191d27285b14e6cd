#!/bin/sh
# embed.sh NAME < FILE > NAME.h: FILE as a C array, NUL-terminated, to be built into a
# program.  An array of numbers, because C11 promises only 4095 characters a string.
set -eu
name=$1
printf '/* Made by scripts/embed.sh; do not edit. */\n'
printf 'static const char %s[] = {\n' "$name"
od -An -v -td1 | sed 's/  */ /g; s/^ //; s/ $//; s/ /, /g; s/$/,/'
printf '0};\n'
