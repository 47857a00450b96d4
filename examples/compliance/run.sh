#!/usr/bin/env bash
# Builds the library and the example in release and runs it. Installs what is missing on Debian: compilers, make, cmake, libnlopt-dev,
# libnlopt-cxx-dev, libeigen3-dev.
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
need libnlopt-dev test -f /usr/include/nlopt.h
need libnlopt-cxx-dev test -f /usr/include/nlopt.hpp
need libeigen3-dev test -d /usr/include/eigen3
install_missing

cmake -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DKEEPOUT_BUILD_OPTIMISERS=ON -DKEEPOUT_BUILD_EXAMPLES=OFF \
  -DKEEPOUT_BUILD_BENCHES=OFF -DKEEPOUT_BUILD_TESTS=OFF -DKEEPOUT_CARGO_TARGET_DIR="$top/build/example/cargo" >&2
cmake --build "$build" --target keepout_compliance >&2
mkdir -p "$top/out"
exec "$build/examples/compliance/keepout_compliance" "$top/out/keepout_compliance.svg"
