//! Computing times of two runs, measured in turns.

use std::time::Duration;

use a3_core::accuracy::{self, Frames, GoOn};
use a3_core::{Control, Method, Scene, Simulation};

use a3_files::failure::Failure;
use a3_files::processor;

/// Least and largest number of turns.
const TURNS: std::ops::Range<u32> = 3..200;
/// Computing time of all turns after which no other follows.
const ENOUGH: Duration = Duration::from_millis(300);

/// Times two runs in turns, in processor time, so that other work of the machine slows both alike.
/// The shortest time of each counts. `None` if `go_on` returned false.
pub fn in_turns(
    runs: [(&Scene, &'static Method, Control); 2],
    frames: &Frames,
    go_on: GoOn,
) -> Result<Option<[Duration; 2]>, Failure> {
    let (mut best, mut sum) = ([Duration::MAX; 2], Duration::ZERO);
    for turn in 0..TURNS.end {
        if turn >= TURNS.start && sum > ENOUGH {
            break;
        }
        for ((scene, method, control), best) in runs.into_iter().zip(&mut best) {
            let run = Simulation::new(scene.clone(), method, control);
            let mut run = run.map_err(Failure::run)?;
            let begun = processor::time();
            let end = accuracy::run(&mut run, frames, go_on, None);
            let elapsed = processor::time().saturating_sub(begun);
            if end.map_err(Failure::run)?.is_none() {
                return Ok(None);
            }
            *best = elapsed.min(*best);
            sum += elapsed;
        }
    }
    Ok(Some(best))
}
