//! BDF: work and errors on a stiff chain, errors that follow the tolerance, orders that rise to the
//! highest, and stiff motion that dies out.

use crate::common::{method, oscillator, scene, size, spring};
use a3_core::integrators::Tolerance;
use a3_core::{Control, Model, Network, ParticleSystem, Path, Scene, Simulation, Vector3};

/// A chain of four springs on a pin, so damped that its fastest motion decays 1100 times a second.
fn overdamped_chain() -> Scene {
    let mut network = Network::new(vec![0.05; 5]).unwrap();
    for i in 0..4 {
        let spring = spring(i, i + 1, [40.0, 0.25, 14.0]);
        network.add_spring(spring).unwrap();
    }
    network.pin(0, Path::Still(Vector3::zeros())).unwrap();
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    network.set_drag(0.02).unwrap();
    let mut state = vec![0.0; 30];
    for i in 0..5 {
        (state[i], state[5 + i]) = (0.3 * i as f64, 0.1 * i as f64);
    }
    Scene::new("overdamped chain", Model::Network(Box::new(network)), state)
}

/// Largest root mean square error, over 60 frames a second, of a run against a reference.
fn error(run: &mut Simulation, reference: &mut Simulation, until: f64) -> f64 {
    let (mut worst, n) = (0.0f64, run.particles());
    for frame in 1..=(60.0 * until) as u32 {
        let time = f64::from(frame) / 60.0;
        run.advance_to(time).unwrap();
        reference.advance_to(time).unwrap();
        let apart = run.state()[..3 * n].iter().zip(reference.state());
        let sum: f64 = apart.map(|(a, b)| (a - b) * (a - b)).sum();
        worst = worst.max((sum / n as f64).sqrt());
    }
    worst
}

#[test]
fn a_stiff_chain_costs_little() {
    let run = |name: &str, relative: f64| {
        let control = Control::Tolerance(relative);
        Simulation::new(overdamped_chain(), method(name), control).unwrap()
    };
    for (relative, most, work) in [(5e-4, 1e-3, 2000.0), (1e-5, 1e-4, 3000.0)] {
        let mut bdf = run("bdf", relative);
        let error = error(&mut bdf, &mut run("dop853", 1e-9), 2.0);
        println!("{relative:e}: {error:.1e} m, {:.0}, {:?}", bdf.work().total(), bdf.work());
        assert!(error <= most && bdf.work().total() <= work);
    }
}

/// Errors at the ends of the steps on the circle, over four revolutions, and number of steps.
fn circle(relative: f64) -> (f64, u32) {
    let circle = scene("simple");
    let system = circle.model.system();
    let tolerance = Tolerance::new(relative).unwrap();
    let mut bdf = method("bdf").adaptive(system, tolerance).unwrap();
    let (mut t, mut y, mut worst, mut steps) = (0.0, circle.state.clone(), 0.0f64, 0);
    while t < 25.0 {
        t += bdf.advance(system, t, f64::INFINITY, &mut y).unwrap().h;
        steps += 1;
        worst = worst.max((y[0] - t.cos()).hypot(y[1] - t.sin()));
        // Within the step the polynomial is as accurate.
        let mut within = vec![0.0; y.len()];
        let time = t - 0.5 * bdf.last().h;
        let _ = bdf.interpolate(system, time, &mut within);
        worst = worst.max((within[0] - time.cos()).hypot(within[1] - time.sin()));
    }
    (worst, steps)
}

#[test]
fn errors_follow_the_tolerance_and_orders_rise() {
    let runs = [1e-3, 1e-5, 1e-7, 1e-9].map(circle);
    println!("{runs:?}");
    for pair in runs.windows(2) {
        let fall = pair[0].0 / pair[1].0;
        assert!((10.0..1000.0).contains(&fall), "{fall}");
    }
    // A method of order 5 takes 10^(4/6) = 4.6 times the steps for a ten-thousandth of the error, a
    // method of order 4 takes 6.3 times as many.
    let more = f64::from(runs[3].1) / f64::from(runs[1].1);
    assert!(more < 5.5, "{more}");
}

#[test]
fn stiff_motion_dies_out_in_a_few_steps() {
    let network = oscillator(1e6, 0.0);
    let tolerance = Tolerance::new(1e-3).unwrap();
    let mut bdf = method("bdf").adaptive(&network, tolerance).unwrap();
    // Velocities of 1e-7 m/s, a tenth of the tolerance.
    let mut y = vec![0.0; network.dim()];
    (y[1], y[3]) = (1e-13, 1e-13);
    let (mut t, mut steps) = (0.0, 0);
    while t < 1.0 && steps < 1000 {
        t += bdf.advance(&network, t, f64::INFINITY, &mut y).unwrap().h;
        steps += 1;
    }
    println!("{steps} steps to {t} s, {:e}", size(&y));
    assert!(t >= 1.0 && size(&y[..6]) < 1e-16);
}

#[test]
fn steps_grow_where_each_has_no_past() {
    let circle = scene("simple");
    let system = circle.model.system();
    let tolerance = Tolerance::new(1e-4).unwrap();
    let mut bdf = method("bdf").adaptive(system, tolerance).unwrap();
    let (mut t, mut y, mut steps) = (0.0, circle.state.clone(), 0);
    while t < 1.0 && steps < 1000 {
        t += bdf.advance(system, t, f64::INFINITY, &mut y).unwrap().h;
        steps += 1;
        // A change as by contact.
        y[0] += 1e-9;
    }
    println!("{steps} steps to {t} s");
    // Steps of order 1 with errors of 1e-4, h^2 / 2, would be 70.
    assert!(t >= 1.0 && steps < 140);
}
