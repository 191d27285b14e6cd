#!/bin/sh
# model_c.sh < core/default.model > default_model.c: the shipped model as the constant
# model_default.  model.c reads the same text at run time, with the same rounding; a test
# compares the two.
set -eu
exec awk '
function next_word() {
    while (++at > fields) {
        if ((getline) <= 0) { print "model_c.sh: the model ends early" > "/dev/stderr"; exit 1 }
        fields = NF
        at = 0
    }
    return $at
}
function want(word,   got) {
    got = next_word()
    if (got != word) {
        print "model_c.sh: " got " instead of " word > "/dev/stderr"
        exit 1
    }
}
function value(macro, word) { return word == "." ? "NAN" : macro "(" word ")" }
function table(member, word, macro,   i) {
    want(word)
    printf "    %s = {", member
    for (i = 0; i < 1312; i++) printf "%s%s,", i % 8 ? " " : "\n        ", value(macro, next_word())
    print "\n    },"
}
function basis(name,   n, k, i) {
    want(name)
    n = next_word()
    printf "    .%s.n = %d,\n", name, n
    table("." name ".rest", "rest", "REST")
    for (k = 0; k < n; k++) {
        want("mode")
        for (i = 0; i < 1312; i++) mode[i, k] = next_word()
    }
    printf "    .%s.mode = {\n", name
    for (i = 0; i < 1312; i++) {
        printf "        {%s", n ? "" : "0"
        for (k = 0; k < n; k++) printf "%s%s", k ? ", " : "", value("MODE", mode[i, k])
        print "},"
    }
    print "    },"
}
BEGIN {
    print "/* Made by scripts/model_c.sh; do not edit. */\n#include <math.h>\n#include \"model.h\""
    print "#define MEAN(v) ((float)((v) / 1000.0))\n#define REST(v) ((float)((v) / 10000.0))"
    print "#define MODE(v) ((float)((v) / 1000.0))\n#define U(v) ((float)((v) / 1000.0))"
    print "#define MM(v) ((v) / 1e6)\n#define RATE(v) ((v) / 1e9)"
    print "const struct model model_default = {"
    want("surfaced-model"); want("1"); want("name")
    name = $0; sub(/^name */, "", name); at = fields
    printf "    .name = \"%s\",\n", name
    want("cap"); printf "    .cap_mm = (float)MM(%s),\n", next_word()
    want("threshold"); printf "    .decision.threshold_mm = MM(%s),\n", next_word()
    want("halving"); printf "    .decision.halving_mm = MM(%s),\n", next_word()
    want("knots"); n = next_word(); printf "    .decision.n = %d,\n    .decision.knot = {", n
    for (i = 0; i < n; i++) { mm = next_word(); printf "{MM(%s), RATE(%s)}, ", mm, next_word() }
    print "},"
    table(".mean", "mean", "MEAN")
    table(".weight", "weight", "U")
    basis("motion"); basis("change")
    want("end")
    print "};"
}' 
