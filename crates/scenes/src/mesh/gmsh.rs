//! Tetrahedra from Gmsh's text files, versions 2.2 and 4.1: `$Nodes` and `$Elements`. Other
//! sections are skipped, and so are points, lines and faces.

use super::data::Mesh;
use super::tetrahedra::{Numbered, lines, position, whole};

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

/// Reader of lines, which knows the number of the last one.
struct Reader<I> {
    lines: I,
    line: usize,
}

impl<'a, I: Iterator<Item = (usize, Vec<&'a str>)>> Reader<I> {
    /// Reads the next line. `within` is the section that must not end before it.
    fn next(&mut self, within: &str) -> Result<Vec<&'a str>, String> {
        let Some((line, words)) = self.lines.next() else {
            return Err(format!("the file ends within {within}"));
        };
        self.line = line;
        if words[0].starts_with('$') {
            return Err(format!(
                "line {line}: {within} ends early: more lines are announced"
            ));
        }
        Ok(words)
    }

    /// Reads the whole numbers of the next line, at least `least` of them.
    fn numbers(&mut self, within: &str, least: usize) -> Result<Vec<u64>, String> {
        let words = self.next(within)?;
        let numbers = whole(&words).map_err(|why| self.wrong(&why))?;
        if numbers.len() < least {
            return Err(self.wrong(&format!("{least} whole numbers are needed here")));
        }
        Ok(numbers)
    }

    fn wrong(&self, why: &str) -> String {
        format!("line {}: {why}", self.line)
    }
}

/// Reads the mesh of a file.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, String> {
    let mut reader = Reader {
        lines: lines(bytes),
        line: 0,
    };
    let mut numbered = Numbered::default();
    let mut version = None;
    while let Some((line, words)) = reader.lines.next() {
        reader.line = line;
        match (words[0], version) {
            ("$MeshFormat", _) => version = Some(format(&reader.next("$MeshFormat")?)?),
            ("$NOD" | "$ELM", None) => return Err(refused("1")),
            ("$Nodes" | "$ParametricNodes" | "$Elements", None) => return Err(NO_FORMAT.into()),
            ("$Nodes" | "$ParametricNodes", Some(Version::Two)) => {
                nodes_2(&mut reader, &mut numbered)?;
            }
            ("$Nodes", Some(Version::Four)) => nodes_4(&mut reader, &mut numbered)?,
            ("$Elements", Some(Version::Two)) => elements_2(&mut reader, &mut numbered)?,
            ("$Elements", Some(Version::Four)) => elements_4(&mut reader, &mut numbered)?,
            _ => {}
        }
    }
    if version.is_none() {
        return Err(NO_FORMAT.into());
    }
    numbered.mesh()
}

const NO_FORMAT: &str = "it is no Gmsh file: one begins with $MeshFormat";

#[derive(Clone, Copy)]
enum Version {
    Two,
    Four,
}

/// Reads the version in a line such as `4.1 0 8`.
fn format(words: &[&str]) -> Result<Version, String> {
    match words {
        ["2.2", "0", ..] => Ok(Version::Two),
        ["4.1", "0", ..] => Ok(Version::Four),
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

fn nodes_2<'a>(
    reader: &mut Reader<impl Iterator<Item = (usize, Vec<&'a str>)>>,
    numbered: &mut Numbered,
) -> Result<(), String> {
    let count = reader.numbers("$Nodes", 1)?[0];
    for _ in 0..count {
        let words = reader.next("$Nodes")?;
        let point = whole(&words[..1]).and_then(|number| Ok((number[0], position(&words[1..])?)));
        let added = point.and_then(|(number, at)| numbered.add_point(number, at));
        added.map_err(|why| reader.wrong(&why))?;
    }
    Ok(())
}

fn elements_2<'a>(
    reader: &mut Reader<impl Iterator<Item = (usize, Vec<&'a str>)>>,
    numbered: &mut Numbered,
) -> Result<(), String> {
    let count = reader.numbers("$Elements", 1)?[0];
    for _ in 0..count {
        let words = reader.next("$Elements")?;
        let head = words
            .get(..3)
            .ok_or_else(|| reader.wrong("3 whole numbers are needed here"))?;
        let head = whole(head).map_err(|why| reader.wrong(&why))?;
        if is_tetrahedron(head[1]).map_err(|why| reader.wrong(&why))? {
            // Tags, which may be negative, come before the corners.
            let first = usize::try_from(head[2].saturating_add(3)).unwrap_or(usize::MAX);
            let corners = whole(words.get(first..).unwrap_or_default());
            let corners = corners.map_err(|why| reader.wrong(&why))?;
            add(reader.line, head[0], &corners, numbered)?;
        }
    }
    Ok(())
}

fn nodes_4<'a>(
    reader: &mut Reader<impl Iterator<Item = (usize, Vec<&'a str>)>>,
    numbered: &mut Numbered,
) -> Result<(), String> {
    let blocks = reader.numbers("$Nodes", 2)?[0];
    for _ in 0..blocks {
        let count = reader.numbers("$Nodes", 4)?[3];
        let first = numbered.points.len();
        for _ in 0..count {
            let number = reader.numbers("$Nodes", 1)?[0];
            let added = numbered.add_point(number, [0.0; 3]);
            added.map_err(|why| reader.wrong(&why))?;
        }
        for k in first..numbered.points.len() {
            let words = reader.next("$Nodes")?;
            numbered.points[k].1 = position(&words).map_err(|why| reader.wrong(&why))?;
        }
    }
    Ok(())
}

fn elements_4<'a>(
    reader: &mut Reader<impl Iterator<Item = (usize, Vec<&'a str>)>>,
    numbered: &mut Numbered,
) -> Result<(), String> {
    let blocks = reader.numbers("$Elements", 2)?[0];
    for _ in 0..blocks {
        let head = reader.numbers("$Elements", 4)?;
        let is_tetrahedron = is_tetrahedron(head[2]).map_err(|why| reader.wrong(&why))?;
        for _ in 0..head[3] {
            let numbers = reader.numbers("$Elements", 1)?;
            if is_tetrahedron {
                add(reader.line, numbers[0], &numbers[1..], numbered)?;
            }
        }
    }
    Ok(())
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

/// Adds the tetrahedron with this number, which is on this line.
fn add(line: usize, number: u64, points: &[u64], numbered: &mut Numbered) -> Result<(), String> {
    let added = match *points {
        [a, b, c, d, ..] => numbered.add_tetrahedron(number, [a, b, c, d], line),
        _ => Err("a tetrahedron has four corners".into()),
    };
    added.map_err(|why| format!("line {line}: {why}"))
}
