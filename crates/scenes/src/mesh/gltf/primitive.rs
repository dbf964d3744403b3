//! Primitives: the triangles of the nodes, with the morph targets that move their points, and
//! skins, by which joints move them instead of their own nodes.

use std::collections::BTreeMap;
use std::rc::Rc;

use nalgebra::{Matrix4, Point3};

use super::document::{Buffers, Document, Primitive, Target, compressed, item};
use crate::mesh::data::{MAX_POINTS, MAX_TRIANGLES, Mesh};

/// Largest number of points that are read, and moved by targets, counted again for each target.
const MAX_SHIFTS: usize = 16 * MAX_POINTS;

/// Reader of a mesh, node by node.
pub(super) struct Reader<'a> {
    pub(super) document: &'a Document<'a>,
    pub(super) buffers: Buffers<'a>,
    pub(super) mesh: Mesh,
    pub(super) skins: Skins<'a>,
    /// Number of primitives that were visited.
    pub(super) primitives: usize,
    /// Number of points that were read, or moved by targets.
    pub(super) shifts: usize,
}

impl Reader<'_> {
    /// Adds the triangles of nodes and of their descendants, in the order of the file.
    pub(super) fn add(&mut self, roots: &[usize]) -> Result<(), String> {
        let document = self.document;
        for (k, matrix) in document.placed(roots)? {
            let node = &document.nodes[k];
            let Some(mesh) = node.mesh else {
                continue;
            };
            let shapes = item(&document.meshes, mesh, "mesh")?;
            let weights = node.weights.as_ref().unwrap_or(&shapes.weights);
            for primitive in &shapes.primitives {
                self.add_primitive(primitive, weights, node.skin, matrix)?;
            }
        }
        Ok(())
    }

    /// Adds the triangles of a primitive. Points and lines have none.
    fn add_primitive(
        &mut self,
        primitive: &Primitive,
        weights: &[f32],
        skin: Option<usize>,
        matrix: Matrix4<f64>,
    ) -> Result<(), String> {
        let too_many =
            || format!("there are more than {MAX_POINTS} points or {MAX_TRIANGLES} triangles");
        self.primitives += 1;
        refuse!(if self.primitives > MAX_POINTS => "{}", too_many());
        let mode = primitive.mode.unwrap_or(4);
        if mode < 4 {
            return Ok(());
        }
        let accessor = |k: usize| item(&self.document.accessors, k, "accessor");
        let position = primitive.attributes.get("POSITION");
        // A primitive without positions is not drawn.
        let Some(&position) = position else {
            return Ok(());
        };
        let positions = accessor(position)?;
        let count = positions.count;
        let compression = self.document.compression();
        if let Some(extension) = compression.filter(|_| !positions.is_stored()) {
            return Err(compressed(extension));
        }
        refuse!(if count > MAX_POINTS => "{}", too_many());
        // Many primitives may share the points of one accessor.
        self.shifts += count;
        refuse!(if self.shifts > MAX_SHIFTS =>
            "its primitives read points more than {MAX_SHIFTS} times");
        let named = |k: usize| move |why: String| format!("accessor {k}: {why}");
        let points = self.points(position, &primitive.targets, weights)?;
        let count = points.len() as u32;
        let corners = match primitive.indices {
            None => (0..count).collect(),
            Some(k) => {
                let indices = accessor(k)?;
                refuse!(if indices.count > 3 * MAX_TRIANGLES => "{}", too_many());
                self.buffers.indices(indices).map_err(named(k))?
            }
        };
        if let Some(corner) = corners.iter().find(|corner| **corner >= count) {
            return Err(format!(
                "a triangle of primitive {}, counted from 0, has corner {corner} of {count} points",
                self.primitives - 1
            ));
        }
        let triangles: Vec<[u32; 3]> = match mode {
            4 => corners.as_chunks::<3>().0.to_vec(),
            5 => {
                let turned = |(k, t): (usize, &[u32])| [t[0], t[1 + k % 2], t[2 - k % 2]];
                corners.windows(3).enumerate().map(turned).collect()
            }
            6 => {
                let fan = corners.windows(2).skip(1);
                fan.map(|side| [corners[0], side[0], side[1]]).collect()
            }
            _ => return Err(format!("there is no mode {mode} of primitives")),
        };
        refuse!(if triangles.len() > MAX_TRIANGLES - self.mesh.triangles.len() => "{}", too_many());
        let carrier = match skin {
            Some(skin) => {
                let attributes = &primitive.attributes;
                let count = points.len();
                self.skins.carrier(skin, attributes, count, &self.buffers)?
            }
            None => Carrier::Node(matrix),
        };
        // Only points of triangles are added.
        let mut places = vec![u32::MAX; points.len()];
        for t in triangles {
            for i in t.map(|i| i as usize) {
                if places[i] != u32::MAX {
                    continue;
                }
                refuse!(if self.mesh.positions.len() == MAX_POINTS => "{}", too_many());
                places[i] = self.mesh.positions.len() as u32;
                let p = carrier.matrix(i).transform_point(&Point3::from(points[i]));
                self.mesh.positions.push([p.x, p.y, p.z]);
            }
            // A reflection reverses the winding order.
            let matrix = carrier.matrix(t[0] as usize);
            let [a, b, c] = t.map(|i| places[i as usize]);
            let is_mirrored = matrix.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
            let t = if is_mirrored { [a, c, b] } else { [a, b, c] };
            self.mesh.triangles.push(t);
        }
        Ok(())
    }

    /// Reads the points of an accessor, and moves them by targets times their weights.
    fn points(
        &mut self,
        position: usize,
        targets: &[Target],
        weights: &[f32],
    ) -> Result<Vec<[f64; 3]>, String> {
        let read = |k: usize| {
            let accessor = item(&self.document.accessors, k, "accessor")?;
            let read = self.buffers.vectors::<3>(accessor);
            read.map_err(|why| format!("accessor {k}: {why}"))
        };
        let points = read(position)?.into_iter();
        let mut points: Vec<_> = points.map(|p| p.map(f64::from)).collect();
        for (target, weight) in targets.iter().zip(weights) {
            let Some(k) = target.position.filter(|_| *weight != 0.0) else {
                continue;
            };
            let count = item(&self.document.accessors, k, "accessor")?.count;
            refuse!(if count != points.len() =>
                "accessor {k}: it has not one vector for each point");
            self.shifts += count;
            refuse!(if self.shifts > MAX_SHIFTS =>
                "targets move points more than {MAX_SHIFTS} times");
            for (point, shift) in points.iter_mut().zip(read(k)?) {
                for axis in 0..3 {
                    point[axis] += f64::from(*weight) * f64::from(shift[axis]);
                }
            }
        }
        Ok(points)
    }
}

/// Largest number of sets of four joints of a point.
const SETS: usize = 2;

/// Skins of a document, each of which is read when it is first used.
pub(super) struct Skins<'a> {
    document: &'a Document<'a>,
    /// Matrix of each node relative to the scene, once it is computed.
    nodes: Option<BTreeMap<usize, Matrix4<f64>>>,
    /// Matrices of the joints of each skin.
    joints: BTreeMap<usize, Rc<Vec<Matrix4<f64>>>>,
}

/// Transformation of the points of a primitive.
pub(super) enum Carrier {
    Node(Matrix4<f64>),
    Joints {
        matrices: Rc<Vec<Matrix4<f64>>>,
        /// Joints of each point, and their weights.
        sets: Vec<[Vec<[f32; 4]>; 2]>,
    },
}

impl<'a> Skins<'a> {
    pub fn new(document: &'a Document<'a>) -> Self {
        Self { document, nodes: None, joints: BTreeMap::new() }
    }

    /// Reads the joints and weights by which a skin moves `count` points with these attributes.
    pub fn carrier(
        &mut self,
        skin: usize,
        attributes: &BTreeMap<String, usize>,
        count: usize,
        buffers: &Buffers,
    ) -> Result<Carrier, String> {
        let matrices = self.joints(skin, buffers)?;
        let mut sets = vec![];
        for k in 0..SETS {
            let names = [format!("JOINTS_{k}"), format!("WEIGHTS_{k}")];
            let [Some(joints), Some(weights)] = names.each_ref().map(|name| attributes.get(name))
            else {
                break;
            };
            let read = |k: &usize| {
                let accessor = item(&self.document.accessors, *k, "accessor")?;
                refuse!(if accessor.count != count =>
                    "accessor {k}: it has not one vector for each point");
                let read = buffers.vectors::<4>(accessor);
                read.map_err(|why| format!("accessor {k}: {why}"))
            };
            let joints = read(joints)?;
            let there = |j: &f32| *j >= 0.0 && (*j as usize) < matrices.len();
            if !joints.iter().flatten().all(there) {
                let count = matrices.len();
                refuse!("a point has a joint that is not among the {count} of its skin");
            }
            sets.push([joints, read(weights)?]);
        }
        Ok(Carrier::Joints { matrices, sets })
    }

    /// Returns the matrices of the joints of a skin, which take points from the mesh to the scene.
    fn joints(&mut self, skin: usize, buffers: &Buffers) -> Result<Rc<Vec<Matrix4<f64>>>, String> {
        if let Some(known) = self.joints.get(&skin) {
            return Ok(known.clone());
        }
        let document = self.document;
        let of = item(&document.skins, skin, "skin")?;
        let nodes = match self.nodes.take() {
            Some(nodes) => nodes,
            None => trees(document)?,
        };
        let nodes = self.nodes.insert(nodes);
        let mut matrices = vec![];
        for joint in &of.joints {
            let matrix = nodes.get(joint);
            matrices.push(
                *matrix.ok_or_else(|| format!("there is no joint {joint} in a tree of nodes"))?,
            );
        }
        if let Some(k) = of.inverse_bind_matrices {
            let accessor = item(&document.accessors, k, "accessor")?;
            refuse!(if accessor.count < matrices.len() =>
                "accessor {k}: it has not one matrix for each joint");
            let inverse = buffers.vectors::<16>(&accessor.first(matrices.len()));
            let inverse = inverse.map_err(|why| format!("accessor {k}: {why}"))?;
            for (matrix, inverse) in matrices.iter_mut().zip(inverse) {
                *matrix *= Matrix4::from_column_slice(&inverse.map(f64::from));
            }
        }
        let matrices = Rc::new(matrices);
        self.joints.insert(skin, matrices.clone());
        Ok(matrices)
    }
}

/// Returns the matrices of all nodes relative to the scene.
fn trees(document: &Document) -> Result<BTreeMap<usize, Matrix4<f64>>, String> {
    let mut is_below = vec![false; document.nodes.len()];
    for child in document.nodes.iter().flat_map(|node| &node.children) {
        item(&document.nodes, *child, "node")?;
        is_below[*child] = true;
    }
    let roots: Vec<_> = (0..is_below.len()).filter(|k| !is_below[*k]).collect();
    Ok(document.placed(&roots)?.into_iter().collect())
}

impl Carrier {
    /// Returns the matrix that moves point i.
    pub fn matrix(&self, i: usize) -> Matrix4<f64> {
        let (matrices, sets) = match self {
            Self::Node(matrix) => return *matrix,
            Self::Joints { matrices, sets } => (matrices, sets),
        };
        let (mut sum, mut matrix) = (0.0, Matrix4::zeros());
        for [joints, weights] in sets {
            for (joint, weight) in joints[i].iter().zip(weights[i]) {
                let weight = f64::from(weight);
                sum += weight;
                matrix += matrices[*joint as usize] * weight;
            }
        }
        // Weights are rounded, so their sum is not exactly 1. A point without weights stays where
        // it is.
        if sum > 0.0 { matrix / sum } else { Matrix4::identity() }
    }
}
