//! STL and PLY, in all their forms.

use std::fmt::Write;

use a3_scenes::Mesh;

use crate::{area, counts, refused, vector_area};

/// Sides of a cube, by their corners.
const SIDES: [[usize; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn corner(k: usize) -> [f32; 3] {
    [0, 1, 2].map(|axis| (k >> axis & 1) as f32)
}

/// Lists the triangles of the cube.
fn triangles() -> Vec<[[f32; 3]; 3]> {
    let halves = SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    halves.map(|t| t.map(corner)).collect()
}

fn is_cube(mesh: &Mesh) {
    assert_eq!(counts(mesh), [8, 12]);
    assert!((area(mesh) - 6.0).abs() < 1e-12 && vector_area(mesh) == [0.0; 3]);
}

fn binary_stl(head: &[u8]) -> Vec<u8> {
    let mut bytes = head.to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles().len() as u32).to_le_bytes());
    for triangle in triangles() {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flatten().flat_map(|x| x.to_le_bytes()));
        bytes.extend([7, 0]);
    }
    bytes
}

#[test]
fn stl_is_text_or_binary() {
    let mut text = "solid a cube # not a comment\n".to_owned();
    for triangle in triangles() {
        text += " facet normal 0 0 0\n  outer loop\n";
        for [x, y, z] in triangle {
            writeln!(text, "   vertex {x:e} {y} {z}").unwrap();
        }
        text += "  endloop\n endfacet\n";
    }
    text += "endsolid a cube\n";
    for text in [text.clone(), text.replace('\n', "\r\n"), format!("\u{feff}{text}")] {
        is_cube(&Mesh::from_stl(text.as_bytes()).unwrap());
    }
    let binary = binary_stl(b"made by hand");
    is_cube(&Mesh::from_stl(&binary).unwrap());
    // Some binary files begin like text, and some have more at their end.
    is_cube(&Mesh::from_stl(&binary_stl(b"solid as a rock")).unwrap());
    is_cube(&Mesh::from_stl(&[&binary[..], b"colours"].concat()).unwrap());
    let said = |bytes: &[u8]| Mesh::from_stl(bytes).unwrap_err();
    assert!(said(&binary[..binary.len() - 1]).contains("cut short"));
    assert!(said(b"").contains("no STL"));
    let more = text.replacen("0 0 0\n  outer", "0 0 0\n vertex 1 1 1\n  outer", 1);
    assert!(said(more.as_bytes()).starts_with("line 7: a triangle has three corners"));
    assert!(said(b"solid\nvertex 1 2\n").starts_with("line 2: a corner has three numbers"));
    let mut infinite = binary;
    infinite[84 + 50 + 12..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert!(said(&infinite).starts_with("triangle 1, counted from 0: a corner has three finite"));
}

/// Returns the header of a cube in PLY.
fn head(format: &str, kind: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment by hand\nelement vertex 8\nproperty uchar red\n\
         property {kind} x\nproperty {kind} y\nproperty {kind} z\nelement edge 1\nproperty int vertex1\n\
         element face 6\nproperty list uchar short vertex_indices\nproperty float quality\nend_header\n"
    )
}

/// Changes of a cube in PLY, with the messages.
const WRONG_PLY: &str = r"
4 0 2 3 1
    4 0 2 3 8 => face 0, counted from 0, has corner 8, but there are 8 points
    4 0 2 3 -1 => face 0, counted from 0: there is no point -1
    x 0 2 3 1 => face 0, counted from 0: `x` is no number
property uchar red
    property word red => line 5: there is no such type
vertex 8
    vertex x => line 4: a count is a whole number
property float x
    property float u => vertex 0, counted from 0: it has not three
ply\n
    plx\n => it is no PLY file
element edge
    element tristrips => it has triangle strips
vertex 8
    vertex 4000000000 => vertex
";

#[test]
fn ply_is_text_or_binary_of_either_order() {
    let mut text = head("ascii", "float");
    for k in 0..8 {
        let [x, y, z] = corner(k);
        writeln!(text, "255 {x} {y} {z}").unwrap();
    }
    text += "3\n";
    for [a, b, c, d] in SIDES {
        writeln!(text, "4 {a} {b} {c} {d} 0.5").unwrap();
    }
    for end in ["\n", "\r\n", "\r"] {
        let text = text.replace('\n', end);
        is_cube(&Mesh::from_ply(text.as_bytes()).unwrap());
    }
    for is_big in [false, true] {
        let ordered = |mut bytes: Vec<u8>| {
            if is_big {
                bytes.reverse();
            }
            bytes
        };
        let format = ["binary_little_endian", "binary_big_endian"][usize::from(is_big)];
        let mut bytes = head(format, "double").into_bytes();
        for k in 0..8 {
            bytes.push(255);
            let place = corner(k).map(|x| ordered(f64::from(x).to_le_bytes().to_vec()));
            bytes.extend(place.concat());
        }
        bytes.extend([0, 0, 0, 0]);
        for side in SIDES {
            bytes.push(4);
            let corners = side.map(|k| ordered((k as u16).to_le_bytes().to_vec()));
            bytes.extend(corners.concat());
            bytes.extend([0, 0, 0, 63]);
        }
        is_cube(&Mesh::from_ply(&bytes).unwrap());
        let why = Mesh::from_ply(&bytes[..bytes.len() - 1]).unwrap_err();
        assert_eq!(why, "face 5, counted from 0: the file ends within it");
    }
    refused(&text, WRONG_PLY, |text| Mesh::from_ply(text.as_bytes()).unwrap_err());
}
