//! The reader between an OBJ file and tobj: what tobj gets from it is always plain `v x y z` and `f i j k …`.
//!
//! ```text
//! bytes ─ Lines ─ statements ─┬─ v, f: checked, rewritten ──▶ tobj
//!                             ├─ usemtl, mtllib: kept in [`Facts`]
//!                             └─ all else: counted or dropped
//! ```
//!
//! tobj 4.0.5 keeps vertices apart between groups, makes triangles of polylines, accepts `nan`, and reports neither line
//! nor word of an error; so groups and materials never reach it, indices arrive absolute and checked, and this reader
//! serves it one line at a time, which makes the line served last the one that an error is about.

use std::collections::HashMap;
use std::io::{self, BufRead, Read};

use super::lines::{Failure, Lines, words};

/// What the file says besides vertices and faces.
#[derive(Debug, Default)]
pub struct Facts {
    /// `v` statements.
    pub vertices: i64,
    /// Faces passed on.
    pub faces: u32,
    /// From which face on which of `names` holds; `None` is the default material.
    pub materials: Vec<(u32, Option<u32>)>,
    /// Names that `usemtl` used, each once.
    pub names: Vec<String>,
    /// Where each name stands in `names`.
    index_of: HashMap<String, u32>,
    /// What stands after each `mtllib`, and on which line.
    pub libraries: Vec<(u64, String)>,
    /// Faces of one or two corners, which are dropped.
    pub short_faces: u64,
    /// Polylines and points, which are dropped.
    pub lines_and_points: u64,
    /// Free-form curves and surfaces, which are dropped.
    pub free_forms: u64,
    /// Vertices with a weight other than 1, which is dropped.
    pub weights: u64,
    /// The largest index that a face names, and on which line.
    farthest: (i64, u64),
}

impl Facts {
    /// Checks what can only be known at the end: that faces name vertices of the file.
    pub fn check(&self) -> Result<(), Failure> {
        let (index, line) = self.farthest;
        if index > self.vertices {
            return Err(Failure::at(
                line,
                format!(
                    "a face names vertex {index}, but the file has only {}",
                    self.vertices
                ),
            ));
        }
        Ok(())
    }
}

/// Serves cleaned lines, see the module.
pub struct Clean<R> {
    lines: Lines<R>,
    served: Vec<u8>,
    at: usize,
    /// Line of `served`.
    line: u64,
    /// What was learned so far.
    pub facts: Facts,
    failure: Option<Failure>,
}

impl<R: BufRead> Clean<R> {
    /// The cleaned lines of `reader`.
    pub fn new(reader: R) -> Self {
        Self {
            lines: Lines::new(reader),
            served: Vec::new(),
            at: 0,
            line: 0,
            facts: Facts::default(),
            failure: None,
        }
    }

    /// Why reading failed, given what tobj said.
    pub fn failure(self, error: tobj::LoadError) -> Failure {
        if let Some(failure) = self.failure {
            return failure;
        }
        if error == tobj::LoadError::FaceVertexOutOfBounds
            && let Err(failure) = self.facts.check()
        {
            return failure;
        }
        // All else that is left for tobj to refuse is a number.
        let number = |w: &[u8]| std::str::from_utf8(w).is_ok_and(|w| w.parse::<f32>().is_ok());
        let bad = words(&self.served).skip(1).find(|w| !number(w));
        Failure::at(
            self.line,
            bad.map_or_else(
                || error.to_string(),
                |bad| format!("'{}' is not a number", shown(bad)),
            ),
        )
    }

    /// Fills `served` with the next line for tobj; leaves it empty at the end.
    fn advance(&mut self) -> Result<(), Failure> {
        self.served.clear();
        self.at = 0;
        while self.served.is_empty() {
            let Some((line, text)) = self.lines.next()? else {
                return Ok(());
            };
            self.line = line;
            let mut rest = words(text);
            match rest.next().unwrap_or_default() {
                b"v" => vertex(line, rest, &mut self.served, &mut self.facts)?,
                b"f" => face(line, rest, &mut self.served, &mut self.facts)?,
                b"usemtl" => use_material(&text[6..], &mut self.facts),
                b"mtllib" => self
                    .facts
                    .libraries
                    .push((line, shown(text[6..].trim_ascii()))),
                b"l" | b"p" => self.facts.lines_and_points += 1,
                b"curv" | b"curv2" | b"surf" => self.facts.free_forms += 1,
                // Normals, texture coordinates, groups, smoothing: nothing that a triangle's shape depends on.
                _ => {}
            }
        }
        Ok(())
    }
}

/// Text for a message or a name, with bytes that are no UTF-8 replaced.
pub fn shown(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Passes on `v x y z`. Colours after the coordinates are dropped, and so is a weight, which only free-form curves use.
fn vertex<'a>(
    line: u64,
    mut rest: impl Iterator<Item = &'a [u8]>,
    served: &mut Vec<u8>,
    facts: &mut Facts,
) -> Result<(), Failure> {
    served.push(b'v');
    for _ in 0..3 {
        let word = rest
            .next()
            .ok_or_else(|| Failure::at(line, "a vertex needs three coordinates"))?;
        check_number(line, word)?;
        served.push(b' ');
        served.extend_from_slice(word);
    }
    served.push(b'\n');
    let after: Vec<&[u8]> = rest.take(2).collect();
    if let [weight] = after[..] {
        let weight = std::str::from_utf8(weight).map(str::parse::<f32>);
        facts.weights += u64::from(!matches!(weight, Ok(Ok(1.0))));
    }
    facts.vertices += 1;
    Ok(())
}

/// Refuses what tobj would accept as a number although it is not finite, or could not even show.
fn check_number(line: u64, word: &[u8]) -> Result<(), Failure> {
    if !word.is_ascii() {
        return Err(Failure::at(
            line,
            format!("'{}' is not a number", shown(word)),
        ));
    }
    // Only these can be anything but finite: `nan`, `inf`, and powers of ten that f32 does not reach.
    let suspicious = word.len() > 30
        || word
            .iter()
            .any(|b| matches!(b, b'n' | b'N' | b'i' | b'I' | b'e' | b'E'));
    let value = || std::str::from_utf8(word).ok()?.parse::<f32>().ok();
    match suspicious.then(value).flatten() {
        Some(x) if !x.is_finite() => Err(Failure::at(
            line,
            format!(
                "'{}' is not a finite 32-bit number; every coordinate must be one",
                shown(word)
            ),
        )),
        _ => Ok(()),
    }
}

/// Passes on `f i j k …` with absolute vertex indices alone, or counts a face that has fewer than three.
fn face<'a>(
    line: u64,
    rest: impl Iterator<Item = &'a [u8]>,
    served: &mut Vec<u8>,
    facts: &mut Facts,
) -> Result<(), Failure> {
    served.push(b'f');
    let mut corners = 0;
    for word in rest {
        let index = corner(line, word, facts.vertices)?;
        if index > facts.farthest.0 {
            facts.farthest = (index, line);
        }
        served.push(b' ');
        push_number(served, index);
        corners += 1;
    }
    if corners == 0 {
        return Err(Failure::at(line, "a face needs three corners or more"));
    }
    if corners < 3 {
        facts.short_faces += 1;
        served.clear();
        return Ok(());
    }
    served.push(b'\n');
    facts.faces += 1;
    Ok(())
}

/// The absolute vertex index of a face's corner `v`, `v/vt`, `v//vn` or `v/vt/vn`. Indices of normals and texture
/// coordinates must look like numbers, but as they are not used, nothing checks that they exist.
fn corner(line: u64, word: &[u8], vertices: i64) -> Result<i64, Failure> {
    let mut parts = word.split(|&b| b == b'/');
    let vertex = parts.next().unwrap_or_default();
    let index = std::str::from_utf8(vertex)
        .ok()
        .and_then(|v| v.parse::<i64>().ok())
        // 2³¹ vertices are more than an index can name.
        .filter(|i| i.abs() <= 1 << 31);
    let others =
        parts.clone().count() <= 2 && parts.flatten().all(|b| b.is_ascii_digit() || *b == b'-');
    match index {
        Some(0) => Err(Failure::at(
            line,
            "a face names vertex 0, but OBJ counts vertices from 1",
        )),
        Some(i) if i < 0 && -i > vertices => Err(Failure::at(
            line,
            format!("a face names vertex {i}, but only {vertices} stand above it"),
        )),
        Some(i) if others => Ok(if i < 0 { vertices + 1 + i } else { i }),
        _ => Err(Failure::at(
            line,
            format!(
                "'{}' is not a corner of a face; it is written v, v/vt, v//vn or v/vt/vn",
                shown(word)
            ),
        )),
    }
}

/// Appends `number` ≥ 0 in decimal.
fn push_number(out: &mut Vec<u8>, mut number: i64) {
    let start = out.len();
    loop {
        out.push(b'0' + (number % 10) as u8);
        number /= 10;
        if number == 0 {
            break;
        }
    }
    out[start..].reverse();
}

/// From the next face on the named material holds; without a name the default one.
fn use_material(name: &[u8], facts: &mut Facts) {
    let name = shown(name).trim().to_owned();
    let index = (!name.is_empty()).then(|| {
        let next = facts.names.len() as u32;
        *facts.index_of.entry(name).or_insert_with_key(|name| {
            facts.names.push(name.clone());
            next
        })
    });
    facts.materials.push((facts.faces, index));
}

impl<R: BufRead> Read for Clean<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let n = self.fill_buf()?.read(out)?;
        self.consume(n);
        Ok(n)
    }
}

impl<R: BufRead> BufRead for Clean<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.at == self.served.len()
            && let Err(failure) = self.advance()
        {
            self.failure = Some(failure);
            return Err(io::Error::other("see Clean::failure"));
        }
        Ok(&self.served[self.at..])
    }

    fn consume(&mut self, n: usize) {
        self.at += n;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clean(text: &str) -> String {
        let mut out = String::new();
        Clean::new(text.as_bytes())
            .read_to_string(&mut out)
            .unwrap();
        out
    }

    #[test]
    fn what_tobj_gets_is_vertices_and_faces_with_absolute_indices() {
        let text = "o x\nv 1 2 3 0.5 0.5 0.5\nv 4 5 6\nvn 0 0 1\nv 7 8 9 1\nl 1 2 3\nf -3//1 2/1/1 -1/4\ns off\n";
        assert_eq!(clean(text), "v 1 2 3\nv 4 5 6\nv 7 8 9\nf 1 2 3\n");
    }

    #[test]
    fn numbers_are_written_as_decimals() {
        let mut out = Vec::new();
        for n in [0, 7, 10, 1_234_567_890] {
            push_number(&mut out, n);
            out.push(b' ');
        }
        assert_eq!(out, b"0 7 10 1234567890 ");
    }
}
