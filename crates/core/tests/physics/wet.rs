//! Fluids that meet soft bodies: cloths, solids, jellies and chains stop them.

use a3_core::{Control, Scene, Simulation, Vector3};

use crate::common::{described, method};

fn run(scene: Scene, step: f64) -> Simulation {
    Simulation::new(scene, method("verlet"), Control::Step(step)).unwrap()
}

/// Particles of the fluid, which are the last.
fn drops(run: &Simulation) -> Vec<usize> {
    let network = run.model().network().unwrap();
    let fluid = network.fluid().unwrap();
    fluid.particles().iter().map(|i| *i as usize).collect()
}

/// A blob that flies against a free slab stays on its side, and both together keep their momentum.
/// The safeguard's impulses act along straight courses, so that they keep the angular momentum to
/// the first order of the step alone.
#[test]
fn slabs_of_all_kinds_stop_a_blob_and_take_its_momentum() {
    let slabs = [
        "[[cloth]]
        grid = [13, 13]
        width = 1.2
        density = 20
        stiffness = [4000, 2000, 500]
        damping_ratio = 0.1
        at = [0, 0.6, 0]
        right = [0, 0, 1]",
        "[[jelly]]
        grid = [3, 9, 9]
        size = [0.2, 1.2, 1.2]
        density = 200
        stiffness = [4000, 2000, 1000]
        damping_ratio = 0.1
        at = [0.1, 0, 0]",
        "[[solid]]
        grid = [2, 7, 7]
        size = [0.1, 1.2, 1.2]
        density = 300
        young = 4e5
        poisson = 0.3
        at = [0.05, 0, 0]",
    ];
    for slab in slabs {
        let mut run = run(
            described(&format!(
                "self_collision = true
                {slab}
                [[fluid]]
                shape = 'ball'
                size = [0.4, 0.4, 0.4]
                spacing = 0.05
                at = [-0.3, 0.05, 0.02]
                velocity = [3, 0, 0]
                density = 1000
                sound = 30
                viscosity = 0.02"
            )),
            2.5e-4,
        );
        let momenta = |run: &Simulation| {
            let masses = run.model().network().unwrap().masses();
            let (n, v) = (run.particles(), run.velocities());
            let parts = masses.iter().enumerate().map(|(i, mass)| {
                let p = *mass * Vector3::new(v[i], v[n + i], v[2 * n + i]);
                [p, run.position(i).cross(&p)]
            });
            let zero = [Vector3::zeros(); 2];
            parts.fold(zero, |[p, l], [dp, dl]| [p + dp, l + dl])
        };
        let drops = drops(&run);
        let mean = |run: &Simulation| {
            let speeds = drops.iter().map(|i| run.velocities()[*i]);
            speeds.sum::<f64>() / drops.len() as f64
        };
        let before = momenta(&run);
        run.advance_to(0.2).unwrap();
        let (after, scale) = (momenta(&run), before[0].norm());
        for ((a, b), error) in after.iter().zip(before).zip([1e-11, 1e-4]) {
            assert!((a - b).norm() < error * scale, "{slab}: {a} {b}");
        }
        assert!(mean(&run) < 2.2, "{slab}: still {} m/s", mean(&run));
        // Behind the slab, and not beside it.
        let slab: Vec<_> = (0..drops[0]).map(|i| run.position(i)).collect();
        let deepest = slab.iter().map(|x| x.x).fold(f64::NEG_INFINITY, f64::max);
        for i in &drops {
            let x = run.position(*i);
            let beside = x.y.abs() > 0.6 || x.z.abs() > 0.6;
            assert!(x.x < deepest || beside, "drop {i} is at {x}, the slab ends at {deepest}");
        }
    }
}

/// A cloth that is held along its edges carries the weight of the water that falls on it, and none
/// passes through.
#[test]
fn a_pond_of_cloth_carries_its_water() {
    let scene = described(
        "gravity = [0, -9.81, 0]
        drag = 0.4
        self_collision = true
        [[cloth]]
        grid = [13, 13]
        width = 1
        density = 1
        stiffness = [600, 300, 1]
        damping_ratio = 0.2
        at = [0, 0.5, -0.5]
        down = [0, 0, 1]
        pin = [{ at = ['left', 'right', 'top', 'bottom'] }]
        [[fluid]]
        size = [0.3, 0.15, 0.3]
        spacing = 0.05
        at = [0, 0.62, 0]
        density = 1000
        sound = 20
        viscosity = 0.03",
    );
    let mut run = run(scene, 5e-4);
    run.advance_to(2.5).unwrap();
    let drops = drops(&run);
    let (n, forces) = (run.particles(), run.contact_forces().unwrap());
    let carried: f64 = drops.iter().map(|i| forces[n + i]).sum();
    let network = run.model().network().unwrap();
    let weight = 9.81 * drops.len() as f64 * network.masses()[drops[0]];
    assert!((carried / weight - 1.0).abs() < 0.02, "{carried} N of {weight} N");
    let lowest = (0..drops[0]).map(|i| run.position(i).y).fold(1.0, f64::min);
    for i in drops {
        let x = run.position(i);
        assert!(x.y > lowest && x.x.hypot(x.z) < 0.5, "drop {i} is at {x}");
    }
}
