//! Versions and capabilities.

use std::ffi::c_char;

/// Version of the ABI that this header describes; it is the number in the soname. It moves when the ABI breaks, and only then.
pub const KO_ABI_VERSION: u32 = 0;

/// Bit of `ko_capabilities`: meshes and fields in three dimensions.
pub const KO_CAPABILITY_3D: u64 = 1;

/// Bit of `ko_capabilities`: files compressed by gzip are read.
pub const KO_CAPABILITY_GZIP: u64 = 2;

/// Bit of `ko_capabilities`: curves and fields in the plane.
pub const KO_CAPABILITY_2D: u64 = 4;

/// Version of the library as "major.minor.patch". Never NULL; static. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn ko_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// Version of the ABI of the library that is loaded: compare with `KO_ABI_VERSION`, that of the header. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn ko_abi_version() -> u32 {
    KO_ABI_VERSION
}

/// What this build can do, as an or of `KO_CAPABILITY_` bits. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn ko_capabilities() -> u64 {
    KO_CAPABILITY_3D | KO_CAPABILITY_GZIP | KO_CAPABILITY_2D
}
