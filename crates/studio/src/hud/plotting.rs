//! The pane of plots of what a user picks (key F3): its rows, the chart with the values at the
//! pointer, and buttons below it.

mod chart;
mod formulas;
mod rows;

use egui::{Align2, Color32, Context, Id, Pos2, Rect, Sense, Stroke, Ui, Vec2, vec2};

use super::charts::{Sheet, colour};
use super::dock::Pane;
use super::style::{FAINT, TEXT};
use super::widgets::{Asks, chip, columns, fixed, write};
use super::words::signed;
use crate::session::{Action, Mode, Pick, PlotFile, PlotRequest, Quantity, RunAction, SPANS};
use crate::session::{IS_PAGE, Session, WindowAction};
use chart::{Axes, Plotted, place, plotted, rows};
use rows::Rows;

pub use chart::{write as write_files, write_one};

/// The pane.
pub const PANE: Pane = Pane {
    title: "Plots",
    action: RunAction::Plots,
    key: "F3",
    margins: [16.0, 17.5],
    contents: show,
    width: (380.0, 800.0, 0.4),
    min_width_beside: 700.0,
    share_below: 0.55,
    narrow: None,
};

/// Height of the heading, of the modes, and of the buttons below the chart (points).
const HEIGHTS: [f32; 3] = [38.0, 28.0, 26.0];
/// Place and size of the button in the heading (points).
const ASKED: [Vec2; 2] = [vec2(70.0, 5.0), vec2(136.0, 25.0)];
/// Distance between rows (points).
const GAP: f32 = 7.0;

/// Draws all rows from the top of a room.
fn show(ui: &mut Ui, room: Rect, session: &Session) {
    let [heading, modes, buttons] = HEIGHTS;
    let top = room.top() + heading;
    let tabs = Rect::from_x_y_ranges(room.x_range(), top..=top + modes);
    let settings = &session.panel.plotting;
    let asked = Rect::from_min_size(room.min + ASKED[0], ASKED[1]);
    chip(ui, asked, "what is computed?", settings.formulas).asks(PlotRequest::Formulas);
    for (place, mode) in columns(tabs, 3, 6.0).zip(Mode::ALL) {
        chip(ui, place, mode.name(), settings.mode == mode).asks(PlotRequest::Mode(mode));
    }
    let mut rows = Rows { ui, session, room: room.with_min_y(top + modes + GAP) };
    rows.picks();
    let is_empty = session.runs.panes[0].traces.is_empty();
    if !is_empty {
        rows.variables();
    }
    let (top, below) = (rows.room.top(), room.bottom() - buttons - 10.0);
    let mut place = Rect::from_x_y_ranges(room.x_range(), top + 2.0..=below - GAP);
    if settings.formulas {
        place.min.y = formulas::show(ui, place, session);
    }
    if !is_empty && place.height() > 0.0 {
        draw(ui, place, session);
    }
    let place = Rect::from_x_y_ranges(room.x_range(), below..=below + buttons);
    foot(ui, place, session);
}

/// Draws the spans of time, and the buttons that write files.
fn foot(ui: &Ui, rect: Rect, session: &Session) {
    let settings = &session.panel.plotting;
    let mut left = rect.left();
    if settings.mode != Mode::Section {
        for span in SPANS {
            let place = Rect::from_x_y_ranges(left..=left + 44.0, rect.y_range());
            let chip = chip(ui, place, &format!("{span} s"), settings.span == span);
            chip.asks(PlotRequest::Span(span));
            left += 48.0;
        }
    }
    let mut right = rect.right();
    let ruled = settings.ruler.is_some();
    let [picture, table] = [PlotFile::Picture, PlotFile::Table].map(WindowAction::WritePlot);
    let buttons: [(_, Action, _); 4] = [
        (if IS_PAGE { "SVG" } else { "PNG" }, picture.into(), false),
        ("CSV", table.into(), false),
        ("clear", PlotRequest::Clear.into(), false),
        ("ruler", PlotRequest::Ruler.into(), ruled),
    ];
    for (words, wish, chosen) in buttons {
        let place = Rect::from_x_y_ranges(right - 50.0..=right, rect.y_range());
        chip(ui, place, words, chosen).asks(wish);
        right -= 54.0;
    }
}

/// Draws a button that plots the particle whose springs are listed, below that list, unless the
/// plots are open.
pub fn offer(ctx: &Context, session: &Session) {
    let is_free = !session.panel.has(RunAction::Plots) && !session.readings.help;
    let [pane] = &*session.runs.panes else {
        return;
    };
    let i = pane.show.springs_of.filter(|_| is_free);
    let list = ctx.memory(|memory| memory.area_rect(Id::unique("run")));
    let Some((i, list)) = i.zip(list) else {
        return;
    };
    let at = list.left_bottom() + vec2(0.0, 6.0);
    let pick = Pick::at(session.runs.first(), i);
    let words = format!("plot {} (F3)", pick.name());
    let rect = Rect::from_min_size(at, vec2(14.0 + 7.5 * words.len() as f32, 26.0));
    fixed(ctx, Id::unique("plot it"), at, |ui| {
        ui.allocate_rect(rect, Sense::hover());
        chip(ui, rect, &words, false).asks(RunAction::Plots);
    });
}

/// Returns the request that a double click makes on a particle, or else on the spring, rod or rope
/// between two, if the plots are visible: to plot it, or the body of the particle, or no longer.
pub fn picked(
    session: &Session,
    particle: Option<usize>,
    link: Option<[usize; 2]>,
) -> Option<PlotRequest> {
    let run = Some(session.runs.first()).filter(|_| session.shows(RunAction::Plots))?;
    let of_link = || {
        let mut links = Pick::links(run.model().network()?);
        links.find(|it| link.is_some() && it.ends() == link)
    };
    let pick = particle.map(|i| Pick::at(run, i)).or_else(of_link);
    pick.map(PlotRequest::Toggle)
}

/// Number of parts of the time in which a curve has a point.
const DETAIL: usize = 500;
/// Size of text (points).
const SIZE: f64 = 11.5;
/// Largest distance of the pointer from the point that it shows (points).
const REACH: f32 = 24.0;

/// Draws the chart in a room.
fn draw(ui: &Ui, room: Rect, session: &Session) {
    let mut plotted = plotted(session, DETAIL);
    let mode = session.panel.plotting.mode;
    if mode == Mode::Section {
        let panel = &mut plotted.chart.panels[0];
        let drawn: usize = panel.lines.iter().map(|it| it.points().count()).sum();
        let points = if drawn == 1 { "point" } else { "points" };
        panel.y_label = format!("{}   {drawn} {points}", panel.y_label);
    }
    for (panel, axes) in plotted.chart.panels.iter_mut().zip(&plotted.axes) {
        // Spaces keep the numbers of the axis away from long words.
        if axes[0].is_some_and(|it| it.of.is_some()) {
            panel.x_label.insert_str(0, "   ");
        }
    }
    let sheet = [room.width(), room.height()].map(f64::from);
    // The rows above the chart name the curves.
    let figure = plotted.chart.draw_compact(sheet, SIZE, false);
    let painter = ui.painter();
    if figure.panels.is_empty() {
        let words = if plotted.chart.panels.is_empty() {
            "Choose what to show."
        } else {
            "There is no room for the plots: make the window higher."
        };
        write(painter, room.min, Align2::LEFT_TOP, words, 13.0, FAINT);
        return;
    }
    let sheet = Sheet::new(painter, room, &figure);
    sheet.draw(None);
    if session.readings.rewound() && mode == Mode::Time {
        sheet.mark(session.runs.first().time(), Stroke::new(1.4, TEXT));
    }
    let pointer = ui.ctx().pointer_latest_pos();
    let pointer = pointer.filter(|at| ui.ctx().layer_id_at(*at) == Some(ui.layer_id()));
    let under = pointer.and_then(|at| Some((at, sheet.under(at)?)));
    match under {
        Some((at, under)) if mode == Mode::Time => {
            show_time(&sheet, session, &plotted, under, at);
        }
        Some((at, (panel, _))) => show_point(&sheet, session, &plotted, panel, at),
        None => {}
    }
}

/// Shows the values at the time under the pointer, which is at a share of the width of a panel:
/// dots on all curves, and the numbers of that panel.
fn show_time(
    sheet: &Sheet,
    session: &Session,
    plotted: &Plotted,
    (over, share): (usize, f64),
    at: Pos2,
) {
    let [from, to] = plotted.chart.panels[over].ends.unwrap_or_default();
    let time = from + share * (to - from);
    let mut lines = vec![];
    let mut shown = None;
    for k in 0..sheet.figure.panels.len() {
        let axes = plotted.axes[k];
        let drawn = &plotted.chart.panels[k].lines;
        for ([pane, pick], line) in plotted.sources[k].iter().zip(drawn) {
            let (_, series) = &session.runs.panes[*pane].traces.iter().as_slice()[*pick];
            let Some(row) = series.nearest(time).filter(|row| row.time >= from) else {
                continue;
            };
            let point = place(session, axes, [*pane, *pick], row);
            if !point[1].is_finite() {
                continue;
            }
            let ink = colour(line.style.colour);
            sheet.painter.circle_filled(sheet.at(k, point), 3.0, ink);
            shown = shown.or(Some(row.time));
            if k == over {
                let words = format!("{}  {}", line.name, value(axes, point, 1));
                lines.push((words, 12.5, ink));
            }
        }
    }
    let Some(shown) = shown else {
        return;
    };
    sheet.mark(shown, Stroke::new(1.0, FAINT));
    lines.insert(0, (format!("at {shown:.3} s"), 12.5, TEXT));
    sheet.note(at, FAINT, lines);
}

/// Shows the point nearest to the pointer in a panel, and its values.
fn show_point(sheet: &Sheet, session: &Session, plotted: &Plotted, panel: usize, at: Pos2) {
    let axes = plotted.axes[panel];
    let sources = plotted.sources[panel].iter();
    let lines = sources.zip(&plotted.chart.panels[panel].lines);
    let all = lines.flat_map(|(source, line)| {
        let rows = rows(session, *source).into_iter();
        let placed = rows.map(|row| (place(session, axes, *source, row), row.time));
        placed.map(move |(values, time)| (sheet.at(panel, values), values, time, line))
    });
    let near = all.filter(|(point, ..)| point.distance(at) < REACH);
    let nearest = near.min_by(|a, b| a.0.distance(at).total_cmp(&b.0.distance(at)));
    let Some((point, values, time, line)) = nearest else {
        return;
    };
    let ink = colour(line.style.colour);
    let edge = Stroke::new(1.8, ink);
    sheet.painter.circle(point, 4.0, Color32::WHITE, edge);
    let mut lines = vec![(line.name.clone(), 12.5, ink), (format!("at {time:.3} s"), 12.5, TEXT)];
    for (k, axis) in axes.into_iter().enumerate() {
        let name = axis.map_or(String::new(), Quantity::name);
        lines.push((format!("{name}  {}", value(axes, values, k)), 12.5, TEXT));
    }
    sheet.note(point, ink, lines);
}

/// Returns the value on one of the axes with its unit.
fn value(axes: Axes, point: [f64; 2], axis: usize) -> String {
    let unit = axes[axis].map_or("s", |it| it.variable.unit());
    format!("{} {unit}", signed(point[axis]))
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use a3_core::Vector3;
    use egui::Pos2;

    use super::*;
    use crate::hud::window::Window;
    use crate::hud::{all::show_all, layout};
    use crate::session::{RulerEnd, Trigger, Variable, apply, frames, session};

    /// Draws a window of a size (points), and clicks at a place. Returns the words of the pane,
    /// their places, and the action.
    fn draw(session: &Session, size: [f32; 2], at: Pos2) -> Drawn {
        let mut window = Window::new(size);
        let px = (size[0] as u32, size[1] as u32);
        let [right, bottom] = layout::insets(session, px, 1.0);
        let action = window.click([right, bottom], at, |ctx| {
            show_all(ctx, session, &HashMap::new());
        });
        let is_in_pane = |rect: &Rect| {
            if layout::is_covered(session, size) {
                rect.bottom() < size[1] - bottom
            } else if right > 0.0 {
                rect.left() > size[0] - right
            } else {
                rect.top() > size[1] - bottom && rect.bottom() < size[1] - 40.0
            }
        };
        let (mut words, mut all) = (vec![], vec![]);
        for (said, rect, seen) in window.written() {
            all.push(said.clone());
            if is_in_pane(&rect) {
                assert!(seen.contains_rect(rect), "{said} in {size:?}");
                words.push((said, rect));
            }
        }
        Drawn { words, all, action }
    }

    struct Drawn {
        words: Vec<(String, Rect)>,
        /// The words of the whole window.
        all: Vec<String>,
        action: Option<Action>,
    }

    impl Drawn {
        /// Returns the place of words.
        fn place(&self, words: &str) -> Pos2 {
            let found = self.words.iter().find(|(said, _)| said == words);
            let all = self.words.iter().map(|(said, _)| said).collect::<Vec<_>>();
            found.unwrap_or_else(|| panic!("{words} in {all:?}")).1.center()
        }
    }

    /// Returns a session of a curtain with three plots.
    fn curtain() -> Session {
        let mut session = session(&["t", "0.01", "--springs-of", "210"]);
        session.act(RunAction::Plots, 0);
        apply(&mut session, PlotRequest::Toggle(Pick::Particle(399)), 0);
        apply(&mut session, PlotRequest::Toggle(Pick::Spring(210, 230)), 0);
        frames(&mut session, 1.0);
        session
    }

    #[test]
    fn no_words_cover_others_in_any_window() {
        let mut session = curtain();
        let away = Pos2::new(5.0, 5.0);
        for (mode, formulas) in [(0, true), (0, false), (1, false), (2, false)] {
            let mode = Mode::ALL[mode];
            session.panel.plotting.formulas = formulas;
            apply(&mut session, PlotRequest::Mode(mode), 0);
            for size in [[1000.0, 560.0], [1280.0, 800.0], [1920.0, 1080.0], [620.0, 900.0]] {
                let drawn = draw(&session, size, away);
                for (k, (a, place)) in drawn.words.iter().enumerate() {
                    for (b, other) in &drawn.words[..k] {
                        let apart = !place.shrink(1.0).intersects(*other);
                        assert!(apart, "{a} over {b} in {size:?}, {mode:?}");
                    }
                }
                for said in ["particle 210", "spring 210 to 230", "CSV", "PNG", mode.name()] {
                    drawn.place(said);
                }
            }
        }
    }

    /// Where nothing is plotted, a narrow window says how to plot something, on whole lines.
    #[test]
    fn a_narrow_window_says_how_to_plot_something() {
        let mut session = session(&["t", "0.01"]);
        session.act(RunAction::Plots, 0);
        for size in [[390.0, 844.0], [1280.0, 800.0]] {
            let mut window = Window::new(size);
            let insets = layout::insets(&session, (size[0] as u32, size[1] as u32), 1.0);
            window.click(insets, Pos2::new(5.0, 5.0), |ctx| {
                show_all(ctx, &session, &HashMap::new());
            });
            let all = window.written();
            for said in [
                "Double click on a particle, a body,",
                "a spring or a rod to plot it.",
                "+ the scene",
            ] {
                let (_, rect, seen) = all.iter().find(|it| it.0 == said).unwrap();
                assert!(seen.contains_rect(*rect), "{said} in {size:?}");
                assert!(rect.right() <= size[0] - 10.0, "{said} in {size:?}");
            }
        }
    }

    #[test]
    fn clicks_choose_what_is_plotted_and_how() {
        let mut session = curtain();
        let size = [1280.0, 800.0];
        let mut click = |words: &str| {
            let at = draw(&session, size, Pos2::new(5.0, 5.0)).place(words);
            let request = draw(&session, size, at).action;
            let Some(Action::Plot(wish)) = request else {
                panic!("{words}: {request:?}");
            };
            apply(&mut session, wish, 0);
            wish
        };
        assert_eq!(click("vy"), PlotRequest::Show(Variable::VelocityY));
        assert_eq!(click("190"), PlotRequest::Toggle(Pick::Spring(190, 210)));
        assert_eq!(click("5 s"), PlotRequest::Span(5.0));
        assert_eq!(click("section"), PlotRequest::Mode(Mode::Section));
        assert_eq!(click("ruler"), PlotRequest::Ruler);
        let on_next = |of| Quantity { of, variable: Variable::X };
        let first = on_next(Some(Pick::Particle(210)));
        assert_eq!(click("+ the scene"), PlotRequest::Toggle(Pick::Scene));
        assert_eq!(click("of each"), PlotRequest::Axis(0, first));
        let other = Pick::Particle(399);
        assert_eq!(click("particle 399"), PlotRequest::Toggle(other));
        assert_eq!(click("what is computed?"), PlotRequest::Formulas);
        let lower = Trigger::Rises(Variable::VelocityY, 0.0);
        let trigger = |session: &Session| session.runs.panes[0].traces.trigger;
        assert_eq!(trigger(&session), lower);
    }

    #[test]
    fn values_are_shown_at_the_pointer() {
        let mut session = curtain();
        let size = [1280.0, 800.0];
        let away = draw(&session, size, Pos2::new(5.0, 5.0));
        let left = away.place("y (m)");
        let said = |session: &Session, at: Pos2| -> Vec<String> {
            let drawn = draw(session, size, at);
            drawn.words.into_iter().map(|(said, _)| said).collect()
        };
        // At a twentieth of the way, 1 s of 20 s have passed.
        let (from, to) = (left.x + 30.0, 1264.0);
        let at = Pos2::new(from + (to - from) / 20.0, left.y + 30.0);
        let words = said(&session, at);
        let time = words.iter().find_map(|it| it.strip_prefix("at ")?.strip_suffix(" s"));
        let time: f64 = time.unwrap().parse().unwrap();
        assert!((0.8..1.05).contains(&time), "{time}");
        let (_, series) = &session.runs.panes[0].traces.iter().as_slice()[0];
        let y = series.nearest(time).unwrap().values[1];
        let value = format!("particle 210  {y:.2} m");
        assert!(words.contains(&value), "{value} in {words:?}");
        apply(&mut session, PlotRequest::Mode(Mode::Phase), 0);
        assert!(!said(&session, Pos2::new(5.0, 5.0)).iter().any(|it| it.starts_with("at ")));
    }

    #[test]
    fn the_ruler_follows_its_ends() {
        let mut session = curtain();
        assert!(!session.panel.plotting.is_ruling());
        apply(&mut session, PlotRequest::Ruler, 0);
        for end in [RulerEnd::Particle(210), RulerEnd::Particle(399)] {
            assert!(session.panel.plotting.is_ruling());
            session.panel.plotting.begin_end(end);
        }
        assert!(!session.panel.plotting.is_ruling());
        session.panel.plotting.move_end(RulerEnd::Point(Vector3::new(0.0, 2.0, 0.0)));
        let mut last = String::new();
        for _ in 0..2 {
            frames(&mut session, 0.3);
            let way = Vector3::new(0.0, 2.0, 0.0) - session.runs.first().position(210);
            let [dx, dy, dz] = [way.x, way.y, way.z].map(signed);
            let length = signed(way.norm());
            let words = format!("{length} m\ndx {dx}   dy {dy}   dz {dz} m");
            let drawn = draw(&session, [1280.0, 800.0], Pos2::new(5.0, 5.0));
            assert!(drawn.all.contains(&words) && words != last, "{words} in {:?}", drawn.all);
            last = words;
        }
        apply(&mut session, PlotRequest::Ruler, 0);
        assert!(session.panel.plotting.ruler.is_none());
    }

    #[test]
    fn a_small_window_says_that_plots_have_no_room() {
        let mut session = curtain();
        apply(&mut session, PlotRequest::Mode(Mode::Phase), 0);
        let said = |session: &Session, size, words: &str| {
            let drawn = draw(session, size, Pos2::new(5.0, 5.0));
            drawn.all.iter().any(|it| it.contains(words))
        };
        // In a low one, a click goes on to the next variable.
        assert!(!said(&session, [640.0, 400.0], "There is no room"));
        assert!(!said(&session, [640.0, 400.0], "speed"));
        let at = draw(&session, [640.0, 400.0], Pos2::new(5.0, 5.0)).place("x");
        let next = Quantity::of_each(Variable::Y);
        let wish = Action::Plot(PlotRequest::Axis(0, next));
        assert_eq!(draw(&session, [640.0, 400.0], at).action, Some(wish));
        assert!(said(&session, [640.0, 300.0], "There is no room"));
        assert!(!said(&session, [640.0, 300.0], "Choose what to show"));
        assert!(!said(&session, [1280.0, 800.0], "There is no room"));
        apply(&mut session, PlotRequest::Mode(Mode::Time), 0);
        for variable in session.panel.plotting.shown.clone() {
            apply(&mut session, PlotRequest::Show(variable), 0);
        }
        assert!(said(&session, [1280.0, 800.0], "Choose what to show"));
    }
}
