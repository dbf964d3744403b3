//! The state of the mouse: its pointer, its buttons and its drag.

use egui::CursorIcon;
use web_time::{Duration, Instant};
use winit::event::MouseButton;

use super::pick::Grip;

/// Longest time between the two presses of a double click.
const MAX_DOUBLE_CLICK_TIME: Duration = Duration::from_millis(400);
/// Time after which a finger that has not moved pins.
const LONG_PRESS: Duration = Duration::from_millis(550);

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
    /// Position of the pointer (px from the left and from the top of the window).
    pub position: [f32; 2],
    /// Whether the pointer is in the window.
    pub inside: bool,
    /// The present drag.
    pub drag: Drag,
    /// The pane in which the button was pressed, at a position (px) and a time.
    pub pane: usize,
    pressed_at: [f32; 2],
    pressed: Instant,
    /// Whether the pointer has stayed near that position, as in a click.
    pub still: bool,
    /// The pressed button: the first one, if there are several.
    pub button: Option<MouseButton>,
    /// The shape of the pointer over the picture.
    pub cursor: CursorIcon,
}

impl Mouse {
    /// Creates a mouse outside the window, with no button pressed.
    pub fn new() -> Self {
        Self {
            position: [0.0; 2],
            inside: false,
            drag: Drag::None,
            pane: 0,
            pressed_at: [f32::INFINITY; 2],
            pressed: Instant::now(),
            still: false,
            button: None,
            cursor: CursorIcon::Default,
        }
    }

    /// Notes that a button was pressed, and returns whether this is a double click.
    pub fn begin_press(&mut self) -> bool {
        let double = self.still && self.pressed.elapsed() < MAX_DOUBLE_CLICK_TIME;
        (self.pressed_at, self.pressed, self.still) = (self.position, Instant::now(), true);
        double
    }

    /// Returns the distance of a position from that where the button was pressed (px).
    pub fn dragged(&self, position: [f32; 2]) -> f32 {
        let [x, y] = [0, 1].map(|k| position[k] - self.pressed_at[k]);
        x.hypot(y)
    }

    /// Returns when a finger that has not moved since it came down has pressed for long, and pins.
    pub fn long_press_at(&self) -> Option<Instant> {
        let is_still = matches!(self.drag, Drag::Pull(_) | Drag::Orbit) && self.still;
        is_still.then(|| self.pressed + LONG_PRESS)
    }

    /// Ends the drag without an effect on the session.
    pub fn abort(&mut self) {
        // Another session may have fewer panes.
        (self.drag, self.button, self.pane) = (Drag::None, None, 0);
    }
}
