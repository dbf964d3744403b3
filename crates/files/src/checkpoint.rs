//! A run as it is saved in a file, with the extremes that the summary at its end needs.
//!
//! The file consists of a line with the version of the program, the run in the format of
//! `postcard`, and the CRC-32 of both.

use std::fmt::Write;
use std::path::Path;

use a3_core::{Checkpoint, Grid, Scene, Simulation, StepLimits};
use serde::{Deserialize, Serialize};

use crate::bounds;
use crate::failure::Failure;
use crate::platform::{output, read_checkpoint};
use crate::scene_file::Source;

/// Ending of the files.
pub const ENDING: &str = "checkpoint";

/// First words of a file, before the version.
pub const TITLE: &[u8] = b"a3 checkpoint, version ";

/// Version of the program that reads and writes the files: no other one promises the same bits.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A saved run: its checkpoint, with the identity of its scene.
#[derive(Serialize, Deserialize)]
pub struct Kept {
    /// Name of the scene.
    name: String,
    /// Identity of the scene among others of this name: its grid, and a hash of its files.
    scene: String,
    /// The run.
    pub checkpoint: Checkpoint,
    /// Extremes of the run for its summary, if one is wanted.
    pub extremes: Option<Extremes>,
    /// Values that were tuned in the panel of the window, by the names of its rows.
    pub tuned: Vec<(String, f64)>,
    /// The scene as a text in TOML, if it was edited in the window.
    pub edited: Option<String>,
}

impl Kept {
    /// Records the present state of a run.
    pub fn new(
        source: &Source,
        grid: Option<Grid>,
        run: &Simulation,
        extremes: Option<Extremes>,
    ) -> Self {
        Self {
            name: run.scene().name.clone(),
            scene: identity(source, grid, run.scene()),
            checkpoint: run.checkpoint(),
            extremes,
            tuned: vec![],
            edited: None,
        }
    }

    /// Returns the same run, of a scene that was edited: its text in TOML, and the scene before
    /// that.
    pub fn of_edited(self, text: String, source: &Source, grid: Option<Grid>, own: &Scene) -> Self {
        Self { scene: identity(source, grid, own), edited: Some(text), ..self }
    }

    /// Writes the file.
    pub fn write(&self, path: &Path) -> Result<(), Failure> {
        output::write(path, &self.bytes()?)
    }

    /// Returns the bytes of the file.
    pub fn bytes(&self) -> Result<Vec<u8>, Failure> {
        let bytes = [TITLE, VERSION.as_bytes(), b"\n"].concat();
        let mut bytes = postcard::to_extend(self, bytes).map_err(Failure::run)?;
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        Ok(bytes)
    }

    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let refuse = |why: String| Failure::usage(format!("{}: {why}", path.display()));
        let bytes = read_checkpoint(path).map_err(refuse)?;
        Self::parse(&bytes).map_err(refuse)
    }

    /// Reads a run from the bytes of a file.
    fn parse(bytes: &[u8]) -> Result<Self, String> {
        if !bytes.starts_with(TITLE) {
            return Err("this is no checkpoint of a3".into());
        }
        let damaged = "this checkpoint is damaged: its checksum is wrong";
        let (content, sum) = bytes.split_last_chunk().ok_or(damaged)?;
        if crc32fast::hash(content) != u32::from_le_bytes(*sum) {
            return Err(damaged.into());
        }
        let content = &content[TITLE.len()..];
        let line = content.iter().position(|byte| *byte == b'\n');
        let (version, run) = content.split_at(line.ok_or(damaged)?);
        if version != VERSION.as_bytes() {
            return Err(format!(
                "this checkpoint was written by a3 {}, but this is a3 {VERSION}, whose bits may differ",
                String::from_utf8_lossy(version)
            ));
        }
        let kept: Self = postcard::from_bytes(&run[1..])
            .map_err(|_| "this checkpoint is damaged: its contents cannot be read")?;
        let control = kept.checkpoint.run.control;
        let range = bounds::of(control);
        if !range.contains(&control.value()) {
            let (value, low, high) = (control.value(), range.start(), range.end());
            return Err(format!(
                "this checkpoint is damaged: its step or tolerance is {value:e}, not from {low:e} to {high}"
            ));
        }
        let tuned = kept.tuned.iter().map(|(_, value)| *value);
        let extremes = kept.extremes.iter().flat_map(Extremes::numbers);
        if !extremes.chain(tuned).all(f64::is_finite) {
            return Err("this checkpoint is damaged: one of its numbers is not finite".into());
        }
        Ok(kept)
    }

    /// Checks that the file at `path` belongs to a scene, before its edits.
    pub fn check(
        &self,
        path: &Path,
        source: &Source,
        grid: Option<Grid>,
        scene: &Scene,
    ) -> Result<(), Failure> {
        let refuse = |why: String| Failure::usage(format!("{}: {why}", path.display()));
        let name = &scene.name;
        if self.name != *name {
            return Err(refuse(format!(
                "this checkpoint is of the scene {}, not of {name}",
                self.name
            )));
        }
        if self.scene != identity(source, grid, scene) {
            return Err(refuse(format!(
                "this checkpoint is of another scene {name}: its file, its meshes, its grid or the limits of its steps were others"
            )));
        }
        Ok(())
    }
}

/// Returns the identity of a scene among others of its name.
fn identity(source: &Source, grid: Option<Grid>, scene: &Scene) -> String {
    let mut identity = source.fingerprint(scene);
    if let Some(grid) = grid {
        let _ = write!(identity, " {}x{}", grid.rows(), grid.cols());
    }
    let StepLimits { absolute, max_step } = scene.limits;
    for limit in [absolute, max_step].into_iter().flatten() {
        let _ = write!(identity, " {limit}");
    }
    identity
}

/// Total energy (J).
#[derive(Clone, Copy, Serialize, Deserialize)]
pub struct Energy {
    /// At the start.
    pub begin: f64,
    /// At the end.
    pub end: f64,
    /// Largest distance from the energy at the start.
    pub largest_drift: f64,
}

/// Extremes of energy and stretch.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub struct Extremes {
    /// The total energy; none for a system without forces.
    pub energy: Option<Energy>,
    /// Largest length over rest length of a spring; none without springs.
    pub stretch: Option<f64>,
}

impl Extremes {
    /// Updates the extremes with the present state.
    pub fn observe(&mut self, simulation: &Simulation) {
        if let Some(total) = simulation.energy().map(|energy| energy.total()) {
            let energy =
                self.energy.get_or_insert(Energy { begin: total, end: total, largest_drift: 0.0 });
            energy.end = total;
            energy.largest_drift = energy.largest_drift.max((total - energy.begin).abs());
        }
        if let Some(stretch) = simulation.largest_stretch() {
            self.stretch = Some(self.stretch.map_or(stretch, |most| most.max(stretch)));
        }
    }

    /// Returns all numbers.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        let energy = self.energy.into_iter();
        let energies = energy.flat_map(|e| [e.begin, e.end, e.largest_drift]);
        energies.chain(self.stretch)
    }

    /// Returns a copy whose stretch is not a number.
    #[cfg(test)]
    pub fn spoiled(self) -> Self {
        Self { stretch: Some(f64::NAN), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept() -> Kept {
        let source = Source::find("pendulum").unwrap();
        let setup = source.build(None).unwrap();
        let method = a3_core::integrators::find("dop853").unwrap();
        let control = a3_core::Control::Tolerance(1e-6);
        let mut run = Simulation::new(setup.scene, method, control).unwrap();
        run.advance_to(0.3).unwrap();
        Kept::new(&source, None, &run, None)
    }

    #[test]
    fn a_file_gives_back_what_was_kept() {
        let kept = kept();
        let again = Kept::parse(&kept.bytes().ok().unwrap()).unwrap();
        assert_eq!(again.checkpoint, kept.checkpoint);
        assert_eq!(again.scene, kept.scene);
    }

    #[test]
    fn every_flipped_byte_and_every_cut_is_found() {
        let bytes = kept().bytes().ok().unwrap();
        for k in 0..bytes.len() {
            let mut flipped = bytes.clone();
            flipped[k] ^= 1 + (37 * k % 255) as u8;
            let why = Kept::parse(&flipped).err().unwrap();
            assert!(why.contains("damaged") || k < TITLE.len(), "{k}: {why}");
            assert!(Kept::parse(&bytes[..k]).is_err());
        }
    }

    /// Files with a correct checksum, but with numbers that no run has.
    #[test]
    fn what_no_run_holds_is_refused() {
        let refused = |change: &dyn Fn(&mut Kept)| {
            let mut kept = kept();
            change(&mut kept);
            let why = Kept::parse(&kept.bytes().ok().unwrap()).err().unwrap();
            assert!(why.starts_with("this checkpoint is damaged: "), "{why}");
        };
        for control in [a3_core::Control::Step(5e-324), a3_core::Control::Tolerance(f64::NAN)] {
            refused(&|kept| kept.checkpoint.run.control = control);
        }
        let mut extremes = Extremes::default();
        extremes.observe(&{
            let setup = Source::find("pendulum").unwrap().build(None).unwrap();
            let method = a3_core::integrators::find("v").unwrap();
            Simulation::new(setup.scene, method, method.default_control).unwrap()
        });
        assert!(extremes.numbers().count() == 4);
        refused(&|kept| kept.extremes = Some(extremes.spoiled()));
        refused(&|kept| kept.tuned.push(("gravity".into(), f64::INFINITY)));
    }

    /// Files with a correct checksum in which a number of the adaptive method or of the present
    /// step was changed.
    #[test]
    fn forged_steps_are_refused() {
        let kept = kept();
        let progress = serde_json::to_value(&kept.checkpoint.progress).unwrap();
        let forge = |place: &str, number: f64| {
            let there = progress.pointer(place).unwrap().as_f64().unwrap();
            let mut bytes = kept.bytes().ok().unwrap();
            bytes.truncate(bytes.len() - 4);
            let mut found = false;
            for at in 0..bytes.len() - 7 {
                if bytes[at..at + 8] == there.to_le_bytes() {
                    bytes[at..at + 8].copy_from_slice(&number.to_le_bytes());
                    found = true;
                }
            }
            assert!(found, "{place}");
            bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
            let mut run = {
                let setup = Source::find("pendulum").unwrap().build(None).unwrap();
                let method = a3_core::integrators::find("v").unwrap();
                Simulation::new(setup.scene, method, method.default_control).unwrap()
            };
            let kept = Kept::parse(&bytes)?;
            let restored = run.restore(&kept.checkpoint);
            restored.map_err(|why| why.to_string())
        };
        let next = progress.pointer("/method/next").unwrap().as_f64().unwrap();
        for place in ["/method/next", "/method/last/h"] {
            assert_eq!(forge(place, 0.5 * next), Ok(()));
            for number in [5e-324, -1e-3, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let why = forge(place, number).unwrap_err();
                assert!(why.contains("a step must be 0 or a positive number"), "{why}");
            }
        }
        for place in ["/within/times/0", "/within/times/1"] {
            for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                assert!(forge(place, number).is_err(), "{place}: {number}");
            }
        }
    }

    #[test]
    fn another_version_is_refused_by_name() {
        let mut bytes = kept().bytes().ok().unwrap();
        bytes.truncate(bytes.len() - 4);
        bytes[TITLE.len()] = b'7';
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        let why = Kept::parse(&bytes).err().unwrap();
        assert!(why.contains("written by a3 7."), "{why}");
    }
}
