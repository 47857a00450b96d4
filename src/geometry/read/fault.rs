//! What a reader reports before the name of the file is known to it.

use std::path::Path;

use crate::Error;
use crate::error::Place;

/// An error of a reader: a fault of the file, or one of the crate's errors as it came.
#[derive(Debug)]
pub(super) enum Fault {
    Format { place: Place, message: String },
    Other(Error),
}

/// Result of a reader.
pub(super) type Read<T> = Result<T, Fault>;

impl Fault {
    pub fn at(place: Place, message: impl Into<String>) -> Self {
        Fault::Format { place, message: message.into() }
    }

    pub fn line(line: usize, message: impl Into<String>) -> Self {
        Fault::at(Place::Line(line), message)
    }

    pub fn byte(byte: usize, message: impl Into<String>) -> Self {
        Fault::at(Place::Byte(byte), message)
    }

    pub fn whole(message: impl Into<String>) -> Self {
        Fault::at(Place::Whole, message)
    }

    pub fn in_file(self, path: &Path) -> Error {
        match self {
            Fault::Format { place, message } => Error::Format { path: path.to_owned(), place, message },
            Fault::Other(error) => error,
        }
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Fault::Other(error)
    }
}
