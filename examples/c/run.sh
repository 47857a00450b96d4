#!/usr/bin/env bash
# Keepout's main job in one command: builds the library and the C example in release and runs it, on a shape of its own or on the mesh or
# curves given. Arguments go to the example (--help lists them). Installs what is missing on Debian: C compiler, make, cmake, libpng-dev.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$top/build/example

source "$top/cmake/install_missing.sh"
need_rust
need gcc command -v cc
need libc6-dev test -f /usr/include/stdio.h
need make command -v make
need cmake command -v cmake
need libpng-dev test -f /usr/include/png.h
install_missing

cmake -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DKEEPOUT_BUILD_EXAMPLES=ON -DKEEPOUT_BUILD_BENCHES=OFF \
  -DKEEPOUT_BUILD_TESTS=OFF >&2
cmake --build "$build" --target keepout_field >&2

# Later options win, so that --picture among the arguments does.
mkdir -p "$top/out"
exec "$build/examples/c/keepout_field" --picture "$top/out/keepout_field.png" "$@"
