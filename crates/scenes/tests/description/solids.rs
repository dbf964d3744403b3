//! Solids: boxes, files, and their faults.

use a3_core::{Element, Vector3};
use a3_scenes::snapshot;

use super::*;

const BOX: &str = "\
[[solid]]
grid = [4, 3, 2]
size = [3, 2, 1]
density = 1200
young = 1e5
poisson = 0.3
at = [0, 5, 0]
pin = [{ at = [\"left\"] }]
";

fn solid(network: &Network) -> &a3_core::elements::Solid {
    let elements = network.elements().iter();
    let solids = elements.filter_map(|element| match element {
        Element::Solid(solid) => Some(solid),
        _ => None,
    });
    solids.last().unwrap()
}

#[test]
fn a_box_is_filled_with_tetrahedra() {
    let scene = build(BOX).unwrap();
    let network = network(&scene);
    let solid = solid(network);
    assert_eq!((network.particles(), solid.volumes().count()), (24, 36));
    let mut volumes = solid.volumes();
    assert!(volumes.all(|volume| (volume - 1.0 / 6.0).abs() < 1e-12));
    assert!((network.masses().iter().sum::<f64>() - 7200.0).abs() < 1e-9);
    // Two triangles on each outer face of a cell close the surface.
    assert_eq!(network.triangles().len(), 2 * 2 * (3 * 2 + 3 + 2));
    let n = network.particles();
    let at = |i: u32| {
        let i = i as usize;
        Vector3::new(scene.state[i], scene.state[n + i], scene.state[2 * n + i])
    };
    let six = network.triangles().iter().map(|t| {
        let [a, b, c] = t.map(at);
        a.dot(&b.cross(&c))
    });
    assert!((six.sum::<f64>() / 6.0 - 6.0).abs() < 1e-9);
    let pinned: Vec<_> = network.pins().map(|(i, _)| i).collect();
    assert_eq!(pinned, [0, 4, 8, 12, 16, 20]);
    assert_eq!(network.forces_in_use(), ["solid"]);
    let mut description = read(&BOX.replace("poisson", "damping = 0.5\npoisson"));
    snapshot::scale_springs(&mut description, 4.0, 2.0);
    let scaled = &description.solid[0];
    assert_eq!([scaled.young, scaled.damping], [4e5, 0.25]);
    assert_eq!(read(&description.to_toml().unwrap()), description);
}

fn from_file(mesh: &Mesh, extra: &str) -> Result<Setup, String> {
    let text = format!(
        "[[solid]]\nfile = 'a'\ndensity = 12\nyoung = 1\npoisson = 0\nat = [0, 0, 0]\n{extra}"
    );
    let (description, places) = parse_toml(&text).map_err(|fault| fault.to_string())?;
    let built = description.build(None, &mut |_| Ok(mesh.clone()));
    built.map_err(|fault| places.locate(fault).to_string())
}

/// The files of all formats have the same two tetrahedra. `TetGen`'s counts their corners the other
/// way round.
#[test]
fn files_hold_tetrahedra() {
    let meshes = [
        Mesh::from_gmsh(&seed("msh/two.msh")),
        Mesh::from_gmsh(&seed("msh/four.msh")),
        Mesh::from_tetgen(&seed("ele/two.node"), &seed("ele/two.ele")),
    ];
    for mesh in meshes {
        let mesh = mesh.unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (5, 6));
        let setup = from_file(&mesh, "scale = 2\npin = [{ at = ['top'] }]").unwrap();
        let network = setup.scene.model.network().unwrap();
        let mut volumes = solid(network).volumes().zip([8.0 / 6.0, 16.0 / 6.0]);
        assert!(volumes.all(|(a, b)| (a - b).abs() < 1e-12));
        assert!((network.masses()[0] - 4.0).abs() < 1e-12 && network.masses()[4] > 7.99);
        let pinned: Vec<_> = network.pins().map(|(i, _)| i).collect();
        assert_eq!(pinned, [2, 4]);
    }
}

/// Changes of the box, with the messages.
const WRONG_BOX: &str = r#"
young = 1e5
    young = 0 => line 5: solid.young: it must be a finite number above 0
    young = 1e14 => line 5: solid.young: it must be a number from
poisson = 0.3
    poisson = 0.5 => line 6: solid.poisson: Poisson's ratio must be above -1
    poisson = -1 => line 6: solid.poisson:
density = 1200
    density = -1 => line 4: solid.density:
[4, 3, 2]
    [4, 1, 2] => line 2: solid.grid: a solid has at least 2 particles
[3, 2, 1]
    [3, 0, 1] => line 3: solid.size:
    [3, 2, 1e-9] => line 3: solid.size: tetrahedron 0 is flat
size = [3, 2, 1]\n
     => line 1: solid: a solid is a box
    size = [3, 2, 1]\nscale = 2\n => line 1: solid: a solid is a box
"left"
    "first" => ... a solid top, bottom, left, right
[4, 3, 2]
    [99999, 99999, 99999] => line 1: solid: the scene would have
grid = [4, 3, 2]
    grid = [300, 30, 30] => ... 1620000 tetrahedra
young
    model = "foam"\nyoung => ... there is no `foam`; the choices are neo-hookean
young = 1e5\n
     => ... young
"#;

#[test]
fn what_is_wrong_with_a_solid_is_said() {
    refused(BOX, WRONG_BOX, said);
    let flat = BOX.replace("grid = [4, 3, 2]\nsize = [3, 2, 1]", "file = 'square.obj'");
    assert!(said(&flat).contains("solid.file: the file has no tetrahedra"));
}

/// Changes of a file of Gmsh, with the messages.
const WRONG_FILE: &str = r"
1 1 2 3 4\n
    1 1 2 3\n => line 20: a tetrahedron has four corners
1 2 3 4\n
    1 2 3 5\n => line 20: there is no point 5
    1 2 3 x\n => line 20: `x` is no whole number
2 1 0 0\n
    2 1 0\n => line 11: a point has a number and three finite coordinates
    2 1 0 nan\n => line 11: a point has
    1 1 0 0\n => ... two points of number 1
$Nodes\n5\n
    $Nodes\n6\n => line 15: $Nodes ends early
$Elements\n4\n
    $Elements\n5\n => line 22: $Elements ends early
2.2 0 8
    2.2 1 8 => ... is Gmsh's format 2.2, binary
$MeshFormat
    $Mesh => ... no Gmsh file
3 4 2
    3 5 2 => line 20: an element of type 5 is a hexahedron
";

#[test]
fn what_is_wrong_with_a_file_is_said() {
    let whole = String::from_utf8(seed("msh/two.msh")).unwrap();
    refused(&whole, WRONG_FILE, |text| Mesh::from_gmsh(text.as_bytes()).unwrap_err());
    for end in (0..whole.len()).step_by(7) {
        let cut = &whole.as_bytes()[..end];
        assert!(end + 14 > whole.len() || Mesh::from_gmsh(cut).is_err());
    }
    let mut mesh = Mesh::from_gmsh(whole.as_bytes()).unwrap();
    mesh.tetrahedra[1].swap(0, 1);
    let why = |mesh: &Mesh| from_file(mesh, "").err().unwrap();
    assert!(why(&mesh).contains("line 2: solid.file: tetrahedron 1 is inside out"));
    mesh.positions[4] = [0.5, 0.5, 0.0];
    assert!(why(&mesh).contains("tetrahedron 1 is flat"));
}
