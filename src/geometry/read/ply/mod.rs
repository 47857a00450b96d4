//! PLY, as text and as binary of either byte order: a header that describes the data, then the data.

mod header;
mod values;

use super::builder::{Builder, push};
use super::fault::{Fault, Read};
use crate::error::Place;
use crate::geometry::Mesh;
use header::{Element, Encoding, Header, Kind, Property};
use values::{Binary, ByteOrder, Text, Values};

pub(super) use header::is_ply;

/// The mesh of a PLY file.
pub(super) fn read(bytes: &[u8]) -> Read<Mesh> {
    let (header, lines) = header::read(bytes)?;
    match header.encoding {
        Encoding::Text => read_data(&header, &mut Text::new(lines)),
        Encoding::LittleEndian => read_data(&header, &mut Binary::new(bytes, lines.offset(), ByteOrder::Little)),
        Encoding::BigEndian => read_data(&header, &mut Binary::new(bytes, lines.offset(), ByteOrder::Big)),
    }
}

fn read_data(header: &Header, values: &mut impl Values) -> Read<Mesh> {
    let (vertex, face) = (header.element("vertex")?, header.element("face")?);
    // Columns first: a row then takes some bytes, so that the file's length bounds the counts.
    let (axes, corner_list) = (axes(vertex)?, corner_list(face)?);
    for element in &header.elements {
        check_room(element, values)?;
    }
    let mut builder = Builder::with_room(vertex.count, face.count)?;
    for element in &header.elements {
        // Again: what came before may have taken more than its least.
        check_room(element, values)?;
        match element.name.as_str() {
            "vertex" => read_vertices(element, &axes, values, &mut builder)?,
            "face" => read_faces(element, corner_list, vertex.count, values, &mut builder)?,
            _ => pass_over(element, values)?,
        }
    }
    builder.finish()
}

/// For each property of the vertices, the axis that it gives.
fn axes(vertex: &Element) -> Read<Vec<Option<usize>>> {
    const NAMES: [&str; 3] = ["x", "y", "z"];
    let axis = |p: &Property| NAMES.iter().position(|name| p.name == *name && p.list.is_none());
    let axes: Vec<_> = vertex.properties.iter().map(axis).collect();
    match (0..3).find(|a| !axes.contains(&Some(*a))) {
        None => Ok(axes),
        Some(a) => Err(Fault::line(vertex.line, format!("element vertex has no property {}", NAMES[a]))),
    }
}

/// Which property of the faces lists their corners.
fn corner_list(face: &Element) -> Read<usize> {
    let is_corners = |p: &Property| p.list.is_some() && (p.name == "vertex_indices" || p.name == "vertex_index");
    let found = face.properties.iter().position(is_corners);
    found.ok_or_else(|| Fault::line(face.line, "element face has no property list vertex_indices"))
}

/// Refuses a count that the rest of the file cannot hold, before anything is made of that size.
fn check_room(element: &Element, values: &impl Values) -> Read<()> {
    let row: usize = element.properties.iter().map(|p| values.least_bytes(p.list.unwrap_or(p.kind))).sum();
    let (name, count, left) = (&element.name, element.count, values.remaining());
    // The last value of a text may lack the space after it.
    if count.saturating_mul(row) > left.saturating_add(1) {
        let message = format!("{count} of element {name} are announced, but only {left} bytes are left for them");
        return Err(Fault::at(values.place(), message));
    }
    Ok(())
}

fn read_vertices(
    element: &Element,
    axes: &[Option<usize>],
    values: &mut impl Values,
    builder: &mut Builder,
) -> Read<()> {
    for _ in 0..element.count {
        let mut p = [0.0; 3];
        let mut place = None;
        for (property, axis) in element.properties.iter().zip(axes) {
            match axis {
                Some(a) => {
                    p[*a] = values.next(property.kind)?;
                    place.get_or_insert_with(|| values.place());
                }
                None => pass_over_property(property, values)?,
            }
        }
        builder.vertex(p, place.unwrap_or(Place::Whole))?;
    }
    Ok(())
}

fn read_faces(
    element: &Element,
    corner_list: usize,
    n_vertices: usize,
    values: &mut impl Values,
    builder: &mut Builder,
) -> Read<()> {
    let mut corners = Vec::new();
    for i in 0..element.count {
        let mut place = Place::Whole;
        for (k, property) in element.properties.iter().enumerate() {
            match property.list {
                Some(count) if k == corner_list => {
                    let n = read_count(count, property.kind, values)?;
                    place = values.place();
                    read_corners(n, property.kind, i, values, &mut corners)?;
                }
                _ => pass_over_property(property, values)?,
            }
        }
        builder.face(&corners, n_vertices, place)?;
    }
    Ok(())
}

fn read_corners(n: usize, kind: Kind, i: usize, values: &mut impl Values, corners: &mut Vec<i64>) -> Read<()> {
    corners.clear();
    for _ in 0..n {
        let corner = values.next(kind)?;
        if corner.fract() != 0.0 {
            return Err(Fault::at(values.place(), format!("face {i} names vertex {corner}; an integer is needed")));
        }
        push(corners, corner as i64, "the corners of a face")?;
    }
    Ok(())
}

/// The length of a list, once it is known that the file can hold it.
fn read_count(count: Kind, item: Kind, values: &mut impl Values) -> Read<usize> {
    let n = values.next(count)?;
    let room = values.remaining().saturating_add(1) / values.least_bytes(item);
    if n.fract() == 0.0 && n >= 0.0 && n <= room as f64 {
        return Ok(n as usize);
    }
    let left = values.remaining();
    Err(Fault::at(values.place(), format!("a list of length {n} is announced, but the file ends {left} bytes later")))
}

fn pass_over(element: &Element, values: &mut impl Values) -> Read<()> {
    // Without properties there is nothing to pass over, however large the count.
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            pass_over_property(property, values)?;
        }
    }
    Ok(())
}

fn pass_over_property(property: &Property, values: &mut impl Values) -> Read<()> {
    let n = match property.list {
        Some(count) => read_count(count, property.kind, values)?,
        None => 1,
    };
    for _ in 0..n {
        values.next(property.kind)?;
    }
    Ok(())
}
