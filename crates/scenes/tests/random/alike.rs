//! The same motion in another frame: to a hundred times what a change of the start by a rounding
//! error grows to, and until that is a hundredth of the scene.

use a3_core::{Control, Method, Simulation, Vector3};
use a3_scenes::Setup;

use crate::chance::Chance;
use crate::frames::Frame;

/// Change of the start that shows how errors grow, over the size of the scene.
const CHANGE: f64 = 1e-12;

/// Largest difference between two frames, over the effect of that change.
const SLACK: f64 = 100.0;

/// Difference over the size of the scene from which on nothing is compared.
const HORIZON: f64 = 0.01;

/// Largest number of steps of a run, and of steps times particles.
const STEPS: [u64; 2] = [40, 3_000];

/// Seeds of the changes of the start, and of further ones, by which a motion is tried that differs
/// in another frame: rounding may decide which of two ways it goes.
const SEEDS: [std::ops::Range<u64>; 2] = [1..3, 3..13];

/// Error of the iterations of implicit methods, over the size of the scene: that of stiff solids,
/// where everything moves fast.
const UNSOLVED: f64 = 1e-5;

/// Number of times at which runs are compared.
const LOOKS: u64 = 4;

/// Places of all particles (m), with the time (s).
type Look = (f64, Vec<Vector3<f64>>);

/// Returns a run of the scene in default steps.
fn start(setup: &Setup, method: &'static Method) -> Result<Simulation, String> {
    let control = match method.default_control {
        Control::Step(h) => Control::Step(h * setup.defaults.step_scale),
        Control::Tolerance(tolerance) => Control::Tolerance(tolerance),
    };
    Simulation::new(setup.scene.clone(), method, control).map_err(|why| why.to_string())
}

/// Returns the number of steps between looks.
fn steps(setup: &Setup) -> u64 {
    let most = STEPS[1] / setup.scene.model.particles().max(1) as u64;
    (STEPS[0].min(most) / LOOKS).max(1)
}

fn look(run: &Simulation) -> Look {
    let places = (0..run.particles()).map(|i| run.position(i));
    (run.time(), places.collect())
}

/// Runs a scene, and looks at it now and then, as far as it gets.
fn watch(setup: &Setup, method: &'static Method) -> Result<Vec<Look>, String> {
    let mut run = start(setup, method)?;
    let mut looks = vec![look(&run)];
    for _ in 0..LOOKS {
        if run.take_steps(steps(setup)).is_err() {
            break;
        }
        looks.push(look(&run));
    }
    Ok(looks)
}

/// Changes the start by a rounding error.
fn shaken(setup: &Setup, seed: u64) -> Setup {
    let (mut other, mut chance) = (setup.clone(), Chance(seed));
    let (size, n) = (setup.scene.extent().1, setup.scene.model.particles());
    for (k, y) in other.scene.state.iter_mut().enumerate() {
        let scale = if k < 6 * n { size } else { y.abs() };
        *y += chance.within((-CHANGE, CHANGE, false)) * scale;
    }
    other
}

/// Returns the largest distance between particles of two looks, and the particle.
fn apart(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> (f64, usize) {
    let all = a.iter().zip(b).map(|(a, b)| (a - b).norm()).enumerate();
    all.fold((0.0, 0), |most, (i, d)| if d > most.0 { (d, i) } else { most })
}

/// Returns the number of the particle in the other frame for each one: the same where that begins
/// in its place, else the nearest of the same mass.
fn numbers(own: &Setup, other: &Setup, frame: &Frame) -> Result<Vec<usize>, String> {
    let place = |setup: &Setup, i: usize| {
        let n = setup.scene.model.particles();
        Vector3::from_fn(|axis, _| setup.scene.state[axis * n + i])
    };
    let n = own.scene.model.particles();
    if other.scene.model.particles() != n {
        let now = other.scene.model.particles();
        return Err(format!("{n} particles become {now}"));
    }
    let near = 1e-9 * (own.scene.extent().1 * frame.length + frame.shift.norm());
    let goals: Vec<_> = (0..n).map(|i| frame.place(place(own, i), 0.0)).collect();
    let places: Vec<_> = (0..n).map(|i| place(other, i)).collect();
    if apart(&goals, &places).0 <= near {
        return Ok((0..n).collect());
    }
    let mass = |setup: &Setup, i: usize| {
        let network = setup.scene.model.network();
        network.map_or(1.0, |network| network.masses()[i])
    };
    let mut free = vec![true; n];
    let mut find = |i: usize| {
        let fits = |j: &usize| {
            let alike = (mass(own, i) - mass(other, *j)).abs() <= 1e-9 * mass(own, i);
            free[*j] && alike && (goals[i] - places[*j]).norm() <= near
        };
        let j = (0..n).find(fits)?;
        free[j] = false;
        Some(j)
    };
    let found: Result<Vec<_>, _> = (0..n).map(|i| find(i).ok_or(i)).collect();
    found.map_err(|i| format!("no particle begins where {i} does, at {}", goals[i]))
}

/// A scene and its run by a method, with the growth of errors.
pub struct Known<'a> {
    setup: &'a Setup,
    method: &'static Method,
    looks: Vec<Look>,
    /// Effects of a rounding error at the start (m).
    growth: Vec<f64>,
}

impl<'a> Known<'a> {
    /// Runs a scene, unless the method does not serve it.
    pub fn new(setup: &'a Setup, method: &'static Method) -> Option<Self> {
        let looks = watch(setup, method).ok()?;
        let growth = vec![CHANGE * setup.scene.extent().1; looks.len()];
        let mut known = Self { setup, method, looks, growth };
        known.shake(SEEDS[0].clone());
        Some(known)
    }

    /// Finds the effects of rounding errors by these seeds too.
    fn shake(&mut self, seeds: std::ops::Range<u64>) {
        for seed in seeds {
            let shaken = watch(&shaken(self.setup, seed), self.method).unwrap_or_default();
            let mut most = 0.0f64;
            for (k, growth) in self.growth.iter_mut().enumerate() {
                let effect = shaken
                    .get(k)
                    .map_or(f64::INFINITY, |(_, places)| apart(&self.looks[k].1, places).0);
                most = most.max(effect);
                *growth = growth.max(most);
            }
        }
    }

    /// Compares the run with one in another frame.
    pub fn compare(&mut self, frame: &Frame, other: &Setup) -> Result<(), String> {
        self.differ(frame, other).or_else(|_| {
            self.shake(SEEDS[1].clone());
            self.differ(frame, other)
        })
    }

    /// Finds where a run in another frame differs more than rounding errors make it.
    fn differ(&self, frame: &Frame, other: &Setup) -> Result<(), String> {
        let numbers = numbers(self.setup, other, frame)?;
        let looks = watch(other, self.method)?;
        let size = self.setup.scene.extent().1;
        let far = 1.0 + frame.shift.norm() / size;
        for (k, ((t, places), growth)) in self.looks.iter().zip(&self.growth).enumerate() {
            let is_solved = f64::from(self.method.solves_linear_systems());
            let allowed = SLACK * far * growth + is_solved * UNSOLVED * size;
            if allowed.is_nan() || allowed > HORIZON * size {
                return Ok(());
            }
            let Some((time, found)) = looks.get(k) else {
                return Err(format!("it fails before {t} s"));
            };
            if (time - t).abs() > 1e-9 * t.abs() {
                return Err(format!("{time} s and not {t} s"));
            }
            let goals: Vec<_> = places.iter().map(|place| frame.place(*place, *t)).collect();
            let found: Vec<_> = numbers.iter().map(|j| found[*j]).collect();
            let (most, i) = apart(&goals, &found);
            let most = most / frame.length;
            if most.is_nan() || most > allowed {
                return Err(format!(
                    "particle {i} is {most:e} m off at {t} s, {:e} of the size; a rounding error of \
                     1e-12 grows to {growth:e} m",
                    most / size
                ));
            }
        }
        Ok(())
    }

    /// Compares the run with one that goes through a checkpoint in the middle.
    pub fn cut(&self) -> Result<(), String> {
        let (mut whole, count) = (start(self.setup, self.method)?, steps(self.setup));
        // A run that explodes is told of ten times a second. Until then it may have gone so far
        // that no checkpoint of it is accepted.
        let is_far = |run: &Simulation| run.state().iter().any(|y| y.abs() > 1e9);
        if whole.take_steps(count).is_err() || is_far(&whole) {
            return Ok(());
        }
        let checkpoint = whole.checkpoint();
        let mut rest = start(self.setup, self.method)?;
        rest.restore(&checkpoint).map_err(|why| why.to_string())?;
        let ends = [&mut whole, &mut rest].map(|run| run.take_steps(count).is_ok());
        let [own, other] = [&whole, &rest].map(Simulation::blow_up);
        if own != other {
            let what = "a run that goes on from a checkpoint blows up otherwise";
            return Err(format!("{what}: {other:?}, not {own:?}"));
        }
        let bits = |run: &Simulation| run.state().iter().map(|y| y.to_bits()).collect::<Vec<_>>();
        // A run that has blown up is back where it was sound, which may be before the checkpoint.
        let is_well = ends == [true; 2];
        if ends[0] != ends[1] || is_well && bits(&whole) != bits(&rest) {
            return Err("a run that goes on from a checkpoint has other bits".into());
        }
        Ok(())
    }
}
