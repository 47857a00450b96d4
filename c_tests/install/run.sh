#!/usr/bin/env bash
# run.sh BUILD CARGO_TARGET VERSION: installs the build tree BUILD to a folder of its own, moves that, and builds the project beside this
# script against it: by find_package, by pkg-config, and by add_subdirectory. Another minor version must be refused.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
build=$1 cargo_target=$2 version=$3
room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT
step() { echo "-- $*"; }

# Without the environment that points to other packages; quiet unless it fails.
unset CMAKE_PREFIX_PATH PKG_CONFIG_PATH LD_LIBRARY_PATH
quietly() {
    "$@" >"$room/log" 2>&1 || { cat "$room/log"; echo "failed: $*"; return 1; }
}

step "install, and move the tree"
quietly cmake --install "$build" --prefix "$room/first"
mv "$room/first" "$room/prefix"
prefix=$room/prefix
lib=$(dirname "$(find "$prefix" -name 'libkeepout.so.*.*.*' -not -path '*/.debug/*')")
for file in "$lib/libkeepout.so.$version" "$lib/libkeepout.so" "$lib/libkeepout.a" "$lib/.debug/libkeepout.so.$version.debug" \
    "$prefix/include/keepout.h" "$prefix/include/keepout.hpp" "$prefix/include/keepout.f90" \
    "$prefix/share/keepout/python/keepout.py"; do
    [[ -e $file ]] || { echo "not installed: $file"; exit 1; }
done
# No folder of this machine is written into what is installed.
if grep -rIlF -e "$build" -e "$root" -e "$room" "$prefix"; then
    echo "these name folders of the build"
    exit 1
fi

step "find_package"
quietly cmake -S "$here" -B "$room/found" -DCMAKE_PREFIX_PATH="$prefix" -DKEEPOUT_WANTED="${version%.*}"
quietly cmake --build "$room/found"
quietly ctest --test-dir "$room/found" --output-on-failure --no-tests=error

step "find_package refuses other minor versions"
IFS=. read -r major minor _ <<<"$version"
others=("$major.$((minor + 1))" "$((major + 1)).0")
((minor == 0)) || others+=("$major.$((minor - 1))")
for wanted in "${others[@]}"; do
    if cmake -S "$here" -B "$room/refused-$wanted" -DCMAKE_PREFIX_PATH="$prefix" -DKEEPOUT_WANTED=$wanted >"$room/log" 2>&1; then
        echo "find_package(keepout $wanted) took version $version"
        exit 1
    fi
    grep -q "version: $version" "$room/log" || { cat "$room/log"; exit 1; }
done

step "pkg-config"
export PKG_CONFIG_PATH=$lib/pkgconfig
[[ $(pkg-config --modversion keepout) == "$version" ]]
read -ra flags <<<"$(pkg-config --cflags --libs keepout)"
cc "$here/user.c" "${flags[@]}" -o "$room/user_c"
c++ -std=c++17 "$here/user.cpp" "${flags[@]}" -o "$room/user_cpp"
LD_LIBRARY_PATH=$lib "$room/user_c"
LD_LIBRARY_PATH=$lib "$room/user_cpp"
if command -v gfortran >/dev/null; then
    gfortran -J "$room" "$prefix/include/keepout.f90" "$here/user.f90" "${flags[@]}" -o "$room/user_fortran"
    LD_LIBRARY_PATH=$lib "$room/user_fortran"
fi
read -ra static_flags <<<"$(pkg-config --cflags --static --libs keepout)"
cc "$here/user.c" "${static_flags[@]/-lkeepout/-l:libkeepout.a}" -o "$room/user_static"
"$room/user_static"

step "Python"
source "$root/cmake/install_missing.sh"
if find_numpy; then
    # The installed module finds the library that was installed with it.
    [[ $(cd "$room" && unset KEEPOUT_LIBRARY && PYTHONPATH=$prefix/share/keepout/python PYTHONDONTWRITEBYTECODE=1 \
        "$python" -c 'import keepout; print(keepout._library._name, keepout.version())') == "$(realpath "$lib")/libkeepout.so."*" $version" ]]
else
    echo "   SKIPPED: there is no Python with NumPy"
fi

step "add_subdirectory"
quietly cmake -S "$here" -B "$room/sub" -DKEEPOUT_SOURCE="$root" -DKEEPOUT_CARGO_TARGET_DIR="$cargo_target"
quietly cmake --build "$room/sub"
quietly ctest --test-dir "$room/sub" --output-on-failure --no-tests=error
