#!/usr/bin/env bash
# dump.sh LIBRARY: the ABI of an unstripped libkeepout.so as libabigail sees it, on the standard output.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# Units of compilation that hold nothing of the ABI go, and the others lose their names, which change with every build; so do the sizes of
# handles, which no caller sees.
abidw --suppressions "$here/inside.ini" --no-corpus-path --no-comp-dir-path --no-show-locs --no-elf-needed --no-parameter-names "$1" |
    awk '/<abi-instr / { unit = $0; next }
         /<\/abi-instr>/ { if (unit == "") print; unit = ""; next }
         unit != "" { sub(/path=.[^ ]*/, "path=\047keepout-" ++n "\047", unit); print unit; unit = "" }
         /name=.ko_(mesh|cloud|field). size-in-bits=/ { sub(/size-in-bits=.[0-9]*/, "size-in-bits=\0470") }
         { print }'
