//! How a mesh hangs: which of its points are pinned, how far it falls, and how stiff it is so that
//! it is not drawn into threads.

use std::collections::BTreeSet;

use a3_scenes::Mesh;

/// Height over width up to which a part is level.
const LEVEL: f64 = 0.02;
/// Points as high as the highest one, or as far out at an edge, as a share of the part.
const NEAR: f64 = 0.01;
/// Largest number of points that are pinned.
const MOST_PINS: usize = 20_000;
/// Number of connected parts beyond which each is pinned at one point only.
const MOST_WIDE: usize = 1000;

/// What holds a mesh.
pub struct Hanging {
    /// Pinned points; `None` if they are the highest ones of the whole.
    pub pins: Option<Vec<usize>>,
    /// Number of parts, and of those that hang.
    pub parts: usize,
    pub held: usize,
    /// How far below its lowest point the mesh may fall.
    pub fall: f64,
    /// Stretches of what hangs by its pins.
    pub necks: Vec<Neck>,
}

/// What is between the pinned points of a part and the others.
pub struct Neck {
    /// Area or volume of the part.
    pub size: f64,
    /// Number of edges, and their mean length.
    pub edges: f64,
    pub length: f64,
}

/// Part of a mesh: its points, in order.
struct Part(Vec<usize>);

/// How a mesh hangs whose points are all in triangles or tetrahedra.
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
        if count > MOST_WIDE {
            own.truncate(1);
        }
        if pins.len() + own.len() > MOST_PINS {
            continue;
        }
        held += 1;
        is_top &= !is_level;
        // What is level swings down from its edge.
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
    /// Least and greatest coordinate along an axis.
    fn extent(&self, mesh: &Mesh, axis: usize) -> [f64; 2] {
        let along = self.0.iter().map(|i| mesh.positions[*i][axis]);
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    }

    /// The points by which it hangs, and whether it is level: its highest ones, or those of an
    /// edge.
    fn held(&self, mesh: &Mesh) -> (Vec<usize>, bool) {
        let size = [0, 1, 2]
            .map(|axis| self.extent(mesh, axis))
            .map(|[low, high]| high - low);
        let longest = size.into_iter().fold(0.0, f64::max);
        let end = |axis: usize, is_high: bool| {
            let [low, high] = self.extent(mesh, axis);
            let (at, near) = (if is_high { high } else { low }, NEAR * (high - low));
            let there = self
                .0
                .iter()
                .filter(|i| (mesh.positions[**i][axis] - at).abs() <= near);
            there.copied().collect::<Vec<_>>()
        };
        let is_level = size[1] <= LEVEL * longest;
        let mut held = if is_level {
            // The edge at the back, or at a side of what has no depth.
            end(if size[2] > LEVEL * longest { 2 } else { 0 }, false)
        } else {
            end(1, true)
        };
        if held.len() == self.0.len() {
            held.truncate(1);
        }
        (held, is_level)
    }
}

/// Edges of triangles and tetrahedra.
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

/// The connected parts, by their first points.
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

/// What is between pinned points and others, of each part that has both.
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
