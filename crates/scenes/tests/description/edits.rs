//! Edits of scenes: what stays has the same state, and names the same particles.

use a3_core::Constraint;
use a3_scenes::{ConstraintSpec, Edit, PartSpec, RigidBody};

use super::*;

/// A scene with bodies of many kinds, which name one another's particles.
const MANY: &str = "trail = 21\n\
    springs = [[2, 9, 8, 0.5, 0.1], [13, 18, 5, 1, 0], [4, 0, 3, 1, 0]]\n\
    torn = [[0, 1]]\n\
    pin = [{ particles = [15, 16] }]\n\
    constraint = [{ rope = [11, 12], length = 5 }, { rod = [14, 15], length = 1 }, \
    { particle = 13, point = [6, 1, 0] }]\n\
    [[cloth]]\ngrid = [3, 3]\nwidth = 1\nat = [0, 2, 0]\nmass = 0.1\nstiffness = [40, 20, 10]\n\
    pin = [{ at = ['top'] }]\n\
    [[chain]]\nparticles = 3\nfrom = [3, 1, 0]\nto = [4, 1, 0]\nmass = 0.1\nstiffness = 50\n\
    [particles]\npositions = [[3.5, 0.5, 0], [6, 1, 0], [6, 2, 0], [7, 2, 0]]\n\
    velocities = [[1, 0, 0], [0, 0, 0], [0, 2, 0], [0, 2, 0]]\nmasses = [0.1, 0.2, 0.3, 0.4]\n\
    springs = [[1, 2, 30, 1, 0.1], [0, 3, 2, 1, 0]]\npin = [{ particles = [2] }]\n\
    [[body]]\nparts = [{ ball = 0.3 }]\nmass = 1\nat = [-3, 1, 0]\nspin = [0, 3, 0]\n\
    [[body]]\nparts = [{ box = [0.4, 0.4, 0.4] }]\nmass = 2\nat = [-5, 1, 0]\nspin = [1, 0, 0]\n";

/// What belongs to a particle: its state, its mass, and its pin.
fn particle(scene: &Scene, i: usize) -> ([f64; 6], f64, bool) {
    let (n, network) = (scene.model.particles(), network(scene));
    let row = std::array::from_fn(|axis| scene.state[axis * n + i]);
    (row, network.masses()[i], network.is_pinned(i))
}

/// The ends of all springs, rods and ropes, in order.
fn links(scene: &Scene, number: impl Fn(usize) -> Option<usize>) -> Vec<[usize; 2]> {
    let network = network(scene);
    let springs = network.all_springs().map(|it| [it.i, it.j]);
    let constraints = network.constraints().iter();
    let constraints = constraints.filter_map(|it| Some([it.ends().0, it.ends().1?]));
    let all = springs.chain(constraints);
    let pairs = all.filter_map(|[i, j]| Some([number(i)?, number(j)?]));
    let mut all: Vec<_> = pairs.collect();
    all.sort_unstable();
    all
}

fn ball(at: [f64; 3]) -> RigidBody {
    RigidBody {
        parts: vec![PartSpec { ball: Some(0.2), ..PartSpec::default() }],
        mass: Some(0.5),
        at: Some(at),
        velocity: Some([1.0, 2.0, 3.0]),
        spin: Some([0.0, 1.0, 0.0]),
        ..RigidBody::default()
    }
}

/// Every edit of a scene that begins as it is built, and of one that begins in a given state.
#[test]
fn an_edit_leaves_all_else_as_it_was() {
    let own = read(MANY);
    let scene = built(&own);
    let n = scene.model.particles();
    let mut given = own.clone();
    let row = |first: usize, i: usize| [0, 1, 2].map(|axis| scene.state[first + axis * n + i]);
    let rotations = [0, 1].map(|k| &scene.state[6 * n + 7 * k..]);
    given.state = Some(a3_scenes::State {
        positions: (0..n).map(|i| row(0, i)).collect(),
        velocities: (0..n).map(|i| row(3 * n, i)).collect(),
        orientations: rotations.map(|r| [r[0], r[1], r[2], r[3]]).into(),
        angular_momenta: rotations.map(|r| [r[4], r[5], r[6]]).into(),
    });
    let rope =
        ConstraintSpec { rope: Some([3, 17]), length: Some(20.0), ..ConstraintSpec::default() };
    // Each with the particles, bodies and links that come or go.
    let (position, mass) = ([0.0, 4.0, 0.0], 0.7);
    let edits = [
        (Edit::AddBody(ball([0.0, 5.0, 0.0])), 2, 1, 0),
        (Edit::AddParticle { position, mass }, 1, 0, 0),
        (Edit::AddSpring((3, 17, 1.0, 1.0, 0.0)), 0, 0, 1),
        (Edit::AddConstraint(rope), 0, 0, 1),
        (Edit::Disjoin([12, 11]), 0, 0, -1),
        (Edit::Disjoin([13, 14]), 0, 0, -1),
        (Edit::Disjoin([3, 4]), 0, 0, -1),
        (Edit::Disjoin([0, 4]), 0, 0, -2),
        (Edit::RemoveParticle(13), -1, 0, -2),
        (Edit::RemoveParticle(15), -1, 0, -2),
        (Edit::RemoveParticle(4), 0, 0, -9),
        (Edit::RemoveBody(0), -2, -1, 0),
        (Edit::RemoveBody(1), -9, -1, -1),
    ];
    for (own, scene) in [(&own, built(&own)), (&given, built(&given))] {
        for (edit, particles, bodies, joined) in &edits {
            let edited = edit.apply(own, network(&scene)).unwrap();
            let after = built(&edited.description);
            let m = after.model.particles();
            assert_eq!(m as i32 - n as i32, *particles, "{edit:?}");
            let turned = (after.state.len() - 6 * m) as i32 / 7;
            assert_eq!(turned - 2, *bodies, "{edit:?}");
            let number = |i| edited.particles.number(i);
            for (i, j) in (0..n).filter_map(|i| Some((i, number(i)?))) {
                assert_eq!(particle(&scene, i), particle(&after, j), "{edit:?}: {i}");
                assert_eq!(edited.particles.back().number(j), Some(i));
            }
            let rotation = |scene: &Scene, k: usize| {
                let first = 6 * scene.model.particles() + 7 * k;
                scene.state[first..first + 7].to_vec()
            };
            for (k, l) in (0..2).filter_map(|k| Some((k, edited.bodies.number(k)?))) {
                assert_eq!(rotation(&scene, k), rotation(&after, l), "{edit:?}");
            }
            let (before, now) = (links(&scene, number), links(&after, Some));
            let lost = links(&scene, Some).len() as i32 - before.len() as i32;
            let more = now.len() as i32 - before.len() as i32 - lost;
            assert_eq!(more, *joined, "{edit:?}");
            let both = [&before, &now];
            let [few, many] = [*joined <= 0, *joined > 0].map(|k| both[usize::from(k)]);
            assert!(few.iter().all(|ends| many.contains(ends)), "{edit:?}");
            if *particles < 0 {
                assert_eq!(before, now, "{edit:?}");
            }
        }
    }
    let apply = |edit: &Edit, own| edit.apply(own, network(&scene)).unwrap().description;
    let body = apply(&edits[0].0, &given);
    assert_eq!(particle(&built(&body), n).0, [0.0, 5.0, 0.0, 1.0, 2.0, 3.0]);
    let fewer = apply(&Edit::RemoveParticle(13), &own);
    assert_eq!([body.trail, fewer.trail], [Some(21), Some(20)]);
}

/// A body that comes into a liquid, or goes, leaves the particles of the liquid and of the other
/// body as they are, and the scene is that of a file with the body in it.
#[test]
fn a_body_comes_into_a_liquid() {
    for [size, depth, z] in [["2", "1", "0"], ["3", "0.4", "0.4"]] {
        let cube = |x: f64| {
            let part = format!("{{ box = [0.4, 0.4, {depth}] }}");
            format!("[[body]]\nparts = [{part}]\nmass = 90\nat = [{x}, 2, 0]\n")
        };
        let text = |bodies: &str| {
            let text = format!(
                "gravity = [0, -9.81, 0]\n{bodies}[[fluid]]\ndimensions = {size}\nsize = [0.8, 0.4, {z}]\n\
                 spacing = 0.1\nat = [0, 0.2, 0]\ndensity = 1000\nsound = 30\nviscosity = 0.05\n\
                 velocity = [0.1, 0, 0]\ntank = {{ size = [2, 1, {z}], at = [0, 0.5, 0] }}\n"
            );
            read(&text)
        };
        for before in [String::new(), cube(-0.5)] {
            let own = text(&before);
            let scene = built(&own);
            let wanted = text(&(before.clone() + &cube(0.5)));
            let body = wanted.body.last().unwrap().clone();
            let edited = Edit::AddBody(body).apply(&own, network(&scene)).unwrap();
            assert_eq!(edited.description, wanted);
            let after = built(&wanted);
            assert!(edited.particles.added > 10, "{}", edited.particles.added);
            for i in 0..scene.model.particles() {
                let now = edited.particles.number(i).unwrap();
                assert_eq!(particle(&scene, i), particle(&after, now), "{i}");
            }
            let gone = Edit::RemoveBody(network(&after).bodies().len() - 1);
            let gone = gone.apply(&wanted, network(&after)).unwrap();
            assert_eq!(gone.description, own);
            assert_eq!(gone.particles, edited.particles.back());
        }
    }
}

#[test]
fn an_edit_that_makes_no_sense_is_refused() {
    let own = read(MANY);
    let scene = built(&own);
    for (edit, why) in [
        (Edit::AddSpring((3, 3, 1.0, 1.0, 0.0)), "Two particles"),
        (Edit::AddSpring((1, 0, 1.0, 1.0, 0.0)), "are torn"),
        (Edit::Disjoin([0, 20]), "Nothing that could be removed"),
        (Edit::RemoveParticle(11), "Rods or ropes hold"),
        (Edit::RemoveParticle(17), "cannot be removed"),
        (Edit::RemoveBody(2), "no such body"),
    ] {
        let said = edit.apply(&own, network(&scene)).unwrap_err();
        assert!(said.contains(why), "{said}");
    }
}

/// Four bodies in a row, on hinges that motors drive, with chains and particles attached to them.
const JOINED: &str = "pin = [{ particles = [4], body = 0 }, { particles = [5], body = 2 }]\n\
    [[chain]]\nparticles = 2\nfrom = [0, 1, 0]\nto = [0, 2, 0]\nmass = 0.1\nstiffness = 50\n\
    pin = [{ at = ['first'], body = 1 }]\n\
    [[chain]]\nparticles = 2\nfrom = [3, 1, 0]\nto = [3, 2, 0]\nmass = 0.1\nstiffness = 50\n\
    pin = [{ at = ['first'], body = 3 }]\n\
    [particles]\npositions = [[0, 5, 0], [2, 5, 0]]\nmass = 0.2\n\
    [[body]]\nparts = [{ ball = 0.3 }]\nmass = 1\n\
    [[body]]\nparts = [{ ball = 0.3 }]\nmass = 2\nat = [1, 0, 0]\n\
    pin = [{ particles = [0], body = 2 }]\n\
    [[body]]\nparts = [{ ball = 0.3 }]\nmass = 3\nat = [2, 0, 0]\n\
    [[body]]\nparts = [{ ball = 0.3 }]\nmass = 4\nat = [3, 0, 0]\n\
    pin = [{ particles = [0], body = 2 }]\n\
    [[joint]]\nbody = 0\nhinge = { at = [0, 0, 0], axis = [0, 0, 1], torque = 5, speed = 1 }\n\
    [[joint]]\nbodies = [0, 1]\nfixed = true\n\
    [[joint]]\nbodies = [3, 2]\nhinge = { at = [2, 0, 0], axis = [0, 0, 1], torque = 7, limits = [-1, 1] }\n\
    [[joint]]\nbody = 3\nhinge = { at = [3, 0, 0], axis = [0, 0, 1], torque = 9 }\n";

/// Joints, limits and attachments of the scene of a description, and torques of its motors, each
/// with the masses of what it joins: 0 for the world.
fn joined_masses(description: &Description) -> Vec<(String, [f64; 2])> {
    let scene = built(description);
    let network = network(&scene);
    let mass = |i: usize| network.masses()[i];
    let constraints = network.constraints().iter();
    let constraints = constraints.filter_map(|it| match it {
        Constraint::Joint(joint) => Some((format!("{:?}", joint.kind), joint)),
        Constraint::Stop(stop) => Some((format!("stop {}", stop.is_upper), &stop.joint)),
        _ => None,
    });
    let constraints = constraints.map(|(name, joint)| {
        let second = joint.second.map_or(0.0, mass);
        (name, [mass(joint.first), second])
    });
    let center = |k: usize| network.bodies()[k].center();
    let motors = description.joint.iter().filter_map(|joint| {
        let torque = joint.hinge.as_ref()?.torque?;
        let [second, first] = joint.bodies.map_or([None, joint.body], |it| it.map(Some));
        let masses = [first, second].map(|k| k.map_or(0.0, |k| mass(center(k))));
        Some((format!("{torque} N m"), masses))
    });
    constraints.chain(motors).collect()
}

/// Joints, motors, limits and attachments stay with their bodies, and go with them.
#[test]
fn what_is_joined_to_a_body_goes_with_it() {
    let own = read(JOINED);
    let scene = built(&own);
    let whole = joined_masses(&own);
    assert_eq!(whole.len(), 4 + 2 + 6 + 3);
    for (k, mass) in [1.0, 2.0, 3.0, 4.0].into_iter().enumerate() {
        let edited = Edit::RemoveBody(k).apply(&own, network(&scene)).unwrap();
        let others = whole.iter().filter(|(_, masses)| !masses.contains(&mass));
        let others: Vec<_> = others.cloned().collect();
        assert_eq!(joined_masses(&edited.description), others, "{k}");
    }
}
