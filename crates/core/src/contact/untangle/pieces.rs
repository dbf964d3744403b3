//! The pieces into which crossings cut surfaces.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use nalgebra::Vector3;

use super::hit::Hit;
use super::skeleton::Skeleton;
use crate::sets::Sets;

/// The pieces into which crossings cut surfaces.
pub(super) struct Pieces {
    /// The piece of each vertex, by its smallest vertex.
    pub of: Vec<u32>,
    /// Lengths of all edges of each piece (m), of cut ones in part.
    pub sizes: Vec<f64>,
    /// Distance of each vertex from the border, along edges that are not cut (m); infinite if there
    /// is none.
    pub depths: Vec<f64>,
}

impl Pieces {
    /// Cuts surfaces with vertices at these places (m).
    pub fn cut(skeleton: &Skeleton, hits: &[Hit], at: &[Vector3<f64>]) -> Self {
        let mut cuts = BTreeMap::new();
        for hit in hits {
            let [first, last] = cuts.entry(hit.edge).or_insert([1.0_f64, 0.0_f64]);
            (*first, *last) = (first.min(hit.share), last.max(hit.share));
        }
        let mut sets = Sets::new(at.len());
        for (k, [a, b]) in skeleton.edges.iter().enumerate() {
            if !cuts.contains_key(&k) {
                sets.join(*a, *b);
            }
        }
        let of: Vec<_> = (0..at.len() as u32).map(|i| sets.find(i)).collect();
        let mut sizes = vec![0.0; at.len()];
        for (k, ends) in skeleton.edges.iter().enumerate() {
            let [a, b] = ends.map(|i| i as usize);
            let length = (at[a] - at[b]).norm();
            let [first, last] = cuts.get(&k).copied().unwrap_or([0.5; 2]);
            sizes[of[a] as usize] += length * first;
            sizes[of[b] as usize] += length * (1.0 - last);
        }
        let is_cut = |edge: u32| cuts.contains_key(&(edge as usize));
        Self {
            of,
            sizes,
            depths: depths(skeleton, is_cut, at),
        }
    }
}

/// Computes distances (m) from the border along edges that are not cut (Dijkstra).
fn depths(skeleton: &Skeleton, is_cut: impl Fn(u32) -> bool, at: &[Vector3<f64>]) -> Vec<f64> {
    let mut depths = vec![f64::INFINITY; at.len()];
    // Numbers that are not negative have the order of their bits.
    let mut queue = BinaryHeap::new();
    for i in &skeleton.border {
        depths[*i as usize] = 0.0;
        queue.push((Reverse(0), *i));
    }
    while let Some((Reverse(bits), i)) = queue.pop() {
        let depth = f64::from_bits(bits);
        if depth > depths[i as usize] {
            continue;
        }
        for (j, edge) in &skeleton.neighbours[i as usize] {
            let there = depth + (at[i as usize] - at[*j as usize]).norm();
            if there < depths[*j as usize] && !is_cut(*edge) {
                depths[*j as usize] = there;
                queue.push((Reverse(there.to_bits()), *j));
            }
        }
    }
    depths
}
