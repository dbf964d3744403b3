//! Meshes from PLY files (Turk, *The PLY Polygon File Format*, 1994), text or binary: the elements
//! `vertex` and `face`. Other elements are skipped.

use super::data::{MAX_POINTS, MAX_TRIANGLES, Mesh};
use super::polygon::Cutter;
use crate::text::{Lines, words};

/// Line that ends the header.
const END: &[u8] = b"end_header";
/// Largest size of the header (bytes).
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
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// Property of an element: a number, or a list of them.
struct Property {
    name: String,
    kind: Kind,
    /// Type of the length of a list.
    length: Option<Kind>,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

/// Reads the mesh of a file.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, String> {
    let (form, elements, body) = head(bytes)?;
    if elements.iter().any(|element| element.name == "tristrips") {
        return Err("it has triangle strips: save it with faces".into());
    }
    let mut numbers = Numbers { form, rest: body };
    let mut faces = Faces::default();
    for element in elements
        .iter()
        .filter(|element| !element.properties.is_empty())
    {
        for k in 0..element.count {
            let read = faces.add(element, &mut numbers);
            numbers.end_line();
            read.map_err(|why| format!("{} {k}, counted from 0: {why}", element.name))?;
        }
    }
    faces.cut()
}

/// Reads the header: the encoding of the numbers, the elements, and the bytes after the header.
fn head(bytes: &[u8]) -> Result<(Form, Vec<Element>, &[u8]), String> {
    let no_ply = "it is no PLY file: one begins with the lines `ply` and `format`";
    let first = &bytes[..bytes.len().min(MAX_HEAD)];
    let end = first.windows(END.len()).position(|window| window == END);
    if !bytes.starts_with(b"ply") {
        return Err(no_ply.into());
    }
    let end = end.ok_or_else(|| {
        let most = MAX_HEAD >> 20;
        format!("its head does not end: the line `end_header` is missing in the first {most} MiB")
    })?;
    let after = &bytes[end + END.len()..];
    // One end of a line only: the next byte may belong to a number.
    let body = after.strip_prefix(b"\r\n").or(after.strip_prefix(b"\n"));
    let body = body.or(after.strip_prefix(b"\r")).unwrap_or(after);
    let (mut form, mut elements): (_, Vec<Element>) = (None, vec![]);
    for (line, statement) in Lines::new(&bytes[..end]) {
        let words: Vec<_> = words(statement)
            .take(MAX_WORDS)
            .map(|word| String::from_utf8_lossy(word).into_owned())
            .collect();
        let words: Vec<_> = words.iter().map(String::as_str).collect();
        let wrong = |why: &str| format!("line {line}: {why}");
        match words[..] {
            ["format", "ascii", ..] => form = Some(Form::Text),
            ["format", "binary_little_endian", ..] => form = Some(Form::Little),
            ["format", "binary_big_endian", ..] => form = Some(Form::Big),
            ["element", name, count] => elements.push(Element {
                name: name.into(),
                count: count
                    .parse()
                    .map_err(|_| wrong("a count is a whole number"))?,
                properties: vec![],
            }),
            ["property", ref of @ ..] => {
                let property = match *of {
                    ["list", length, kind, name] => {
                        kind_of(length)
                            .zip(kind_of(kind))
                            .map(|(length, kind)| Property {
                                name: name.into(),
                                kind,
                                length: Some(length),
                            })
                    }
                    [kind, name] => kind_of(kind).map(|kind| Property {
                        name: name.into(),
                        kind,
                        length: None,
                    }),
                    _ => None,
                };
                let why = wrong("there is no such type of numbers");
                let element = elements.last_mut().ok_or(wrong("it is of no element"))?;
                element.properties.push(property.ok_or(why)?);
            }
            _ => {}
        }
    }
    Ok((form.ok_or(no_ply)?, elements, body))
}

fn kind_of(name: &str) -> Option<Kind> {
    Some(match name {
        "char" | "int8" => Kind::I8,
        "uchar" | "uint8" => Kind::U8,
        "short" | "int16" => Kind::I16,
        "ushort" | "uint16" => Kind::U16,
        "int" | "int32" => Kind::I32,
        "uint" | "uint32" => Kind::U32,
        "float" | "float32" => Kind::F32,
        "double" | "float64" => Kind::F64,
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
    fn next(&mut self, kind: Kind) -> Result<f64, String> {
        if self.form == Form::Text {
            let rest = self.rest.trim_ascii_start();
            let end = rest.iter().position(u8::is_ascii_whitespace);
            let (word, rest) = rest.split_at(end.unwrap_or(rest.len()));
            self.rest = rest;
            let number = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
            return number.ok_or_else(|| match word {
                [] => "the file ends within it".into(),
                _ => format!(
                    "`{}` is no number",
                    String::from_utf8_lossy(&word[..word.len().min(40)])
                ),
            });
        }
        let size = match kind {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::F64 => 8,
        };
        let (number, rest) = self
            .rest
            .split_at_checked(size)
            .ok_or("the file ends within it")?;
        self.rest = rest;
        // In little-endian order, padded with zeros.
        let mut bytes = [0; 8];
        bytes[..size].copy_from_slice(number);
        if self.form == Form::Big {
            bytes[..size].reverse();
        }
        let whole = u64::from_le_bytes(bytes);
        Ok(match kind {
            Kind::I8 => f64::from(whole as i8),
            Kind::I16 => f64::from(whole as i16),
            Kind::I32 => f64::from(whole as i32),
            Kind::U8 | Kind::U16 | Kind::U32 => whole as f64,
            Kind::F32 => f64::from(f32::from_bits(whole as u32)),
            Kind::F64 => f64::from_bits(whole),
        })
    }
}

/// Points and faces that were read so far.
#[derive(Default)]
struct Faces {
    mesh: Mesh,
    corners: Vec<u32>,
    /// End of the corners of each face.
    ends: Vec<u32>,
    triangles: usize,
}

impl Faces {
    /// Reads and adds the next element.
    fn add(&mut self, element: &Element, numbers: &mut Numbers) -> Result<(), String> {
        let (is_vertex, is_face) = (element.name == "vertex", element.name == "face");
        let mut point = [None; 3];
        for Property { name, kind, length } in &element.properties {
            let Some(length) = length else {
                let number = numbers.next(*kind)?;
                let axis = ["x", "y", "z"].iter().position(|axis| axis == name);
                if let Some(axis) = axis.filter(|_| is_vertex) {
                    point[axis] = Some(number).filter(|x| x.is_finite());
                }
                continue;
            };
            let length = numbers.next(*length)?;
            if !(length >= 0.0 && length.fract() == 0.0) {
                return Err(format!("a list of {length} numbers is none"));
            }
            let is_kept = is_face && (name == "vertex_indices" || name == "vertex_index");
            let first = self.corners.len();
            for _ in 0..length as u64 {
                let number = numbers.next(*kind)?;
                if !is_kept {
                    continue;
                }
                if !(0.0..MAX_POINTS as f64).contains(&number) {
                    return Err(format!("there is no point {number}"));
                }
                self.corners.push(number as u32);
                self.triangles += usize::from(self.corners.len() - first > 2);
                if self.triangles > MAX_TRIANGLES {
                    return Err(format!("there are more than {MAX_TRIANGLES} triangles"));
                }
            }
            match self.corners.len() - first {
                0..=2 => self.corners.truncate(first),
                _ => self.ends.push(self.corners.len() as u32),
            }
        }
        if is_vertex {
            if self.mesh.positions.len() == MAX_POINTS {
                return Err(format!("there are more than {MAX_POINTS} points"));
            }
            let [Some(x), Some(y), Some(z)] = point else {
                return Err("it has not three finite coordinates, x, y and z".into());
            };
            self.mesh.positions.push([x, y, z]);
        }
        Ok(())
    }

    /// Cuts all faces into the triangles of a mesh.
    fn cut(mut self) -> Result<Mesh, String> {
        let count = self.mesh.positions.len();
        if let Some(k) = self.corners.iter().position(|i| *i as usize >= count) {
            let face = self.ends.partition_point(|end| *end as usize <= k);
            return Err(format!(
                "face {face}, counted from 0, has corner {}, but there are {count} points",
                self.corners[k]
            ));
        }
        let (mut cutter, mut first) = (Cutter::default(), 0);
        let Mesh {
            positions,
            triangles,
            ..
        } = &mut self.mesh;
        for (k, end) in self.ends.iter().enumerate() {
            let face = &self.corners[first..*end as usize];
            cutter.cut(face, positions, triangles).ok_or_else(|| {
                let count = face.len();
                format!("faces that are not convex have too many corners, {count} in face {k}, counted from 0: split them")
            })?;
            first = *end as usize;
        }
        Ok(self.mesh)
    }
}
