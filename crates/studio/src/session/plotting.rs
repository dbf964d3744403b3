//! What is plotted of all panes.

use std::f64::consts::TAU;

use a3_core::{Path, Simulation};
use a3_media::show::Target;

use super::pane::Pane;
use super::traces::{MAX_PICKS, Mode, Pick, PlotRequest, PlotSettings, Trigger, Variable};

/// Largest number of things that are plotted without being picked.
const FEW: usize = 3;

/// Plots something of all panes, or no longer. Returns why that is impossible, if it is.
pub fn toggle(panes: &mut [Pane], pick: Pick) -> Result<(), String> {
    let traces = &panes[0].traces;
    if !traces.has(pick) && traces.len() >= MAX_PICKS {
        return Err(format!(
            "{MAX_PICKS} things are plotted already: leave one out."
        ));
    }
    for pane in panes {
        pane.traces.toggle(pick, &pane.simulation);
    }
    Ok(())
}

/// Plots the highlighted particle, or the one whose springs are listed, or all that move if they
/// are few, if nothing is plotted yet.
pub fn pick_first(panes: &mut [Pane]) {
    let first = &panes[0];
    if !first.traces.is_empty() {
        return;
    }
    let mut hovered = panes.iter().filter_map(|pane| pane.show.hovered);
    let hovered = hovered.find_map(Target::particle);
    let run = &first.simulation;
    let listed = hovered.or(first.show.springs_of);
    let picks = listed.map_or_else(|| few(run), |i| vec![Pick::at(run, i)]);
    for pick in picks {
        for pane in &mut *panes {
            pane.traces.toggle(pick, &pane.simulation);
        }
    }
}

/// Returns the particles and bodies that move, if they are few.
fn few(run: &Simulation) -> Vec<Pick> {
    let network = run.model().network();
    let is_free = |i: &usize| network.is_none_or(|network| !network.is_pinned(*i));
    let mut picks: Vec<_> = (0..run.particles())
        .filter(is_free)
        .map(|i| Pick::at(run, i))
        .collect();
    picks.dedup();
    if picks.len() > FEW {
        picks.clear();
    }
    picks
}

/// Returns the period (s) of the motion that drives a run: that of the first pin or obstacle which
/// oscillates.
pub fn drive(run: &Simulation) -> Option<f64> {
    let network = run.model().network()?;
    let pins = network.pins().map(|(_, path)| path);
    let obstacles = network.obstacles().iter().map(|obstacle| obstacle.path);
    let rates = pins.chain(obstacles).filter_map(|path| match path {
        Path::Sine { rate, .. } if rate != 0.0 => Some(rate.abs()),
        _ => None,
    });
    rates.map(|rate| TAU / rate).next()
}

/// Returns the trigger with which a section of a run begins: the phase of its drive, or else the
/// lower turning point of another coordinate than that across.
pub fn first_trigger(run: &Simulation, across: Variable) -> Trigger {
    let other = if across == Variable::Y {
        Variable::VelocityX
    } else {
        Variable::VelocityY
    };
    drive(run).map_or(Trigger::Rises(other, 0.0), Trigger::Period)
}

/// Takes the points of sections of all panes at other events.
pub fn set_trigger(panes: &mut [Pane], trigger: Trigger) {
    for pane in panes {
        pane.traces.set_trigger(trigger);
    }
}

/// Sets the trigger of a section that is shown for the first time.
pub fn begin_section(panes: &mut [Pane], mode: Mode, across: Variable) {
    if mode == Mode::Section && panes[0].traces.trigger() == Trigger::Off {
        let trigger = first_trigger(&panes[0].simulation, across);
        set_trigger(panes, trigger);
    }
}

/// Carries out a request, and returns what is to be said.
pub fn apply(
    settings: &mut PlotSettings,
    panes: &mut [Pane],
    request: PlotRequest,
) -> Option<String> {
    match request {
        PlotRequest::Toggle(pick) => return toggle(panes, pick).err(),
        PlotRequest::Mode(mode) => {
            settings.mode = mode;
            begin_section(panes, mode, settings.axes[0]);
        }
        PlotRequest::Show(variable) => {
            let before = settings.shown.len();
            settings.shown.retain(|it| *it != variable);
            if settings.shown.len() == before {
                settings.shown.push(variable);
            }
        }
        PlotRequest::Axis(axis, variable) => {
            // The velocity goes with its coordinate.
            let [across, up] = &mut settings.axes;
            if axis == 0 && *up == across.velocity() && variable.is_coordinate() {
                *up = variable.velocity();
            }
            settings.axes[axis] = variable;
        }
        PlotRequest::Trigger(trigger) => set_trigger(panes, trigger),
        PlotRequest::Span(span) => settings.span = span,
        PlotRequest::Clear => panes.iter_mut().for_each(|pane| pane.traces.forget()),
        PlotRequest::Ruler if settings.ruler.take().is_none() => {
            settings.ruler = Some(vec![]);
            return Some("Drag from one point to another, or click on both.".into());
        }
        PlotRequest::Ruler => {}
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{Row, RunAction, Session, compared, frames, session};

    /// Returns the values of the first pick in the first pane.
    fn rows(session: &Session) -> Vec<Row> {
        let (_, series) = &session.runs.panes[0].traces.iter().as_slice()[0];
        series.rows().copied().collect()
    }

    /// Returns the points of its section.
    fn section(session: &Session) -> Vec<Row> {
        let (_, series) = &session.runs.panes[0].traces.iter().as_slice()[0];
        series.section().copied().collect()
    }

    /// Returns the energy (J) of all particles and bodies that move, each by its pick, and that of
    /// the network without its pins.
    fn energies(run: &Simulation) -> [f64; 2] {
        let network = run.model().network().unwrap();
        let mut picks: Vec<_> = (0..run.particles())
            .filter(|i| !network.is_pinned(*i))
            .map(|i| Pick::at(run, i))
            .collect();
        picks.dedup();
        let own = picks
            .into_iter()
            .map(|it| Variable::Energy.of(&it.read(run)));
        let energy = run.energy().unwrap();
        let pins = network.pins().map(|(i, _)| {
            let row = Pick::Particle(i).read(run);
            let gravity = network.gravity().unwrap_or_default();
            row.values[6] - network.masses()[i] * gravity.dot(&run.position(i))
        });
        // Springs between pins belong to no particle that moves.
        let between = network
            .springs()
            .filter(|s| network.is_pinned(s.i) && network.is_pinned(s.j));
        let between = between.map(|s| {
            let length = (run.position(s.i) - run.position(s.j)).norm();
            0.5 * s.law.stiffness * (length - s.law.rest_length).powi(2)
        });
        let all = energy.kinetic + energy.elastic + energy.gravitational;
        [own.sum(), all - pins.sum::<f64>() - between.sum::<f64>()]
    }

    #[test]
    fn the_energies_of_all_add_up_to_that_of_the_scene() {
        let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/");
        let own = |name: &str| format!("{docs}{name}.toml");
        for (scene, time) in [
            ("cloth".to_owned(), 0.5),
            ("pendulum".into(), 1.3),
            ("boxes".into(), 0.4),
            ("t-handle".into(), 2.0),
            (own("strip"), 2.0),
        ] {
            let mut session = session(&["--scene", &scene]);
            session.run_to(time);
            let [sum, all] = energies(session.runs.first());
            assert!(
                (sum - all).abs() < 1e-9 * all.abs().max(1.0),
                "{scene}: {sum} {all}"
            );
        }
    }

    #[test]
    fn a_spring_has_its_length_its_strain_and_its_force() {
        let mut session = session(&["r", "0.01", "--scene", "pendulum"]);
        session.run_to(0.7);
        let run = session.runs.first();
        let length = run.position(1).norm();
        let values = Pick::Spring(1, 0).read(run).values;
        assert!((values[0] - length).abs() < 1e-15 && length > 1.1);
        assert!((values[1] - (length - 1.0)).abs() < 1e-14);
        assert!((values[2] - 50.0 * (length - 1.0)).abs() < 1e-12);
        assert!(Pick::Spring(0, 7).read(run).values[0].is_nan());
        let handle = crate::session::session(&["--scene", "t-handle"]);
        let run = handle.runs.first();
        let body = &run.model().network().unwrap().bodies()[0];
        let rotation = run.model().network().unwrap().rotation(0, run.state());
        let spin = &Pick::Body(0).read(run).values[8..];
        let spin = a3_core::Vector3::from_column_slice(spin);
        assert!((body.momentum(rotation.q, spin) - rotation.momentum).norm() < 1e-12);
    }

    /// Compares sections of the swung pendulum with those of a Runge-Kutta integration by `NumPy`,
    /// of x'' = (50 (1/L - 1) d - 0.1 x') + g, d = x - (0.3 sin 2t, 0, 0), L = |d|.
    #[test]
    fn sections_of_a_driven_pendulum_are_those_of_another_program() {
        let mut session = session(&["r", "0.002", "--scene", "pendulum"]);
        session.act(RunAction::Swing, 0);
        toggle(&mut session.runs.panes, Pick::Particle(1)).unwrap();
        let trigger = first_trigger(session.runs.first(), Variable::X);
        assert_eq!(trigger, Trigger::Period(TAU / 2.0));
        set_trigger(&mut session.runs.panes, trigger);
        frames(&mut session, 19.0);
        let found: Vec<_> = section(&session);
        let right = [
            [0.586_026_463, -1.785_234_427],
            [-0.930_796_730, 1.067_619_366],
            [-0.874_315_235, 1.891_994_277],
            [0.016_812_855, 3.183_751_494],
            [0.745_398_204, 1.232_400_060],
            [-0.349_664_570, -0.468_966_506],
        ];
        assert_eq!(found.len(), right.len());
        for (point, [x, v]) in found.iter().zip(right) {
            let errors = [point.values[0] - x, point.values[3] - v];
            assert!(errors.iter().all(|e| e.abs() < 2e-5), "{errors:?}");
        }
        set_trigger(
            &mut session.runs.panes,
            Trigger::Rises(Variable::VelocityY, 0.0),
        );
        let found: Vec<_> = section(&session);
        let right = [
            [0.716_664_255, 0.622_655_379, -3.231_291_521],
            [2.108_170_968, -0.255_654_430, 2.149_240_307],
            [3.321_737_241, 0.182_262_198, -2.495_239_098],
            [4.537_292_377, 0.183_184_277, 1.480_711_141],
            [5.696_194_500, -0.170_622_240, -2.739_683_605],
            [7.005_505_121, 0.301_682_846, 2.523_472_178],
        ];
        for (point, [t, x, v]) in found.iter().zip(right) {
            let errors = [point.time - t, point.values[0] - x, point.values[3] - v];
            assert!(errors.iter().all(|e| e.abs() < 2e-5), "{errors:?}");
        }
    }

    /// The phase plane of a small swing of a rod is the ellipse (x / a)2 + (v / (w a))2 = 1, but
    /// for terms of the order of a2, with w2 = g / l.
    #[test]
    fn the_phase_plane_of_a_small_swing_is_an_ellipse() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("swing.toml");
        let text = "gravity = [0, -9.81, 0]\n[[chain]]\nparticles = 2\nfrom = [0, 0, 0]\n\
            to = [0.01, -0.99995, 0]\nmass = 1\nrigid = true\npin = [{ at = [\"first\"] }]\n";
        std::fs::write(&file, text).unwrap();
        let mut session = session(&["r", "0.005", "--scene", file.to_str().unwrap()]);
        pick_first(&mut session.runs.panes);
        frames(&mut session, 4.0);
        let rows: Vec<_> = rows(&session);
        assert!(rows.len() > 700);
        let (a, w) = (0.01, 9.81_f64.sqrt());
        for row in &rows {
            let [x, v] = [row.values[0] / a, row.values[3] / (w * a)];
            assert!((x * x + v * v - 1.0).abs() < 1e-4, "{row:?}");
        }
        // It went round twice in 4 s.
        let lefts = rows
            .windows(2)
            .filter(|pair| pair[0].values[0] < 0.0 && pair[1].values[0] >= 0.0);
        assert_eq!(lefts.count(), 2);
    }

    #[test]
    fn going_back_and_resets_leave_no_line_through_the_jump() {
        let mut session = compared(&["r:0.01", "v:0.01", "--scene", "pendulum"], 0.0);
        session.readings.in_window = true;
        pick_first(&mut session.runs.panes);
        frames(&mut session, 2.0);
        let largest_jump = |session: &Session| {
            let jumps = session.runs.panes.iter().flat_map(|pane| {
                let [(_, series)] = pane.traces.iter().as_slice() else {
                    panic!("one pick");
                };
                let rows: Vec<_> = series.rows().collect();
                let times = rows.windows(2).map(|pair| pair[1].time - pair[0].time);
                times.collect::<Vec<_>>()
            });
            jumps.fold(0.0, f64::max)
        };
        assert!(largest_jump(&session) < 0.0101);
        session.act(RunAction::Scrub(-60), 0);
        // What comes later stays until the run goes on.
        let last = |session: &Session| rows(session).last().unwrap().time;
        assert!(last(&session) > 1.9);
        session.act(RunAction::Pause, 0);
        frames(&mut session, 0.1);
        assert!((last(&session) - session.runs.first().time()).abs() < 1e-9);
        assert!(last(&session) < 1.3 && largest_jump(&session) < 0.0101);
        session.act(RunAction::Reset, 0);
        assert_eq!(rows(&session).len(), 0);
        frames(&mut session, 0.5);
        assert!(largest_jump(&session) < 0.0101 && rows(&session).len() > 40);
        session.act(RunAction::NextScene, 0);
        assert!(session.runs.panes[0].traces.is_empty());
    }

    #[test]
    fn what_is_plotted_is_in_every_pane_and_changes_no_bit() {
        let mut plotted = compared(&["e:0.0005", "a", "--scene", "cloth"], 0.0);
        let mut other = compared(&["e:0.0005", "a", "--scene", "cloth"], 0.0);
        for i in 0..MAX_PICKS {
            toggle(&mut plotted.runs.panes, Pick::Particle(200 + i)).unwrap();
        }
        assert!(toggle(&mut plotted.runs.panes, Pick::Particle(0)).is_err());
        for session in [&mut plotted, &mut other] {
            frames(session, 0.2);
        }
        for (with, without) in plotted.runs.panes.iter().zip(&other.runs.panes) {
            assert_eq!(with.simulation.state(), without.simulation.state());
            assert_eq!(with.traces.iter().len(), MAX_PICKS);
            for (pick, series) in with.traces.iter() {
                assert!(series.rows().len() > 40);
                let last = series.nearest(1e9).unwrap();
                assert_eq!(last.time, with.simulation.time());
                assert_eq!(last.values[..8], pick.read(&with.simulation).values[..8]);
            }
        }
        toggle(&mut plotted.runs.panes, Pick::Particle(200)).unwrap();
        assert_eq!(plotted.runs.panes[1].traces.iter().len(), MAX_PICKS - 1);
    }
}
