# keepout::keepout and keepout::keepout_static, in the build tree and in an installed one alike.
# Takes keepout_lib_dir, keepout_include_dir, keepout_file, keepout_soname, keepout_scope (GLOBAL or empty).

if(NOT TARGET keepout::keepout)
  add_library(keepout::keepout SHARED IMPORTED ${keepout_scope})
  set_target_properties(keepout::keepout PROPERTIES
    IMPORTED_LOCATION "${keepout_lib_dir}/${keepout_file}"
    IMPORTED_SONAME "${keepout_soname}"
    INTERFACE_INCLUDE_DIRECTORIES "${keepout_include_dir}")
endif()

if(NOT TARGET keepout::keepout_static)
  add_library(keepout::keepout_static STATIC IMPORTED ${keepout_scope})
  set_target_properties(keepout::keepout_static PROPERTIES
    IMPORTED_LOCATION "${keepout_lib_dir}/libkeepout.a"
    INTERFACE_LINK_LIBRARIES "gcc_s;util;rt;pthread;m;dl;c"
    INTERFACE_INCLUDE_DIRECTORIES "${keepout_include_dir}")
endif()
