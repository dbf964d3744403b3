//! Sharp edges of closed surfaces.

use a3_core::Vector3;
use a3_render::Topology;

/// Cosine of the largest angle between the normals of two triangles that are smooth at their common
/// point (40 degrees).
const MIN_COSINE: f64 = 0.766;

/// Splits the points at which the surface has a sharp edge. `places` are the places of the points
/// at rest (m), `None` for those of surfaces that have no sharp edges, such as cloth.
pub fn split(topology: &mut Topology, places: &[Option<Vector3<f64>>]) {
    let normal = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|i| places[i as usize]);
        let (a, b, c) = (a?, b?, c?);
        (b - a).cross(&(c - a)).try_normalize(0.0)
    };
    let normals: Vec<_> = topology.triangles.iter().map(normal).collect();
    let mut corners: Vec<_> = (0..topology.triangles.len())
        .filter(|t| normals[*t].is_some())
        .flat_map(|t| (0..3).map(move |k| (t, k)))
        .collect();
    corners.sort_by_key(|(t, k)| topology.triangles[*t][*k]);
    let of = |(t, k): &(usize, usize)| topology.triangles[*t][*k];
    let around: Vec<Vec<_>> = corners
        .chunk_by(|a, b| of(a) == of(b))
        .map(<[_]>::to_vec)
        .collect();
    for corners in around {
        let smooth = |a: usize, b: usize| match (normals[a], normals[b]) {
            (Some(a), Some(b)) => a.dot(&b) > MIN_COSINE,
            _ => false,
        };
        let groups = groups(corners.len(), |a, b| smooth(corners[a].0, corners[b].0));
        if groups.iter().all(|group| *group == 0) {
            continue;
        }
        let (t, k) = corners[0];
        let point = topology.triangles[t][k];
        let first = topology.points + topology.splits.len();
        let count = groups.iter().max().map_or(0, |last| last + 1);
        topology.splits.extend(std::iter::repeat_n(point, count));
        for ((t, k), group) in corners.into_iter().zip(groups) {
            topology.triangles[t][k] = (first + group) as u32;
        }
    }
}

/// Returns the number of the group of each of `count` items: those that are joined, also by way of
/// others, are in one group. Groups are numbered from 0 in the order of their first items.
fn groups(count: usize, joined: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let mut of = vec![usize::MAX; count];
    let mut next = 0;
    for start in 0..count {
        if of[start] != usize::MAX {
            continue;
        }
        let mut open = vec![start];
        of[start] = next;
        while let Some(item) = open.pop() {
            for (other, group) in of.iter_mut().enumerate() {
                if *group == usize::MAX && joined(item, other) {
                    *group = next;
                    open.push(other);
                }
            }
        }
        next += 1;
    }
    of
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a roof of two slopes, at an angle of 90 degrees or nearly flat.
    fn roof(height: f64) -> Topology {
        let places = [
            [-1.0, 0.0, 0.0],
            [-1.0, 0.0, 1.0],
            [0.0, height, 0.0],
            [0.0, height, 1.0],
            [1.0, 0.0, 0.0],
            [1.0, 0.0, 1.0],
        ];
        let places = places.map(|place| Some(Vector3::from(place)));
        let mut topology = Topology {
            points: 6,
            triangles: vec![[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]],
            ..Topology::default()
        };
        split(&mut topology, &places);
        topology
    }

    #[test]
    fn points_are_split_at_sharp_edges_only() {
        let flat = roof(0.1);
        assert_eq!(flat.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]]);
        assert_eq!(flat.splits, [0; 0]);
        let steep = roof(1.0);
        assert_eq!(steep.splits, [2, 2, 3, 3]);
        assert_eq!(
            steep.triangles,
            [[0, 1, 6], [6, 1, 8], [7, 9, 4], [4, 9, 5]]
        );
    }

    #[test]
    fn surfaces_without_places_stay_whole() {
        let mut topology = roof(1.0);
        let triangles = vec![[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]];
        (topology.triangles, topology.splits) = (triangles.clone(), vec![]);
        split(&mut topology, &[None; 6]);
        assert_eq!((topology.triangles, topology.splits), (triangles, vec![]));
    }
}
