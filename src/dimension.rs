//! The plane or space, where only a file or a caller at run time can tell.

use crate::Error;

/// A thing of the plane, `P`, or of space, `S`.
#[derive(Debug, Clone)]
pub enum OfDimension<P, S> {
    /// D = 2.
    Plane(P),
    /// D = 3.
    Space(S),
}

impl<P, S> OfDimension<P, S> {
    /// 2 or 3.
    pub fn dim(&self) -> u32 {
        match self {
            OfDimension::Plane(_) => 2,
            OfDimension::Space(_) => 3,
        }
    }

    /// That of the plane; none in space.
    pub fn plane(&self) -> Option<&P> {
        match self {
            OfDimension::Plane(thing) => Some(thing),
            OfDimension::Space(_) => None,
        }
    }

    /// That of space; none in the plane.
    pub fn space(&self) -> Option<&S> {
        match self {
            OfDimension::Plane(_) => None,
            OfDimension::Space(thing) => Some(thing),
        }
    }
}

/// The error of things that are named, each with its dimension, where it must be the same.
pub fn differ(dims: &[(&str, u32)]) -> Error {
    let dims: Vec<String> = dims.iter().map(|(what, dim)| format!("{what} dim {dim}")).collect();
    Error::InvalidArgument(format!("{}; they must be the same", dims.join(", ")))
}

/// The error of a dimension that there is not.
pub fn no_dim(dim: u32) -> Error {
    Error::InvalidArgument(format!("dim is {dim}; it must be 2 or 3"))
}

/// Does the same with what is in an [`OfDimension`], in whichever dimension it is.
macro_rules! in_its_dimension {
    ($thing:expr, $name:ident => $body:expr) => {
        match $thing {
            $crate::dimension::OfDimension::Plane($name) => $body,
            $crate::dimension::OfDimension::Space($name) => $body,
        }
    };
}
pub(crate) use in_its_dimension;
