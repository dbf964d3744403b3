//! Skins: meshes that are moved by joints instead of by their own nodes.

use std::collections::BTreeMap;
use std::rc::Rc;

use nalgebra::Matrix4;

use super::accessor::Buffers;
use super::document::{Document, item};

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
        Self {
            document,
            nodes: None,
            joints: BTreeMap::new(),
        }
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
                if accessor.count != count {
                    return Err(format!(
                        "accessor {k}: it has not one vector for each point"
                    ));
                }
                let read = buffers.vectors::<4>(accessor);
                read.map_err(|why| format!("accessor {k}: {why}"))
            };
            let joints = read(joints)?;
            let there = |j: &f32| *j >= 0.0 && (*j as usize) < matrices.len();
            if !joints.iter().flatten().all(there) {
                let count = matrices.len();
                return Err(format!(
                    "a point has a joint that is not among the {count} of its skin"
                ));
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
            if accessor.count < matrices.len() {
                return Err(format!(
                    "accessor {k}: it has not one matrix for each joint"
                ));
            }
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
        if sum > 0.0 {
            matrix / sum
        } else {
            Matrix4::identity()
        }
    }
}
