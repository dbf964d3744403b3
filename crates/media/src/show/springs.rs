//! Springs: the look of each kind, and the list of the springs of a particle as text.

use a3_core::{Simulation, Spring, SpringKind, SpringLaw};

use super::colours::{AMBER, TEAL, VIOLET};

/// All kinds, in the order in which they are drawn. In a grid, bend springs lie over structural
/// ones, so the wider lines come first.
pub const KINDS: [SpringKind; 3] = [SpringKind::Bend, SpringKind::Shear, SpringKind::Structural];

/// Width of a spring when all springs are drawn (points).
const WIDTH: f32 = 1.6;

/// Returns whether a scene has springs.
pub fn has_springs(simulation: &Simulation) -> bool {
    let network = simulation.model().network();
    network.is_some_and(|network| network.all_springs().next().is_some())
}

/// Returns the colour of a kind of springs, and its width when all springs are drawn (points).
pub fn kind_look(kind: SpringKind) -> ([f32; 4], f32) {
    match kind {
        SpringKind::Structural => (AMBER, WIDTH),
        SpringKind::Shear => (TEAL, WIDTH),
        SpringKind::Bend => (VIOLET, 2.0 * WIDTH),
    }
}

/// Returns the springs attached to particle i.
pub fn springs_of(simulation: &Simulation, i: usize) -> Vec<Spring> {
    simulation.model().network().into_iter().flat_map(|n| n.springs_of(i)).collect()
}

/// Returns the name of a kind of springs.
pub fn kind_name(kind: SpringKind) -> &'static str {
    match kind {
        SpringKind::Structural => "structural",
        SpringKind::Shear => "shear",
        SpringKind::Bend => "bend",
    }
}

/// Lists the springs attached to particle i as text, each in its own line.
pub fn list_springs_of(simulation: &Simulation, i: usize) -> String {
    let springs = springs_of(simulation, i);
    let line = |s: &Spring| {
        let kind = kind_name(s.kind);
        let SpringLaw { stiffness, rest_length, damping } = s.law;
        let to = s.i + s.j - i;
        format!(
            "  {kind:<10}  to {to:>5}   k = {stiffness:.4} N/m   rest length {rest_length:.4} m   \
             damping {damping:.4} N s/m\n"
        )
    };
    let lines: String = springs.iter().map(line).collect();
    format!("particle {i} has {} springs\n{lines}", springs.len())
}
