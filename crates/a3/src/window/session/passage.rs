//! Passage of a run from a scene to the same scene after an edit: which particles stay, and where
//! those begin that are added.

use a3_core::{Checkpoint, Constraint, Network, Path, Scene, Simulation};
use a3_scenes::Splice;

/// Numbers that the state has for each particle: its position (m) and its velocity (m/s).
const PARTICLE: usize = 6;
/// Numbers that the state has for each rigid body: its quaternion and its angular momentum.
const BODY: usize = 7;

/// Passage of runs to an edited scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Passage {
    /// How particles are numbered there.
    pub particles: Splice,
    /// How rigid bodies are numbered there.
    pub bodies: Splice,
    /// State of the particles and the bodies that are added, where it is not that at the start.
    pub returning: Option<Removed>,
    /// Whether surfaces touch there; `None` if they do as before.
    pub touching: Option<bool>,
}

/// State of what an edit removed.
#[derive(Clone, Debug, PartialEq)]
pub struct Removed {
    /// Positions (m) and velocities (m/s) of its particles.
    particles: Vec<[f64; PARTICLE]>,
    /// Quaternions and angular momenta of its bodies (kg m2/s).
    bodies: Vec<[f64; BODY]>,
    /// Pins, by the numbers of their particles.
    pins: Vec<(usize, Path)>,
}

impl Removed {
    /// Reads what these splices remove from a run.
    pub fn from(run: &Simulation, particles: Splice, bodies: Splice) -> Self {
        let (y, n) = (run.state(), run.particles());
        let numbers = |it: Splice| it.at..it.at + it.removed;
        let particle = |i: usize| std::array::from_fn(|axis| y[axis * n + i]);
        let body = |k: usize| std::array::from_fn(|axis| y[PARTICLE * n + BODY * k + axis]);
        let pins = run.model().network().into_iter().flat_map(Network::pins);
        Self {
            particles: numbers(particles).map(particle).collect(),
            bodies: numbers(bodies).map(body).collect(),
            pins: pins
                .filter(|(i, _)| numbers(particles).contains(i))
                .collect(),
        }
    }
}

impl Passage {
    /// Whether a state of `dim` numbers passes to one of the scene.
    pub fn fits(&self, dim: usize, scene: &Scene) -> bool {
        let change = |it: Splice, each: usize| [it.added * each, it.removed * each];
        let [more, fewer] = change(self.particles, PARTICLE);
        let [more_turned, fewer_turned] = change(self.bodies, BODY);
        dim + more + more_turned == scene.state.len() + fewer + fewer_turned
    }

    /// Passes a moment of a run to `next`, which is at the start of the edited scene.
    pub fn take(&self, moment: &mut Checkpoint, run: &Simulation, next: &Simulation) {
        let (Some(old), Some(new)) = (run.model().network(), next.model().network()) else {
            return;
        };
        let number = |i: usize| self.particles.number(i);
        let pair = |[i, j]: [usize; 2]| Some([number(i)?, number(j)?]);
        // What the old scene itself had torn is not torn for good: the new scene says what is.
        let scene = run.scene().model.network();
        let own = scene.map_or(&[][..], Network::torn);
        moment.torn.retain(|ends| own.binary_search(ends).is_err());
        moment.torn = moment.torn.iter().filter_map(|ends| pair(*ends)).collect();
        moment.torn.extend_from_slice(new.torn());
        moment.torn.sort_unstable();
        moment.torn.dedup();
        if let Some(touching) = self.touching {
            moment.touching = touching;
        }
        if (self.particles, self.bodies) != (Splice::default(), Splice::default()) {
            moment.run.y = self.state(&moment.run.y, run.particles(), next);
        }
        let pins = moment.pins.iter();
        moment.pins = pins
            .filter_map(|(i, path)| Some((number(*i)?, *path)))
            .collect();
        let returning = self.returning.iter().flat_map(|it| &it.pins);
        moment.pins.extend(returning);
        let ends = |k: &usize| {
            let (i, j) = old.constraints().get(*k)?.ends();
            pair([i, j?])
        };
        let ropes: Vec<_> = moment.taut.iter().filter_map(ends).collect();
        let is_taut = |rope: &Constraint| match *rope {
            Constraint::Rope { i, j, .. } => ropes.contains(&[i, j]),
            _ => false,
        };
        let all = new.constraints().iter().enumerate();
        moment.taut = all.filter(|(_, it)| is_taut(it)).map(|(k, _)| k).collect();
    }

    /// Returns the state in the edited scene from that of n particles before it.
    fn state(&self, y: &[f64], n: usize, next: &Simulation) -> Vec<f64> {
        let (m, mut state) = (next.particles(), next.state().to_vec());
        let returning = self.returning.as_ref();
        for i in 0..m {
            let added = i.wrapping_sub(self.particles.at);
            let kept = self.particles.back().number(i);
            let removed = returning.and_then(|it| it.particles.get(added));
            for axis in 0..PARTICLE {
                let own = &mut state[axis * m + i];
                *own = match (kept, removed) {
                    (Some(before), _) => y[axis * n + before],
                    (None, Some(row)) => row[axis],
                    (None, None) => *own,
                };
            }
        }
        for (k, own) in state[PARTICLE * m..].chunks_exact_mut(BODY).enumerate() {
            let added = k.wrapping_sub(self.bodies.at);
            let removed = returning.and_then(|it| it.bodies.get(added));
            match (self.bodies.back().number(k), removed) {
                (Some(before), _) => {
                    let first = PARTICLE * n + BODY * before;
                    own.copy_from_slice(&y[first..first + BODY]);
                }
                (None, Some(row)) => own.copy_from_slice(row),
                (None, None) => {}
            }
        }
        state
    }
}
