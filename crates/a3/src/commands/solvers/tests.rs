//! The table says what solvers do, and the manual has it.

use a3_core::{Control, Simulation, integrators};

use super::all;
use super::table::{kinds, table};

/// Every solver takes a step on the kinds that it serves, and begins no run on the others.
#[test]
fn solvers_do_what_the_table_says() {
    for kind in kinds() {
        let scene = kind.scene().unwrap();
        for method in integrators::METHODS {
            let refused = method.refusal(scene.model.system());
            let control = Control::Step(1e-3);
            let control = if method.is_adaptive() { Control::Tolerance(1e-3) } else { control };
            let run = Simulation::new(scene.clone(), method, control);
            let run = run.and_then(|mut run| run.advance_to(2e-3));
            assert_eq!(run.is_ok(), refused.is_none(), "{} on {}", method.name, kind.0);
        }
    }
}

/// `docs/methods.md` has the table as `a3 solvers --kinds` prints it.
#[test]
fn the_manual_has_the_table() {
    let manual = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/methods.md");
    let text = std::fs::read_to_string(manual).unwrap();
    let table = table().unwrap();
    assert!(text.contains(&table), "put this into docs/methods.md:\n{table}");
}

/// A solver that changes its order is listed with all its orders, as in the manual.
#[test]
fn orders_that_change_are_listed() {
    let list = all();
    let line = list.lines().find(|line| line.contains(" bdf ")).unwrap();
    assert!(line.contains(" 1 to 5 "), "{line}");
    let line = list.lines().find(|line| line.contains(" rk4 ")).unwrap();
    assert!(line.contains(" 4 ") && !line.contains(" to "), "{line}");
}
