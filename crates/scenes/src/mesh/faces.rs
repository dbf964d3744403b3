//! Meshes from files of faces: Wavefront OBJ, with points (`v`) and faces (`f`); STL, binary or
//! text, with triangles, each with its corners; and PLY (Turk, *The PLY Polygon File Format*,
//! 1994), text or binary, with the elements `vertex` and `face`. All else in them is skipped.

use std::collections::HashMap;

use super::data::{MAX_POINTS, Mesh, check_triangles};
use super::polygon::Faces;
use crate::description::Triple;
use crate::text::{Lines, brief, number, unmarked, words};

/// Reads the mesh of an OBJ file.
pub(super) fn obj(text: &[u8]) -> Result<Mesh, String> {
    let (mut mesh, mut faces, mut lines) = (Mesh::default(), Faces::default(), Lines::new(text));
    // The line of each face, and the largest number of a corner, with its line.
    let (mut lines_of_faces, mut last) = (vec![], (0, 0));
    // The name of a folder or a material may end in a backslash.
    let is_read = |line: &[u8]| matches!(words(line).next(), Some(b"v" | b"f"));
    while let Some((line, statement)) = lines.statement(is_read) {
        let wrong = |why: String| format!("line {line}: {why}");
        let mut words = words(statement);
        match words.next() {
            Some(b"v") => {
                let point = point(words).map_err(wrong)?;
                mesh.add_point(point).map_err(wrong)?;
            }
            Some(b"f") => {
                for word in words {
                    let corner = corner(word, mesh.positions.len()).map_err(wrong)?;
                    last = last.max((corner, line));
                    faces.add_corner(corner).map_err(wrong)?;
                }
                if faces.end() {
                    lines_of_faces.push(line);
                }
            }
            _ => {}
        }
    }
    let ((corner, line), count) = (last, mesh.positions.len());
    if line > 0 && corner as usize >= count {
        let corner = u64::from(corner) + 1;
        refuse!("line {line}: a face has corner {corner}, but there are {count} points");
    }
    faces.cut(&mut mesh, |k, count| {
        let line = lines_of_faces[k];
        format!("line {line}: faces that are not convex have too many corners, {count} in this one")
    })?;
    Ok(mesh)
}

/// Reads the coordinates of a point of an OBJ file.
fn point<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Result<Triple, String> {
    let mut point = [0.0; 3];
    for x in &mut point {
        let of_three = "a point has three finite numbers, as in `v 0 0.5 1`";
        let word = words.next().ok_or(of_three)?;
        let finite = number(word).filter(|x: &f64| x.is_finite());
        *x = finite.ok_or_else(|| format!("`{}` is none: {of_three}", brief(word)))?;
    }
    Ok(point)
}

/// Reads the point of a corner such as `3`, `3/1`, `3//2` or `-1/2/3`, counted from 0. A negative
/// number counts back from the last of `count` points.
fn corner(word: &[u8], count: usize) -> Result<u32, String> {
    let given = word.split(|b| *b == b'/').next().and_then(number::<i64>);
    let corner = given.and_then(|number| {
        let from = if number < 0 { count as i64 } else { -1 };
        u32::try_from(from.checked_add(number)?).ok()
    });
    corner.ok_or_else(|| {
        format!(
            "`{}` is no corner: a corner is the number of a point, counted from 1, or from -1 \
             backwards, among the {count} points before it",
            brief(word)
        )
    })
}

/// Lengths of the header of a binary STL file and of a triangle (bytes).
const STL_HEAD: usize = 84;
const STL_TRIANGLE: usize = 50;

/// Mesh that was read so far, in which corners with the same bits are one point.
#[derive(Default)]
struct Corners {
    mesh: Mesh,
    known: HashMap<[u64; 3], u32>,
}

impl Corners {
    /// Returns the point at a place, and adds it if it is new.
    fn point(&mut self, at: Triple) -> Result<u32, String> {
        refuse!(if !at.iter().all(|x| x.is_finite()) => "a corner has three finite coordinates");
        let next = self.mesh.positions.len() as u32;
        let point = *self.known.entry(at.map(f64::to_bits)).or_insert(next);
        if point == next {
            self.mesh.add_point(at)?;
        }
        Ok(point)
    }

    fn triangle(&mut self, corners: [Triple; 3]) -> Result<(), String> {
        check_triangles(self.mesh.triangles.len() + 1)?;
        let [a, b, c] = corners.map(|at| self.point(at));
        self.mesh.triangles.push([a?, b?, c?]);
        Ok(())
    }
}

/// Reads the mesh of an STL file. A binary file may begin like text, but it has the length that it
/// gives.
pub(super) fn stl(bytes: &[u8]) -> Result<Mesh, String> {
    let count = bytes.get(STL_HEAD - 4..STL_HEAD);
    let count = count.and_then(|n| Some(u32::from_le_bytes(n.try_into().ok()?) as usize));
    let length = count.and_then(|count| count.checked_mul(STL_TRIANGLE)?.checked_add(STL_HEAD));
    let is_text = |bytes: &[u8]| {
        let begin = bytes.trim_ascii_start().get(..5);
        begin.is_some_and(|begin| begin.eq_ignore_ascii_case(b"solid"))
    };
    let fits = length.filter(|length| *length <= bytes.len());
    match (unmarked(bytes), fits) {
        (_, Some(length)) if length == bytes.len() => stl_triangles(&bytes[STL_HEAD..]),
        (Ok(text), fits) if is_text(text) => match (stl_lines(text), fits) {
            // Some binary files begin like text, and have more bytes after their triangles.
            (Ok(mesh), Some(length)) if mesh.triangles.is_empty() => {
                stl_triangles(&bytes[STL_HEAD..length])
            }
            (read, _) => read,
        },
        (_, Some(length)) => stl_triangles(&bytes[STL_HEAD..length]),
        (Err(why), None) => Err(why),
        (Ok(_), None) => Err("it is no STL file, or cut short: one begins with `solid`, or has 84 bytes and 50 more for each triangle".into()),
    }
}

fn stl_triangles(triangles: &[u8]) -> Result<Mesh, String> {
    let mut corners = Corners::default();
    for (k, triangle) in triangles.chunks_exact(STL_TRIANGLE).enumerate() {
        // A normal comes first.
        let (numbers, _) = triangle[12..48].as_chunks::<4>();
        let (points, _) = numbers.as_chunks::<3>();
        let places = [0, 1, 2].map(|k| points[k].map(|x| f64::from(f32::from_le_bytes(x))));
        let added = corners.triangle(places);
        added.map_err(|why| format!("triangle {k}, counted from 0: {why}"))?;
    }
    Ok(corners.mesh)
}

fn stl_lines(text: &[u8]) -> Result<Mesh, String> {
    let (mut corners, mut loop_of, mut is_in_facet) = (Corners::default(), vec![], false);
    for (line, statement) in Lines::new(text) {
        let wrong = |why: String| format!("line {line}: {why}");
        let of_three = || wrong("a triangle has three corners".into());
        let mut words = words(statement);
        let key = words.next().unwrap_or_default().to_ascii_lowercase();
        match &key[..] {
            b"facet" => is_in_facet = true,
            b"endfacet" => is_in_facet = false,
            b"vertex" => {
                let mut coordinate = || words.next().and_then(number::<f64>);
                let [Some(x), Some(y), Some(z)] = [coordinate(), coordinate(), coordinate()] else {
                    let why = "a corner has three numbers, as in `vertex 0 0.5 1`";
                    return Err(wrong(why.into()));
                };
                loop_of.push([x, y, z]);
            }
            b"endloop" => {
                let places = loop_of[..].try_into().map_err(|_| of_three())?;
                corners.triangle(places).map_err(wrong)?;
                loop_of.clear();
            }
            _ => {}
        }
        if loop_of.len() > 3 {
            return Err(of_three());
        }
    }
    refuse!(if is_in_facet => "the file ends within a facet: it is cut short");
    Ok(corners.mesh)
}

/// Line that ends the header of a PLY file.
const PLY_END: &[u8] = b"end_header";
/// Largest size of that header (bytes).
const MAX_HEAD: usize = 1 << 20;
/// Most words of a line of the header that mean anything.
const MAX_WORDS: usize = 6;

/// Encoding of the numbers.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Text,
    Little,
    Big,
}

/// Type of a number.
#[derive(Clone, Copy)]
enum Kind {
    Signed,
    Unsigned,
    Float,
}

/// Type of a number, and its size (bytes).
type Coding = (Kind, usize);

/// Property of an element: a number, or a list of them.
struct Property {
    name: String,
    kind: Coding,
    /// Type of the length of a list.
    length: Option<Coding>,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

/// Reads the mesh of a PLY file.
pub(super) fn ply(bytes: &[u8]) -> Result<Mesh, String> {
    let (form, elements, rest) = ply_head(bytes)?;
    refuse!(if elements.iter().any(|element| element.name == "tristrips") =>
        "it has triangle strips: save it with faces");
    let (mut numbers, mut mesh, mut faces) =
        (Numbers { form, rest }, Mesh::default(), Faces::default());
    for element in elements.iter().filter(|it| !it.properties.is_empty()) {
        for k in 0..element.count {
            let read = numbers.element(element, &mut mesh, &mut faces);
            numbers.end_line();
            read.map_err(|why| format!("{} {k}, counted from 0: {why}", element.name))?;
        }
    }
    let count = mesh.positions.len();
    if let Some((face, corner)) = faces.beyond(count) {
        refuse!("face {face}, counted from 0, has corner {corner}, but there are {count} points");
    }
    faces.cut(&mut mesh, |k, count| {
        format!(
            "faces that are not convex have too many corners, {count} in face {k}, counted from 0"
        )
    })?;
    Ok(mesh)
}

/// Reads the header: the encoding of the numbers, the elements, and the bytes after the header.
fn ply_head(bytes: &[u8]) -> Result<(Form, Vec<Element>, &[u8]), String> {
    let no_ply = "it is no PLY file: one begins with the lines `ply` and `format`";
    let first = &bytes[..bytes.len().min(MAX_HEAD)];
    let mut windows = first.windows(PLY_END.len());
    let end = windows.position(|window| window == PLY_END);
    if !bytes.starts_with(b"ply") {
        return Err(no_ply.into());
    }
    let end = end.ok_or_else(|| {
        let most = MAX_HEAD >> 20;
        format!("its head does not end: the line `end_header` is missing in the first {most} MiB")
    })?;
    let after = &bytes[end + PLY_END.len()..];
    // One end of a line only: the next byte may belong to a number.
    let body = after.strip_prefix(b"\r\n").or(after.strip_prefix(b"\n"));
    let body = body.or(after.strip_prefix(b"\r")).unwrap_or(after);
    let (mut form, mut elements): (_, Vec<Element>) = (None, vec![]);
    for (line, statement) in Lines::new(&bytes[..end]) {
        let words = words(statement).take(MAX_WORDS).map(String::from_utf8_lossy);
        let words: Vec<_> = words.collect();
        let words: Vec<_> = words.iter().map(|word| &**word).collect();
        let wrong = |why: &str| format!("line {line}: {why}");
        match words[..] {
            ["format", "ascii", ..] => form = Some(Form::Text),
            ["format", "binary_little_endian", ..] => form = Some(Form::Little),
            ["format", "binary_big_endian", ..] => form = Some(Form::Big),
            ["element", name, count] => elements.push(Element {
                name: name.into(),
                count: count.parse().map_err(|_| wrong("a count is a whole number"))?,
                properties: vec![],
            }),
            ["property", ref of @ ..] => {
                let (length, kind, name) = match *of {
                    ["list", length, kind, name] => (Some(kind_of(length)), kind_of(kind), name),
                    [kind, name] => (None, kind_of(kind), name),
                    _ => (None, None, ""),
                };
                let element = elements.last_mut().ok_or(wrong("it is of no element"))?;
                let (Some(kind), false) = (kind, matches!(length, Some(None))) else {
                    return Err(wrong("there is no such type of numbers"));
                };
                let (name, length) = (name.into(), length.flatten());
                element.properties.push(Property { name, kind, length });
            }
            _ => {}
        }
    }
    Ok((form.ok_or(no_ply)?, elements, body))
}

fn kind_of(name: &str) -> Option<Coding> {
    Some(match name {
        "char" | "int8" => (Kind::Signed, 1),
        "uchar" | "uint8" => (Kind::Unsigned, 1),
        "short" | "int16" => (Kind::Signed, 2),
        "ushort" | "uint16" => (Kind::Unsigned, 2),
        "int" | "int32" => (Kind::Signed, 4),
        "uint" | "uint32" => (Kind::Unsigned, 4),
        "float" | "float32" => (Kind::Float, 4),
        "double" | "float64" => (Kind::Float, 8),
        _ => return None,
    })
}

/// Numbers that are still to be read.
struct Numbers<'a> {
    form: Form,
    rest: &'a [u8],
}

impl Numbers<'_> {
    /// Skips the rest of a line of text.
    fn end_line(&mut self) {
        if self.form == Form::Text {
            let is_end = |b: &u8| matches!(b, b'\n' | b'\r');
            let end = self.rest.iter().position(is_end);
            self.rest = &self.rest[end.unwrap_or(self.rest.len())..];
        }
    }

    /// Reads the next number, of this type.
    fn next(&mut self, (kind, size): Coding) -> Result<f64, String> {
        if self.form == Form::Text {
            let rest = self.rest.trim_ascii_start();
            let end = rest.iter().position(u8::is_ascii_whitespace);
            let (word, rest) = rest.split_at(end.unwrap_or(rest.len()));
            self.rest = rest;
            return number(word).ok_or_else(|| match word {
                [] => "the file ends within it".into(),
                _ => format!("`{}` is no number", brief(word)),
            });
        }
        let split = self.rest.split_at_checked(size);
        let (number, rest) = split.ok_or("the file ends within it")?;
        self.rest = rest;
        // In little-endian order, padded with zeros.
        let mut bytes = [0; 8];
        bytes[..size].copy_from_slice(number);
        if self.form == Form::Big {
            bytes[..size].reverse();
        }
        let whole = u64::from_le_bytes(bytes);
        Ok(match (kind, size) {
            (Kind::Float, 8) => f64::from_bits(whole),
            (Kind::Float, _) => f64::from(f32::from_bits(whole as u32)),
            (Kind::Unsigned, _) => whole as f64,
            (Kind::Signed, 1) => f64::from(whole as i8),
            (Kind::Signed, 2) => f64::from(whole as i16),
            (Kind::Signed, _) => f64::from(whole as i32),
        })
    }

    /// Reads an element, and adds it if it is a point or a face.
    fn element(&mut self, it: &Element, mesh: &mut Mesh, faces: &mut Faces) -> Result<(), String> {
        let (is_vertex, is_face) = (it.name == "vertex", it.name == "face");
        let mut point = [None; 3];
        for Property { name, kind, length } in &it.properties {
            let Some(length) = length else {
                let number = self.next(*kind)?;
                let axis = ["x", "y", "z"].iter().position(|axis| axis == name);
                if let Some(axis) = axis.filter(|_| is_vertex) {
                    point[axis] = Some(number).filter(|x| x.is_finite());
                }
                continue;
            };
            let length = self.next(*length)?;
            refuse!(if !(length >= 0.0 && length.fract() == 0.0) =>
                "a list of {length} numbers is none");
            let is_kept = is_face && (name == "vertex_indices" || name == "vertex_index");
            for _ in 0..length as u64 {
                let number = self.next(*kind)?;
                refuse!(if is_kept && !(0.0..MAX_POINTS as f64).contains(&number) =>
                    "there is no point {number}");
                if is_kept {
                    faces.add_corner(number as u32)?;
                }
            }
            faces.end();
        }
        let [Some(x), Some(y), Some(z)] = point else {
            let why = "it has not three finite coordinates, x, y and z";
            return if is_vertex { Err(why.into()) } else { Ok(()) };
        };
        mesh.add_point([x, y, z])
    }
}
