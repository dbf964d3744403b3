//! Parts that evaluations of a network share: its forces, with gravity and drag in them or in
//! drifts; prescribed motion; forces and torques on rigid bodies; the energy; and the network as
//! sweeps see it, row by row of its sheets.

use std::ops::Range;

use nalgebra::Vector3;

use super::elements::Element;
use super::parts::Network;
use super::surfaces::Prescribed;
use crate::constraints::Turning;
use crate::contact::{ContactLayer, Obstacle};
use crate::elements::force::{At, DriftForces};
use crate::elements::sheet::{Advance, LAWS, SPRING_FORCES, begin};
use crate::elements::{Finish, Flow, Gravity, Sheet, flow_each};
use crate::energy::Energy;
use crate::path::Path;
use crate::random::SplitMix;
use crate::rigid::{Body, Rotation};
use crate::rows::{Patch, Registers, Rows, Stage, SweepScratch, Terms};

/// Returns the arguments of the elements of a network.
pub(super) fn at<'a>(network: &'a Network, t: f64, x: &'a [f64], v: &'a [f64]) -> At<'a> {
    At { t, x, v, masses: network.particles.masses(), triangles: &network.surfaces.triangles }
}

/// Writes all forces except those of constraints to f.
pub(super) fn other_forces(network: &Network, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
    let finish = finish(network, Terms::AllForces);
    network.elements.evaluate(&at(network, t, x, v), f, &finish);
}

/// Returns whether drifts apply gravity and drag, and kicks the other forces: not with constraints,
/// which hold against all forces together, nor with a particle whose inertia is not its mass.
pub(super) fn is_split(network: &Network, terms: Terms) -> bool {
    let together = !network.constraints.all().is_empty() || network.particles.is_burdened();
    terms == Terms::KickForces && !together
}

/// Returns gravity and drag where drifts apply them; otherwise nothing.
pub(super) fn drift_forces(network: &Network, terms: Terms) -> DriftForces {
    if is_split(network, terms) { network.elements.drift_forces() } else { DriftForces::default() }
}

/// Returns gravity and drag where no drift applies them, to be added last; otherwise nothing.
pub(super) fn finish(network: &Network, terms: Terms) -> Finish<'_> {
    if is_split(network, terms) {
        return Finish::default();
    }
    let DriftForces { gravity, drag } = network.elements.drift_forces();
    let masses = network.particles.masses();
    Finish {
        gravity: (gravity != Vector3::zeros()).then_some((gravity, masses)),
        drag: (drag > 0.0).then_some(drag),
        ..Finish::default()
    }
}

/// Moves particles by a drift. Pins are put in their places afterwards.
pub(super) fn flow(
    network: &Network,
    terms: Terms,
    h: f64,
    particles: Range<usize>,
    x: [&mut [f64]; 3],
    v: [&mut [f64]; 3],
) {
    let DriftForces { drag, gravity } = drift_forces(network, terms);
    if let Some(w) = network.particles.uniform_inverse_mass() {
        Flow::new(drag, gravity, w, h).apply(x, v);
    } else {
        let inverse_masses = &network.particles.inverse_masses()[particles];
        flow_each(drag, gravity, inverse_masses, h, x, v);
    }
}

/// Returns the motion that the scene prescribes.
pub(super) fn prescribed(network: &Network) -> Prescribed<'_> {
    Prescribed {
        particles: &network.particles,
        obstacles: network.surfaces.obstacles(),
        wind: network.elements.wind(),
    }
}

/// Writes the positions and velocities of the pins of a row at time t (s).
fn place_row(
    network: &Network,
    t: f64,
    particles: Range<usize>,
    row: usize,
    registers: &mut Registers,
) {
    for pin in network.particles.pins_of(particles.clone()) {
        let place = pin.at(t);
        let columns = registers.stage_mut(row);
        for axis in 0..3 {
            let i = pin.particle - particles.start;
            columns[axis][i] = place.position[axis];
            columns[3 + axis][i] = place.velocity[axis];
        }
    }
}

/// Returns the sheet whose rows are this patch, if there is one.
fn patch_sheet(network: &Network, patch: usize) -> Option<&Sheet> {
    network.elements.sheets().nth(patch)
}

impl Rows for Network {
    fn patches(&self) -> usize {
        self.sheets().count()
    }

    fn patch(&self, patch: usize) -> Patch {
        let of = |sheet: &Sheet| Patch {
            first: sheet.particles().start,
            rows: sheet.grid().rows(),
            cols: sheet.grid().cols(),
        };
        patch_sheet(self, patch).map_or_else(Patch::default, of)
    }

    fn kept_columns(&self) -> usize {
        SPRING_FORCES
    }

    fn shared_numbers(&self) -> usize {
        LAWS
    }

    fn begin(&self, patch: usize, scratch: &mut SweepScratch) {
        if let Some(sheet) = patch_sheet(self, patch) {
            begin(sheet, scratch);
        }
    }

    fn drift(
        &self,
        patch: usize,
        terms: Terms,
        (t, h): (f64, f64),
        row: usize,
        registers: &mut Registers,
    ) {
        let particles = self.patch(patch).row(row);
        let [x, y, z, u, v, w] = registers.stage_mut(row);
        flow(self, terms, h, particles.clone(), [x, y, z], [u, v, w]);
        place_row(self, t + h, particles, row, registers);
    }

    fn advance(
        &self,
        patch: usize,
        number: usize,
        stage: &Stage,
        rows: Range<usize>,
        registers: &mut Registers,
        scratch: &mut SweepScratch,
    ) {
        let Some(sheet) = patch_sheet(self, patch) else {
            return;
        };
        let place = self.patch(patch);
        let finish = Finish {
            inverse_masses: Some(self.particles.inverse_masses()),
            ..finish(self, stage.terms)
        };
        let flow = self.particles.uniform_inverse_mass().filter(|_| stage.drift != 0.0);
        let flow = flow.map(|w| {
            let DriftForces { drag, gravity } = drift_forces(self, stage.terms);
            Flow::new(drag, gravity, w, stage.drift)
        });
        let added = self.elements.by_particle().next().is_some();
        for row in rows {
            if added {
                let [x, y, z, ..] = registers.stage(row);
                let mut addends = scratch.addends_mut();
                for addends in &mut addends {
                    addends.fill(0.0);
                }
                self.elements
                    .by_particle()
                    .for_each(|force| force.add(stage.t, [x, y, z], &mut addends));
            }
            Advance { sheet, added, finish: &finish, flow, number, stage, row, registers, scratch }
                .run();
            if stage.drift == 0.0 || flow.is_some() {
                place_row(self, stage.until, place.row(row), row, registers);
            } else {
                let times = (stage.t, stage.drift);
                Rows::drift(self, patch, stage.terms, times, row, registers);
            }
        }
    }
}

/// Force (N) and torque about the centre (N m) on a body.
#[derive(Clone, Copy, Default)]
pub(super) struct Wrench {
    pub force: Vector3<f64>,
    pub torque: Vector3<f64>,
}

/// Forces (N) on all particles at x (m), n x 3 each, and torques (N m) on bodies besides those of
/// these forces, three numbers each.
#[derive(Clone, Copy)]
pub(super) struct Loads<'a> {
    pub x: &'a [f64],
    pub f: &'a [f64],
    pub torques: &'a [f64],
}

/// Returns the force and torque on body k, from the forces on its particles and its torques. Drag
/// damps the rotation at the same rate c / m as the motion of the centre.
pub(super) fn wrench(
    network: &Network,
    k: usize,
    rotation: &Rotation,
    terms: Terms,
    Loads { x, f, torques }: Loads,
) -> Wrench {
    let body = &network.bodies()[k];
    let center = row(x, body.center());
    let mut wrench = Wrench {
        force: row(f, body.center()),
        torque: Vector3::from_column_slice(&torques[3 * k..3 * k + 3]),
    };
    for i in body.points() {
        let force = row(f, i);
        wrench.force += force;
        wrench.torque += (row(x, i) - center).cross(&force);
    }
    if !is_split(network, terms) {
        wrench.torque -= rotation.momentum * decay(network, body);
    }
    wrench
}

/// Returns the rotation of body k and acceleration of its centre (m/s2) under these loads in the
/// state y.
pub(super) fn turning(
    network: &Network,
    k: usize,
    y: &[f64],
    terms: Terms,
    loads: Loads,
) -> (Turning, Vector3<f64>) {
    let (body, rotation) = (&network.bodies()[k], network.rotation(k, y));
    let moving = body.moving(&rotation);
    let wrench = wrench(network, k, &rotation, terms, loads);
    let turning = Turning {
        center: row(loads.x, body.center()),
        rotation: moving.rotation,
        spin: moving.spin,
        acceleration: moving.angular_acceleration(&body.inertia(), wrench.torque),
        inverse_inertia: body.inertia().map(|moment| 1.0 / moment),
    };
    (turning, wrench.force * network.particles.inverse_masses()[body.center()])
}

/// Returns the rate (1/s) at which drag damps the motion of a body.
pub(super) fn decay(network: &Network, body: &Body) -> f64 {
    network.elements.drift_forces().drag / network.masses()[body.center()]
}

/// Returns row i of an n x 3 matrix.
fn row(a: &[f64], i: usize) -> Vector3<f64> {
    let n = a.len() / 3;
    Vector3::new(a[i], a[n + i], a[2 * n + i])
}

/// Returns the energy in the state (x, v) at time t (s).
pub(super) fn energy_at(network: &Network, t: f64, x: &[f64], v: &[f64]) -> Energy {
    let of_axis = |v: &[f64]| -> f64 {
        let of_one = |(v, m): (&f64, &f64)| 0.5 * m * v * v;
        v.iter().zip(network.masses()).map(of_one).sum()
    };
    let mut energy = Energy {
        kinetic: v.chunks_exact(network.particles()).map(of_axis).sum(),
        ..Energy::default()
    };
    for element in network.elements() {
        energy += element.force().energy(&at(network, t, x, v));
    }
    energy
}

/// Returns the energy of the state y at time t (s), that of rotations included.
pub(super) fn energy_of(network: &Network, t: f64, y: &[f64]) -> Energy {
    let (x, v) = network.halves(y);
    let mut energy = energy_at(network, t, x, v);
    for (k, body) in network.bodies().iter().enumerate() {
        energy.kinetic += body.energy(&network.rotation(k, y));
    }
    energy
}

/// Returns the energy (J) that errors of all positions, of up to `error` (m), add in the state y at
/// time t (s): elastic energy, and that of the motion that corrects errors of constraints.
pub(crate) fn energy_of_errors(network: &Network, t: f64, y: &[f64], error: f64) -> f64 {
    let (mut off, mut random) = (y.to_vec(), SplitMix(1));
    for x in &mut off[..3 * network.particles()] {
        *x += random.between(-error, error);
    }
    let elastic = energy_of(network, t, &off).elastic - energy_of(network, t, y).elastic;
    let mass = network.masses().iter().sum::<f64>();
    let rate =
        if network.is_constrained() { network.constraints.baumgarte_frequency() } else { 0.0 };
    let correction = 0.5 * mass * (error * rate).powi(2);
    let all = elastic.max(0.0) + correction;
    if all.is_finite() { all } else { 0.0 }
}

/// Adds the forces of wind (N) in the state (x, v) at time t (s) to f.
pub(crate) fn add_wind(network: &Network, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
    for element in network.elements() {
        if element.force().is_wind() {
            element.force().add_forces(&at(network, t, x, v), f);
        }
    }
}

/// Returns whether motors drive bodies.
pub(crate) fn has_motors(network: &Network) -> bool {
    !network.bodies.motors().is_empty()
}

/// Returns the power (W) of the constraints at the last evaluation: where velocities do not fit
/// them, their forces work, which no exact motion does.
pub(crate) fn constraint_power(network: &Network) -> f64 {
    network.constraints.power()
}

/// Returns whether the forces conserve energy: there is no damping, no wind, no motor and no
/// prescribed motion, and no spring is shortened or breaks. Contact with obstacles is left out.
pub(crate) fn is_conservative(network: &Network) -> bool {
    let loses = |element: &Element| {
        let force = element.force();
        force.is_driven() || force.reads_velocity()
    };
    let mut paths = network.all_pins().map(|pin| pin.path);
    !network.elements().iter().any(loses)
        && paths.all(|path| matches!(path, Path::Still(_)))
        && network.obstacles().iter().all(Obstacle::is_still)
        && network.strain_limits().is_empty()
        && !has_motors(network)
}

/// Returns whether nothing holds a network in the world: its motion is the same to observers with
/// different uniform velocities.
pub(crate) fn is_loose(network: &Network) -> bool {
    let is_inner = |element: &Element| {
        let is_uniform = element.get::<Gravity>().is_some();
        is_uniform || element.get::<ContactLayer>().is_some() || element.force().matter().is_some()
    };
    let mut constraints = network.constraints().iter();
    network.elements().iter().all(is_inner)
        && network.pins().next().is_none()
        && network.obstacles().is_empty()
        && constraints.all(|constraint| constraint.ends().1.is_some())
}
