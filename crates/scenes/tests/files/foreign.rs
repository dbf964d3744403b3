//! Files of other programs that were once read wrongly, or refused without the cause.

use a3_scenes::Mesh;

use crate::{area, begins, counts, obj, random};

/// Corners that are at one place in the plane of a face, but not in space, keep their triangles.
#[test]
fn bent_faces_keep_all_triangles() {
    let mesh = obj("v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 1 0\nf 1 2 3 4\n");
    assert_eq!(counts(&mesh), [4, 2]);
    assert!(area(&mesh) > 1.0, "{}", area(&mesh));
    // All bent faces with four corners on a 3 x 3 x 3 grid: two triangles each.
    let place = |k: usize| [k % 3, k / 3 % 3, k / 9];
    for k in 0..27 * 27 {
        let corners = [[0, 0, 0], [2, 0, 0], place(k % 27), place(k / 27)];
        let is_apart = (0..4).all(|a| (0..a).all(|b| corners[a] != corners[b]));
        let lines = corners.map(|[x, y, z]| format!("v {x} {y} {z}\n"));
        let text = lines.concat();
        let Ok(mesh) = Mesh::from_obj(format!("{text}f 1 2 3 4\n").as_bytes()) else {
            continue;
        };
        let on_a_line = |k: usize| {
            let [a, b, c] = [k, k + 1, k + 2].map(|k| corners[k % 4].map(|x| x as i32));
            let side = |to: [i32; 3]| [0, 1, 2].map(|axis| to[axis] - a[axis]);
            let (u, v) = (side(b), side(c));
            (0..3).all(|i| u[i] * v[(i + 1) % 3] == u[(i + 1) % 3] * v[i])
        };
        if is_apart && !(0..4).any(on_a_line) {
            assert_eq!(mesh.triangles.len(), 2, "{text}");
        }
    }
}

/// Coordinates far from the origin keep all digits.
#[test]
fn coordinates_are_read_with_all_digits() {
    let far = obj("v 500000.125 4000000.03 7.3\nv 500001 4000000 7\nv 500000 4000001 7\nf 1 2 3\n");
    assert_eq!(far.positions[0], [500_000.125, 4_000_000.03, 7.3]);
}

/// A tetrahedron in two groups, which Gmsh 2.2 writes twice, counts once. Tags may be negative.
#[test]
fn tetrahedra_count_once() {
    let nodes = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n\
                 4 0 0 1\n$EndNodes\n";
    let twice = "$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 4 2 1 1 -2 3 1 2 4\n$EndElements\n";
    let mesh = Mesh::from_gmsh(format!("{nodes}{twice}").as_bytes()).unwrap();
    assert_eq!((mesh.tetrahedra.len(), mesh.triangles.len()), (1, 4));
    assert_eq!(mesh.tetrahedron_numbers, [1]);
    let parametric = format!("{nodes}{twice}").replace("Nodes", "ParametricNodes");
    let same = Mesh::from_gmsh(parametric.as_bytes()).unwrap();
    assert_eq!(same.positions, mesh.positions);
    let hexahedron =
        |kind: &str| format!("{nodes}{}", twice.replace("2 4 4", &format!("2 {kind} 4")));
    #[rustfmt::skip]
    let cases = [
        (hexahedron("92"), "line 14: an element of type 92 is a hexahedron"),
        (hexahedron("118"), "line 14: an element of type 118 is a hexahedron"),
        ("$NOD\n1\n".into(), "it is Gmsh's format 1, and only the text formats 2.2 and 4.1"),
        ("$MeshFormat\n4 0 8\n".into(), "it is Gmsh's format 4, and only"),
        ("$MeshFormat\n4.1 1 8\n".into(), "it is Gmsh's format 4.1, binary, and only"),
    ];
    for (text, why) in cases {
        let refused = Mesh::from_gmsh(text.as_bytes()).unwrap_err();
        begins(refused, why);
    }
}

/// Triangles without an area are left out, and no others.
#[test]
fn what_has_no_area_is_left_out() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    let mesh = obj(format!("{square}v 5 5 5\nv 6 6 6\nv 7 7 7\nf 5 6 7\n"));
    assert_eq!(counts(&mesh), [4, 2]);
    let nothing = Mesh::from_obj(b"v 5 5 5\nv 6 6 6\nv 7 7 7\nf 1 2 3\n").unwrap_err();
    assert_eq!(nothing, "the triangles of the file have no area");
}

/// STL text in capitals is read. A text or a binary file that is cut short is not.
#[test]
fn stl_in_capitals_and_cut_short() {
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
                vertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    for text in [text.to_uppercase(), text.replace("vertex 1", "Vertex 1")] {
        let mesh = Mesh::from_stl(text.as_bytes()).unwrap();
        assert_eq!(counts(&mesh), [3, 1]);
    }
    let short = &text[..text.find("endfacet").unwrap()];
    let refused = Mesh::from_stl(short.as_bytes()).unwrap_err();
    assert_eq!(refused, "the file ends within a facet: it is cut short");
    // Some programs leave out the last line.
    let open = &text[..text.find("endsolid").unwrap()];
    assert_eq!(Mesh::from_stl(open.as_bytes()).unwrap().triangles.len(), 1);
    let wide: Vec<u8> = text.bytes().flat_map(|b| [b, 0]).collect();
    let refused = Mesh::from_stl(&wide).unwrap_err();
    begins(refused, "it is UTF-16");
    // A binary file may begin like text and have more bytes after its triangles.
    let mut binary = [b"solid".as_slice(), &[b' '; 75], &1u32.to_le_bytes()].concat();
    binary.extend([0; 12]);
    for x in [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        binary.extend(x.to_le_bytes());
    }
    binary.extend([0; 2 + 7]);
    assert_eq!(Mesh::from_stl(&binary).unwrap().triangles.len(), 1);
}

/// The rest of a line of a PLY file after its element is skipped. A wrong face is named.
#[test]
fn lines_of_ply_may_have_more() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
                end_header\n0 0 0 9 9\n1 0 0 9\n0 1 0\n3 0 1 2 0.5 0.25\n";
    let mesh = Mesh::from_ply(text.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    // A long line costs no memory for its words, and ends the search for the end of the head.
    let beyond = "face 0, counted from 0, has corner 7, but there are 3 points";
    let long = format!("comment{}\nend_header", " a".repeat(1 << 20));
    for (part, instead, why) in [
        ("3 0 1 2", "3 0 1 7", beyond),
        ("end_header", "", "`end_header` is missing"),
        ("end_header", &long, "in the first 1 MiB"),
    ] {
        let refused = Mesh::from_ply(text.replace(part, instead).as_bytes()).unwrap_err();
        assert!(refused.contains(why), "{refused}");
    }
}

/// Files of other kinds are refused with their kind.
#[test]
fn other_files_are_named() {
    let lfs = b"version https://git-lfs.github.com/spec/v1\n";
    let three = "line 1: `nan` is none: a point has three finite numbers";
    for (bytes, why) in [
        (b"\x1f\x8b\x08\0".as_slice(), "it is compressed by gzip"),
        (b"PK\x03\x04", "it is a zip archive"),
        (lfs, "it is a pointer of Git LFS"),
        (b"<!DOCTYPE html>", "it is a web page"),
        (b"v\0\0\0 \0\0\0", "it is UTF-32"),
        (b"v nan 0 0\n", three),
        (b"v 0,5 0 0\n", "line 1: `0,5` is none"),
    ] {
        let refused = Mesh::from_obj(bytes).unwrap_err();
        begins(refused, why);
    }
    // The numbers of a binary file are not taken for text in UTF-32.
    let refused = Mesh::from_gmsh(&[200, 0, 0, 0, 1, 0, 0, 0]).unwrap_err();
    begins(refused, "it is no Gmsh file");
}

/// A hundred thousand points within a few millionths of the longest side are welded in little time.
#[test]
fn crowds_of_points_are_welded_at_once() {
    let mut positions = vec![[1e6, 0.0, 0.0]];
    let mut random = random(1);
    positions.extend((0..100_000).map(|_| [random(), random(), random()].map(|x| 4.0 * x)));
    let triangles = (0..positions.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
    let mesh = Mesh { triangles: triangles.collect(), positions, ..Mesh::default() };
    // Each point is kept or within the tolerance, 1 m, of one that is kept. At most a hundred fit.
    let welded = mesh.welded().positions.len();
    assert!((5..150).contains(&welded), "{welded}");
}
