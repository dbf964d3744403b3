//! a3: mass-spring systems in a window and without one. The window, pictures and
//! films are the feature `window`.
//!
//! The commands that measure are functions of this library too. They take a scene, methods of the
//! table or own ones, and options, and return values, which have their tables, pictures and data:
//!
//! * [`chart()`]: speed against accuracy.
//! * [`choose()`]: the cheapest method for an error, or the most accurate one for a budget.
//! * [`stability()`]: the largest stable and accurate steps.
//! * [`compare()`]: runs side by side, and their distances.
//! * [`judge_states()`]: the errors of another program, and the method that it agrees with.
//! * [`simplify()`]: what a scene can do without.
//! * [`scene()`]: a scene by its name, or from a file.
//!
//! Heun's method as one's own, on a system of one's own, beside Euler's:
//!
//! ```
//! use a3_core::{Method, Ode, Scene, integrators};
//!
//! let heun = Method::from_step("my-heun", 2, |f, t, y, h| {
//!     let a = f.at(t, y)?;
//!     let ahead: Vec<f64> = y.iter().zip(&a).map(|(y, a)| y + h * a).collect();
//!     let b = f.at(t + h, &ahead)?;
//!     Ok((0..y.len()).map(|k| y[k] + 0.5 * h * (a[k] + b[k])).collect())
//! })?
//! .register();
//! let growth = Ode::new(1, |_t, y, dydt| dydt[0] = y[0] * (1.0 - y[0]))?;
//! let scene = Scene::new("logistic growth", growth, vec![0.1]);
//!
//! let methods = [integrators::find("euler").unwrap(), heun];
//! let options = a3::ChartOptions { until: Some(2.0), ..Default::default() };
//! let chart = a3::chart(&scene, &methods, &options, &())?;
//! let finest = chart.runs().filter(|run| run.solver == "my-heun").last().unwrap();
//! assert!((finest.order.unwrap() - 2.0).abs() < 0.01);
//! assert!(chart.figure(800, 560)?.svg().contains("my-heun"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

mod cli;
mod commands;
#[cfg(test)]
mod hostile;
mod program;

pub use a3_files::{
    failure::{Failure, InputError},
    monitor::Monitor,
    quantity::Quantity,
    setup::{Request, SceneOptions, scene},
};
pub use a3_lab::{
    chart::{Chart, ChartOptions, Record, chart},
    choose::{Choice, ChooseOptions, Chosen, Goal, choose},
    compare::{ComparedRun, Comparison, compare},
    judge::{JudgeOptions, StatesOf, Verdict, judge_states},
    simplify::{LeanScene, ModelEffect, SceneRun, Simplified, SimplifyOptions, simplify},
    stability::{MethodLimits, Stability, stability},
};
pub use program::{main, run};
