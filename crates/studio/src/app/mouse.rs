//! Actions of the mouse: pulling, turning and moving the camera, and pinning.

use a3_core::Vector3;
use a3_media::show::{self, Target};
use a3_render::Camera;
use egui::CursorIcon;
use web_time::{Duration, Instant};
use winit::dpi::PhysicalPosition;
use winit::event::{MouseButton, MouseScrollDelta};

use super::pick::Grip;
use super::pointer::Pointer;
use super::screen::Screen;
use super::tool;
use crate::hud::plotting;
use crate::session::{RulerEnd, Selection, Session, apply, looks};

/// Largest motion of the pointer during a click of the mouse, and of a finger (points).
const MAX_CLICK_DISTANCES: [f32; 2] = [4.0, 10.0];
/// Angle by which the camera turns when the pointer moves by the height of the picture (rad).
const ORBIT_ANGLE: f32 = 4.0;
/// Least height of the eye above the ground to which a drag turns it, in units of length.
const ABOVE_GROUND: f32 = 0.05;
/// Time after which a finger that has not moved pins.
const LONG_PRESS: Duration = Duration::from_millis(550);
/// Smooth scrolling that counts as a notch of the wheel (px).
const PIXELS_PER_NOTCH: f32 = 50.0;

/// A drag: the effect of a pressed button while the pointer moves.
#[derive(Clone, Copy, PartialEq)]
pub enum Drag {
    /// No action.
    None,
    /// Pull a particle or push an obstacle.
    Pull(Grip),
    /// Turn the camera.
    Orbit,
    /// Move the camera.
    Pan,
    /// Move an end of the ruler.
    Rule,
    /// Edit the scene by a click, or join a particle to another one by a drag.
    Tool(Option<usize>),
    /// Pin or free the particles in a box between the corner `from` (px) and the pointer.
    Select { from: [f32; 2], pinned: bool },
}

/// The mouse.
pub struct Mouse {
    pub pointer: Pointer,
    /// The present drag.
    pub drag: Drag,
    /// The pane in which the button was pressed.
    pane: usize,
    /// The pressed button: the first one, if there are several.
    pub button: Option<MouseButton>,
    /// The shape of the pointer over the picture.
    pub cursor: CursorIcon,
}

impl Mouse {
    /// Creates a mouse outside the window, with no button pressed.
    pub fn new() -> Self {
        Self {
            pointer: Pointer::new(),
            drag: Drag::None,
            pane: 0,
            button: None,
            cursor: CursorIcon::Default,
        }
    }

    /// Starts the drag of a button at the pointer, with or without Shift.
    pub fn press(
        &mut self,
        button: MouseButton,
        shift: bool,
        session: &mut Session,
        screen: &Screen,
    ) {
        // Ignore a second button.
        if self.button.is_some() {
            return;
        }
        let pane = self.pointer.pane(session, screen);
        let double = self.pointer.press();
        let hit = self.pointer.hit(session, screen, pane);
        let select = |pinned| Drag::Select {
            from: self.pointer.position,
            pinned,
        };
        let drag = match button {
            MouseButton::Left | MouseButton::Right if shift => select(button == MouseButton::Left),
            MouseButton::Left if session.panel.plotting.is_ruling() => {
                let end = self.ruler_end(session, screen, pane);
                session.panel.plotting.begin_end(end);
                Drag::Rule
            }
            MouseButton::Left if session.panel.editor.open => {
                let joins = session.panel.editor.tool.joins();
                let particle = hit.and_then(|(target, _)| target.particle());
                Drag::Tool(particle.filter(|_| joins))
            }
            MouseButton::Left => {
                if double {
                    let particle = hit.and_then(|(target, _)| target.particle());
                    let link = tool::link_at(&self.pointer, session, screen, pane);
                    let link = link.filter(|_| hit.is_none());
                    double_click(session, particle, link);
                }
                match hit {
                    Some((Target::Particle(i), grip)) if session.runs.grab(i) => Drag::Pull(grip),
                    Some((Target::Obstacle(k), grip)) if session.runs.grab_obstacle(k) => {
                        Drag::Pull(grip)
                    }
                    _ => Drag::Orbit,
                }
            }
            MouseButton::Right | MouseButton::Middle => Drag::Pan,
            _ => return,
        };
        session.pulled |= matches!(drag, Drag::Pull(_));
        (self.drag, self.pane, self.button) = (drag, pane, Some(button));
    }

    /// Ends the drag of a button. A right click pins or frees the particle under the pointer.
    pub fn release(&mut self, button: MouseButton, session: &mut Session, screen: &Screen) {
        if self.button != Some(button) {
            return;
        }
        if button == MouseButton::Right
            && self.pointer.is_click()
            && self.drag == Drag::Pan
            && let Some((Target::Particle(i), _)) = self.pointer.hit(session, screen, self.pane)
        {
            session.toggle_pin(i);
        }
        if let Drag::Tool(from) = self.drag {
            tool::release(&self.pointer, from, session, screen, self.pane);
        }
        self.finish(session, screen);
    }

    /// Returns when a finger that has not moved since it came down has pressed for long, and pins.
    pub fn long_press_at(&self) -> Option<Instant> {
        let is_still = matches!(self.drag, Drag::Pull(_) | Drag::Orbit) && self.pointer.is_click();
        is_still.then(|| self.pointer.pressed() + LONG_PRESS)
    }

    /// Pins or frees the particle under a finger that has pressed for long, and ends its drag.
    pub fn long_press(&mut self, session: &mut Session, screen: &Screen) {
        let pulled = session.runs.panes[self.pane].simulation.grabbed();
        let hit = self.pointer.hit(session, screen, self.pane);
        let particle = pulled.or(hit.and_then(|(target, _)| target.particle()));
        self.finish(session, screen);
        if let Some(i) = particle {
            session.toggle_pin(i);
        }
    }

    /// Ends the drag: pins or frees the particles in the box, and releases a grabbed particle or
    /// obstacle.
    pub fn finish(&mut self, session: &mut Session, screen: &Screen) {
        if let Drag::Select { pinned, .. } = self.drag
            && session.readings.selection.take().is_some()
        {
            session.pin_all(&self.selected_particles(session, screen), pinned);
        }
        session.release();
        for pane in &mut session.runs.panes {
            pane.show.joining = None;
        }
        self.abort();
    }

    /// Ends the drag without an effect on the session.
    pub fn abort(&mut self) {
        // Another session may have fewer panes.
        (self.drag, self.button, self.pane) = (Drag::None, None, 0);
    }

    /// Returns the particles in the box, without the walls of tanks.
    fn selected_particles(&self, session: &Session, screen: &Screen) -> Vec<usize> {
        let Drag::Select { from, .. } = self.drag else {
            return vec![];
        };
        let (tile, to) = (screen.tile(session, self.pane), self.pointer.position);
        let run = &session.runs.panes[self.pane].simulation;
        let (a, b) = (tile.place(from), tile.place(to));
        let inside =
            |at: [f32; 2]| (0..2).all(|k| (a[k].min(b[k])..=a[k].max(b[k])).contains(&at[k]));
        let network = run.model().network();
        let is_wall = |i: usize| network.is_some_and(|network| network.is_wall(i));
        let project = session.view.camera.projection(tile.aspect());
        (0..run.particles())
            .filter(|i| {
                let seen = project(show::to_f32(run.position(*i)));
                seen.is_some_and(|(at, _)| inside(at)) && !is_wall(*i)
            })
            .collect()
    }

    /// Returns the point (m) to which the pointer pulls the grabbed particle or obstacle.
    pub fn target(&self, session: &Session, screen: &Screen) -> Option<Vector3<f64>> {
        let Drag::Pull(grip) = self.drag else {
            return None;
        };
        let tile = screen.tile(session, self.pane);
        let place = tile.place(self.pointer.position);
        let target = grip.target(&session.view.camera, place, tile.aspect());
        Some(Vector3::from(target).cast())
    }

    /// Moves the pointer, and continues the drag.
    pub fn move_to(
        &mut self,
        position: PhysicalPosition<f64>,
        session: &mut Session,
        screen: &Screen,
    ) {
        let position = [position.x as f32, position.y as f32];
        self.pointer.inside = true;
        let under = screen.pane_at(session, position);
        session.panel.pane = under.unwrap_or(session.panel.pane);
        // The panel, the bar, lists and the help highlight the row or button under the pointer.
        screen.redraw();
        let tile = screen.tile(session, self.pane);
        // Do not move the camera until the pointer is too far for a click.
        let still = MAX_CLICK_DISTANCES[usize::from(session.readings.touch)];
        self.pointer.update_click(position, still * screen.scale());
        if self.pointer.is_click() && self.drag == Drag::Pan {
            return;
        }
        let throws = session.panel.editor.tool.throws();
        if self.drag == Drag::Tool(None) && !self.pointer.is_click() && !throws {
            self.drag = Drag::Orbit;
        }
        let ([x, y], [was_x, was_y]) = (tile.place(position), tile.place(self.pointer.position));
        let (dx, dy, aspect) = (x - was_x, y - was_y, tile.aspect());
        self.pointer.position = position;
        if self.drag == Drag::Rule && !self.pointer.is_click() {
            let end = self.ruler_end(session, screen, self.pane);
            session.panel.plotting.move_end(end);
        }
        let camera = &mut session.view.camera;
        match self.drag {
            Drag::Orbit => {
                // From below, the lines of the floor would lie over the scene.
                let ground = session.runs.panes[self.pane].show.ground();
                let lowest = ground.map_or(f32::MIN, |height| {
                    height as f32 + ABOVE_GROUND * camera.unit()
                });
                camera.orbit_above(-ORBIT_ANGLE * dx * aspect, ORBIT_ANGLE * dy, lowest);
            }
            Drag::Pan => camera.pan(-dx * aspect, dy),
            Drag::Select { from, pinned } => {
                let scale = screen.scale();
                session.readings.selection = Some(Selection {
                    corners: [from, position].map(|at| at.map(|px| px / scale)),
                    count: self.selected_particles(session, screen).len(),
                    pinned,
                });
            }
            Drag::Tool(Some(i)) => {
                let end = tool::end(&self.pointer, i, session, screen, self.pane);
                session.runs.panes[self.pane].show.joining = end.map(|end| (i, end));
            }
            Drag::Pull(_) | Drag::Tool(None) | Drag::Rule | Drag::None => {}
        }
    }

    /// Returns the end of the ruler at the pointer: a particle, or a point in the plane of the
    /// other end, or else of the centre of the view, that is parallel to the picture.
    fn ruler_end(&self, session: &Session, screen: &Screen, pane: usize) -> RulerEnd {
        let hit = self.pointer.hit(session, screen, pane);
        if let Some(i) = hit.and_then(|(target, _)| target.particle()) {
            return RulerEnd::Particle(i);
        }
        let (tile, camera) = (screen.tile(session, pane), &session.view.camera);
        let ruler = session.panel.plotting.ruler.as_deref().unwrap_or_default();
        let run = &session.runs.panes[pane].simulation;
        let other = ruler.first().and_then(|end| end.place(run));
        let through = other.map_or(camera.target().coords.into(), show::to_f32);
        let distance = camera.project(through, tile.aspect());
        let distance = distance.map_or(1.0, |(_, distance)| distance);
        let at = tile.place(self.pointer.position);
        let point = camera.unproject(at, distance, tile.aspect());
        RulerEnd::Point(Vector3::from(point).cast())
    }

    /// Returns the camera zoomed towards the pointer by the notches of the wheel.
    pub fn scroll(&self, delta: MouseScrollDelta, session: &Session, screen: &Screen) -> Camera {
        let notches = match delta {
            MouseScrollDelta::LineDelta(_, y) => y,
            MouseScrollDelta::PixelDelta(p) => p.y as f32 / PIXELS_PER_NOTCH,
        };
        let tile = screen.tile(session, self.pointer.pane(session, screen));
        let at = tile.place(self.pointer.position);
        let (factor, mut camera) = (0.9f32.powf(notches), session.view.camera);
        camera.zoom_at(factor, at, tile.aspect());
        camera
    }
}

/// Lists the springs of a particle, and with the plots open plots it, or the link between two
/// particles. Without either, which is on the background, closes the list.
fn double_click(session: &mut Session, particle: Option<usize>, link: Option<[usize; 2]>) {
    if link.is_none() {
        looks::show_springs_of(&mut session.runs.panes, particle);
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
