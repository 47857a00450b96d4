# Libraries, headers, the package for find_package(keepout) and the file for pkg-config. All of it may be moved as one tree.

include(CMakePackageConfigHelpers)

set(keepout_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/keepout")
set(keepout_staging "${PROJECT_BINARY_DIR}/package")

configure_package_config_file(cmake/keepout-config.cmake.in "${keepout_staging}/keepout-config.cmake"
  INSTALL_DESTINATION "${keepout_package_dir}" PATH_VARS CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_INCLUDEDIR)
# Before 1.0 a minor version may break what the one before it offered.
write_basic_package_version_file("${keepout_staging}/keepout-config-version.cmake" COMPATIBILITY SameMinorVersion)

file(RELATIVE_PATH keepout_prefix_from_pc "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" "${CMAKE_INSTALL_PREFIX}")
# The folders may be given as absolute paths.
file(RELATIVE_PATH keepout_libdir_from_prefix "${CMAKE_INSTALL_PREFIX}" "${CMAKE_INSTALL_FULL_LIBDIR}")
file(RELATIVE_PATH keepout_includedir_from_prefix "${CMAKE_INSTALL_PREFIX}" "${CMAKE_INSTALL_FULL_INCLUDEDIR}")
configure_file(cmake/keepout.pc.in "${keepout_staging}/keepout.pc" @ONLY)

list(GET keepout_files 0 keepout_shared)
install(PROGRAMS "${keepout_shared}" DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(FILES "${keepout_lib_dir}/${keepout_soname}" "${keepout_lib_dir}/libkeepout.so" "${keepout_lib_dir}/libkeepout.a"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}")
# Debuggers look for debug information beside a library in .debug.
install(FILES "${keepout_shared}.debug" DESTINATION "${CMAKE_INSTALL_LIBDIR}/.debug" COMPONENT debug)
install(DIRECTORY include/ DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "keepout.*")
install(FILES "${keepout_staging}/keepout-config.cmake" "${keepout_staging}/keepout-config-version.cmake"
        cmake/keepout-targets.cmake DESTINATION "${keepout_package_dir}")
install(FILES "${keepout_staging}/keepout.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
# The Python module, which looks for the library from there.
install(FILES examples/python/keepout.py DESTINATION "${CMAKE_INSTALL_DATADIR}/keepout/python")
install(FILES LICENSE-APACHE LICENSE-MIT DESTINATION "${CMAKE_INSTALL_DOCDIR}")
