//! Speed against accuracy of three methods on a spring pendulum, as a table.
//!
//! `cargo run -p a3-core --example chart`

use a3_core::accuracy::{Frames, Reference, measure};
use a3_core::{
    Control, Error, Network, Path, Scene, Spring, SpringKind, SpringLaw, Vector3, integrators,
};

/// A particle of 1 kg on a spring below a pin, pulled aside.
fn pendulum() -> Result<Scene, Error> {
    let mut network = Network::new(vec![1.0; 2])?;
    let law = SpringLaw::new(50.0, 1.0, 0.0)?;
    let kind = SpringKind::Structural;
    network.add_spring(Spring { kind, i: 0, j: 1, law })?;
    network.pin(0, Path::Still(Vector3::zeros()))?;
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    // All x, all y, all z of the two positions, and then of the velocities.
    let positions = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    let state = [positions, [0.0; 6]].concat();
    Ok(Scene::new("pendulum", network, state))
}

fn main() -> Result<(), Error> {
    let scene = pendulum()?;
    let go_on = || true;
    // The reference is known to `floor`; errors are the largest over the frames of 2 s.
    let Some(reference) = Reference::finest(&scene, Frames::new(2.0), &go_on)? else {
        return Ok(());
    };
    println!("method                step (s)   evaluations   error (m)");
    for name in ["trapezoid", "verlet", "rk4"] {
        let Some(method) = integrators::find(name) else {
            continue;
        };
        for step in [0.02, 0.01, 0.005, 0.0025] {
            let outcome = measure(&scene, method, Control::Step(step), &reference, &go_on)?;
            if let Some(outcome) = outcome {
                println!(
                    "{name:<20}  {step:8}   {:11.0}   {:9.2e}",
                    outcome.work.total(),
                    outcome.errors.position
                );
            }
        }
    }
    Ok(())
}
