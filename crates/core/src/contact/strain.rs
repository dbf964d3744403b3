//! Limit of strain: after a step, springs longer than a multiple of their rest lengths are
//! shortened to that multiple by impulses along them (Provot, *Deformation constraints in a
//! mass-spring model to describe rigid cloth behavior*, 1995; Bridson, Fedkiw, Anderson, *Robust
//! treatment of collisions, contact and friction for cloth animation*, 2002).
//!
//! An impulse moves the two ends of a spring by w dx, where w is the inverse mass, in opposite
//! directions: momentum is conserved. Springs follow one another in sweeps, over-relaxed, until
//! none is too long by more than a small tolerance. Corrections of a sweep travel only from one
//! spring to the next, so each sweep begins with tethers: no particle may be farther from the
//! nearest pin than the sum of the longest lengths of the springs between them (Kim, Chentanez,
//! Mueller-Fischer, *Long range attachments*, 2012). If springs are within their limits, tethers
//! are too.
//!
//! The velocities change by dx / h in a step of h. All limits together are a convex set, so a
//! motion that started within them loses kinetic energy, apart from the work of pins. Another
//! motion could gain some: then the change of velocity is reduced until it does not.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Largest number of sweeps in a step.
const MAX_SWEEPS: usize = 10;
/// Excess length, over the longest length, at which the sweeps end.
const TOLERANCE: f64 = 5e-4;
/// Over-relaxation factor of each correction of a spring: corrections of adjacent springs partly
/// undo one another.
const RELAXATION: f64 = 1.7;

/// Springs with the same limit: `count` springs from i + k to j + k.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SpringRun {
    i: usize,
    j: usize,
    count: usize,
    longest: f64,
}

/// Largest distance of a particle from a pin.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tether {
    pin: usize,
    particle: usize,
    longest: f64,
}

/// Longest lengths of springs, and of tethers to pins.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StrainLimit {
    rows: Vec<SpringRun>,
    tethers: Vec<Tether>,
}

/// Result of a limit of strain after a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Strained {
    /// Largest length of a spring over its longest length, less 1; 0 if none was too long.
    pub excess: f64,
    /// Number of sweeps over the springs.
    pub sweeps: usize,
}

impl StrainLimit {
    /// Creates the limit of these springs, each given by the particles at its ends and its longest
    /// length (m). The inverse masses (1/kg) are 0 for pinned particles.
    #[must_use]
    pub fn new(
        springs: impl IntoIterator<Item = ([usize; 2], f64)>,
        inverse_masses: &[f64],
    ) -> Self {
        let mut rows: Vec<SpringRun> = vec![];
        for ([i, j], longest) in springs {
            if inverse_masses[i] + inverse_masses[j] == 0.0 {
                continue;
            }
            match rows.last_mut() {
                Some(row)
                    if [row.i + row.count, row.j + row.count] == [i, j]
                        && row.longest == longest =>
                {
                    row.count += 1;
                }
                _ => rows.push(SpringRun { i, j, count: 1, longest }),
            }
        }
        let tethers = tethers(&rows, inverse_masses);
        Self { rows, tethers }
    }

    /// Returns the largest length of a spring at x (m) over its longest length, less 1; 0 if none
    /// is too long.
    #[must_use]
    pub fn excess(&self, x: &[f64]) -> f64 {
        let n = x.len() / 3;
        let of_row = |row: &SpringRun| {
            let axes = [0, n, 2 * n].map(|axis| {
                let (i, j) = (axis + row.i, axis + row.j);
                (&x[i..i + row.count], &x[j..j + row.count])
            });
            let mut largest = 0.0;
            for k in 0..row.count {
                let [a, b, c] = axes.map(|(i, j)| j[k] - i[k]);
                let squared = a * a + b * b + c * c;
                largest = if squared > largest { squared } else { largest };
            }
            if largest > row.longest * row.longest {
                largest.sqrt() / row.longest - 1.0
            } else {
                0.0
            }
        };
        self.rows.iter().map(of_row).fold(0.0, f64::max)
    }
}

/// Phase that limits the strain of a run, with its scratch.
#[derive(Clone, Debug, Default)]
pub struct StrainLimiter {
    /// Sums of impulses times the step on each particle (kg m), pins included.
    moments: Vec<f64>,
}

impl StrainLimiter {
    /// Creates a phase with room for states of length `dim`.
    #[must_use]
    pub fn new(dim: usize) -> Self {
        Self { moments: Vec::with_capacity(dim / 2) }
    }

    /// Shortens springs that are too long in y1 = [x | v], the end of a step of h (s), and changes
    /// the velocities accordingly. Changes nothing if none is too long, and no pinned particle,
    /// whose inverse mass (1/kg) is 0.
    pub fn resolve(
        &mut self,
        limit: &StrainLimit,
        inverse_masses: &[f64],
        h: f64,
        y1: &mut [f64],
    ) -> Strained {
        let n = inverse_masses.len();
        let (x, v) = y1.split_at_mut(3 * n);
        let mut strained = Strained { excess: limit.excess(x), sweeps: 0 };
        if strained.excess <= 0.0 {
            return strained;
        }
        self.moments.clear();
        self.moments.resize(3 * n, 0.0);
        let mut ends = RunEnds { x, moments: &mut self.moments, inverse_masses };
        while strained.sweeps < MAX_SWEEPS {
            strained.sweeps += 1;
            for tether in &limit.tethers {
                ends.shorten([tether.pin, tether.particle], tether.longest, 1.0);
            }
            let mut excess: f64 = 0.0;
            // A sheet is listed from its first row on, by which it often hangs: in reverse order,
            // the corrections of the other rows arrive there in one sweep.
            for row in limit.rows.iter().rev() {
                for k in (0..row.count).rev() {
                    let over = ends.shorten([row.i + k, row.j + k], row.longest, RELAXATION);
                    excess = excess.max(over / row.longest);
                }
            }
            if excess <= TOLERANCE {
                break;
            }
        }
        self.change_velocities(inverse_masses, h, v);
        strained
    }

    /// Adds the changes of position over h (s) to the velocities, or as large a part of them that
    /// the kinetic energy does not grow by more than the work of pins.
    fn change_velocities(&self, inverse_masses: &[f64], h: f64, v: &mut [f64]) {
        let n = inverse_masses.len();
        // The energy grows by a s / h + b s^2 / (2 h^2) for the share s of the changes.
        let (mut a, mut b) = (0.0, 0.0);
        for (v, p) in v.chunks_exact(n).zip(self.moments.chunks_exact(n)) {
            for ((v, p), w) in v.iter().zip(p).zip(inverse_masses) {
                a += v * p;
                b += w * p * p;
            }
        }
        let share = if b > 0.0 { -2.0 * h * a / b } else { 0.0 };
        let over_h = share.clamp(0.0, 1.0) / h;
        for (v, p) in v.chunks_exact_mut(n).zip(self.moments.chunks_exact(n)) {
            for ((v, p), w) in v.iter_mut().zip(p).zip(inverse_masses) {
                *v += over_h * w * p;
            }
        }
    }
}

/// Particles at the ends of springs.
struct RunEnds<'a> {
    x: &'a mut [f64],
    moments: &'a mut [f64],
    inverse_masses: &'a [f64],
}

impl RunEnds<'_> {
    /// Moves particles i and j towards each other, by their excess distance over `longest` (m)
    /// times a factor. Returns the excess (m).
    fn shorten(&mut self, [i, j]: [usize; 2], longest: f64, factor: f64) -> f64 {
        let n = self.inverse_masses.len();
        let x = &mut *self.x;
        let d = [0, n, 2 * n].map(|axis| x[axis + j] - x[axis + i]);
        let squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if squared <= longest * longest {
            return 0.0;
        }
        let (length, [wi, wj]) = (squared.sqrt(), [i, j].map(|i| self.inverse_masses[i]));
        let scale = factor * (length - longest) / (length * (wi + wj));
        for (axis, d) in d.into_iter().enumerate() {
            let (i, j, moment) = (axis * n + i, axis * n + j, scale * d);
            x[i] += wi * moment;
            x[j] -= wj * moment;
            self.moments[i] += moment;
            self.moments[j] -= moment;
        }
        length - longest
    }
}

/// Returns the tethers of all particles that springs connect to a pin: to the nearest pin, by the
/// sum of longest lengths along springs (Dijkstra, 1959).
fn tethers(rows: &[SpringRun], inverse_masses: &[f64]) -> Vec<Tether> {
    let n = inverse_masses.len();
    let mut nearest = vec![(f64::INFINITY, 0); n];
    // The bits of non-negative numbers have the order of the numbers.
    let mut reached = BinaryHeap::new();
    for i in (0..n).filter(|i| inverse_masses[*i] == 0.0) {
        nearest[i] = (0.0, i);
        reached.push((Reverse(0.0_f64.to_bits()), i));
    }
    if reached.is_empty() {
        return vec![];
    }
    let mut neighbours = vec![vec![]; n];
    for row in rows {
        for (i, j) in (row.i..row.i + row.count).zip(row.j..) {
            neighbours[i].push((j, row.longest));
            neighbours[j].push((i, row.longest));
        }
    }
    while let Some((Reverse(bits), i)) = reached.pop() {
        let (here, pin) = nearest[i];
        if bits > here.to_bits() {
            continue;
        }
        for &(j, longest) in &neighbours[i] {
            let there = here + longest;
            if there < nearest[j].0 {
                nearest[j] = (there, pin);
                reached.push((Reverse(there.to_bits()), j));
            }
        }
    }
    let held = nearest.iter().enumerate();
    held.filter(|(_, (longest, _))| *longest > 0.0 && longest.is_finite())
        .map(|(particle, &(longest, pin))| Tether { pin, particle, longest })
        .collect()
}
