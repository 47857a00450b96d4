#!/usr/bin/env bash
# Builds the library and experiments in release and runs them: run.sh [NAME...], of wind_farm, packing, drone, wing; all of them without a
# name. Pictures go to out/NAME.svg. Fails where one of them does. Installs what is missing on Debian: compilers, make, cmake, pkg-config,
# coinor-libipopt-dev.
#
#   KEEPOUT_DATA   folder of the test data; ../shared/data beside the project otherwise
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$top/build/example_optimisers
data=${KEEPOUT_DATA:-$top/../shared/data}

[ $# -gt 0 ] || set -- wind_farm packing drone wing
for name; do
  case $name in
    wind_farm | packing | drone | wing) ;;
    *) echo "there is no experiment '$name': wind_farm, packing, drone and wing are" >&2 && exit 2 ;;
  esac
done
if [ ! -f "$data/PROVENANCE.md" ]; then
  echo "there is no test data in $data, which the experiments take their shapes from: set KEEPOUT_DATA to its folder" >&2
  exit 1
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

cmake -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DKEEPOUT_BUILD_OPTIMISERS=ON -DKEEPOUT_BUILD_EXAMPLES=OFF \
  -DKEEPOUT_BUILD_BENCHES=OFF -DKEEPOUT_BUILD_TESTS=OFF -DKEEPOUT_CARGO_TARGET_DIR="$top/build/example/cargo" >&2
cmake --build "$build" --target "${@/#/keepout_}" >&2
mkdir -p "$top/out"
failed=0
for name; do
  "$build/examples/experiments/keepout_$name" "$data" "$top/out/$name.svg" || failed=1
done
exit $failed
