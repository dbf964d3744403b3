//! A system of one's own, by several methods: the Lorenz equations, which are chaotic, so that
//! every error grows until the solutions have nothing in common.
//!
//! `cargo run -p a3-core --example own_system`

use a3_core::{Error, ParticleSystem, integrators};

/// x' = 10 (y - x), y' = x (28 - z) - y, z' = x y - 8/3 z (Lorenz, *Deterministic nonperiodic
/// flow*, 1963).
struct Lorenz;

impl ParticleSystem for Lorenz {
    fn dim(&self) -> usize {
        3
    }

    fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) {
        dydt[0] = 10.0 * (y[1] - y[0]);
        dydt[1] = y[0] * (28.0 - y[2]) - y[1];
        dydt[2] = y[0] * y[1] - 8.0 / 3.0 * y[2];
    }
}

/// The state after `steps` steps of h (s) by a method, from (1, 1, 1).
fn integrate(method: &str, h: f64, steps: u32) -> Result<[f64; 3], Error> {
    let Some(method) = integrators::find(method) else {
        return Err(Error::Invalid(format!("there is no method {method}")));
    };
    let mut integrator = method.integrator(&Lorenz)?;
    let mut y = [1.0; 3];
    for k in 0..steps {
        integrator.step(&Lorenz, f64::from(k) * h, h, &mut y)?;
    }
    Ok(y)
}

fn main() -> Result<(), Error> {
    println!("x at time t by several methods, in steps of 0.002 s\n");
    print!("  t (s)");
    let methods = ["euler", "trapezoid", "midpoint", "rk4"];
    for method in methods {
        print!("  {method:>10}");
    }
    println!();
    for time in [0.5, 1.0, 2.0, 5.0, 10.0, 20.0] {
        print!("{time:7.1}");
        for method in methods {
            let h = 0.002;
            let [x, ..] = integrate(method, h, (time / h).round() as u32)?;
            print!("  {x:10.4}");
        }
        println!();
    }
    Ok(())
}
