//! The rows above the chart: the picks, their variables, and the times of points of a section,
//! side by side in as many lines as they need.

use std::f64::consts::TAU;

use egui::{FontId, Pos2, Rect, Ui, pos2, vec2};

use super::super::charts::line;
use super::super::style::{FAINT, TEXT};
use super::super::widgets::{Asks, LEFT, MIDDLE, ask, chip, is_asked, write};
use super::super::words::signed;
use super::chart::{has, run_name, style};
use crate::session::plotting::{axes, drive, fitting_trigger};
use crate::session::{Mode, Pick, PlotRequest, Quantity, Session, Trigger, Variable};

/// Width of the sample of a curve (points).
const SAMPLE: f32 = 18.0;
/// Largest number of springs, rods and ropes that are offered.
const MAX_LINKS: usize = 24;
/// Height below which a room has no lines of its own for the variables of each axis (points).
const LOW: f32 = 260.0;
/// Steps between the least and the greatest value of a variable that a section may pass.
const STEPS: f64 = 20.0;

/// Rows that are drawn below one another.
pub struct Rows<'a> {
    pub ui: &'a Ui,
    pub session: &'a Session,
    /// The room that is left.
    pub room: Rect,
}

impl Rows<'_> {
    /// Draws a button in a flow.
    fn button(&self, flow: &mut Flow, words: &str, chosen: bool, wish: PlotRequest) {
        let place = flow.words(self.ui, words, 8.0);
        chip(self.ui, place, words, chosen).asks(wish);
    }

    /// Writes words in a flow.
    fn say(&self, flow: &mut Flow, words: &str) {
        let at = flow.words(self.ui, words, 2.0).left_center();
        write(self.ui.painter(), at, LEFT, words, 13.0, FAINT);
    }

    /// Goes on below a flow.
    fn end(&mut self, flow: &Flow) {
        self.room.min.y = flow.bottom();
    }

    /// Draws what is plotted, each with its colour and a cross that ends it. In a comparison, the
    /// colours are those of the panes, which are named if anything is plotted.
    pub fn picks(&mut self) {
        let (session, panes) = (self.session, &self.session.runs.panes);
        let mut flow = Flow::new(self.room);
        let picks: Vec<Pick> = panes[0].traces.iter().map(|(pick, _)| *pick).collect();
        if picks.is_empty() {
            // In two parts, the words fit into a narrow window.
            self.say(&mut flow, "Double click on a particle, a body,");
            self.say(&mut flow, "a spring or a rod to plot it.");
        }
        for (k, pick) in picks.into_iter().enumerate() {
            let name = pick.name();
            let place = flow.words(self.ui, &name, 0.5 * SAMPLE + 17.0);
            self.pick(place, &name, [0, k], panes.len() > 1, pick);
        }
        if !panes[0].traces.has(Pick::Scene) && panes[0].simulation.model().network().is_some() {
            let wish = PlotRequest::Toggle(Pick::Scene);
            self.button(&mut flow, "+ the scene", false, wish);
        }
        self.end(&flow);
        if panes.len() > 1 && !panes[0].traces.is_empty() {
            let mut flow = Flow::new(self.room);
            for (k, pane) in panes.iter().enumerate() {
                let name = run_name(pane);
                let place = flow.words(self.ui, &name, 0.5 * SAMPLE + 8.0);
                let at = place.left_center();
                let ends = vec![at + vec2(2.0, 0.0), at + vec2(2.0 + SAMPLE, 0.0)];
                line(self.ui.painter(), ends, &style(session, [k, 0]).pen(2.2));
                let at = at + vec2(SAMPLE + 8.0, 0.0);
                write(self.ui.painter(), at, LEFT, name, 13.0, TEXT);
            }
            self.end(&flow);
        }
        self.links();
    }

    /// Draws one thing that is plotted.
    fn pick(&self, place: Rect, name: &str, source: [usize; 2], grey: bool, pick: Pick) {
        let (ui, look) = (self.ui, style(self.session, source));
        let response = chip(ui, place, "", false);
        let painter = ui.painter();
        let at = place.left_center() + vec2(8.0, 0.0);
        let ends = vec![at, at + vec2(SAMPLE, 0.0)];
        let mut pen = look.pen(2.2);
        if grey {
            pen.colour = "#181c28";
        }
        line(painter, ends, &pen);
        let at = at + vec2(SAMPLE + 6.0, 0.0);
        write(painter, at, LEFT, name, 13.0, TEXT);
        let at = pos2(place.right() - 9.0, at.y);
        let ink = if response.hovered() { TEXT } else { FAINT };
        write(painter, at, MIDDLE, "✖", 10.0, ink);
        let response = response.on_hover_text("Plot it no longer");
        response.asks(PlotRequest::Toggle(pick));
    }

    /// Offers the springs, rods and ropes of the particle whose springs are listed.
    fn links(&mut self) {
        let first = &self.session.runs.panes[0];
        let network = first.simulation.model().network();
        let (Some(i), Some(network)) = (first.show.springs_of, network) else {
            return;
        };
        let links = Pick::links(network).filter_map(|link| {
            let [a, b] = link.ends().filter(|ends| ends.contains(&i))?;
            Some((link, (a + b - i).to_string()))
        });
        let links: Vec<_> = links.take(MAX_LINKS).collect();
        if links.is_empty() {
            return;
        }
        let mut flow = Flow::new(self.room);
        let are_springs = links.iter().all(|(link, _)| matches!(link, Pick::Spring(..)));
        let what = if are_springs { "springs" } else { "links" };
        self.say(&mut flow, &format!("{what} of particle {i} to"));
        for (link, other) in links {
            let chosen = first.traces.has(link);
            self.button(&mut flow, &other, chosen, PlotRequest::Toggle(link));
        }
        self.end(&flow);
    }

    /// Draws the variables over time, or those on both axes: in a low room, only the present ones,
    /// and a click goes on to the next.
    pub fn variables(&mut self) {
        let settings = &self.session.panel.plotting;
        if settings.mode == Mode::Time {
            let mut flow = Flow::new(self.room);
            for variable in self.all_variables() {
                let chosen = settings.shown.contains(&variable);
                let wish = PlotRequest::Show(variable);
                self.button(&mut flow, variable.name(), chosen, wish);
            }
            return self.end(&flow);
        }
        let is_low = self.room.height() < LOW;
        let axes = axes(settings, &self.session.runs.panes);
        let mut flow = Flow::new(self.room);
        for (axis, words) in ["across", "up"].into_iter().enumerate() {
            self.say(&mut flow, words);
            let now = axes[axis];
            let all = self.all_variables();
            let k = all.iter().position(|it| *it == now.variable);
            let next = all[k.map_or(0, |k| (k + 1) % all.len())];
            for (variable, name) in all.iter().map(|it| (*it, it.name())) {
                let chosen = now.variable == variable;
                let variable = if is_low { next } else { variable };
                let wish = PlotRequest::Axis(axis, Quantity { variable, ..now });
                if chosen || !is_low {
                    self.button(&mut flow, name, chosen, wish);
                }
            }
            self.owner(&mut flow, axis, now);
            if axis == 1 || !is_low {
                self.end(&flow);
                flow = Flow::new(self.room);
            }
        }
        if settings.mode == Mode::Section {
            self.trigger(axes[0].variable);
        }
    }

    /// Draws of what the quantity on an axis is, if several things have its variable. A click goes
    /// on to the next one.
    fn owner(&self, flow: &mut Flow, axis: usize, now: Quantity) {
        let picks = self.session.runs.panes[0].traces.iter();
        let own = picks.map(|(pick, _)| *pick);
        let own: Vec<_> = own.filter(|pick| now.variable.is_of(pick.kind())).collect();
        if own.len() < 2 && now.of.is_none() {
            return;
        }
        let k = own.iter().position(|pick| Some(*pick) == now.of);
        let next = own.get(k.map_or(0, |k| k + 1)).copied();
        let words = now.of.map_or("of each".into(), |pick| format!("of {}", pick.name()));
        let wish = PlotRequest::Axis(axis, Quantity { of: next, ..now });
        self.button(flow, &words, now.of.is_some(), wish);
    }

    /// Returns the variables of anything that is plotted.
    fn all_variables(&self) -> Vec<Variable> {
        let all = Variable::all();
        all.filter(|it| has(self.session, *it)).collect()
    }

    /// Draws when points of the section are taken.
    fn trigger(&mut self, across: Variable) {
        let session = self.session;
        let trigger = session.runs.panes[0].traces.trigger;
        let fitting = fitting_trigger(&session.runs.panes, across);
        if fitting != trigger && !is_asked(self.ui) {
            ask(self.ui, PlotRequest::Trigger(fitting));
        }
        let run = &session.runs.panes[0].simulation;
        let mut flow = Flow::new(self.room);
        self.say(&mut flow, "when");
        if let Some(period) = drive(run) {
            let chosen = matches!(trigger, Trigger::Period(_));
            let wish = PlotRequest::Trigger(Trigger::Period(period));
            self.button(&mut flow, "a period of the drive ends", chosen, wish);
        }
        let of = match trigger {
            Trigger::Rises(variable, _) => Some(variable),
            _ => None,
        };
        for variable in self.all_variables() {
            let wish = PlotRequest::Trigger(Trigger::Rises(variable, 0.0));
            self.button(&mut flow, variable.name(), of == Some(variable), wish);
        }
        if let Trigger::Rises(variable, value) = trigger {
            self.say(&mut flow, "rises through");
            let step = step(session, variable);
            for (words, by) in [("−", -step), ("+", step)] {
                let next = step * ((value + by) / step).round();
                let wish = PlotRequest::Trigger(Trigger::Rises(variable, next));
                self.button(&mut flow, words, false, wish);
                if by < 0.0 {
                    let words = format!("{} {}", signed(value), variable.unit());
                    self.say(&mut flow, &words);
                }
            }
        }
        self.end(&flow);
    }
}

/// Returns the step by which the value of a variable that a section passes is changed: a round part
/// of its range.
fn step(session: &Session, variable: Variable) -> f64 {
    let panes = session.runs.panes.iter();
    let traces = panes.flat_map(|pane| pane.traces.iter());
    let of_kind = traces.filter(|(pick, _)| variable.is_of(pick.kind()));
    let values = of_kind.flat_map(|(_, series)| series.rows().map(|row| variable.of(row)));
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    // A section passes angles any number of turns away, too.
    let most = if variable == Variable::Angle { TAU } else { f64::INFINITY };
    let part = (high - low).min(most) / STEPS;
    if !(part > 0.0 && part.is_finite()) {
        return 0.1;
    }
    let power = 10_f64.powf(part.log10().floor());
    let rounds = [1.0, 2.0, 5.0, 10.0].map(|by| by * power);
    rounds.into_iter().find(|it| *it >= part).unwrap_or(power)
}

/// Height of a line, and distance between its parts and between lines (points).
const LINE: [f32; 2] = [24.0, 4.0];

/// Places from the left to the right of a room, line by line.
struct Flow {
    room: Rect,
    next: Pos2,
}

impl Flow {
    /// Begins at the top of a room.
    fn new(room: Rect) -> Self {
        Self { room, next: room.min }
    }

    /// Returns the place of a part of a width (points).
    fn place(&mut self, width: f32) -> Rect {
        let is_full = self.next.x + width > self.room.right() && self.next.x > self.room.left();
        if is_full {
            self.next = pos2(self.room.left(), self.next.y + LINE[0] + LINE[1]);
        }
        let place = Rect::from_min_size(self.next, vec2(width, LINE[0]));
        self.next.x += width + LINE[1];
        place
    }

    /// Returns the place of words with a margin (points) on either side.
    fn words(&mut self, ui: &Ui, words: &str, margin: f32) -> Rect {
        let font = FontId::proportional(13.0);
        let galley = ui.painter().layout_no_wrap(words.into(), font, TEXT);
        self.place(galley.size().x + 2.0 * margin)
    }

    /// Returns the height (points) below the last line.
    fn bottom(&self) -> f32 {
        self.next.y + LINE[0] + LINE[1]
    }
}
