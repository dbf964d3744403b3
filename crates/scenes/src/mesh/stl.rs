//! Meshes from STL files, binary or text: triangles, each with its corners.

use std::collections::HashMap;

use super::data::{MAX_POINTS, MAX_TRIANGLES, Mesh};
use crate::text::{Lines, unmarked, words};

/// Lengths of the header of a binary file and of a triangle (bytes).
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

/// Mesh that was read so far, in which corners with the same bits are one point.
#[derive(Default)]
struct Corners {
    mesh: Mesh,
    known: HashMap<[u64; 3], u32>,
}

impl Corners {
    /// Returns the point at a place, and adds it if it is new.
    fn point(&mut self, at: [f64; 3]) -> Result<u32, String> {
        if !at.iter().all(|x| x.is_finite()) {
            return Err("a corner has three finite coordinates".into());
        }
        let positions = &mut self.mesh.positions;
        let next = positions.len() as u32;
        let point = *self.known.entry(at.map(f64::to_bits)).or_insert(next);
        if point == next {
            if positions.len() == MAX_POINTS {
                return Err(format!("there are more than {MAX_POINTS} points"));
            }
            positions.push(at);
        }
        Ok(point)
    }

    fn triangle(&mut self, corners: [[f64; 3]; 3]) -> Result<(), String> {
        if self.mesh.triangles.len() == MAX_TRIANGLES {
            return Err(format!("there are more than {MAX_TRIANGLES} triangles"));
        }
        let [a, b, c] = corners.map(|at| self.point(at));
        self.mesh.triangles.push([a?, b?, c?]);
        Ok(())
    }
}

/// Reads the mesh of a file. A binary file may begin like text, but it has the length that it
/// gives.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, String> {
    let count = bytes.get(HEAD - 4..HEAD).and_then(|n| n.try_into().ok());
    let count = count.map(|n| u32::from_le_bytes(n) as usize);
    let length = count.and_then(|count| count.checked_mul(TRIANGLE)?.checked_add(HEAD));
    let is_text = |bytes: &[u8]| {
        let begin = bytes.trim_ascii_start().get(..5);
        begin.is_some_and(|begin| begin.eq_ignore_ascii_case(b"solid"))
    };
    let fits = length.filter(|length| *length <= bytes.len());
    match (unmarked(bytes), fits) {
        (_, Some(length)) if length == bytes.len() => binary(&bytes[HEAD..]),
        (Ok(text), fits) if is_text(text) => match (lines(text), fits) {
            // Some binary files begin like text, and have more bytes after their triangles.
            (Ok(mesh), Some(length)) if mesh.triangles.is_empty() => binary(&bytes[HEAD..length]),
            (read, _) => read,
        },
        (_, Some(length)) => binary(&bytes[HEAD..length]),
        (Err(why), None) => Err(why),
        (Ok(_), None) => Err("it is no STL file, or cut short: one begins with `solid`, or has 84 bytes and 50 more for each triangle".into()),
    }
}

fn binary(triangles: &[u8]) -> Result<Mesh, String> {
    let mut corners = Corners::default();
    for (k, triangle) in triangles.chunks_exact(TRIANGLE).enumerate() {
        // A normal comes first.
        let (numbers, _) = triangle[12..48].as_chunks::<4>();
        let (points, _) = numbers.as_chunks::<3>();
        let [a, b, c] = [0, 1, 2].map(|k| points[k].map(|x| f64::from(f32::from_le_bytes(x))));
        let added = corners.triangle([a, b, c]);
        added.map_err(|why| format!("triangle {k}, counted from 0: {why}"))?;
    }
    Ok(corners.mesh)
}

fn lines(text: &[u8]) -> Result<Mesh, String> {
    let (mut corners, mut loop_of) = (Corners::default(), vec![]);
    let mut is_in_facet = false;
    for (line, statement) in Lines::new(text) {
        let wrong = |why: String| format!("line {line}: {why}");
        let mut words = words(statement);
        let key = words.next().unwrap_or_default().to_ascii_lowercase();
        match &key[..] {
            b"facet" => is_in_facet = true,
            b"endfacet" => is_in_facet = false,
            b"vertex" => {
                let mut coordinate = || str::from_utf8(words.next()?).ok()?.parse::<f64>().ok();
                let [Some(x), Some(y), Some(z)] = [coordinate(), coordinate(), coordinate()] else {
                    let why = "a corner has three numbers, as in `vertex 0 0.5 1`";
                    return Err(wrong(why.into()));
                };
                loop_of.push([x, y, z]);
            }
            b"endloop" => {
                let [a, b, c] = loop_of[..] else {
                    return Err(wrong("a triangle has three corners".into()));
                };
                corners.triangle([a, b, c]).map_err(wrong)?;
                loop_of.clear();
            }
            _ => {}
        }
        if loop_of.len() > 3 {
            return Err(wrong("a triangle has three corners".into()));
        }
    }
    if is_in_facet {
        return Err("the file ends within a facet: it is cut short".into());
    }
    Ok(corners.mesh)
}
