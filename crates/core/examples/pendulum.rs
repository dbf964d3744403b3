//! A network of one's own: a chain of springs that hangs from a pin, stepped and printed.
//!
//! `cargo run -p a3-core --example pendulum`

use a3_core::{
    Control, Error, Network, Path, Scene, Simulation, Spring, SpringKind, SpringLaw, Vector3,
    integrators,
};

/// Number of particles.
const N: usize = 4;
/// Distance between neighbouring particles at the start (m).
const SPACING: f64 = 0.5;

fn main() -> Result<(), Error> {
    // Particles of 0.1 kg, joined by springs of 200 N/m; the first one is pinned.
    let mut network = Network::new(vec![0.1; N])?;
    let law = SpringLaw::new(200.0, SPACING, 0.05)?;
    let kind = SpringKind::Structural;
    network.add_springs((1..N).map(|j| Spring { kind, i: j - 1, j, law }))?;
    network.pin(0, Path::Still(Vector3::zeros()))?;
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));

    // The state is y = [x | v], each n x 3 in column-major order: all x, all y, all z. The chain
    // starts along the x axis, at rest.
    let mut state = vec![0.0; 6 * N];
    for (i, x) in state[..N].iter_mut().enumerate() {
        *x = SPACING * i as f64;
    }

    let scene = Scene::new("pendulum", network, state);
    let Some(rk4) = integrators::find("rk4") else {
        return Err(Error::Invalid("there is no method rk4".into()));
    };
    let mut run = Simulation::new(scene, rk4, Control::Step(0.005))?;
    println!("time (s)   end of the chain (m)   energy (J)");
    for frame in 0..=10 {
        run.advance_to(0.2 * f64::from(frame))?;
        let end = run.position(N - 1);
        let energy = run.energy().map_or(0.0, |energy| energy.total());
        println!("{:8.2}   {:9.4} {:9.4}   {energy:10.4}", run.time(), end.x, end.y);
    }
    Ok(())
}
