//! What is plotted of all panes.

use std::f64::consts::TAU;

use a3_core::{Path, Simulation};
use a3_media::show::Target;

use super::pane::Pane;
use super::traces::{Kind, MAX_PICKS, Mode, Pick, PlotRequest, PlotSettings};
use super::traces::{Quantity, Trigger, Variable};

/// Largest number of things that are plotted without being picked.
const FEW: usize = 3;

/// Returns the kinds of what is plotted.
pub fn kinds(panes: &[Pane]) -> Vec<Kind> {
    let picks = panes[0].traces.iter();
    picks.map(|(pick, _)| pick.kind()).collect()
}

/// Returns a quantity: of each if what it was of is plotted no longer, or lacks its variable.
fn of_plotted(panes: &[Pane], quantity: Quantity) -> Quantity {
    let has = |pick: &Pick| panes[0].traces.has(*pick) && quantity.variable.is_of(pick.kind());
    let of = quantity.of.filter(has);
    Quantity { of, ..quantity }
}

/// Returns the quantities on both axes: the chosen ones or, where no plotted thing has both, others
/// that one has. If no plotted thing has one of the variables, they are those of the phase plane of
/// the thing that was plotted last.
pub fn axes(settings: &PlotSettings, panes: &[Pane]) -> [Quantity; 2] {
    let kinds = kinds(panes);
    let chosen = settings.axes_in(&panes[0].simulation.scene().name);
    let has = |axis: &Quantity| kinds.iter().any(|kind| axis.variable.is_of(*kind));
    let mut axes = match kinds.last() {
        Some(last) if !chosen.iter().all(has) => last.plane().map(Quantity::of_each),
        _ => chosen.map(|it| of_plotted(panes, it)),
    };
    // What lost its owner gets another one first.
    let first = usize::from(axes[0].of == chosen[0].of);
    for k in [first, 1 - first] {
        axes[k] = on_axis(panes, axes[k], axes[1 - k]);
    }
    axes
}

/// Plots something of all panes, or no longer. Returns why that is impossible, if it is.
pub fn toggle(panes: &mut [Pane], pick: Pick) -> Result<(), String> {
    let traces = &panes[0].traces;
    if !traces.has(pick) && traces.len() >= MAX_PICKS {
        return Err(format!("{MAX_PICKS} things are plotted already: leave one out."));
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
    let free = (0..run.particles()).filter(is_free);
    let mut picks: Vec<_> = free.map(|i| Pick::at(run, i)).collect();
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

/// Returns the trigger with which a section begins: the phase of the drive, or else the lower
/// turning point of another coordinate than that across; if nothing that is plotted has its
/// velocity, the second variable of the first thing's phase plane.
fn first_trigger(panes: &[Pane], across: Variable) -> Trigger {
    let other = if across == Variable::Y { Variable::VelocityX } else { Variable::VelocityY };
    let drive = drive(&panes[0].simulation).map(Trigger::Period);
    let trigger = drive.unwrap_or(Trigger::Rises(other, 0.0));
    match kinds(panes).first() {
        Some(kind) if !fires(panes, trigger) => Trigger::Rises(kind.plane()[1], 0.0),
        _ => trigger,
    }
}

/// Returns whether a trigger takes points of anything that is plotted.
fn fires(panes: &[Pane], trigger: Trigger) -> bool {
    let kinds = kinds(panes);
    kinds.iter().any(|kind| trigger.of(*kind) != Trigger::Off)
}

/// Returns the trigger of a section of what is plotted: the present one, unless it takes no points.
pub fn fitting_trigger(panes: &[Pane], across: Variable) -> Trigger {
    let present = panes[0].traces.trigger;
    if fires(panes, present) { present } else { first_trigger(panes, across) }
}

/// Takes the points of sections of all panes at other events.
pub fn set_trigger(panes: &mut [Pane], trigger: Trigger) {
    for pane in panes {
        pane.traces.set_trigger(trigger);
    }
}

/// Shows the variables of a new kind of things over time, if none of its phase plane is shown.
fn show(settings: &mut PlotSettings, kind: Kind) {
    let plane = kind.plane();
    if !plane.iter().any(|it| settings.shown.contains(it)) {
        settings.shown.extend(plane);
    }
}

/// Fits the axes, and the trigger of a section that is shown, to what is plotted.
fn fit(settings: &mut PlotSettings, panes: &mut [Pane]) {
    let axes = axes(settings, panes);
    settings.take_axes(axes, &panes[0].simulation.scene().name);
    let trigger = fitting_trigger(panes, axes[0].variable);
    if settings.mode == Mode::Section && trigger != panes[0].traces.trigger {
        set_trigger(panes, trigger);
    }
}

/// Returns a quantity for an axis. Where nothing has both its variable and that on the other axis,
/// it is of the first thing that has it.
fn on_axis(panes: &[Pane], quantity: Quantity, other: Quantity) -> Quantity {
    let has = |kind: Kind, it: Quantity| it.variable.is_of(kind);
    let (quantity, other) = (of_plotted(panes, quantity), of_plotted(panes, other));
    let both = |kind: &Kind| has(*kind, quantity) && (other.of.is_some() || has(*kind, other));
    let mut picks = panes[0].traces.iter().map(|(pick, _)| *pick);
    let of = match quantity.of {
        None if !kinds(panes).iter().any(both) => picks.find(|it| has(it.kind(), quantity)),
        of => of,
    };
    Quantity { of, ..quantity }
}

/// Carries out a request, and returns what is to be said.
pub fn apply(
    settings: &mut PlotSettings,
    panes: &mut [Pane],
    request: PlotRequest,
) -> Option<String> {
    let said = carry_out(settings, panes, request);
    fit(settings, panes);
    said
}

/// Carries out a request as [`apply`] does, but leaves axes and trigger as they are.
fn carry_out(
    settings: &mut PlotSettings,
    panes: &mut [Pane],
    request: PlotRequest,
) -> Option<String> {
    match request {
        PlotRequest::Toggle(pick) => {
            let is_known = kinds(panes).contains(&pick.kind());
            let refused = toggle(panes, pick).err();
            if !is_known && refused.is_none() {
                show(settings, pick.kind());
            }
            return refused;
        }
        PlotRequest::Mode(mode) => settings.mode = mode,
        PlotRequest::Show(variable) => {
            let before = settings.shown.len();
            settings.shown.retain(|it| *it != variable);
            if settings.shown.len() == before {
                settings.shown.push(variable);
            }
        }
        PlotRequest::Axis(axis, quantity) => {
            let mut axes = axes(settings, panes);
            let [across, up] = axes.map(|it| it.variable);
            axes[axis] = on_axis(panes, quantity, axes[1 - axis]);
            // The velocity goes with its coordinate.
            if axis == 0 && up == across.velocity() && quantity.variable.is_coordinate() {
                axes[1].variable = quantity.variable.velocity();
                axes[1] = on_axis(panes, axes[1], axes[0]);
            }
            settings.take_axes(axes, &panes[0].simulation.scene().name);
        }
        PlotRequest::Trigger(trigger) => set_trigger(panes, trigger),
        PlotRequest::Span(span) => settings.span = span,
        PlotRequest::Clear => panes.iter_mut().for_each(|pane| pane.traces.forget()),
        PlotRequest::Ruler if settings.ruler.take().is_none() => {
            settings.ruler = Some(vec![]);
            return Some("Drag from one point to another, or click on both.".into());
        }
        PlotRequest::Ruler => {}
        PlotRequest::Formulas => settings.formulas = !settings.formulas,
    }
    None
}

#[cfg(test)]
mod tests {
    use a3_core::Vector3;

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
        let own = picks.into_iter().map(|it| Variable::Energy.of(&it.read(run)));
        let energy = run.energy().unwrap();
        let pins = network.pins().map(|(i, _)| {
            let row = Pick::Particle(i).read(run);
            let gravity = network.gravity().unwrap_or_default();
            row.values[6] - network.masses()[i] * gravity.dot(&run.position(i))
        });
        // Springs between pins belong to no particle that moves.
        let between =
            network.springs().filter(|s| network.is_pinned(s.i) && network.is_pinned(s.j));
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
            assert!((sum - all).abs() < 1e-9 * all.abs().max(1.0), "{scene}: {sum} {all}");
            let run = session.runs.first();
            let (energy, row) = (run.energy().unwrap(), Pick::Scene.read(run));
            for (part, right) in [
                (Variable::Kinetic, energy.kinetic),
                (Variable::Elastic, energy.elastic),
                (Variable::Gravitational, energy.gravitational),
                (Variable::Contact, energy.contact),
            ] {
                assert_eq!(part.of(&row), right, "{scene}");
            }
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
        let spin = &Pick::Body(0).read(run).values[10..13];
        let spin = Vector3::from_column_slice(spin);
        assert!((body.momentum(rotation.q, spin) - rotation.momentum).norm() < 1e-12);
    }

    /// Compares sections of the swung pendulum with those of a Runge-Kutta integration by `NumPy`,
    /// of x'' = (50 (1/L - 1) d - 0.1 x') + g, d = x - (0.3 sin 2t, 0, 0), L = |d|.
    #[test]
    fn sections_of_a_driven_pendulum_are_those_of_another_program() {
        let mut session = session(&["r", "0.002", "--scene", "pendulum"]);
        session.act(RunAction::Swing, 0);
        toggle(&mut session.runs.panes, Pick::Particle(1)).unwrap();
        let trigger = first_trigger(&session.runs.panes, Variable::X);
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
        set_trigger(&mut session.runs.panes, Trigger::Rises(Variable::VelocityY, 0.0));
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

    /// The angles of the rods of a double pendulum are those between their ends, they go on past
    /// whole turns, and their rates are the angular velocities.
    #[test]
    fn angles_of_rods_are_those_between_their_ends() {
        let mut session = session(&["r", "0.002", "--scene", "double-pendulum"]);
        let rods = [Pick::Rod(0, 1), Pick::Rod(1, 2)];
        for rod in rods {
            apply(&mut session.panel.plotting, &mut session.runs.panes, PlotRequest::Toggle(rod));
        }
        assert!(session.panel.plotting.shown.ends_with(&rods[0].kind().plane()));
        frames(&mut session, 20.0);
        let run = session.runs.first();
        let mut most = 0.0_f64;
        for (k, (rod, series)) in session.runs.panes[0].traces.iter().enumerate() {
            let way = run.position(k + 1) - run.position(k);
            let last = series.nearest(1e9).unwrap();
            assert_eq!((*rod, last.values[0]), (rods[k], way.norm()));
            let angle = Variable::Angle.of(last);
            let turns = (angle - way.x.atan2(-way.y)) / TAU;
            assert!((turns - turns.round()).abs() < 1e-12, "{angle}");
            assert!((Variable::Tilt.of(last) - (-way.y / way.norm()).acos()).abs() < 1e-9);
            let rows: Vec<_> = series.rows().collect();
            for pair in rows.windows(2) {
                let [before, now] = [0, 1].map(|k| Variable::Angle.of(pair[k]));
                let rates = pair[0].values[12] + pair[1].values[12];
                let turned = 0.5 * rates * (pair[1].time - pair[0].time);
                assert!((now - before - turned).abs() < 1e-3, "{turned}");
                most = most.max(now.abs());
            }
        }
        assert!(most > 1.1 * TAU / 2.0, "{most}");
    }

    /// Returns the quantities on the axes of a session.
    fn shown(session: &Session) -> [Quantity; 2] {
        axes(&session.panel.plotting, &session.runs.panes)
    }

    /// Carries out requests.
    fn ask(session: &mut Session, requests: impl IntoIterator<Item = PlotRequest>) {
        for request in requests {
            let (own, panes) = (&mut session.panel.plotting, &mut session.runs.panes);
            apply(own, panes, request);
        }
    }

    #[test]
    fn only_a_new_kind_of_things_shows_variables() {
        let mut session = session(&["r", "0.002", "--scene", "double-pendulum"]);
        pick_first(&mut session.runs.panes);
        let rods = [Pick::Rod(0, 1), Pick::Rod(1, 2)].map(PlotRequest::Toggle);
        ask(&mut session, [Variable::X, Variable::Length, Variable::Force].map(PlotRequest::Show));
        assert_eq!(session.panel.plotting.shown, [Variable::Y]);
        ask(&mut session, [rods[0]]);
        let all = [Variable::Y, Variable::Angle, Variable::SpinZ];
        assert_eq!(session.panel.plotting.shown, all);
        // What was hidden stays so.
        ask(&mut session, [Variable::Angle, Variable::SpinZ].map(PlotRequest::Show));
        let modes = Mode::ALL.map(PlotRequest::Mode);
        ask(&mut session, [rods[1], rods[1], rods[0]].into_iter().chain(modes));
        assert_eq!(session.panel.plotting.shown, [Variable::Y]);
    }

    #[test]
    fn axes_are_of_what_is_left_and_never_of_another_scenes_things() {
        let mut session = session(&["r", "0.002", "--scene", "double-pendulum"]);
        pick_first(&mut session.runs.panes);
        let rods = [Pick::Rod(0, 1), Pick::Rod(1, 2)];
        let (x, angle) = (Quantity::of_each(Variable::X), Quantity::of_each(Variable::Angle));
        let of = |pick, quantity| Quantity { of: Some(pick), ..quantity };
        ask(&mut session, rods.map(PlotRequest::Toggle));
        let begun = [
            PlotRequest::Mode(Mode::Phase),
            PlotRequest::Axis(0, of(rods[0], angle)),
            PlotRequest::Axis(1, x),
        ];
        ask(&mut session, begun);
        assert_eq!(shown(&session), [of(rods[0], angle), x]);
        ask(&mut session, [PlotRequest::Toggle(rods[0])]);
        assert_eq!(shown(&session), [of(rods[1], angle), x]);
        // An edit that removes the rods asks for nothing.
        toggle(&mut session.runs.panes, rods[1]).unwrap();
        assert_eq!(shown(&session), Kind::Particle.plane().map(Quantity::of_each));
        let first = Pick::Particle(1);
        ask(&mut session, [PlotRequest::Axis(0, of(first, x))]);
        assert_eq!(shown(&session)[0].of, Some(first));
        session.act(RunAction::NextScene, 0);
        toggle(&mut session.runs.panes, first).unwrap();
        assert_eq!(shown(&session)[0], x);
    }

    #[test]
    fn a_section_has_a_trigger_of_what_is_plotted() {
        let mut session = session(&["r", "0.002", "--scene", "double-pendulum"]);
        pick_first(&mut session.runs.panes);
        let trigger = |session: &Session| session.runs.panes[0].traces.trigger;
        assert_eq!(trigger(&session), Trigger::Off);
        ask(&mut session, [PlotRequest::Mode(Mode::Section)]);
        assert_eq!(trigger(&session), Trigger::Rises(Variable::VelocityY, 0.0));
        let picks: Vec<_> = session.runs.panes[0].traces.iter().map(|it| it.0).collect();
        let no_more = picks.iter().copied().map(PlotRequest::Toggle);
        ask(&mut session, [PlotRequest::Toggle(Pick::Rod(0, 1))]);
        assert_eq!(trigger(&session), Trigger::Rises(Variable::VelocityY, 0.0));
        ask(&mut session, no_more);
        assert_eq!(trigger(&session), Trigger::Rises(Variable::SpinZ, 0.0));
        frames(&mut session, 5.0);
        assert!(!section(&session).is_empty());
        // One that fits stays.
        let tilt = Trigger::Rises(Variable::Tilt, 0.5);
        ask(&mut session, [PlotRequest::Trigger(tilt), PlotRequest::Toggle(picks[0])]);
        assert_eq!(trigger(&session), tilt);
    }

    /// A handle that spins about its middle axis stands upright and upside down in turn, and energy
    /// is kept: of the body, and of the whole scene.
    #[test]
    fn the_tilt_of_a_handle_goes_from_one_end_to_the_other() {
        let mut session = session(&["r", "0.01", "--scene", "t-handle"]);
        for pick in [Pick::Body(0), Pick::Scene] {
            toggle(&mut session.runs.panes, pick).unwrap();
        }
        frames(&mut session, 20.0);
        let [(_, body), (_, scene)] = session.runs.panes[0].traces.iter().as_slice() else {
            panic!("two picks");
        };
        let tilts = body.rows().map(|row| Variable::Tilt.of(row));
        let [low, high] = tilts.fold([9.0_f64, 0.0_f64], |[a, b], it| [a.min(it), b.max(it)]);
        assert!(low < 0.1 && high > 3.0, "{low} {high}");
        let run = session.runs.first();
        let pose = run.model().network().unwrap().pose(0, run.state());
        let own = |axis: Vector3<f64>| pose.of(axis).position - pose.place.position;
        let (x, y) = (own(Vector3::x()), own(Vector3::y()));
        let row = Pick::Body(0).read(run);
        assert!((Variable::Tilt.of(&row) - y.y.acos()).abs() < 1e-9);
        assert!((Variable::Angle.of(&row) - x.y.atan2(x.x)).abs() < 1e-9);
        for (own, all) in body.rows().zip(scene.rows()) {
            let [a, b] = [own, all].map(|row| Variable::Energy.of(row));
            assert!((a - b).abs() < 1e-9 * b, "{a} {b}");
        }
        let total = session.runs.first().energy().unwrap().total();
        let last = scene.nearest(1e9).unwrap();
        assert!((Variable::Energy.of(last) - total).abs() < 1e-9 * total);
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
        let lefts =
            rows.windows(2).filter(|pair| pair[0].values[0] < 0.0 && pair[1].values[0] >= 0.0);
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

    /// Plots that are opened while runs are paused show the last seconds, with the same values as
    /// those that were open all the time.
    #[test]
    fn plots_that_are_opened_late_show_the_last_seconds() {
        let [early, late] = [true, false].map(|early| {
            let mut session = compared(&["r:0.01", "v:0.01", "--scene", "pendulum"], 0.0);
            session.readings.in_window = true;
            if early {
                session.toggle(RunAction::Plots);
            }
            frames(&mut session, 2.0);
            session.act(RunAction::Pause, 0);
            if !early {
                session.toggle(RunAction::Plots);
            }
            rows(&session)
        });
        assert!(late.len() > 100, "{}", late.len());
        for row in &late {
            let same = early.iter().find(|other| other.time == row.time).unwrap();
            assert_eq!(same.values[..10], row.values[..10], "{}", row.time);
        }
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
                assert_eq!(last.values[..10], pick.read(&with.simulation).values[..10]);
            }
        }
        toggle(&mut plotted.runs.panes, Pick::Particle(200)).unwrap();
        assert_eq!(plotted.runs.panes[1].traces.iter().len(), MAX_PICKS - 1);
    }
}
