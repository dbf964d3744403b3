//! Meshes from STL files, binary or text: triangles, each with its corners.

use std::collections::HashMap;

use super::data::{MAX_POINTS, MAX_TRIANGLES, Mesh};
use crate::text::{Lines, unmarked, words};

/// Lengths of what a binary file begins with, and of a triangle (bytes).
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

/// The mesh so far, in which corners with the same bits are one point.
#[derive(Default)]
struct Corners {
    mesh: Mesh,
    known: HashMap<[u32; 3], u32>,
}

impl Corners {
    /// The point at that place.
    fn point(&mut self, at: [f32; 3]) -> Result<u32, String> {
        if !at.iter().all(|x| x.is_finite()) {
            return Err("a corner has three finite coordinates".into());
        }
        let positions = &mut self.mesh.positions;
        let next = positions.len() as u32;
        let point = *self.known.entry(at.map(f32::to_bits)).or_insert(next);
        if point == next {
            if positions.len() == MAX_POINTS {
                return Err(format!("there are more than {MAX_POINTS} points"));
            }
            positions.push(at.map(f64::from));
        }
        Ok(point)
    }

    fn triangle(&mut self, corners: [[f32; 3]; 3]) -> Result<(), String> {
        if self.mesh.triangles.len() == MAX_TRIANGLES {
            return Err(format!("there are more than {MAX_TRIANGLES} triangles"));
        }
        let [a, b, c] = corners.map(|at| self.point(at));
        self.mesh.triangles.push([a?, b?, c?]);
        Ok(())
    }
}

/// The mesh in a file. Binary files may begin like text, but have the length that they say.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, String> {
    let count = bytes.get(HEAD - 4..HEAD).and_then(|n| n.try_into().ok());
    let count = count.map(|n| u32::from_le_bytes(n) as usize);
    let length = count.and_then(|count| count.checked_mul(TRIANGLE)?.checked_add(HEAD));
    let text = unmarked(bytes).unwrap_or_default().trim_ascii_start();
    match length {
        Some(length) if length == bytes.len() => binary(&bytes[HEAD..]),
        _ if text.starts_with(b"solid") => lines(text),
        Some(length) if length < bytes.len() => binary(&bytes[HEAD..length]),
        _ => Err("it is no STL file, or cut short: one begins with `solid`, or has 84 bytes and 50 more for each triangle".into()),
    }
}

fn binary(triangles: &[u8]) -> Result<Mesh, String> {
    let mut corners = Corners::default();
    for (k, triangle) in triangles.chunks_exact(TRIANGLE).enumerate() {
        // A normal comes first.
        let (numbers, _) = triangle[12..48].as_chunks::<4>();
        let (points, _) = numbers.as_chunks::<3>();
        let [a, b, c] = [0, 1, 2].map(|k| points[k].map(f32::from_le_bytes));
        let added = corners.triangle([a, b, c]);
        added.map_err(|why| format!("triangle {k}, counted from 0: {why}"))?;
    }
    Ok(corners.mesh)
}

fn lines(text: &[u8]) -> Result<Mesh, String> {
    let (mut corners, mut loop_of) = (Corners::default(), vec![]);
    for (line, statement) in Lines::new(text) {
        let wrong = |why: String| format!("line {line}: {why}");
        let mut words = words(statement);
        match words.next() {
            Some(b"vertex") => {
                let mut coordinate = || str::from_utf8(words.next()?).ok()?.parse::<f32>().ok();
                let [Some(x), Some(y), Some(z)] = [coordinate(), coordinate(), coordinate()] else {
                    let why = "a corner has three numbers, as in `vertex 0 0.5 1`";
                    return Err(wrong(why.into()));
                };
                loop_of.push([x, y, z]);
            }
            Some(b"endloop") => {
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
    Ok(corners.mesh)
}
