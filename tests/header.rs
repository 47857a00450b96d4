//! `include/keepout.h` is what cbindgen makes of `src/ffi`. To bring it up to date: `KEEPOUT_BLESS=1 cargo test --test header`.

use std::path::Path;

#[test]
fn the_committed_header_is_up_to_date() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("cbindgen.toml is read");
    // In the order in which a newcomer reads them.
    let files = ["status", "version", "mesh", "cloud", "fit_options", "field", "report"];
    let builder = files.iter().fold(cbindgen::Builder::new().with_config(config), |builder, file| {
        builder.with_src(root.join(format!("src/ffi/{file}.rs")))
    });
    let bindings = builder.generate().expect("the header is generated");
    let mut generated = Vec::new();
    bindings.write(&mut generated);
    let path = root.join("include/keepout.h");
    if std::env::var_os("KEEPOUT_BLESS").is_some() {
        std::fs::write(&path, &generated).expect("the header is written");
    }
    let committed = std::fs::read(&path).expect("include/keepout.h is there");
    assert!(
        committed == generated,
        "include/keepout.h is stale: run `KEEPOUT_BLESS=1 cargo test --test header` and commit it"
    );
}
