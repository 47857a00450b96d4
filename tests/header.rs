//! `include/keepout.h` is what cbindgen makes of `src/ffi`. To bring it up to date: `KEEPOUT_BLESS=1 cargo test --test header`.

use std::path::Path;

/// The header that `src/ffi` makes.
fn generated() -> Vec<u8> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("cbindgen.toml is read");
    // In the order in which a newcomer reads them.
    let files = [
        "status",
        "version",
        "progress",
        "mesh",
        "cloud",
        "normals",
        "smooth",
        "fit_options",
        "field",
        "sensitivity",
        "level_set",
        "certify",
        "report",
        "aggregation",
        "body",
        "constraints",
        "formulations",
        "motion",
        "part",
        "part_mesh",
        "pair_options",
        "sweep",
        "pair",
        "pair_shapes",
        "pair_contact",
        "pair_optimise",
        "assembly",
    ];
    let builder = files.iter().fold(cbindgen::Builder::new().with_config(config), |builder, file| {
        builder.with_src(root.join(format!("src/ffi/{file}.rs")))
    });
    let bindings = builder.generate().expect("the header is generated");
    let mut generated = Vec::new();
    bindings.write(&mut generated);
    generated
}

#[test]
fn the_committed_header_is_up_to_date() {
    let generated = generated();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("include/keepout.h");
    if std::env::var_os("KEEPOUT_BLESS").is_some() {
        std::fs::write(&path, &generated).expect("the header is written");
    }
    let committed = std::fs::read(&path).expect("include/keepout.h is there");
    assert!(
        committed == generated,
        "include/keepout.h is stale: run `KEEPOUT_BLESS=1 cargo test --test header` and commit it"
    );
}

/// The number after "Default" in the comment on a field of a struct of options.
fn documented_default(header: &str, field: &str) -> f64 {
    let (before, _) = header.split_once(&format!(" {field};")).expect("the field is in the header");
    let (_, comment) = before.rsplit_once("/**").expect("the field has a comment");
    let (_, default) = comment.split_once("Default ").expect("the comment tells the default");
    let number: String = default.chars().take_while(|c| c.is_ascii_alphanumeric() || ".-".contains(*c)).collect();
    number.trim_end_matches('.').parse().expect("the default is a number")
}

#[test]
fn the_header_tells_the_defaults_of_the_code() {
    // Generated, not read: the other test may be writing the file at this moment.
    let header = String::from_utf8(generated()).expect("the header is text");
    let d = keepout::field::FitOptions::default();
    let l = keepout::field::LevelSetOptions::default();
    let n = keepout::geometry::orient::NormalOptions::default();
    let s = keepout::geometry::smooth::SmoothOptions::default();
    let c = keepout::field::CertifyOptions::default();
    let o = keepout::cogen::OptimiseOptions::default();
    let p = keepout::cogen::PersistenceOptions::default();
    let a = keepout::cogen::ArrangeOptions::default();
    let e = keepout::constraint::formulations::ExplicitOptions::default();
    let defaults = [
        ("reweightings", f64::from(d.reweightings)),
        ("margin", d.margin),
        ("lambda_normal", d.normal_weight),
        ("lambda_smooth", d.smooth_weight),
        ("distance_weight", d.distance_weight),
        ("tolerance", d.tolerance),
        ("max_iterations", f64::from(d.max_iterations)),
        ("max_unknowns", d.max_unknowns as f64),
        ("subdivisions", f64::from(l.subdivisions)),
        ("shortest_edge", l.shortest_edge),
        ("relaxations", f64::from(l.relaxations)),
        ("outlier_factor", n.outlier_factor),
        ("rounds", f64::from(s.rounds)),
        ("max_boxes", c.max_boxes as f64),
        ("softening", e.softening),
        ("exponent", f64::from(e.exponent)),
        ("slack", 0.05),
        ("gap", keepout::cogen::FamilyOptions::default().gap),
        ("gamma", o.gamma),
        ("feasibility", o.feasibility),
        ("n_times", p.n_times as f64),
        ("max_tries", p.max_tries as f64),
        ("max_rounds", a.max_rounds as f64),
        ("max_starts", a.max_starts as f64),
    ];
    for (field, default) in defaults {
        assert_eq!(documented_default(&header, field), default, "{field}");
    }
}
