#!/usr/bin/env bash
# dump.sh LIBRARY: the ABI of an unstripped libkeepout.so as libabigail sees it, on the standard output.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# Units of compilation that hold nothing of the ABI go, and the others lose their names, which change with every build; so do the sizes of
# handles, which no caller sees: types that the header declares without a body.
handles=$(sed -n 's/^typedef struct \(ko_[a-z_]*\) \1;$/\1/p' "$here/../../include/keepout.h" | paste -sd '|')
[[ -n $handles ]] || { echo "dump.sh: keepout.h has no handles" >&2; exit 1; }
abidw --suppressions "$here/inside.ini" --no-corpus-path --no-comp-dir-path --no-show-locs --no-elf-needed --no-parameter-names "$1" |
    awk -v handle="name=.($handles). size-in-bits=" '
         /<abi-instr / { unit = $0; next }
         /<\/abi-instr>/ { if (unit == "") print; unit = ""; next }
         unit != "" { sub(/path=.[^ ]*/, "path=\047keepout-" ++n "\047", unit); print unit; unit = "" }
         $0 ~ handle { sub(/size-in-bits=.[0-9]*/, "size-in-bits=\0470") }
         { print }'
