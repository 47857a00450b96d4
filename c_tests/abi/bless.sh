#!/usr/bin/env bash
# bless.sh BUILD: keeps header, ABI dump, a program and golden files of the version in the build tree BUILD, for the compatibility tests of
# later ones. Run it before a release, never after: what a released version left here stays as it is.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
build=$1
cmake --build "$build"
version=$(sed -n 's/^version = "\(.*\)"/\1/p' "$root/Cargo.toml" | head -n 1)
cargo_target=$(sed -n 's/^KEEPOUT_CARGO_TARGET_DIR:PATH=//p' "$build/CMakeCache.txt")
mkdir -p "$here/$version"
# The program is an old caller to later versions: it includes the header beside it.
cp "$root/include/keepout.h" "$root/c_tests/lifecycle.c" "$root/c_tests/check.h" "$here/$version"
"$here/dump.sh" "$cargo_target/release/libkeepout.so" >"$here/$version/keepout.abi"
"$build/c_tests/golden" --write "$root/c_tests/golden"
