#!/bin/sh
# check_packaging.sh: the package's version is the program's, and its Build-Depends has the
# libraries of scripts/packages.txt.
set -eu
cd "$(dirname "$0")/.."
debian=packaging/debian
bad=0
version=$(sed -n 's|.*SURFACE_VERSION *"\(.*\)".*|\1|p' core/basic/surface_basic.h)
package=$(sed -n '1s/^surfaced (\([^)]*\)).*/\1/p' $debian/changelog)
if [ "$package" != "$version" ]; then
    echo "$debian/changelog begins with version $package, core/basic/surface_basic.h says $version"
    bad=1
fi
libraries=$(awk '$1 == "build" && $2 ~ /-dev$/ && $2 != "libc6-dev" { print $2 }' \
    scripts/packages.txt)
for library in $libraries; do
    if ! grep -qE "[ ,]$library(,|$)" $debian/control; then
        echo "$debian/control: Build-Depends lacks $library of scripts/packages.txt"
        bad=1
    fi
done
exit $bad
