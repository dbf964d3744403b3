//! Scenes made from a mesh file alone: the mesh hangs by its highest points, or by an edge if it
//! is level.
//!
//! How it hangs decides the points that are pinned, the depth of its fall, and the sizes from
//! which its stiffness is chosen.

use std::collections::BTreeSet;
use std::path::Path;

use a3_core::Vector3;
use a3_scenes::Mesh;

use super::files::{MESH_ENDINGS, MeshReader, load_mesh};
use crate::platform::terminal;
use crate::rounding::{MANY, round_up};

/// Longest side of the mesh (m).
const SIDE: f64 = 2.0;
/// Acceleration of gravity (m/s2).
const GRAVITY: f64 = 9.81;
/// Largest strain of the edges at the pins under the weight, by which the stiffness is chosen.
const STRAIN: f64 = 0.1;
/// Density of a cloth (kg/m2).
const CLOTH_DENSITY: f64 = 0.3;
/// Density of a solid (kg/m3).
const SOLID_DENSITY: f64 = 1000.0;

/// Returns whether a file with this ending is a mesh.
pub fn is_mesh(extension: &str) -> bool {
    MESH_ENDINGS.contains(&extension)
}

/// Writes the text of a scene in which the mesh of a file hangs: a cloth if it is made of
/// triangles, a solid if it is made of tetrahedra. Mesh files give no unit of length, so the mesh
/// is scaled: its longest side is 2 m.
///
/// # Errors
/// The file cannot be read, or the mesh has no size.
pub fn scene(path: &Path) -> Result<String, String> {
    let mut mesh = load_mesh(path, &mut MeshReader::new(1))?;
    if mesh.tetrahedra.is_empty() {
        mesh = mesh.welded();
    }
    let whole = Part((0..mesh.positions.len()).collect());
    let extents = [0, 1, 2].map(|axis| whole.extent(&mesh, axis));
    let size = extents.map(|[low, high]| high - low);
    let longest = size.into_iter().fold(0.0, f64::max);
    let scale = SIDE / longest;
    if !(longest > 0.0 && scale.is_finite() && scale > 0.0) {
        return Err("the mesh has no size".into());
    }
    let at = extents.map(|[low, high]| 0.0 - 0.5 * scale * (low + high));
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let hanging = hang(&mesh);
    if hanging.held < hanging.parts {
        let Hanging { held, parts, .. } = hanging;
        terminal::note(&format!("{name}: {held} of {parts} parts are pinned"));
    }
    // A string in JSON is one in TOML too.
    let file = serde_json::Value::from(&*name);
    let body = if mesh.tetrahedra.is_empty() {
        let stiffness = stiffness(&hanging, scale);
        format!(
            "# Air pushes its triangles: key d lets the wind blow.\n\
             wind = {{ velocity = [3, 0, 1.5] }}\n\
             {}\n\
             [[mesh]]\n\
             density = 0.3                   # kg/m2\n\
             stiffness = [{stiffness}, {}]           # structural, bend, N/m\n\
             damping_ratio = 0.1\n",
            camera(&hanging, size, scale),
            stiffness / 12.0,
        )
    } else {
        format!(
            "{}\n\
             [[solid]]\n\
             density = 1000                  # kg/m3\n\
             young = {:e}                     # Pa\n\
             poisson = 0.3\n\
             damping = 0.004                 # s\n",
            camera(&hanging, size, scale),
            young(&hanging, scale),
        )
    };
    let (by, pins) = match &hanging.pins {
        None => ("its highest points", "at = [\"top\"]".to_owned()),
        Some(pins) if hanging.parts == 1 => ("an edge", format!("particles = {pins:?}")),
        Some(pins) => ("points of each part", format!("particles = {pins:?}")),
    };
    Ok(format!(
        "# The mesh of {name}, which hangs by {by}.\n\n\
         summary = \"a mesh that hangs by {by}\"\n\
         solver = \"implicit\"\n\
         step = 0.0166666666666667\n\
         gravity = [0, -9.81, 0]\n\
         drag_per_mass = 0.5\n\
         {body}\
         file = {file}\n\
         scale = {scale}\n\
         at = {at:?}\n\
         pin = [{{ {pins} }}]\n"
    ))
}

/// Returns the stiffness of the structural springs (N/m), with which edges at few pins are not
/// stretched far by the weight below them. `scale` is that from the unit of the file to metres.
fn stiffness(hanging: &Hanging, scale: f64) -> f64 {
    let needed = |neck: &Neck| {
        let weight = CLOTH_DENSITY * GRAVITY * neck.size * scale.powi(2);
        weight / (STRAIN * neck.edges * neck.length * scale)
    };
    largest(hanging, needed, [120.0, 1e6])
}

/// Returns Young's modulus (Pa) of a solid, chosen in the same way.
fn young(hanging: &Hanging, scale: f64) -> f64 {
    let needed = |neck: &Neck| {
        let weight = SOLID_DENSITY * GRAVITY * neck.size * scale.powi(3);
        // Each edge stands for a prism half as wide as it is long.
        let area = neck.edges * (0.5 * neck.length * scale).powi(2);
        weight / (STRAIN * area)
    };
    largest(hanging, needed, [1e5, 1e8])
}

/// Returns the largest of what the necks need, within bounds, as a round number.
fn largest(hanging: &Hanging, needed: impl Fn(&Neck) -> f64, [least, most]: [f64; 2]) -> f64 {
    let needed = hanging.necks.iter().map(needed).fold(0.0, f64::max);
    round_up(needed.clamp(least, most), MANY)
}

/// Writes the key of a camera that sees the whole fall of the mesh; an empty text if the mesh does
/// not fall far.
fn camera(hanging: &Hanging, size: [f64; 3], scale: f64) -> String {
    let fall = hanging.fall * scale;
    if fall <= 0.1 * SIDE {
        return String::new();
    }
    let [x, y, z] = size.map(|side| side * scale);
    let target = -0.5 * fall;
    let radius = 0.5 * (x * x + (y + fall).powi(2) + z * z).sqrt();
    // From the front, a little from the right and from above, as scenes without a camera are seen.
    let eye = [0.43, 0.13, 0.87].map(|e: f64| 2.8 * radius * e);
    let [x, y, z] = [eye[0], eye[1] + target, eye[2]];
    format!("camera = {{ eye = [{x:.3}, {y:.3}, {z:.3}], target = [0, {target:.3}, 0] }}\n")
}

/// Largest height of a part that counts as level, over its longest side.
const MAX_LEVEL_HEIGHT: f64 = 0.02;
/// Largest distance of pinned points from the highest point or from the edge, over the size of the
/// part in that direction.
const PIN_DISTANCE: f64 = 0.01;
/// Largest number of points that are pinned.
const MAX_PINS: usize = 20_000;
/// Largest number of connected parts that are pinned at several points; if there are more, each is
/// pinned at one.
const MAX_WIDE_PARTS: usize = 1000;

/// Pins of a mesh, and what follows from them.
pub struct Hanging {
    /// Numbers of the pinned points; `None` if the scene can ask for its highest points instead.
    pub pins: Option<Vec<usize>>,
    /// Number of connected parts.
    pub parts: usize,
    /// Number of parts that are pinned.
    pub held: usize,
    /// Largest distance that a level part may fall below the lowest point of the mesh, in the unit
    /// of the file.
    pub fall: f64,
    /// Necks of the parts that hang by pins.
    pub necks: Vec<Neck>,
}

/// Edges of a part between its pinned points and the others, which carry its weight. Lengths are in
/// the unit of the file.
pub struct Neck {
    /// Area or volume of the part.
    pub size: f64,
    /// Number of these edges.
    pub edges: f64,
    /// Mean length of these edges.
    pub length: f64,
}

/// Connected part of a mesh: the numbers of its points, in order.
struct Part(Vec<usize>);

/// Chooses how a mesh hangs. All its points are in triangles or tetrahedra.
pub fn hang(mesh: &Mesh) -> Hanging {
    let parts = parts(mesh);
    let count = parts.len();
    let mut is_pinned = vec![false; mesh.positions.len()];
    let (mut pins, mut held, mut is_top) = (vec![], 0, count == 1);
    let mut fall: f64 = 0.0;
    let lowest = parts.iter().map(|part| part.extent(mesh, 1)[0]);
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    for part in &parts {
        let (mut own, is_level) = part.held(mesh);
        if count > MAX_WIDE_PARTS {
            own.truncate(1);
        }
        if pins.len() + own.len() > MAX_PINS {
            continue;
        }
        held += 1;
        is_top &= !is_level;
        // A level part swings down from its edge.
        let height = mesh.positions[own[0]][1];
        let width = [0, 2].map(|axis| part.extent(mesh, axis)).map(|[a, b]| b - a);
        if is_level {
            fall = fall.max(width[0].hypot(width[1]) - (height - lowest));
        }
        for i in &own {
            is_pinned[*i] = true;
        }
        pins.extend(own);
    }
    Hanging {
        necks: necks(mesh, &parts, &is_pinned),
        pins: (!is_top).then_some(pins),
        parts: count,
        held,
        fall,
    }
}

impl Part {
    /// Returns the smallest and the largest coordinate along an axis.
    fn extent(&self, mesh: &Mesh, axis: usize) -> [f64; 2] {
        let along = self.0.iter().map(|i| mesh.positions[*i][axis]);
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    }

    /// Returns the points by which the part hangs, and whether it is level: a level part hangs by
    /// an edge, any other by its highest points.
    fn held(&self, mesh: &Mesh) -> (Vec<usize>, bool) {
        let size = [0, 1, 2].map(|axis| self.extent(mesh, axis)).map(|[low, high]| high - low);
        let longest = size.into_iter().fold(0.0, f64::max);
        let end = |axis: usize, is_high: bool| {
            let [low, high] = self.extent(mesh, axis);
            let (at, near) = ([low, high][usize::from(is_high)], PIN_DISTANCE * (high - low));
            let is_there = |i: &&usize| (mesh.positions[**i][axis] - at).abs() <= near;
            let there = self.0.iter().filter(is_there);
            there.copied().collect::<Vec<_>>()
        };
        let is_level = size[1] <= MAX_LEVEL_HEIGHT * longest;
        let mut held = if is_level {
            // The edge at the back, or one at the side if the part has no depth.
            let has_depth = size[2] > MAX_LEVEL_HEIGHT * longest;
            end(if has_depth { 2 } else { 0 }, false)
        } else {
            end(1, true)
        };
        if held.len() == self.0.len() {
            held.truncate(1);
        }
        (held, is_level)
    }
}

/// Returns the edges of all triangles and tetrahedra; shared ones occur more than once.
fn edges(mesh: &Mesh) -> impl Iterator<Item = [u32; 2]> {
    let triangles = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let tetrahedra = mesh.tetrahedra.iter();
    let inner =
        tetrahedra.flat_map(|&[a, b, c, d]| [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d]]);
    triangles.chain(inner)
}

/// Finds the connected parts, in the order of their first points.
fn parts(mesh: &Mesh) -> Vec<Part> {
    let mut first: Vec<_> = (0..mesh.positions.len()).collect();
    let find = |first: &mut Vec<usize>, mut i: usize| {
        while first[i] != i {
            first[i] = first[first[i]];
            i = first[i];
        }
        i
    };
    for ends in edges(mesh) {
        let [a, b] = ends.map(|i| find(&mut first, i as usize));
        first[a.max(b)] = a.min(b);
    }
    let mut places = vec![usize::MAX; first.len()];
    let mut parts = vec![];
    for i in 0..first.len() {
        let root = find(&mut first, i);
        if places[root] == usize::MAX {
            places[root] = parts.len();
            parts.push(Part(vec![]));
        }
        parts[places[root]].0.push(i);
    }
    parts
}

/// Measures the neck of each part that has both pinned points and others.
fn necks(mesh: &Mesh, parts: &[Part], is_pinned: &[bool]) -> Vec<Neck> {
    let mut part_of = vec![0; mesh.positions.len()];
    for (k, part) in parts.iter().enumerate() {
        part.0.iter().for_each(|i| part_of[*i] = k);
    }
    let at = |i: u32| Vector3::from(mesh.positions[i as usize]);
    let neck = |_| Neck { size: 0.0, edges: 0.0, length: 0.0 };
    let mut necks: Vec<_> = parts.iter().map(neck).collect();
    for &[a, b, c, d] in &mesh.tetrahedra {
        let [u, v, w] = [b, c, d].map(|i| at(i) - at(a));
        let volume = u.cross(&v).dot(&w).abs() / 6.0;
        necks[part_of[a as usize]].size += volume;
    }
    if mesh.tetrahedra.is_empty() {
        for &[a, b, c] in &mesh.triangles {
            let normal = (at(b) - at(a)).cross(&(at(c) - at(a)));
            necks[part_of[a as usize]].size += 0.5 * normal.norm();
        }
    }
    let between =
        edges(mesh).filter(|ends| ends.iter().filter(|i| is_pinned[**i as usize]).count() == 1);
    let between: BTreeSet<_> = between.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    for [a, b] in between {
        let neck = &mut necks[part_of[a as usize]];
        neck.edges += 1.0;
        neck.length += (at(b) - at(a)).norm();
    }
    necks.retain(|neck| neck.edges > 0.0);
    for neck in &mut necks {
        neck.length /= neck.edges;
    }
    necks
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use a3_core::{Simulation, integrators};

    use crate::scene_file::Source;

    /// A box of triangles, and one of tetrahedra, in millimetres and far from the origin: both hang
    /// and come to rest near the origin.
    #[test]
    fn meshes_of_any_unit_hang() {
        let folder = tempfile::tempdir().unwrap();
        let corners = (0..8).map(|k| [0, 1, 2].map(|axis| 7000 + 500 * (k >> axis & 1)));
        let corners: Vec<_> = corners.collect();
        let obj = folder.path().join("my \"box\".obj");
        let mut text = String::new();
        for [x, y, z] in &corners {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        text += "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";
        std::fs::write(&obj, text).unwrap();
        let msh = folder.path().join("box.msh");
        let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n".to_owned();
        for (k, [x, y, z]) in corners.iter().enumerate() {
            writeln!(text, "{} {x} {y} {z}", k + 1).unwrap();
        }
        text += "$EndNodes\n$Elements\n6\n";
        // Six tetrahedra around the diagonal.
        for (k, [a, b]) in [[2, 4], [4, 3], [3, 7], [7, 5], [5, 6], [6, 2]].iter().enumerate() {
            writeln!(text, "{} 4 2 1 1 1 {a} {b} 8", k + 1).unwrap();
        }
        text += "$EndElements\n";
        std::fs::write(&msh, text).unwrap();
        for (file, name) in [(&obj, "my \"box\""), (&msh, "box")] {
            let source = Source::find(file.to_str().unwrap()).unwrap();
            let setup = source.build(None).unwrap();
            assert_eq!(setup.scene.name, name);
            let method = source.solver_or(None);
            assert_eq!(method.name, "implicit");
            let control = setup.defaults.control_of(method);
            let mut run = Simulation::new(setup.scene, method, control).unwrap();
            run.advance_to(12.0).unwrap();
            let network = run.model().network().unwrap();
            assert_eq!(network.pins().count(), 4);
            for i in 0..run.particles() {
                assert!(run.position(i).norm() < 2.2, "{}", run.position(i));
                let held = network.is_pinned(i);
                assert!(held == (run.position(i).y > 0.98), "{}", run.position(i));
            }
            assert!(run.energy().unwrap().kinetic < 1e-2);
            assert!(integrators::find("v").unwrap().check(run.model().system()).is_ok());
        }
    }

    /// Returns the pinned particles of the scene of a mesh, and their number.
    fn pinned(text: &str) -> (Vec<usize>, usize, Source) {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mesh.obj");
        std::fs::write(&file, text).unwrap();
        let source = Source::find(file.to_str().unwrap()).unwrap();
        let scene = source.build(None).unwrap().scene;
        let network = scene.model.network().unwrap();
        let pins = network.pins().map(|(i, _)| i).collect();
        (pins, network.particles(), source)
    }

    /// Returns a sheet of 3 x 3 points across y at that height.
    fn sheet(y: f64, first: usize) -> String {
        let points = (0..9).map(|k| format!("v {} {y} {}\n", k % 3, k / 3));
        let corner = |k: usize| first + k + k / 2;
        let faces = (0..4).map(|k| {
            let a = corner(k);
            format!("f {a} {} {} {}\n", a + 1, a + 4, a + 3)
        });
        points.chain(faces).collect()
    }

    /// A level sheet hangs by an edge, and each of several parts hangs.
    #[test]
    fn all_parts_hang_and_move() {
        let (pins, count, source) = pinned(&sheet(7.0, 1));
        assert_eq!((pins.len(), count), (3, 9));
        let camera = source.description.camera.as_ref().unwrap();
        assert!(camera.target[1] < -0.5 && camera.eye[2] > 2.0);
        let upright = "v 0 0 5\nv 1 0 5\nv 1 1 5\nv 0 1 5\nf 19 20 21 22\n";
        let text = sheet(0.0, 1) + &sheet(3.0, 10) + upright;
        let (pins, count, source) = pinned(&text);
        assert_eq!((pins.len(), count), (3 + 3 + 2, 22));
        assert!(source.text().contains("hangs by points of each part"));
    }

    /// A mesh that hangs by few edges is stiffer, in proportion to its weight.
    #[test]
    fn stiffness_fits_the_weight() {
        let stiffness = |text: &str| pinned(text).2.description.mesh[0].stiffness[0];
        let wide = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
        assert_eq!(stiffness(wide), 120.0);
        let tip = "v 0 1 0\nv -0.02 0.98 0\nv 0.02 0.98 0\nv -1 0 0\nv 1 0 0\n\
                   f 1 2 3\nf 2 4 5 3\n";
        // A triangle of 1 m2 on two edges of 28 mm.
        let needed = 0.3 * 9.81 / (0.1 * 2.0 * 0.028_28);
        let found = stiffness(tip);
        assert!(found >= needed && found < 1.3 * needed, "{found} {needed}");
    }

    #[test]
    fn meshes_without_size_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("dot.obj");
        std::fs::write(&file, "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n").unwrap();
        let why = Source::find(file.to_str().unwrap()).err().unwrap();
        let why = why.to_string();
        assert!(why.contains("dot.obj: ") && !why.contains('\n'), "{why}");
        std::fs::write(&file, "nonsense\n").unwrap();
        assert!(Source::find(file.to_str().unwrap()).is_err());
        let gone = folder.path().join("gone.glb");
        let why = Source::find(gone.to_str().unwrap()).err().unwrap();
        let why = why.to_string();
        assert!(why.contains("gone.glb: it could not be read"), "{why}");
    }
}
