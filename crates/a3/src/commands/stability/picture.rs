//! The stability regions that explain the limits.

use a3_core::integrators::bdf_growth;
use a3_core::stability::{GROWTH, Growth, Mode, tenfold_time};
use a3_plot::{CurveStyle, Region, StabilityRegions};

use super::limits::MethodLimits;
use super::table::{INTERVAL, is_interval, observation, step};
use crate::commands::chart::style;

/// Creates the chart of stability regions, with the eigenvalues of the modes times the step h (s).
pub fn chart(title: String, rows: &[MethodLimits], modes: &[Mode], h: f64) -> StabilityRegions {
    let methods: Vec<_> = rows.iter().map(|row| row.method).collect();
    let styles = style::each(&methods);
    StabilityRegions {
        title,
        subtitle: format!(
            "Where the eigenvalues of the scene as it starts, times a step of {}\u{a0}ms, lie in each solver's stable region",
            step(h)
        ),
        note: if rows
            .iter()
            .filter_map(|row| row.bounded)
            .any(|seen| is_interval(&seen))
        {
            format!("a\u{2013}b\u{a0}{INTERVAL}")
        } else {
            String::new()
        },
        regions: (rows.iter().zip(styles))
            .map(|(row, style)| region(row, style, modes, h))
            .collect(),
    }
}

/// Creates the stability region of a method.
fn region(row: &MethodLimits, style: CurveStyle, modes: &[Mode], h: f64) -> Region {
    let method = row.method;
    let is_bdf = method.name == "bdf";
    let subtitle = format!(
        "{}bounded {}\u{a0}ms, accurate {}\u{a0}ms",
        if is_bdf {
            "region of all orders; fixed steps: "
        } else {
            ""
        },
        observation(row.bounded),
        row.accurate.map_or("-".into(), step)
    );
    // The growth of a Runge-Kutta step depends on the eigenvalues only. That of a splitting method
    // also depends on how the damping is divided between drag and springs, which is taken from the
    // fastest mode.
    let share = modes
        .first()
        .map_or(0.0, |m| m.damping / (m.drag + m.damping).max(1e-300));
    let reads_velocity = modes.first().is_some_and(|m| m.reads_velocity);
    let radius = move |re: f64, im: f64| {
        // The fixed steps of BDF are those of TR-BDF2, but the chart shows its adaptive formulas.
        if is_bdf {
            return bdf_growth(re, im);
        }
        let mode = Mode::of_eigenvalue(re, im);
        let mode = Mode {
            drag: (1.0 - share) * mode.drag,
            damping: share * mode.drag,
            reads_velocity,
            ..mode
        };
        Growth::new(method, mode).map_or(f64::INFINITY, |mut growth| growth.of_step(1.0))
    };
    Region {
        style,
        title: method.title.to_owned(),
        subtitle,
        radius: Box::new(radius),
        slow: GROWTH.powf(h / tenfold_time(h)),
        eigenvalues: modes
            .iter()
            .filter(|mode| mode.returns())
            .flat_map(Mode::eigenvalues)
            .map(|[re, im]| [h * re, h * im])
            .collect(),
    }
}
