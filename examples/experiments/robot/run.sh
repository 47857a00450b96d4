#!/usr/bin/env bash
# Builds the library and the robot's experiment in release and runs it: run.sh [PICTURE.svg | --starts NUMBER]. The heart is looked for in
# $KEEPOUT_DATA, else in ../shared/data beside the project. Installs what is missing on Debian: compilers, make, cmake, pkg-config,
# coinor-libipopt-dev.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
top=$(cd "$here/../../.." && pwd)
build=$top/build/robot

data=${KEEPOUT_DATA:-$top/../shared/data}
if [ ! -f "$data/anatomy/heart_sphinxsys.stl" ]; then
  echo "there is no anatomy/heart_sphinxsys.stl in $data; set KEEPOUT_DATA to where the meshes lie" >&2
  exit 2
fi

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

cmake -S "$here" -B "$build" -DCMAKE_BUILD_TYPE=Release -DKEEPOUT_CARGO_TARGET_DIR="$top/build/example/cargo" >&2
cmake --build "$build" --target keepout_robot >&2
mkdir -p "$top/out"
[ $# -gt 0 ] || set -- "$top/out/keepout_robot.svg"
# One thread, of the library as of the algebra within IPOPT.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
exec "$build/keepout_robot" "$data" "$@"
