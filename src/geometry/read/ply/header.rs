//! The header of a PLY file: encoding, elements, their properties.

use crate::geometry::read::builder::push;
use crate::geometry::read::fault::{Fault, Read};
use crate::geometry::read::text::{Lines, number, quote, words};

/// How the data is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Type of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn parse(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Kind::I8,
            b"uchar" | b"uint8" => Kind::U8,
            b"short" | b"int16" => Kind::I16,
            b"ushort" | b"uint16" => Kind::U16,
            b"int" | b"int32" => Kind::I32,
            b"uint" | b"uint32" => Kind::U32,
            b"float" | b"float32" => Kind::F32,
            b"double" | b"float64" => Kind::F64,
            _ => return None,
        })
    }

    /// Bytes of a value in a binary file.
    pub fn size(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::F64 => 8,
        }
    }
}

/// A value, or a list of them, that every row of an element has.
#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
    /// Type of the length, for a list.
    pub list: Option<Kind>,
}

/// A table of rows.
#[derive(Debug)]
pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
    /// Line of the header that announces it.
    pub line: usize,
}

/// All that a header says.
#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
}

impl Header {
    /// The one element called `name`.
    pub fn element(&self, name: &str) -> Read<&Element> {
        let mut found = self.elements.iter().filter(|e| e.name == name);
        let first = found.next().ok_or_else(|| Fault::whole(format!("the header announces no element {name}")))?;
        match found.next() {
            None => Ok(first),
            Some(second) => Err(Fault::line(second.line, format!("element {name} is announced a second time"))),
        }
    }
}

/// Whether `bytes` begin as PLY does.
pub(crate) fn is_ply(bytes: &[u8]) -> bool {
    Lines::new(bytes).next().is_some_and(|(_, line)| line.trim_ascii_end() == b"ply")
}

/// Reads the header; gives with it the lines after it.
pub(super) fn read(bytes: &[u8]) -> Read<(Header, Lines<'_>)> {
    if !is_ply(bytes) {
        return Err(Fault::line(1, "`ply` was expected on the first line"));
    }
    let mut lines = Lines::new(bytes);
    lines.next();
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    while let Some((line, content)) = lines.next() {
        let mut rest = words(content);
        match rest.next().unwrap_or_default() {
            b"" | b"comment" | b"obj_info" => {}
            b"format" => encoding = Some(parse_encoding(rest.next().unwrap_or_default(), line)?),
            b"element" => push(&mut elements, parse_element(rest, line)?, "the elements")?,
            b"property" => {
                let property = parse_property(rest, line)?;
                let Some(element) = elements.last_mut() else {
                    return Err(Fault::line(line, "a property comes before any element"));
                };
                push(&mut element.properties, property, "the properties")?;
            }
            b"end_header" => {
                let encoding = encoding.ok_or_else(|| Fault::line(line, "the header ends without a `format` line"))?;
                return Ok((Header { encoding, elements }, lines));
            }
            other => return Err(Fault::line(line, format!("{} is no keyword of a PLY header", quote(other)))),
        }
    }
    Err(Fault::line(lines.number(), "the file ends before `end_header`"))
}

fn parse_encoding(word: &[u8], line: usize) -> Read<Encoding> {
    match word {
        b"ascii" => Ok(Encoding::Text),
        b"binary_little_endian" => Ok(Encoding::LittleEndian),
        b"binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(Fault::line(
            line,
            format!("format {} is not ascii, binary_little_endian or binary_big_endian", quote(word)),
        )),
    }
}

fn parse_element<'a>(mut words: impl Iterator<Item = &'a [u8]>, line: usize) -> Read<Element> {
    let name = name(words.next());
    let word = words.next().unwrap_or_default();
    let count = number(word)
        .ok_or_else(|| Fault::line(line, format!("the count of element {name} was expected, found {}", quote(word))))?;
    Ok(Element { name, count, properties: Vec::new(), line })
}

fn parse_property<'a>(mut words: impl Iterator<Item = &'a [u8]>, line: usize) -> Read<Property> {
    let kind = |word: Option<&[u8]>| {
        let word = word.unwrap_or_default();
        Kind::parse(word)
            .ok_or_else(|| Fault::line(line, format!("{} is no type; char to uint, float and double are", quote(word))))
    };
    let first = words.next();
    if first != Some(b"list") {
        return Ok(Property { kind: kind(first)?, name: name(words.next()), list: None });
    }
    let count = kind(words.next())?;
    if matches!(count, Kind::F32 | Kind::F64) {
        return Err(Fault::line(line, "the length of a list must be of an integer type"));
    }
    Ok(Property { kind: kind(words.next())?, name: name(words.next()), list: Some(count) })
}

fn name(word: Option<&[u8]>) -> String {
    String::from_utf8_lossy(word.unwrap_or_default()).into_owned()
}
