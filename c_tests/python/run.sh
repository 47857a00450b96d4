#!/usr/bin/env bash
# run.sh LIBRARY: tests the Python module of examples/python with LIBRARY, and runs the example.
# Where no Python has NumPy the test counts as skipped (77), or as failed when KEEPOUT_REQUIRE_DATA is 1.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
source "$root/cmake/install_missing.sh"
if ! find_numpy; then
    echo "SKIPPED: there is no Python with NumPy; set PYTHON to one" >&2
    [[ ${KEEPOUT_REQUIRE_DATA:-0} == 1 ]] && exit 1
    exit 77
fi
export KEEPOUT_LIBRARY=$1 PYTHONPATH=$root/examples/python PYTHONDONTWRITEBYTECODE=1
"$python" -W error "$here/test_keepout.py"
"$python" -W error "$here/test_cogen.py"
"$python" -W error "$root/examples/python/fit_field.py" --points 2000
