#!/usr/bin/env bash
# Builds the library in release and runs the Python example; arguments go to it (--help lists them). Installs what is missing on Debian:
# python3-numpy, a C compiler, make, cmake.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$top/build/example_python

source "$top/cmake/install_missing.sh"
need_rust
need gcc command -v cc
need libc6-dev test -f /usr/include/stdio.h
need make command -v make
need cmake command -v cmake
need python3-numpy find_numpy
install_missing
find_numpy || { echo "examples/python/run.sh: no Python has NumPy; set PYTHON to one that has" >&2; exit 1; }

cmake -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DKEEPOUT_BUILD_EXAMPLES=OFF -DKEEPOUT_BUILD_BENCHES=OFF \
  -DKEEPOUT_BUILD_TESTS=OFF -DKEEPOUT_CARGO_TARGET_DIR="$top/build/example/cargo" >&2
cmake --build "$build" >&2
KEEPOUT_LIBRARY=$build/lib/libkeepout.so exec "$python" "$top/examples/python/fit_field.py" "$@"
