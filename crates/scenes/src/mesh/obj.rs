//! Meshes from Wavefront OBJ files: points (`v`) and faces (`f`). Other statements are skipped.

use super::data::{MAX_POINTS, MAX_TRIANGLES, Mesh};
use super::polygon::Cutter;
use crate::description::Triple;
use crate::text::{Lines, brief, words};

/// Faces of a file, as numbers of points.
#[derive(Default)]
struct Faces {
    corners: Vec<u32>,
    /// End of the corners of each face, and its line.
    ends: Vec<(u32, u32)>,
    /// Number of triangles that the faces make.
    triangles: usize,
    /// Largest number of a corner, and its line.
    last: (u32, usize),
}

/// Reads the mesh of a file.
pub(super) fn read(text: &[u8]) -> Result<Mesh, String> {
    let mut mesh = Mesh::default();
    let mut faces = Faces::default();
    let mut lines = Lines::new(text);
    // The name of a folder or a material may end in a backslash.
    let is_read = |line: &[u8]| matches!(words(line).next(), Some(b"v" | b"f"));
    while let Some((line, statement)) = lines.statement(is_read) {
        let wrong = |why: String| format!("line {line}: {why}");
        let mut words = words(statement);
        match words.next() {
            Some(b"v") => {
                if mesh.positions.len() == MAX_POINTS {
                    return Err(wrong(format!("there are more than {MAX_POINTS} points")));
                }
                mesh.positions.push(point(words).map_err(wrong)?);
            }
            Some(b"f") => faces
                .add(words, mesh.positions.len(), line)
                .map_err(wrong)?,
            _ => {}
        }
    }
    faces.cut(&mut mesh)?;
    Ok(mesh)
}

/// Reads the coordinates of a point.
fn point<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Result<Triple, String> {
    let mut point = [0.0; 3];
    for x in &mut point {
        let of_three = "a point has three finite numbers, as in `v 0 0.5 1`";
        let word = words.next().ok_or(of_three)?;
        let number = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        *x = number
            .filter(|x: &f64| x.is_finite())
            .ok_or_else(|| format!("`{}` is none: {of_three}", brief(word)))?;
    }
    Ok(point)
}

impl Faces {
    /// Adds the face of a line from its corners, after `count` points.
    fn add<'a>(
        &mut self,
        words: impl Iterator<Item = &'a [u8]>,
        count: usize,
        line: usize,
    ) -> Result<(), String> {
        let first = self.corners.len();
        for word in words {
            let corner = corner(word, count).ok_or_else(|| {
                format!(
                    "`{}` is no corner: a corner is the number of a point, counted from 1, or from -1 \
                     backwards, among the {count} points before it",
                    brief(word)
                )
            })?;
            self.last = self.last.max((corner, line));
            self.corners.push(corner);
            if self.corners.len() - first > 2 {
                self.triangles += 1;
            }
            if self.triangles > MAX_TRIANGLES {
                return Err(format!("there are more than {MAX_TRIANGLES} triangles"));
            }
        }
        if self.corners.len() - first < 3 {
            self.corners.truncate(first);
        } else {
            self.ends.push((self.corners.len() as u32, line as u32));
        }
        Ok(())
    }

    /// Cuts all faces into the triangles of the mesh.
    fn cut(self, mesh: &mut Mesh) -> Result<(), String> {
        let (corner, line) = self.last;
        let count = mesh.positions.len();
        if line > 0 && corner as usize >= count {
            let corner = u64::from(corner) + 1;
            return Err(format!(
                "line {line}: a face has corner {corner}, but there are {count} points"
            ));
        }
        let (mut cutter, mut first) = (Cutter::default(), 0);
        mesh.triangles.reserve_exact(self.triangles);
        for (end, line) in self.ends {
            let face = &self.corners[first..end as usize];
            let cut = cutter.cut(face, &mesh.positions, &mut mesh.triangles);
            cut.ok_or_else(|| {
                let count = face.len();
                format!(
                    "line {line}: faces that are not convex have too many corners, {count} in this one: split them"
                )
            })?;
            first = end as usize;
        }
        Ok(())
    }
}

/// Reads the point of a corner such as `3`, `3/1`, `3//2` or `-1/2/3`, counted from 0. A negative
/// number counts back from the last of `count` points.
fn corner(word: &[u8], count: usize) -> Option<u32> {
    let number = word.split(|b| *b == b'/').next()?;
    let number: i64 = str::from_utf8(number).ok()?.parse().ok()?;
    let from = if number < 0 { count as i64 } else { -1 };
    u32::try_from(from.checked_add(number)?).ok()
}
