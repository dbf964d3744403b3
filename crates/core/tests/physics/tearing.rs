//! Tearing: exactly the springs that are stretched too far tear, and the bend springs along them.

use crate::common::{described, distance, method, scene, scene_with_grid, size};
use a3_core::elements::{Air, Buckling, Wind};
use a3_core::{
    Control, Mechanics, Method, Model, Network, Path, Scene, Simulation, Spring, SpringKind,
    SpringLaw, Vector3, integrators,
};
use approx::assert_relative_eq;

const LIMIT: f64 = 1.5;
const G: f64 = 9.81;

fn spring(kind: SpringKind, i: usize, j: usize, stiffness: f64, rest_length: f64) -> Spring {
    let law = SpringLaw::new(stiffness, rest_length, 0.0).unwrap();
    Spring { kind, i, j, law }
}

/// Three masses that hang from a pin by springs, of which the second is weak.
fn chain(limit: Option<f64>) -> Scene {
    let mut network = Network::new(vec![1.0; 4]).unwrap();
    for (i, stiffness) in [(0, 400.0), (1, 60.0), (2, 400.0)] {
        let link = spring(SpringKind::Structural, i, i + 1, stiffness, 0.5);
        network.add_spring(link).unwrap();
    }
    network.set_gravity(Vector3::new(0.0, -G, 0.0));
    network.pin(0, Path::Still(Vector3::zeros())).unwrap();
    network.set_tear(limit).unwrap();
    let mut state = vec![0.0; 24];
    for i in 0..4 {
        state[4 + i] = -0.5 * i as f64;
    }
    Scene::new("chain", Model::Network(Box::new(network)), state)
}

fn network_of(run: &Simulation) -> &Network {
    run.model().network().unwrap()
}

/// Largest length over rest length of the remaining springs.
fn stretch(run: &Simulation) -> f64 {
    network_of(run)
        .springs()
        .map(|s| (run.position(s.i) - run.position(s.j)).norm() / s.law.rest_length)
        .fold(0.0, f64::max)
}

#[test]
fn the_weak_link_breaks_as_it_passes_the_limit_and_the_rest_falls_freely() {
    let mut times = vec![];
    for (name, value) in
        [("rk4", 0.001), ("verlet", 0.001), ("implicit-midpoint", 0.001), ("dopri5", 1e-8)]
    {
        let mut run =
            Simulation::new(chain(Some(LIMIT)), method(name), method(name).control(value)).unwrap();
        let mut before = 1.0;
        let weak = |run: &Simulation| (run.position(1) - run.position(2)).norm() / 0.5;
        while run.tears() == 0 {
            before = weak(&run);
            run.advance_to(run.time() + 0.001).unwrap();
            assert!(run.time() < 2.0);
        }
        assert!(before <= LIMIT && weak(&run) > LIMIT, "{name}: {before}");
        assert!(weak(&run) < LIMIT + 0.01);
        assert_eq!(run.tears(), 1);
        let network = network_of(&run);
        assert!(network.is_torn(1, 2) && network.is_torn(2, 1) && !network.is_torn(0, 1));
        times.push(run.time());
        // The two masses below the tear fall freely with their initial speed.
        let speed = |run: &Simulation| 0.5 * (run.velocities()[4 + 2] + run.velocities()[4 + 3]);
        let (since, had) = (run.time(), speed(&run));
        run.advance_to(since + 0.7).unwrap();
        assert_relative_eq!(speed(&run), had - G * 0.7, epsilon = 1e-9);
        assert_eq!(run.tears(), 1);
    }
    for time in &times {
        assert!((time - times[0]).abs() < 0.0021, "{times:?}");
    }
}

#[test]
fn nothing_tears_unless_it_is_asked_for_or_below_the_limit() {
    let end = |limit, name: &str| {
        let mut run = Simulation::new(chain(limit), method(name), Control::Step(0.001)).unwrap();
        run.advance_to(3.0).unwrap();
        assert!(stretch(&run) > LIMIT && run.tears() == 0);
        run.state().to_vec()
    };
    for name in ["rk4", "verlet", "dopri5"] {
        assert!(end(None, name) == end(Some(1e6), name), "{name}");
    }
    assert_eq!(chain(None).model.network().unwrap().tear_limit(), None);
}

#[test]
fn a_spring_of_rest_length_zero_never_tears() {
    let mut network = Network::new(vec![1.0; 2]).unwrap();
    let link = spring(SpringKind::Structural, 0, 1, 10.0, 0.0);
    network.add_spring(link).unwrap();
    network.set_tear(Some(LIMIT)).unwrap();
    assert_eq!(network.tear(&[0.0, 5.0, 0.0, 0.0, 0.0, 0.0], 0.0), 0);
}

#[test]
fn a_limit_that_makes_no_sense_is_refused() {
    let mut network = Network::new(vec![1.0; 2]).unwrap();
    for wrong in [1.0, 0.0, -2.0, f64::NAN, f64::INFINITY] {
        let error = network.set_tear(Some(wrong)).unwrap_err().to_string();
        assert!(error.contains("above 1, such as 2"), "{error}");
    }
    network.set_tear(Some(1.01)).unwrap();
    assert_eq!(network.tear_limit(), Some(1.01));
    assert_eq!(network.forces_in_use(), ["tearing"]);
}

/// Cloth with triangles that tears at 1.6 rest lengths.
fn weak_cloth() -> Scene {
    let mut scene = scene("cloth");
    let Model::Network(network) = &mut scene.model else { panic!("masses and springs") };
    let grid = network.sheets().next().unwrap().grid();
    network.set_triangles(grid.triangles()).unwrap();
    network.set_tear(Some(1.6)).unwrap();
    let air = Air::new(1.2, 1.2, 0.5).unwrap();
    scene.wind = Some(Wind::on_triangles(1, Vector3::new(0.5, 0.0, 3.0), air));
    scene
}

/// Pulls at one particle after another.
fn pull_about(run: &mut Simulation) {
    run.advance_to(0.5).unwrap();
    for (k, i) in [210, 150, 390, 285].into_iter().enumerate() {
        run.grab(i).unwrap();
        let home = run.position(i);
        let end = 1.0 + 0.5 * k as f64;
        while run.time() < end {
            let phase = 6.0 * (run.time() + 0.5 - end);
            let way = Vector3::new(phase.sin(), 0.3 * phase.cos(), 3.0 * phase.sin());
            run.pull(home + way * 1.5);
            run.advance_to(run.time() + 1.0 / 60.0).unwrap();
        }
        run.release();
    }
    run.advance_to(4.0).unwrap();
}

#[test]
fn cloth_pulled_by_a_hand_tears_stays_finite_and_is_mended_by_a_reset() {
    for (name, value) in
        [("trapezoid", 0.005), ("verlet", 0.005), ("implicit", 0.01), ("dopri5", 1e-4)]
    {
        let mut run =
            Simulation::new(weak_cloth(), method(name), method(name).control(value)).unwrap();
        let all = network_of(&run).springs().count();
        run.set_wind(true);
        pull_about(&mut run);
        let tears = run.tears();
        println!("{name}: {tears} of {all} springs");
        assert!(tears > 50 && tears < all / 2, "{name}: {tears}");
        assert!(run.state().iter().all(|y| y.is_finite()));
        assert!(stretch(&run) <= 1.6, "{name}: {}", stretch(&run));
        let network = network_of(&run);
        assert_eq!(network.sheets().count(), 1);
        assert_eq!(network.springs().count() + tears, all);
        assert!(network.springs().all(|s| !network.is_torn(s.i, s.j)));
        let triangles = network.triangles();
        let grid = run.scene().grid().unwrap();
        let whole: Vec<_> = grid.triangles().filter(|t| network.is_whole(*t)).collect();
        assert!(triangles.len() < 2 * 19 * 19 - 5);
        assert!(triangles.iter().map(|t| t.map(|i| i as usize)).eq(whole));
        // After a reset, the run repeats itself to the bit.
        let first = run.state().to_vec();
        run.reset();
        assert_eq!(run.tears(), 0);
        assert!(run.windy());
        assert_eq!(network_of(&run).springs().count(), all);
        assert_eq!(network_of(&run).triangles().len(), 2 * 19 * 19);
        pull_about(&mut run);
        assert!(run.state() == first && run.tears() == tears, "{name}");
    }
}

/// In a flat sheet, bend springs tear with the structural springs along them.
#[test]
fn a_bend_spring_goes_with_the_structural_ones_that_it_runs_along() {
    let scene = scene_with_grid("mit", 5, 6);
    let mut network = scene.model.network().unwrap().clone();
    let grid = network.sheets().next().unwrap().grid();
    let mut x: Vec<f64> = vec![0.0; 90];
    let spacing = network.sheets().next().unwrap().laws()[0].rest_length;
    for i in 0..30 {
        x[i] = spacing * (i % 6) as f64;
        x[30 + i] = -spacing * (i / 6) as f64;
    }
    assert_eq!(network.tear(&x, 0.0), 0, "it never tears unless it is asked");
    network.set_tear(Some(1.9)).unwrap();
    assert_eq!(network.tear(&x, 0.0), 0);
    assert!(network.sheets().next().is_some());
    // All particles right of the third column move to the right by one spacing. Then 5 structural
    // springs are 2 rest lengths long, shear springs sqrt 5 / sqrt 2 = 1.58, and bend springs 1.5.
    for (_, x) in x.iter_mut().enumerate().take(30).filter(|(i, _)| i % 6 >= 3) {
        *x += spacing;
    }
    let all = network.springs().count();
    // Ten bend springs cross the gap: five from the second column to the fourth, and five from the
    // third to the fifth.
    assert_eq!(network.tear(&x, 0.0), 5 + 10);
    assert_eq!((network.tears(), network.springs().count()), (15, all - 15));
    for row in 0..5 {
        let at = |col| grid.index_of(row, col);
        assert!(network.is_torn(at(2), at(3)) && !network.is_torn(at(1), at(2)));
        assert!(network.is_torn(at(1), at(3)) && network.is_torn(at(2), at(4)));
        assert!(!network.is_torn(at(0), at(2)) && !network.is_torn(at(3), at(5)));
    }
    assert_eq!(network.tear(&x, 0.0), 0);
    // The remaining springs pull as before.
    let v = vec![0.0; 90];
    let mut f = vec![0.0; 90];
    network.spring_forces(&x, &v, &mut f);
    let mut list = Network::new(vec![1.0; 30]).unwrap();
    let left = scene.model.network().unwrap().springs();
    list.add_springs(left.filter(|s| !network.is_torn(s.i, s.j))).unwrap();
    let mut expected = vec![0.0; 90];
    list.spring_forces(&x, &v, &mut expected);
    assert!(distance(&f, &expected) < 1e-13 * size(&expected));
}

/// A bend spring without structural springs along it, or with another path of them, holds until it
/// is itself too long.
#[test]
fn bend_springs_with_nothing_along_them_or_another_way_round_hold() {
    let line = |shift: f64| {
        // Particles 0, 1, 2 are on a line, and particle 3 is beside particle 1.
        let (x, y) = ([0.0, 1.0 + shift, 2.0, 1.0], [0.0, 0.0, 0.0, 0.5]);
        [x, y, [0.0; 4]].concat()
    };
    let bend = spring(SpringKind::Bend, 0, 2, 1.0, 2.0);
    let along = [(0, 1, 1.0), (1, 2, 1.0)];
    let round = [(0, 3, 1.25f64.sqrt()), (3, 2, 1.25f64.sqrt())];
    for (links, torn) in [
        (along.to_vec(), 2),
        (along.iter().chain(&round).copied().collect(), 1),
        (along[..1].to_vec(), 1),
    ] {
        for buckles in [false, true] {
            let mut network = Network::new(vec![1.0; 4]).unwrap();
            for (i, j, rest) in &links {
                let link = spring(SpringKind::Structural, *i, *j, 1.0, *rest);
                network.add_spring(link).unwrap();
            }
            if buckles {
                network
                    .add_buckling(Buckling {
                        i: 0,
                        j: 2,
                        rest_length: 2.0,
                        bending: 0.01,
                        compression: 1.0,
                        tension: 0.0,
                        damping: 0.0,
                    })
                    .unwrap();
            } else {
                network.add_spring(bend).unwrap();
            }
            network.set_tear(Some(1.5)).unwrap();
            assert_eq!(network.tear(&line(0.49), 0.0), 0);
            assert_eq!(network.tear(&line(0.51), 0.0), torn, "{links:?}");
            assert_eq!(network.is_torn(2, 0), torn == 2);
            assert_eq!(network.buckling().count(), usize::from(buckles && torn != 2));
            // With the particles far apart, all springs tear.
            let far: Vec<f64> = line(0.0).iter().map(|x| x * 4.0).collect();
            assert_eq!(network.tear(&far, 0.0), links.len() + 1 - torn);
            assert_eq!(network.springs().count() + network.buckling().count(), 0);
        }
    }
}

#[test]
fn no_wind_blows_on_a_hole() {
    let mut network = Network::new(vec![1.0; 4]).unwrap();
    for (i, j) in [(0, 1), (1, 2), (2, 0), (1, 3), (3, 2)] {
        let side = spring(SpringKind::Structural, i, j, 1.0, 1.0);
        network.add_spring(side).unwrap();
    }
    network.set_triangles([[0, 1, 2], [1, 3, 2]]).unwrap();
    let air = Air::new(1.2, 1.0, 0.0).unwrap();
    network.set_wind(Some(Wind::on_triangles(1, Vector3::z() * 5.0, air)));
    network.set_tear(Some(2.0)).unwrap();
    // Particle 3 is far from the others.
    let x = [
        0.0, 1.0, 0.5, 9.0, //
        0.0, 0.0, 0.8, 0.8, //
        0.0, 0.0, 0.0, 0.0,
    ];
    let push = |network: &Network| {
        let mut f = [0.0; 12];
        network.forces(0.0, &x, &[0.0; 12], &mut f);
        [f[8], f[9], f[10], f[11]]
    };
    assert!(push(&network)[3] > 1.0);
    assert_eq!(network.tear(&x, 0.0), 2);
    assert_eq!(network.triangles(), [[0, 1, 2]]);
    let [a, b, c, d] = push(&network);
    assert!(a > 0.1 && a == b && b == c && d == 0.0);
    assert!(network.is_whole([2, 1, 0]) && !network.is_whole([1, 2, 3]));
}

#[test]
fn every_method_tears_alike() {
    let whole = chain(Some(LIMIT));
    let serving = |m: &&Method| m.check(whole.model.system()).is_ok();
    for m in integrators::METHODS.iter().filter(serving) {
        let control = m.control(if m.is_adaptive() { 1e-6 } else { 0.0005 });
        let mut run = Simulation::new(chain(Some(LIMIT)), m, control).unwrap();
        while run.tears() == 0 && run.time() < 2.0 {
            run.advance_to(run.time() + 0.0005).unwrap();
        }
        assert!(network_of(&run).is_torn(1, 2), "{}", m.name);
        assert!((run.time() - 0.261).abs() < 6e-4, "{}", m.name);
        run.take_steps(20).unwrap();
        assert_eq!(run.tears(), 1, "{}", m.name);
    }
}

/// A run that goes back to a moment has only its tears, and tears again as before.
#[test]
fn what_tore_after_a_moment_is_mended_there() {
    let scene = described(
        "tear = 1.3
        torn = [[0, 1]]
        [wind]
        on = true
        velocity = [3, 0, 1]
        [[sphere]]
        center = [0.5, -0.5, 0.4]
        radius = 0.1
        sine = { amplitude = [0, 0, 0.3], rate = 5 }
        [[cloth]]
        grid = [6, 5]
        width = 1
        mass = 0.01
        stiffness = [20, 10, 5]
        damping_ratio = 0.1
        pin = [{ at = ['left'] }, { at = ['right'], shift = { by = [0.9, 0, 0], start = 0.1, end = 0.7 } }]",
    );
    let mut run = Simulation::new(scene, method("rk4"), Control::Step(1.0 / 512.0)).unwrap();
    let mut moments = vec![];
    for k in 0..=20 {
        run.advance_to(f64::from(k) / 16.0).unwrap();
        moments.push((run.moment(), network_of(&run).clone()));
    }
    let tears: Vec<_> = moments.iter().map(|(moment, _)| moment.torn.len()).collect();
    assert!(
        tears[0] == 1 && tears[20] > 10 && tears.windows(2).filter(|t| t[0] < t[1]).count() > 2
    );
    for k in [12, 0, 9, 20, 3] {
        let (moment, network) = &moments[k];
        run.grab_obstacle(0).unwrap();
        run.pull_obstacle(Vector3::new(3.0, 3.0, 3.0));
        run.rewind(moment).unwrap();
        assert_eq!((run.time(), run.steps()), (moment.time(), moment.run.steps));
        assert_eq!(run.moment().obstacles, moment.obstacles);
        assert_eq!((run.state(), network_of(&run).torn()), (&moment.run.y[..], &moment.torn[..]));
        assert!(network_of(&run).springs().eq(network.springs()));
        run.advance_to(1.25).unwrap();
        assert_eq!(run.state(), moments[20].0.run.y, "{k}");
        assert_eq!(network_of(&run).torn(), moments[20].0.torn, "{k}");
    }
}
