//! Nearest points of the surfaces of obstacles, in the obstacle's own frame.

use nalgebra::Vector3;

/// Nearest point of a surface (m), and the unit normal there.
pub(crate) struct Nearest {
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
}

/// Separation of a point from a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Separation {
    /// Distance from the surface (m), below 0 inside.
    pub distance: f64,
    /// Direction in which the distance grows fastest: a unit vector.
    pub normal: Vector3<f64>,
}

/// Returns the nearest point of a sphere around the origin to a point d inside it; for its centre,
/// the point in the direction of `aside`.
pub(crate) fn of_sphere(
    d: Vector3<f64>,
    radius: f64,
    aside: impl Fn() -> Vector3<f64>,
) -> Option<Nearest> {
    let squared = d.x * d.x + d.y * d.y + d.z * d.z;
    if squared < radius * radius {
        let distance = squared.sqrt();
        let normal = if distance > 0.0 {
            d / distance
        } else {
            aside()
        };
        Some(Nearest {
            point: radius * normal,
            normal,
        })
    } else {
        None
    }
}

/// Returns the nearest point of a box around the origin to a point d inside it: on the nearest
/// face.
pub(crate) fn of_box(
    d: Vector3<f64>,
    half_extents: Vector3<f64>,
    axes: [Vector3<f64>; 3],
) -> Option<Nearest> {
    let local = axes.map(|axis| axis.dot(&d));
    let depth = |k: usize| half_extents[k] - local[k].abs();
    if !(0..3).all(|k| depth(k) > 0.0) {
        return None;
    }
    let k = (1..3).fold(
        0,
        |k, other| if depth(other) < depth(k) { other } else { k },
    );
    let normal = if local[k] < 0.0 { -axes[k] } else { axes[k] };
    Some(Nearest {
        point: d + normal * depth(k),
        normal,
    })
}

/// Returns the nearest point of a capsule to a point d inside it.
pub(crate) fn of_capsule(
    d: Vector3<f64>,
    [a, b]: [Vector3<f64>; 2],
    radius: f64,
) -> Option<Nearest> {
    let axis = b - a;
    let squared = axis.norm_squared();
    let share = if squared > 0.0 {
        ((d - a).dot(&axis) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let middle = a + share * axis;
    let Nearest { point, normal } = of_sphere(d - middle, radius, || upwards(axis))?;
    Some(Nearest {
        point: middle + point,
        normal,
    })
}

/// Returns the nearest point of a floor at height 0 to a point d below it.
pub(crate) fn of_floor(d: Vector3<f64>) -> Option<Nearest> {
    (d.y < 0.0).then(|| Nearest {
        point: Vector3::new(d.x, 0.0, d.z),
        normal: Vector3::y(),
    })
}

/// Returns the unit vector perpendicular to an axis that points upwards most steeply; along x if
/// the axis is vertical.
fn upwards(axis: Vector3<f64>) -> Vector3<f64> {
    let squared = axis.norm_squared();
    if squared == 0.0 {
        return Vector3::y();
    }
    [Vector3::y(), Vector3::x()]
        .into_iter()
        .map(|e| e - axis * (axis.dot(&e) / squared))
        .find(|across| across.norm_squared() > 1e-6)
        .map_or(Vector3::y(), |across| across.normalize())
}
