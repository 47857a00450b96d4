#!/usr/bin/env bash
# compare.sh LIBRARY: the unstripped libkeepout.so still has the ABI of every version kept here under the same soname: no function or struct
# removed or changed, no constant given another value.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
now=$(mktemp --suffix .abi)
trap 'rm -f "$now"' EXIT
"$here/dump.sh" "$1" >"$now"
soname() { sed -n "/soname=/{s/.*soname='\([^']*\)'.*/\1/p;q}"; }
constants() { grep '^#define KO_' "$1" | sort; }
failures=0
for dump in "$here"/*/keepout.abi; do
    kept=$(dirname "$dump")
    if [[ $(soname <"$dump") != "$(soname <"$now")" ]]; then
        echo "-- $(basename "$kept") has another soname"
        continue
    fi
    echo "-- against $(basename "$kept")"
    # The preprocessor's constants are in no dump.
    changed=$(comm -23 <(constants "$kept/keepout.h") <(constants "$here/../../include/keepout.h"))
    [[ -z $changed ]] || { echo "no longer so in keepout.h: $changed"; failures=$((failures + 1)); }
    # New functions are fine; all else moves KO_ABI_VERSION, and with it the soname. Harmless changes count too: a struct that grows at its
    # end, as those with struct_size may, is to be seen here once, and then let pass by its name, in grown.ini.
    abidiff --no-added-syms --harmless --suppressions "$here/grown.ini" "$dump" "$now" || failures=$((failures + 1))
done
[[ $failures == 0 ]]
