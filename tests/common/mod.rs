//! What the integration tests share.

use std::io::Write;
use std::path::{Path, PathBuf};

/// The folder of test data: `$KEEPOUT_DATA`, or `../shared/data` beside the crate. Where there is none the calling test
/// should return, unless `KEEPOUT_REQUIRE_DATA` is 1: then this fails.
pub fn data_dir() -> Option<PathBuf> {
    let dir = match std::env::var_os("KEEPOUT_DATA") {
        Some(dir) => PathBuf::from(dir),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"),
    };
    if dir.join("PROVENANCE.md").is_file() {
        return Some(dir);
    }
    let message = format!("no test data in {}; set KEEPOUT_DATA to its folder", dir.display());
    assert!(std::env::var("KEEPOUT_REQUIRE_DATA").as_deref() != Ok("1"), "{message}");
    // Past the test harness, which shows what a passing test prints to no one.
    let _ = writeln!(std::io::stderr(), "SKIPPED: {message}");
    None
}
