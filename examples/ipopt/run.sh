#!/usr/bin/env bash
# Builds the library and the IPOPT example in release and runs it: run.sh [ARGUMENTS]. Installs what is missing on Debian: compilers, make,
# cmake, pkg-config, coinor-libipopt-dev.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$top/build/example_optimisers

source "$top/cmake/install_missing.sh"
need_rust
need gcc command -v cc
need g++ command -v c++
need libc6-dev test -f /usr/include/stdio.h
need make command -v make
need cmake command -v cmake
need pkg-config command -v pkg-config
need coinor-libipopt-dev pkg-config --exists ipopt
install_missing

cmake -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DKEEPOUT_BUILD_OPTIMISERS=ON -DKEEPOUT_BUILD_EXAMPLES=OFF \
  -DKEEPOUT_BUILD_BENCHES=OFF -DKEEPOUT_BUILD_TESTS=OFF -DKEEPOUT_CARGO_TARGET_DIR="$top/build/example/cargo" >&2
cmake --build "$build" --target keepout_layout >&2
mkdir -p "$top/out"
[ $# -gt 0 ] || set -- "$top/out/keepout_layout.obj"
exec "$build/examples/ipopt/keepout_layout" "$@"
