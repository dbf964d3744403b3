//! Contact of surfaces.

use a3_core::{Control, Simulation, integrators};
use a3_scenes::Description;

const PILE: &str = "gravity = [0, -9.81, 0]
drag_per_mass = 0.5
floor = 0
self_collision = true
[[cloth]]
grid = [20, 20]
width = 1
density = 0.2
stiffness = [40, 20, 0.5]
damping_ratio = 0.1
at = [0, 1.05, 0]
sway = [0, 0, 0.2]
";

#[test]
fn pile() {
    let setup = Description::parse(PILE)
        .unwrap()
        .build(None, &mut |_| Err(String::new()))
        .unwrap();
    for (name, control) in [
        ("r", Control::Step(1.0 / 300.0)),
        ("v", Control::Step(1.0 / 600.0)),
        ("i", Control::Step(1.0 / 60.0)),
        ("x", Control::Tolerance(1e-5)),
        ("b", Control::Step(1.0 / 60.0)),
    ] {
        let method = integrators::find(name).unwrap();
        let mut run = Simulation::new(setup.scene.clone(), method, control).unwrap();
        let start = std::time::Instant::now();
        for frame in 1..=90 {
            if let Err(e) = run.advance_to(f64::from(frame) / 60.0) {
                println!("{name} {e}");
                break;
            }
            if frame % 15 == 0 {
                println!(
                    "{name} t {:.2} {:.2?} steps {} {:?} energy {:.4} lowest {:.4} {:?}",
                    run.time(),
                    start.elapsed(),
                    run.steps(),
                    run.guarded(),
                    run.energy().unwrap().total(),
                    run.lowest(),
                    run.work().rejections
                );
            }
        }
    }
    panic!();
}
