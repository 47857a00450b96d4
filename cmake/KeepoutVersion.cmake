# KEEPOUT_VERSION from Cargo.toml, KEEPOUT_ABI_VERSION from src/ffi/version.rs: neither is written anywhere else.

set(keepout_root "${CMAKE_CURRENT_LIST_DIR}/..")
set(keepout_version_sources "${keepout_root}/Cargo.toml" "${keepout_root}/src/ffi/version.rs")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${keepout_version_sources})

# Sets `variable` to what the first group of `pattern` matches in `file`.
function(keepout_read_version variable file pattern)
  file(STRINGS "${file}" line REGEX "${pattern}" LIMIT_COUNT 1)
  if(NOT line MATCHES "${pattern}")
    message(FATAL_ERROR "${file} has no line like ${pattern}")
  endif()
  set(${variable} "${CMAKE_MATCH_1}" PARENT_SCOPE)
endfunction()

keepout_read_version(KEEPOUT_VERSION "${keepout_root}/Cargo.toml" "^version = \"([0-9]+\\.[0-9]+\\.[0-9]+)\"")
keepout_read_version(KEEPOUT_ABI_VERSION "${keepout_root}/src/ffi/version.rs" "KO_ABI_VERSION: u32 = ([0-9]+)")
