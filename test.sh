#!/usr/bin/env bash
# test.sh: everything that must hold, stage by stage, with the time of each. Needs a Rust toolchain; on Debian it installs what else is missing.
#
#   KEEPOUT_DATA           folder of the test data; ../shared/data beside the project otherwise
#   KEEPOUT_REQUIRE_DATA   1: tests without their data fail instead of being skipped
#   KEEPOUT_LONG           1: valgrind runs the programs that take it minutes, too: that of Fortran, and certificates
#   CMAKE_BUILD_PARALLEL_LEVEL, CARGO_BUILD_JOBS   jobs at once, all cores otherwise
set -euo pipefail

# Folders are told from where this was called.
for name in KEEPOUT_DATA CARGO_TARGET_DIR; do
    [[ -z ${!name:-} ]] || export "$name=$(realpath -m -- "${!name}")"
done
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

packages() {
    source cmake/install_missing.sh
    need_rust fmt clippy || return 1
    need gcc command -v cc
    need g++ command -v c++
    need libc6-dev test -f /usr/include/stdio.h
    need gfortran command -v gfortran
    need python3-numpy find_numpy
    need python3-matplotlib find_matplotlib
    need binutils command -v objcopy
    need cmake command -v cmake
    need ninja-build command -v ninja
    need pkg-config command -v pkg-config
    need libcgal-dev test -f /usr/include/CGAL/version.h
    need libpng-dev test -f /usr/include/png.h
    need libceres-dev test -f /usr/include/ceres/ceres.h
    need coinor-libipopt-dev pkg-config --exists ipopt
    need libboost-dev test -f /usr/include/boost/version.hpp
    need libeigen3-dev test -d /usr/include/eigen3
    need libnlopt-dev test -f /usr/include/nlopt.h
    need libnlopt-cxx-dev test -f /usr/include/nlopt.hpp
    need abigail-tools command -v abidw
    need valgrind command -v valgrind
    install_missing
}

# The bench's crate is a workspace of its own; to lint it would take its dependencies.
format() {
    cargo fmt --check && cargo fmt --check --manifest-path benches/peers/Cargo.toml
}

documentation() {
    RUSTDOCFLAGS="${KEEPOUT_REQUIRE_DATA:+-D warnings}" cargo doc --locked --no-deps
}

cmake_build() {
    cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DKEEPOUT_REQUIRE_OPTIMISERS=ON \
        -DKEEPOUT_CARGO_TARGET_DIR="$target/shipped" &&
        cmake --build "$build"
}

tests_but() {
    ctest --test-dir "$build" --output-on-failure --no-tests=error -E "$1"
}

tests_named() {
    ctest --test-dir "$build" --output-on-failure --no-tests=error -R "^($1)\$"
}

# The programs of C and Fortran once more under valgrind: no wrong access, no leak. It replaces the allocator, so allocations.c has nothing to
# count. As many at once as there are cores, those that take minutes first.
under_valgrind() (
    room=$(mktemp -d) || exit 1
    trap 'kill $(jobs -p) 2>/dev/null || true; rm -rf "$room"' EXIT
    programs=(errors_later refined threads lifecycle plane level_sets normals clouds refits sensitivity constraints constraints_errors formulations
        cogen cogen_errors pair_choices part_meshes assemblies errors golden)
    [[ -z ${KEEPOUT_LONG:-} ]] || programs=(fortran certify "${programs[@]}")
    data=${KEEPOUT_DATA:-$root/../shared/data}
    [[ -d $data ]] && programs+=(bad_data)
    declare -A running=()
    # Waits for one that ends, and shows what it wrote.
    finish() {
        local passed=1 ended
        wait -n -p ended "${!running[@]}" || passed=0
        echo "${running[$ended]}"
        cat "$room/${running[$ended]}.log"
        ((passed)) || { echo "${running[$ended]} failed under valgrind"; exit 1; }
        unset "running[$ended]"
    }
    for program in "${programs[@]}"; do
        ((${#running[@]} < $(nproc))) || finish
        arguments=()
        [[ $program == golden ]] && arguments=("$root/c_tests/golden")
        [[ $program == certify || $program == sensitivity ]] && arguments=(quick)
        [[ $program == bad_data ]] && arguments=("$(realpath "$data")")
        mkdir "$room/$program" || exit 1
        (cd "$room/$program" && exec valgrind --quiet --error-exitcode=1 --leak-check=full \
            --show-leak-kinds=definite,indirect,possible --errors-for-leak-kinds=definite,indirect,possible \
            --suppressions="$root/c_tests/valgrind.supp" "$build/c_tests/$program" "${arguments[@]}") >"$room/$program.log" 2>&1 &
        running[$!]=$program
    done
    while ((${#running[@]})); do finish; done
)

stage "packages" packages
stage "format" format
# A newer toolchain than ours may warn of more: only CI takes warnings for errors.
stage "clippy" cargo clippy --locked --all-targets -- ${KEEPOUT_REQUIRE_DATA:+-D warnings}
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
