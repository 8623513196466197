//! Lines of OBJ and MTL text: counted, joined and stripped, before any grammar looks at them.
//!
//! Lines end in LF, CRLF or CR. A byte order mark is dropped. A `\` at the end of a line joins it with the next, and a
//! comment goes, whatever bytes it holds; a `\` in a comment joins nothing, because paths in comments end in one.

use std::io::{self, BufRead};

/// The longest joined line: enough for a face of millions of corners, and an end for files that are no text.
const MAX_LINE: usize = 64 << 20;

/// Why there is no next line.
#[derive(Debug)]
pub enum Failure {
    /// The system could not read on.
    Io(io::Error),
    /// What stands at a line, from 1, and what is wrong with it.
    Text {
        /// The line.
        line: u64,
        /// A sentence without its full stop.
        reason: String,
    },
    /// What is wrong with the file as a whole.
    File(String),
}

impl Failure {
    /// What is wrong at `line`.
    pub fn at(line: u64, reason: impl Into<String>) -> Self {
        Self::Text {
            line,
            reason: reason.into(),
        }
    }
}

/// Reads lines that hold something besides white space and comments.
pub struct Lines<R> {
    reader: R,
    line: Vec<u8>,
    /// Physical lines read so far.
    count: u64,
    /// Whether the last line ended in CR, so that an LF which follows belongs to it.
    after_cr: bool,
}

impl<R: BufRead> Lines<R> {
    /// Lines of `reader`.
    pub fn new(reader: R) -> Self {
        Self {
            reader,
            line: Vec::new(),
            count: 0,
            after_cr: false,
        }
    }

    /// The next joined line without comment and surrounding white space, and the number of its first physical line;
    /// `None` at the end.
    pub fn next(&mut self) -> Result<Option<(u64, &[u8])>, Failure> {
        loop {
            self.line.clear();
            if !self.append()? {
                return Ok(None);
            }
            let first = self.count;
            let named = holds_a_name(&self.line);
            self.strip_from(0, named);
            while self.line.trim_ascii_end().last() == Some(&b'\\') {
                self.line.truncate(self.line.trim_ascii_end().len() - 1);
                self.line.push(b' ');
                let start = self.line.len();
                if !self.append()? {
                    break;
                }
                self.strip_from(start, named);
            }
            if !self.line.trim_ascii().is_empty() {
                return Ok(Some((first, self.line.trim_ascii())));
            }
        }
    }

    /// Appends the next physical line without its end; `false` when there is none.
    fn append(&mut self) -> Result<bool, Failure> {
        let start = self.line.len();
        let mut any = false;
        loop {
            let buffer = match self.reader.fill_buf() {
                Ok(buffer) => buffer,
                Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
                Err(e) => return Err(Failure::Io(e)),
            };
            if buffer.is_empty() {
                break;
            }
            if self.after_cr {
                self.after_cr = false;
                if buffer[0] == b'\n' {
                    self.reader.consume(1);
                    continue;
                }
            }
            any = true;
            let end = buffer.iter().position(|&b| b == b'\n' || b == b'\r');
            let taken = end.unwrap_or(buffer.len());
            if self.line.len() + taken > MAX_LINE {
                return Err(Failure::at(
                    self.count + 1,
                    "the line is longer than 64 MiB; is this an OBJ file?",
                ));
            }
            self.line.extend_from_slice(&buffer[..taken]);
            if let Some(end) = end {
                self.after_cr = buffer[end] == b'\r';
                self.reader.consume(end + 1);
                break;
            }
            self.reader.consume(taken);
        }
        if any {
            self.count += 1;
            if self.count == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
                self.line.drain(..3);
            }
            if self.line[start..].contains(&0) {
                return Err(Failure::File(format!(
                    "is not text: line {} holds a zero byte; export it as an OBJ in UTF-8",
                    self.count
                )));
            }
        }
        Ok(any)
    }

    /// Drops a comment in the part of the line from `start` on.
    fn strip_from(&mut self, start: usize, named: bool) {
        let part = &self.line[start..];
        // Names may hold a `#`; there a comment needs white space before it.
        let comment = part.iter().enumerate().position(|(i, &b)| {
            b == b'#' && (!named || i == 0 || part[i - 1].is_ascii_whitespace())
        });
        if let Some(comment) = comment {
            self.line.truncate(start + comment);
        }
    }
}

/// Whether the line's statement is followed by a name or path, which may hold nearly any character.
fn holds_a_name(line: &[u8]) -> bool {
    let word = words(line).next().unwrap_or_default();
    matches!(word, b"usemtl" | b"mtllib" | b"newmtl" | b"o" | b"g") || word.starts_with(b"map_")
}

/// The words of a line.
pub fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&b| is_blank(b)).filter(|word| !word.is_empty())
}

/// ASCII white space as `str::split_whitespace` sees it: with the vertical tab.
fn is_blank(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == b'\x0b'
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> Vec<(u64, String)> {
        let mut lines = Lines::new(text);
        let mut all = Vec::new();
        while let Some((n, line)) = lines.next().unwrap() {
            all.push((n, String::from_utf8_lossy(line).into_owned()));
        }
        all
    }

    #[test]
    fn all_three_line_ends_count_lines_alike() {
        let expected = [
            (1, "a".to_owned()),
            (3, "b".to_owned()),
            (4, "c".to_owned()),
        ];
        for text in ["a\n\nb\nc", "a\r\n\r\nb\r\nc\r\n", "a\r\rb\rc\r"] {
            assert_eq!(lines(text.as_bytes()), expected, "{text:?}");
        }
    }

    #[test]
    fn a_continuation_over_several_lines_has_the_number_of_its_first() {
        let text = b"f 1 \\\n 2 \\ # why\r\n 3\nv 1";
        assert_eq!(
            lines(text),
            [(1, "f 1   2   3".to_owned()), (4, "v 1".to_owned())]
        );
    }

    #[test]
    fn a_backslash_in_a_comment_or_at_the_end_of_the_file_joins_nothing() {
        assert_eq!(
            lines(b"# C:\\dir\\\nv 1\nv 2 \\"),
            [(2, "v 1".to_owned()), (3, "v 2".to_owned())]
        );
    }

    #[test]
    fn a_hash_belongs_to_a_name_unless_white_space_stands_before_it() {
        assert_eq!(
            lines(b"usemtl a#1 # x\nf 1 2 3#x"),
            [(1, "usemtl a#1".to_owned()), (2, "f 1 2 3".to_owned())]
        );
    }

    #[test]
    fn a_byte_order_mark_is_dropped_at_the_start_only() {
        assert_eq!(lines(b"\xef\xbb\xbfv 1"), [(1, "v 1".to_owned())]);
    }
}
