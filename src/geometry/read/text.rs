//! Lines and words of a text, with the number of each line.
//!
//! Texts are bytes, since mesh files hold names in any encoding. A line ends with LF, CR LF or CR alone.

use std::str::FromStr;

use super::fault::{Fault, Read};

/// The lines of a text with their numbers, counted from 1.
pub(super) struct Lines<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Lines<'a> {
    pub fn new(text: &'a [u8]) -> Self {
        Lines { text, at: 0, line: 0 }
    }

    /// Offset in bytes of the line that comes next.
    pub fn offset(&self) -> usize {
        self.at
    }

    /// Bytes that no line has taken yet.
    pub fn remaining(&self) -> usize {
        self.text.len() - self.at
    }

    /// Number of the line that came last; 0 before the first.
    pub fn number(&self) -> usize {
        self.line
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = &self.text[self.at..];
        if rest.is_empty() {
            return None;
        }
        self.line += 1;
        let Some(end) = rest.iter().position(|&b| b == b'\n' || b == b'\r') else {
            self.at = self.text.len();
            return Some((self.line, rest));
        };
        self.at += end + if rest[end..].starts_with(b"\r\n") { 2 } else { 1 };
        Some((self.line, &rest[..end]))
    }
}

/// The words of a text, across its lines.
pub(super) struct Words<'a> {
    lines: Lines<'a>,
    rest: &'a [u8],
}

impl<'a> Words<'a> {
    /// The words of the lines that `lines` has yet to give.
    pub fn of(lines: Lines<'a>) -> Self {
        Words { lines, rest: &[] }
    }

    /// Number of the line of the word that came last.
    pub fn line(&self) -> usize {
        self.lines.number().max(1)
    }

    /// Bytes that no word has taken yet.
    pub fn remaining(&self) -> usize {
        self.rest.len() + self.lines.remaining()
    }

    /// The next word, or the end of the text as an error that names `what` was expected.
    pub fn expect(&mut self, what: &str) -> Read<&'a [u8]> {
        self.next().ok_or_else(|| Fault::line(self.line(), format!("the file ends where {what} was expected")))
    }

    /// Passes over the rest of the line of the word that came last.
    pub fn skip_line(&mut self) {
        self.rest = &[];
    }

    /// The next word as a number.
    pub fn number(&mut self, what: &str) -> Read<f64> {
        let word = self.expect(what)?;
        number(word).ok_or_else(|| Fault::line(self.line(), format!("{what} was expected, found {}", quote(word))))
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            if let Some(start) = self.rest.iter().position(|b| !is_space(*b)) {
                let word = &self.rest[start..];
                let end = word.iter().position(|b| is_space(*b)).unwrap_or(word.len());
                self.rest = &word[end..];
                return Some(&word[..end]);
            }
            (_, self.rest) = self.lines.next()?;
        }
    }
}

/// The words of one line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|b| is_space(*b)).filter(|word| !word.is_empty())
}

/// `line` up to its comment.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    line.split(|&b| b == b'#').next().unwrap_or_default()
}

/// A word as a number; NaN and the infinities pass here, and fail as coordinates.
pub(super) fn number<T: FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A piece of a file, cut and escaped for a message.
pub(super) fn quote(piece: &[u8]) -> String {
    const LONGEST: usize = 40;
    let dots = if piece.len() > LONGEST { "..." } else { "" };
    format!("`{}{dots}`", piece[..piece.len().min(LONGEST)].escape_ascii())
}

fn is_space(byte: u8) -> bool {
    // 0x0b is the vertical tab, which `is_ascii_whitespace` leaves out.
    byte.is_ascii_whitespace() || byte == 0x0b
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<(usize, &str)> {
        Lines::new(text.as_bytes()).map(|(i, line)| (i, std::str::from_utf8(line).unwrap())).collect()
    }

    #[test]
    fn lines_end_in_three_ways() {
        assert_eq!(lines(""), []);
        assert_eq!(lines("a"), [(1, "a")]);
        assert_eq!(lines("a\n"), [(1, "a")]);
        assert_eq!(lines("a\rb\r\nc\n\nd"), [(1, "a"), (2, "b"), (3, "c"), (4, ""), (5, "d")]);
    }

    #[test]
    fn words_know_their_line() {
        let mut words = Words::of(Lines::new(b"\n a\t b\r\n\r\nc d\ne"));
        let mut seen = Vec::new();
        while let Some(word) = words.next() {
            seen.push((words.line(), word));
            if word == b"c" {
                words.skip_line();
            }
        }
        assert_eq!(seen, [(2, &b"a"[..]), (2, b"b"), (4, b"c"), (5, b"e")]);
        assert_eq!(words.remaining(), 0);
        assert!(words.number("a radius").is_err());
    }

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quote(b"a\xff\n"), "`a\\xff\\n`");
        assert!(quote(&[b'x'; 1000]).len() < 50);
    }
}
