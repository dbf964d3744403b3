//! The mouse pointer: its position, what is under it, and whether a button clicks or drags.

use a3_media::show::Target;
use web_time::{Duration, Instant};

use super::pick::{self, Grip};
use super::screen::Screen;
use crate::hud::layout;
use crate::session::Session;

/// Distance from the pointer within which a particle is picked (points).
const PICK_DISTANCE: f32 = 18.0;
/// Longest time between the two presses of a double click.
const MAX_DOUBLE_CLICK_TIME: Duration = Duration::from_millis(400);

/// The pointer.
pub struct Pointer {
    /// Position (px from the left and from the top of the window).
    pub position: [f32; 2],
    /// Whether the pointer is in the window.
    pub inside: bool,
    /// Position when the button was pressed (px).
    pressed_at: [f32; 2],
    /// Time when the button was pressed.
    pressed: Instant,
    /// Whether the pointer has stayed near that position, as in a click.
    still: bool,
}

impl Pointer {
    /// Creates a pointer outside the window.
    pub fn new() -> Self {
        Self {
            position: [0.0; 2],
            inside: false,
            pressed_at: [f32::INFINITY; 2],
            pressed: Instant::now(),
            still: false,
        }
    }

    /// Notes that a button was pressed, and returns whether this is a double click.
    pub fn press(&mut self) -> bool {
        let double = self.still && self.pressed.elapsed() < MAX_DOUBLE_CLICK_TIME;
        (self.pressed_at, self.pressed, self.still) = (self.position, Instant::now(), true);
        double
    }

    /// Makes the click a drag if `position` is farther (px) than `most` from where the button was
    /// pressed.
    pub fn update_click(&mut self, position: [f32; 2], most: f32) {
        let [x, y] = [0, 1].map(|k| position[k] - self.pressed_at[k]);
        self.still &= x.hypot(y) <= most;
    }

    /// Returns when the button was pressed.
    pub fn pressed(&self) -> Instant {
        self.pressed
    }

    /// Returns whether the pressed button has not dragged so far.
    pub fn is_click(&self) -> bool {
        self.still
    }

    /// Returns the length of the drag of the pressed button (px).
    pub fn dragged(&self) -> f32 {
        let [x, y] = [0, 1].map(|k| self.position[k] - self.pressed_at[k]);
        if self.still { 0.0 } else { x.hypot(y) }
    }

    /// Returns the pane under the pointer, or else the pane that it was over last.
    pub fn pane(&self, session: &Session, screen: &Screen) -> usize {
        let last = session.panel.pane.min(session.runs.panes.len() - 1);
        screen.pane_at(session, self.position).unwrap_or(last)
    }

    /// Returns the particle or obstacle under the pointer in a pane; `None` in a diverged run.
    pub fn hit(&self, session: &Session, screen: &Screen, pane: usize) -> Option<(Target, Grip)> {
        let (tile, pane) = (screen.tile(session, pane), &session.runs.panes[pane]);
        let reach = PICK_DISTANCE * screen.scale() / tile.height as f32;
        let place = tile.place(self.position);
        let run = Some(&pane.simulation).filter(|_| pane.alive())?;
        pick::pick(run, &session.view.camera, place, tile.aspect(), reach)
    }

    /// Returns whether the position is in the picture, in a window of `size` (px) at `scale` pixels
    /// per point.
    pub fn is_in_picture(&self, session: &Session, size: (u32, u32), scale: f32) -> bool {
        let ([x, y], free) = (self.position, layout::picture_size(session, size, scale));
        (0.0..free.0 as f32).contains(&x) && (0.0..free.1 as f32).contains(&y)
    }

    /// Returns whether the pointer is over the picture, where presses act on the scene.
    pub fn is_over_picture(&self, session: &Session, screen: &Screen) -> bool {
        let Some(graphics) = &screen.graphics else {
            return false;
        };
        let inside = self.is_in_picture(session, graphics.size(), graphics.scale());
        let is_free = session.list.is_none() && !session.readings.help;
        inside && self.inside && is_free && !graphics.covers(self.position)
    }
}
