//! The readings of a run in words, and the text about one that blew up.

use a3_core::{BlowUp, Cause, Control, Simulation, StepLength};
use a3_files::holding::MIN_HOLD_TIME;
use egui::{RichText, Sense, Ui, vec2};

use super::style::{ALARM, Mark, SAFE, WARNING, faint, text};
use crate::session::{FilmProgress, Pane, Rates, Readings};

/// A day (s).
const DAY: f64 = 86_400.0;

/// Formats a number that is not negative with three significant digits; without a fraction from 100
/// on.
pub fn digits(number: f64) -> String {
    match number {
        0.0 => "0".into(),
        small if small < 1e-3 => format!("{small:.2e}"),
        large if large >= 100.0 => format!("{large:.0}"),
        middling => {
            let places = (2.0 - middling.log10().floor()).clamp(0.0, 5.0) as usize;
            format!("{middling:.places$}")
        }
    }
}

/// Formats any number as [`digits`] does.
pub fn signed(number: f64) -> String {
    let sign = if number < 0.0 { "-" } else { "" };
    format!("{sign}{}", digits(number.abs()))
}

/// Returns the scene's name, and its grid if it has one.
pub fn scene(simulation: &Simulation) -> String {
    let scene = simulation.scene();
    let grid =
        scene.grid().map_or(String::new(), |grid| format!("  {} × {}", grid.rows(), grid.cols()));
    format!("{}{grid}", scene.name)
}

/// Returns the method, and its step or tolerance.
pub fn method(simulation: &Simulation) -> String {
    format!("{},  {}", simulation.method().title, simulation.control())
}

/// Returns the present step of an adaptive method, and the number of rejected ones.
pub fn steps(simulation: &Simulation) -> Option<String> {
    let step = simulation.step_size()?;
    let rejections = simulation.work().rejections;
    let words = |_| format!("{} ms, {rejections} rejected", digits(1e3 * step));
    simulation.control().tolerance().map(words)
}

/// Returns the largest stable step, and the present step as a share of it. The mark is safe up to
/// 80 %, a warning near the limit and where motion grows slowly, and an alarm where it grows fast.
pub fn limit(pane: &Pane) -> Option<(String, Mark)> {
    let limit = pane.limit.limit?;
    // With constraints or rigid bodies, modes show only which steps are too long, not which are
    // stable.
    let network = pane.simulation.model().network();
    let modes_tell_all =
        network.is_none_or(|n| n.constraints().is_empty() && n.bodies().is_empty());
    if limit.step.is_infinite() {
        return modes_tell_all.then(|| ("none: every step is stable".into(), SAFE));
    }
    let step = pane.simulation.step_size()?;
    let mark = match step {
        fast if fast > limit.step => ALARM,
        near if near > 0.8 * limit.bounded => WARNING,
        _ if modes_tell_all => SAFE,
        _ => return None,
    };
    let largest = if limit.is_sharp() { limit.step } else { limit.bounded };
    let share = |largest: f64| {
        let percent = 100.0 * step / largest;
        format!("{} ms (step at {percent:.0} %)", digits(1e3 * largest))
    };
    let time = pane.limit.tenfold_time(pane.simulation.method(), step);
    let tenfold = match time.filter(|time| *time < DAY) {
        Some(time) => format!("tenfold in {} s", digits(time)),
        None => "too slowly to see".into(),
    };
    let words = if largest == 0.0 {
        format!("every step makes motion grow; this one, {tenfold}")
    } else if step > largest {
        format!("{}; motion grows {tenfold}", share(largest))
    } else {
        share(largest)
    };
    Some((words, mark))
}

/// Writes the largest stable step, or that none is known.
pub fn limit_row(pane: &Pane) -> RichText {
    if let Some((words, mark)) = limit(pane) {
        return mark.text(&words);
    }
    let most = pane.limit.limit.map(|limit| limit.step);
    let most = most.filter(|most| most.is_finite());
    text(most.map_or("none is known".into(), |most| format!("at most {} ms", digits(1e3 * most))))
}

/// Returns the work of the collision safeguard since the start, if there was any: its impulses, the
/// number of motions that it truncated, and the momentum that this removed.
pub fn contact(simulation: &Simulation) -> Option<String> {
    let guarded = simulation.guarded();
    let count = |n: usize, what: &str| match n {
        1 => format!("1 {what}"),
        n => format!("{n} {what}s"),
    };
    let impulses = count(guarded.impulses, "impulse");
    let cuts = count(guarded.cuts, "cut");
    match (guarded.impulses, guarded.cuts) {
        (0, 0) => None,
        (_, 0) => Some(impulses),
        _ => Some(format!("{impulses}, {cuts} ({} N s lost)", digits(guarded.lost))),
    }
}

/// Returns the parts that are left out: their names, or, if they are many, how many.
pub fn without(readings: &Readings) -> Option<String> {
    match &readings.left_out[..] {
        [] => None,
        few if few.len() <= 3 => Some(format!("without {}", few.join(", "))),
        many => Some(format!("without {} parts", many.len())),
    }
}

/// Returns the simulated time, with enough digits to tell consecutive steps apart.
pub fn time(simulation: &Simulation) -> String {
    let step = simulation.control().step().unwrap_or(1e-3);
    let digits = (-step.log10()).ceil().clamp(2.0, 7.0) as usize;
    format!("{:.digits$} s", simulation.time())
}

/// Returns the name and value of the reading that shows best whether the run is accurate: the
/// energy, with its change if the forces conserve it, or else the radius of the circle.
pub fn energy(pane: &Pane) -> (&'static str, String) {
    match pane.energy {
        Some(energy) => {
            let change = pane.simulation.energy_change().unwrap_or_default();
            let percent = format!("{:+.2}", 100.0 * change);
            let is_kept = percent.trim_start_matches(['+', '-']) == "0.00";
            let said = if is_kept { String::new() } else { format!(" ({percent} %)") };
            ("energy", format!("{energy:.3} J{said}"))
        }
        None => ("radius", format!("{:.6} m", pane.simulation.position(0).norm())),
    }
}

/// Returns the spurious gain of energy, if it is large.
pub fn gained(simulation: &Simulation) -> Option<RichText> {
    let gain = simulation.gained()?;
    let words = format!("{} J from nowhere: shorten the step", digits(gain.energy));
    Some(WARNING.text(&words))
}

/// Returns the largest violation of a constraint so far, if it is visible.
pub fn worst_constraint(simulation: &Simulation) -> Option<RichText> {
    let unmet = simulation.worst_constraint()?;
    let words = format!("{} was off by {:.1} %", unmet.constraint, 100.0 * unmet.share);
    unmet.is_visible().then(|| WARNING.text(&words))
}

/// Returns the frame rate and the time per frame, while frames are measured.
pub fn frames(readings: &Readings) -> Option<[String; 2]> {
    let Rates { rate, simulating, drawing, .. } = readings.rates;
    let each = || format!("{simulating:.1} ms steps + {drawing:.1} ms drawing");
    (!readings.paused && rate > 0.0).then(|| [format!("{rate:.0} per second"), each()])
}

/// Draws the progress of a film, after a red dot.
pub fn film(ui: &mut Ui, film: &FilmProgress) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
        ui.painter().circle_filled(rect.center(), 4.5, ALARM.colour);
        ui.label(text(&film.said));
    });
}

/// Returns the states that are on: paused, wind, swing, pulling. If none is, it returns those of
/// wind and swing that the scene has; `None` if it has neither.
pub fn states(simulation: &Simulation, readings: &Readings) -> Option<RichText> {
    let states = [
        (readings.paused, "paused"),
        (simulation.windy(), "wind"),
        (simulation.swinging(), "swing"),
        (simulation.grabbed().is_some() || simulation.grabbed_obstacle().is_some(), "pulling"),
    ];
    let on = states.iter().filter(|(on, _)| *on);
    let on: Vec<_> = on.map(|(_, name)| *name).collect();
    if !on.is_empty() {
        return Some(text(on.join("   ")).strong());
    }
    let scene = simulation.scene();
    let off = [scene.wind.map(|_| "no wind"), scene.swing.map(|_| "no swing")];
    let off: Vec<_> = off.into_iter().flatten().collect();
    (!off.is_empty()).then(|| faint(off.join(", ")))
}

/// Returns simulated time over real time, once it was measured.
pub fn speed(readings: &Readings) -> Option<String> {
    match readings.rates.factor {
        _ if readings.paused => Some("paused".into()),
        0.0 => None,
        slow if slow < 0.01 => Some(format!("{slow:.1e} × real time")),
        factor => Some(format!("{factor:.2} × real time")),
    }
}

/// Returns the chosen slow motion, if it is on.
pub fn slow_motion(readings: &Readings) -> Option<String> {
    let slowness = Some(readings.slowness).filter(|slowness| *slowness > 0)?;
    Some(format!("1/{} of real time", 1 << slowness))
}

/// Writes when the run blew up, which limit the step exceeded, and which step would have been
/// stable.
pub fn explain(ui: &mut Ui, pane: &Pane, blow_up: &BlowUp) {
    ui.label(ALARM.text(&format!("It {blow_up}.")).size(14.5).strong());
    let shown = time(&pane.simulation);
    ui.label(text(format!("The picture shows the time {shown}.")));
    let method = blow_up.method;
    let same = method == pane.simulation.method().title;
    let limit = pane.limit.limit.map(|limit| limit.step);
    let sought = pane.limit.sought.filter(|_| same);
    let until = blow_up.time.max(MIN_HOLD_TIME);
    let sought = sought.map_or(String::new(), |sought| sentence(&sought.clause(until)));
    ui.label(text(match blow_up.control {
        _ if blow_up.cause == Cause::ReadsVelocity => {
            format!("{method} cannot integrate forces that depend on velocity.")
        }
        _ if no_step_is_stable(blow_up) => "A shorter step does not help.".into(),
        Control::Tolerance(tolerance) if matches!(blow_up.cause, Cause::StepTooSmall { .. }) => {
            format!("{method} found no step that meets a tolerance of {tolerance:e}.{sought}")
        }
        Control::Tolerance(tolerance) => {
            format!("A tolerance of {tolerance:e} was too large for {method}.{sought}")
        }
        Control::Step(step) => {
            let past = limit
                .filter(|limit| same && step > *limit)
                .map(|limit| format!(": past its limit here of {} ms", digits(1e3 * limit)));
            let past = past.unwrap_or_default();
            let step = StepLength(step);
            format!("A step of {step} was too long for {method}{past}.{sought}")
        }
    }));
}

/// Returns a clause as a sentence that follows another.
fn sentence(clause: &str) -> String {
    let mut letters = clause.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    let all: String = first.into_iter().chain(letters).collect();
    format!(" {all}.")
}

/// Returns whether pins or moving obstacles left no room between surfaces.
fn is_pinched(blow_up: &BlowUp) -> bool {
    matches!(blow_up.cause, Cause::Pinched { .. })
}

/// Returns whether no step would have been stable.
fn no_step_is_stable(blow_up: &BlowUp) -> bool {
    is_pinched(blow_up) || matches!(blow_up.cause, Cause::Contradiction(_))
}

/// Returns advice on the keys to press after a blow-up.
pub fn advice(blow_up: &BlowUp) -> String {
    if is_pinched(blow_up) {
        return "Press , to go back, or x to let surfaces pass through one another, then r.".into();
    }
    "Press , or drag the timeline to see how, - for a shorter step, or a digit for another solver; or r to \
     start again."
        .into()
}

#[cfg(test)]
mod tests {
    use a3_core::{Control, Simulation, integrators};
    use a3_media::show::{Manner, Show};

    use super::*;
    use crate::hud::{pane, read};
    use crate::session::{Pane, Readings, RunAction, session, times};

    #[test]
    fn three_digits() {
        for (number, words) in [
            (0.0, "0"),
            (1.234e-7, "1.23e-7"),
            (0.012_34, "0.0123"),
            (1.234, "1.23"),
            (99.99, "100.0"),
            (12345.6, "12346"),
        ] {
            assert_eq!(digits(number), words);
        }
    }

    #[test]
    fn impulses_of_contact_are_shown_where_there_are_any() {
        let said = |steps| {
            let mut pane = pane("jelly", "t", 0.005);
            pane.simulation.set_touching(true).unwrap();
            pane.simulation.take_steps(steps).unwrap();
            let guarded = pane.simulation.guarded();
            (read(&[pane], &Readings::default(), [1280.0, 720.0]).0, guarded)
        };
        let (words, guarded) = said(20);
        assert!(guarded.impulses == 0 && !words.contains("contact"), "{words}");
        let (words, guarded) = said(200);
        let held = format!("contact\n{} impulses\n", guarded.impulses);
        assert!(guarded.impulses > 1 && words.contains(&held), "{words}");
    }

    #[test]
    fn no_step_is_called_safe_where_modes_do_not_decide() {
        for (method, value) in [("t", 0.1), ("t", 0.3), ("r", 0.005), ("r", 0.05)] {
            let mut pane = pane("double-pendulum", method, value);
            pane.simulation.take_steps(1).unwrap();
            pane.read_state();
            assert!(limit(&pane).is_none_or(|(_, mark)| mark != SAFE));
            let (words, _) = read(&[pane], &Readings::default(), [1280.0, 720.0]);
            assert!(words.contains("limit\n"), "{words}");
        }
    }

    #[test]
    fn the_limit_is_shown_with_its_mark() {
        let said = |scene: &str, method: &str, value: f64| {
            let mut pane = pane(scene, method, value);
            pane.simulation.take_steps(1).unwrap();
            pane.read_state();
            let mark = limit(&pane).unwrap().1;
            let (words, _) = read(&[pane], &Readings::default(), [1280.0, 720.0]);
            (words.replace('\n', " "), mark)
        };
        for (step, mark) in [(0.01, SAFE), (0.032, WARNING), (0.04, ALARM)] {
            let (words, found) = said("mit", "r", step);
            // Within 1 % of 34.9 ms.
            let share = format!("35.2 ms (step at {:.0} %)", step / 0.0352 * 100.0);
            let share = mark.text(&share).text().to_owned();
            assert!(words.contains(&share), "{share} in {words}");
            assert_eq!(found, mark);
        }
        assert!(said("mit", "i", 0.1).0.contains("none: every step is stable"));
        for (step, mark, time) in [(0.01, WARNING, "461"), (0.1, ALARM, "46.3")] {
            let (words, found) = said("simple", "e", step);
            // A step multiplies the radius by (1 + h^2)^1/2.
            let tenfold = step * 10f64.ln() / (0.5 * (1.0 + step * step).ln());
            assert_eq!(digits(tenfold), time);
            let grows = format!("every step makes motion grow; this one, tenfold in {time} s");
            assert!(words.contains(&grows), "{words}");
            assert_eq!(found, mark);
        }
        // With drag, the motion of the cloth grows for steps above 0.37 ms, slowly at first.
        for (step, mark) in [(0.000_2, SAFE), (0.000_4, WARNING), (0.000_6, ALARM)] {
            let (words, found) = said("mit", "e", step);
            assert!(words.contains("0.37"), "{words}");
            assert_eq!(words.contains("; motion grows tenfold in"), mark != SAFE, "{words}");
            assert_eq!(found, mark);
        }
        let (words, _) = said("cloth", "a", 1e-4);
        assert!(words.contains("tolerance 1e-4"), "{words}");
        assert!(words.contains("rejected") && words.contains("limit"), "{words}");
    }

    #[test]
    fn a_blow_up_says_which_limit_was_passed() {
        let mut pane = pane("mit", "r", 0.05);
        while pane.simulation.take_steps(1).is_ok() {}
        pane.read_state();
        let (words, _) = read(&[pane], &Readings::default(), [1280.0, 720.0]);
        let words = words.replace('\n', " ");
        for said in [
            "A step of 0.05 s was too long for classical Runge-Kutta: past its limit here of 3",
            "0.03 s would have held",
            "The picture shows the time",
        ] {
            assert!(words.contains(said), "{said} in {words}");
        }
    }

    #[test]
    fn surfaces_without_room_are_named() {
        let pinched = "self_collision = true\n\
            [[cloth]]\ngrid = [3, 3]\nwidth = 1\nmass = 0.1\nstiffness = [40, 20, 1]\n\
            down = [0, 0, 1]\npin = [{ at = ['top', 'bottom'] }]\n\
            [[sphere]]\ncenter = [0, 1, 0]\nradius = 0.2\nshift = { by = [0, -2, 0], end = 1 }\n";
        let setup = a3_scenes::Description::parse(pinched).unwrap();
        let setup = setup.build(None, &mut |_| unreachable!()).unwrap();
        let method = integrators::find("v").unwrap();
        let simulation = Simulation::new(setup.scene, method, Control::Step(0.001)).unwrap();
        let mut pane = Pane::new(simulation, Show::new(setup.presentation, Manner::default()));
        while pane.simulation.take_steps(1).is_ok() {}
        let (words, _) = read(&[pane], &Readings::default(), [1280.0, 720.0]);
        let words = words.replace('\n', " ");
        for said in [
            "surfaces are pinched: pins or moving obstacles leave no room between obstacle 0 and particle 0",
            "A shorter step does not help. Press , to go back",
        ] {
            assert!(words.contains(said), "{said} in {words}");
        }
        assert!(!words.contains("too long"), "{words}");
    }

    #[test]
    fn a_blow_up_names_what_failed_and_nothing_overlaps() {
        let mut pane = pane("mit", "e", 0.05);
        let run = &mut pane.simulation;
        while run.take_steps(1).is_ok() {}
        run.set_method(integrators::find("r").unwrap(), Control::Step(0.01)).unwrap();
        let panes = [pane];
        let readings =
            Readings { message: Some("There is no wind here.".into()), ..Readings::default() };
        for size in [[1280.0, 720.0], [800.0, 600.0], [500.0, 400.0], [260.0, 860.0]] {
            let (words, sheets) = read(&panes, &readings, size);
            let words = words.replace('\n', " ");
            assert!(words.contains("blew up at step") && words.contains("no wind here"), "{words}");
            assert!(words.contains("A step of 0.05 s was too long for explicit Euler."), "{words}");
            assert!(sheets.len() >= 3);
            for (k, a) in sheets.iter().enumerate() {
                assert!(a.right() <= size[0] + 1.0, "{a:?} in {size:?}");
                assert!(
                    sheets[..k].iter().all(|b| !a.shrink(1.0).intersects(*b)),
                    "{sheets:?} in {size:?}"
                );
            }
        }
    }

    /// Each of the last steps before the blow-up is a moment, up to the last valid state.
    #[test]
    fn a_blow_up_can_be_seen_step_by_step() {
        for (words, step) in
            [(["r", "0.05", "--scene", "mit"], 0.05), (["e", "0.002", "--scene", "mit"], 0.002)]
        {
            let mut session = session(&words);
            session.readings.in_window = true;
            while session.runs.panes[0].alive() {
                session.tick(1.0 / 60.0);
            }
            let end = session.runs.first().blow_up().unwrap().step;
            assert!(session.readings.timeline.unwrap().blew_up);
            let (mut energies, mut steps) = (vec![], vec![]);
            let count = 40.min(end - 1);
            for _ in 0..count {
                session.act(RunAction::Scrub(-1), 0);
                energies.push(session.runs.first().energy().unwrap().total());
                steps.push(session.runs.first().steps());
            }
            // The newest moment is the state before the step that failed.
            let expected: Vec<_> = (0..count).map(|k| end - 2 - k).collect();
            assert_eq!(steps, expected, "{words:?}");
            // The motion grows, and faster and faster, where it does not explode in a few steps.
            let third = energies.len() / 3;
            let [late, middle, early] = [0, third, 2 * third].map(|k| energies[k]);
            assert!(late - middle > middle - early || count < 10, "{energies:?}");
            assert!(session.readings.timeline.unwrap().back < 45.0 * step);
            // It blows up again at the same step.
            session.act(RunAction::Pause, 0);
            while session.runs.panes[0].alive() {
                session.tick(1.0 / 60.0);
            }
            assert_eq!(session.runs.first().blow_up().unwrap().step, end);
        }
    }

    #[test]
    fn in_a_comparison_all_runs_go_back_to_the_steps_before_a_blow_up() {
        let mut session = session(&["compare", "e:0.002", "r:0.01", "--scene", "mit"]);
        session.readings.in_window = true;
        while session.runs.panes[0].alive() {
            session.tick(1.0 / 60.0);
        }
        session.act(RunAction::Scrub(-10), 0);
        let times = times(&session);
        assert!(session.runs.panes[0].alive());
        assert!((times[0] - times[1]).abs() < 0.0101, "{times:?}");
    }
}
