#!/bin/sh
# Goal: the Python package installs from its folder without a network, into a virtual environment
# as Debian makes it, and its own tests pass with what was installed, against daemons of theirs.
. tests/box/lib.sh
needs openssl
needs_section clients pip3 mypy
export PYTHONDONTWRITEBYTECODE=1
/usr/bin/python3 -m venv "$T/env"
cp -R clients/python "$T/package" # building leaves files in it
ok "it installs without a network" env PIP_NO_INDEX=1 PIP_DISABLE_PIP_VERSION_CHECK=1 HOME="$T" \
    "$T/env/bin/pip" install -q "$T/package"
ok "its types" mypy --strict --no-warn-return-any --cache-dir "$T/mypy" clients/python/surfaced
if BUILD=$(cd "$BUILD" && pwd) "$T/env/bin/python" -W error -m unittest discover -s clients/python/tests \
    >"$T/out" 2>&1; then
    ok "the number of its tests: $(tail -n 3 "$T/out")" grep -Eq '^Ran (2[4-9]|[3-9][0-9]) tests' "$T/out"
else
    cat "$T/out"
    ok "its tests" false
fi
ok "nothing is left in the folder" sh -c \
    '! find clients/python -name __pycache__ -o -name "*.egg-info" -o -name build | grep .'
finish
