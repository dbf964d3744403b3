//! Meshes from Wavefront OBJ files: points (`v`) and faces (`f`). All else is passed over.

use super::{MAX_POINTS, MAX_TRIANGLES, Mesh};

/// The mesh in an OBJ file. A face of more than three corners is a fan of triangles around its
/// first corner.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, String> {
    let mut mesh = Mesh::default();
    // The largest corner that is named, counted from 0, and its line.
    let mut last = (0, 0);
    for (k, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let mut words = line
            .split(u8::is_ascii_whitespace)
            .filter(|w| !w.is_empty());
        let wrong = |why: String| format!("line {}: {why}", k + 1);
        match words.next() {
            Some(b"v") => {
                if mesh.positions.len() == MAX_POINTS {
                    return Err(wrong(format!("there are more than {MAX_POINTS} points")));
                }
                let mut coordinate = || text(words.next()?)?.parse::<f32>().ok();
                let point = [coordinate(), coordinate(), coordinate()];
                let [Some(x), Some(y), Some(z)] = point.map(|x| x.filter(|x| x.is_finite())) else {
                    return Err(wrong("a point has three numbers, as in `v 0 0.5 1`".into()));
                };
                mesh.positions.push([x, y, z].map(f64::from));
            }
            Some(b"f") => {
                let count = mesh.positions.len();
                let mut corners = words.map(|word| {
                    let corner = corner(word, count).ok_or_else(|| {
                        wrong(format!(
                            "`{}` is no corner: a corner is the number of a point, counted from 1, or from -1 \
                             backwards, among the {count} points before it",
                            String::from_utf8_lossy(&word[..word.len().min(40)])
                        ))
                    })?;
                    last = last.max((corner, k + 1));
                    Ok::<u32, String>(corner)
                });
                let (Some(a), Some(b)) = (corners.next(), corners.next()) else {
                    continue;
                };
                let (a, mut b) = (a?, b?);
                for c in corners {
                    let c = c?;
                    if mesh.triangles.len() == MAX_TRIANGLES {
                        return Err(wrong(format!(
                            "there are more than {MAX_TRIANGLES} triangles"
                        )));
                    }
                    mesh.triangles.push([a, b, c]);
                    b = c;
                }
            }
            _ => {}
        }
    }
    let (corner, line) = last;
    if line > 0 && corner as usize >= mesh.positions.len() {
        return Err(format!(
            "line {line}: a face has corner {}, but there are {} points",
            u64::from(corner) + 1,
            mesh.positions.len()
        ));
    }
    Ok(mesh)
}

/// The point of a corner such as `3`, `3/1`, `3//2` or `-1/2/3`, counted from 0. A negative number
/// counts back from the last of `count` points.
fn corner(word: &[u8], count: usize) -> Option<u32> {
    let number: i64 = text(word.split(|b| *b == b'/').next()?)?.parse().ok()?;
    let from = if number < 0 { count as i64 } else { -1 };
    u32::try_from(from.checked_add(number)?).ok()
}

fn text(word: &[u8]) -> Option<&str> {
    std::str::from_utf8(word).ok()
}
