#!/bin/sh
# Runs tests/c/threads.c with the library built for the thread sanitizer: no data race. The test is skipped where the
# toolchain lacks the sanitizer's runtime.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
host=$(rustc -vV | sed -n 's/^host: //p')
libraries=$(rustc --print sysroot)/lib/rustlib/$host/lib
runtime=$(find "$libraries" -name 'librustc-*_rt.tsan.a' | head -n 1)
if [ -z "$runtime" ]; then
    echo "skipped: this Rust toolchain has no thread sanitizer"
    exit 0
fi

target=${CARGO_TARGET_DIR:-$root/target}
# The sanitizer is an unstable flag, and the standard library comes without it.
RUSTC_BOOTSTRAP=1 \
    RUSTFLAGS="-Zsanitizer=thread -Cunsafe-allow-abi-mismatch=sanitizer --cfg thread_sanitizer" \
    cargo rustc --quiet --manifest-path "$root/Cargo.toml" --lib --crate-type staticlib --target "$host"

# shellcheck disable=SC2046 # lists of flags
cc -std=c99 -Wall -Wextra -Werror -g -O1 -I"$root/include" $(pkg-config --cflags ode) \
    "$root/tests/c/threads.c" "$root/tests/c/scene.c" -o "$target/$host/threads" \
    "$target/$host/debug/libode_visual_hull.a" -Wl,--whole-archive "$runtime" -Wl,--no-whole-archive \
    $(pkg-config --libs ode) $(sed -n 's/^Libs.private: //p' "$root/ode_visual_hull.pc.in") -lstdc++
TSAN_OPTIONS="halt_on_error=0 exitcode=66 suppressions=$root/tests/thread_sanitizer.supp" "$target/$host/threads"
echo "no data race in tests/c/threads.c"
