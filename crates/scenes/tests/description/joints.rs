//! Joints of rigid bodies, and particles that are attached to them.

use a3_core::Constraint;
use a3_core::constraints::JointKind;
use a3_scenes::snapshot;

use super::*;

/// Two boxes and a chain, with what follows.
fn boxes(rest: &str) -> String {
    format!(
        "[[chain]]\nparticles = 3\nfrom = [0.3, 0, 0]\nto = [0.3, -1, 0]\nmass = 0.1\nstiffness = 50\n\
         pin = [{{ at = [\"first\"], body = 0 }}]\n\
         [[body]]\nparts = [{{ box = [0.6, 0.2, 0.2] }}]\nmass = 1\n\
         [[body]]\nparts = [{{ box = [0.6, 0.2, 0.2] }}]\nmass = 1\nat = [0.7, 0, 0]\nspin = [0, 0, 1]\n\
         {rest}"
    )
}

const HINGED: &str = "[[joint]]\nbody = 0\nhinge = { at = [-0.3, 0, 0], axis = [0, 0, 1] }\n\
    [[joint]]\nbodies = [0, 1]\nhinge = { at = [0.35, 0, 0], axis = [0, 0, 1], limits = [-1, 0.5] }\n";

/// Changes of a joint of two boxes, with the messages.
const WRONG: &str = r"
body = 0\nfixed = true
    body = 0 => joint: give one of `ball`, `hinge`,
    ball = [0, 0, 0] => joint: give either `body`,
    body = 0\nball = [0, 0, 0]\nfixed = true => joint: give one of `ball`, `hinge`,
    body = 7\nball = [0, 0, 0] =>
        joint.body: there is no rigid body 7: they are numbered 0 to 1
    bodies = [1, 1]\nfixed = true => joint: a joint needs two different bodies
    body = 0\nslider = { axis = [0, 0, 0] } => joint.slider.axis: the length of an axis
    body = 0\nslider = { axis = [1, 0, 0], limits = [0.1, 1] } =>
        joint.slider.limits: the first must be at most 0
    body = 0\nhinge = { at = [0, 0, 0], axis = [1, 0, 0], limits = [-4, 4] } =>
        joint.hinge.limits: only a hinge and a slider have limits
    body = 0\nhinge = { at = [0, 0, 0], axis = [1, 0, 0], speed = 1 } =>
        joint.hinge.speed: a motor also needs its `torque`
    body = 0\nhinge = { at = [0, 0, 0], axis = [1, 0, 0], torque = -1, speed = 1 } =>
        joint.hinge.torque: a motor needs bodies that exist
body = 0 }
    body = 0, shift = { by = [1, 0, 0], end = 1 } } => chain.pin.body: what is attached
    body = 2 } => pin.body: there is no rigid body 2
";

#[test]
fn joints_that_make_no_sense_are_refused() {
    let said = |text: &str| read(text).build(None, &mut mesh).err().unwrap().to_string();
    let joint = "[[joint]]\nbody = 0\nfixed = true\n";
    refused(&boxes(joint), WRONG, said);
    let many = said(&boxes(&joint.repeat(1001)));
    begins(many, "joint: the scene has 1001 joints");
}

/// Velocities that do not fit joints are changed by an impact, and nothing touches what it is
/// joined to.
#[test]
fn a_scene_begins_with_velocities_that_fit_its_joints() {
    let scene = build(&boxes(HINGED)).unwrap();
    let network = network(&scene);
    let constraints = network.constraints().iter();
    let kinds = constraints.map(|constraint| match constraint {
        Constraint::Joint(joint) => Some(joint.kind),
        _ => None,
    });
    let (hinge, ball) = (Some(JointKind::Hinge), Some(JointKind::Ball));
    assert_eq!(kinds.collect::<Vec<_>>(), [hinge, hinge, None, None, ball]);
    let poses = [0, 1].map(|k| network.pose(k, &scene.state));
    let spins = poses.map(|pose| pose.orientation.unwrap().spin);
    // The first turns with what pushes it at its end, and the place of the hinge moves with both.
    let moved = |k: usize, at: f64| {
        let place = &poses[k].place;
        place.velocity.y + spins[k].z * (at - place.position.x)
    };
    assert!(moved(0, -0.3).abs() < 1e-12 && spins[0].z.abs() > 1e-3);
    assert!((moved(0, 0.35) - moved(1, 0.35)).abs() < 1e-12);
    run(scene, "rk4", 0.01);
}

/// A run goes on from the scene file that describes it, with its joints where the bodies are.
#[test]
fn a_snapshot_keeps_joints_and_attachments() {
    let text = format!("gravity = [0, -9.81, 0]\n{}", boxes(HINGED));
    let mut description = read(&text);
    let mut own = run(build(&text).unwrap(), "rk4", 1e-3);
    own.advance_to(0.2).unwrap();
    snapshot::begin_with(&mut description, own.model(), &own.checkpoint());
    let again = build(&description.to_toml().unwrap()).unwrap();
    let error = network(&again).constraint_error(&again.state).unwrap();
    assert!(error < 1e-6, "{error:e}");
    let mut other = run(again, "rk4", 1e-3);
    own.advance_to(0.4).unwrap();
    other.advance_to(0.2).unwrap();
    for i in 0..3 {
        let off = (own.position(i) - other.position(i)).norm();
        assert!(off < 1e-9, "particle {i}: {off:e}");
    }
}
