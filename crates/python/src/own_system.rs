//! Own systems and own forces: functions of Python.

use a3_core::elements::OwnForce;
use a3_core::{Error, Model, Ode, ParticleSystem, Scene, SecondOrder};
use pyo3::prelude::*;

use super::errors::{of_error, wrong};
use super::function::{Function, Raised, Shape};

/// Cost of a call of a function of Python, in the unit of
/// [`evaluation_cost`](a3_core::ParticleSystem::evaluation_cost). One of a line takes 5 us.
const COST_OF_CALL: f64 = 25_000.0;

/// Builds the scene of a `System` of Python.
pub fn scene(system: &Bound<PyAny>, raised: &Raised) -> PyResult<Scene> {
    let py = system.py();
    let failed = |error: Error| of_error(py, &error, error.to_string());
    let name: String = system.getattr("name")?.extract()?;
    let state: Vec<f64> = system.getattr("_state")?.extract()?;
    let call = system.getattr("f")?;
    let masses: Option<Vec<f64>> = system.getattr("masses")?.extract()?;
    let model: Model = if let Some(masses) = masses {
        let forces = Function::new(&call, Shape::Rows, raised)?;
        let made = SecondOrder::of_particles(&masses, move |t, x, v, f: &mut [f64]| {
            forces.of_motion(t, x, v, f)
        });
        let mut system_of = made.map_err(failed)?;
        let energy = system.getattr("_energy")?;
        if !energy.is_none() {
            let energy = Function::new(&energy, Shape::Number, raised)?;
            system_of = system_of.with_energy(move |t, x, v, found| {
                energy.of_motion(t, x, v, std::slice::from_mut(found))
            });
        }
        if system.getattr("positional")?.extract()? {
            system_of.positional().into()
        } else {
            system_of.into()
        }
    } else {
        let f = Function::new(&call, Shape::Flat, raised)?;
        let made = Ode::new(state.len(), move |t, y, dydt: &mut [f64]| f.of_state(t, y, dydt));
        let scales: Vec<f64> = system.getattr("_scales")?.extract()?;
        let made = made.and_then(|made| {
            let cost = COST_OF_CALL + made.evaluation_cost();
            made.with_evaluation_cost(cost)
        });
        let mut made = made.map_err(failed)?;
        let jacobian = system.getattr("_jac")?;
        if !jacobian.is_none() {
            let sparse = system.call_method0("_entries")?;
            made = if sparse.is_none() {
                let jacobian = Function::new(&jacobian, Shape::Square, raised)?;
                made.with_jacobian(move |t, y, out| jacobian.of_state(t, y, out))
            } else {
                let entries = Function::new(&sparse, Shape::Flat, raised)?;
                made.with_jacobian_entries(move |t, y, out| entries.entries_of_state(t, y, out))
            };
        }
        let sparsity: Vec<(u32, u32)> = system.getattr("_sparsity")?.extract()?;
        made = made.with_sparsity(sparsity).map_err(failed)?;
        let mass: Vec<(u32, u32, f64)> = system.getattr("_mass")?.extract()?;
        if !mass.is_empty() {
            made = made.with_mass_matrix(mass).map_err(failed)?;
        }
        let jumps: Vec<f64> = system.getattr("_jumps")?.extract()?;
        made = made.with_jumps(jumps).map_err(failed)?;
        let (count, quantities): (usize, Bound<PyAny>) =
            system.getattr("_quantities")?.extract()?;
        if !quantities.is_none() {
            let quantities = Function::new(&quantities, Shape::Flat, raised)?;
            let write = move |t: f64, y: &[f64], out: &mut [f64]| quantities.of_state(t, y, out);
            made = made.with_quantities(count, write).map_err(failed)?;
        }
        if system.getattr("_backward")?.extract()? {
            made = made.reversed();
        }
        if scales.is_empty() {
            made.into()
        } else {
            made.with_scales(scales).map_err(failed)?.into()
        }
    };
    Ok(Scene::new(name, model, state))
}

/// Adds forces F(t, x, v) to the network of a scene.
pub fn add_forces(scene: &mut Scene, forces: &[Bound<PyAny>], raised: &Raised) -> PyResult<()> {
    for force in forces {
        let function = Function::new(force, Shape::Rows, raised)?;
        let Model::Network(network) = &mut scene.model else {
            let name = &scene.name;
            let why = format!("the scene {name} has no masses that forces could act on");
            return Err(wrong(force.py(), why));
        };
        let own = OwnForce::new(move |t, x: &[f64], v: &[f64], f: &mut [f64]| {
            let mut added = vec![0.0; f.len()];
            function.of_motion(t, x, v, &mut added)?;
            for (f, added) in f.iter_mut().zip(added) {
                *f += added;
            }
            Ok::<(), String>(())
        });
        let added = network.add(own);
        added.map_err(|error| of_error(force.py(), &error, error.to_string()))?;
    }
    Ok(())
}
