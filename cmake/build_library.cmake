# Run at build time: cargo, then the shared library parted from its debug information.
# Takes CARGO, SOURCE_DIR, TARGET_DIR, LIB_DIR, FILE, SONAME, OBJCOPY.

cmake_minimum_required(VERSION 3.21)

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# What is shipped names no folder of the machine that built it: not the sources, nor those of dependencies and the standard library.
find_program(RUSTC rustc PATHS "$ENV{CARGO_HOME}/bin" "$ENV{HOME}/.cargo/bin" REQUIRED)
execute_process(COMMAND "${RUSTC}" --print sysroot WORKING_DIRECTORY "${SOURCE_DIR}" OUTPUT_VARIABLE sysroot
                OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
set(cargo_home "$ENV{CARGO_HOME}")
if(NOT cargo_home)
  set(cargo_home "$ENV{HOME}/.cargo")
endif()
# The folders below must be there before the flags are made: flags that change from the first build to the second build all anew.
execute_process(COMMAND "${RUSTC}" -vV OUTPUT_VARIABLE version COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "host: ([^\n]+)" host "${version}")
execute_process(COMMAND "${CARGO}" fetch --quiet --locked --target "${CMAKE_MATCH_1}" WORKING_DIRECTORY "${SOURCE_DIR}"
                COMMAND_ERROR_IS_FATAL ANY)
file(GLOB registries "${cargo_home}/registry/src/*")
set(flags "--remap-path-prefix=${cargo_home}=cargo")
foreach(registry IN LISTS registries)
  list(APPEND flags "--remap-path-prefix=${registry}=crates")
endforeach()
# The last that matches counts.
list(APPEND flags "--remap-path-prefix=${sysroot}/lib/rustlib/src/rust=rust" "--remap-path-prefix=${SOURCE_DIR}=keepout"
     "--remap-path-prefix=${TARGET_DIR}=target")
string(ASCII 31 separator)
# As cargo parts them: at blanks, any number of them, and at nothing else.
string(STRIP "$ENV{RUSTFLAGS}" own_flags)
string(REGEX REPLACE " +" "${separator}" own_flags "${own_flags}")
string(REPLACE ";" "${separator}" flags "${flags}")
if(own_flags)
  string(PREPEND flags "${own_flags}${separator}")
endif()
set(ENV{CARGO_ENCODED_RUSTFLAGS} "${flags}")

execute_process(COMMAND "${CARGO}" build --release --locked --lib --target-dir "${TARGET_DIR}"
                WORKING_DIRECTORY "${SOURCE_DIR}" COMMAND_ERROR_IS_FATAL ANY)

set(built "${TARGET_DIR}/release")
file(MAKE_DIRECTORY "${LIB_DIR}")
run("${OBJCOPY}" --only-keep-debug "${built}/libkeepout.so" "${LIB_DIR}/${FILE}.debug")
run("${OBJCOPY}" --strip-unneeded "--add-gnu-debuglink=${LIB_DIR}/${FILE}.debug" "${built}/libkeepout.so" "${LIB_DIR}/${FILE}")
run("${OBJCOPY}" --strip-debug "${built}/libkeepout.a" "${LIB_DIR}/libkeepout.a")
file(CREATE_LINK "${FILE}" "${LIB_DIR}/${SONAME}" SYMBOLIC)
file(CREATE_LINK "${SONAME}" "${LIB_DIR}/libkeepout.so" SYMBOLIC)
