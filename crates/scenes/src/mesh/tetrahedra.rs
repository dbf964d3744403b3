//! Meshes of tetrahedra, and the triangles that bound them: from Gmsh's text files, versions 2.2
//! and 4.1, of which `$Nodes` and `$Elements` are read, without points, lines and faces; and from a
//! pair of `TetGen`'s text files, points (`.node`) and tetrahedra (`.ele`).

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
    let all = tetrahedra.iter().flat_map(faces).enumerate();
    let all = all.map(|(place, face)| (sorted(face), place as u32, face));
    let mut all: Vec<_> = all.collect();
    all.sort_unstable();
    let same = all.chunk_by(|(a, ..), (b, ..)| a == b);
    let alone = same.filter(|same| same.len() == 1);
    let mut outer: Vec<_> = alone.map(|same| (same[0].1, same[0].2)).collect();
    outer.sort_unstable();
    outer.into_iter().map(|(_, face)| face).collect()
}

/// Returns corners in the order of their numbers.
fn sorted<const N: usize>(mut corners: [u32; N]) -> [u32; N] {
    corners.sort_unstable();
    corners
}

/// Tetrahedron of a file.
struct Tetrahedron {
    number: u64,
    /// Numbers of its corners.
    corners: [u64; 4],
    line: usize,
}

/// Points and tetrahedra as a file numbers them.
#[derive(Default)]
struct Numbered {
    /// Number of each point, and its position.
    points: Vec<(u64, Triple)>,
    tetrahedra: Vec<Tetrahedron>,
}

impl Numbered {
    /// Adds the point of a line.
    fn add_point(&mut self, number: u64, position: Triple) -> Result<(), String> {
        refuse!(if self.points.len() == MAX_POINTS => "there are more than {MAX_POINTS} points");
        self.points.push((number, position));
        Ok(())
    }

    /// Adds the tetrahedron of a line, of whose points the first four are the corners.
    fn add_tetrahedron(&mut self, number: u64, corners: &[u64], line: usize) -> Result<(), String> {
        let &[a, b, c, d, ..] = corners else {
            return Err("a tetrahedron has four corners".into());
        };
        refuse!(if self.tetrahedra.len() == MAX_TETRAHEDRA =>
            "there are more than {MAX_TETRAHEDRA} tetrahedra");
        let corners = [a, b, c, d];
        self.tetrahedra.push(Tetrahedron { number, corners, line });
        Ok(())
    }

    /// Creates the mesh, with its points numbered in their order. If the volumes of all tetrahedra
    /// are negative, the file counts corners the other way round, and all are turned.
    fn mesh(mut self) -> Result<Mesh, String> {
        self.points.sort_by_key(|(number, _)| *number);
        if let Some(twice) = self.points.windows(2).find(|w| w[0].0 == w[1].0) {
            return Err(format!("there are two points of number {}", twice[0].0));
        }
        let find = |number: u64, line: usize| {
            let points = &self.points;
            let place = points.binary_search_by_key(&number, |(number, _)| *number);
            let none = |_| format!("line {line}: there is no point {number}");
            place.map(|place| place as u32).map_err(none)
        };
        let (mut tetrahedra, mut tetrahedron_numbers) = (vec![], vec![]);
        let mut seen = HashSet::new();
        for Tetrahedron { number, corners, line } in &self.tetrahedra {
            let [a, b, c, d] = corners.map(|corner| find(corner, *line));
            let corners = [a?, b?, c?, d?];
            // Gmsh writes an element twice that is in two groups.
            if seen.insert(sorted(corners)) {
                tetrahedra.push(corners);
                tetrahedron_numbers.push(*number);
            }
        }
        refuse!(if tetrahedra.is_empty() => "the file has no tetrahedra");
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
            tetrahedron_numbers,
        })
    }
}

/// Lists the lines of a file that have words, with their numbers from 1, without comments.
fn lines(text: &[u8]) -> impl Iterator<Item = (usize, Vec<&str>)> {
    Lines::new(text).filter_map(|(number, line)| {
        let text = std::str::from_utf8(line).unwrap_or("?");
        let words: Vec<_> = text.split_ascii_whitespace().take(MAX_WORDS).collect();
        (!words.is_empty()).then_some((number, words))
    })
}

/// Largest number of words of a line that are read.
const MAX_WORDS: usize = 64;

/// Reads words as whole numbers. The error names the first word that is none.
fn whole(words: &[&str]) -> Result<Vec<u64>, String> {
    let brief = |word: &str| word.chars().take(40).collect::<String>();
    let wrong = |word: &str| format!("`{}` is no whole number", brief(word));
    words.iter().map(|word| word.parse().map_err(|_| wrong(word))).collect()
}

/// Reads the three coordinates at the beginning of some words.
fn position(words: &[&str]) -> Result<Triple, String> {
    let mut position = [0.0; 3];
    for (axis, x) in position.iter_mut().enumerate() {
        let number = words.get(axis).and_then(|word| word.parse().ok());
        let finite = number.filter(|x: &f64| x.is_finite());
        *x = finite.ok_or("a point has a number and three finite coordinates")?;
    }
    Ok(position)
}

/// Reads the mesh of a pair of files. Of a tetrahedron with ten points, the first four are the
/// corners.
pub(super) fn tetgen(node: &[u8], ele: &[u8]) -> Result<Mesh, String> {
    let mut numbered = Numbered::default();
    let head = "its number of points and their dimension, 3";
    each(node, ".node", head, 3, |line, number, words| {
        let added = position(words).and_then(|at| numbered.add_point(number, at));
        added.map_err(|why| format!("line {line} of the .node file: {why}"))
    })?;
    let head = "its number of tetrahedra and of the corners of each, 4 or 10";
    each(ele, ".ele", head, 4, |line, number, words| {
        let none = || format!("tetrahedron {number} has four corners");
        let corners = words.get(..4).ok_or_else(none).and_then(whole);
        let added = corners.and_then(|corners| numbered.add_tetrahedron(number, &corners, line));
        added.map_err(|why| format!("line {line}: {why}"))
    })?;
    numbered.mesh()
}

/// Visits the lines whose count the first one gives. `visit` gets the number of each line, its
/// first word, and the others.
fn each(
    bytes: &[u8],
    name: &str,
    head: &str,
    kind: u64,
    mut visit: impl FnMut(usize, u64, &[&str]) -> Result<(), String>,
) -> Result<(), String> {
    let mut lines = lines(bytes);
    let first = lines.next().map(|(_, words)| words);
    let counts = first.and_then(|words| whole(&words[..words.len().min(2)]).ok());
    let is_kind = |found: u64| found == kind || kind == 4 && found == 10;
    let given = |counts: &[u64]| counts.get(1).is_none_or(|found| is_kind(*found));
    let Some(&[count, ..]) = counts.as_deref().filter(|counts| given(counts)) else {
        refuse!("the first line of the {name} file must give {head}");
    };
    for _ in 0..count {
        let Some((line, words)) = lines.next() else {
            refuse!("the {name} file ends before all {count} of its lines");
        };
        let number = whole(&words[..1]).map_err(|why| format!("line {line}: {why}"))?[0];
        visit(line, number, &words[1..])?;
    }
    Ok(())
}

/// Returns whether elements of a kind are tetrahedra, of any order: their first points are the
/// corners.
fn is_simplex(kind: u64) -> bool {
    matches!(kind, 4 | 11 | 29..=33 | 71..=75 | 79..=83 | 87 | 137 | 139)
}

/// Returns whether a kind of elements is another solid: a hexahedron, a prism, a pyramid or a
/// polyhedron.
fn is_other_solid(kind: u64) -> bool {
    matches!(kind, 5..=7 | 12..=14 | 17..=19 | 35 | 88..=132 | 140)
}

/// Returns whether elements of a kind are tetrahedra. Other solid elements are refused, because a
/// body without them would have holes.
fn is_tetrahedron(kind: u64) -> Result<bool, String> {
    if is_other_solid(kind) {
        return Err(format!(
            "an element of type {kind} is a hexahedron, a prism or a pyramid: of solid elements only tetrahedra are read"
        ));
    }
    Ok(is_simplex(kind))
}

/// Reader of a file of Gmsh.
struct GmshReader<'a> {
    lines: Box<dyn Iterator<Item = (usize, Vec<&'a str>)> + 'a>,
    /// Number of the line that was read last; 0 at the end of the file.
    line: usize,
    numbered: Numbered,
}

const NO_FORMAT: &str = "it is no Gmsh file: one begins with $MeshFormat";

/// Reads the mesh of a file of Gmsh.
pub(super) fn gmsh(bytes: &[u8]) -> Result<Mesh, String> {
    let (lines, numbered) = (Box::new(lines(bytes)), Numbered::default());
    let mut reader = GmshReader { lines, line: 0, numbered };
    // Whether the version is 4.1 and not 2.2, once it is known.
    let mut is_new = None;
    while let Some((line, words)) = reader.lines.next() {
        reader.line = line;
        let read = match (words[0], is_new) {
            ("$MeshFormat", _) => {
                let words = reader.next("$MeshFormat");
                is_new = Some(is_new_format(&words.map_err(|why| reader.wrong(why))?)?);
                Ok(())
            }
            ("$NOD" | "$ELM", None) => return Err(refused("1")),
            ("$Nodes" | "$ParametricNodes" | "$Elements", None) => return Err(NO_FORMAT.into()),
            ("$Nodes" | "$ParametricNodes", Some(false)) => reader.nodes(),
            ("$Nodes", Some(true)) => reader.blocks_of_nodes(),
            ("$Elements", Some(false)) => reader.elements(),
            ("$Elements", Some(true)) => reader.blocks_of_elements(),
            _ => Ok(()),
        };
        read.map_err(|why| reader.wrong(why))?;
    }
    if is_new.is_none() {
        return Err(NO_FORMAT.into());
    }
    reader.numbered.mesh()
}

/// Returns whether the version in a line such as `4.1 0 8` is 4.1 and not 2.2.
fn is_new_format(words: &[&str]) -> Result<bool, String> {
    match words {
        ["2.2", "0", ..] => Ok(false),
        ["4.1", "0", ..] => Ok(true),
        [version, "1", ..] => Err(refused(&format!("{version}, binary"))),
        [version, ..] => Err(refused(version)),
        [] => Err(NO_FORMAT.into()),
    }
}

/// Returns the error of a format of Gmsh that is not supported.
fn refused(format: &str) -> String {
    format!(
        "it is Gmsh's format {format}, and only the text formats 2.2 and 4.1 are read: save with `-format msh41` or `msh22`"
    )
}

impl<'a> GmshReader<'a> {
    /// Reads the next line. `within` is the section that must not end before it.
    fn next(&mut self, within: &str) -> Result<Vec<&'a str>, String> {
        let line = self.lines.next();
        self.line = line.as_ref().map_or(0, |(line, _)| *line);
        match line {
            None => Err(format!("the file ends within {within}")),
            Some((_, words)) if words[0].starts_with('$') => {
                Err(format!("{within} ends early: more lines are announced"))
            }
            Some((_, words)) => Ok(words),
        }
    }

    /// Reads the whole numbers of the next line, at least `least` of them.
    fn numbers(&mut self, within: &str, least: usize) -> Result<Vec<u64>, String> {
        let numbers = whole(&self.next(within)?)?;
        refuse!(if numbers.len() < least => "{least} whole numbers are needed here");
        Ok(numbers)
    }

    /// Adds the line to an error, if it has one.
    fn wrong(&self, why: String) -> String {
        match self.line {
            0 => why,
            line => format!("line {line}: {why}"),
        }
    }

    fn nodes(&mut self) -> Result<(), String> {
        for _ in 0..self.numbers("$Nodes", 1)?[0] {
            let words = self.next("$Nodes")?;
            let number = whole(&words[..1])?[0];
            self.numbered.add_point(number, position(&words[1..])?)?;
        }
        Ok(())
    }

    fn elements(&mut self) -> Result<(), String> {
        for _ in 0..self.numbers("$Elements", 1)?[0] {
            let words = self.next("$Elements")?;
            let head = whole(words.get(..3).ok_or("3 whole numbers are needed here")?)?;
            if is_tetrahedron(head[1])? {
                // Tags, which may be negative, come before the corners.
                let first = usize::try_from(head[2].saturating_add(3)).unwrap_or(usize::MAX);
                let corners = whole(words.get(first..).unwrap_or_default())?;
                self.numbered.add_tetrahedron(head[0], &corners, self.line)?;
            }
        }
        Ok(())
    }

    fn blocks_of_nodes(&mut self) -> Result<(), String> {
        for _ in 0..self.numbers("$Nodes", 2)?[0] {
            let count = self.numbers("$Nodes", 4)?[3];
            let first = self.numbered.points.len();
            for _ in 0..count {
                let number = self.numbers("$Nodes", 1)?[0];
                self.numbered.add_point(number, [0.0; 3])?;
            }
            for k in first..self.numbered.points.len() {
                self.numbered.points[k].1 = position(&self.next("$Nodes")?)?;
            }
        }
        Ok(())
    }

    fn blocks_of_elements(&mut self) -> Result<(), String> {
        for _ in 0..self.numbers("$Elements", 2)?[0] {
            let head = self.numbers("$Elements", 4)?;
            let is_tetrahedron = is_tetrahedron(head[2])?;
            for _ in 0..head[3] {
                let numbers = self.numbers("$Elements", 1)?;
                if is_tetrahedron {
                    self.numbered.add_tetrahedron(numbers[0], &numbers[1..], self.line)?;
                }
            }
        }
        Ok(())
    }
}
