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

/// The program of the file `source` of `c_tests`, with the header in `include`.
fn compile(source: &Path, include: &Path, folder: &Path) -> PathBuf {
    let target = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let compiler = cc::Build::new().target(&target).host(&target).opt_level(1).cargo_metadata(false).get_compiler();
    let program = folder.join(source.file_stem().expect("a source has a name"));
    let status = compiler
        .to_command()
        .args(["-std=c99", "-D_XOPEN_SOURCE=700", "-Wall", "-Wextra", "-pedantic", "-Werror"])
        .arg("-I")
        .arg(include)
        .arg(source)
        .arg(deps().join("libkeepout.a"))
        .args(NATIVE_LIBRARIES)
        .arg("-o")
        .arg(&program)
        .status()
        .expect("the C compiler starts");
    assert!(status.success(), "{} does not compile", source.display());
    program
}

fn run(name: &str, arguments: &[&Path]) {
    let source = root().join("c_tests").join(name).with_extension("c");
    run_with_header(name, &source, &root().join("include"), arguments);
}

fn run_with_header(name: &str, source: &Path, include: &Path, arguments: &[&Path]) {
    let folder = folder_for(name);
    let output = Command::new(compile(source, include, &folder)).args(arguments).current_dir(&folder).output();
    let output = output.expect("the program starts");
    assert!(output.status.success(), "{name}: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr));
}

#[test]
fn lifecycle() {
    run("lifecycle", &[]);
}

#[test]
fn plane() {
    run("plane", &[]);
}

#[test]
fn level_sets() {
    run("level_sets", &[]);
}

#[test]
fn normals() {
    run("normals", &[]);
}

#[test]
fn clouds() {
    run("clouds", &[]);
}

#[test]
fn refits() {
    run("refits", &[]);
}

#[test]
fn refined() {
    run("refined", &[]);
}

#[test]
fn constraints() {
    run("constraints", &[]);
}

#[test]
fn constraints_errors() {
    run("constraints_errors", &[]);
}

#[test]
fn certify() {
    run("certify", &[]);
}

#[test]
fn formulations() {
    run("formulations", &[]);
}

#[test]
fn cogen() {
    run("cogen", &[]);
}

#[test]
fn pair_choices() {
    run("pair_choices", &[]);
}

#[test]
fn part_meshes() {
    run("part_meshes", &[]);
}

#[test]
fn assemblies() {
    run("assemblies", &[]);
}

#[test]
fn cogen_errors() {
    run("cogen_errors", &[]);
}

#[test]
fn sensitivity() {
    run("sensitivity", &[]);
}

#[test]
fn errors() {
    run("errors", &[]);
}

#[test]
fn errors_later() {
    run("errors_later", &[]);
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

/// Programs of versions that are out, compiled with the headers of their time, run with this library: as long as the ABI's version stays.
#[test]
fn callers_of_kept_versions() {
    let mut versions = 0;
    for entry in root().join("c_tests/abi").read_dir().expect("the folder is there") {
        let kept = entry.expect("the folder is read").path();
        if kept.is_dir() {
            let version = kept.file_name().expect("a folder has a name").to_string_lossy().into_owned();
            run_with_header(&format!("kept_{version}"), &kept.join("lifecycle.c"), &kept, &[]);
            versions += 1;
        }
    }
    assert!(versions > 0, "no version is kept");
}

#[test]
fn bad_data() {
    let Some(data) = common::data_dir() else { return };
    run("bad_data", &[&data]);
}
