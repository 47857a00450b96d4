//! The bindings of other languages follow `include/keepout.h`: `keepout.hpp` and the Python module call every function with as many
//! arguments as it has, `keepout.f90` and the Python module declare them, the structs and the constants with the same types, and use each
//! function for more than to declare it.

use std::collections::BTreeMap;
use std::path::Path;

/// A function, as its name, what it returns and the types of its arguments.
#[derive(Debug, PartialEq)]
struct Function {
    returns: String,
    arguments: Vec<String>,
}

/// Names and types of a struct's fields, in order.
type Fields = Vec<(String, String)>;

fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The text between `start` and the next `end`.
fn between<'a>(text: &'a str, start: &str, end: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(start)?;
    Some(rest.split_once(end)?.0)
}

/// Splits at the commas that no bracket encloses.
fn split_arguments(text: &str) -> Vec<String> {
    let mut depth = 0;
    let parts = text.split(|c| {
        depth += i32::from("([{".contains(c)) - i32::from(")]}".contains(c));
        c == ',' && depth == 0
    });
    parts.map(|part| part.split_whitespace().collect::<Vec<_>>().join(" ")).filter(|part| !part.is_empty()).collect()
}

/// What is in the bracket that `text` begins in.
fn up_to_closing(text: &str) -> &str {
    let mut depth = 1;
    let end = text.find(|c| {
        depth += i32::from("([{".contains(c)) - i32::from(")]}".contains(c));
        depth == 0
    });
    &text[..end.expect("the bracket is closed")]
}

fn is_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// How often `name` is in `text`, as a whole word.
fn count(name: &str, text: &str) -> usize {
    text.split(|c| !is_name(c)).filter(|word| *word == name).count()
}

/// `text` without what is behind `mark` in each line.
fn without_comments(text: &str, mark: &str) -> String {
    text.lines().map(|line| line.split(mark).next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

// ---- C, the original

/// The header without its comments and its preprocessor lines.
fn header() -> String {
    let mut text = read("include/keepout.h");
    while let Some(start) = text.find("/*") {
        let length = text[start..].find("*/").expect("the comment ends") + 2;
        text.replace_range(start..start + length, "");
    }
    text.lines().filter(|line| !line.starts_with('#')).collect::<Vec<_>>().join("\n")
}

/// `const double *points` as its type, `const double *`, and its name; an array keeps its length: `double [3]`.
fn c_declaration(text: &str) -> (String, String) {
    let text = text.trim();
    let (text, length) = match text.split_once('[') {
        Some((before, length)) => (before, format!("[{length}")),
        None => (text, String::new()),
    };
    let start = text.rfind(|c| !is_name(c)).map_or(0, |i| i + 1);
    let plain = text[..start].replace("struct ", "");
    ((plain.trim().to_owned() + &length).trim().to_owned(), text[start..].to_owned())
}

fn c_functions() -> BTreeMap<String, Function> {
    let text = header();
    let text = between(&text, "extern \"C\" {", "}  //").expect("the header has its functions");
    let text = text.replace('\n', " ");
    let declarations = text.split(';').filter(|declaration| declaration.contains('('));
    let functions = declarations.map(|declaration| {
        let (head, rest) = declaration.split_once('(').expect("a function has a bracket");
        let (returns, name) = c_declaration(head);
        let arguments = split_arguments(up_to_closing(rest)).into_iter().filter(|argument| argument != "void");
        (name, Function { returns, arguments: arguments.map(|argument| c_declaration(&argument).0).collect() })
    });
    functions.collect()
}

fn c_structs() -> BTreeMap<String, Fields> {
    let text = header();
    let bodies = text.split("typedef struct ").skip(1).filter_map(|part| {
        let name: String = part.chars().take_while(|&c| is_name(c)).collect();
        let body = part[name.len()..].trim_start().strip_prefix('{')?;
        Some((name, up_to_closing(body).to_owned()))
    });
    let fields = |body: String| {
        let fields = body.split(';').filter(|field| !field.trim().is_empty()).map(c_declaration);
        fields.map(|(type_, name)| (name, type_)).collect()
    };
    bodies.map(|(name, body)| (name, fields(body))).collect()
}

/// Types of the caller's functions.
const CALLBACKS: [&str; 2] = ["ko_progress", "ko_pose_function"];

/// A type that the header does not see into.
fn is_handle(c: &str) -> bool {
    c.starts_with("ko_") && c.chars().all(is_name) && !CALLBACKS.contains(&c) && !c_structs().contains_key(c)
}

fn c_constants() -> BTreeMap<String, i64> {
    let text = read("include/keepout.h");
    let defines = text.lines().filter_map(|line| line.strip_prefix("#define ")?.split_once(' '));
    defines.map(|(name, value)| (name.to_owned(), value.parse().expect("a constant is a number"))).collect()
}

// ---- Fortran

/// The module of the C calls without comments and with continued lines joined.
fn fortran() -> String {
    let text = read("include/keepout.f90");
    let text = between(&text, "module keepout_c\n", "\nend module").expect("keepout.f90 has its module keepout_c");
    let lines = text.lines().map(|line| line.split('!').next().unwrap_or_default().trim());
    lines.collect::<Vec<_>>().join("\n").replace("&\n", "")
}

/// The declarations `type :: name` of a body, in order.
fn fortran_declarations(body: &str) -> Fields {
    let lines = body.lines().filter_map(|line| line.split_once(" :: "));
    lines.map(|(type_, name)| (name.to_owned(), type_.to_owned())).collect()
}

fn fortran_functions() -> BTreeMap<String, Function> {
    let text = fortran();
    let mut functions = BTreeMap::new();
    for kind in ["function", "subroutine"] {
        for part in text.split(&format!("\n{kind} ko_")).skip(1) {
            let (head, rest) = part.split_once('\n').expect("the interface has a body");
            let body = rest.split_once(&format!("\nend {kind}")).expect("the interface ends").0;
            let (name, arguments) = head.split_once('(').expect("the interface has arguments");
            let declared = fortran_declarations(body);
            let type_of = |name: &str| {
                let found = declared.iter().find(|(declared, _)| declared.split('(').next() == Some(name));
                let (whole, type_) = found.unwrap_or_else(|| panic!("ko_{part} does not declare {name}"));
                type_.clone() + if whole.ends_with("(*)") { " (*)" } else { "" }
            };
            let arguments = split_arguments(up_to_closing(arguments)).iter().map(|name| type_of(name)).collect();
            let returns = between(head, "result(", ")").map_or("void".into(), type_of);
            functions.insert(format!("ko_{name}"), Function { returns, arguments });
        }
    }
    CALLBACKS.iter().for_each(|callback| drop(functions.remove(*callback)));
    functions
}

/// How an argument of C may be declared: arrays by their element, or as an address where they may be NULL.
fn fortran_argument(c: &str) -> Vec<String> {
    let address = "type(c_ptr), value".to_owned();
    let plain = c.trim_start_matches("const ");
    // Handles that are read.
    if let Some(target) = plain.strip_suffix("*const *") {
        assert!(is_handle(target.trim()), "{c} is an array of pointers, but of no handles");
        return vec!["type(c_ptr), intent(in) (*)".into()];
    }
    if let Some(target) = plain.strip_suffix("**") {
        assert!(is_handle(target.trim()), "{c} is an output, but no handle");
        return vec!["type(c_ptr), intent(out)".into()];
    }
    let Some(target) = plain.strip_suffix('*').map(str::trim) else {
        return vec![format!("{}, value", fortran_type(c))];
    };
    let read_only = c.starts_with("const ");
    match target {
        "char" => vec!["character(kind=c_char), intent(in) (*)".into()],
        _ if is_handle(target) => vec![address],
        _ => {
            let of = fortran_type(target);
            let intent = if read_only { "in" } else { "inout" };
            vec![format!("{of}, intent({intent}) (*)"), format!("{of}, intent({intent})"), address]
        }
    }
}

fn fortran_type(c: &str) -> String {
    let type_ = match c {
        "double" => "real(c_double)",
        "int32_t" | "uint32_t" => "integer(c_int32_t)",
        "int64_t" | "uint64_t" => "integer(c_int64_t)",
        "uint8_t" => "integer(c_int8_t)",
        "size_t" => "integer(c_size_t)",
        _ if CALLBACKS.contains(&c) => "type(c_funptr)",
        "const char *" | "void *" | "const double *" => "type(c_ptr)",
        "void" => "void",
        _ if c.starts_with("ko_") => return format!("type({c})"),
        _ => panic!("no Fortran type is known for {c}"),
    };
    type_.to_owned()
}

#[test]
fn fortran_has_every_function() {
    let (right, mut found) = (c_functions(), fortran_functions());
    for (name, function) in &right {
        let Some(bound) = found.remove(name) else { panic!("keepout.f90 has no interface for {name}") };
        assert_eq!(bound.arguments.len(), function.arguments.len(), "arguments of {name} in keepout.f90");
        assert_eq!(bound.returns, fortran_type(&function.returns), "result of {name} in keepout.f90");
        for (i, (bound, c)) in bound.arguments.iter().zip(&function.arguments).enumerate() {
            let right = fortran_argument(c);
            assert!(right.contains(bound), "argument {i} of {name} is {bound} in keepout.f90; {c} asks for {right:?}");
        }
    }
    assert!(found.is_empty(), "keepout.f90 has interfaces for what the header has not: {:?}", found.keys());
}

#[test]
fn fortran_has_every_struct() {
    let text = fortran();
    for (name, fields) in c_structs() {
        let body = between(&text, &format!("type, bind(c) :: {name}\n"), "end type");
        let body = body.unwrap_or_else(|| panic!("keepout.f90 has no type {name}"));
        let right = fields.iter().map(|(field, type_)| match type_.split_once('[') {
            Some((of, length)) => (format!("{field}({}", length.replace(']', ")")), fortran_type(of.trim())),
            None => (field.clone(), fortran_type(type_)),
        });
        assert_eq!(fortran_declarations(body), right.collect::<Fields>(), "{name} in keepout.f90");
    }
}

#[test]
fn fortran_has_every_constant() {
    let text = fortran();
    for (name, value) in c_constants() {
        // Fortran does not tell KO_ABI_VERSION from ko_abi_version.
        let name = name.replace("KO_ABI_VERSION", "KO_MODULE_ABI_VERSION");
        let line = format!(" :: {name} = {value}");
        assert!(text.lines().any(|found| found.ends_with(&line)), "keepout.f90 has no `{line}`");
    }
}

/// What the calls of C are declared for. Those without arguments and texts are called as they are.
#[test]
fn fortran_uses_every_function() {
    let text = read("include/keepout.f90");
    let (_, text) = text.split_once("\nend module").expect("keepout.f90 has a module behind keepout_c");
    let text = without_comments(text, "!").to_lowercase();
    for (name, function) in c_functions() {
        let is_plain = function.arguments.is_empty() && !function.returns.contains('*');
        assert!(is_plain || count(&name, &text) > 0, "the module keepout of keepout.f90 does not use {name}");
    }
}

// ---- C++

#[test]
fn cpp_calls_every_function() {
    let text = without_comments(&read("include/keepout.hpp"), "//");
    for (name, function) in c_functions() {
        let start = format!("{name}(");
        let calls = text.match_indices(&start).map(|(i, _)| up_to_closing(&text[i + start.len()..]));
        let counts: Vec<usize> = calls.map(|arguments| split_arguments(arguments).len()).collect();
        if name.ends_with("_free") && counts.is_empty() {
            assert!(text.contains(&name), "keepout.hpp does not use {name}");
            continue;
        }
        assert!(!counts.is_empty(), "keepout.hpp does not call {name}");
        let right = function.arguments.len();
        assert!(counts.iter().all(|&n| n == right), "{name} takes {right} arguments; keepout.hpp gives {counts:?}");
    }
}

// ---- Python

fn python() -> String {
    read("examples/python/keepout.py")
}

fn python_functions() -> BTreeMap<String, Function> {
    let text = python();
    let bound = text.split("_bind(").skip(1).filter_map(|part| {
        let mut parts = split_arguments(up_to_closing(part)).into_iter();
        let name = parts.next()?.strip_prefix("\"ko_")?.trim_end_matches('"').to_owned();
        Some((format!("ko_{name}"), Function { returns: parts.next()?, arguments: parts.collect() }))
    });
    bound.collect()
}

/// How an argument of C may be declared: _doubles and _indices are arrays, POINTER(...) is one number to write, or an array of its type.
fn python_argument(c: &str) -> Vec<String> {
    let mut types = vec![python_type(c)];
    match c.trim_start_matches("const ") {
        "double *" => types.push("_doubles".into()),
        "uint32_t *" => types.push("_indices".into()),
        _ => {}
    }
    types
}

fn python_type(c: &str) -> String {
    let plain = c.trim_start_matches("const ").trim_end_matches("const").trim();
    match plain {
        "char *" => "c_char_p".into(),
        "void *" => "c_void_p".into(),
        "void" => "None".into(),
        "size_t" => "c_size_t".into(),
        _ => match plain.strip_suffix('*').map(str::trim_end) {
            // keepout.py calls the type of pointers to ko_mesh _mesh.
            Some(target) if is_handle(target) => target.replacen("ko_", "_", 1),
            Some(target) => format!("POINTER({})", python_type(target)),
            None if plain.starts_with("ko_") => plain.into(),
            None => format!("c_{}", plain.trim_end_matches("_t")),
        },
    }
}

#[test]
fn python_has_every_function() {
    let (right, mut found) = (c_functions(), python_functions());
    for (name, function) in &right {
        let Some(bound) = found.remove(name) else { panic!("keepout.py does not bind {name}") };
        assert_eq!(bound.arguments.len(), function.arguments.len(), "arguments of {name} in keepout.py");
        assert_eq!(bound.returns, python_type(&function.returns), "result of {name} in keepout.py");
        for (i, (bound, c)) in bound.arguments.iter().zip(&function.arguments).enumerate() {
            let right = python_argument(c);
            assert!(right.contains(bound), "argument {i} of {name} is {bound} in keepout.py; {c} asks for {right:?}");
        }
    }
    assert!(found.is_empty(), "keepout.py binds what the header has not: {:?}", found.keys());
}

#[test]
fn python_uses_every_function() {
    let text = without_comments(&python(), "#");
    for name in c_functions().keys() {
        let bound = name.trim_start_matches("ko");
        assert_eq!(text.matches(&format!("\n{bound} = _bind(")).count(), 1, "keepout.py does not call {name} {bound}");
        assert!(count(bound, &text) > 1, "keepout.py binds {name} and does not use it");
    }
}

#[test]
fn python_has_every_struct() {
    let text = python();
    for (name, fields) in c_structs() {
        let class = between(&text, &format!("\nclass {name}(_Struct):"), "\n    ]\n");
        let class = class.unwrap_or_else(|| panic!("keepout.py has no class {name}"));
        let declared =
            class.lines().filter_map(|line| line.trim().strip_prefix("(\"")?.strip_suffix("),")?.split_once("\", "));
        let declared: Fields = declared.map(|(field, type_)| (field.to_owned(), type_.to_owned())).collect();
        let right = fields.iter().map(|(field, type_)| match type_.split_once('[') {
            Some((of, length)) => {
                (field.clone(), format!("{} * {}", python_type(of.trim()), length.trim_end_matches(']')))
            }
            None => (field.clone(), python_type(type_)),
        });
        assert_eq!(declared, right.collect::<Fields>(), "{name} in keepout.py");
    }
}

/// The class of keepout.py that has a constant, and its name there; no class for what the module has itself.
fn python_constant(name: &str) -> (Option<&'static str>, String) {
    let prefixes = [
        ("ERR_", "Status"),
        ("CAPABILITY_", "Capability"),
        ("POINT_", "Point"),
        ("FEASIBLE_", "Feasible"),
        ("REWEIGHT_", "Reweight"),
        ("AGGREGATE_", "Aggregate"),
        ("ROTATION_", "Rotation"),
        ("SCALE_", "Scale"),
        ("EXPLICIT_", "Formulation"),
        ("CELL_", "Cell"),
        ("CONFLICTS_", "Conflicts"),
        ("WITHIN_", "Within"),
        ("CHANGE_", "Change"),
    ];
    let short = name.trim_start_matches("KO_").replace("CAPABILITY_3D", "CAPABILITY_SPACE");
    let short = short.replace("CAPABILITY_2D", "CAPABILITY_PLANE");
    let of = prefixes.iter().find_map(|(prefix, class)| Some((Some(*class), short.strip_prefix(prefix)?.to_owned())));
    of.unwrap_or_else(|| {
        let class = match short.as_str() {
            "WORLD" | "ABI_VERSION" => None,
            "BELOW" | "ABOVE" => Some("Side"),
            "LEAST" | "LARGEST" => Some("Extreme"),
            "AVOID" | "STAY_IN" => Some("Rule"),
            _ => Some("Status"),
        };
        (class, short)
    })
}

#[test]
fn python_has_every_constant() {
    let text = python();
    for (name, value) in c_constants() {
        let (class, short) = python_constant(&name);
        let (place, line) = match class {
            Some(class) => {
                let body = between(&text, &format!("\nclass {class}(enum."), "\n\n\n");
                (
                    body.unwrap_or_else(|| panic!("keepout.py has no enumeration {class}")),
                    format!("    {short} = {value}"),
                )
            }
            None => (text.as_str(), format!("{short} = {value}")),
        };
        assert!(place.lines().any(|found| found == line), "keepout.py has no `{line}` for {name} in {class:?}");
    }
}

/// A test that finds nothing would pass for ever.
#[test]
fn the_header_is_understood() {
    let functions = c_functions();
    assert!(functions.len() >= 30, "only {:?}", functions.keys());
    let right = Function {
        returns: "int32_t".into(),
        arguments: ["const ko_mesh *", "size_t", "uint64_t", "ko_cloud **"].map(String::from).to_vec(),
    };
    assert_eq!(functions["ko_mesh_sample"], right);
    assert!(c_structs()["ko_fit_options"].contains(&("control_points".into(), "uint32_t[3]".into())));
    assert_eq!(c_constants()["KO_ERR_INTERNAL"], -9);
}
