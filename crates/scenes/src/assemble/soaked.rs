//! Points of rigid bodies that a fluid touches: particles of the fluid that the body carries.

use a3_core::Vector3;
use a3_core::rigid::Part;

use super::places::LAYERS;
use crate::check::{at, positive};
use crate::description::Fluid;
use crate::fault::Fault;

/// Largest number of points of the lattice around a body.
const MAX_POINTS: f64 = 500_000.0;
/// Differences of distances that count as none, as a share of the spacing.
const SAME: f64 = 1e-6;

/// Lists the points of a body of a volume (m3) that a fluid touches, relative to the body's origin
/// (m): those of a lattice of the fluid's spacing around the middle of its parts, up to a few
/// layers below its surface. There are as many as the volume has cells, so that the body displaces
/// its volume. In two dimensions, the points in the plane of the origin and in the parts are taken.
pub(super) fn soaked(
    parts: &[Part],
    volume: f64,
    fluid: &Fluid,
) -> Result<Vec<Vector3<f64>>, Fault> {
    let spacing = fluid.spacing;
    at("spacing", positive("it", spacing)).map_err(|fault| fault.within("fluid"))?;
    let (low, high) = bounds(parts);
    let size = high - low;
    let flat = fluid.dimensions == 2;
    // A cell more on each side, half of which is outside if the count is odd.
    let counts = size.map(|size| (size / spacing).round() + 2.0);
    let counts = Vector3::new(counts.x, counts.y, if flat { 1.0 } else { counts.z });
    if counts.product() > MAX_POINTS {
        let why = format!(
            "the fluid's spacing {spacing} is too fine for this body, which is {} x {} x {} m large",
            size.x, size.y, size.z
        );
        return Err(Fault::new("parts", why));
    }
    let first = 0.5 * (low + high) - 0.5 * spacing * (counts - Vector3::repeat(1.0));
    let first = if flat {
        Vector3::new(first.x, first.y, 0.0)
    } else {
        first
    };
    let [nx, ny, nz] = [counts.x, counts.y, counts.z].map(|count| count as usize);
    let all = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])));
    let near = all.map(|index| {
        let place = first + spacing * Vector3::from(index.map(|i| i as f64));
        let distances = parts
            .iter()
            .map(|part| part.shape.distance(place - part.at));
        (place, distances.fold(f64::INFINITY, f64::min))
    });
    let mut near: Vec<_> = near.filter(|(_, distance)| *distance < spacing).collect();
    let outermost = if flat {
        0.0
    } else {
        outermost(&near, (volume / spacing.powi(3)).round() as usize, spacing)
    };
    near.retain(|(_, distance)| *distance < outermost);
    let deepest = outermost.min(0.0) - f64::from(LAYERS) * spacing;
    let shell = near.into_iter().filter(|(_, distance)| *distance > deepest);
    Ok(shell.map(|(place, _)| place).collect())
}

/// Returns the distance (m) from the surface below which about `count` of the places lie. Places at
/// the same distance stay together, so that symmetric bodies have symmetric points.
fn outermost(places: &[(Vector3<f64>, f64)], count: usize, spacing: f64) -> f64 {
    let mut distances: Vec<_> = places.iter().map(|(_, distance)| *distance).collect();
    distances.sort_by(f64::total_cmp);
    let Some(last) = distances.get(count.saturating_sub(1)) else {
        return spacing;
    };
    let edges = [-SAME, SAME].map(|by| last + by * spacing);
    let counts = edges.map(|edge| distances.partition_point(|d| *d < edge));
    let is_nearer_below = count - counts[0].min(count) < counts[1] - count.min(counts[1]);
    edges[usize::from(!is_nearer_below)]
}

/// Returns the least and the largest coordinates of all parts (m).
fn bounds(parts: &[Part]) -> (Vector3<f64>, Vector3<f64>) {
    let around = Vector3::repeat(f64::INFINITY);
    parts.iter().fold((around, -around), |bounds, part| {
        let simplices = part.shape.simplices();
        let radius = Vector3::repeat(simplices.radius);
        simplices.points.iter().fold(bounds, |(low, high), point| {
            let at = part.at + point;
            (low.inf(&(at - radius)), high.sup(&(at + radius)))
        })
    })
}
