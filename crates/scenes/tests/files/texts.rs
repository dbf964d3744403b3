//! Text files from all systems, and the numbers in them.

use a3_scenes::Mesh;

use crate::{area, begins, counts, data, obj};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

/// Byte order marks, ends of lines, comments and continued lines change nothing.
#[test]
fn a_square_is_a_square_however_it_is_written() {
    let square = obj(SQUARE);
    assert_eq!(counts(&square), [4, 2]);
    for text in [
        data("continued.obj"),
        data("comment.obj"),
        data("cr.obj"),
        SQUARE.replace('\n', "\r\n").into(),
        format!("\u{feff}{SQUARE}").into(),
        SQUARE.replace("1 0\n", "1 0 # a corner \\\n").into(),
        SQUARE.replace("f 1 2 3", "f\\\n 1 \\  \n2\\\r\n3").into(),
        SQUARE.replace("v 1 0 0", "v 1 \\\r0 0").into(),
        // A statement that is skipped is not continued.
        format!("mtllib C:\\things\\\n{SQUARE}usemtl red\\").into(),
        SQUARE.replace('\n', "\r").into(),
    ] {
        let shown = String::from_utf8_lossy(&text).into_owned();
        assert_eq!(obj(text), square, "{shown}");
    }
    let marked = obj(data("mark.obj"));
    assert_eq!(marked.positions, square.positions);
}

#[test]
fn marks_and_comments_are_in_all_texts() {
    let orphan = String::from_utf8(data("orphan.msh")).unwrap();
    let mesh = Mesh::from_gmsh(orphan.as_bytes()).unwrap();
    assert_eq!((mesh.positions.len(), mesh.tetrahedra.len()), (4, 1));
    assert!(mesh.numbers == [2, 3, 4, 5] && mesh.tetrahedron_numbers == [2]);
    for text in [
        format!("\u{feff}{orphan}"),
        orphan.replace('\n', "\r\n"),
        orphan.replace('\n', "\r"),
        orphan.replace('\n', " # a comment\n"),
    ] {
        assert_eq!(Mesh::from_gmsh(text.as_bytes()).unwrap(), mesh, "{text}");
    }
    let [ele, node] = ["ten.ele", "ten.node"].map(|name| String::from_utf8(data(name)).unwrap());
    let mesh = Mesh::from_tetgen(node.as_bytes(), ele.as_bytes()).unwrap();
    assert_eq!(counts(&mesh), [4, 4]);
    assert_eq!(mesh.numbers, [1, 2, 3, 4]);
    let marked = [&node, &ele].map(|text| format!("\u{feff}{}", text.replace('\n', "\r")));
    let [node, ele] = marked.each_ref().map(std::string::String::as_bytes);
    assert_eq!(Mesh::from_tetgen(node, ele).unwrap(), mesh);
}

/// Ten-node tetrahedra of Gmsh are read by their corners. Other solid elements are refused.
#[test]
fn elements_of_gmsh_are_read_by_their_corners() {
    let file = |kind: u32| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n7 0 0 1\n$EndNodes\n\
             $Elements\n2\n5 {kind} 2 1 1 1 2 3 7 1 1 1 1 1 1\n6 15 2 1 1 1\n$EndElements\n"
        )
    };
    let mesh = Mesh::from_gmsh(file(11).as_bytes()).unwrap();
    assert_eq!(mesh.tetrahedra, [[0, 1, 2, 3]]);
    assert!(mesh.numbers == [1, 2, 3, 7] && mesh.tetrahedron_numbers == [5]);
    let why = Mesh::from_gmsh(file(5).as_bytes()).unwrap_err();
    begins(why, "line 13: an element of type 5 is a hexahedron");
}

#[test]
fn utf_16_is_named() {
    let wide = |mark: &[u8], order: fn(u16) -> [u8; 2]| {
        let words = SQUARE.encode_utf16().flat_map(order);
        mark.iter().copied().chain(words).collect::<Vec<_>>()
    };
    for text in [
        wide(b"\xff\xfe", u16::to_le_bytes),
        wide(b"\xfe\xff", u16::to_be_bytes),
        wide(b"", u16::to_le_bytes),
        wide(b"", u16::to_be_bytes),
    ] {
        for read in [
            Mesh::from_obj(&text),
            Mesh::from_gmsh(&text),
            Mesh::from_tetgen(&text, b""),
            Mesh::from_gltf(&text, &mut |_| Ok(vec![])),
        ] {
            assert_eq!(read.unwrap_err(), "it is UTF-16 text: save it as UTF-8");
        }
    }
}

/// Points that are in no face are left out, wherever they are.
#[test]
fn loose_points_are_left_out() {
    let mesh = obj(data("loose.obj"));
    assert_eq!((mesh.positions.len(), area(&mesh)), (4, 1.0));
    let far = obj(format!("v 1e30 0 0\n{SQUARE}").replace("1 2 3 4", "2 3 4 5"));
    assert_eq!(far.numbers, [2, 3, 4, 5]);
    let why = Mesh::from_obj(SQUARE.replace("v 1 1 0", "v 1 2e9 0").as_bytes()).unwrap_err();
    begins(why, "point 3 is at (1e0, 2e9, 0e0)");
}

/// Points where parts of a file meet are merged, though rounding separates them. A part that is
/// small relative to the mesh keeps its shape.
#[test]
fn seams_are_welded() {
    let halves = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1.0000002 0 0\nv 2 0 0\nv 2 1 0\nv 0.9999998 1 0\nf 1 2 3 4\nf 5 6 7 8\n";
    for unit in [1e-6, 1.0, 1e6] {
        let scaled = |x: &str| format!("{:e}", x.parse::<f64>().unwrap() * unit);
        let lines = halves.lines().map(|line| match line.strip_prefix("v ") {
            Some(point) => {
                let numbers: Vec<_> = point.split(' ').map(scaled).collect();
                format!("v {}\n", numbers.join(" "))
            }
            None => format!("{line}\n"),
        });
        let mesh = obj(lines.collect::<String>()).welded();
        assert_eq!(counts(&mesh), [6, 4], "{unit}");
        assert_eq!(mesh.numbers, [1, 2, 3, 4, 6, 7]);
    }
    let apart = halves.replace("0002", "0200").replace("9999998", "9999800");
    assert_eq!(obj(apart).welded().positions.len(), 8);
    // A triangle with sides of a hundred-thousandth of the mesh's.
    let fine = "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nv 0.01 0 5\nv 0.02 0 5\nv 0.02 0.01 5\nf 1 2 3\nf 4 5 6\n";
    assert_eq!(obj(fine).welded().triangles.len(), 2);
    let same = "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n";
    let refused = Mesh::from_obj(same.as_bytes()).unwrap_err();
    assert_eq!(refused, "the triangles of the file have no area");
    // -0 is 0.
    let zero = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv -0 -0 0\nv 0 1 0\nf 1 2 3\nf 4 3 5\n";
    assert_eq!(obj(zero).welded().positions.len(), 4);
}
