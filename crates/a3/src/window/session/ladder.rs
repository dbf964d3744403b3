//! The steps and tolerances that the keys + and - choose.

/// Steps (s) and tolerances, over the power of ten below them.
const LADDER: [f64; 10] = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0];

/// Returns the next larger or smaller step or tolerance of the ladder.
pub fn next_step(step: f64, longer: bool) -> f64 {
    let decade = step.log10().floor() as i32;
    let rungs = (decade - 1..=decade + 1).flat_map(|d| {
        // Dividing by 10^n rounds correctly; multiplying by 10^-n, which is not exact, does not.
        LADDER.iter().map(move |rung| {
            if d < 0 {
                rung / 10f64.powi(-d)
            } else {
                rung * 10f64.powi(d)
            }
        })
    });
    let next = if longer {
        rungs
            .filter(|rung| *rung > step * (1.0 + 1e-9))
            .reduce(f64::min)
    } else {
        rungs
            .filter(|rung| *rung < step * (1.0 - 1e-9))
            .reduce(f64::max)
    };
    next.unwrap_or(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::bounds::{LARGEST_STEP, SMALLEST_STEP};
    use crate::window::session::{RunAction, session};

    #[test]
    fn steps_climb_the_ladder() {
        assert_eq!(next_step(0.01, true), 0.012);
        assert_eq!(next_step(0.01, false), 0.008);
        assert_eq!(next_step(0.008, true), 0.01);
        assert_eq!(next_step(0.0123, false), 0.012);
        assert_eq!(next_step(8.0, true), 10.0);
        let ends = |solver, end: f64, longer| {
            let mut session = session(&[solver, &end.to_string(), "--scene", "chain"]);
            let action = if longer {
                RunAction::LongerStep
            } else {
                RunAction::ShorterStep
            };
            session.act(action, 0);
            session.runs.first().control().value() == end
        };
        assert!(ends("r", LARGEST_STEP, true) && ends("r", SMALLEST_STEP, false));
        assert!(ends("a", 1.0, true) && ends("a", 1e-13, false));
    }
}
