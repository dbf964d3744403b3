//! Very viscous liquids by Verlet's method with implicit damping, against closed forms and against
//! Verlet's method in short steps.

use a3_core::elements::{Fluid, FluidLaw};
use a3_core::{Control, Model, Network, Scene, Simulation};

use crate::common::{described, distance, method};
use crate::networks::Random;

/// A vortex without circulation, of the speed r exp(-r^2 / 4 nu t) / t^2, keeps its shape while it
/// spreads, so that its energy falls as t^-2 (Taylor, *On the dissipation of eddies*, 1918).
#[test]
fn a_vortex_spreads_as_in_its_closed_form() {
    let (spacing, viscosity, core) = (0.04, 1.2, 0.3);
    let law = FluidLaw { dimensions: 2, spacing, density: 1000.0, sound: 10.0, viscosity };
    let place = |k: i32| (f64::from(k) + 0.5) * spacing;
    let places: Vec<_> = (-25..25)
        .flat_map(|i| (-25..25).map(move |j| (place(i), place(j))))
        .filter(|(x, y)| x.hypot(*y) < 1.0)
        .collect();
    let n = places.len();
    let mut network = Network::new(vec![law.mass(); n]).unwrap();
    let fluid = Fluid::new(law, (0..n as u32).collect()).unwrap();
    network.add(fluid).unwrap();
    let mut y = vec![0.0; 6 * n];
    for (i, (a, b)) in places.into_iter().enumerate() {
        let turn = 1e-3 * (-(a * a + b * b) / (core * core)).exp();
        (y[i], y[n + i], y[3 * n + i], y[4 * n + i]) = (a, b, -turn * b, turn * a);
    }
    let energy = |y: &[f64]| y[3 * n..].iter().map(|v| v * v).sum::<f64>();
    let begun = energy(&y);
    let model = Model::Network(Box::new(network));
    let scene = Scene::new("a vortex", model, y);
    // Twelve times the longest step of explicit methods, a tenth of spacing^2 / nu.
    let step = 0.4 * spacing / law.sound;
    let own = method("implicit-damping");
    let mut run = Simulation::new(scene, own, Control::Step(step)).unwrap();
    // On the lattice the viscous force of a shear is that of 0.794 nu along its axes, and of 1.112
    // nu along its diagonals: the sums of 4 m W' / (rho r) x^2 y^2 / (r^2 + s^2).
    let start = core * core / (4.0 * 0.5 * (0.794 + 1.112) * viscosity);
    for stretch in [1.5, 2.0] {
        run.advance_to((stretch - 1.0) * start).unwrap();
        let left = energy(run.state()) / begun;
        let error = left * stretch * stretch - 1.0;
        assert!(error.abs() < 0.03, "{stretch}: {error}");
    }
}

/// A column of honey that falls on the floor of a tank and spreads.
fn column(viscosity: f64) -> Scene {
    described(&format!(
        "gravity = [0, -9.81, 0]
        [[fluid]]
        dimensions = 2
        size = [0.3, 0.6, 0]
        spacing = 0.05
        at = [0, 0.3, 0]
        density = 1400
        sound = 20
        viscosity = {viscosity}
        tank = {{ size = [1.2, 0.8, 0], at = [0, 0.4, 0] }}"
    ))
}

/// Verlet's method blows up in steps that sound would allow, and in steps short enough for the
/// viscosity goes where the own method goes. Where the viscosity is high, that takes more work.
#[test]
fn honey_takes_steps_of_sound() {
    let sound = 0.4 * 0.05 / 20.0;
    for (viscosity, most, least_order) in [(2.0, 3e-3, 1.7), (10.0, 0.04, 1.4)] {
        let scene = column(viscosity);
        let half = scene.state.len() / 2;
        let run = |name: &str, step: f64| {
            let control = Control::Step(step);
            let mut run = Simulation::new(scene.clone(), method(name), control).unwrap();
            run.advance_to(0.4).map(|()| (run.state()[..half].to_vec(), run.work().total()))
        };
        assert!(run("verlet", sound).is_err());
        let (exact, expensive) = run("verlet", sound / 16.0).unwrap();
        let moved = distance(&exact, &scene.state[..half]);
        let errors = [1.0, 0.5].map(|share| {
            let (own, work) = run("implicit-damping", share * sound).unwrap();
            assert!(share < 1.0 || 2.0 * work < expensive, "{work}");
            distance(&own, &exact) / moved
        });
        let order = (errors[0] / errors[1]).log2();
        assert!(errors[0] < most && order > least_order, "{viscosity}: {errors:?}");
    }
}

/// A free drop keeps its momentum and its angular momentum to rounding, in steps by which viscosity
/// is stiff.
#[test]
fn momentum_is_kept_to_rounding() {
    for dimensions in [2, 3] {
        let depth = if dimensions == 3 { 0.4 } else { 0.0 };
        let mut scene = described(&format!(
            "[[fluid]]
            dimensions = {dimensions}
            size = [0.6, 0.8, {depth}]
            spacing = 0.1
            at = [0, 0, 0]
            density = 1000
            sound = 20
            viscosity = 20
            strain = [1, -2, 0.5]"
        ));
        let n = scene.model.particles();
        let mut random = Random(3);
        for (k, y) in scene.state.iter_mut().enumerate() {
            if dimensions == 3 || k / n % 3 != 2 {
                *y += random.between(-0.01, 0.01);
            }
        }
        let Model::Network(network) = &scene.model else { unreachable!() };
        let masses = network.masses().to_vec();
        let momenta = |y: &[f64]| {
            let v = &y[3 * n..];
            let sum = |of: &dyn Fn(usize) -> f64| (0..n).map(|i| masses[i] * of(i)).sum::<f64>();
            let mut all = [0.0; 6];
            for axis in 0..3 {
                let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
                all[axis] = sum(&|i| v[axis * n + i]);
                all[3 + axis] = sum(&|i| y[b * n + i] * v[c * n + i] - y[c * n + i] * v[b * n + i]);
            }
            all
        };
        let begun = momenta(&scene.state);
        let size: f64 = masses.iter().zip(&scene.state[3 * n..]).map(|(m, v)| m * v.abs()).sum();
        let mut run =
            Simulation::new(scene, method("implicit-damping"), Control::Step(2e-3)).unwrap();
        run.take_steps(50).unwrap();
        for (now, begun) in momenta(run.state()).into_iter().zip(begun) {
            assert!((now - begun).abs() < 1e-13 * size, "{now} instead of {begun}");
        }
    }
}
