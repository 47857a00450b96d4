//! Gives the shared library its name in the dynamic linker's eyes: libkeepout.so with the ABI's version.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=src/ffi/version.rs");
    let source = std::fs::read_to_string("src/ffi/version.rs").expect("src/ffi/version.rs is there");
    let version = source
        .split_once("KO_ABI_VERSION: u32 = ")
        .and_then(|(_, rest)| rest.split_once(';'))
        .map(|(number, _)| number)
        .expect("src/ffi/version.rs says `KO_ABI_VERSION: u32 = N;`");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux") {
        println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libkeepout.so.{version}");
    }
}
