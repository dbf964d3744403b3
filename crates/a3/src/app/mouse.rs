//! Actions of the mouse: pull, turn, move, pin, and drag the timeline.

use winit::dpi::PhysicalPosition;
use winit::event::{MouseButton, MouseScrollDelta};

use super::pick::{self, Grip};
use super::pointer::Drag;
use super::state::App;
use crate::hud::layout;
use crate::session::{Selection, looks};
use crate::show::{self, Target};

/// Distance from the pointer within which a particle is hit (points).
const REACH: f32 = 18.0;
/// The farthest that the pointer may move during a click (points).
pub(super) const CLICK: f32 = 4.0;
/// Angle by which the camera turns when the pointer moves by the height of the picture (rad).
const TURN: f32 = 4.0;
/// Pixels of smooth scrolling that count as a notch of the wheel.
const NOTCH: f32 = 50.0;

impl App {
    /// Begins what a button does where the pointer is.
    pub fn press(&mut self, button: MouseButton) {
        // One button at a time.
        if self.mouse.button.is_some() {
            return;
        }
        let pane = self.pointed();
        let double = self.mouse.press();
        let share = self.timeline_share(CLICK);
        let hit = self.hit(pane);
        let session = &mut self.session;
        let select = |pinned| Drag::Select {
            from: self.mouse.pointer,
            pinned,
        };
        let drag = match button {
            MouseButton::Left | MouseButton::Right if self.shift => {
                select(button == MouseButton::Left)
            }
            MouseButton::Left if share.is_some() => {
                session.scrub_to(share.unwrap_or(1.0));
                Drag::Scrub
            }
            MouseButton::Left => {
                let particle = hit.and_then(|(target, _)| match target {
                    Target::Particle(i) => Some(i),
                    Target::Obstacle(_) => None,
                });
                if double {
                    looks::show_springs_of(&mut session.runs.panes, particle);
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
        (self.mouse.drag, self.mouse.pane, self.mouse.button) = (drag, pane, Some(button));
    }

    /// The particle or the obstacle under the pointer in a pane. A lost run cannot be pulled.
    pub(super) fn hit(&self, pane: usize) -> Option<(Target, Grip)> {
        let (tile, pane) = (self.tile(pane), &self.session.runs.panes[pane]);
        let reach = REACH * self.scale() / tile.height as f32;
        let place = tile.place(self.mouse.pointer);
        let run = Some(&pane.simulation).filter(|_| pane.alive())?;
        pick::pick(run, &self.session.view.camera, place, tile.aspect(), reach)
    }

    /// The share of the timeline at which the pointer is, if the timeline is shown and the pointer
    /// no farther from it than `margin` (points).
    pub(super) fn timeline_share(&self, margin: f32) -> Option<f32> {
        let graphics = self.graphics.as_ref()?;
        self.session.readings.rewound?;
        let (scale, size) = (graphics.scale(), graphics.size());
        let size = [size.0, size.1].map(|side| side as f32 / scale);
        let [x, y] = self.mouse.pointer.map(|px| px / scale);
        let [left, top, width, height] = layout::timeline(size);
        let (from, to) = layout::track(left, width);
        let inside = x > left - margin
            && x < left + width + margin
            && y > top - margin
            && y < top + height + margin;
        inside.then_some(((x - from) / (to - from)).clamp(0.0, 1.0))
    }

    /// Pins the particle under the pointer, or frees it.
    pub fn click(&mut self) {
        if let Some((Target::Particle(i), _)) = self.hit(self.mouse.pane) {
            self.session.toggle_pin(i);
        }
    }

    /// The particles in the box that is drawn, walls of tanks left out.
    fn boxed(&self) -> Vec<usize> {
        let Drag::Select { from, .. } = self.mouse.drag else {
            return vec![];
        };
        let (tile, to) = (self.tile(self.mouse.pane), self.mouse.pointer);
        let run = &self.session.runs.panes[self.mouse.pane].simulation;
        let (a, b) = (tile.place(from), tile.place(to));
        let inside =
            |at: [f32; 2]| (0..2).all(|k| (a[k].min(b[k])..=a[k].max(b[k])).contains(&at[k]));
        let network = run.model().network();
        let is_wall = |i: usize| network.is_some_and(|network| network.is_wall(i));
        let project = self.session.view.camera.projection(tile.aspect());
        (0..run.particles())
            .filter(|i| {
                let seen = project(show::to_f32(run.position(*i)));
                seen.is_some_and(|(at, _)| inside(at)) && !is_wall(*i)
            })
            .collect()
    }

    /// Shows the box, and how many particles are in it.
    fn look_into_box(&mut self) {
        let scale = self.scale();
        if let Drag::Select { from, pinned } = self.mouse.drag {
            let corners = [from, self.mouse.pointer].map(|at| at.map(|px| px / scale));
            let count = self.boxed().len();
            self.session.readings.selection = Some(Selection {
                corners,
                count,
                pinned,
            });
        }
    }

    /// Pins what is in the box, or lets go of it.
    fn take_box(&mut self) {
        if let Drag::Select { pinned, .. } = self.mouse.drag
            && self.session.readings.selection.take().is_some()
        {
            let particles = self.boxed();
            self.session.pin_all(&particles, pinned);
        }
    }

    /// Ends what the pressed button does.
    pub fn let_go(&mut self) {
        self.take_box();
        self.session.release();
        self.mouse.let_go();
    }

    /// Moves the pointer, and what the pressed button holds.
    pub fn move_to(&mut self, position: PhysicalPosition<f64>) {
        let pointer = [position.x as f32, position.y as f32];
        if self.session.panel.open {
            let panes = 0..self.session.runs.panes.len();
            let under = panes.into_iter().find(|k| self.tile(*k).contains(pointer));
            self.session.panel.pane = under.unwrap_or(self.session.panel.pane);
            // The row under the pointer is drawn in another colour.
            self.redraw();
        }
        let tile = self.tile(self.mouse.pane);
        // A click moves nothing until the pointer has gone too far for one.
        self.mouse.move_to(pointer, CLICK * self.scale());
        if self.mouse.is_click() && self.mouse.drag == Drag::Pan {
            return;
        }
        let ([x, y], [was_x, was_y]) = (tile.place(pointer), tile.place(self.mouse.pointer));
        let (dx, dy, aspect) = (x - was_x, y - was_y, tile.aspect());
        self.mouse.pointer = pointer;
        match self.mouse.drag {
            Drag::Orbit => self
                .session
                .view
                .camera
                .orbit(-TURN * dx * aspect, TURN * dy),
            Drag::Pan => self.session.view.camera.pan(-dx * aspect, dy),
            Drag::Scrub => {
                if let Some(share) = self.timeline_share(f32::INFINITY) {
                    self.session.scrub_to(share);
                }
            }
            Drag::Select { .. } => self.look_into_box(),
            Drag::Pull(_) | Drag::None => return,
        }
        self.redraw();
    }

    /// Zooms to the pointer by the notches of the wheel.
    pub fn scroll(&mut self, delta: MouseScrollDelta) {
        let notches = match delta {
            MouseScrollDelta::LineDelta(_, y) => y,
            MouseScrollDelta::PixelDelta(p) => p.y as f32 / NOTCH,
        };
        let tile = self.tile(self.pointed());
        let at = tile.place(self.mouse.pointer);
        let factor = 0.9f32.powf(notches);
        self.session.view.camera.zoom_at(factor, at, tile.aspect());
    }
}
