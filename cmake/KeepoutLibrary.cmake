# The library by cargo, laid out under lib/ of the build tree as it will be installed, and the targets that stand for it there.

# The PATH's comes before the one that rustup put where the PATH may not lead.
find_program(CARGO cargo PATHS "$ENV{CARGO_HOME}/bin" "$ENV{HOME}/.cargo/bin" REQUIRED)
mark_as_advanced(CARGO)

set(keepout_lib_dir "${PROJECT_BINARY_DIR}/lib")
set(keepout_soname "libkeepout.so.${KEEPOUT_ABI_VERSION}")
set(keepout_file "libkeepout.so.${PROJECT_VERSION}")
set(keepout_files "${keepout_lib_dir}/${keepout_file}" "${keepout_lib_dir}/${keepout_soname}" "${keepout_lib_dir}/libkeepout.so"
    "${keepout_lib_dir}/${keepout_file}.debug" "${keepout_lib_dir}/libkeepout.a")

file(GLOB_RECURSE keepout_sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/*.rs")
list(APPEND keepout_sources "${PROJECT_SOURCE_DIR}/Cargo.toml" "${PROJECT_SOURCE_DIR}/Cargo.lock"
     "${PROJECT_SOURCE_DIR}/build.rs" "${CMAKE_CURRENT_LIST_DIR}/build_library.cmake")

add_custom_command(
  OUTPUT ${keepout_files}
  COMMAND ${CMAKE_COMMAND} "-DCARGO=${CARGO}" "-DSOURCE_DIR=${PROJECT_SOURCE_DIR}" "-DTARGET_DIR=${KEEPOUT_CARGO_TARGET_DIR}"
          "-DLIB_DIR=${keepout_lib_dir}" "-DFILE=${keepout_file}" "-DSONAME=${keepout_soname}"
          "-DOBJCOPY=${CMAKE_OBJCOPY}" -P "${CMAKE_CURRENT_LIST_DIR}/build_library.cmake"
  DEPENDS ${keepout_sources}
  COMMENT "Building libkeepout ${PROJECT_VERSION} by cargo"
  USES_TERMINAL VERBATIM)
add_custom_target(keepout_library ALL DEPENDS ${keepout_files})

set(keepout_scope GLOBAL)
set(keepout_include_dir "${PROJECT_SOURCE_DIR}/include")
include("${CMAKE_CURRENT_LIST_DIR}/keepout-targets.cmake")
add_dependencies(keepout::keepout keepout_library)
add_dependencies(keepout::keepout_static keepout_library)
