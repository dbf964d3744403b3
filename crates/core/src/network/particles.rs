//! Particles of a network: their masses, and the pins that hold some of them.

use std::ops::Range;

use crate::elements::force::check_particle;
use crate::error::{Error, positive};
use crate::path::Path;
use crate::pin::Pin;

/// Masses and pins.
#[derive(Clone, Debug)]
pub(super) struct Particles {
    masses: Vec<f64>,
    /// One over the mass of each particle (1/kg), if all masses are the same.
    uniform_inverse_mass: Option<f64>,
    /// One over the mass of each particle (1/kg), 0 where it is pinned.
    inverse_masses: Vec<f64>,
    /// Particle with an inertia beyond its mass.
    burdened: Option<usize>,
    /// Pins that hold, in the order of their particles.
    pins: Vec<Pin>,
    /// Pins that have let go.
    released: Vec<Pin>,
    /// Times (s) from which on and before which these are the pins that hold.
    span: [f64; 2],
}

/// Times of pins that never let go.
const ALWAYS: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

impl Particles {
    /// Creates free particles of these masses (kg).
    pub fn new(masses: Vec<f64>) -> Result<Self, Error> {
        if masses.is_empty() {
            return Err(Error::Invalid("a network needs at least one particle".into()));
        }
        for &m in &masses {
            positive("a particle's mass", m)?;
        }
        Ok(Self {
            inverse_masses: masses.iter().map(|m| 1.0 / m).collect(),
            uniform_inverse_mass: uniform_inverse(&masses),
            burdened: None,
            pins: vec![],
            released: vec![],
            span: ALWAYS,
            masses,
        })
    }

    pub fn len(&self) -> usize {
        self.masses.len()
    }

    /// Checks that particle i exists.
    pub fn check(&self, i: usize) -> Result<(), Error> {
        check_particle(i, self.len())
    }

    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    pub fn inverse_masses(&self) -> &[f64] {
        &self.inverse_masses
    }

    pub fn uniform_inverse_mass(&self) -> Option<f64> {
        self.uniform_inverse_mass
    }

    /// Returns whether a rigid body carries particle i.
    pub fn is_carried(&self, i: usize) -> bool {
        self.masses[i] == 0.0
    }

    /// Sets the masses of particles that a rigid body carries from now on to 0.
    pub fn carry(&mut self, particles: Range<usize>) {
        for i in particles {
            (self.masses[i], self.inverse_masses[i]) = (0.0, 0.0);
        }
        self.uniform_inverse_mass = None;
    }

    /// Pins particle i to a path for good. Returns whether it was free.
    pub fn pin(&mut self, i: usize, path: Path) -> bool {
        let pin = Pin::new(i, path);
        self.inverse_masses[i] = 0.0;
        match self.pins.binary_search_by_key(&i, |pin| pin.particle) {
            Ok(k) => {
                let before = std::mem::replace(&mut self.pins[k], pin);
                self.forget_end(before);
                false
            }
            Err(k) => {
                self.pins.insert(k, pin);
                true
            }
        }
    }

    /// Adds pins. If a particle is named several times, its last pin counts.
    pub fn pin_all(&mut self, pins: Vec<Pin>) {
        for pin in &pins {
            self.inverse_masses[pin.particle] = 0.0;
        }
        self.pins.extend(pins);
        sort(&mut self.pins);
        self.pins.dedup_by(|later, first| {
            let same = later.particle == first.particle;
            if same {
                *first = *later;
            }
            same
        });
        self.find_span();
    }

    /// Frees particle i. Returns whether it was pinned.
    pub fn unpin(&mut self, i: usize) -> bool {
        let found = self.pins.binary_search_by_key(&i, |pin| pin.particle);
        if let Ok(k) = found {
            let before = self.pins.remove(k);
            self.inverse_masses[i] = 1.0 / self.masses[i];
            self.forget_end(before);
        }
        found.is_ok()
    }

    /// Forgets the pins that have let go: none of them holds again at an earlier time.
    pub fn forget_released(&mut self) {
        self.released.clear();
        self.find_span();
    }

    /// Lets the pins hold that hold at time t (s), and lets go of all others. Returns whether that
    /// changes any.
    pub fn pass_to(&mut self, t: f64) -> bool {
        if self.span[0] <= t && t < self.span[1] {
            return false;
        }
        let mut all = std::mem::take(&mut self.pins);
        let held = all.len();
        all.append(&mut self.released);
        // A particle that was pinned again since keeps its later pin.
        sort(&mut all);
        all.dedup_by_key(|pin| pin.particle);
        for pin in all {
            let i = pin.particle;
            if pin.holds_at(t) {
                self.inverse_masses[i] = 0.0;
                self.pins.push(pin);
            } else {
                self.inverse_masses[i] = 1.0 / self.masses[i];
                self.released.push(pin);
            }
        }
        self.find_span();
        held != self.pins.len()
    }

    /// Finds the times between which the same pins hold.
    fn find_span(&mut self) {
        let first = self.pins.iter().filter_map(|pin| pin.until);
        let last = self.released.iter().filter_map(|pin| pin.until);
        self.span = [last.fold(ALWAYS[0], f64::max), first.fold(ALWAYS[1], f64::min)];
    }

    /// Finds these times again if a pin that lets go was removed.
    fn forget_end(&mut self, removed: Pin) {
        if removed.until.is_some() {
            self.find_span();
        }
    }

    /// Returns the first time (s) at which a pin lets go; infinite if none does.
    pub fn next_release(&self) -> f64 {
        self.span[1]
    }

    /// Replaces the path of each pin by the result of `path` for it.
    pub fn lead_pins(&mut self, mut path: impl FnMut(usize, Path) -> Path) {
        for pin in &mut self.pins {
            pin.path = path(pin.particle, pin.path);
        }
    }

    /// Lets particle i move as if an inertia (kg) were added to its mass.
    pub fn burden(&mut self, i: usize, inertia: f64) {
        if self.inverse_masses[i] > 0.0 {
            self.inverse_masses[i] = 1.0 / (self.masses[i] + inertia);
            self.uniform_inverse_mass = None;
            self.burdened = Some(i);
        }
    }

    /// Lets all particles move by their masses alone.
    pub fn unburden(&mut self) {
        if let Some(i) = self.burdened.take() {
            if self.inverse_masses[i] > 0.0 {
                self.inverse_masses[i] = 1.0 / self.masses[i];
            }
            self.uniform_inverse_mass = uniform_inverse(&self.masses);
        }
    }

    /// Returns whether a particle has an inertia beyond its mass.
    pub fn is_burdened(&self) -> bool {
        self.burdened.is_some()
    }

    pub fn pins(&self) -> &[Pin] {
        &self.pins
    }

    /// Returns the pins that have let go.
    pub fn released(&self) -> &[Pin] {
        &self.released
    }

    /// Returns the pins among some particles.
    pub fn pins_of(&self, particles: Range<usize>) -> &[Pin] {
        let before = |i: usize| self.pins.partition_point(|pin| pin.particle < i);
        &self.pins[before(particles.start)..before(particles.end)]
    }

    pub fn is_pinned(&self, i: usize) -> bool {
        self.inverse_masses[i] == 0.0 && !self.is_carried(i)
    }
}

/// Returns one over the mass of each particle (1/kg), if all masses are the same.
fn uniform_inverse(masses: &[f64]) -> Option<f64> {
    let first = masses[0];
    (first > 0.0 && masses.iter().all(|m| *m == first)).then(|| 1.0 / first)
}

/// Sorts pins by their particles. Those of the same particle keep their order.
fn sort(pins: &mut [Pin]) {
    pins.sort_by_key(|pin| pin.particle);
}
