//! States that errors are taken from: the ends of steps that are longer than the fastest motion,
//! and a reference that is known until an impact.

use crate::common::{described, errors, method, reference};
use a3_core::{Control, Simulation};

/// The fastest motion takes a hundredth of a step. The method determines only the ends of steps: no
/// polynomial knows the motion between them.
#[test]
fn errors_are_those_at_the_ends_of_steps() {
    let stiff = described(
        "gravity = [0, -9.81, 0]\ndrag = 0.05\n[[chain]]\nparticles = 5\nfrom = [0, 0, 0]\n\
         to = [1.2, 0, 0]\nmass = 0.1\nstiffness = 1e6\npin = [{ at = [\"first\"] }]\n",
    );
    let reference = reference(&stiff, 1.0);
    for (name, h) in [("implicit-midpoint", 1.0 / 100.0), ("tr-bdf2", 1.0 / 20.0)] {
        let control = Control::Step(h);
        let found = errors(&stiff, name, control, &reference).position;
        let mut run = Simulation::new(stiff.clone(), method(name), control).unwrap();
        let accurate = Control::Tolerance(1e-10);
        let mut exact = Simulation::new(stiff.clone(), method("dop853"), accurate).unwrap();
        let mut worst: f64 = 0.0;
        while run.time() < 1.0 - 0.5 * h {
            run.take_steps(1).unwrap();
            exact.advance_to(run.time()).unwrap();
            let squared = (0..5).map(|i| (run.position(i) - exact.position(i)).norm_squared());
            worst = worst.max((squared.sum::<f64>() / 5.0).sqrt());
        }
        assert!((found / worst - 1.0).abs() < 0.01, "{name}: {found} {worst}");
    }
}

/// All motion is over at the end of the first step, where its error is small; but the motion
/// meanwhile is unknown.
#[test]
fn steps_that_skip_the_motion_are_not_accurate() {
    let damped = described(
        "gravity = [0, -9.81, 0]\ndrag = 2\n[[chain]]\nparticles = 4\nfrom = [0, 0, 0]\n\
         to = [0.9, 0, 0]\nmass = 0.1\nstiffness = 100\npin = [{ at = [\"first\"] }]\n",
    );
    let reference = reference(&damped, 20.0);
    let error = |h: f64| errors(&damped, "tr-bdf2", Control::Step(h), &reference).position;
    assert!(error(10.0) > 0.05 * reference.still.position);
    assert!(error(0.05) < 0.01 * reference.still.position);
}

/// A jelly with a rod in it falls 0.1 m onto a round obstacle, on which it then rests by impulses
/// after each step.
#[test]
fn a_reference_says_until_when_it_is_clear() {
    let fall = described(
        "gravity = [0, -9.81, 0]\n[[sphere]]\ncenter = [0, -2, 0]\nradius = 2\n[[jelly]]\ngrid = [4, 4, 4]\nsize = [0.3, 0.3, 0.3]\n\
         at = [0, 0.25, 0]\nmass = 0.01\nstiffness = [40, 20, 10]\n\
         [[constraint]]\nrod = [0, 1]\n",
    );
    let reference = reference(&fall, 0.3);
    let (until, known) = reference.clear_until().unwrap();
    let impact = f64::sqrt(2.0 * 0.1 / 9.81);
    assert!((until - impact).abs() < 1.0 / 60.0, "{until} {impact}");
    assert!(known < 1e-9 && reference.floor.position > 1e-8, "{known} {:?}", reference.floor);
}
