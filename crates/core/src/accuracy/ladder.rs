//! Steps or tolerances at which a method is tried, from the coarsest that makes sense.

use super::Frames;
use crate::control::Control;
use crate::error::Error;
use crate::integrators::Method;
use crate::scene::Scene;
use crate::stability::{largest_step, spectrum};

/// Ratio of a step to the next shorter one, at least, as far as whole numbers allow.
const RUNG: f64 = 1.5;
/// Longest step over the method's stability limit: one or two steps past the limit show where it
/// is.
const PAST: f64 = 1.4;
/// Exponents of the largest and the smallest tolerance of adaptive methods, in half powers of ten:
/// from 10^-1 to 10^-12, and to 10^-8 for implicit methods, whose orders are low.
const TOLERANCES: (i32, [i32; 2]) = (-2, [-24, -16]);

/// Steps that fit the frames, from just past the method's stability limit down, or, for an adaptive
/// method, tolerances from 0.1 down.
///
/// The coarsest comes first. The list of steps ends where a run would take more than `most` steps.
///
/// # Errors
/// The method does not support the scene.
pub fn ladder(
    scene: &Scene,
    method: &'static Method,
    frames: &Frames,
    most: u64,
) -> Result<Vec<Control>, Error> {
    let system = scene.model.system();
    method.check(system)?;
    if method.is_adaptive() {
        let least = TOLERANCES.1[usize::from(method.implicit)];
        return Ok((least..=TOLERANCES.0)
            .rev()
            .map(|half| {
                let digits = if half % 2 == 0 { 1.0 } else { 3.0 };
                let power = (f64::from(half) / 2.0).floor() as i32;
                Control::Tolerance(digits / 10f64.powi(-power))
            })
            .collect());
    }
    let modes = spectrum(system, 0.0, &scene.state);
    let limit = largest_step(method, &modes)?.map_or(f64::INFINITY, |limit| limit.step);
    let longest = (PAST * limit).min(frames.until / 6.0);
    let mut steps = vec![];
    // Steps of several frames, where they divide the number of frames.
    let spacing = frames.spacing();
    let mut last = f64::INFINITY;
    for stride in (2..=frames.count).rev() {
        let h = stride as f64 * spacing;
        if frames.count.is_multiple_of(stride) && h <= longest && h <= last / RUNG {
            steps.push(Control::Step(h));
            last = h;
        }
    }
    // Several steps in each frame.
    let mut parts = (spacing / longest).ceil().max(1.0) as u64;
    while parts * frames.count <= most {
        steps.push(Control::Step(spacing / parts as f64));
        parts = ((parts as f64 * RUNG) as u64).max(parts + 1);
    }
    Ok(steps)
}
