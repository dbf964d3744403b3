//! Places of the particles of one grid on another.

use std::collections::HashMap;

use a3_core::Vector3;

/// Places of the particles of one grid on another, body by body.
#[derive(Default)]
pub struct Places {
    /// Place of each particle, as a weighted mean of particles of the other grid: their numbers and
    /// weights.
    pub of: Vec<Vec<(usize, f64)>>,
    /// Number of particles of the scene on the other grid.
    pub count: usize,
    /// Number of particles that belong to no grid.
    pub kept: usize,
}

impl Places {
    /// Adds a body with its numbers of particles along each axis, on its own grid and on the other.
    /// The index along the last axis varies fastest.
    pub fn add(&mut self, own: &[usize], other: &[usize]) {
        let first = self.count;
        let total: usize = own.iter().product();
        for number in 0..total {
            // The place along each axis: the index of the particle before it, and the distance from
            // there in cells.
            let mut rest = number;
            let mut along: Vec<(usize, f64)> = own
                .iter()
                .zip(other)
                .rev()
                .map(|(&n, &m)| {
                    let i = rest % n;
                    rest /= n;
                    let at = i as f64 * (m - 1) as f64 / (n.max(2) - 1) as f64;
                    let before = (at.floor() as usize).min(m - 2);
                    (before, at - before as f64)
                })
                .collect();
            along.reverse();
            let mut corners = vec![(0, 1.0)];
            for ((before, share), &m) in along.iter().zip(other) {
                corners = corners
                    .iter()
                    .flat_map(|&(at, weight)| {
                        let at = at * m + before;
                        [(at, weight * (1.0 - share)), (at + 1, weight * share)]
                    })
                    .filter(|(_, weight)| *weight > 1e-12)
                    .collect();
            }
            let corners = corners.into_iter().map(|(at, w)| (first + at, w));
            self.of.push(corners.collect());
        }
        self.count += other.iter().product::<usize>();
    }

    /// Adds a lattice, in which the index along x varies fastest.
    pub fn add_lattice(&mut self, [x, y, z]: [usize; 3], [i, j, k]: [usize; 3]) {
        self.add(&[z, y, x], &[k, j, i]);
    }

    /// Adds the other particles of the scene, up to this number in all, which belong to no grid.
    pub fn add_others(&mut self, particles: usize) {
        self.kept = particles.saturating_sub(self.of.len());
        for _ in 0..self.kept {
            self.of.push(vec![(self.count, 1.0)]);
            self.count += 1;
        }
    }

    /// Adds particles of a fluid or of the walls of a tank: their positions (m) on their own
    /// lattice, and those of all particles on the other. Each is interpolated in the nearest cell
    /// that has a particle at each corner, and extrapolated from it where that does not enclose it.
    ///
    /// # Errors
    /// The other lattice has no such cell near a particle.
    pub fn add_points(&mut self, own: &[Vector3<f64>], other: &Lattice) -> Result<(), String> {
        for place in own {
            let corners = other
                .corners(place)
                .ok_or("a fluid has too few particles on another lattice")?;
            let corners = corners.into_iter().map(|(at, w)| (self.count + at, w));
            self.of.push(corners.collect());
        }
        self.count += other.numbers.len();
        Ok(())
    }
}

/// Particles on points of a cubic lattice, or of a square one across z.
pub struct Lattice {
    origin: Vector3<f64>,
    spacing: f64,
    /// Number of axes.
    dimensions: usize,
    /// Number of the particle on each point that has one.
    numbers: HashMap<[i64; 3], usize>,
}

/// Largest distance of a cell from a particle that is interpolated in it (cells).
const MAX_DISTANCE: i64 = 5;

impl Lattice {
    /// Creates the lattice of particles at these positions (m).
    pub fn new(points: &[Vector3<f64>], spacing: f64, dimensions: usize) -> Self {
        let origin = points.first().copied().unwrap_or_default();
        let index = |place: &Vector3<f64>| {
            let cells = (place - origin) / spacing;
            [0, 1, 2].map(|axis| cells[axis].round() as i64)
        };
        let numbers = points.iter().enumerate().map(|(i, p)| (index(p), i));
        Self {
            origin,
            spacing,
            dimensions,
            numbers: numbers.collect(),
        }
    }

    /// Returns the particles at the corners of the nearest complete cell, with their weights at a
    /// place (m).
    fn corners(&self, place: &Vector3<f64>) -> Option<Vec<(usize, f64)>> {
        let at = (place - self.origin) / self.spacing;
        // Rounding must not move a place across a point of the lattice.
        let first = [0, 1, 2].map(|axis| (at[axis] + 1e-9).floor() as i64);
        let nearest = |distance: i64| {
            let offsets = (-distance..=distance).flat_map(move |z| {
                (-distance..=distance)
                    .flat_map(move |y| (-distance..=distance).map(move |x| [x, y, z]))
            });
            let ring = offsets.filter(|offset| {
                offset.iter().any(|k| k.abs() == distance)
                    && offset[self.dimensions..].iter().all(|k| *k == 0)
            });
            let cells = ring.map(|offset| [0, 1, 2].map(|axis| first[axis] + offset[axis]));
            let complete = cells.filter_map(|cell| Some((self.weights(cell, &at)?, cell)));
            complete.min_by(|(_, a), (_, b)| {
                let far = |cell: &[i64; 3]| {
                    let axes = 0..self.dimensions;
                    axes.map(|k| (cell[k] as f64 + 0.5 - at[k]).powi(2))
                        .sum::<f64>()
                };
                far(a).total_cmp(&far(b))
            })
        };
        (0..=MAX_DISTANCE).find_map(nearest).map(|found| found.0)
    }

    /// Returns the particles at the corners of a cell, with their weights at a place (cells).
    /// `None` if one of them is missing.
    fn weights(&self, cell: [i64; 3], at: &Vector3<f64>) -> Option<Vec<(usize, f64)>> {
        let corners = (0..1_usize << self.dimensions).map(|corner| {
            let (mut point, mut weight) = (cell, 1.0);
            for axis in 0..self.dimensions {
                let share = at[axis] - cell[axis] as f64;
                let is_far = corner >> axis & 1 == 1;
                point[axis] += i64::from(is_far);
                weight *= if is_far { share } else { 1.0 - share };
            }
            Some((*self.numbers.get(&point)?, weight))
        });
        corners.collect()
    }
}
