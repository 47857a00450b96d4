//! A file's bytes, unpacked where they are packed.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use crate::error::{Place, try_reserve, try_with_capacity};
use crate::{Error, Result};

const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// The bytes of the file at `path`, unpacked when they are gzip; at most `limit` of them.
pub(super) fn load(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let io_error = |e: io::Error| Error::io(path, &e);
    let mut file = File::open(path).map_err(io_error)?;
    let size = file.metadata().map_err(io_error)?.len();
    let mut magic = Vec::with_capacity(GZIP_MAGIC.len());
    file.by_ref().take(GZIP_MAGIC.len() as u64).read_to_end(&mut magic).map_err(io_error)?;
    let packed = magic == GZIP_MAGIC;
    let whole = io::Cursor::new(magic).chain(file);
    if packed {
        read_all(MultiGzDecoder::new(BufReader::new(whole)), 0, limit, |e| Error::Format {
            path: path.to_owned(),
            place: Place::Whole,
            message: format!("the gzip data is damaged or cut short: {e}"),
        })
    } else {
        read_all(whole, size, limit, io_error)
    }
}

/// All bytes of `source`, of which there are `expected` or so; more than `limit` are an error.
fn read_all(source: impl Read, expected: u64, limit: u64, io_error: impl Fn(io::Error) -> Error) -> Result<Vec<u8>> {
    const WHAT: &str = "the content of the file";
    let too_large =
        |bytes: u64| Error::OutOfMemory { what: WHAT.to_owned(), bytes: bytes.into(), limit: Some(limit.into()) };
    if expected > limit {
        return Err(too_large(expected));
    }
    let mut bytes = try_with_capacity(expected as usize, WHAT)?;
    let mut source = source.take(limit.saturating_add(1));
    let mut chunk = vec![0; 1 << 16];
    loop {
        let n = match source.read(&mut chunk) {
            Ok(0) => return Ok(bytes),
            Ok(n) => n,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(io_error(e)),
        };
        let len = bytes.len() + n;
        if len as u64 > limit {
            return Err(too_large(len as u64));
        }
        try_reserve(&mut bytes, n, WHAT)?;
        bytes.extend_from_slice(&chunk[..n]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8], limit: u64) -> Result<Vec<u8>> {
        read_all(bytes, bytes.len() as u64, limit, |e| Error::io(Path::new("x"), &e))
    }

    #[test]
    fn the_limit_is_the_last_size_that_passes() {
        for n in [0, 1, 2, 65_536, 65_537] {
            let bytes = vec![7; n];
            assert_eq!(all(&bytes, n as u64).unwrap(), bytes);
            if n > 0 {
                assert!(matches!(all(&bytes, n as u64 - 1), Err(Error::OutOfMemory { limit: Some(_), .. })));
            }
        }
    }

    #[test]
    fn an_endless_source_ends_at_the_limit() {
        let endless = read_all(io::repeat(0), 0, 1 << 20, |e| Error::io(Path::new("x"), &e));
        assert!(matches!(endless, Err(Error::OutOfMemory { bytes, limit: Some(_), .. }) if bytes == (1 << 20) + 1));
    }
}
