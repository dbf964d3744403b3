//! Particles, rigid bodies, springs, rods and the whole scene, the variables of them that can be
//! plotted, and their values in a state of a run.

use a3_core::elements::{Buckling, Cords};
use a3_core::{Constraint, Element, Network, Simulation, Spring, Vector3};
use a3_scenes::Splice;

use crate::session::rows;

/// Something with values, by the numbers of its run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pick {
    Particle(usize),
    Body(usize),
    /// The spring between two particles.
    Spring(usize, usize),
    /// The rod between two particles.
    Rod(usize, usize),
    /// The rope between two particles.
    Rope(usize, usize),
    /// The whole scene.
    Scene,
}

impl Pick {
    /// Returns the pick at a particle: the body that it belongs to, or the particle itself.
    pub fn at(run: &Simulation, i: usize) -> Self {
        let network = run.model().network();
        let body = network.and_then(|network| network.body_of(i));
        body.map_or(Self::Particle(i), Self::Body)
    }

    /// Returns all springs, rods and ropes of a network.
    pub fn links(network: &Network) -> impl Iterator<Item = Self> {
        let springs = network.all_springs().map(|s| Self::Spring(s.i, s.j));
        springs.chain(Self::ties(network))
    }

    /// Returns all rods and ropes of a network.
    fn ties(network: &Network) -> impl Iterator<Item = Self> {
        let all = network.constraints().iter();
        all.filter_map(|tie| match *tie {
            Constraint::Rod { i, j, .. } => Some(Self::Rod(i, j)),
            Constraint::Rope { i, j, .. } => Some(Self::Rope(i, j)),
            _ => None,
        })
    }

    /// Returns the particles at the ends of a spring, a rod or a rope.
    pub fn ends(self) -> Option<[usize; 2]> {
        match self {
            Self::Spring(i, j) | Self::Rod(i, j) | Self::Rope(i, j) => Some([i, j]),
            _ => None,
        }
    }

    /// Returns the same pick by the numbers of particles and rigid bodies since an edit; `None` if
    /// it was removed.
    pub fn renumbered(self, [particles, bodies]: [Splice; 2]) -> Option<Self> {
        Some(match self {
            Self::Particle(i) => Self::Particle(particles.number(i)?),
            Self::Body(k) => Self::Body(bodies.number(k)?),
            Self::Spring(i, j) => Self::Spring(particles.number(i)?, particles.number(j)?),
            Self::Rod(i, j) => Self::Rod(particles.number(i)?, particles.number(j)?),
            Self::Rope(i, j) => Self::Rope(particles.number(i)?, particles.number(j)?),
            Self::Scene => Self::Scene,
        })
    }

    pub fn kind(self) -> Kind {
        match self {
            Self::Particle(_) => Kind::Particle,
            Self::Body(_) => Kind::Body,
            Self::Spring(..) => Kind::Spring,
            Self::Rod(..) | Self::Rope(..) => Kind::Rod,
            Self::Scene => Kind::Scene,
        }
    }

    /// Returns the name.
    pub fn name(self) -> String {
        match self {
            Self::Particle(i) => format!("particle {i}"),
            Self::Body(k) => format!("body {k}"),
            Self::Spring(i, j) => format!("spring {i} to {j}"),
            Self::Rod(i, j) => format!("rod {i} to {j}"),
            Self::Rope(i, j) => format!("rope {i} to {j}"),
            Self::Scene => "the scene".into(),
        }
    }

    /// Returns whether a run has this.
    pub fn is_in(self, run: &Simulation) -> bool {
        !self.read(run).values[0].is_nan()
    }

    /// Returns the values in the present state of a run; NaN if it has no such thing.
    pub fn read(self, run: &Simulation) -> Row {
        let network = run.model().network();
        let values = match (self, network) {
            (Self::Particle(i), Some(network)) if i < network.particles() => {
                moving(network, run, i, spring_energy(network, run, i))
            }
            (Self::Particle(i), None) if i < run.particles() => path(run, i),
            (Self::Body(k), Some(network)) if k < network.bodies().len() => {
                let body = &network.bodies()[k];
                let mut values = moving(network, run, body.center(), 0.0);
                values[6] += body.energy(&network.rotation(k, run.state()));
                if let Some(turning) = network.pose(k, run.state()).orientation {
                    let (spin, axes) = (turning.spin, turning.rotation);
                    values[10..ANGLE].copy_from_slice(spin.as_slice());
                    values[ANGLE..].copy_from_slice(&[
                        axes[(1, 0)].atan2(axes[(0, 0)]),
                        axes[(1, 1)].clamp(-1.0, 1.0).acos(),
                    ]);
                }
                values
            }
            (Self::Spring(i, j), Some(network)) => spring(network, run, i, j),
            (Self::Rod(i, j) | Self::Rope(i, j), Some(network))
                if Self::ties(network).any(|tie| tie == self) =>
            {
                between(network, run, i, j)
            }
            (Self::Scene, _) => whole(run),
            _ => [f64::NAN; VALUES],
        };
        Row { time: run.time(), values }
    }
}

/// Returns the values of particle i of a network, whose springs have some energy (J).
fn moving(network: &Network, run: &Simulation, i: usize, of_springs: f64) -> [f64; VALUES] {
    let (x, v) = (run.position(i), velocity(network, run, i));
    let mass = network.masses()[i];
    let gravity = network.gravity().unwrap_or_default();
    let mut values = [f64::NAN; VALUES];
    values[..3].copy_from_slice(x.as_slice());
    values[3..6].copy_from_slice(v.as_slice());
    values[6] = 0.5 * mass * v.norm_squared();
    values[7..10].copy_from_slice(&[of_springs, -mass * gravity.dot(&x), 0.0]);
    values
}

/// Returns the energies of a run.
fn whole(run: &Simulation) -> [f64; VALUES] {
    let mut values = [f64::NAN; VALUES];
    if let Some(all) = run.energy() {
        let parts = [all.kinetic, all.elastic, all.gravitational, all.contact];
        values[6..10].copy_from_slice(&parts);
    }
    values
}

/// Returns position and velocity of point i of a first-order system.
fn path(run: &Simulation, i: usize) -> [f64; VALUES] {
    let (n, rates) = (run.particles(), run.velocities());
    let mut values = [f64::NAN; VALUES];
    values[..3].copy_from_slice(run.position(i).as_slice());
    for axis in 0..3 {
        values[3 + axis] = rates[axis * n + i];
    }
    values
}

/// Returns the velocity of particle i (m/s).
fn velocity(network: &Network, run: &Simulation, i: usize) -> Vector3<f64> {
    let (n, (_, v)) = (network.particles(), network.halves(run.state()));
    Vector3::new(v[i], v[n + i], v[2 * n + i])
}

/// Returns length, angles and angular velocity of the line from particle i to j.
fn between(network: &Network, run: &Simulation, i: usize, j: usize) -> [f64; VALUES] {
    let mut values = [f64::NAN; VALUES];
    let way = run.position(j) - run.position(i);
    let rate = velocity(network, run, j) - velocity(network, run, i);
    values[0] = way.norm();
    values[12] = (way.x * rate.y - way.y * rate.x) / (way.x * way.x + way.y * way.y);
    values[ANGLE] = way.x.atan2(-way.y);
    values[ANGLE + 1] = way.x.hypot(way.z).atan2(-way.y);
    values
}

/// Returns the same, strain, force and energy of the spring between particles i and j.
fn spring(network: &Network, run: &Simulation, i: usize, j: usize) -> [f64; VALUES] {
    let Some((alone, rest)) = alone(network, i, j) else {
        return [f64::NAN; VALUES];
    };
    let mut values = between(network, run, i, j);
    let [x, v] = [
        [run.position(i), run.position(j)],
        [velocity(network, run, i), velocity(network, run, j)],
    ]
    .map(|ends| columns(&ends));
    let mut force = [0.0; 6];
    alone.spring_forces(&x, &v, &mut force);
    let way = run.position(j) - run.position(i);
    let length = way.norm();
    let pull = Vector3::new(force[0], force[2], force[4]);
    values[7] = alone.energy(&x, &v).elastic;
    values[1] = if rest > 0.0 { length / rest - 1.0 } else { f64::NAN };
    values[2] = if length > 0.0 { pull.dot(&way) / length } else { 0.0 };
    values
}

/// Returns the energy (J) of the springs of particle i: all of those to pins, and half of the
/// others, so that the energies of all particles that move add up to that of the network.
fn spring_energy(network: &Network, run: &Simulation, i: usize) -> f64 {
    let of = |s: &Spring, energy: f64| {
        let other = s.i + s.j - i;
        energy * if network.is_pinned(other) { 1.0 } else { 0.5 }
    };
    let stretch = |s: &Spring| {
        let length = (run.position(s.i) - run.position(s.j)).norm();
        length - s.law.rest_length
    };
    let touches = |s: &Spring| s.i == i || s.j == i;
    let plain = network.springs().filter(touches);
    let plain = plain.map(|s| of(&s, 0.5 * s.law.stiffness * stretch(&s).powi(2)));
    let slack = cords(network).filter(touches);
    let slack = slack.map(|s| of(&s, 0.5 * s.law.stiffness * stretch(&s).max(0.0).powi(2)));
    let strips = network.buckling().filter(|b| b.i == i || b.j == i);
    let bent = strips.filter_map(|b| {
        let share = if network.is_pinned(b.i + b.j - i) { 1.0 } else { 0.5 };
        let x = columns(&[run.position(b.i), run.position(b.j)]);
        let mut alone = Network::new(vec![1.0; 2]).ok()?;
        alone.add_buckling(Buckling { i: 0, j: 1, ..b }).ok()?;
        Some(share * alone.energy(&x, &[0.0; 6]).elastic)
    });
    plain.chain(slack).sum::<f64>() + bent.sum::<f64>()
}

/// Returns the springs of a network that only pull.
fn cords(network: &Network) -> impl Iterator<Item = Spring> {
    let all = network.elements().iter().filter_map(|element| match element {
        Element::Cords(cords) => Some(cords.springs()),
        _ => None,
    });
    all.flatten()
}

/// Returns all that is elastic between particles i and j in a network of its own, from particle 0
/// to 1, and its rest length (m).
fn alone(network: &Network, i: usize, j: usize) -> Option<(Network, f64)> {
    let is = |a: usize, b: usize| (a, b) == (i, j) || (a, b) == (j, i);
    let at_ends = |s: Spring| Spring { i: 0, j: 1, ..s };
    let (mut pair, mut rest) = (Network::new(vec![1.0; 2]).ok()?, None);
    for spring in network.springs().filter(|s| is(s.i, s.j)) {
        rest = Some(spring.law.rest_length);
        pair.add_spring(at_ends(spring)).ok()?;
    }
    for strip in network.buckling().filter(|b| is(b.i, b.j)) {
        rest = Some(strip.rest_length);
        pair.add_buckling(Buckling { i: 0, j: 1, ..strip }).ok()?;
    }
    let cords: Vec<_> = cords(network).filter(|s| is(s.i, s.j)).collect();
    if let Some(cord) = cords.last() {
        rest = Some(cord.law.rest_length);
        pair.add(Cords::new(cords.into_iter().map(at_ends))).ok()?;
    }
    Some((pair, rest?))
}

/// Returns two vectors as the columns of a network of two particles.
fn columns([a, b]: &[Vector3<f64>; 2]) -> [f64; 6] {
    [a.x, b.x, a.y, b.y, a.z, b.z]
}

/// Kind of what is plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Particle,
    Body,
    Spring,
    /// A rod or a rope.
    Rod,
    Scene,
}

impl Kind {
    /// Returns the phase plane with which plots of this kind begin.
    pub fn plane(self) -> [Variable; 2] {
        match self {
            Self::Particle | Self::Body => [Variable::X, Variable::VelocityX],
            Self::Spring => [Variable::Length, Variable::Force],
            Self::Rod => [Variable::Angle, Variable::SpinZ],
            Self::Scene => [Variable::Kinetic, Variable::Potential],
        }
    }
}

/// A variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variable {
    X,
    Y,
    Z,
    VelocityX,
    VelocityY,
    VelocityZ,
    Speed,
    Kinetic,
    Elastic,
    Contact,
    Gravitational,
    Potential,
    Energy,
    Angle,
    Tilt,
    SpinX,
    SpinY,
    SpinZ,
    Length,
    Strain,
    Force,
}

impl Variable {
    /// All variables in the order of their buttons, each with the name on the button, the name on
    /// an axis, the unit, and the places of the values of a row that add up to it.
    const TABLE: [(Self, [&'static str; 3], &'static [usize]); 21] = [
        (Self::X, ["x", "x", "m"], &[0]),
        (Self::Y, ["y", "y", "m"], &[1]),
        (Self::Z, ["z", "z", "m"], &[2]),
        (Self::VelocityX, ["vx", "vx", "m/s"], &[3]),
        (Self::VelocityY, ["vy", "vy", "m/s"], &[4]),
        (Self::VelocityZ, ["vz", "vz", "m/s"], &[5]),
        (Self::Speed, ["speed", "speed", "m/s"], &[]),
        (Self::Kinetic, ["kinetic", "kinetic energy", "J"], &[6]),
        (Self::Elastic, ["elastic", "elastic energy", "J"], &[7]),
        (Self::Contact, ["contact", "energy of contact", "J"], &[9]),
        (Self::Gravitational, ["gravity", "gravitational energy", "J"], &[8]),
        (Self::Potential, ["potential", "potential energy", "J"], &[7, 8, 9]),
        (Self::Energy, ["energy", "energy", "J"], &[6, 7, 8, 9]),
        (Self::Angle, ["angle", "angle", "rad"], &[ANGLE]),
        (Self::Tilt, ["tilt", "angle to the vertical", "rad"], &[14]),
        (Self::SpinX, ["ωx", "angular velocity x", "rad/s"], &[10]),
        (Self::SpinY, ["ωy", "angular velocity y", "rad/s"], &[11]),
        (Self::SpinZ, ["ωz", "angular velocity z", "rad/s"], &[12]),
        (Self::Length, ["length", "length", "m"], &[0]),
        (Self::Strain, ["strain", "strain", ""], &[1]),
        (Self::Force, ["force", "force", "N"], &[2]),
    ];

    /// Returns all variables, in the order of their buttons.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::TABLE.into_iter().map(|row| row.0)
    }

    /// Returns the short name, the name on an axis, and the unit, which is empty for a ratio.
    pub fn words(self) -> [&'static str; 3] {
        Self::TABLE[self as usize].1
    }

    /// Returns the short name.
    pub fn name(self) -> &'static str {
        self.words()[0]
    }

    /// Returns the unit; empty for a ratio.
    pub fn unit(self) -> &'static str {
        self.words()[2]
    }

    /// Returns whether things of a kind have the variable.
    pub fn is_of(self, kind: Kind) -> bool {
        match self {
            Self::X | Self::Y | Self::Z | Self::Speed => {
                kind == Kind::Particle || kind == Kind::Body
            }
            Self::VelocityX | Self::VelocityY | Self::VelocityZ => Self::X.is_of(kind),
            Self::Kinetic | Self::Potential | Self::Energy => {
                Self::X.is_of(kind) || kind == Kind::Scene
            }
            Self::Elastic => matches!(kind, Kind::Particle | Kind::Spring | Kind::Scene),
            Self::Gravitational => kind == Kind::Particle || kind == Kind::Scene,
            Self::Contact => kind == Kind::Scene,
            Self::Angle | Self::Tilt | Self::SpinZ => {
                matches!(kind, Kind::Body | Kind::Spring | Kind::Rod)
            }
            Self::SpinX | Self::SpinY => kind == Kind::Body,
            Self::Length => kind == Kind::Spring || kind == Kind::Rod,
            Self::Strain | Self::Force => kind == Kind::Spring,
        }
    }

    /// Returns the value in a row of something that has the variable.
    pub fn of(self, row: &Row) -> f64 {
        if self == Self::Speed {
            let [x, y, z] = [3, 4, 5].map(|k| row.values[k]);
            return x.hypot(y).hypot(z);
        }
        let values = Self::TABLE[self as usize].2.iter();
        let values = values.map(|k| row.values[*k]);
        values.reduce(|sum, value| sum + value).unwrap_or(f64::NAN)
    }

    /// Returns whether this is a coordinate of a place, or an angle.
    pub fn is_coordinate(self) -> bool {
        matches!(self, Self::X | Self::Y | Self::Z | Self::Angle)
    }

    /// Returns the velocity of a coordinate or of an angle; that of x for any other variable.
    pub fn velocity(self) -> Self {
        match self {
            Self::Angle => Self::SpinZ,
            Self::Y => Self::VelocityY,
            Self::Z => Self::VelocityZ,
            _ => Self::VelocityX,
        }
    }
}

/// Number of values of a row.
pub const VALUES: usize = 15;
/// Place of the angle among them.
pub const ANGLE: usize = 13;

/// Values of a pick at one time. Of a spring, or a rod without the last two: length (m), strain and
/// force (N), above 0 when it pulls. Otherwise: position (m). Then of all: velocity (m/s), kinetic,
/// elastic, gravitational and contact energy (J), angular velocity (rad/s), and two angles (rad). A
/// value that is not known is NaN.
///
/// Seen from the front, along z, the first angle is that of a spring or a rod from straight down,
/// or of a body's own x axis from the right, both anticlockwise. The second one is that in space of
/// the spring or rod to straight down, or of the body's own y axis to straight up.
pub type Row = rows::Row<[f64; VALUES]>;
