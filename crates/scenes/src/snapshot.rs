//! Descriptions of the present state of runs, from which other runs continue. Their time begins at
//! 0 again: paths and gusts are shifted in time.

use a3_core::contact::Shape;
use a3_core::{Checkpoint, Model, Network, Path, Pin as Held, Pose, rotation};
use nalgebra::{Rotation3, UnitQuaternion};

use crate::description::{
    Description, Floor, FloorSpec, Movable, ObstacleKeys, Pin, Shift, Sine, SpringSpec, State,
    Triple, Turn,
};

/// Multiplies the stiffness and the damping of all springs by these factors. In fluids, the square
/// of the speed of sound and the viscosity are multiplied.
pub fn scale_springs(description: &mut Description, stiffness: f64, damping: f64) {
    // Factors of damping over stiffness, and of damping over the critical one, which grows with
    // the root of the stiffness.
    let (time, ratio) = (damping / stiffness, damping / stiffness.sqrt());
    let scale_list = |springs: &mut Vec<SpringSpec>| {
        for (_, _, k, _, c) in springs {
            *k *= stiffness;
            *c *= damping;
        }
    };
    for body in description.bodies_mut() {
        let of_springs = body.stiffness.into_iter().flatten();
        let strips = body.buckling.into_iter().flatten();
        let of_strips = strips.flat_map(|law| [&mut law.bending, &mut law.compression]);
        of_springs.chain(of_strips).for_each(|k| *k *= stiffness);
        for (damping, factor) in [(body.damping, time), (body.damping_ratio, ratio)] {
            damping.into_iter().flatten().for_each(|c| *c *= factor);
        }
    }
    for solid in &mut description.solid {
        solid.young *= stiffness;
        solid.damping *= time;
    }
    for chain in &mut description.chain {
        chain.stiffness *= stiffness;
        chain.damping *= damping;
    }
    if let Some(particles) = &mut description.particles {
        scale_list(&mut particles.springs);
    }
    for fluid in &mut description.fluid {
        fluid.sound *= stiffness.sqrt();
        fluid.viscosity *= damping;
    }
    scale_list(&mut description.springs);
}

/// Multiplies the force or velocity of the wind by a factor, if there is wind.
pub fn scale_wind(description: &mut Description, factor: f64) {
    if let Some(wind) = &mut description.wind {
        let means = [&mut wind.force, &mut wind.force_per_mass, &mut wind.velocity];
        for x in means.into_iter().flatten().flatten() {
            *x *= factor;
        }
    }
}

/// Replaces the initial state of the description by that of a run `now`: its method, state, pins,
/// obstacles, wind, gravity and drag. Springs stay as described, except for broken ones. A grabbed
/// particle is released.
pub fn begin_with(description: &mut Description, model: &Model, now: &Checkpoint) {
    let (n, t) = (model.particles(), now.time());
    description.solver = Some(now.run.method.name.into());
    description.step = Some(now.run.control.value());
    let mut parts = now.run.y.chunks_exact(3 * n);
    let network = model.network();
    let bodies = 0..network.map_or(0, |network| network.bodies().len());
    let rotations =
        || network.into_iter().flat_map(|it| bodies.clone().map(|k| it.rotation(k, &now.run.y)));
    description.state = Some(State {
        positions: parts.next().map(rows).unwrap_or_default(),
        velocities: parts.next().map(rows).unwrap_or_default(),
        orientations: rotations().map(|r| [r.q.w, r.q.i, r.q.j, r.q.k]).collect(),
        angular_momenta: rotations().map(|r| r.momentum.into()).collect(),
    });
    let Some(network) = network else {
        return;
    };
    description.change_gravity(network.gravity().map(Into::into));
    (description.drag, description.drag_per_mass) = (network.drag(), None);
    description.torn.clone_from(&now.torn);
    description.self_collision = now.touching;
    if let Some(wind) = &mut description.wind {
        wind.on = now.wind.is_some();
        wind.ahead += t;
    }
    let fluids = description.fluid.iter_mut();
    for inflow in fluids.filter_map(|it| it.inflow.as_mut()) {
        inflow.ahead += t;
    }
    write_obstacles(description, network, t);
    write_strain_limits(description, network);
    // Particles that are attached to rigid bodies stay so.
    let pinned = description.bodies_mut().filter_map(|body| body.pin);
    pinned.for_each(|pins| pins.retain(|pin| pin.body.is_some()));
    description.pin.retain(|pin| pin.body.is_some());
    description.pin.extend(pins(now));
}

/// Returns the rows of particles whose numbers are all x, all y, all z.
pub(crate) fn rows(part: &[f64]) -> Vec<Triple> {
    let n = part.len() / 3;
    let row = |i| [part[i], part[n + i], part[2 * n + i]];
    (0..n).map(row).collect()
}

/// Replaces the pins of a description by those of another one of the same bodies, in its words.
pub fn pin_as(description: &mut Description, mut other: Description) {
    let pinned = description.bodies_mut().filter_map(|body| body.pin);
    let others = other.bodies_mut().filter_map(|body| body.pin);
    for (pins, others) in pinned.zip(others) {
        std::mem::swap(pins, others);
    }
    description.pin = other.pin;
}

/// Describes the obstacles as they are at time t (s). The obstacles of each kind are in the order
/// in which they were added. The floor may have been removed.
fn write_obstacles(description: &mut Description, network: &Network, t: f64) {
    let mut spheres = description.sphere.iter_mut();
    let mut boxes = description.boxes.iter_mut();
    let mut capsules = description.capsule.iter_mut();
    let mut solids = description.obstacle.iter_mut();
    description.floor = None;
    for obstacle in network.obstacles() {
        let pose = obstacle.at(t);
        let here = pose.place.position;
        let Motion { sine, shift, about } = motion(&obstacle.path, t);
        let turn = obstacle.turn.and_then(|turn| going_on(turn, about, t));
        let (friction, restitution) = (obstacle.friction, obstacle.restitution);
        let set = |described: &mut dyn Movable| {
            described.set(ObstacleKeys {
                friction,
                restitution,
                thickness: described.keys().thickness,
                sine,
                shift,
                turn,
            });
        };
        match &obstacle.shape {
            &Shape::Sphere { radius } => {
                if let Some(described) = spheres.next() {
                    (described.center, described.radius) = (here.into(), radius);
                    set(described);
                }
            }
            Shape::Box { .. } => {
                if let Some(described) = boxes.next() {
                    described.center = here.into();
                    described.rotation = turned(described.rotation, &pose);
                    set(described);
                }
            }
            &Shape::Capsule { ends, radius } => {
                if let Some(described) = capsules.next() {
                    let [from, to] = ends.map(|end| pose.of(end).position.into());
                    (described.from, described.to, described.radius) = (from, to, radius);
                    set(described);
                }
            }
            Shape::Mesh(_) => {
                if let Some(described) = solids.next() {
                    described.at = Some(here.into());
                    described.rotation = turned(described.rotation, &pose);
                    set(described);
                }
            }
            Shape::Floor => {
                let (height, thickness) = (here.y, Some(obstacle.thickness).filter(|d| *d > 0.0));
                let floor = FloorSpec { height, friction, restitution, thickness };
                let is_plain = [friction, restitution, obstacle.thickness] == [0.0; 3];
                let plain = Floor::Height(height);
                description.floor = Some(if is_plain { plain } else { Floor::Table(floor) });
            }
        }
    }
}

/// Describes the limits of strain: those of the bodies that had one, or else, if limits were set
/// during the run, those of the cloths.
fn write_strain_limits(description: &mut Description, network: &Network) {
    let bodies = description.bodies_mut();
    let mut bodies: Vec<_> = bodies.filter_map(|body| body.strain_limit).collect();
    if bodies.iter().any(|limit| limit.is_some()) {
        bodies.retain(|limit| limit.is_some());
    }
    let mut limits = network.strain_limits().iter().map(|(_, limit)| *limit);
    for body in bodies {
        *body = limits.next();
    }
}

/// Describes the pins from now on, except those of liquid that has flowed out. Pins with the same
/// motion are merged. A grabbed particle that was pinned before stays pinned where it is.
fn pins(now: &Checkpoint) -> Vec<Pin> {
    let mut pins: Vec<Pin> = vec![];
    let t = now.time();
    let held = now.run.grabbed.filter(|grabbed| grabbed.was_pinned);
    let held = held.map(|grabbed| Held::new(grabbed.particle, grabbed.path));
    let is_drained = |pin: &Held| now.drained.binary_search(&(pin.particle as u32)).is_ok();
    let holding = || {
        let all = now.pins.iter().filter(|pin| pin.holds_at(t));
        all.filter(|pin| !is_drained(pin))
    };
    let held = held.filter(|held| holding().all(|pin| pin.particle != held.particle));
    for Held { particle, path, until } in holding().copied().chain(held) {
        let grabbed = now.run.grabbed.filter(|it| it.particle == particle);
        let Motion { sine, shift, about } = match grabbed {
            None => motion(&path, t),
            Some(grabbed) if grabbed.was_pinned => Motion::default(),
            Some(_) => continue,
        };
        let turn = match path {
            Path::Turn { turn, .. } if about.is_some() => going_on(turn, about, t),
            _ => None,
        };
        let pin = Pin { sine, shift, turn, until: until.map(|until| until - t), ..Pin::default() };
        let alike = |other: &&mut Pin| {
            (&other.sine, &other.shift, &other.turn, other.until)
                == (&pin.sine, &pin.shift, &pin.turn, pin.until)
        };
        match pins.iter_mut().find(alike) {
            Some(pin) => pin.particles.push(particle),
            None => pins.push(Pin { particles: vec![particle], ..pin }),
        }
    }
    pins
}

/// Motion that continues a path from a time, which becomes time 0.
#[derive(Default)]
struct Motion {
    sine: Option<Sine>,
    shift: Option<Shift>,
    /// Point of the axis, where the path turns about one (m).
    about: Option<Triple>,
}

/// Returns the motion that continues a path from time t (s).
fn motion(path: &Path, t: f64) -> Motion {
    match *path {
        Path::Sine { center, amplitude, rate, phase } => Motion {
            sine: Some(Sine {
                amplitude: amplitude.into(),
                rate,
                phase: rate * t + phase,
                center: Some(center.into()),
            }),
            ..Motion::default()
        },
        Path::Line { to, start, end, .. } if t < end => Motion {
            shift: Some(Shift {
                by: (to - path.at(t).position).into(),
                start: (start - t).max(0.0),
                end: end - t,
            }),
            ..Motion::default()
        },
        Path::Still(_) | Path::Line { .. } => Motion::default(),
        Path::Turn { from, to, start, end, .. } => {
            let axis = Path::Line { from, to, start, end };
            let about = Some(axis.at(t).position.into());
            Motion { about, ..motion(&axis, t) }
        }
    }
}

/// Returns the continuation of a turn from time t (s), if it has not ended.
fn going_on(turn: a3_core::Turn, about: Option<Triple>, t: f64) -> Option<Turn> {
    turn.end.is_none_or(|end| t < end).then(|| Turn {
        about,
        axis: turn.axis.into(),
        rate: Some(turn.rate),
        angle: None,
        start: (turn.start - t).max(0.0),
        end: turn.end.map(|end| end - t),
    })
}

/// Returns the rotation vector of a body after it turned to a pose, from the one before.
fn turned(before: Option<Triple>, pose: &Pose) -> Option<Triple> {
    let Some(orientation) = pose.orientation else {
        return before;
    };
    let before = rotation(before.unwrap_or_default().into());
    let now = Rotation3::from_matrix_unchecked(orientation.rotation * before);
    let now = UnitQuaternion::from_rotation_matrix(&now);
    Some(now.scaled_axis().into())
}
