//! Tetrahedra from a pair of `TetGen`'s text files: points (`.node`) and tetrahedra (`.ele`).

use super::data::Mesh;
use super::tetrahedra::{Numbered, lines, position, whole};

/// Reads the mesh of a pair of files. Of a tetrahedron with ten points, the first four are the
/// corners.
pub(super) fn read(node: &[u8], ele: &[u8]) -> Result<Mesh, String> {
    let mut numbered = Numbered::default();
    let head = "its number of points and their dimension, 3";
    each(node, ".node", head, 3, |line, number, words| {
        let added = position(words).and_then(|at| numbered.add_point(number, at));
        added.map_err(|why| format!("line {line} of the .node file: {why}"))
    })?;
    let head = "its number of tetrahedra and of the corners of each, 4 or 10";
    each(ele, ".ele", head, 4, |line, number, words| {
        let corners = words.get(..4).map(whole).transpose();
        let added = match corners.as_ref().map(Option::as_deref) {
            Ok(Some(&[a, b, c, d])) => numbered.add_tetrahedron(number, [a, b, c, d], line),
            Ok(_) => Err(format!("tetrahedron {number} has four corners")),
            Err(why) => Err(why.clone()),
        };
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
        return Err(format!(
            "the first line of the {name} file must give {head}"
        ));
    };
    for _ in 0..count {
        let Some((line, words)) = lines.next() else {
            return Err(format!(
                "the {name} file ends before all {count} of its lines"
            ));
        };
        let number = whole(&words[..1]).map_err(|why| format!("line {line}: {why}"))?[0];
        visit(line, number, &words[1..])?;
    }
    Ok(())
}
