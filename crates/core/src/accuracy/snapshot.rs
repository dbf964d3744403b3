//! Snapshot of a state: the quantities by which states are compared, their errors, the scope in
//! which these are taken, and the first impact of a run: the times at which surfaces first touch,
//! and at which nothing touches any more.
//!
//! Both times are found on cubic polynomials through the positions and velocities of two frames.
//! They are functions of these states alone, the same for every method, so their errors fall with
//! the order of the method. A touch that begins and ends between two frames is not detected.

use nalgebra::Vector3;

use super::hermite::weights;
use crate::contact::ContactLayer;
use crate::elements::force::distance;
use crate::error::Error;
use crate::integrators::add_scaled;
use crate::network::Network;
use crate::scene::Model;
use crate::spring::SpringKind;
use crate::system::Mechanics;

/// Size of a plain number over the largest one, up to which it counts as rounding errors, a few
/// units in the last place for each of thousands of steps. Its errors are then over the size of the
/// largest number.
const ROUNDING: f64 = 1e-12;

/// Quantities of a state that are compared.
#[derive(Clone, Debug, Default)]
pub(super) struct Snapshot {
    /// Number of particles.
    particles: usize,
    /// Number of these particles that are pinned in walls: they have no errors.
    walls: usize,
    /// Positions (m): all x, all y, all z. Without particles, all numbers of the state.
    positions: Vec<f64>,
    /// Velocities (m/s): the rates of change of these.
    velocities: Vec<f64>,
    /// The system's own [quantities](crate::ParticleSystem::quantities), by which its states are
    /// compared; empty if they are compared by their numbers.
    quantities: Vec<f64>,
    /// The largest size of each compared number so far; empty with particles.
    sizes: Vec<f64>,
    /// Total energy (J); 0 for a system that does not know it.
    energy: f64,
    /// Momentum of the particles that are not pinned (kg m/s); 0 for a first-order scene.
    momentum: Vector3<f64>,
    /// Length over rest length of each structural spring.
    strains: Vec<f64>,
    /// Largest depth of penetration over the thickness.
    penetration: f64,
    /// First impact so far.
    impact: FirstImpact,
}

impl Snapshot {
    /// Creates a snapshot of the state y of a model at time t (s), at which a run starts.
    pub fn of(model: &Model, t: f64, y: &[f64]) -> Self {
        let Some(network) = model.network() else {
            let (positions, velocities) = model.motion(t, y);
            let quantities = quantities(model, t, y);
            let sizes = match model.particles() {
                0 if quantities.is_empty() => sizes(positions, model.system().scales()),
                0 => sizes(&quantities, &[]),
                _ => vec![],
            };
            return Self {
                particles: model.particles(),
                positions: positions.to_vec(),
                velocities: velocities.into_owned(),
                energy: model.own_energy(t, y).unwrap_or(0.0),
                quantities,
                sizes,
                ..Self::default()
            };
        };
        let penetration = network.contact_layer();
        let penetration =
            penetration.map_or(0.0, |layer| layer.penetration(t, network.halves(y).0));
        Self {
            energy: network.energy_of(t, y).total(),
            penetration,
            impact: FirstImpact::at_start(t),
            ..Self::of_motion(network, y)
        }
    }

    /// Creates a snapshot of the quantities that follow from positions and velocities alone; the
    /// rest is 0.
    fn of_motion(network: &Network, y: &[f64]) -> Self {
        let (positions, velocities) = network.halves(y);
        let inverse_masses = network.inverse_masses();
        let momentum = Vector3::from_fn(|axis, _| {
            let n = inverse_masses.len();
            let column = velocities[axis * n..(axis + 1) * n].iter();
            let free = column.zip(inverse_masses).filter(|(_, w)| **w > 0.0);
            free.map(|(v, w)| v / w).sum()
        });
        Self {
            momentum,
            strains: structural(network)
                .map(|s| distance(positions, s.i, s.j) / s.law.rest_length)
                .collect(),
            particles: inverse_masses.len(),
            walls: network.fixed_walls(),
            positions: positions.to_vec(),
            velocities: velocities.to_vec(),
            ..Self::default()
        }
    }

    /// Creates a snapshot of the state y of a model at time t (s), of the quantities that are
    /// compared between frames: without those of contact, and without the energy if contact or
    /// rotations contribute to it.
    pub fn between_frames(model: &Model, t: f64, y: &[f64]) -> Self {
        let Some(network) = model.network() else {
            return Self::of(model, t, y);
        };
        let of_more = network.contact_layer().is_some() || !network.bodies().is_empty();
        Self {
            energy: if of_more { f64::INFINITY } else { network.energy_of(t, y).total() },
            ..Self::of_motion(network, y)
        }
    }

    /// Creates a snapshot at time t (s), interpolated from known times (s): positions by the
    /// polynomial through positions and velocities, all other quantities by that through the
    /// values.
    pub fn interpolated(model: &Model, known: &[(f64, &Self)], t: f64) -> Self {
        // Times are in units of their distance, so that the weights are of ordinary size.
        let (first, last) = (known[0].0, known[known.len() - 1].0);
        let unit = (last - first) / (known.len() - 1) as f64;
        let nodes: Vec<_> = known.iter().map(|(time, _)| (time - first) / unit).collect();
        let [of_values, of_both] = [1, 2].map(|count| weights(&nodes, count, (t - first) / unit));
        let mut y = vec![0.0; known[0].1.positions.len() + known[0].1.velocities.len()];
        let (x, v) = y.split_at_mut(known[0].1.positions.len());
        let (mut energy, mut momentum) = (0.0, Vector3::zeros());
        for (k, (_, node)) in known.iter().enumerate() {
            add_scaled(x, of_both[2 * k], &node.positions);
            add_scaled(x, of_both[2 * k + 1] * unit, &node.velocities);
            add_scaled(v, of_values[k], &node.velocities);
            energy += of_values[k] * node.energy;
            momentum += of_values[k] * node.momentum;
        }
        let at = match model.network() {
            Some(network) => Self::of_motion(network, &y),
            None => Self {
                particles: model.particles(),
                positions: x.to_vec(),
                velocities: v.to_vec(),
                quantities: quantities(model, t, x),
                sizes: known[known.len() - 1].1.sizes.clone(),
                ..Self::default()
            },
        };
        Self { energy, momentum, ..at }
    }

    /// Creates the next snapshot of a run after this one, of the state y of a model at time t (s).
    pub fn next(&self, model: &Model, t: f64, y: &[f64]) -> Self {
        let mut next = Self::of(model, t, y);
        for (size, before) in next.sizes.iter_mut().zip(&self.sizes) {
            *size = size.max(*before);
        }
        if let Some(layer) = model.network().and_then(Network::contact_layer) {
            let ends = [self, &next].map(|s| [&*s.positions, &*s.velocities]);
            let touch = [self, &next].map(|s| s.penetration > 0.0);
            next.impact = self.impact.next(layer, t, ends, touch);
        } else {
            next.impact = self.impact.later(t);
        }
        next
    }

    /// Returns the size of each number, or of its change within a time (s) if that is larger.
    pub fn sizes_until(&self, time: f64) -> Vec<f64> {
        let rates = self.positions.iter().zip(&self.velocities);
        rates.map(|(y, rate)| y.abs().max((rate * time).abs())).collect()
    }

    /// Returns the snapshot at time t (s) if nothing moves any more.
    pub fn still(&self, t: f64) -> Self {
        Self { impact: self.impact.still(t, self.penetration > 0.0), ..self.clone() }
    }

    /// Returns the positions (m): all x, all y, all z.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// Returns the positions (m) and velocities (m/s), or the numbers of the state and their rates
    /// of change.
    pub fn motion(&self) -> [Vec<f64>; 2] {
        [self.positions.clone(), self.velocities.clone()]
    }

    /// Returns the errors of another snapshot of the same scene against this one, which is exact.
    /// The phase is not yet divided by the [`square_speed`](Self::square_speed).
    pub fn errors_of(&self, other: &Self, scope: Scope) -> Errors {
        let springs = self.strains.len().max(1) as f64;
        let stretch = self.strains.iter().zip(&other.strains);
        let positions = moved(&self.positions, &other.positions);
        let along = positions.clone().zip(&self.velocities).map(|(d, v)| d * v);
        let (position, state) = match self.particles {
            0 => {
                let largest = self.sizes.iter().fold(0.0, |most: f64, size| most.max(*size));
                let over = |size: f64| match size {
                    size if size > ROUNDING * largest => size,
                    _ if largest > 0.0 => largest,
                    _ => 1.0,
                };
                let [own, others] = [self, other].map(Self::compared);
                let relative = moved(own, others).zip(&self.sizes);
                let squares = relative.map(|(d, size)| (d / over(*size)).powi(2));
                (0.0, mean(scope.particle, own.len(), squares).sqrt())
            }
            _ => (self.mean(scope, positions.map(|d| d * d)).sqrt(), 0.0),
        };
        Errors {
            position,
            state,
            energy: (self.energy - other.energy).abs(),
            strain: (stretch.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / springs).sqrt(),
            momentum: (self.momentum - other.momentum).norm(),
            phase: self.mean(scope, along).abs(),
            penetration: (self.penetration - other.penetration).abs(),
            impact: self.impact.error_of(&other.impact),
        }
    }

    /// Returns the mean square speed of the particles in the scope (m2/s2).
    pub fn square_speed(&self, scope: Scope) -> f64 {
        self.mean(scope, self.velocities.iter().map(|v| v * v))
    }

    /// Returns the numbers of a state without particles that are compared.
    fn compared(&self) -> &[f64] {
        match &self.quantities[..] {
            [] => &self.positions,
            quantities => quantities,
        }
    }

    /// Returns the sum over the axes of the mean over the particles in the scope, without those in
    /// walls; without particles, the mean over the numbers in the scope, or over all if quantities
    /// are compared.
    fn mean(&self, scope: Scope, numbers: impl Iterator<Item = f64>) -> f64 {
        let (only, n) = match self.particles {
            0 if !self.quantities.is_empty() => (None, self.positions.len()),
            0 => (scope.particle, self.positions.len()),
            n => (scope.particle, n),
        };
        match only {
            None if self.walls < n => mean(None, n - self.walls, numbers),
            _ => mean(only, n, numbers),
        }
    }

    /// Extrapolates each quantity to fine + (fine - coarse) * `share`.
    pub fn extrapolate(coarse: &Self, fine: &Self, share: f64) -> Self {
        let both = |coarse: &f64, fine: &f64| fine + (fine - coarse) * share;
        let all = |coarse: &[f64], fine: &[f64]| {
            let pairs = coarse.iter().zip(fine);
            pairs.map(|(c, f)| both(c, f)).collect()
        };
        Self {
            particles: fine.particles,
            walls: fine.walls,
            positions: all(&coarse.positions, &fine.positions),
            velocities: all(&coarse.velocities, &fine.velocities),
            energy: both(&coarse.energy, &fine.energy),
            momentum: fine.momentum + (fine.momentum - coarse.momentum) * share,
            strains: all(&coarse.strains, &fine.strains),
            quantities: all(&coarse.quantities, &fine.quantities),
            sizes: fine.sizes.clone(),
            penetration: both(&coarse.penetration, &fine.penetration),
            impact: FirstImpact::extrapolate(&coarse.impact, &fine.impact, both),
        }
    }
}

/// Returns how much other numbers are above these.
fn moved<'a>(own: &'a [f64], other: &'a [f64]) -> impl Iterator<Item = f64> + Clone + 'a {
    own.iter().zip(other).map(|(own, other)| other - own)
}

/// Returns the system's own quantities of the state y of a model at time t (s).
fn quantities(model: &Model, t: f64, y: &[f64]) -> Vec<f64> {
    let system = model.system();
    let mut all = vec![0.0; system.quantities()];
    system.write_quantities(t, y, &mut all);
    all
}

/// Returns the mean over n numbers for each axis, summed over the axes, or the sum of the numbers
/// of the `only` one.
fn mean(only: Option<usize>, n: usize, numbers: impl Iterator<Item = f64>) -> f64 {
    match only {
        None => numbers.sum::<f64>() / n as f64,
        Some(i) => numbers.skip(i).step_by(n).sum(),
    }
}

/// Returns the sizes of plain numbers, at least these scales where the system has some.
fn sizes(numbers: &[f64], scales: &[f64]) -> Vec<f64> {
    let least = scales.iter().copied().chain(std::iter::repeat(0.0));
    let pairs = numbers.iter().zip(least);
    pairs.map(|(y, least)| y.abs().max(least)).collect()
}

/// Lists the structural springs of a network whose rest length is above 0.
fn structural(network: &Network) -> impl Iterator<Item = crate::Spring> {
    network.springs().filter(|s| s.kind == SpringKind::Structural && s.law.rest_length > 0.0)
}

/// Times of the first impact; one that has not begun or ended yet has the time of the state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FirstImpact {
    /// Time of the state (s).
    t: f64,
    /// Time at which surfaces touched first, and time at which nothing touched any more (s).
    times: [f64; 2],
}

impl FirstImpact {
    /// Creates the impact of a run that starts at time t (s).
    pub fn at_start(t: f64) -> Self {
        Self { t, times: [t; 2] }
    }

    /// Returns the impact at time t (s), if nothing begins or ends until then.
    pub fn later(&self, t: f64) -> Self {
        let times = self.times.map(|time| if time < self.t { time } else { t });
        Self { t, times }
    }

    /// Returns the impact at time t (s), if nothing moves until then, and surfaces touch or do not.
    pub fn still(&self, t: f64, touch: bool) -> Self {
        let mut later = self.later(t);
        if touch {
            later.times[0] = later.times[0].min(self.t);
        }
        later
    }

    /// Returns the impact at time t (s). `ends` are the positions (m) and velocities (m/s) of the
    /// state before and now, and `touch` tells whether surfaces touch then and now.
    pub fn next(
        &self,
        layer: &ContactLayer,
        t: f64,
        ends: [[&[f64]; 2]; 2],
        touch: [bool; 2],
    ) -> Self {
        let mut next = self.still(t, touch[0]);
        let ended = next.times[1] < t;
        if touch[0] == touch[1] || ended {
            return next;
        }
        let mut x = vec![0.0; ends[0][0].len()];
        let (mut low, mut high) = (0.0, 1.0);
        // Until both times agree to double precision.
        for _ in 0..50 {
            let middle = f64::midpoint(low, high);
            between(ends, t - self.t, middle, &mut x);
            let at = self.t + middle * (t - self.t);
            if (layer.penetration(at, &x) > 0.0) == touch[0] {
                low = middle;
            } else {
                high = middle;
            }
        }
        next.times[usize::from(touch[0])] = self.t + low * (t - self.t);
        next
    }

    /// Returns the larger difference (s) between the times of two impacts.
    pub fn error_of(&self, other: &Self) -> f64 {
        let [begins, ends] = [0, 1].map(|k| (self.times[k] - other.times[k]).abs());
        begins.max(ends)
    }

    /// Applies a function to both times of two runs.
    pub fn extrapolate(coarse: &Self, fine: &Self, both: impl Fn(&f64, &f64) -> f64) -> Self {
        let times = [0, 1].map(|k| both(&coarse.times[k], &fine.times[k]));
        Self { t: fine.t, times }
    }
}

/// Writes the positions (m) at a fraction s of the time (s) between two states to x.
fn between([[xa, va], [xb, vb]]: [[&[f64]; 2]; 2], time: f64, s: f64, x: &mut [f64]) {
    let r = 1.0 - s;
    let [a, b] = [(1.0 + 2.0 * s) * r * r, (1.0 + 2.0 * r) * s * s];
    let [va_weight, vb_weight] = [s * r * r * time, -s * s * r * time];
    for (k, x) in x.iter_mut().enumerate() {
        *x = a * xa[k] + b * xb[k] + va_weight * va[k] + vb_weight * vb[k];
    }
}

/// Particles and times at which errors are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scope {
    /// The only particle whose position and phase count, or the only number or quantity of a state
    /// without particles; `None` for all of them.
    pub particle: Option<usize>,
    /// Whether only the last frame counts, instead of the largest error of all frames.
    pub at_end: bool,
}

impl Scope {
    /// Returns this scope.
    ///
    /// # Errors
    /// The model has no such particle or number.
    pub fn checked(self, model: &Model) -> Result<Self, Error> {
        let system = model.system();
        let (kind, count) = match (model.particles(), system.quantities()) {
            (0, 0) => ("number", system.dim()),
            (0, quantities) => ("quantity", quantities),
            (particles, _) => ("particle", particles),
        };
        let kinds = match kind {
            "quantity" => "quantities".into(),
            kind => format!("{kind}s"),
        };
        match self.particle {
            Some(i) if i >= count => Err(Error::Invalid(format!(
                "the scene has no {kind} {i}: its {kinds} are 0 to {}",
                count - 1
            ))),
            _ => Ok(self),
        }
    }
}

/// Errors of a state, or the largest ones over the frames of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Root mean square over the particles of the distance from their reference positions (m); 0
    /// without particles.
    pub position: f64,
    /// Root mean square over the numbers of a state without particles, or over its quantities, of
    /// their errors, each over the largest size that the number has had in the reference; 0 with
    /// particles.
    pub state: f64,
    /// Absolute error of the total energy (J); 0 for a system that does not know it.
    pub energy: f64,
    /// Root mean square over the structural springs of the error of length over rest length; 0
    /// without such springs.
    pub strain: f64,
    /// Length of the error of the total momentum of the particles that are not pinned (kg m/s); 0
    /// for a first-order scene.
    pub momentum: f64,
    /// Time (s) by which the run is ahead of the reference or behind it: the error of the positions
    /// along the reference velocities, over the largest speed squared of the reference. Without
    /// particles, those of the numbers of the state.
    pub phase: f64,
    /// Error of the penetration of surfaces in contact: the largest depth over the thickness. 0
    /// where surfaces do not touch.
    pub penetration: f64,
    /// Error of the first impact (s): the larger of the errors of its beginning and of its end. 0
    /// where surfaces do not touch.
    pub impact: f64,
}

impl Errors {
    /// Creates errors with the same value of each quantity.
    pub(super) fn with_all(error: f64) -> Self {
        let zero = Self::default();
        zero.with(zero, |_, _| error)
    }

    /// Applies a function to each quantity of both errors.
    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            position: f(self.position, other.position),
            state: f(self.state, other.state),
            energy: f(self.energy, other.energy),
            strain: f(self.strain, other.strain),
            momentum: f(self.momentum, other.momentum),
            phase: f(self.phase, other.phase),
            penetration: f(self.penetration, other.penetration),
            impact: f(self.impact, other.impact),
        }
    }

    /// Returns the larger of both errors in each quantity; NaN is larger than any number.
    pub(super) fn max(self, other: Self) -> Self {
        self.with(other, |a, b| if a >= b || a.is_nan() { a } else { b })
    }

    /// Returns the smaller of both errors in each quantity.
    pub(super) fn min(self, other: Self) -> Self {
        self.with(other, f64::min)
    }

    /// Returns the error of the positions or, without particles, of the state.
    pub(super) fn of_coordinates(&self) -> f64 {
        // One of both is 0.
        self.position + self.state
    }
}

/// Choice of one of the [`Errors`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// Error of the positions (m).
    #[default]
    Position,
    /// Error of the numbers of a state without particles, over their sizes.
    State,
    /// Error of the total energy (J).
    Energy,
    /// Error of length over rest length.
    Strain,
    /// Error of the total momentum (kg m/s).
    Momentum,
    /// Error of the phase (s).
    Phase,
    /// Error of the penetration of surfaces, as a share of the thickness.
    Penetration,
    /// Error of the times of the first impact (s).
    Impact,
}

impl Metric {
    /// Metrics of scenes with particles.
    pub const OF_PARTICLES: [Self; 7] = [
        Self::Position,
        Self::Energy,
        Self::Strain,
        Self::Momentum,
        Self::Phase,
        Self::Penetration,
        Self::Impact,
    ];

    /// Returns the name of the metric.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Energy => "energy",
            Self::Strain => "strain",
            Self::Momentum => "momentum",
            Self::Phase => "phase",
            Self::Penetration => "penetration",
            Self::Impact => "impact",
            Self::State => "state",
        }
    }

    /// Returns the metric of the motion of a model: the error of its positions or, without
    /// particles, of the numbers of its state.
    #[must_use]
    pub fn of_motion(model: &Model) -> Self {
        match model.particles() {
            0 => Self::State,
            _ => Self::Position,
        }
    }

    /// Checks that a model has particles, if the metric needs any, and none if it is for plain
    /// numbers.
    pub(super) fn check(self, model: &Model) -> Result<(), Error> {
        let why = match (self, model.particles()) {
            (Self::State | Self::Phase, 0) => return Ok(()),
            (_, 0) => {
                "the scene has no particles, but plain numbers: ask for the error of the state or \
                 of the phase"
            }
            (Self::State, _) => {
                "the scene has particles: ask for the error of their positions instead of that of \
                 the state"
            }
            _ => return Ok(()),
        };
        Err(Error::Invalid(why.into()))
    }

    /// Returns the error that the metric chooses, in its unit.
    #[must_use]
    pub fn of(self, errors: &Errors) -> f64 {
        match self {
            Self::Position => errors.position,
            Self::State => errors.state,
            Self::Energy => errors.energy,
            Self::Strain => errors.strain,
            Self::Momentum => errors.momentum,
            Self::Phase => errors.phase,
            Self::Penetration => errors.penetration,
            Self::Impact => errors.impact,
        }
    }
}
