//! Passage of a run from a scene to the same scene after an edit: which particles stay.

use a3_core::{Checkpoint, Constraint, Network, Pin, Scene, Simulation};
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
    /// Whether surfaces touch there; `None` if they do as before.
    pub touching: Option<bool>,
}

impl Passage {
    /// Returns whether a state of `dim` numbers passes to one of the scene.
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
        let renumbered = |pin: &Pin| {
            let particle = number(pin.particle)?;
            Some(Pin { particle, ..*pin })
        };
        moment.pins = moment.pins.iter().filter_map(renumbered).collect();
        let renumbered = |i: &u32| Some(number(*i as usize)? as u32);
        moment.drained = moment.drained.iter().filter_map(renumbered).collect();
        let back = self.particles.back();
        let added = new
            .all_pins()
            .filter(|pin| back.number(pin.particle).is_none());
        moment.pins.extend(added);
        // Ropes, and ends of joints.
        let kind = |it: &Constraint| match it {
            Constraint::Rope { .. } => Some(None),
            Constraint::Stop(stop) => Some(Some(stop.is_upper)),
            _ => None,
        };
        let before = |k: &usize| {
            let constraint = old.constraints().get(*k)?;
            let (first, second) = constraint.ends();
            let second = match second {
                Some(j) => Some(number(j)?),
                None => None,
            };
            Some((kind(constraint)?, (number(first)?, second)))
        };
        let taut: Vec<_> = moment.taut.iter().filter_map(before).collect();
        let is_taut =
            |it: &Constraint| kind(it).is_some_and(|kind| taut.contains(&(kind, it.ends())));
        let all = new.constraints().iter().enumerate();
        moment.taut = all.filter(|(_, it)| is_taut(it)).map(|(k, _)| k).collect();
    }

    /// Returns the state in the edited scene from that of n particles before it.
    fn state(&self, y: &[f64], n: usize, next: &Simulation) -> Vec<f64> {
        let (m, mut state) = (next.particles(), next.state().to_vec());
        let before = |j: usize| self.particles.back().number(j);
        for (j, i) in (0..m).filter_map(|j| Some((j, before(j)?))) {
            for axis in 0..PARTICLE {
                state[axis * m + j] = y[axis * n + i];
            }
        }
        let (old, new) = (&y[PARTICLE * n..], &mut state[PARTICLE * m..]);
        for (l, own) in new.chunks_exact_mut(BODY).enumerate() {
            if let Some(k) = self.bodies.back().number(l) {
                own.copy_from_slice(&old[BODY * k..BODY * (k + 1)]);
            }
        }
        state
    }
}
