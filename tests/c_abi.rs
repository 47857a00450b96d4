//! The C programs of `c_tests`, compiled and linked with the static library that cargo made beside this test: the ABI without CMake.

#![cfg(target_os = "linux")]

mod common;

use std::path::{Path, PathBuf};
use std::process::Command;

/// What `rustc --print native-static-libs` says of the static library.
const NATIVE_LIBRARIES: [&str; 6] = ["-lgcc_s", "-lutil", "-lrt", "-lpthread", "-lm", "-ldl"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// `target/<profile>/deps`, where this test lies and `libkeepout.a` with it.
fn deps() -> PathBuf {
    let test = std::env::current_exe().expect("the test knows its path");
    test.parent().expect("a file lies in a folder").to_owned()
}

/// A folder of this program's own to run in.
fn folder_for(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c_abi").join(name);
    std::fs::create_dir_all(&folder).expect("the folder is made");
    folder
}

fn compile(name: &str, folder: &Path) -> PathBuf {
    let target = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let compiler = cc::Build::new().target(&target).host(&target).opt_level(1).cargo_metadata(false).get_compiler();
    let program = folder.join(name);
    let status = compiler
        .to_command()
        .args(["-std=c99", "-D_XOPEN_SOURCE=700", "-Wall", "-Wextra", "-pedantic", "-Werror"])
        .arg("-I")
        .arg(root().join("include"))
        .arg(root().join("c_tests").join(name).with_extension("c"))
        .arg(deps().join("libkeepout.a"))
        .args(NATIVE_LIBRARIES)
        .arg("-o")
        .arg(&program)
        .status()
        .expect("the C compiler starts");
    assert!(status.success(), "{name}.c does not compile");
    program
}

fn run(name: &str, arguments: &[&Path]) {
    let folder = folder_for(name);
    let output = Command::new(compile(name, &folder)).args(arguments).current_dir(&folder).output();
    let output = output.expect("the program starts");
    assert!(output.status.success(), "{name}: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr));
}

#[test]
fn lifecycle() {
    run("lifecycle", &[]);
}

#[test]
fn errors() {
    run("errors", &[]);
}

#[test]
fn threads() {
    run("threads", &[]);
}

#[test]
fn allocations() {
    run("allocations", &[]);
}

#[test]
fn golden() {
    run("golden", &[&root().join("c_tests/golden")]);
}

#[test]
fn bad_data() {
    let Some(data) = common::data_dir() else { return };
    run("bad_data", &[&data]);
}
