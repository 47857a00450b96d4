//! Sets of cells as C has them: a byte a cell, 0 or 1.

use super::pointer::array;
use crate::cogen::Bits;
use crate::{Error, Result};

/// The set at `pointer`, of `len` cells.
///
/// # Safety
/// `pointer` is NULL or points to `len` bytes that live, and are not written to, during the call.
pub(super) unsafe fn read_set(pointer: *const u8, len: usize, name: &str) -> Result<Bits> {
    // SAFETY: the caller's promise.
    bits_of(unsafe { array(pointer, len, name) }?, name)
}

/// Refuses bytes that are no set.
pub(super) fn check_set(bytes: &[u8], name: &str) -> Result<()> {
    if let Some((i, byte)) = bytes.iter().enumerate().find(|(_, byte)| **byte > 1) {
        return Err(Error::InvalidArgument(format!("entry {i} of {name} is {byte}; it must be 0 or 1")));
    }
    Ok(())
}

/// The set of the cells whose byte is 1.
pub(super) fn bits_of(bytes: &[u8], name: &str) -> Result<Bits> {
    check_set(bytes, name)?;
    Bits::of(bytes.len(), |i| bytes[i] == 1)
}

/// Writes a byte for each cell.
pub(super) fn put(set: &Bits, to: &mut [u8]) {
    to.fill(0);
    set.iter().for_each(|i| to[i] = 1);
}
