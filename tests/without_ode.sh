#!/bin/sh
# Without the feature `ode` the library needs neither ODE nor libclang: their crates are not in the graph, and all targets
# build without a warning.
set -eu

cd "$(dirname "$0")/.."
packages="--package ode-visual-hull --package ode-visual-hull-check --package ode-visual-hull-film"
# shellcheck disable=SC2086 # a list of options
needed=$(cargo tree $packages --no-default-features --edges normal,build,dev --prefix none | grep -E '^(ode-sys|bindgen|clang-sys) ' || true)
[ -z "$needed" ] || { echo "needed without the feature ode: $needed" >&2; exit 1; }
# shellcheck disable=SC2086
cargo clippy $packages --no-default-features --all-targets -- --deny warnings
echo "all but ODE builds without ODE"
