//! Solids within closed meshes: points inside, nearest points, and which meshes are closed.

use a3_core::contact::{ClosedMesh, Obstacle, Shape, Step, resolve};
use a3_core::{Path, Vector3};

/// An L, 1 m thick: a square of 2 m without its upper right quarter.
fn l() -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let outline = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]].map(|p| p.map(f64::from));
    let at = |z: f64| outline.map(|[x, y]| Vector3::new(x, y, z));
    let points = [at(0.0), at(1.0)].concat();
    let front = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    let sides = (0..6).flat_map(|i| {
        let j = (i + 1) % 6;
        [[i, j, j + 6], [i, j + 6, i + 6]]
    });
    let triangles = front.iter().flat_map(|t| {
        let [a, b, c] = *t;
        [[a, c, b], t.map(|i| i + 6)]
    });
    (points, triangles.chain(sides).collect())
}

/// Distance from a point inside the L to the nearest of its faces, from its six sides and the inner
/// edge.
fn depth(p: Vector3<f64>) -> f64 {
    let inner = if p.x > 1.0 {
        1.0 - p.y
    } else if p.y > 1.0 {
        1.0 - p.x
    } else {
        (1.0 - p.x).hypot(1.0 - p.y)
    };
    let least = p.x.min(2.0 - p.x).min(p.y).min(2.0 - p.y);
    least.min(p.z).min(1.0 - p.z).min(inner)
}

/// Also in a mesh whose triangles all have the wrong orientation, and also a rotated one.
#[test]
fn what_is_inside_is_put_on_the_nearest_point_of_the_surface() {
    let (points, triangles) = l();
    let inverse = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    for triangles in [triangles, inverse] {
        let mesh = ClosedMesh::new(points.clone(), triangles).unwrap();
        let solid = Obstacle::smooth(Shape::Mesh(mesh.into()), Path::Still(Vector3::zeros()));
        let mut inside = 0;
        for k in 0..27_000 {
            let step = |k: i32| f64::from(k % 30) * 0.083 - 0.2;
            let p = Vector3::new(step(k), step(k / 30), 0.6 * step(k / 900));
            let mut y = [p.x, p.y, p.z, 0.0, 0.0, 0.0];
            let step = Step { t: 0.0, h: 0.1, y0: &[] };
            let met = resolve(std::slice::from_ref(&solid), &[1.0], &step, &mut y).contacts > 0;
            let within = p.iter().all(|x| *x > 0.0)
                && p.x < 2.0
                && p.y < 2.0
                && p.z < 1.0
                && (p.x < 1.0 || p.y < 1.0);
            assert_eq!(met, within, "{p}");
            let moved = (Vector3::from_column_slice(&y[..3]) - p).norm();
            let expected = if within { depth(p) } else { 0.0 };
            assert!((moved - expected).abs() < 1e-14, "{p}: {moved} {expected}");
            inside += u32::from(met);
        }
        assert!(inside > 5000, "{inside}");
    }
}

#[test]
fn an_open_mesh_is_refused_with_the_edge_that_is_open() {
    let said = |change: &dyn Fn(&mut Vec<[u32; 3]>)| {
        let (points, mut triangles) = l();
        change(&mut triangles);
        ClosedMesh::new(points, triangles).unwrap_err().to_string()
    };
    let open = said(&|triangles| {
        triangles.remove(0);
    });
    let ends = "from point 0 at (0, 0, 0) to point 1 at (2, 0, 0)";
    assert!(open.contains(ends) && open.ends_with("not 1"), "{open}");
    let turned = said(&|triangles| triangles[0].swap(0, 1));
    assert!(turned.contains(ends) && turned.ends_with("sides"), "{turned}");
    assert!(said(&|triangles| triangles.push(triangles[0])).ends_with("not 3"));
    assert!(said(&|triangles| triangles[3][1] = 12).contains("no corner 12"));
    assert!(said(&Vec::clear).contains("1 to 200000 triangles, not 0"));
}
