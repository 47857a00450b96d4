#!/usr/bin/env bash
# test.sh: everything that must hold, stage by stage, with the time of each. Needs a Rust toolchain; on Debian it installs what else is missing.
#
#   KEEPOUT_DATA           folder of the test data; ../shared/data beside the project otherwise
#   KEEPOUT_REQUIRE_DATA   1: tests without their data fail instead of being skipped
#   CMAKE_BUILD_PARALLEL_LEVEL, CARGO_BUILD_JOBS   jobs at once, all cores otherwise
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")"
root=$PWD
target=${CARGO_TARGET_DIR:-$root/target}
build=$target/cmake
summary=()

# stage NAME COMMAND...
stage() {
    local name=$1 start=$SECONDS
    shift
    printf '\n==== %s\n' "$name"
    if ! "$@" </dev/null; then
        printf '\nFAILED: %s, after %d s\n' "$name" $((SECONDS - start))
        exit 1
    fi
    summary+=("$name $((SECONDS - start)) s")
    printf -- '---- %s: %d s\n' "$name" $((SECONDS - start))
}

# Debian packages, each with a file that tells that it is there.
install_missing() {
    local missing=() package file
    while read -r package file; do
        [[ -e $file ]] || missing+=("$package")
    done <<'LIST'
gcc /usr/bin/gcc
g++ /usr/bin/g++
binutils /usr/bin/objcopy
cmake /usr/bin/cmake
ninja-build /usr/bin/ninja
pkg-config /usr/bin/pkg-config
libcgal-dev /usr/include/CGAL/version.h
libpng-dev /usr/include/png.h
abigail-tools /usr/bin/abidw
valgrind /usr/bin/valgrind
LIST
    if [[ ${#missing[@]} == 0 ]]; then
        echo "nothing is missing"
        return
    fi
    echo "installing by apt-get: ${missing[*]}"
    local as_root=()
    [[ $(id -u) == 0 ]] || as_root=(sudo)
    "${as_root[@]}" apt-get update -qq &&
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "${missing[@]}"
}

documentation() {
    RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps
}

cmake_build() {
    cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DKEEPOUT_CARGO_TARGET_DIR="$target/shipped" &&
        cmake --build "$build"
}

tests_but() {
    ctest --test-dir "$build" --output-on-failure --no-tests=error -E "$1"
}

tests_named() {
    ctest --test-dir "$build" --output-on-failure --no-tests=error -R "^($1)\$"
}

# The C programs once more under valgrind: no wrong access, no leak. It replaces the allocator, so allocations.c has nothing to count.
under_valgrind() {
    local room program
    room=$(mktemp -d)
    for program in lifecycle errors threads golden; do
        echo "$program"
        local arguments=()
        [[ $program == golden ]] && arguments=("$root/c_tests/golden")
        (cd "$room" && valgrind --quiet --error-exitcode=1 --leak-check=full --show-leak-kinds=definite,indirect,possible \
            --errors-for-leak-kinds=definite,indirect,possible --suppressions="$root/c_tests/valgrind.supp" \
            "$build/c_tests/$program" "${arguments[@]}") || return 1
    done
    rm -rf "$room"
}

stage "packages" install_missing
stage "format" cargo fmt --check
stage "clippy" cargo clippy --locked --all-targets -- -D warnings
stage "cargo test" cargo test --locked
stage "rustdoc" documentation
stage "cmake" cmake_build
stage "ctest" tests_but '^(shipped|install|abi)$'
stage "shipped library" tests_named shipped
stage "install" tests_named install
stage "abi" tests_named abi
stage "valgrind" under_valgrind

printf '\nALL PASSED in %d s:' "$SECONDS"
printf ' %s;' "${summary[@]}"
printf '\n'
