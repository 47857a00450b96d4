#!/usr/bin/env bash
# pictures.sh LIBRARY: makes the pictures of docs/pictures.md and of docs/cogen_figures.md with LIBRARY, small and coarse, the first with the
# test data where they are, and without. Where no Python has matplotlib the test counts as skipped (77), or as failed when KEEPOUT_REQUIRE_DATA is 1.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
source "$root/cmake/install_missing.sh"
if ! find_matplotlib; then
    echo "SKIPPED: there is no Python with matplotlib; set PYTHON to one" >&2
    [[ ${KEEPOUT_REQUIRE_DATA:-0} == 1 ]] && exit 1
    exit 77
fi
export KEEPOUT_LIBRARY=$1 PYTHONDONTWRITEBYTECODE=1 MPLCONFIGDIR=$PWD/matplotlib
"$python" "$root/examples/python/pictures.py" --quick --out with_data
KEEPOUT_DATA=$PWD/nothing "$python" "$root/examples/python/pictures.py" --quick --out without_data
for picture in emblem figure_3 figure_4 figure_6 figure_7; do
    [[ -s with_data/$picture.png && -s without_data/$picture.png ]]
done
mkdir -p figures
"$python" "$root/examples/cogen/figures.py" --cells 20 --cells-3d 9 --folder figures
for figure in 5 6 7 8 9 10 11 12 13 14 15 16; do
    [[ -s figures/cogen_figure_$figure.png ]]
done
rm -r with_data without_data figures matplotlib
