//! Hands, wind, pins, tears and rewinds where surfaces touch: nothing ever crosses.

use a3_core::{Control, Mechanics, Model, Network, Scene, Simulation, Vector3};

use crate::common::{described, method};

const CURTAIN: &str = "gravity = [0, -9.81, 0]\ndrag_per_mass = 0.5\n\
    [wind]\nvelocity = [4, 0, 2]\n[swing]\namplitude = [0, 0, 0.3]\nrate = 3\n\
    [[cloth]]\ngrid = [12, 12]\nwidth = 1\ndensity = 0.2\nstiffness = [40, 20, 0.5]\n\
    damping_ratio = 0.1\nat = [0, 1, 0]\nfolds = 3\nturn = 0.9\npin = [{ at = ['top'] }]\n";

/// Particles at both lower corners, and one of the pins.
const LEFT: usize = 132;
const RIGHT: usize = 143;
const PIN: usize = 6;

fn run(text: &str, name: &str) -> Simulation {
    let method = method(name);
    let scene = described(text);
    Simulation::new(scene, method, method.control(1.0 / 60.0)).unwrap()
}

/// A run of the curtain with other keys before its own, whose surfaces touch.
fn touching(keys: &str, name: &str) -> Simulation {
    run(&format!("self_collision = true\n{keys}{CURTAIN}"), name)
}

fn crossings(run: &Simulation) -> usize {
    let (x, _) = run.state().split_at(run.state().len() / 2);
    let network = run.model().network().unwrap();
    network.crossed(run.time(), x).len()
}

/// Advances by a frame of 60 Hz; the grabbed particle is pulled in circles, back and forth through
/// the curtain.
fn frame(run: &mut Simulation) {
    if run.grabbed().is_some() {
        let phase = 9.0 * run.time();
        let place = [0.9 * phase.sin(), 0.5 + 0.4 * phase.cos()];
        run.pull(Vector3::new(place[0], place[1], 1.2 * (0.7 * phase).sin()));
    }
    run.advance_to(run.time() + 1.0 / 60.0).unwrap();
    assert_eq!(crossings(run), 0, "at {} s", run.time());
}

/// All that hands do to a run, in two seconds. Returns the largest energy of contact (J).
fn handle(run: &mut Simulation) -> f64 {
    let mut energy = 0.0_f64;
    for k in 0..120 {
        match k {
            5 => run.grab(LEFT).unwrap(),
            30 => run.set_wind(true),
            40 => assert!(run.toggle_pin(RIGHT).unwrap()),
            50 => run.set_swinging(true),
            60 => run.grab(PIN).unwrap(),
            90 => run.release(),
            100 => run.set_pinned(false),
            _ => {}
        }
        frame(run);
        energy = energy.max(run.energy().unwrap().contact);
    }
    energy
}

#[test]
fn hands_draw_nothing_through_anything() {
    for name in ["implicit", "dopri5", "xpbd"] {
        let mut run = touching("", name);
        let energy = handle(&mut run);
        assert!(energy > 1e-5, "{name}: {energy} J");
        // The same actions, if surfaces may pass through one another, leave some crossed.
        let mut loose = self::run(CURTAIN, name);
        for _ in 0..5 {
            frame(&mut loose);
        }
        loose.grab(LEFT).unwrap();
        let crossed = (0..40).any(|k| {
            let phase = 0.3 * f64::from(k);
            loose.pull(Vector3::new(0.9 * phase.sin(), 0.5, 1.2 * phase.cos()));
            loose.advance_to(loose.time() + 1.0 / 60.0).unwrap();
            crossings(&loose) > 0
        });
        assert!(crossed, "{name}");
    }
}

#[test]
fn what_tears_does_not_cross() {
    let mut run = touching("tear = 1.5\n", "implicit");
    handle(&mut run);
    assert!(run.tears() > 10, "{}", run.tears());
    let network = run.model().network().unwrap();
    let triangles = network.triangles().len();
    assert!(triangles < 242, "{triangles} triangles have no hole");
}

#[test]
fn a_hand_lifts_a_cloth_and_a_pin_stays_where_it_is_let_go() {
    let mut run = touching("", "implicit");
    for (i, target) in [
        (LEFT, Vector3::new(-0.5, 0.8, 0.3)),
        (PIN, run.position(PIN) + Vector3::new(0.0, 0.05, 0.1)),
    ] {
        run.grab(i).unwrap();
        for _ in 0..60 {
            run.pull(target);
            run.advance_to(run.time() + 1.0 / 60.0).unwrap();
        }
        let missed = (run.position(i) - target).norm();
        assert!(missed < 0.06, "particle {i} is {missed} m off");
        run.release();
    }
    let there = run.position(PIN);
    run.advance_to(run.time() + 0.1).unwrap();
    assert_eq!(run.position(PIN), there);
}

/// A hand that holds still does not drive the swings of the curtain: the particle stays in its
/// place, where a hand without inertia lets it swing by centimetres for ever. The hand weighs
/// nothing, and leaves no trace.
#[test]
fn a_particle_in_a_hand_that_holds_still_rests() {
    for (name, h) in [("trapezoid", 0.01), ("verlet", 0.005)] {
        let scene = a3_scenes::find("cloth").unwrap().build(None).unwrap().scene;
        let mut run = Simulation::new(scene, method(name), Control::Step(h)).unwrap();
        run.set_touching(true).unwrap();
        run.advance_to(1.0).unwrap();
        let before = run.model().network().unwrap().inverse_masses().to_vec();
        let energy = run.energy().unwrap();
        run.grab(210).unwrap();
        assert_eq!(run.energy().unwrap(), energy);
        let target = run.position(210) + Vector3::new(0.86, 0.5, -0.51);
        while run.time() < 10.0 {
            run.pull(target);
            run.take_steps(2).unwrap();
            let off = (run.position(210) - target).norm();
            assert!(run.time() < 4.0 || off < 5e-3, "{name}: {off} m off");
        }
        run.release();
        assert_eq!(run.model().network().unwrap().inverse_masses(), before);
    }
}

/// Back to an earlier moment and forward again: the same bits.
#[test]
fn going_back_and_on_again_is_the_same_run() {
    let mut run = touching("tear = 1.5\n", "implicit");
    run.set_swinging(true);
    run.set_wind(true);
    run.advance_to(0.4).unwrap();
    let moment = run.moment();
    run.advance_to(1.0).unwrap();
    let end = run.state().to_vec();
    run.rewind(&moment).unwrap();
    run.advance_to(1.0).unwrap();
    assert_eq!(run.state(), end);
    run.reset();
    run.advance_to(1.0).unwrap();
    let again = run.state().to_vec();
    run.reset();
    run.advance_to(1.0).unwrap();
    assert_eq!(run.state(), again);
}

#[test]
fn rods_keep_their_lengths_and_do_not_cross() {
    let chain = |at: &str, down: &str| {
        format!(
            "[[chain]]\nrigid = true\nparticles = 5\nmass = 0.1\nthickness = 0.02\n\
             from = {at}\nto = {down}\npin = [{{ at = ['first'] }}]\n"
        )
    };
    let [first, second] =
        [chain("[0, 0, 0]", "[1, 0.1, 0]"), chain("[0.35, -0.3, 0.02]", "[0.35, -0.25, 1.02]")];
    let text = format!("gravity = [0, -9.81, 0]\nself_collision = true\n{first}{second}");
    let mut run = run(&text, "rk4");
    for _ in 0..60 {
        for _ in 0..16 {
            let next = run.time() + 1.0 / 960.0;
            run.advance_to(next).unwrap();
        }
        assert_eq!(crossings(&run), 0);
        let length = (run.position(4) - run.position(3)).norm();
        assert!((length - 0.252).abs() < 0.01, "{length} m");
    }
}

fn network(scene: &mut Scene) -> &mut Network {
    match &mut scene.model {
        Model::Network(network) => network,
        Model::FirstOrder(_) | Model::Points(_) => unreachable!(),
    }
}

#[test]
fn surfaces_begin_to_touch_while_they_are_apart() {
    let mut run = run(CURTAIN, "implicit");
    run.advance_to(0.1).unwrap();
    let before = run.moment();
    run.set_touching(true).unwrap();
    assert!(run.touching() && run.moment().touching);
    handle(&mut run);
    // A reset keeps the setting; going back to a moment restores that of the moment.
    let after = run.moment();
    run.reset();
    assert!(run.touching());
    run.rewind(&before).unwrap();
    assert!(!run.touching());
    assert_eq!(run.model().network().unwrap().touch(), None);
    run.restore(&after).unwrap();
    assert!(run.touching() && run.state() == after.run.y);
    run.set_touching(false).unwrap();
    assert_eq!(run.model().network().unwrap().touch(), None);
}

#[test]
fn what_crosses_does_not_begin_to_touch() {
    let mut run = run(CURTAIN, "implicit");
    let place = run.position(LEFT);
    run.grab(LEFT).unwrap();
    for k in 0.. {
        assert!(k < 200, "it crosses nothing");
        run.pull(Vector3::new(-place.x, 0.5, if k % 40 < 20 { 1.0 } else { -1.0 }));
        run.advance_to(run.time() + 1.0 / 60.0).unwrap();
        if crossings(&run) > 0 {
            break;
        }
    }
    let (state, held) = (run.state().to_vec(), run.grabbed());
    let why = run.set_touching(true).unwrap_err().to_string();
    assert!(
        why.starts_with("surfaces that cross cannot begin to touch: the edge of particles "),
        "{why}"
    );
    assert!(!run.touching() && run.state() == state && run.grabbed() == held);
    // A scene without surfaces has nothing that could touch.
    let mut scene = described(CURTAIN);
    scene.touch = None;
    network(&mut scene).set_triangles([]).unwrap();
    let mut run = Simulation::new(scene, run.method(), run.control()).unwrap();
    run.set_touching(true).unwrap();
    assert!(!run.touching());
}

/// Cloths of 16 particles in planes through one another, and one apart.
#[test]
fn what_crosses_is_named_by_its_parts() {
    let cloth = |down: &str, at: &str| {
        format!(
            "[[cloth]]\ngrid = [4, 4]\nwidth = 1\ndensity = 0.2\nstiffness = [40, 20, 0.5]\n\
             right = [1, 0, 0]\ndown = {down}\nat = {at}\n"
        )
    };
    let apart = cloth("[0, -1, 0]", "[0, 0, 5]");
    let upright = cloth("[0, -1, 0]", "[0, 0.03, 0]");
    let level = cloth("[0, 0, -1]", "[0.07, -0.5, 0.53]");
    let run = run(&[apart, upright, level].concat(), "implicit");
    let why = run.model().network().unwrap();
    let why = why.check_apart(0.0, &run.state()[..144]).unwrap_err();
    let why = why.to_string();
    let parts = "; of 3 connected parts, part 2 (16 particles from 16 on) crosses part 3 \
                 (16 particles from 32 on) (";
    assert!(why.contains(parts) && why.contains(" near (-0."), "{why}");
}

/// Surfaces that are apart, but by less than a thickness that is far too large.
#[test]
fn a_smaller_thickness_is_offered_where_it_would_do() {
    let mut scene = described(
        "self_collision = true\n[[cloth]]\ngrid = [30, 30]\nwidth = 1\ndensity = 0.2\n\
         stiffness = [40, 20, 0.5]\n",
    );
    let state = scene.state.clone();
    let network = network(&mut scene);
    network.check_apart(0.0, &state[..2700]).unwrap();
    let mut touch = network.touch().unwrap().clone();
    for skin in &mut touch.skins {
        skin.thickness = 10.0;
    }
    network.set_touch(Some(touch)).unwrap();
    let why = network.check_apart(0.0, &state[..2700]).unwrap_err();
    assert!(why.to_string().contains("it is up to 10 m"), "{why}");
}
