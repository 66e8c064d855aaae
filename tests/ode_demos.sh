#!/bin/sh
# Runs ODE's demo_boxstack and demo_heightfield on their own ground and on a hull in its place: no body falls through the
# hull, and the lowest point is as low. The demos come from Debian's source package `ode`, or from ODE_SOURCE, a folder
# with the unpacked source; where neither is available, the test is skipped.
#
#     tests/ode_demos.sh [STEPS]
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
steps=${1:-4000}
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

skip() {
    echo "skipped: $1; set ODE_SOURCE to a folder with the source of ODE 0.16.2"
    exit 0
}

source=${ODE_SOURCE:-}
if [ -z "$source" ]; then
    command -v apt-get >/dev/null || skip "no apt-get to fetch the source of ODE"
    apt-get indextargets 'Created-By: Sources' 2>/dev/null | grep -q . || skip "no deb-src is configured"
    (cd "$tree" && apt-get source --download-only ode >apt.log 2>&1) || skip "apt-get source ode failed"
    source="$tree/source"
    mkdir "$source"
    tar -xf "$tree"/ode_*.orig.tar.gz -C "$source" --strip-components=1
fi
[ -f "$source/ode/demo/demo_boxstack.cpp" ] || {
    echo "ODE_SOURCE: expected a folder with ode/demo/demo_boxstack.cpp, found $source" >&2
    exit 2
}

make -C "$root" --no-print-directory install DESTDIR="$tree" PREFIX=/usr >"$tree/install.log"
export PKG_CONFIG_SYSROOT_DIR="$tree" PKG_CONFIG_PATH="$tree/usr/lib/pkgconfig" LD_LIBRARY_PATH="$tree/usr/lib"
flags=$(pkg-config --cflags ode_visual_hull) libraries=$(pkg-config --libs ode_visual_hull)
# Only the headers of drawstuff: those of ODE have to be the installed ones, of the library's precision.
mkdir "$tree/include"
cp -r "$source/include/drawstuff" "$tree/include"

# shellcheck disable=SC2086 # lists of flags
build() {
    demo=$1 ground=$2 define=$3
    c++ -O2 -w $define -include "$root/tests/ode_demos/ground.h" -I"$tree/include" -I"$source/ode/demo" $flags \
        "$source/ode/demo/$demo.cpp" "$root/tests/ode_demos/drawstuff.cpp" "$tree/ground.o" $libraries \
        -o "$tree/${demo}_$ground"
}

# shellcheck disable=SC2086
cc -std=c99 -Wall -Wextra -Werror -O2 -c $flags "$root/tests/ode_demos/ground.c" -o "$tree/ground.o"

# The numbers of a run's last line: bodies below the ground, lowest point in metres at the end, lowest point of all steps.
result() { "$tree/$1" "$2" "$steps" | sed -n 's/^result //p'; }

fell=0 off=0
printf '%-16s %-8s %14s %14s %12s %12s\n' demo bodies 'fell through' 'lowest mm' "ODE's own" 'ever mm'
for demo in demo_boxstack demo_heightfield; do
    build "$demo" plane ""
    build "$demo" hull -DHULL_GROUND
    for kind in b:boxes s:spheres c:capsules y:cylinders v:convexes; do
        result "${demo}_plane" "${kind%%:*}" >"$tree/plane" &
        result "${demo}_hull" "${kind%%:*}" >"$tree/hull"
        wait $!
        read -r own_fell own_lowest own_ever <"$tree/plane"
        read -r hull_fell hull_lowest hull_ever <"$tree/hull"
        printf '%-16s %-8s %14s %14s %12s %12s\n' "$demo" "${kind#*:}" "$hull_fell ($own_fell)" \
            "$(echo "$hull_lowest" | awk '{ printf "%.2f", 1000 * $1 }')" \
            "$(echo "$own_lowest" | awk '{ printf "%.2f", 1000 * $1 }')" \
            "$(echo "$hull_ever $own_ever" | awk '{ printf "%.1f (%.1f)", 1000 * $1, 1000 * $2 }')"
        fell=$((fell + hull_fell))
        off=$(echo "$off $hull_lowest $own_lowest" | awk '{ d = $2 - $3; d = d < 0 ? -d : d; print (d > $1) ? d : $1 }')
    done
done
echo "odedemo_fell_through $fell"
echo "odedemo_lowest_off_m $off"
awk "BEGIN { exit !($fell == 0 && $off <= 0.01) }" || {
    echo "expected that nothing falls through the hull and that the lowest point is within 0.01 m of ODE's own" >&2
    exit 1
}
