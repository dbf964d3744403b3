//! The mouse: the position of its pointer, and the drag by a pressed button.

use web_time::{Duration, Instant};

use winit::event::MouseButton;

use super::pick::Grip;

/// The longest time between the two clicks of a double click.
const DOUBLE_CLICK: Duration = Duration::from_millis(400);

/// A drag: the action of a pressed button while the pointer moves.
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
    /// Go along the timeline.
    Scrub,
    /// Pin what is in a box from there (px) to the pointer, or let go of it.
    Select { from: [f32; 2], pinned: bool },
}

/// The mouse.
pub struct Mouse {
    /// Position of the pointer (px from the left and from the top of the window).
    pub pointer: [f32; 2],
    /// Whether the pointer is in the window.
    pub inside: bool,
    /// The drag by the pressed button.
    pub drag: Drag,
    /// The pane in which the button was pressed.
    pub pane: usize,
    /// The button that is pressed: the first one, if there are several.
    pub button: Option<MouseButton>,
    /// Position of the pointer when the button was pressed (px).
    pressed_at: [f32; 2],
    /// Time when the button was pressed.
    pressed: Instant,
    /// Whether the pointer has stayed near that position: it is a click, not a drag.
    still: bool,
}

impl Mouse {
    /// A mouse of which nothing is known yet.
    pub fn new() -> Self {
        Self {
            pointer: [0.0; 2],
            inside: false,
            drag: Drag::None,
            pane: 0,
            button: None,
            pressed_at: [f32::INFINITY; 2],
            pressed: Instant::now(),
            still: false,
        }
    }

    /// Notes that a button was pressed, and returns whether that is the second of a double click.
    pub fn press(&mut self) -> bool {
        let double = self.still && self.pressed.elapsed() < DOUBLE_CLICK;
        (self.pressed_at, self.pressed, self.still) = (self.pointer, Instant::now(), true);
        double
    }

    /// Notes where the pointer goes. Beyond `reach` (px) from where the button was pressed, the
    /// click becomes a drag.
    pub fn move_to(&mut self, pointer: [f32; 2], reach: f32) {
        let [x, y] = [0, 1].map(|k| pointer[k] - self.pressed_at[k]);
        self.still &= x.hypot(y) <= reach;
    }

    /// Whether the pressed button clicks until now, and does not drag.
    pub fn is_click(&self) -> bool {
        self.still
    }

    /// Ends what the button does.
    pub fn let_go(&mut self) {
        (self.drag, self.button) = (Drag::None, None);
    }
}
