//! Rods, ropes and wires.

use a3_core::{Constraint, Network, Scene, Vector3};

use crate::check::{at, key_of, share};
use crate::description::{ConstraintSpec, Description};
use crate::fault::Fault;

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
    match spec {
        ConstraintSpec {
            rod,
            rope,
            length,
            restitution,
            particle: None,
            point: None,
            line: None,
            circle: None,
            sphere: None,
        } if rod.is_some() != rope.is_some() => {
            let (key, [i, j]) = match (rod, rope) {
                (Some(ends), _) => ("rod", *ends),
                (None, ends) => ("rope", ends.unwrap_or_default()),
            };
            for end in [i, j] {
                at(key, network.check_particle(end))?;
            }
            let n = network.particles();
            let point = |i: usize| Vector3::new(state[i], state[n + i], state[2 * n + i]);
            let length = length.unwrap_or((point(i) - point(j)).norm());
            let restitution = *restitution;
            if rope.is_some() {
                at("restitution", share("it", restitution))?;
                return Ok(Constraint::Rope {
                    i,
                    j,
                    length,
                    restitution,
                });
            }
            if restitution != 0.0 {
                return Err(Fault::new("restitution", "only a rope has this key"));
            }
            Ok(Constraint::Rod { i, j, length })
        }
        ConstraintSpec {
            rod: None,
            rope: None,
            restitution: 0.0,
            length: None,
            particle: Some(particle),
            ..
        } => {
            at("particle", network.check_particle(*particle))?;
            wire(*particle, spec)
        }
        _ => Err(Fault::new(
            "",
            "give either `rod` or `rope` with two particles, or `particle` with one of `point`, `line`, `circle` and `sphere`",
        )),
    }
}

/// Creates the constraint of a particle to a point, a line, a circle or a sphere.
fn wire(particle: usize, spec: &ConstraintSpec) -> Result<Constraint, Fault> {
    Ok(match (spec.point, &spec.line, &spec.circle, &spec.sphere) {
        (Some(position), None, None, None) => Constraint::Point {
            particle,
            position: Vector3::from(position),
        },
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
        _ => {
            let why = "give one of `point`, `line`, `circle` and `sphere`";
            return Err(Fault::new("", why));
        }
    })
}
