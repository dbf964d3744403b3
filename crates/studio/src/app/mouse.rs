//! What the mouse does: pulling, turning and moving the camera, pinning, and editing the scene. The
//! shape of the pointer and a highlight tell the effect of a press.

use a3_core::Vector3;
use a3_media::show::{self, Target};
use egui::CursorIcon;
use winit::dpi::PhysicalPosition;
use winit::event::{MouseButton, MouseScrollDelta};

use super::graphics::Graphics;
use super::pick::{Grip, Sight};
use super::pointer::Drag;
use super::state::App;
use crate::hud::edit::{self, Aim, Throw, click, join};
use crate::hud::{layout, plotting};
use crate::session::{RulerEnd, Selection, Session, Tool, apply, looks};

/// Largest motion of the pointer during a click of the mouse, and of a finger (points).
const MAX_CLICK_DISTANCES: [f32; 2] = [4.0, 10.0];
/// Angle by which the camera turns when the pointer moves by the height of the picture (rad).
const ORBIT_ANGLE: f32 = 4.0;
/// Least height of the eye above the ground to which a drag turns it, in units of length.
const ABOVE_GROUND: f32 = 0.05;
/// Smooth scrolling that counts as a notch of the wheel (px).
const PIXELS_PER_NOTCH: f32 = 50.0;
/// Distances from the pointer within which a particle is picked, and within which a spring, a rod
/// or a rope is found (points).
const PICK_DISTANCES: [f32; 2] = [18.0, 9.0];
/// Factor of the mass of a heavy ball.
const HEAVY: f64 = 10.0;
/// Factor of the speed that a drag by the height of the picture adds.
const PULL: f32 = 4.0;

impl App {
    /// Returns the pane under the pointer, or else the pane that it was over last.
    pub fn pane(&self) -> usize {
        let (session, position) = (&self.session, self.mouse.position);
        let last = session.panel.pane.min(session.runs.panes.len() - 1);
        self.screen.pane_at(session, position).unwrap_or(last)
    }

    /// Returns the line of sight through a place (px) in a pane.
    fn sight(&self, place: [f32; 2], pane: usize) -> Sight<'_> {
        let tile = self.screen.tile(&self.session, pane);
        Sight {
            run: &self.session.runs.panes[pane].simulation,
            camera: &self.session.view.camera,
            at: tile.place(place),
            aspect: tile.aspect(),
        }
    }

    /// Returns the distances within which things are picked in a pane, as shares of its height.
    fn reach(&self, pane: usize) -> [f32; 2] {
        let height = self.screen.tile(&self.session, pane).height as f32;
        PICK_DISTANCES.map(|points| points * self.screen.scale() / height)
    }

    /// Returns the particle or obstacle under the pointer in a pane; `None` in a diverged run.
    fn hit(&self, pane: usize) -> Option<(Target, Grip)> {
        let alive = self.session.runs.panes[pane].alive();
        let sight = self.sight(self.mouse.position, pane);
        alive.then(|| sight.pick(self.reach(pane)[0])).flatten()
    }

    /// Returns the particle under the pointer in a pane.
    pub fn particle(&self, pane: usize) -> Option<usize> {
        self.hit(pane).and_then(|(target, _)| target.particle())
    }

    /// Returns the particles that the spring, the rod or the rope under the pointer joins.
    fn link(&self, pane: usize) -> Option<[usize; 2]> {
        let sight = self.sight(self.mouse.position, pane);
        sight.link(self.reach(pane)[1])
    }

    /// Returns where the line of sight through a place (px) in a pane ends.
    fn aim(&self, place: [f32; 2], pane: usize) -> Aim {
        let ground = self.session.runs.panes[pane].show.ground();
        self.sight(place, pane).aim(ground)
    }

    /// Returns whether the pointer is at a place of the picture.
    pub fn is_in_picture(&self) -> bool {
        let picture = |graphics: &Graphics| {
            layout::picture_size(&self.session, graphics.size(), graphics.scale())
        };
        let [x, y] = self.mouse.position;
        self.screen.graphics.as_ref().is_some_and(|graphics| {
            let (width, height) = picture(graphics);
            (0.0..width as f32).contains(&x) && (0.0..height as f32).contains(&y)
        })
    }

    /// Returns whether the pointer is over the picture, where presses act on the scene.
    fn is_over_picture(&self) -> bool {
        let covers = |graphics: &Graphics| graphics.covers(self.mouse.position);
        let is_covered = self.screen.graphics.as_ref().is_some_and(covers);
        let is_free = self.session.list.is_none() && !self.session.readings.help;
        self.is_in_picture() && self.mouse.inside && is_free && !is_covered
    }

    /// Starts the drag of a button at the pointer, with or without Shift.
    pub fn press(&mut self, button: MouseButton, shift: bool) {
        // Ignore a second button.
        if self.mouse.button.is_some() {
            return;
        }
        let (pane, double) = (self.pane(), self.mouse.begin_press());
        let hit = self.hit(pane);
        let particle = hit.and_then(|(target, _)| target.particle());
        let drag = match button {
            MouseButton::Left | MouseButton::Right if shift => {
                Drag::Select { from: self.mouse.position, pinned: button == MouseButton::Left }
            }
            MouseButton::Left if self.session.panel.plotting.is_ruling() => {
                let end = self.ruler_end(pane);
                self.session.panel.plotting.begin_end(end);
                Drag::Rule
            }
            MouseButton::Left if self.session.panel.editor.open => {
                let joins = self.session.panel.editor.tool.joins();
                Drag::Tool(particle.filter(|_| joins))
            }
            MouseButton::Left => {
                if double {
                    let link = self.link(pane).filter(|_| hit.is_none());
                    double_click(&mut self.session, particle, link);
                }
                let runs = &mut self.session.runs;
                match hit {
                    Some((Target::Particle(i), grip)) if runs.grab(i) => Drag::Pull(grip),
                    Some((Target::Obstacle(k), grip)) if runs.grab_obstacle(k) => Drag::Pull(grip),
                    _ => Drag::Orbit,
                }
            }
            MouseButton::Right | MouseButton::Middle => Drag::Pan,
            _ => return,
        };
        self.session.pulled |= matches!(drag, Drag::Pull(_));
        let mouse = &mut self.mouse;
        (mouse.drag, mouse.pane, mouse.button) = (drag, pane, Some(button));
    }

    /// Ends the drag of a button. A right click pins or frees the particle under the pointer.
    pub fn release(&mut self, button: MouseButton) {
        let (pane, drag) = (self.mouse.pane, self.mouse.drag);
        if self.mouse.button != Some(button) {
            return;
        }
        let is_right_click = button == MouseButton::Right && self.mouse.still;
        if is_right_click
            && drag == Drag::Pan
            && let Some(i) = self.particle(pane)
        {
            self.session.toggle_pin(i);
        }
        if let Drag::Tool(from) = drag {
            self.use_tool(from, pane);
        }
        self.finish();
    }

    /// Edits the scene after the button was released in a pane: where it clicked, or between the
    /// particle `from` and that under the pointer.
    fn use_tool(&mut self, from: Option<usize>, pane: usize) {
        let (is_click, position) = (self.mouse.still, self.mouse.position);
        if is_click {
            let aim = Aim {
                target: self.hit(pane).map(|(target, _)| target),
                link: self.link(pane),
                ..self.aim(position, pane)
            };
            click(&mut self.session, &aim);
        } else if let Some(i) = from {
            if let Some(j) = self.particle(pane) {
                join(&mut self.session, [i, j]);
            } else {
                let why = "There is no particle here to join.";
                self.session.readings.say(why);
            }
        } else if self.session.panel.editor.tool.throws() {
            let height = self.screen.tile(&self.session, pane).height as f32;
            let how = Throw {
                speed: f64::from(1.0 + PULL * self.mouse.dragged(position) / height),
                ..Throw::default()
            };
            let aim = self.aim(position, pane);
            edit::throw(&mut self.session, &aim, how);
        }
    }

    /// Throws a ball, with Shift a heavy one, to the pointer or, if that is elsewhere, into the
    /// picture.
    pub fn throw(&mut self, pane: usize) {
        let tile = self.screen.tile(&self.session, pane);
        let middle = [tile.x + tile.width / 2, tile.y + tile.height / 2].map(|px| px as f32);
        let place = if self.is_over_picture() { self.mouse.position } else { middle };
        let aim = self.aim(place, pane);
        let how = Throw {
            mass: if self.modifiers.shift_key() { HEAVY } else { 1.0 },
            ..Throw::default()
        };
        let tool = &mut self.session.panel.editor.tool;
        let chosen = std::mem::replace(tool, Tool::ThrowBall);
        edit::throw(&mut self.session, &aim, how);
        self.session.panel.editor.tool = chosen;
    }

    /// Pins or frees the particle under a finger that has pressed for long, and ends its drag.
    pub fn long_press(&mut self) {
        let pane = self.mouse.pane;
        let pulled = self.session.runs.panes[pane].simulation.grabbed();
        let particle = pulled.or(self.particle(pane));
        self.finish();
        if let Some(i) = particle {
            self.session.toggle_pin(i);
        }
    }

    /// Ends the drag: pins or frees the particles in the box, and releases a grabbed particle or
    /// obstacle.
    pub fn finish(&mut self) {
        if let Drag::Select { from, pinned } = self.mouse.drag
            && self.session.readings.selection.take().is_some()
        {
            let selected = self.selected_particles(from);
            self.session.pin_all(&selected, pinned);
        }
        self.session.release();
        for pane in &mut self.session.runs.panes {
            pane.show.joining = None;
        }
        self.mouse.abort();
    }

    /// Returns the particles in the box from a corner (px), without the walls of tanks.
    fn selected_particles(&self, from: [f32; 2]) -> Vec<usize> {
        let [a, b] = [from, self.mouse.position].map(|at| self.sight(at, self.mouse.pane));
        let (run, project) = (a.run, a.camera.projection(a.aspect));
        let ranges = [0, 1].map(|k| a.at[k].min(b.at[k])..=a.at[k].max(b.at[k]));
        let inside = |at: [f32; 2]| (0..2).all(|k| ranges[k].contains(&at[k]));
        let network = run.model().network();
        let is_wall = |i: usize| network.is_some_and(|network| network.is_wall(i));
        (0..run.particles())
            .filter(|i| {
                let seen = project(show::to_f32(run.position(*i)));
                seen.is_some_and(|(at, _)| inside(at)) && !is_wall(*i)
            })
            .collect()
    }

    /// Pulls the grabbed particle or obstacle to the pointer.
    pub fn pull(&mut self) {
        if let Drag::Pull(grip) = self.mouse.drag {
            let sight = self.sight(self.mouse.position, self.mouse.pane);
            let target = sight.dragged(grip);
            self.session.runs.pull(target);
        }
    }

    /// Moves the pointer, and continues the drag.
    pub fn move_to(&mut self, position: PhysicalPosition<f64>) {
        let position = [position.x as f32, position.y as f32];
        let (pane, was) = (self.mouse.pane, self.mouse.position);
        self.mouse.inside = true;
        if let Some(under) = self.screen.pane_at(&self.session, position) {
            self.session.panel.pane = under;
        }
        // The panel, the bar, lists and the help highlight the row or button under the pointer.
        self.screen.redraw();
        let tile = self.screen.tile(&self.session, pane);
        // Do not move the camera until the pointer is too far for a click.
        let most = MAX_CLICK_DISTANCES[usize::from(self.session.readings.touch)];
        self.mouse.still &= self.mouse.dragged(position) <= most * self.screen.scale();
        if self.mouse.still && self.mouse.drag == Drag::Pan {
            return;
        }
        let throws = self.session.panel.editor.tool.throws();
        if self.mouse.drag == Drag::Tool(None) && !self.mouse.still && !throws {
            self.mouse.drag = Drag::Orbit;
        }
        let ([x, y], [was_x, was_y]) = (tile.place(position), tile.place(was));
        let (dx, dy, aspect) = (x - was_x, y - was_y, tile.aspect());
        self.mouse.position = position;
        let camera = &mut self.session.view.camera;
        match self.mouse.drag {
            Drag::Orbit => {
                // From below, the lines of the floor would lie over the scene.
                let ground = self.session.runs.panes[pane].show.ground();
                let lowest =
                    ground.map_or(f32::MIN, |height| height as f32 + ABOVE_GROUND * camera.unit());
                camera.orbit_above(-ORBIT_ANGLE * dx * aspect, ORBIT_ANGLE * dy, lowest);
            }
            Drag::Pan => camera.pan(-dx * aspect, dy),
            Drag::Select { from, pinned } => {
                let scale = self.screen.scale();
                self.session.readings.selection = Some(Selection {
                    corners: [from, position].map(|at| at.map(|px| px / scale)),
                    count: self.selected_particles(from).len(),
                    pinned,
                });
            }
            Drag::Rule if !self.mouse.still => {
                let end = self.ruler_end(pane);
                self.session.panel.plotting.move_end(end);
            }
            Drag::Tool(Some(i)) => {
                let run = &self.session.runs.panes[pane].simulation;
                let at = self.particle(pane).map(|j| run.position(j));
                let end = at.or_else(|| self.beside(run.position(i), pane));
                self.session.runs.panes[pane].show.joining = end.map(|end| (i, end));
            }
            Drag::Pull(_) | Drag::Tool(None) | Drag::Rule | Drag::None => {}
        }
    }

    /// Returns the point at the pointer that is as deep in the picture of a pane as another one
    /// (m), if that is seen.
    fn beside(&self, other: Vector3<f64>, pane: usize) -> Option<Vector3<f64>> {
        let sight = self.sight(self.mouse.position, pane);
        let (_, depth) = sight.camera.project(show::to_f32(other), sight.aspect)?;
        Some(sight.point(depth))
    }

    /// Returns the end of the ruler at the pointer: a particle, or a point in the plane of the
    /// other end, or else of the centre of the view, that is parallel to the picture.
    fn ruler_end(&self, pane: usize) -> RulerEnd {
        if let Some(i) = self.particle(pane) {
            return RulerEnd::Particle(i);
        }
        let sight = self.sight(self.mouse.position, pane);
        let ruler = self.session.panel.plotting.ruler.iter().flatten().next();
        let other = ruler.and_then(|end| end.place(sight.run));
        let centre = sight.camera.target().coords.into();
        let through = other.map_or(centre, show::to_f32);
        let seen = sight.camera.project(through, sight.aspect);
        RulerEnd::Point(sight.point(seen.map_or(1.0, |(_, distance)| distance)))
    }

    /// Zooms the camera towards the pointer by the notches of the wheel.
    pub fn scroll(&mut self, delta: MouseScrollDelta) {
        let notches = match delta {
            MouseScrollDelta::LineDelta(_, y) => y,
            MouseScrollDelta::PixelDelta(p) => p.y as f32 / PIXELS_PER_NOTCH,
        };
        let tile = self.screen.tile(&self.session, self.pane());
        let (at, factor) = (tile.place(self.mouse.position), 0.9f32.powf(notches));
        let camera = &mut self.session.view.camera;
        camera.zoom_at(factor, at, tile.aspect());
    }

    /// Finds what is under the pointer, and sets the pointer's shape and the highlight. Returns
    /// whether shape or highlight changed.
    pub fn update_hover(&mut self) -> bool {
        let (at, panel) = (self.pane(), &self.session.panel);
        let boxes = self.modifiers.shift_key() || panel.plotting.is_ruling();
        let (cursor, hovered) = match self.mouse.drag {
            Drag::Pull(_) => (CursorIcon::Grabbing, None),
            Drag::Orbit => (CursorIcon::AllScroll, None),
            Drag::Pan => (CursorIcon::Move, None),
            Drag::Select { .. } | Drag::Rule => (CursorIcon::Crosshair, None),
            Drag::Tool(_) => (CursorIcon::Crosshair, self.tool_target(at)),
            Drag::None if !self.is_over_picture() => (CursorIcon::Default, None),
            Drag::None if boxes => (CursorIcon::Crosshair, None),
            Drag::None if panel.editor.open => (CursorIcon::Crosshair, self.tool_target(at)),
            Drag::None => match self.hit(at).map(|(target, _)| target) {
                Some(target @ Target::Particle(_)) => (CursorIcon::Grab, Some(target)),
                Some(target @ Target::Obstacle(_)) => (CursorIcon::Move, Some(target)),
                None => (CursorIcon::Default, None),
            },
        };
        let mut changed = self.mouse.cursor != cursor;
        self.mouse.cursor = cursor;
        for (k, pane) in self.session.runs.panes.iter_mut().enumerate() {
            let hovered = hovered.filter(|_| k == at);
            changed |= pane.show.hovered != hovered;
            pane.show.hovered = hovered;
        }
        changed
    }

    /// Returns what the chosen tool would act on under the pointer, if it acts on something.
    fn tool_target(&self, pane: usize) -> Option<Target> {
        let (hit, _) = self.hit(pane)?;
        match self.session.panel.editor.tool {
            Tool::Delete => Some(hit),
            tool if tool.joins() => Some(hit).filter(|hit| hit.particle().is_some()),
            _ => None,
        }
    }
}

/// Lists the springs of a particle, and with the plots open plots it, or the link between two
/// particles. Without either, which is on the background, closes the list.
fn double_click(session: &mut Session, particle: Option<usize>, link: Option<[usize; 2]>) {
    if link.is_none() {
        let panes = &mut session.runs.panes;
        looks::each(panes, |show| show.springs_of = particle);
    }
    if let Some(request) = plotting::picked(session, particle, link) {
        apply(session, request, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{Pick, RunAction, session};

    #[test]
    fn a_double_click_on_a_link_plots_it_and_leaves_the_list_of_springs() {
        let mut session = session(&["r", "0.01", "--scene", "cloth"]);
        session.act(RunAction::Plots, 0);
        let state = |session: &Session| {
            let pane = &session.runs.panes[0];
            let picks: Vec<_> = pane.traces.iter().map(|(pick, _)| *pick).collect();
            (pane.show.springs_of, picks)
        };
        let (particle, spring) = (Pick::Particle(210), Pick::Spring(210, 211));
        double_click(&mut session, Some(210), None);
        assert_eq!(state(&session), (Some(210), vec![particle]));
        double_click(&mut session, None, Some([210, 211]));
        assert_eq!(state(&session), (Some(210), vec![particle, spring]));
        double_click(&mut session, None, None);
        assert_eq!(state(&session), (None, vec![particle, spring]));
    }
}
