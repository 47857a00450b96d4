//! The one error type. Every variant says what was wrong, where, and what would be right.

use std::collections::HashMap;
use std::fmt;
use std::hash::Hash;
use std::path::{Path, PathBuf};

/// What can go wrong. The text of each is meant for the person who made the call.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// An argument is outside what the call accepts.
    InvalidArgument(String),
    /// The call would need more memory than its limit, or than the system gives.
    OutOfMemory {
        /// What the memory is for.
        what: String,
        /// Bytes that it would take.
        bytes: u128,
        /// Bytes allowed; `None` when the system refused.
        limit: Option<u128>,
    },
    /// The operating system refused to read or write a file.
    Io {
        /// The file.
        path: PathBuf,
        /// The system's own words.
        message: String,
    },
    /// A file's content is not what its format asks for.
    Format {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// What was found and what would be right.
        message: String,
    },
    /// A request that is well formed, but that this version does not serve.
    Unsupported(String),
    /// Geometry from which the result cannot be made: all points equal, say.
    Degenerate(String),
    /// An iterative solve stopped short of its tolerance.
    NotConverged {
        /// Iterations done.
        iterations: usize,
        /// Relative residual reached.
        residual: f64,
        /// Relative residual asked for.
        tolerance: f64,
    },
    /// The caller's progress function asked to stop.
    Cancelled,
}

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Line of a text file, counted from 1.
    Line(usize),
    /// Offset in a binary file, in bytes from 0.
    Byte(usize),
    /// The file as a whole.
    Whole,
}

/// Result with the crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// The error of one solve of several, with the `earlier` ones' iterations counted, as the limit counts them, and the `tolerance` that the
    /// caller asked for: solves before the last have one that nobody set.
    pub(crate) fn of_a_round(self, earlier: u32, tolerance: f64) -> Self {
        match self {
            Error::NotConverged { iterations, residual, .. } => {
                Error::NotConverged { iterations: iterations + earlier as usize, residual, tolerance }
            }
            other => other,
        }
    }

    /// An [`Error::Io`] on `path` with the system's words.
    pub fn io(path: &Path, source: &std::io::Error) -> Self {
        Error::Io { path: path.to_owned(), message: source.to_string() }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::InvalidArgument(message) | Error::Unsupported(message) | Error::Degenerate(message) => {
                f.write_str(message)
            }
            Error::OutOfMemory { what, bytes, limit: Some(limit) } => {
                write!(f, "{what} would take {bytes} bytes; the limit is {limit} bytes")
            }
            Error::OutOfMemory { what, bytes, limit: None } => {
                write!(f, "the system did not give the {bytes} bytes for {what}")
            }
            Error::Io { path, message } => write!(f, "{}: {message}", path.display()),
            Error::Format { path, place, message } => match place {
                Place::Line(line) => write!(f, "{}:{line}: {message}", path.display()),
                Place::Byte(byte) => write!(f, "{}: at byte {byte}: {message}", path.display()),
                Place::Whole => write!(f, "{}: {message}", path.display()),
            },
            Error::NotConverged { iterations, residual, tolerance } => write!(
                f,
                "the solve stopped after {iterations} iterations at relative residual {residual:.3e}, short of {tolerance:.3e}; \
                 allow more iterations, loosen the tolerance or raise lambda_smooth"
            ),
            Error::Cancelled => f.write_str("cancelled by the progress function"),
        }
    }
}

impl std::error::Error for Error {}

/// A vector of `len` copies of `value`, or [`Error::OutOfMemory`] naming `what`: for buffers that grow with the input.
pub fn try_vec<T: Clone>(len: usize, value: T, what: &str) -> Result<Vec<T>> {
    let mut vec = try_with_capacity(len, what)?;
    vec.resize(len, value);
    Ok(vec)
}

/// An empty vector with room for `capacity` items, or [`Error::OutOfMemory`] naming `what`.
pub fn try_with_capacity<T>(capacity: usize, what: &str) -> Result<Vec<T>> {
    let mut vec = Vec::new();
    vec.try_reserve_exact(capacity).map_err(|_| no_room::<T>(capacity as u128, what))?;
    crate::pages::prefer_huge(&mut vec);
    Ok(vec)
}

/// Makes room for `more` items behind those of `vec`, or gives [`Error::OutOfMemory`] naming `what`.
pub fn try_reserve<T>(vec: &mut Vec<T>, more: usize, what: &str) -> Result<()> {
    let len = vec.len() as u128 + more as u128;
    vec.try_reserve(more).map_err(|_| no_room::<T>(len, what))
}

/// The same, for no more than that.
pub fn try_reserve_exact<T>(vec: &mut Vec<T>, more: usize, what: &str) -> Result<()> {
    let len = vec.len() as u128 + more as u128;
    vec.try_reserve_exact(more).map_err(|_| no_room::<T>(len, what))
}

/// Makes room in `map` for one entry more, or gives [`Error::OutOfMemory`] naming `what`.
pub fn try_reserve_entry<K: Eq + Hash, V>(map: &mut HashMap<K, V>, what: &str) -> Result<()> {
    let len = map.len() as u128 + 1;
    map.try_reserve(1).map_err(|_| no_room::<(K, V)>(len, what))
}

/// The error where there is no room for `len` items.
pub fn no_room<T>(len: u128, what: &str) -> Error {
    Error::OutOfMemory { what: what.to_owned(), bytes: len * size_of::<T>() as u128, limit: None }
}
