//! Steps allocate no memory, with any method and any scene.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use a3_core::elements::{Air, Wind};
use a3_core::{Constraint, Control, Model, Network, Path, Scene, Simulation, Vector3, integrators};

/// Allocator of the system that counts the allocations of each thread.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

#[expect(unsafe_code, reason = "an allocator cannot be written without")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(run: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.get();
    run();
    ALLOCATIONS.get() - before
}

#[test]
fn the_counter_counts() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1u8; 100]))) > 0);
}

#[test]
fn no_step_allocates() {
    for entry in a3_scenes::SCENES {
        for method in integrators::METHODS {
            let setup = entry.build(None).unwrap();
            // A fluid allocates when it lists neighbours, and surfaces when they list pairs.
            let network = setup.scene.model.network();
            if network.is_some_and(|n| n.fluid().is_some() || n.contact_layer().is_some()) {
                continue;
            }
            let many_springs = network.is_some_and(|n| {
                let of_sheets = n.sheets().map(|sheet| sheet.springs().count());
                n.springs().count() - of_sheets.sum::<usize>() > 1000
            });
            let control = setup.defaults.control_of(method);
            let Ok(mut run) = Simulation::new(setup.scene, method, control) else {
                assert!(method.check(entry.build(None).unwrap().scene.model.system()).is_err());
                continue;
            };
            run.set_wind(true);
            run.set_swinging(true);
            // The first step analyses the pattern of a matrix and packs many springs; one later
            // step does again if longer steps make another solver cheaper.
            // The forces that work on a scene are listed in the first step after they have changed.
            let is_adaptive = matches!(control, Control::Tolerance(_));
            let long = is_adaptive && (method.is_implicit() || many_springs);
            run.take_steps(if long { 60 } else { 1 }).unwrap();
            let count = allocations(|| run.take_steps(20).unwrap());
            assert_eq!(count, 0, "{} on {}", method.name, entry.name);
        }
    }
}

/// Air ends the sweeps of a sheet: the first step in it allocates scratch for whole arrays, and no
/// later step allocates.
#[test]
fn no_step_in_the_air_allocates_but_the_first() {
    for method in integrators::METHODS.iter().filter(|m| !m.positions_only() && !m.plain_only()) {
        let mut scene = a3_scenes::find("cloth").unwrap().build(None).unwrap().scene;
        if let Model::Network(network) = &mut scene.model {
            let grid = network.sheets().next().unwrap().grid();
            network.set_triangles(grid.triangles()).unwrap();
        }
        let air = Air::new(1.2, 1.2, 0.5).unwrap();
        scene.wind = Some(Wind::on_triangles(1, Vector3::new(0.0, 0.0, 3.0), air));
        let mut run = Simulation::new(scene, method, method.default_control).unwrap();
        run.set_wind(true);
        run.take_steps(1).unwrap();
        let count = allocations(|| run.take_steps(20).unwrap());
        assert_eq!(count, 0, "{} in the air", method.name);
    }
}

/// Few rods allocate nothing, and many only in the first step, which analyses their pattern.
#[test]
fn constraints_allocate_nothing() {
    for (rods, first) in [(4, 0), (20, 1)] {
        let mut network = Network::new(vec![1.0; rods + 1]).unwrap();
        network.pin(0, Path::Still(Vector3::zeros())).unwrap();
        for i in 0..rods {
            let (j, length) = (i + 1, 1.0);
            network.add_constraint(Constraint::Rod { i, j, length }).unwrap();
        }
        let mut state = vec![0.0; 6 * (rods + 1)];
        for (i, x) in state[..=rods].iter_mut().enumerate() {
            *x = i as f64;
        }
        for method in integrators::METHODS.iter().filter(|m| m.check(&network).is_ok()) {
            let model = Model::Network(Box::new(network.clone()));
            let scene = Scene::new("rods", model, state.clone());
            let mut run = Simulation::new(scene, method, method.default_control).unwrap();
            run.take_steps(first).unwrap();
            let count = allocations(|| run.take_steps(20).unwrap());
            assert_eq!(count, 0, "{}", method.name);
        }
    }
}

#[test]
fn no_step_that_tears_nothing_allocates() {
    for name in ["cloth", "chain"] {
        for method in integrators::METHODS {
            let mut scene = a3_scenes::find(name).unwrap().build(None).unwrap().scene;
            if let Model::Network(network) = &mut scene.model {
                network.set_tear(Some(1e3)).unwrap();
            }
            let Ok(mut run) = Simulation::new(scene, method, method.default_control) else {
                assert!(method.plain_only() || method.positions_only() && name == "cloth");
                continue;
            };
            let count = allocations(|| run.take_steps(20).unwrap());
            assert_eq!(count, 0, "{} on {name}", method.name);
        }
    }
}

/// Scratch of a method is reallocated when the scene is adjusted, not during steps.
#[test]
fn no_step_after_an_adjustment_allocates() {
    for method in integrators::METHODS.iter().filter(|m| !m.positions_only() && !m.plain_only()) {
        let mut scene = a3_scenes::find("cloth").unwrap().build(None).unwrap().scene;
        let own = scene.model.network().unwrap().clone();
        if let Model::Network(network) = &mut scene.model {
            network.scale_springs(1.0, 0.0).unwrap();
        }
        let mut run = Simulation::new(scene, method, method.default_control).unwrap();
        run.take_steps(1).unwrap();
        run.adjust(|network| network.copy_springs(&own).unwrap());
        let count = allocations(|| run.take_steps(20).unwrap());
        assert_eq!(count, 0, "{}", method.name);
    }
}

/// Springs whose strain is limited are listed in the first step, and no later step allocates.
#[test]
fn no_step_that_limits_strain_allocates_but_the_first() {
    for name in ["verlet", "implicit", "dopri5"] {
        let mut scene = a3_scenes::find("cloth").unwrap().build(None).unwrap().scene;
        if let Model::Network(network) = &mut scene.model {
            let all = 0..network.particles();
            network.set_strain_limit(all, Some(1.05)).unwrap();
        }
        let method = integrators::find(name).unwrap();
        let mut run = Simulation::new(scene, method, method.default_control).unwrap();
        run.take_steps(1).unwrap();
        let count = allocations(|| run.take_steps(100).unwrap());
        assert_eq!(count, 0, "{name}");
    }
}
