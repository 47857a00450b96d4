use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use flate2::Compression;
use flate2::write::GzEncoder;
use proptest::prelude::*;
use std::io::Write;

use super::*;
use crate::error::Place;

/// A tetrahedron in each of the formats.
const OBJ: &str = "# four\nmtllib none.mtl\no a\nv 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\ng lower\nf 1 3 2\nvt 0 0\nv 0 0 1\n\
                   usemtl gone\nf 1/1 2/1 4/1\ng upper\nf -3//7 -2//7 -1//7\nf 1 \\\n4 3\n";
const OFF: &str = "OFF\n# four\n4 4 6\n0 0 0\n1 0 0\n\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3 255 0 0\n3 1 2 3\n3 0 3 2\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment four\nelement material 1\nproperty list uchar int ids\n\
                   element vertex 4\nproperty uchar red\nproperty float x\nproperty float y\nproperty float z\n\
                   element face 4\nproperty list uchar int vertex_index\nproperty float quality\nend_header\n\
                   2 7 8\n0 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n3 0 2 1 .5\n3 0 1 3 .5\n3 1 2 3 .5\n3 0 3 2 .5\n";

const POINTS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

fn stl_text() -> String {
    let mut text = String::from("solid a b\n");
    for face in FACES {
        text += "facet normal nan nan nan\n outer loop\n";
        for p in face.map(|i| POINTS[i as usize]) {
            text += &format!("  vertex {:e} {} {}\n", p[0], p[1], p[2]);
        }
        text += " endloop\nendfacet\n";
    }
    text + "endsolid a b\n"
}

fn stl_binary() -> Vec<u8> {
    let mut bytes = format!("{:80}", "solid in name only").into_bytes();
    bytes.extend((FACES.len() as u32).to_le_bytes());
    for face in FACES {
        bytes.extend([0; 12]);
        face.iter().flat_map(|&i| POINTS[i as usize]).for_each(|x| bytes.extend((x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ply_binary(format: &str, float: impl Fn(f32) -> [u8; 4], int: impl Fn(i32) -> [u8; 4]) -> Vec<u8> {
    let header = PLY.split_inclusive("end_header\n").next().unwrap_or_default().replace("ascii", format);
    let mut bytes = header.into_bytes();
    bytes.push(2);
    bytes.extend([int(7), int(8)].concat());
    for p in POINTS {
        bytes.push(0);
        p.iter().for_each(|&x| bytes.extend(float(x as f32)));
    }
    for face in FACES {
        bytes.push(3);
        face.iter().for_each(|&i| bytes.extend(int(i as i32)));
        bytes.extend(float(0.5));
    }
    bytes
}

/// The tetrahedron in every form.
fn samples() -> Vec<(Format, Vec<u8>)> {
    vec![
        (Format::Obj, OBJ.into()),
        (Format::Off, OFF.into()),
        (Format::Ply, PLY.into()),
        (Format::Ply, ply_binary("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes)),
        (Format::Ply, ply_binary("binary_big_endian", f32::to_be_bytes, i32::to_be_bytes)),
        (Format::Stl, stl_text().into()),
        (Format::Stl, stl_binary()),
    ]
}

fn extension(format: Format) -> &'static str {
    match format {
        Format::Obj => "obj",
        Format::Off => "off",
        Format::Ply => "ply",
        Format::Stl => "stl",
    }
}

/// A file that goes when the test does.
struct Temporary(PathBuf);

impl Temporary {
    fn new(name: &str, bytes: &[u8]) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let unique = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("keepout-{}-{unique}-{name}", std::process::id()));
        std::fs::write(&path, bytes).expect("the temporary folder is writable");
        Temporary(path)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        std::fs::remove_file(&self.0).ok();
    }
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).expect("writing to memory");
    encoder.finish().expect("writing to memory")
}

/// Place and words of the fault in `bytes`.
fn fault(format: Format, bytes: impl AsRef<[u8]>) -> (Place, String) {
    match parse(format, bytes.as_ref()) {
        Err(Fault::Format { place, message }) => (place, message),
        other => panic!("a fault of the file was expected, not {other:?}"),
    }
}

#[test]
fn every_form_reads_alike_packed_or_not() {
    for (format, bytes) in samples() {
        for (name, content) in [("a.", bytes.clone()), ("packed.", gzip(&bytes))] {
            let file = Temporary::new(&format!("{name}{}", extension(format)), &content);
            let mesh = Mesh::read(&file.0).unwrap();
            assert_eq!(mesh.vertices().len(), 4, "{format:?}");
            let corners = |t: usize| mesh.corners(t);
            let expected = |t: usize| FACES[t].map(|i| POINTS[i as usize]);
            assert!((0..4).all(|t| corners(t) == expected(t)), "{format:?}: {mesh:?}");
            let report = mesh.report().unwrap();
            assert!(report.closed && report.oriented && report.manifold && report.volume > 0.0);
        }
    }
}

#[test]
fn the_name_decides_where_the_content_does_not() {
    let format = |name: &str, content: &str| format_of(Path::new(name), content.as_bytes());
    assert_eq!(format("A.OBJ", "").unwrap(), Format::Obj);
    assert_eq!(format("a.b.stl.GZ", "solid").unwrap(), Format::Stl);
    assert_eq!(format("a.txt", "ply\r\n").unwrap(), Format::Ply);
    assert_eq!(format("a", "# by hand\nCOFF 3 1").unwrap(), Format::Off);
    for name in ["a.step", "a", "obj", ""] {
        let error = format(name, "v 0 0 0").unwrap_err().to_string();
        assert!(error.contains(".obj, .off, .ply and .stl"), "{error}");
    }
    assert!(matches!(read(Path::new("no such file.obj")), Err(Error::Io { .. })));
    assert!(matches!(read(&std::env::temp_dir()), Err(Error::Io { .. } | Error::Unsupported(_))));
}

#[test]
fn gzip_cut_short_is_an_error() {
    let packed = gzip(OFF.as_bytes());
    let file = Temporary::new("cut.off.gz", &packed[..packed.len() / 2]);
    let error = Mesh::read(&file.0).unwrap_err().to_string();
    assert!(error.contains("gzip data is damaged or cut short"), "{error}");
}

#[test]
fn unpacking_stops_at_the_limit() {
    let file = Temporary::new("bomb.off.gz", &gzip(&vec![b' '; 1 << 22]));
    assert!(std::fs::metadata(&file.0).unwrap().len() < 1 << 14);
    assert!(load::load(&file.0, 1 << 22).is_ok());
    assert!(matches!(load::load(&file.0, 1 << 16), Err(Error::OutOfMemory { limit: Some(65_536), .. })));
}

#[test]
fn obj_keeps_the_numbers_of_the_file() {
    for (n, text) in [
        (1, "v 5 5 5\nf 1 1 1"),
        (2, "v 5 5 5\nv 6 6 6\nf 2 2 1"),
        (5, "f 4 5 2\nv 0 0 0\nv 1 1 1\nv 2 2 2\nv 3 3 3\nv 4 4 4"),
    ] {
        let mesh = parse(Format::Obj, text.as_bytes()).unwrap();
        assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (n, 1), "{text}");
    }
    let mesh = parse(Format::Obj, b"v 0 0 0\nv 9 9 9\nv 1 0 0\nv 0 0 0\nv 0 1 0\nf 5 4 3 1").unwrap();
    assert_eq!(mesh.triangles(), [[4, 3, 2], [4, 2, 0]]);
    assert_eq!(mesh.vertices()[1], [9.0; 3]);
}

#[test]
fn obj_corners_take_every_form() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
    for (face, triangles) in [
        ("f 1 2 3", &[[0, 1, 2]][..]),
        ("f 1/9 2/8 3/7", &[[0, 1, 2]]),
        ("f 1//9 2//8 3//7", &[[0, 1, 2]]),
        ("f 1/9/9 2/8/8 3/7/7 # the first", &[[0, 1, 2]]),
        ("f\t-4 -3/1 -1//2", &[[0, 1, 3]]),
        ("f 1 2 \\\n 4 3\n", &[[0, 1, 3], [0, 3, 2]]),
        ("g a b\ns off\nf 1 2 3\ng\nl 1 2\nf 2 4 3", &[[0, 1, 2], [1, 3, 2]]),
    ] {
        for text in [format!("{vertices}{face}"), format!("{vertices}{face}").replace('\n', "\r\n")] {
            assert_eq!(parse(Format::Obj, text.as_bytes()).unwrap().triangles(), triangles, "{text:?}");
        }
    }
    // Negative numbers count from where they stand, not from the end of the file.
    let early = parse(Format::Obj, format!("{vertices}f -4 -3 -2\nv 9 9 9\n").as_bytes()).unwrap();
    assert_eq!((early.triangles(), early.vertices().len()), (&[[0, 1, 2]][..], 5));
}

#[test]
fn obj_faults_name_their_line() {
    let cases = [
        ("v 0 0\nf 1 1 1", 1, "3 coordinates"),
        ("v 0 0 0\n\nv 0 x 0\nf 1 1 1", 3, "`v 0 x 0`"),
        ("v 0 0 0\nv 0 inf 0\nf 1 1 1", 2, "vertex 1 is (0, inf, 0)"),
        ("v 0 0 0\nf 1 1", 2, "face 0 has 2 corners"),
        ("v 0 0 0\nf 1 1 1\nf 1 1 2", 3, "face 1 names vertex 2; 1 to 1"),
        ("v 0 0 0\nf 1 1 0", 2, "names vertex 0"),
        ("v 0 0 0\nf 1 1 -2", 2, "names vertex -2"),
        ("v 0 0 0\nf 1 1 /1", 2, "without vertex, `/1`"),
        ("v 0 0 0\r\nf 1 1 b\r\n", 2, "`f 1 1 b`"),
        ("v 0 0 0\nf 1 1 99999999999999999999", 2, "a face needs"),
        ("v 0 0 0\nf -1 -1 -2\nv 0 0 0", 2, "names vertex -2; 1 to 2, or -1 to -1 here"),
        ("v 0 0 0\nf 1 \\\n1 \\\n2", 2, "names vertex 2"),
    ];
    for (text, line, words) in cases {
        let (place, message) = fault(Format::Obj, text);
        assert_eq!(place, Place::Line(line), "{text:?}: {message}");
        assert!(message.contains(words), "{text:?}: {message}");
    }
}

#[test]
fn off_takes_the_headers_in_use() {
    let body = "0 0 0 9 9 9\n1 0 0 9 9 9\n0 1 0 9 9 9\n3 0 1 2 1 0 0\n";
    for header in ["OFF 3 1 0\n", "OFF\n3 1\n", "# c\n\nCOFF # c\n3 1 0\n", "NOFF\r\n3 1 3\r\n", "STCNOFF\r3 1 3\r"] {
        let mesh = parse(Format::Off, format!("{header}{body}").as_bytes()).unwrap();
        assert_eq!(mesh.triangles(), [[0, 1, 2]], "{header:?}");
    }
    for header in ["OFF BINARY\n", "4OFF\n3 1 0\n", "nOFF\n"] {
        assert!(matches!(parse(Format::Off, header.as_bytes()), Err(Fault::Other(Error::Unsupported(_)))));
    }
}

#[test]
fn off_faults_name_their_line() {
    let cases = [
        ("of\n3 1 0", 1, "`OFF` was expected"),
        ("OFF", 1, "before the counts"),
        ("OFF\n3", 2, "the number of faces was expected"),
        ("OFF\n3 99999999999999999999 0", 2, "the number of faces was expected"),
        ("OFF\n18446744073709551615 18446744073709551615 0\n", 2, "but only 0 bytes follow"),
        ("OFF\n1 1 0\n0 0 0\n3 0 0 1\n", 4, "face 0 names vertex 1; the file has 1 vertices"),
        ("OFF\n1 1 0\n0 0 0\n3 0 0 -1\n", 4, "names vertex -1"),
        ("OFF\n1 1 0\n0 0 0\n4 0 0 0\n", 4, "announces 4 corners, but its line holds 3"),
        ("OFF\n1 1 0\n0 0 0\n2 0 0    \n", 4, "face 0 has 2 corners"),
        ("OFF\n1 1 0\n0 0    \n3 0 0 0\n", 3, "vertex 0 needs 3 coordinates"),
        ("OFF\n1 1 0\n0 0 1e999\n3 0 0 0\n", 3, "vertex 0 is (0, 0, inf)"),
    ];
    for (text, line, words) in cases {
        let (place, message) = fault(Format::Off, text);
        assert_eq!(place, Place::Line(line), "{text:?}: {message}");
        assert!(message.contains(words), "{text:?}: {message}");
    }
}

#[test]
fn ply_faults_name_their_line() {
    let cases = [
        ("ply ", "plx", 1, "`ply` was expected"),
        ("format ascii", "format text", 2, "`text` is not ascii"),
        ("float x", "quad x", 8, "`quad` is no type"),
        ("float x", "float u", 6, "no property x"),
        ("uchar int vertex_index", "float int vertex_index", 12, "integer type"),
        ("vertex_index\n", "others\n", 11, "no property list vertex_indices"),
        ("vertex 4", "vertex 18446744073709551615", 14, "of element vertex are announced"),
        ("vertex 4", "vertex -4", 6, "the count of element vertex"),
        ("element face", "element vertex", 11, "a second time"),
        ("2 7 8\n", "2000000 7 8\n", 15, "a list of length 2000000"),
        ("2 7 8\n", "-2 7 8\n", 15, "a list of length -2"),
        ("0 1 0 0\n", "0 1 NaN 0\n", 17, "vertex 1 is (1, NaN, 0)"),
        ("3 0 2 1", "3 0 2 9", 20, "face 0 names vertex 9"),
        ("3 0 2 1", "3 0 2 1.5", 20, "names vertex 1.5"),
        ("3 0 2 1", "2 0 2", 20, "face 0 has 2 corners"),
        ("end_header", "end", 14, "no keyword"),
    ];
    for (from, to, line, words) in cases {
        let text = if from == "ply " { PLY.replacen("ply", to, 1) } else { PLY.replacen(from, to, 1) };
        let (place, message) = fault(Format::Ply, text);
        assert_eq!(place, Place::Line(line), "{to:?}: {message}");
        assert!(message.contains(words), "{to:?}: {message}");
    }
    assert!(fault(Format::Ply, "ply\nformat ascii 1.0\nend_header\n").1.contains("no element vertex"));
}

#[test]
fn ply_counts_of_nothing_take_no_time() {
    let text = PLY.replacen("element vertex", "element nothing 18446744073709551615\nelement vertex", 1);
    assert!(parse(Format::Ply, text.as_bytes()).is_ok());
    // Nor memory: without columns, no number of bytes bounds the count.
    let bare = "ply\nformat ascii 1.0\nelement vertex 4294967295\nelement face 18446744073709551615\nend_header\n";
    assert_eq!(fault(Format::Ply, bare).0, Place::Line(3));
}

#[test]
fn stl_faults_name_line_or_byte() {
    let text = stl_text();
    let cases = [
        ("endsolid a b\n", "", 29, "`facet` or `endsolid`"),
        ("outer", "inner", 3, "`outer` was expected, found `inner`"),
        ("  vertex 0e0 1 0\n", "", 7, "face 0 has 2 corners"),
        ("vertex 0e0 1 0", "vertex 0e0 NaN 0", 5, "vertex 1 is (0, NaN, 0)"),
        ("vertex 0e0 1 0", "vertex 0e0 one 0", 5, "y was expected, found `one`"),
    ];
    for (from, to, line, words) in cases {
        let (place, message) = fault(Format::Stl, text.replacen(from, to, 1));
        assert_eq!(place, Place::Line(line), "{to:?}: {message}");
        assert!(message.contains(words), "{to:?}: {message}");
    }
    let mut bytes = stl_binary();
    bytes[84 + 50 + 16..84 + 50 + 20].copy_from_slice(&f32::NAN.to_le_bytes());
    let (place, message) = fault(Format::Stl, &bytes);
    assert_eq!(place, Place::Byte(84 + 50 + 12), "{message}");
    assert!(fault(Format::Stl, &bytes[..283]).1.contains("cut short"));
    assert!(fault(Format::Stl, [&bytes[..], b"x"].concat()).1.contains("followed by something else"));
    assert!(fault(Format::Stl, [0; 84]).1.contains("0 faces"));
    assert!(fault(Format::Stl, "solid\nendsolid\n").1.contains("0 faces"));
}

#[test]
fn every_cut_is_an_error() {
    for (format, bytes) in samples() {
        // Cut within the line end, or within the last word, a text may still be whole; OBJ announces no count at all.
        let last = match format {
            Format::Obj => 0,
            Format::Stl if bytes.starts_with(b"solid a") => bytes.len() - " a b\n".len(),
            _ => bytes.len() - 3,
        };
        for n in 0..last {
            assert!(parse(format, &bytes[..n]).is_err(), "{format:?} cut to {n} of {} bytes", bytes.len());
        }
    }
}

proptest! {
    // PROPTEST_CASES counts against its default.
    #![proptest_config(ProptestConfig { cases: 512 * ProptestConfig::default().cases / 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), text in "[-v f/0-9a-z.\\\\\n#]{0,200}") {
        for format in [Format::Obj, Format::Off, Format::Ply, Format::Stl] {
            for content in [&bytes[..], text.as_bytes()] {
                parse(format, content).ok();
                let magic: &[u8] = match format {
                    Format::Obj => b"v 0 0 0\nf ",
                    Format::Off => b"OFF\n",
                    Format::Ply => b"ply\nformat ascii 1.0\n",
                    Format::Stl => b"solid\nfacet ",
                };
                parse(format, &[magic, content].concat()).ok();
            }
        }
    }

    #[test]
    fn damaged_files_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        cut in any::<prop::sample::Index>(),
        digits in "[0-9]{1,20}",
    ) {
        for (format, bytes) in samples() {
            let mut damaged = bytes.clone();
            for (at, value) in &changes {
                let at = at.index(damaged.len());
                damaged[at] = *value;
            }
            parse(format, &damaged).ok();
            let at = cut.index(damaged.len());
            parse(format, &damaged[..at]).ok();
            // A number where none was, or a larger one: claims about counts and indices.
            parse(format, &[&bytes[..at], digits.as_bytes(), &bytes[at..]].concat()).ok();
        }
    }
}
