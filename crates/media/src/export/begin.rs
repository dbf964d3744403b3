//! Creation of exports, by the ending of the file.

use std::path::Path;

use a3_files::failure::Failure;
use a3_files::frames::{FrameTimes, Sequence};
use a3_files::output;
use a3_files::setup::Run;

use super::geometry::{Export, Job};
use super::{csv, glb, json, npz, obj, usd, vtu};

/// Default frames per second.
const DEFAULT_RATE: f64 = 30.0;

/// Largest sizes of files (GiB): in general, and in formats whose lengths have 32 bits.
const MAX_SIZES: (f64, f64) = (16.0, 4.0);

/// Endings of the files of all formats.
const ENDINGS: &[&str] = &["json", "csv", "npz", "obj", "glb", "usda", "vtu"];

/// Checks that the output is standard output or has the ending of a format.
pub fn check_ending(path: &Path) -> Result<(), Failure> {
    if path == Path::new("-") {
        return Ok(());
    }
    output::check_ending(path, ENDINGS)
}

/// Creates the export of a run to a file, and the times of its frames, at this rate (1/s) if one is
/// given. Impossible exports are refused here, before any work is done.
pub fn begin(
    path: &Path,
    rate: Option<f64>,
    run: &Run,
) -> Result<(FrameTimes, Box<dyn Export>), Failure> {
    let (simulation, presentation) = (&run.simulation, &run.presentation);
    let until = run.until;
    let last = FrameTimes::new(until, until, DEFAULT_RATE)?;
    if path == Path::new("-") {
        if rate.is_some() {
            return Err(Failure::usage(
                "--fps needs a file: standard output gets only the final state",
            ));
        }
        return Ok((last, Box::new(json::Json::to_stdout())));
    }
    output::check(path, ENDINGS)?;
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let sequence = Sequence::of(path);
    let of_vtu = if ending == "vtu" { Some(vtu::size(simulation)?) } else { None };
    let is_single = ending == "obj" || of_vtu.is_some();
    let single = |files| obj::Frames {
        presentation: presentation.clone(),
        files,
        write: of_vtu.map_or(obj::write, |_| vtu::write),
    };
    if is_single && sequence.is_none() {
        if rate.is_some() {
            let ending = ending.display();
            return Err(Failure::usage(format!(
                "a file .{ending} has one frame: leave out --fps, or write a sequence such as cloth-####.{ending}"
            )));
        }
        check_size(of_vtu.unwrap_or_default(), MAX_SIZES.0)?;
        return Ok((last, Box::new(single(obj::Files::One(path.into())))));
    }
    if ending == "json" && rate.is_none() {
        return Ok((last, Box::new(json::Json::new(path, false)?)));
    }
    let all = FrameTimes::new(0.0, until, rate.unwrap_or(DEFAULT_RATE))?;
    let several = all.since(simulation.time());
    let (particles, count) = (simulation.particles() as f64, several.count as f64);
    let (ending, first) = (ending.to_str(), several.first);
    let job = Job { path, surface: &presentation.surface, simulation, frames: several };
    let (size, largest) = match ending {
        Some("csv") => (csv::ROW_SIZE * particles * count, MAX_SIZES.0),
        Some("npz") => (npz::size(particles, several), MAX_SIZES.1),
        Some("glb") => {
            glb::check(several)?;
            (glb::size(job), MAX_SIZES.1)
        }
        Some("usda") => (usd::size(simulation, several), MAX_SIZES.0),
        Some("obj" | "vtu") => {
            sequence.iter().try_for_each(|it| it.check(all.count))?;
            let size = of_vtu.unwrap_or_else(|| obj::size(job));
            (size * count, MAX_SIZES.0)
        }
        _ => (json::ROW_SIZE * particles * count, MAX_SIZES.0),
    };
    check_size(size, largest)?;
    let export: Box<dyn Export> = match (ending, sequence) {
        (Some("csv"), _) => Box::new(csv::Csv::new(path, first)?),
        (Some("npz"), _) => Box::new(npz::Npz::new(path, simulation, several)?),
        (Some("glb"), _) => Box::new(glb::Glb::new(job)?),
        (Some("usda"), _) => Box::new(usd::Usd::new(job)?),
        (Some("obj" | "vtu"), Some(sequence)) => {
            Box::new(single(obj::Files::Many(sequence, first)))
        }
        _ => Box::new(json::Json::new(path, true)?),
    };
    Ok((several, export))
}

/// Refuses a file of `bytes` bytes if they are more than `largest` (GiB).
fn check_size(bytes: f64, largest: f64) -> Result<(), Failure> {
    let size = bytes / 1024f64.powi(3);
    if size <= largest {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "the file would have {size:.1} GiB, and at most {largest} GiB are allowed: use a lower --fps or --until, or fewer particles"
    )))
}
