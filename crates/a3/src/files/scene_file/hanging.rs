//! How a mesh hangs: the points that are pinned, the depth of its fall, and the sizes from which
//! its stiffness is chosen.

use std::collections::BTreeSet;

use a3_scenes::Mesh;

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
        let width = [0, 2]
            .map(|axis| part.extent(mesh, axis))
            .map(|[a, b]| b - a);
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
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    }

    /// Returns the points by which the part hangs, and whether it is level: a level part hangs by
    /// an edge, any other by its highest points.
    fn held(&self, mesh: &Mesh) -> (Vec<usize>, bool) {
        let size = [0, 1, 2]
            .map(|axis| self.extent(mesh, axis))
            .map(|[low, high]| high - low);
        let longest = size.into_iter().fold(0.0, f64::max);
        let end = |axis: usize, is_high: bool| {
            let [low, high] = self.extent(mesh, axis);
            let (at, near) = (
                if is_high { high } else { low },
                PIN_DISTANCE * (high - low),
            );
            let there = self
                .0
                .iter()
                .filter(|i| (mesh.positions[**i][axis] - at).abs() <= near);
            there.copied().collect::<Vec<_>>()
        };
        let is_level = size[1] <= MAX_LEVEL_HEIGHT * longest;
        let mut held = if is_level {
            // The edge at the back, or one at the side if the part has no depth.
            end(
                if size[2] > MAX_LEVEL_HEIGHT * longest {
                    2
                } else {
                    0
                },
                false,
            )
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
    let triangles = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
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
    let at = |i: u32| mesh.positions[i as usize];
    let minus = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] - b[k]);
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut necks: Vec<_> = parts
        .iter()
        .map(|_| Neck {
            size: 0.0,
            edges: 0.0,
            length: 0.0,
        })
        .collect();
    for &[a, b, c, d] in &mesh.tetrahedra {
        let sides = [b, c, d].map(|i| minus(at(i), at(a)));
        let volume = dot(cross(sides[0], sides[1]), sides[2]).abs() / 6.0;
        necks[part_of[a as usize]].size += volume;
    }
    if mesh.tetrahedra.is_empty() {
        for &[a, b, c] in &mesh.triangles {
            let normal = cross(minus(at(b), at(a)), minus(at(c), at(a)));
            necks[part_of[a as usize]].size += 0.5 * dot(normal, normal).sqrt();
        }
    }
    let between =
        edges(mesh).filter(|ends| ends.iter().filter(|i| is_pinned[**i as usize]).count() == 1);
    let between: BTreeSet<_> = between.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    for [a, b] in between {
        let neck = &mut necks[part_of[a as usize]];
        let along = minus(at(b), at(a));
        neck.edges += 1.0;
        neck.length += dot(along, along).sqrt();
    }
    necks.retain(|neck| neck.edges > 0.0);
    for neck in &mut necks {
        neck.length /= neck.edges;
    }
    necks
}
