#!/usr/bin/env bash
# with_data.sh PROGRAM: runs PROGRAM with the folder of test data, $KEEPOUT_DATA or ../shared/data beside the project.
# Where there is none the test counts as skipped (77), or as failed when KEEPOUT_REQUIRE_DATA is 1.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
data=${KEEPOUT_DATA:-$root/../shared/data}
if [[ -f $data/PROVENANCE.md ]]; then
    exec "$1" "$data"
fi
echo "SKIPPED: no test data in $data; set KEEPOUT_DATA to its folder" >&2
[[ ${KEEPOUT_REQUIRE_DATA:-0} == 1 ]] && exit 1
exit 77
