#!/usr/bin/env bash
# compare.sh LIBRARY: the unstripped libkeepout.so still has the ABI of every version kept here: nothing removed, nothing changed.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
failures=0
for dump in "$here"/*/keepout.abi; do
    echo "-- against $(basename "$(dirname "$dump")")"
    # Additions are fine; all else moves KO_ABI_VERSION, and with it the soname.
    abidiff --suppressions "$here/suppress.ini" --no-added-syms "$dump" "$1" || failures=$((failures + 1))
done
[[ $failures == 0 ]]
