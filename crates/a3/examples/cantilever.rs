//! Chart of the deflection of a bar under its weight, as solids of several Poisson's ratios and as
//! a jelly, compared with Timoshenko's beam: linear tetrahedra are too stiff, and less so the finer
//! they are.
//!
//! `cargo run -p a3-simulator --example cantilever -- docs/pictures/cantilever.svg`

use std::error::Error;

use a3_core::elements::Solid;
use a3_core::{Element, Network, ParticleSystem, Path, Vector3, integrators};
use a3_plot::{Curve, CurveStyle, Marker, Measurement, Problem, WorkPrecision};
use a3_scenes::Description;

/// Lengths of the edges (m), density (kg/m3) and Young's modulus (Pa) of the bar.
const SIZE: [f64; 3] = [1.0, 0.1, 0.1];
const DENSITY: f64 = 1000.0;
const YOUNG: f64 = 1e5;
/// Acceleration of gravity (m/s2), so small that the bar hardly bends.
const GRAVITY: f64 = 1e-4;
/// Evaluations of a single spring in the time of one tetrahedron.
const TETRAHEDRON_COST: f64 = 3.7;

/// Model of the bar.
#[derive(Clone, Copy)]
enum Made {
    /// Tetrahedra, with their Poisson's ratio.
    Solid(f64),
    /// Springs.
    Jelly,
}

/// A bar that is held at its left end.
struct Bar {
    network: Network,
    positions: Vec<f64>,
    tip: Vec<usize>,
    /// Cost of its forces, in single springs.
    cost: f64,
}

/// Makes the bar with a number of cells across, each twice as long as it is high.
fn bar(made: Made, across: usize) -> Result<Bar, Box<dyn Error>> {
    let grid = [5 * across + 1, across + 1, across + 1];
    let body = match made {
        Made::Solid(poisson) => {
            format!("[[solid]]\ndensity = {DENSITY}\nyoung = {YOUNG}\npoisson = {poisson}\n")
        }
        Made::Jelly => "[[jelly]]\nmass = 1\nstiffness = [200, 125, 85]\n".into(),
    };
    let text = format!("{body}grid = {grid:?}\nsize = {SIZE:?}\nat = [0.5, 0, 0]\n");
    let scene = Description::parse(&text)?.build(None, &mut |name| Err(name.into()))?.scene;
    let own = scene.model.network().ok_or("no network")?;
    let n = own.particles();
    let at = |axis: usize, i: usize| scene.state[axis * n + i];
    // Particles at the surface have the mass of half a cell, at its edges of a quarter.
    let share = |i: usize| -> f64 {
        let is_outer = |axis: usize| {
            let centre = if axis == 0 { 0.5 } else { 0.0 };
            (at(axis, i) - centre).abs() > 0.4999 * SIZE[axis]
        };
        let shares = (0..3).map(|axis| if is_outer(axis) { 0.5 } else { 1.0 });
        shares.product::<f64>() / (5 * across.pow(3)) as f64
    };
    let mass = DENSITY * SIZE.iter().product::<f64>();
    let mut network = Network::new((0..n).map(|i| share(i) * mass).collect())?;
    network.add_springs(own.springs())?;
    let mut cost = own.springs().count() as f64;
    for element in own.elements() {
        if let Element::Solid(solid) = element {
            cost += TETRAHEDRON_COST * Solid::volumes(solid).count() as f64;
            network.add(element.clone())?;
        }
    }
    for i in (0..n).filter(|i| at(0, *i) < 1e-9) {
        let place = Vector3::new(at(0, i), at(1, i), at(2, i));
        network.pin(i, Path::Still(place))?;
    }
    Ok(Bar {
        tip: (0..n).filter(|i| at(0, *i) > SIZE[0] - 1e-9).collect(),
        positions: scene.state[..3 * n].to_vec(),
        network,
        cost,
    })
}

impl Bar {
    /// Returns the displacement of the tip (m) at rest with gravity along an axis: one step of
    /// implicit Euler, so long that inertia is negligible, solves the linear equations.
    fn displacement(&mut self, axis: usize) -> Result<f64, Box<dyn Error>> {
        let n = self.network.particles();
        let mut gravity = Vector3::zeros();
        gravity[axis] = GRAVITY;
        self.network.set_gravity(gravity);
        let mut y = [self.positions.clone(), vec![0.0; 3 * n]].concat();
        assert_eq!(y.len(), self.network.dim());
        let implicit = integrators::find("implicit").ok_or("no method")?;
        let mut implicit = implicit.integrator(&self.network)?;
        implicit.step(&self.network, 0.0, 1e4, &mut y)?;
        let moved = |i: &usize| y[axis * n + i] - self.positions[axis * n + i];
        Ok(self.tip.iter().map(moved).sum::<f64>() / self.tip.len() as f64)
    }
}

/// Returns the deflection (m) of Timoshenko's beam of a square section under its weight, by bending
/// and by shear (Cowper, 1966).
fn deflection(young: f64, poisson: f64) -> f64 {
    let [length, height, width] = SIZE;
    let (area, inertia) = (height * width, width * height.powi(3) / 12.0);
    let load = DENSITY * area * GRAVITY;
    let shear = young / (2.0 * (1.0 + poisson));
    let share = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
    load * length.powi(4) / (8.0 * young * inertia)
        + load * length.powi(2) / (2.0 * share * shear * area)
}

/// Returns the error of the deflection, over the deflection of the beam.
fn error(made: Made, bar: &mut Bar) -> Result<f64, Box<dyn Error>> {
    let (young, poisson) = match made {
        Made::Solid(poisson) => (YOUNG, poisson),
        // Young's modulus is that of its own stretch under its weight. Springs in all directions
        // have Poisson's ratio 1/4.
        Made::Jelly => {
            let stretch = bar.displacement(0)?;
            (DENSITY * GRAVITY * SIZE[0].powi(2) / (2.0 * stretch), 0.25)
        }
    };
    Ok(bar.displacement(1)? / deflection(young, poisson) - 1.0)
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("which file is the chart to be?")?;
    let kinds = [
        (Made::Solid(0.0), "solid, Poisson's ratio 0", "#1f77b4", Marker::Polygon(8, 0.0)),
        (Made::Solid(0.3), "solid, 0.3", "#d62728", Marker::Polygon(4, 0.125)),
        (Made::Solid(0.45), "solid, 0.45", "#2ca02c", Marker::Polygon(4, 0.0)),
        (Made::Jelly, "jelly", "#7f7f7f", Marker::Polygon(3, 0.0)),
    ];
    let mut curves = vec![];
    println!("body                       cells across   cost (springs)   error");
    for (made, name, colour, marker) in kinds {
        let mut runs = vec![];
        for across in [1, 2, 4, 8] {
            let mut bar = bar(made, across)?;
            let error = error(made, &mut bar)?;
            println!("{name:<25}  {across:12}   {:14.0}   {:+.3}", bar.cost, error);
            runs.push(Measurement {
                error: error.abs(),
                work: bar.cost,
                lost: false,
                held: false,
                label: Some(across.to_string()),
                spread: None,
            });
        }
        let style = CurveStyle { colour, dash: &[], marker };
        let name = name.into();
        curves.push(Curve { style, name, runs });
    }
    let chart = WorkPrecision {
        title: "A bar that bends under its weight".into(),
        subtitle: "1 m x 0.1 m x 0.1 m, in cells twice as long as high; labels: cells across"
            .into(),
        x_label: "error of the deflection, against Timoshenko's beam".into(),
        y_label: "cost of the forces (single springs)".into(),
        problems: vec![Problem { curves, ..Problem::default() }],
        foot: String::new(),
        held: String::new(),
    };
    std::fs::write(path, chart.draw(800.0, 560.0)?.svg())?;
    Ok(())
}
