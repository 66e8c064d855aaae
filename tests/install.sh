#!/bin/sh
# `make install` installs into a temporary tree, the C examples build and run with that tree by pkg-config alone, and
# `make uninstall` leaves no file. The example with a recording is skipped where the captures are absent.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
data=${ODE_VISUAL_HULL_DATA:-$root/../shared/data}
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

make -C "$root" --no-print-directory install DESTDIR="$tree" PREFIX=/usr
cp -r "$root/examples/c" "$tree/examples"
export PKG_CONFIG_SYSROOT_DIR="$tree" PKG_CONFIG_PATH="$tree/usr/lib/pkgconfig" LD_LIBRARY_PATH="$tree/usr/lib"
make -C "$tree/examples" --no-print-directory clean all CFLAGS="-O2 -Wall -Wextra -Werror"

"$tree/examples/box_stack" | tail -n 1
"$tree/examples/figure6" | tail -n 1
if [ -d "$data/balancing_person" ]; then
    "$tree/examples/from_images" "$data/balancing_person" cam01 cam02 cam03 cam04 | tail -n 1
else
    echo "skipped: no $data/balancing_person; set ODE_VISUAL_HULL_DATA to the folder of captures"
fi

make -C "$root" --no-print-directory uninstall DESTDIR="$tree" PREFIX=/usr
left=$(find "$tree/usr" ! -type d)
[ -z "$left" ] || { echo "left behind by make uninstall: $left" >&2; exit 1; }
echo "the installed library serves all examples"
