//! A method of one's own on a system of one's own, charted beside built-in ones: Ralston's method
//! of order 3 on the Lotka-Volterra equations of hares and lynxes.
//!
//! `cargo run --release -p a3-simulator --example own_method -- docs/pictures`

use std::error::Error;

use a3::ChartOptions;
use a3_core::{Method, Ode, Scene, integrators};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("which folder?")?;
    // Hares are born and eaten, lynxes starve and eat.
    let animals = Ode::new(2, |_t, y, dydt| {
        dydt[0] = y[0] * (1.0 - y[1]);
        dydt[1] = y[1] * (y[0] - 1.0);
    })?;
    let scene = Scene::new("hares and lynxes", animals, vec![3.0, 1.0]);

    // y + h (2 k1 + 3 k2 + 4 k3) / 9 (Ralston, Runge-Kutta methods with minimum error bounds,
    // 1962).
    let plus = |y: &[f64], a: f64, k: &[f64]| -> Vec<f64> {
        y.iter().zip(k).map(|(y, k)| y + a * k).collect()
    };
    let ralston = Method::from_step("ralston", 3, move |f, t, y, h| {
        let k1 = f.at(t, y)?;
        let k2 = f.at(t + 0.5 * h, &plus(y, 0.5 * h, &k1))?;
        let k3 = f.at(t + 0.75 * h, &plus(y, 0.75 * h, &k2))?;
        let slope = plus(&plus(&k1, 1.5, &k2), 2.0, &k3);
        Ok(plus(y, 2.0 * h / 9.0, &slope))
    })?;
    let ralston = ralston.with_title("Ralston's method").register();

    let built_in = ["heun", "rk4", "dopri5"].map(|name| integrators::find(name).unwrap());
    let methods = [&built_in[..], &[ralston]].concat();
    let options = ChartOptions { until: Some(10.0), ..ChartOptions::default() };
    let chart = a3::chart(&scene, &methods, &options, &())?;
    print!("{}", chart.table());
    let picture = chart.figure(800, 560)?.png(1.5)?;
    Ok(std::fs::write(format!("{folder}/own-method.png"), picture)?)
}
