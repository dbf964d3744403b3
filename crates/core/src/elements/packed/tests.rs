//! Tests of packed springs against the same springs one by one.

use pulp::{Scalar, WithSimd};

use super::blocks::Columns;
use super::*;
use crate::coupling::Coupling;
use crate::elements::axial::{add_all, add_differential, coupling};
use crate::geometry::Triangles;
use crate::random::SplitMix;
use crate::spring::{SpringKind, SpringLaw};

/// Returns springs between random particles whose numbers differ by at most `reach`.
fn springs(count: usize, particles: usize, reach: usize, damping: f64) -> Vec<Spring> {
    let mut random = SplitMix(5);
    let mut below = |most: usize| random.between(0.0, most as f64) as usize;
    let ends: Vec<_> = (0..count)
        .map(|_| {
            let i = below(particles - 1);
            let j = i + 1 + below(reach.min(particles - 1 - i));
            if below(2) == 0 { [i, j] } else { [j, i] }
        })
        .collect();
    let mut number = || random.between(0.5, 2.0);
    let law = |[i, j]: [usize; 2]| Spring {
        i,
        j,
        kind: SpringKind::Structural,
        law: SpringLaw {
            stiffness: 100.0 * number(),
            rest_length: number(),
            damping: damping * number(),
        },
    };
    ends.into_iter().map(law).collect()
}

/// Returns springs from each particle to the next and to the one `reach` further, except some that
/// are missing, and some twice between the same particles.
fn rows(reach: usize, particles: usize, damping: f64) -> Vec<Spring> {
    let starts = (0..particles).filter(|i| i % 11 != 3);
    let next = starts.flat_map(|i| [(i, i + 1), (i + reach, i), (i, i + reach + 1)]);
    let ends = next.filter(|(i, j)| reach > 0 && (*i).max(*j) < particles);
    let twice = springs(100, particles, 1, damping).into_iter().take(20 * reach);
    let spring = |(number, (i, j))| Spring {
        i,
        j,
        kind: SpringKind::Structural,
        law: SpringLaw { stiffness: 1.0 + (number % 7) as f64, rest_length: 0.5, damping },
    };
    ends.enumerate().map(spring).chain(twice).collect()
}

fn numbers(count: usize, seed: u64) -> Vec<f64> {
    let mut random = SplitMix(seed);
    (0..count).map(|_| random.between(-1.0, 1.0)).collect()
}

/// Returns the largest difference of two vectors, over the largest number of the first.
fn off(a: &[f64], b: &[f64]) -> f64 {
    let size = a.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
    let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    apart.fold(0.0, f64::max) / size
}

/// Returns the forces, their differential, and products with a clamped matrix and with one that is
/// not, computed in `bands` bands.
fn in_bands(packed: &Packed, bands: usize, all: &[Vec<f64>; 4]) -> [Vec<f64>; 4] {
    let [x, v, dx, dv] = all.each_ref().map(|a| Some(a.as_slice()));
    let product = |clamped| Quantity::product(&matrix(&all[0], clamped));
    [
        (Quantity::Forces, [x, v, None, None]),
        (Quantity::Differential, [x, v, dx, dv]),
        (product(true), [x, None, dx, None]),
        (product(false), [x, None, dx, None]),
    ]
    .map(|(quantity, fields)| {
        let mut f = vec![0.0; all[0].len()];
        packed.add_in(bands, Task { quantity, fields }, &mut f);
        f
    })
}

fn matrix(x: &[f64], clamped: bool) -> Matrix<'_> {
    Matrix { x, stiffness: 0.49, damping: 0.7, clamped, masses: &[], free: &[] }
}

/// Adds the part of a spring in a product, from its coupling.
fn add_product(spring: &Spring, matrix: &Matrix, p: &[f64], out: &mut [f64]) {
    let Coupling::Axial(c) = coupling(spring, matrix.x, matrix.clamped) else {
        unreachable!("a spring couples along its direction");
    };
    let (n, [a2, a]) = (p.len() / 3, [matrix.stiffness, matrix.damping]);
    let apart: [f64; 3] = std::array::from_fn(|axis| p[axis * n + c.i] - p[axis * n + c.j]);
    let along: f64 = (0..3).map(|axis| c.direction[axis] * apart[axis]).sum();
    let turned = (a2 * (c.along - c.across) + a * c.damping) * along;
    for axis in 0..3 {
        let part = a2 * c.across * apart[axis] + turned * c.direction[axis];
        out[axis * n + c.i] += part;
        out[axis * n + c.j] -= part;
    }
}

#[test]
#[cfg_attr(miri, ignore = "takes hours there")]
fn blocks_are_the_sum_of_springs_one_by_one_and_bands_change_no_bit() {
    for (dense, count, particles, reach) in [
        (0, 1024, 40, 40),
        (0, 1025, 5000, 5000),
        (0, 4000, 1500, 10),
        (0, 9000, 3000, 300),
        (5, 0, 400, 0),
        (7, 9000, 3000, 300),
        // A reach as long as a panel, which then ends before a band starts.
        (0, 20_000, 9000, 2048),
        (70, 0, 1300, 0),
    ] {
        for damping in [0.0, 3.0] {
            let mut springs = springs(count, particles, reach, damping);
            springs.extend(rows(dense, particles, damping));
            let what = format!("{dense} {count} {particles} {damping}");
            let mut all: [Vec<f64>; 4] =
                std::array::from_fn(|seed| numbers(3 * particles, seed as u64));
            // A spring of length 0.
            let Spring { i, j, .. } = springs[7];
            for axis in 0..3 {
                all[0][axis * particles + i] = all[0][axis * particles + j];
            }
            let at = At {
                t: 0.0,
                x: &all[0],
                v: &all[1],
                masses: &[],
                triangles: &Triangles::default(),
            };
            let mut expected = [(); 4].map(|()| vec![0.0; 3 * particles]);
            add_all(&springs, at.x, at.v, &mut expected[0]);
            for spring in &springs {
                add_differential(spring, &at, [&all[2], &all[3]], &mut expected[1]);
                for (k, clamped) in [(2, true), (3, false)] {
                    add_product(spring, &matrix(at.x, clamped), &all[2], &mut expected[k]);
                }
            }
            let packed = Packed::new(&springs).unwrap();
            let found = in_bands(&packed, 1, &all);
            for (expected, found) in expected.iter().zip(&found) {
                assert!(off(expected, found) < 1e-13, "{what}");
            }
            for bands in [2, 3, 8] {
                assert!(in_bands(&packed, bands, &all) == found, "{what}: {bands}");
            }
            let fields = all.each_ref().map(|a| Some(a.as_slice()));
            let [by_vectors, one_by_one] = [true, false].map(|has_vectors| {
                let (mut window, [runs, blocks]) = (TileWindow::default(), packed.order.of_tile(0));
                window.take(&packed.order, 0, &fields);
                assert_eq!(runs.is_empty(), dense == 0, "{what}");
                if !runs.is_empty() {
                    let sum = packed.sum_of_runs(&mut window, runs, 0, Quantity::Differential);
                    run(sum, has_vectors);
                }
                if !blocks.is_empty() {
                    let sum = packed.sum_of_blocks(&mut window, blocks, 0, Quantity::Differential);
                    run(sum, has_vectors);
                }
                let size = 3 * packed.order.window();
                let columns = window.columns.each_ref().map(Columns::get);
                let columns = columns.map(|all| all.get(..size).map(<[f64]>::to_vec));
                (columns, window.rows)
            });
            assert!(by_vectors == one_by_one, "{what}: one by one");
        }
    }
}

fn run(sum: impl WithSimd<Output = ()>, has_vectors: bool) {
    if has_vectors {
        Arch::new().dispatch(sum);
    } else {
        sum.with_simd(Scalar::new());
    }
}

#[test]
fn few_springs_are_not_packed() {
    assert!(Packed::new(&springs(MIN_SPRINGS - 1, 50, 50, 0.0)).is_none());
    assert!(Packed::new(&springs(MIN_SPRINGS, 50, 50, 0.0)).is_some());
}
