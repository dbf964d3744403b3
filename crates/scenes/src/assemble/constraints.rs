//! Rods, ropes and wires, joints of rigid bodies, and particles that are attached to these.

use a3_core::constraints::{Joint, JointKind, Stop};
use a3_core::rigid::{Drive, Motor};
use a3_core::{Constraint, Network, Path, Pose, Scene, Vector3};

use super::motion::Pinned;
use crate::budget::{Budget, RODS};
use crate::description::{ConstraintSpec, Description, JointSpec};
use crate::fault::{Fault, at, key_of, share};

/// Largest error of a constraint at the start, relative to its length.
const MAX_INITIAL_ERROR: f64 = 1e-3;

/// Checks that the initial state meets the constraints.
pub(super) fn check(description: &Description, scene: &Scene) -> Result<(), Fault> {
    let network = scene.model.network();
    let (_, radius) = scene.extent();
    let worst = network.and_then(|network| network.worst_constraint(&scene.state, radius));
    let Some((network, unmet)) = network.zip(worst.filter(|unmet| unmet.share > MAX_INITIAL_ERROR))
    else {
        return Ok(());
    };
    // The rods of chains come first, and joints, which begin where the bodies are, last.
    let count = description.constraint.len();
    let is_joint = |it: &&Constraint| matches!(it, Constraint::Joint(_) | Constraint::Stop(_));
    let joints = network.constraints().iter().filter(is_joint).count();
    let rods = network.constraints().len() - joints - count;
    let (key, number) = match unmet.number.checked_sub(rods) {
        Some(k) => (key_of("constraint", k, count), format!("constraint {k}, ")),
        None => ("chain".into(), String::new()),
    };
    let why = format!(
        "{number}{}, is off by {:.3} % at the start, and a scene has to begin with its constraints met",
        unmet.constraint,
        100.0 * unmet.share
    );
    Err(Fault::new(key, why))
}

/// Adds the constraints of the description. A rod or a rope without a length has the
/// distance of its particles in the initial state.
pub(super) fn add(
    description: &Description,
    network: &mut Network,
    state: &[f64],
) -> Result<(), Fault> {
    if let Some(w) = description.feedback {
        at("feedback", network.set_baumgarte_frequency(w))?;
    }
    let all = &description.constraint;
    for (k, spec) in all.iter().enumerate() {
        let added = constraint(spec, network, state)
            .and_then(|constraint| at("", network.add_constraint(constraint)));
        added.map_err(|fault| fault.within(&key_of("constraint", k, all.len())))?;
    }
    Ok(())
}

fn constraint(
    spec: &ConstraintSpec,
    network: &Network,
    state: &[f64],
) -> Result<Constraint, Fault> {
    let is_wire = spec.point.is_some()
        || spec.line.is_some()
        || spec.circle.is_some()
        || spec.sphere.is_some();
    let restitution = spec.restitution;
    match (spec.rod, spec.rope, spec.particle) {
        (Some(ends @ [i, j]), None, None) | (None, Some(ends @ [i, j]), None) if !is_wire => {
            let is_rope = spec.rope.is_some();
            let key = if is_rope { "rope" } else { "rod" };
            for end in ends {
                at(key, network.check_particle(end))?;
            }
            refuse!(if i == j => key: "it must join two different particles, not {i} with itself");
            let apart = place(network, state, i) - place(network, state, j);
            let length = spec.length.unwrap_or(apart.norm());
            if is_rope {
                at("restitution", share("it", restitution))?;
                return Ok(Constraint::Rope { i, j, length, restitution });
            }
            refuse!(if restitution != 0.0 => "restitution": "only a rope has this key");
            Ok(Constraint::Rod { i, j, length })
        }
        (None, None, Some(particle)) if restitution == 0.0 && spec.length.is_none() => {
            at("particle", network.check_particle(particle))?;
            wire(particle, spec)
        }
        _ => refuse!("":
            "give either `rod` or `rope` with two particles, or `particle` with one of `point`, `line`, `circle` and `sphere`"),
    }
}

/// Returns the position of a particle in a state (m).
fn place(network: &Network, state: &[f64], i: usize) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| state[axis * network.particles() + i])
}

/// Creates the constraint of a particle to a point, a line, a circle or a sphere.
fn wire(particle: usize, spec: &ConstraintSpec) -> Result<Constraint, Fault> {
    Ok(match (spec.point, &spec.line, &spec.circle, &spec.sphere) {
        (Some(position), None, None, None) => {
            Constraint::Point { particle, position: Vector3::from(position) }
        }
        (None, Some(line), None, None) => Constraint::Line {
            particle,
            point: Vector3::from(line.point),
            direction: Vector3::from(line.direction),
        },
        (None, None, Some(circle), None) => Constraint::Circle {
            particle,
            center: Vector3::from(circle.center),
            normal: Vector3::from(circle.normal),
            radius: circle.radius,
        },
        (None, None, None, Some(sphere)) => Constraint::Sphere {
            particle,
            center: Vector3::from(sphere.center),
            radius: sphere.radius,
        },
        _ => refuse!("": "give one of `point`, `line`, `circle` and `sphere`"),
    })
}

/// Largest numbers of joints and of attached particles: the time of a step may grow with the square
/// of these.
const MAX_JOINTS: usize = 1000;
const MAX_ATTACHED: usize = 10_000;

/// Number of rods that take as much memory as a joint with its limits.
const RODS_PER_JOINT: usize = 6;

/// Adds the joints of the description, and the attached particles, where they are in a state.
pub(super) fn add_joints(
    description: &Description,
    budget: &mut Budget,
    pins: &Pinned,
    network: &mut Network,
    state: &[f64],
) -> Result<(), Fault> {
    let all = &description.joint;
    let (attached, of_bodies) = (pins.attached.len(), "particles that are attached to bodies");
    for (key, count, most, what) in [
        ("joint", all.len(), MAX_JOINTS, "joints"),
        ("pin.body", attached, MAX_ATTACHED, of_bodies),
    ] {
        refuse!(if count > most => key: "the scene has {count} {what}; at most {most} are allowed");
    }
    budget.spend("joint", RODS_PER_JOINT * all.len(), RODS)?;
    for (k, spec) in all.iter().enumerate() {
        let added = join(spec, network, state);
        added.map_err(|fault| fault.within(&key_of("joint", k, all.len())))?;
    }
    for &(i, k) in &pins.attached {
        at("pin.body", check_body(network, k))?;
        let there = place(network, state, i);
        let own = Pose { place: Path::Still(there).at(0.0), orientation: None };
        let (center, pose) = (network.bodies()[k].center(), network.pose(k, state));
        let sides = ((i, &own), Some((center, &pose)));
        let length = network.bodies()[k].radius();
        let joint = Joint::new(JointKind::Ball, sides, (there, Vector3::x()), length);
        let joint = at("pin.body", joint)?;
        at("pin.body", network.add_constraint(Constraint::Joint(joint)))?;
    }
    Ok(())
}

/// Adds a joint, with its limits and its motor.
fn join(spec: &JointSpec, network: &mut Network, state: &[f64]) -> Result<(), Fault> {
    let (moved, other) = match (spec.body, spec.bodies) {
        (Some(k), None) => (k, None),
        (None, Some([other, k])) => (k, Some(other)),
        _ => refuse!("":
            "give either `body`, for a joint with the world, or `bodies` with two numbers"),
    };
    let key = if other.is_some() { "bodies" } else { "body" };
    for k in other.into_iter().chain([moved]) {
        at(key, check_body(network, k))?;
    }
    let pose = |k: usize| (network.bodies()[k].center(), network.pose(k, state));
    let (own, against) = (pose(moved), other.map(pose));
    let center = own.1.place.position;
    let x = Vector3::x();
    let (hinge, slider) = (spec.hinge.as_ref(), spec.slider.as_ref());
    let kinds = [
        spec.ball.map(|there| ("ball", JointKind::Ball, there.into(), x)),
        hinge.map(|it| ("hinge.axis", JointKind::Hinge, it.at.into(), it.axis.into())),
        slider.map(|it| ("slider.axis", JointKind::Slider, center, it.axis.into())),
        spec.fixed.then_some(("fixed", JointKind::Fixed, center, x)),
    ];
    let mut kinds = kinds.into_iter().flatten();
    let (Some((key, kind, there, axis)), None) = (kinds.next(), kinds.next()) else {
        refuse!("": "give one of `ball`, `hinge`, `slider` and `fixed = true`");
    };
    let other_side = against.as_ref().map(|(i, pose)| (*i, pose));
    let sides = ((own.0, &own.1), other_side);
    let length = network.bodies()[moved].radius();
    let joint = at(key, Joint::new(kind, sides, (there, axis), length))?;
    at("", network.add_constraint(Constraint::Joint(joint)))?;
    let free = match (&spec.hinge, &spec.slider) {
        (Some(hinge), _) => Free {
            name: "hinge",
            limits: hinge.limits,
            restitution: hinge.restitution,
            drive: Drive::Rotary,
            effort: ("torque", hinge.torque),
            speed: hinge.speed,
        },
        (_, Some(slider)) => Free {
            name: "slider",
            limits: slider.limits,
            restitution: slider.restitution,
            drive: Drive::Linear,
            effort: ("force", slider.force),
            speed: slider.speed,
        },
        _ => return Ok(()),
    };
    let added = free.limit(network, joint);
    let added = added.and_then(|()| free.drive(network, (moved, other), &joint));
    added.map_err(|fault| fault.within(free.name))
}

/// Motion that a hinge or a slider lets free: its limits and its motor.
struct Free {
    /// Key of the joint.
    name: &'static str,
    limits: Option<[f64; 2]>,
    restitution: Option<f64>,
    drive: Drive,
    /// Key and value of the torque (N m) or the force (N) of the motor.
    effort: (&'static str, Option<f64>),
    speed: Option<f64>,
}

impl Free {
    /// Adds the limits, if there are any.
    fn limit(&self, network: &mut Network, joint: Joint) -> Result<(), Fault> {
        let Some(limits) = self.limits else {
            refuse!(if self.restitution.is_some() => "restitution": "a rebound needs `limits`");
            return Ok(());
        };
        if !(limits[0] <= 0.0 && limits[1] >= 0.0) {
            let [least, most] = limits;
            let why = format!(
                "the first must be at most 0 and the second at least 0, because the joint is at 0 \
                 where the bodies are as described, not {least} and {most}"
            );
            return Err(Fault::new("limits", why));
        }
        let restitution = self.restitution.unwrap_or(0.0);
        refuse!(if !(0.0..=1.0).contains(&restitution) => "restitution":
            "must be from 0 to 1, not {restitution}");
        for is_upper in [false, true] {
            let stop = Stop { joint, limits, is_upper, restitution };
            at("limits", network.add_constraint(Constraint::Stop(stop)))?;
        }
        Ok(())
    }

    /// Adds the motor, if there is one.
    fn drive(
        &self,
        network: &mut Network,
        (first, second): (usize, Option<usize>),
        joint: &Joint,
    ) -> Result<(), Fault> {
        let (key, effort) = self.effort;
        let Some(effort) = effort else {
            refuse!(if self.speed.is_some() => "speed": "a motor also needs its `{key}`");
            return Ok(());
        };
        let motor = Motor {
            drive: self.drive,
            first,
            second,
            axis: joint.axes[0].column(0).into_owned(),
            effort,
            speed: self.speed,
        };
        at(key, network.add_motor(motor))
    }
}

fn check_body(network: &Network, k: usize) -> Result<(), String> {
    match network.bodies().len() {
        count if k < count => Ok(()),
        0 => Err("there is no rigid body".into()),
        count => {
            let last = count - 1;
            Err(format!("there is no rigid body {k}: they are numbered 0 to {last}"))
        }
    }
}
