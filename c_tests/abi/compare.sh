#!/usr/bin/env bash
# compare.sh LIBRARY: the unstripped libkeepout.so still has the ABI of every version kept here: nothing removed, nothing changed.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
now=$(mktemp --suffix .abi)
trap 'rm -f "$now"' EXIT
"$here/dump.sh" "$1" >"$now"
failures=0
for dump in "$here"/*/keepout.abi; do
    echo "-- against $(basename "$(dirname "$dump")")"
    # New functions are fine; all else moves KO_ABI_VERSION, and with it the soname. Harmless changes count too: a struct that grows at its end,
    # as those with struct_size may, is to be seen here once, and then let pass by its name.
    abidiff --no-added-syms --harmless "$dump" "$now" || failures=$((failures + 1))
done
[[ $failures == 0 ]]
