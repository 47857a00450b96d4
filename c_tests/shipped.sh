#!/usr/bin/env bash
# shipped.sh LIB_DIR FILE SONAME FORBIDDEN...: the shared library as it is shipped exports what the header declares and no more, carries its
# soname, is stripped with its debug information beside it, and names none of the FORBIDDEN folders, nor the home of who built it.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
lib_dir=$1 file=$2 soname=$3
shift 3
library=$lib_dir/$file
failures=0

fail() {
    echo "$*" >&2
    failures=$((failures + 1))
}

exported=$(nm -D --defined-only "$library" | awk '{ print $3 }' | sort)
declared=$(sed 's,//.*,,; /^ *\*/d; /^ *\/\*/d' "$root/include/keepout.h" | grep -oE '\bko_[a-z0-9_]+\(' | tr -d '(' | sort -u)
[[ $exported == "$declared" ]] || fail "exported and declared differ:
$(diff <(echo "$exported") <(echo "$declared") || true)"
[[ $(grep -c . <<<"$exported") -ge 28 ]] || fail "only these are exported: $exported"

# Whole outputs first: `grep -q` leaves early, and pipefail takes the broken pipe for a failure.
grep -q "SONAME.*\[$soname\]" <<<"$(readelf -d "$library")" || fail "the soname is not $soname"
[[ $(readlink "$lib_dir/libkeepout.so") == "$soname" && $(readlink "$lib_dir/$soname") == "$file" ]] || fail "the links are wrong"

sections=$(readelf -SW "$library")
grep -q '\.debug_info' <<<"$sections" && fail "the library still has its debug information"
grep -q '\.symtab' <<<"$sections" && fail "the library still has its symbols"
grep -q '\.gnu_debuglink' <<<"$sections" || fail "the library does not say where its debug information is"
grep -q '\.debug_info' <<<"$(readelf -SW "$library.debug")" || fail "the debug file has no debug information"

for shipped in "$library" "$library.debug" "$lib_dir/libkeepout.a"; do
    for folder in "$@" "$HOME/" "${CARGO_HOME:-$HOME/.cargo}/"; do
        found=$(strings -a "$shipped" | grep -F -m 3 -- "$folder" || true)
        [[ -z $found ]] || fail "$(basename "$shipped") names $folder: $found"
    done
done

[[ $failures == 0 ]]
