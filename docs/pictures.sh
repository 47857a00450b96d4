#!/usr/bin/env bash
# Makes the pictures of docs/pictures.md, into docs/pictures; arguments go to examples/python/pictures.py (--help lists them). Builds the
# library in release, and installs what is missing on Debian: python3-matplotlib, python3-numpy, a C compiler, make, cmake.
#
#   KEEPOUT_DATA   folder of the test data; ../shared/data beside the project otherwise. Without them a knot takes the bunny's place
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$top/build/example_python

source "$top/cmake/install_missing.sh"
need_rust
need gcc command -v cc
need libc6-dev test -f /usr/include/stdio.h
need make command -v make
need cmake command -v cmake
need python3-numpy find_numpy
need python3-matplotlib find_matplotlib
install_missing
find_matplotlib || { echo "docs/pictures.sh: no Python has matplotlib; set PYTHON to one that has" >&2; exit 1; }

cmake -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DKEEPOUT_BUILD_EXAMPLES=OFF -DKEEPOUT_BUILD_BENCHES=OFF \
  -DKEEPOUT_BUILD_TESTS=OFF -DKEEPOUT_CARGO_TARGET_DIR="$top/build/example/cargo" >&2
cmake --build "$build" >&2
KEEPOUT_LIBRARY=$build/lib/libkeepout.so exec "$python" "$top/examples/python/pictures.py" "$@"
