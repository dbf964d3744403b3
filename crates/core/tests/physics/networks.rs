//! Random networks that a seed determines: several sheets, also torn ones, with single springs
//! between them.

use a3_core::elements::{Air, Buckling, Wind};
use a3_core::{Grid, Network, Path, Sheet, Spring, SpringKind, SpringLaw, Vector3};

/// Pseudorandom numbers that a seed determines.
pub struct Random(pub u64);

impl Random {
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        from + (to - from) * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn below(&mut self, end: usize) -> usize {
        (self.between(0.0, end as f64) as usize).min(end - 1)
    }
}

pub const SPACING: f64 = 0.1;

/// Kinds of parts of a network.
#[derive(Clone, Copy)]
pub struct Kinds {
    /// Whether there are particles in no sheet, single springs, springs that buckle, and air around
    /// triangles.
    pub mixed: bool,
    /// Whether springs are torn.
    pub torn: bool,
    /// Whether springs are damped.
    pub damped: bool,
}

/// Network of up to three sheets, some of them wide, and a state near rest.
pub fn network(seed: u64, kinds: Kinds) -> (Network, Vec<f64>) {
    let mut random = Random(seed);
    let (mut sheets, mut triangles, mut positions) = (vec![], vec![], vec![]);
    for k in 0..=seed as usize % 3 {
        if kinds.mixed {
            for _ in 0..random.below(3) {
                positions.push([random.between(0.0, 1.0), -0.5, k as f64]);
            }
        }
        let wide = if random.below(3) == 0 { 150 } else { 14 };
        let grid = Grid::new(2 + random.below(9), 2 + random.below(wide)).unwrap();
        let first = positions.len();
        let stiffness = [50.0, 30.0, 10.0].map(|k| k * random.between(0.5, 2.0));
        let damping = if kinds.damped { 0.004 } else { 0.0 };
        let sheet = Sheet::new(grid, SPACING, stiffness, damping).unwrap();
        sheets.push(sheet.starting_at(first));
        triangles.extend(grid.triangles().map(|t| t.map(|i| first + i)));
        for i in 0..grid.particles() {
            let (row, col) = (i / grid.cols(), i % grid.cols());
            positions.push([SPACING * col as f64, -SPACING * row as f64, k as f64]);
        }
    }
    let n = positions.len();
    let uniform = random.below(2) == 0;
    let masses = (0..n).map(|_| if uniform { 0.02 } else { random.between(0.01, 0.04) });
    let mut network = Network::new(masses.collect()).unwrap();
    // The sheets are added in reverse order, because the order must not matter.
    for sheet in sheets.into_iter().rev() {
        network.add(sheet).unwrap();
    }
    if kinds.mixed {
        for k in 0..20 {
            let (i, j) = (random.below(n), random.below(n));
            let stiffness = random.between(1.0, 30.0);
            let damping = if kinds.damped { 0.1 } else { 0.0 };
            let rest_length = random.between(0.05, 0.3);
            if i == j {
                continue;
            }
            if k % 5 == 0 {
                let strip = Buckling {
                    i,
                    j,
                    rest_length,
                    bending: 0.01 * rest_length.powi(3) * stiffness,
                    compression: stiffness,
                    tension: 0.5 * stiffness,
                    damping,
                };
                network.add_buckling(strip).unwrap();
            } else {
                let law = SpringLaw::new(stiffness, rest_length, damping).unwrap();
                let kind = SpringKind::Structural;
                network.add_spring(Spring { kind, i, j, law }).unwrap();
            }
        }
        network.set_triangles(triangles).unwrap();
    }
    network.set_wind(Some(if kinds.mixed && random.below(2) == 0 {
        let air = Air::new(1.2, 1.1, 0.6).unwrap();
        Wind::on_triangles(seed, Vector3::new(1.0, 0.3, 3.0), air)
    } else {
        Wind::new(seed, Vector3::new(0.02, 0.0, 0.05))
    }));
    network.set_gravity(Vector3::new(0.0, -9.81, 0.3));
    network.set_drag(0.01).unwrap();
    if kinds.torn {
        let springs: Vec<_> = network.springs().collect();
        let broken = |_| {
            let spring = springs[random.below(springs.len())];
            [spring.j, spring.i]
        };
        let pairs: Vec<_> = (0..=springs.len() / 12).map(broken).collect();
        network.break_springs(&pairs).unwrap();
        assert!(network.springs().all(|s| !network.is_torn(s.i, s.j)));
    }
    let mut y: Vec<f64> = (0..6 * n)
        .map(|k| {
            if k < 3 * n {
                positions[k % n][k / n] + 0.03 * random.between(-1.0, 1.0)
            } else {
                random.between(-1.0, 1.0)
            }
        })
        .collect();
    for _ in 0..2 {
        let i = random.below(n);
        let at = Vector3::new(y[i], y[n + i], y[2 * n + i]);
        network.pin(i, Path::Still(at)).unwrap();
        (3..6).for_each(|axis| y[axis * n + i] = 0.0);
    }
    (network, y)
}

/// Networks of all kinds with their names and states.
pub fn networks() -> impl Iterator<Item = (String, Network, Vec<f64>)> {
    (0..48).map(|seed| {
        let kinds = Kinds { mixed: seed % 4 < 3, torn: seed % 8 < 4, damped: seed % 3 > 0 };
        let (network, y) = network(seed, kinds);
        (format!("seed {seed}"), network, y)
    })
}

/// The same network with all its springs as single ones.
pub fn listed(network: &Network) -> Network {
    let mut list = Network::new(network.masses().to_vec()).unwrap();
    list.add_springs(network.springs()).unwrap();
    for strip in network.buckling() {
        list.add_buckling(strip).unwrap();
    }
    list.set_triangles(network.triangles().iter().map(|t| t.map(|i| i as usize))).unwrap();
    list.set_wind(network.wind().copied());
    list.set_gravity(network.gravity().unwrap());
    list.set_drag(network.drag().unwrap()).unwrap();
    for (i, path) in network.pins() {
        list.pin(i, path).unwrap();
    }
    list
}
