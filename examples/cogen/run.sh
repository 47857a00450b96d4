#!/usr/bin/env bash
# Builds the library and the example of co-generation in release and runs it: run.sh STUDY [OPTION...] (--help lists them), or run.sh latch;
# all where none is named. Pages go to out/cogen. Installs what is missing on Debian: C compiler, make, cmake, libpng-dev.
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
cmake --build "$build" --target keepout_cogen keepout_latch >&2

# Later options win, so that --folder among the arguments does.
mkdir -p "$top/out/cogen"
program=$build/examples/cogen/keepout_cogen
[[ ${1:-} != latch ]] || exec "$build/examples/cogen/keepout_latch" "$top/out/cogen"
[[ $# -eq 0 ]] || exec "$program" --folder "$top/out/cogen" "$@"
for study in gears cam cam_3d bolt; do
  "$program" --folder "$top/out/cogen" "$study"
done
exec "$build/examples/cogen/keepout_latch" "$top/out/cogen"
