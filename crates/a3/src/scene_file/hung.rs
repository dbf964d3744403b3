//! Scenes of a mesh alone: it hangs by its highest points.

use std::path::Path;

use super::mesh;

/// Longest side of the mesh (m).
const SIDE: f64 = 2.0;

/// Whether a file with this ending is a mesh.
pub fn is_mesh(extension: &str) -> bool {
    ["obj", "gltf", "glb", "msh", "ele"].contains(&extension)
}

/// The text of a scene in which the mesh of a file hangs by its highest points: a cloth if it is
/// made of triangles, a solid if it is made of tetrahedra. Files say nothing of their unit: the
/// longest side of the mesh is 2 m.
pub fn scene(path: &Path) -> Result<String, String> {
    let mesh = mesh::load(path, &mut mesh::Reader::new(1))?;
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in &mesh.positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let longest = (0..3).map(|axis| high[axis] - low[axis]);
    let longest = longest.fold(0.0, f64::max);
    let scale = SIDE / longest;
    if !(longest > 0.0 && scale.is_finite() && scale > 0.0) {
        return Err(format!("{}: the mesh has no size", path.display()));
    }
    let at = [0, 1, 2].map(|axis| -0.5 * scale * (low[axis] + high[axis]));
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    // What JSON quotes, TOML reads.
    let file = serde_json::Value::from(&*name);
    let body = if mesh.tetrahedra.is_empty() {
        "# Air pushes its triangles: key d lets the wind blow.\n\
         wind = { velocity = [3, 0, 1.5] }\n\n\
         [[mesh]]\n\
         density = 0.3                   # kg/m2\n\
         stiffness = [120, 10]           # structural, bend, N/m\n\
         damping_ratio = 0.1\n"
    } else {
        "\n[[solid]]\n\
         density = 1000                  # kg/m3\n\
         young = 1e5                     # Pa\n\
         poisson = 0.3\n\
         damping = 0.004                 # s\n"
    };
    Ok(format!(
        "# The mesh of {name}, which hangs by its highest points.\n\n\
         summary = \"a mesh that hangs by its highest points\"\n\
         solver = \"implicit\"\n\
         step = 0.0166666666666667\n\
         gravity = [0, -9.81, 0]\n\
         drag_per_mass = 0.5\n\
         {body}\
         file = {file}\n\
         scale = {scale}\n\
         at = {at:?}\n\
         pin = [{{ at = [\"top\"] }}]\n"
    ))
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
        for (k, [a, b]) in [[2, 4], [4, 3], [3, 7], [7, 5], [5, 6], [6, 2]]
            .iter()
            .enumerate()
        {
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
            assert!(
                integrators::find("v")
                    .unwrap()
                    .check(run.model().system())
                    .is_ok()
            );
        }
    }

    #[test]
    fn meshes_without_size_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("dot.obj");
        std::fs::write(&file, "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n").unwrap();
        let why = Source::find(file.to_str().unwrap()).err().unwrap();
        assert!(why.contains("dot.obj: ") && !why.contains('\n'), "{why}");
        std::fs::write(&file, "nonsense\n").unwrap();
        assert!(Source::find(file.to_str().unwrap()).is_err());
        let gone = folder.path().join("gone.glb");
        let why = Source::find(gone.to_str().unwrap()).err().unwrap();
        assert!(why.contains("gone.glb: it could not be read"), "{why}");
    }
}
