//! Tetrahedra of a mesh from any file, and the triangles that bound them.

use std::collections::HashSet;

use a3_core::Vector3;

use super::data::{MAX_POINTS, MAX_TETRAHEDRA, Mesh};
use crate::description::Triple;
use crate::text::Lines;

/// Faces of a tetrahedron, counterclockwise as seen from outside.
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

/// Lists the faces that belong to one tetrahedron only, in the order of the tetrahedra,
/// counterclockwise as seen from outside.
pub(crate) fn boundary(tetrahedra: &[[u32; 4]]) -> Vec<[u32; 3]> {
    let faces = |t: &[u32; 4]| FACES.map(|face| face.map(|k| t[k]));
    let mut all: Vec<_> = tetrahedra
        .iter()
        .flat_map(faces)
        .enumerate()
        .map(|(place, face)| {
            let mut corners = face;
            corners.sort_unstable();
            (corners, place as u32, face)
        })
        .collect();
    all.sort_unstable();
    let mut outer: Vec<_> = all
        .chunk_by(|(a, ..), (b, ..)| a == b)
        .filter(|same| same.len() == 1)
        .map(|same| (same[0].1, same[0].2))
        .collect();
    outer.sort_unstable();
    outer.into_iter().map(|(_, face)| face).collect()
}

/// Tetrahedron of a file.
pub(super) struct Tetrahedron {
    number: u64,
    /// Numbers of its corners.
    corners: [u64; 4],
    line: usize,
}

/// Points and tetrahedra as a file numbers them.
#[derive(Default)]
pub(super) struct Numbered {
    /// Number of each point, and its position.
    pub points: Vec<(u64, Triple)>,
    pub tetrahedra: Vec<Tetrahedron>,
}

impl Numbered {
    /// Adds the point of a line.
    pub fn add_point(&mut self, number: u64, position: Triple) -> Result<(), String> {
        if self.points.len() == MAX_POINTS {
            return Err(format!("there are more than {MAX_POINTS} points"));
        }
        self.points.push((number, position));
        Ok(())
    }

    /// Adds the tetrahedron of a line.
    pub fn add_tetrahedron(
        &mut self,
        number: u64,
        corners: [u64; 4],
        line: usize,
    ) -> Result<(), String> {
        if self.tetrahedra.len() == MAX_TETRAHEDRA {
            return Err(format!("there are more than {MAX_TETRAHEDRA} tetrahedra"));
        }
        self.tetrahedra.push(Tetrahedron {
            number,
            corners,
            line,
        });
        Ok(())
    }

    /// Creates the mesh, with its points numbered in their order. If the volumes of all tetrahedra
    /// are negative, the file counts corners the other way round, and all are turned.
    pub fn mesh(mut self) -> Result<Mesh, String> {
        self.points.sort_by_key(|(number, _)| *number);
        if let Some(twice) = self.points.windows(2).find(|w| w[0].0 == w[1].0) {
            return Err(format!("there are two points of number {}", twice[0].0));
        }
        let find = |number: u64, line: usize| {
            let place = self
                .points
                .binary_search_by_key(&number, |(number, _)| *number);
            let none = |_| format!("line {line}: there is no point {number}");
            place.map(|place| place as u32).map_err(none)
        };
        let mut tetrahedra = Vec::with_capacity(self.tetrahedra.len());
        for Tetrahedron { corners, line, .. } in &self.tetrahedra {
            let [a, b, c, d] = corners.map(|corner| find(corner, *line));
            tetrahedra.push([a?, b?, c?, d?]);
        }
        if tetrahedra.is_empty() {
            return Err("the file has no tetrahedra".into());
        }
        // Gmsh writes an element twice that is in two groups.
        let mut seen = HashSet::new();
        let mut is_new: Vec<_> = tetrahedra
            .iter()
            .map(|t: &[u32; 4]| {
                let mut corners = *t;
                corners.sort_unstable();
                seen.insert(corners)
            })
            .collect();
        let mut kept = is_new.iter();
        tetrahedra.retain(|_| *kept.next().unwrap_or(&true));
        let mut kept = is_new.drain(..);
        self.tetrahedra.retain(|_| kept.next().unwrap_or(true));
        let positions: Vec<_> = self.points.iter().map(|(_, position)| *position).collect();
        let is_turned = |t: &[u32; 4]| {
            let [a, b, c, d] = t.map(|i| Vector3::from(positions[i as usize]));
            (b - a).cross(&(c - a)).dot(&(d - a)) < 0.0
        };
        if tetrahedra.iter().all(is_turned) {
            for t in &mut tetrahedra {
                t.swap(2, 3);
            }
        }
        Ok(Mesh {
            triangles: boundary(&tetrahedra),
            positions,
            tetrahedra,
            numbers: self.points.iter().map(|(number, _)| *number).collect(),
            tetrahedron_numbers: self.tetrahedra.iter().map(|t| t.number).collect(),
        })
    }
}

/// Lists the lines of a file that have words, with their numbers from 1, without comments.
pub(super) fn lines(text: &[u8]) -> impl Iterator<Item = (usize, Vec<&str>)> {
    Lines::new(text).filter_map(|(number, line)| {
        let text = std::str::from_utf8(line).unwrap_or("?");
        let words: Vec<_> = text.split_ascii_whitespace().take(MAX_WORDS).collect();
        (!words.is_empty()).then_some((number, words))
    })
}

/// Largest number of words of a line that are read.
const MAX_WORDS: usize = 64;

/// Reads words as whole numbers. The error names the first word that is none.
pub(super) fn whole(words: &[&str]) -> Result<Vec<u64>, String> {
    let each = words.iter().map(|word| {
        let number = word.parse().ok();
        number.ok_or_else(|| format!("`{}` is no whole number", brief(word)))
    });
    each.collect()
}

/// Reads the three coordinates at the beginning of some words.
pub(super) fn position(words: &[&str]) -> Result<Triple, String> {
    let mut position = [0.0; 3];
    for (axis, x) in position.iter_mut().enumerate() {
        let word = words.get(axis);
        let number = word
            .and_then(|word| word.parse().ok())
            .filter(|x: &f64| x.is_finite());
        *x = number.ok_or("a point has a number and three finite coordinates")?;
    }
    Ok(position)
}

fn brief(word: &str) -> String {
    word.chars().take(40).collect()
}
