//! The values of a PLY file's data, one after the other, from text or binary.

use super::header::Kind;
use crate::error::Place;
use crate::geometry::read::fault::{Fault, Read};
use crate::geometry::read::text::{Lines, Words};

/// A row of values of announced types. All types of PLY fit an `f64` without loss.
pub(super) trait Values {
    /// The next value.
    fn next(&mut self, kind: Kind) -> Read<f64>;
    /// Where the value that came last was found.
    fn place(&self) -> Place;
    /// Bytes left.
    fn remaining(&self) -> usize;
    /// Least bytes that a value of this type takes: at least 1.
    fn least_bytes(&self, kind: Kind) -> usize;
}

/// Values as words.
pub(super) struct Text<'a>(Words<'a>);

impl<'a> Text<'a> {
    pub fn new(lines: Lines<'a>) -> Self {
        Text(Words::of(lines))
    }
}

impl Values for Text<'_> {
    fn next(&mut self, _: Kind) -> Read<f64> {
        self.0.number("a number")
    }

    fn place(&self) -> Place {
        Place::Line(self.0.line())
    }

    fn remaining(&self) -> usize {
        self.0.remaining()
    }

    fn least_bytes(&self, _: Kind) -> usize {
        // A digit and a space.
        2
    }
}

/// Which end of a number comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// Values as bytes.
pub(super) struct Binary<'a> {
    bytes: &'a [u8],
    at: usize,
    last: usize,
    order: ByteOrder,
}

impl<'a> Binary<'a> {
    /// The values of `bytes` from offset `at`.
    pub fn new(bytes: &'a [u8], at: usize, order: ByteOrder) -> Self {
        Binary { bytes, at, last: at, order }
    }

    /// The next `N` bytes, least significant first.
    fn take<const N: usize>(&mut self) -> Read<[u8; N]> {
        let Some(piece) = self.bytes[self.at..].first_chunk::<N>() else {
            let left = self.remaining();
            return Err(Fault::byte(self.at, format!("a value of {N} bytes was expected; the file ends after {left}")));
        };
        self.last = self.at;
        self.at += N;
        let mut value = *piece;
        if self.order == ByteOrder::Big {
            value.reverse();
        }
        Ok(value)
    }
}

impl Values for Binary<'_> {
    fn next(&mut self, kind: Kind) -> Read<f64> {
        Ok(match kind {
            Kind::I8 => i8::from_le_bytes(self.take()?).into(),
            Kind::U8 => u8::from_le_bytes(self.take()?).into(),
            Kind::I16 => i16::from_le_bytes(self.take()?).into(),
            Kind::U16 => u16::from_le_bytes(self.take()?).into(),
            Kind::I32 => i32::from_le_bytes(self.take()?).into(),
            Kind::U32 => u32::from_le_bytes(self.take()?).into(),
            Kind::F32 => f32::from_le_bytes(self.take()?).into(),
            Kind::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    fn place(&self) -> Place {
        Place::Byte(self.last)
    }

    fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn least_bytes(&self, kind: Kind) -> usize {
        kind.size()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_byte_orders_agree() {
        let big = [0xff, 0xfe, 0x3f, 0xc0, 0, 0];
        let little = [0xfe, 0xff, 0, 0, 0xc0, 0x3f];
        for (bytes, order) in [(big, ByteOrder::Big), (little, ByteOrder::Little)] {
            let mut values = Binary::new(&bytes, 0, order);
            assert_eq!(values.next(Kind::I16).unwrap(), -2.0);
            assert_eq!(values.next(Kind::F32).unwrap(), 1.5);
            assert_eq!((values.place(), values.remaining()), (Place::Byte(2), 0));
            assert!(values.next(Kind::U8).is_err());
        }
    }
}
