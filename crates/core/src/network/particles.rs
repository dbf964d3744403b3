//! Particles of a network: their masses, and the pins that hold some of them.

use std::ops::Range;

use crate::elements::force::check_particle;
use crate::error::{Error, positive};
use crate::path::Path;

/// A pinned particle and its path.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pin {
    pub particle: usize,
    pub path: Path,
}

/// Masses and pins.
#[derive(Clone, Debug)]
pub(super) struct Particles {
    masses: Vec<f64>,
    /// One over the mass of each particle (1/kg), if all masses are the same.
    uniform_inverse_mass: Option<f64>,
    /// One over the mass of each particle (1/kg), 0 where it is pinned.
    inverse_masses: Vec<f64>,
    /// Pins in the order of their particles.
    pins: Vec<Pin>,
}

impl Particles {
    /// Creates free particles of these masses (kg).
    pub fn new(masses: Vec<f64>) -> Result<Self, Error> {
        if masses.is_empty() {
            return Err(Error::Invalid(
                "a network needs at least one particle".into(),
            ));
        }
        for &m in &masses {
            positive("a particle's mass", m)?;
        }
        let uniform = masses.iter().all(|&m| m == masses[0]);
        Ok(Self {
            inverse_masses: masses.iter().map(|m| 1.0 / m).collect(),
            uniform_inverse_mass: uniform.then(|| 1.0 / masses[0]),
            pins: vec![],
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

    /// Whether a rigid body carries particle i.
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

    /// Pins particle i to a path. Returns whether it was free.
    pub fn pin(&mut self, i: usize, path: Path) -> bool {
        self.inverse_masses[i] = 0.0;
        match self.pins.binary_search_by_key(&i, |pin| pin.particle) {
            Ok(k) => {
                self.pins[k].path = path;
                false
            }
            Err(k) => {
                self.pins.insert(k, Pin { particle: i, path });
                true
            }
        }
    }

    /// Pins particles to paths. If one is named several times, its last path counts.
    pub fn pin_all(&mut self, pins: Vec<(usize, Path)>) {
        for &(i, _) in &pins {
            self.inverse_masses[i] = 0.0;
        }
        let pins = pins
            .into_iter()
            .map(|(particle, path)| Pin { particle, path });
        self.pins.extend(pins);
        self.pins.sort_by_key(|pin| pin.particle);
        self.pins.dedup_by(|later, first| {
            let same = later.particle == first.particle;
            if same {
                first.path = later.path;
            }
            same
        });
    }

    /// Frees particle i. Returns whether it was pinned.
    pub fn unpin(&mut self, i: usize) -> bool {
        let found = self.pins.binary_search_by_key(&i, |pin| pin.particle);
        if let Ok(k) = found {
            self.pins.remove(k);
            self.inverse_masses[i] = 1.0 / self.masses[i];
        }
        found.is_ok()
    }

    /// Replaces the path of each pin by the result of `path` for it.
    pub fn lead_pins(&mut self, mut path: impl FnMut(usize, Path) -> Path) {
        for pin in &mut self.pins {
            pin.path = path(pin.particle, pin.path);
        }
    }

    pub fn pins(&self) -> &[Pin] {
        &self.pins
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
