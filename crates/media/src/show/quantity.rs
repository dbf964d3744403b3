//! Quantities that colour particles, and vectors that arrows show.

use a3_core::{Mechanics, Network, Simulation};

/// A number of each particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Speed (m/s)
    Speed,
    /// Largest strain of the springs at a particle, or of its tetrahedra
    Strain,
    /// Sum of the forces on a particle that is free (N)
    Force,
    /// Force by which obstacles and surfaces touch a particle (N)
    Contact,
    /// Distance from the reference of a comparison (m)
    Error,
}

/// A vector of each particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrows {
    /// Velocity (m/s)
    Velocity,
    /// Sum of the forces on a particle (N)
    Force,
}

impl Quantity {
    /// All quantities, in the order of key v.
    pub const ALL: [Self; 5] = [Self::Speed, Self::Strain, Self::Force, Self::Contact, Self::Error];

    /// Returns the name of the quantity.
    pub fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Strain => "strain",
            Self::Force => "force",
            Self::Contact => "contact",
            Self::Error => "error",
        }
    }

    /// Returns the unit of the quantity, after a space.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Speed => " m/s",
            Self::Strain => "",
            Self::Force | Self::Contact => " N",
            Self::Error => " m",
        }
    }

    /// Returns whether a run has the quantity. `compared` says whether the run has a reference.
    pub fn is_in(self, simulation: &Simulation, compared: bool) -> bool {
        let network = simulation.model().network();
        match self {
            Self::Speed => true,
            Self::Strain => network.is_some_and(Network::is_elastic),
            Self::Force => network.is_some(),
            Self::Contact => network.is_some_and(Network::can_touch),
            Self::Error => compared,
        }
    }

    /// Returns the vectors whose lengths are the values, n x 3; empty if the values are no lengths.
    pub fn vectors(self, simulation: &Simulation, errors: &[f64]) -> Vec<f64> {
        match self {
            Self::Speed => simulation.velocities(),
            Self::Error => errors.to_vec(),
            Self::Strain | Self::Force | Self::Contact => vec![],
        }
    }

    /// Returns the value at each particle, NaN for one that has none; empty if the run does not
    /// have the quantity. `errors` are the vectors from the reference to the particles, n x 3 (m).
    pub fn values(self, simulation: &Simulation, errors: &[f64]) -> Vec<f64> {
        let network = simulation.model().network();
        match self {
            Self::Speed | Self::Error => lengths(&self.vectors(simulation, errors)),
            Self::Strain => network
                .filter(|network| network.is_elastic())
                .map(|network| network.strains(network.halves(simulation.state()).0))
                .unwrap_or_default(),
            Self::Force => {
                let mut forces = lengths(&forces(simulation));
                // Reaction forces at pins dwarf the others, so they are not shown.
                for (i, _) in network.into_iter().flat_map(Network::pins) {
                    forces[i] = 0.0;
                }
                // The forces on a body's points are summed at its centre.
                for body in network.into_iter().flat_map(Network::bodies) {
                    let on_body = forces[body.center()];
                    forces[body.points()].fill(on_body);
                }
                forces
            }
            Self::Contact => {
                let forces = simulation.contact_forces();
                forces.map(|forces| lengths(&forces)).unwrap_or_default()
            }
        }
    }
}

impl Arrows {
    /// Both vectors, in the order of key a.
    pub const ALL: [Self; 2] = [Self::Velocity, Self::Force];

    /// Returns the name of the vector.
    pub fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Force => "force",
        }
    }

    /// Returns the unit of the vector, after a space.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Velocity => " m/s",
            Self::Force => " N",
        }
    }

    /// Returns whether the scene has the vector.
    pub fn is_in(self, simulation: &Simulation) -> bool {
        self == Self::Velocity || simulation.model().network().is_some()
    }

    /// Returns the vectors, n x 3; empty if the scene does not have them.
    pub fn vectors(self, simulation: &Simulation) -> Vec<f64> {
        match self {
            Self::Velocity => simulation.velocities(),
            Self::Force => forces(simulation),
        }
    }
}

/// Returns the sum of all forces on each particle (N), n x 3; empty for a scene without forces.
fn forces(simulation: &Simulation) -> Vec<f64> {
    let Some(network) = simulation.model().network() else {
        return vec![];
    };
    let (x, v) = network.halves(simulation.state());
    let mut f = vec![0.0; x.len()];
    network.forces(simulation.time(), x, v, &mut f);
    f
}

/// Returns the lengths of the rows of an n x 3 matrix.
pub fn lengths(a: &[f64]) -> Vec<f64> {
    let n = a.len() / 3;
    let square = |i: usize| (0..3).map(|axis| a[axis * n + i].powi(2)).sum::<f64>();
    (0..n).map(|i| square(i).sqrt()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use a3_core::{Control, integrators};

    fn run(scene: &str) -> Simulation {
        let scene = a3_scenes::find(scene).unwrap().build(None).unwrap().scene;
        let method = integrators::find("rk4").unwrap();
        Simulation::new(scene, method, Control::Step(0.002)).unwrap()
    }

    #[test]
    fn values_are_those_of_the_run() {
        let mut run = run("chain");
        run.take_steps(100).unwrap();
        let (n, v) = (run.particles(), run.velocities());
        let speeds = Quantity::Speed.values(&run, &[]);
        assert_eq!(speeds.len(), n);
        let [vx, vy, vz] = [v[2], v[n + 2], v[2 * n + 2]];
        assert!((speeds[2] - vx.hypot(vy).hypot(vz)).abs() < 1e-14);
        let spring = run.model().network().unwrap().springs().next().unwrap();
        let length = (run.position(spring.i) - run.position(spring.j)).norm();
        let strain = (length / spring.law.rest_length - 1.0).abs();
        let strains = Quantity::Strain.values(&run, &[]);
        assert!(strains[spring.i].max(strains[spring.j]) >= strain && strain > 0.0);
        // The force on the last particle is its mass times its acceleration.
        let forces = Arrows::Force.vectors(&run);
        let mass = run.model().network().unwrap().masses()[n - 1];
        let mut rates = vec![0.0; 6 * n];
        run.model().system().eval_f(run.time(), run.state(), &mut rates);
        let a = rates[3 * n + 2 * n - 1];
        assert!((forces[2 * n - 1] - mass * a).abs() < 1e-12 && a.abs() > 0.1);
    }

    #[test]
    fn a_circle_has_a_speed_alone_and_a_solid_has_strain() {
        let circle = run("simple");
        assert!((Quantity::Speed.values(&circle, &[])[0] - 1.0).abs() < 1e-12);
        for quantity in Quantity::ALL {
            assert_eq!(quantity.values(&circle, &[]).is_empty(), !quantity.is_in(&circle, false));
        }
        assert_eq!(Quantity::Error.values(&circle, &[0.3, -0.4, 0.0]), [0.5]);
        assert!(Quantity::Error.is_in(&circle, true));
        assert!(Arrows::Force.vectors(&circle).is_empty() && !Arrows::Force.is_in(&circle));
        let mut bar = run("cantilever");
        let strains = |bar: &Simulation| Quantity::Strain.values(bar, &[]);
        assert!(strains(&bar).iter().all(|s| *s < 1e-9));
        bar.take_steps(50).unwrap();
        assert!(strains(&bar).iter().any(|s| *s > 1e-4));
    }

    #[test]
    fn what_lies_on_a_sphere_is_touched_where_it_lies() {
        let mut run = run("mit-sphere");
        assert!(Quantity::Contact.is_in(&run, false));
        run.take_steps(1000).unwrap();
        let values = Quantity::Contact.values(&run, &[]);
        let obstacle = &run.model().network().unwrap().obstacles()[0];
        let middle = obstacle.at(run.time()).place.position;
        let distances = (0..run.particles()).map(|i| (run.position(i) - middle).norm());
        let distances: Vec<_> = distances.collect();
        let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let mut touched = 0;
        for (value, distance) in values.iter().zip(distances) {
            assert!(*value == 0.0 || distance < nearest + 1e-6, "{value} N, {distance} m");
            touched += usize::from(*value > 0.0);
        }
        assert!(touched > 5, "{touched}");
    }

    #[test]
    fn a_body_is_one_for_forces_and_has_no_strain() {
        let mut run = run("ball-on-cloth");
        run.take_steps(20).unwrap();
        let values = |quantity: Quantity| quantity.values(&run, &[]);
        let network = run.model().network().unwrap();
        for body in network.bodies() {
            let weight = 9.81 * network.masses()[body.center()];
            for i in body.points() {
                assert!((values(Quantity::Force)[i] / weight - 1.0).abs() < 0.1);
                assert!(values(Quantity::Strain)[i].is_nan());
                assert!((values(Quantity::Speed)[i] - 0.04 * 9.81).abs() < 0.01);
            }
        }
    }
}
