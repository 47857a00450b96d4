#!/usr/bin/env bash
# Builds the library and the Fortran examples in release and runs them: run.sh [POINTS], of the first. Installs what is missing on Debian:
# gfortran, a C compiler, make, cmake.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$top/build/example_fortran

source "$top/cmake/install_missing.sh"
need_rust
need gcc command -v cc
need libc6-dev test -f /usr/include/stdio.h
need gfortran command -v gfortran
need make command -v make
need cmake command -v cmake
install_missing

cmake -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DKEEPOUT_BUILD_FORTRAN=ON -DKEEPOUT_BUILD_EXAMPLES=OFF \
  -DKEEPOUT_BUILD_BENCHES=OFF -DKEEPOUT_BUILD_TESTS=OFF -DKEEPOUT_CARGO_TARGET_DIR="$top/build/example/cargo" >&2
cmake --build "$build" --target fit_field_fortran band_fortran >&2
"$build/examples/fortran/fit_field_fortran" "$@"
echo
exec "$build/examples/fortran/band_fortran"
