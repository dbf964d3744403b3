//! Runs of scenes.

use std::sync::Arc;

use a3_core::{Checkpoint, Error, Network, Passage, Simulation, StepLimits, Vector3};
use a3_files::failure::Failure;
use a3_files::output;
use a3_media::painter::Painter;
use a3_media::show::{Arrows, Manner, Quantity, Show, check_drawing, kind_name, style};
use a3_scenes::Presentation;
use a3_studio::caption;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::arrays::{indices, numbers, rows};
use super::driving::{Driven, GoOn, advance, check_time, drive, take_steps};
use super::errors::{of_error, told, wrong};
use super::function::{Function, Raised, Shape};
use super::own_method::raised_by;
use super::scene::{Given, Opened, setting};
use super::tables::method;
use super::turns::{Turn, Turns};

/// Data of all springs: ends, kinds, stiffness (N/m), rest length (m), damping (N s/m).
type Springs<'py> = (
    Bound<'py, PyArray2<i64>>,
    Vec<&'static str>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// The run of a scene by a method.
#[pyclass(frozen, subclass, module = "a3_simulator._a3")]
pub struct Run {
    simulation: Turns<Simulation>,
    presentation: Arc<Presentation>,
    /// Length of a run of the scene (s), if it has one of its own.
    duration: Option<f64>,
    /// Exceptions of the functions of the scene.
    raised: Raised,
    /// Whether the scene or the method calls functions of Python.
    calls: bool,
    /// Whether the run goes back in time.
    is_backward: bool,
}

impl Run {
    /// Returns the simulation, as soon as no other thread uses it.
    fn simulation(&self, py: Python<'_>) -> PyResult<Turn<'_, Simulation>> {
        self.simulation.wait(py)?.ok_or_else(|| {
            wrong(
                py,
                "this run is being advanced by the caller of this function: wait until it has advanced",
            )
        })
    }

    /// Runs `work` on the simulation without the global lock.
    fn work(
        &self,
        py: Python<'_>,
        progress: Option<&Bound<PyAny>>,
        work: impl Send + FnOnce(&mut Simulation, GoOn) -> Driven,
    ) -> PyResult<()> {
        let mut simulation = self.simulation(py)?;
        let of_method = raised_by(simulation.method());
        let raised: Vec<_> = [self.raised.clone()].into_iter().chain(of_method).collect();
        drive(py, &mut simulation, &raised, progress, work)
    }

    /// Applies `read` to the network, if the scene is one.
    fn network<T>(&self, py: Python<'_>, read: impl FnOnce(&Network) -> T) -> PyResult<Option<T>> {
        Ok(self.simulation(py)?.model().network().map(read))
    }

    /// Changes the simulation by `change`, which may refuse.
    fn change<T>(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut Simulation) -> Result<T, Error>,
    ) -> PyResult<T> {
        let mut simulation = self.simulation(py)?;
        change(&mut simulation).map_err(|error| of_error(py, &error, error.to_string()))
    }

    /// Checks that the run can advance to a time (s).
    fn check_time(&self, py: Python<'_>, time: f64) -> PyResult<()> {
        let checked = check_time(&*self.simulation(py)?, time);
        checked.map_err(|why| wrong(py, why))
    }
}

#[pymethods]
impl Run {
    #[new]
    fn new(
        py: Python<'_>,
        given: Given,
        method: Option<&str>,
        step: Option<f64>,
        tolerance: Option<f64>,
        absolute: Option<f64>,
        max_step: Option<f64>,
    ) -> PyResult<Self> {
        let mut opened = Opened::new(py, &given)?;
        let method = method.map(|name| self::method(py, name)).transpose()?;
        let method = opened.scene.method_or(method);
        let value = setting(py, method, step, tolerance)?;
        let limits = StepLimits { absolute, max_step };
        if !method.is_adaptive() && limits != StepLimits::default() {
            let why = format!(
                "{} takes a step, not a tolerance: leave out absolute and max_step",
                method.name
            );
            return Err(wrong(py, why));
        }
        let Opened { scene, setup, .. } = &mut opened;
        let run = py.detach(|| scene.run(setup, method, value, limits));
        // Its energy was evaluated.
        if let Some(raised) = opened.raised.take() {
            return Err(raised);
        }
        Ok(Self {
            simulation: Turns::new(told(py, run)?),
            presentation: opened.setup.presentation.clone(),
            duration: opened.setup.defaults.duration,
            calls: opened.calls || method.is_own(),
            is_backward: opened.is_backward,
            raised: opened.raised,
        })
    }

    /// Takes this number of steps. If the present time is within a step, that step is finished
    /// first, and counts.
    #[pyo3(signature = (count=1))]
    fn step(&self, py: Python<'_>, count: u64) -> PyResult<()> {
        self.work(py, None, move |run, go_on| take_steps(run, count, go_on))
    }

    /// Advances to a time (s). `progress` is called with the time now and then.
    #[pyo3(signature = (time, progress=None))]
    fn advance(&self, py: Python<'_>, time: f64, progress: Option<&Bound<PyAny>>) -> PyResult<()> {
        let calls = self.calls;
        self.check_time(py, time)?;
        self.work(py, progress, move |run, go_on| advance(run, time, calls, go_on))
    }

    /// Advances to the first time at which a function of t and y passes through 0, or else to a
    /// time (s). A `direction` above 0 is from below, one below 0 from above.
    #[pyo3(signature = (function, time, direction=0))]
    fn advance_until(
        &self,
        py: Python<'_>,
        function: &Bound<PyAny>,
        time: f64,
        direction: i64,
    ) -> PyResult<bool> {
        self.check_time(py, time)?;
        let function = Function::new(function, Shape::Number, &self.raised)?;
        let passage = match direction.signum() {
            0 => Passage::Either,
            1 => Passage::Rising,
            _ => Passage::Falling,
        };
        let mut found = false;
        self.work(py, None, |run, _| {
            let value = |t: f64, y: &[f64]| {
                let mut value = [0.0];
                function.of_state(t, y, &mut value)?;
                Ok(value[0])
            };
            found = run
                .advance_until(time, passage, value)
                .map_err(|error| Box::new((error.clone(), error.to_string())))?;
            Ok(())
        })?;
        Ok(found)
    }

    /// Continues from another state, at another time (s) or this one.
    #[pyo3(signature = (state, time=None))]
    fn set_state(&self, py: Python<'_>, state: Vec<f64>, time: Option<f64>) -> PyResult<()> {
        self.change(py, |run| run.set_state(&state, time.unwrap_or(run.time())))
    }

    /// Goes back to the beginning.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.simulation(py)?.reset();
        Ok(())
    }

    /// Returns the run as it is now, to continue from with the same bits.
    fn checkpoint<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let checkpoint = self.simulation(py)?.checkpoint();
        let bytes = postcard::to_stdvec(&(self.is_backward, checkpoint));
        let bytes = bytes.map_err(|error| wrong(py, error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Continues from a checkpoint of the same scene.
    fn restore(&self, py: Python<'_>, checkpoint: &[u8]) -> PyResult<()> {
        let (is_backward, checkpoint): (bool, Checkpoint) = postcard::from_bytes(checkpoint)
            .map_err(|_| wrong(py, "these bytes are not the checkpoint of a run"))?;
        if is_backward != self.is_backward {
            let why = "the checkpoint is of a run in the other direction of time";
            return Err(wrong(py, why));
        }
        self.change(py, |run| run.restore(&checkpoint))
    }

    /// Pins a particle where it is, or releases it, and returns whether it is pinned then.
    fn toggle_pin(&self, py: Python<'_>, particle: usize) -> PyResult<bool> {
        self.change(py, |run| run.toggle_pin(particle))
    }

    /// Grabs a particle with the hand.
    fn grab(&self, py: Python<'_>, particle: usize) -> PyResult<()> {
        self.change(py, |run| run.grab(particle))
    }

    /// Pulls the grabbed particle towards a point (m).
    fn pull(&self, py: Python<'_>, point: [f64; 3]) -> PyResult<()> {
        if point.iter().any(|x| !x.is_finite()) {
            let why = format!("a point is three finite numbers in metres, not {point:?}");
            return Err(wrong(py, why));
        }
        self.simulation(py)?.pull(Vector3::from(point));
        Ok(())
    }

    /// Lets go of the grabbed particle.
    fn release(&self, py: Python<'_>) -> PyResult<()> {
        self.simulation(py)?.release();
        Ok(())
    }

    /// Returns the name of the scene.
    #[getter]
    fn scene(&self, py: Python<'_>) -> PyResult<String> {
        Ok(self.simulation(py)?.scene().name.clone())
    }

    /// Returns the name of the method.
    #[getter]
    fn method(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(self.simulation(py)?.method().name)
    }

    /// Returns the step (s) or the relative tolerance.
    #[getter]
    fn setting(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.simulation(py)?.control().value())
    }

    /// Returns whether the method chooses its steps.
    #[getter]
    fn adaptive(&self, py: Python<'_>) -> PyResult<bool> {
        Ok(self.simulation(py)?.control().step().is_none())
    }

    /// Returns the length of the next step or, of an adaptive method, of the last (s).
    #[getter]
    fn step_size(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        Ok(self.simulation(py)?.step_size())
    }

    /// Returns the length of a run of the scene (s), if it has one of its own.
    #[getter]
    fn duration(&self) -> Option<f64> {
        self.duration
    }

    /// Returns the simulated time (s).
    #[getter]
    fn time(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.simulation(py)?.time())
    }

    /// Returns the number of steps.
    #[getter]
    fn steps(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(self.simulation(py)?.steps())
    }

    /// Returns the cost of the steps: evaluations, solves, factorisations, rejections, and the
    /// total in evaluations.
    fn work_done(&self, py: Python<'_>) -> PyResult<(u64, u64, u64, u64, f64)> {
        let work = self.simulation(py)?.work();
        Ok((work.evaluations, work.solves, work.factorizations, work.rejections, work.total()))
    }

    /// Returns the state, as a flat array.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(numbers(py, self.simulation(py)?.state()))
    }

    /// Returns the positions (m), n x 3.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let simulation = self.simulation(py)?;
        rows(py, &simulation.state()[..3 * simulation.particles()])
    }

    /// Returns the velocities (m/s), n x 3.
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let simulation = self.simulation(py)?;
        let mut velocities = simulation.velocities();
        if simulation.particles() == 0 {
            velocities.clear();
        }
        rows(py, &velocities)
    }

    /// Returns the contact forces (N), n x 3, if anything can touch.
    #[getter]
    fn contact_forces<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let forces = self.simulation(py)?.contact_forces();
        forces.map(|forces| rows(py, &forces)).transpose()
    }

    /// Returns the masses (kg), if the scene has some.
    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        self.network(py, |network| numbers(py, network.masses()))
    }

    /// Returns the numbers of the pinned particles.
    #[getter]
    fn pinned<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let pins = self.network(py, |network| network.pins().map(|(i, _)| i as i64).collect());
        Ok(PyArray1::from_vec(py, pins?.unwrap_or_default()))
    }

    /// Returns the triangles of the surfaces.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let corners = &self.presentation.surface.triangles;
        let corners = corners.iter().map(|corners| corners.map(i64::from));
        indices(py, &corners.collect::<Vec<_>>())
    }

    /// Returns the ends, kinds and numbers of all springs.
    fn spring_data<'py>(&self, py: Python<'py>) -> PyResult<Springs<'py>> {
        let simulation = self.simulation(py)?;
        let network = simulation.model().network();
        let springs: Vec<_> = network.into_iter().flat_map(Network::all_springs).collect();
        let ends: Vec<_> = springs.iter().map(|s| [s.i as i64, s.j as i64]).collect();
        let column = |number: fn(&a3_core::Spring) -> f64| {
            PyArray1::from_iter(py, springs.iter().map(number))
        };
        Ok((
            indices(py, &ends)?,
            springs.iter().map(|s| kind_name(s.kind)).collect(),
            column(|s| s.law.stiffness),
            column(|s| s.law.rest_length),
            column(|s| s.law.damping),
        ))
    }

    /// Returns the energy (J): kinetic, elastic, of contact, gravitational.
    fn energies(&self, py: Python<'_>) -> PyResult<Option<[f64; 4]>> {
        let energy = self.simulation(py)?.energy();
        Ok(energy.map(|e| [e.kinetic, e.elastic, e.contact, e.gravitational]))
    }

    /// A picture, as a PNG file.
    #[pyo3(signature = (width, height, *, colour=None, arrows=None, wireframe=false, springs=false,
        orthographic=false, dark=false, transparent=false))]
    #[expect(
        clippy::too_many_arguments,
        clippy::fn_params_excessive_bools,
        reason = "each is an option"
    )]
    fn picture<'py>(
        &self,
        py: Python<'py>,
        width: u32,
        height: u32,
        colour: Option<&str>,
        arrows: Option<&str>,
        wireframe: bool,
        springs: bool,
        orthographic: bool,
        dark: bool,
        transparent: bool,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let mut simulation = self.simulation(py)?;
        let run = &mut *simulation;
        let draw = move || {
            let manner = Manner {
                style: style(wireframe, springs),
                springs_of: None,
                orthographic,
                dark,
                colour: named(colour, "colour", &Quantity::ALL, Quantity::name)?,
                arrows: named(arrows, "arrows", &Arrows::ALL, Arrows::name)?,
            };
            check_drawing(run, manner, false)?;
            let mut show = Show::new(self.presentation.clone(), manner);
            show.transparent = transparent;
            let size = (width, height);
            let mut painter = Painter::new(&show, run, size, caption(&show, size))?;
            output::png(&painter.draw(&mut show, run)?, size)
        };
        let png = py.detach(draw);
        Ok(PyBytes::new(py, &told(py, png)?))
    }
}

/// Finds the choice of this name.
fn named<T: Copy>(
    name: Option<&str>,
    option: &str,
    all: &[T],
    name_of: impl Fn(T) -> &'static str,
) -> Result<Option<T>, Failure> {
    let Some(name) = name else { return Ok(None) };
    let found = all.iter().copied().find(|choice| name_of(*choice) == name);
    found.map(Some).ok_or_else(|| {
        let names: Vec<_> = all.iter().map(|choice| name_of(*choice)).collect();
        let names = names.join(", ");
        Failure::usage(format!("{option} `{name}`: the choices are {names}"))
    })
}
