//! Fingers: one pulls, pushes or turns, as the left button does, or pins by a long press; two move
//! and zoom the view.

use a3_render::{Camera, Tile};
use winit::event::{Touch, TouchPhase};

/// The fingers on the screen.
#[derive(Default)]
pub struct Fingers {
    /// Identities and positions (px), in the order in which they came.
    down: Vec<(u64, [f32; 2])>,
    gesture: Gesture,
}

/// What the fingers do, until all are lifted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Gesture {
    /// Nothing, or what egui makes of it.
    #[default]
    None,
    /// One finger does what the left button would do.
    Press,
    /// Two fingers move and zoom the view.
    Pinch,
}

/// What a change of a finger does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effect {
    Nothing,
    /// Press the left button.
    Press,
    /// Move the pressed pointer.
    Move,
    /// Release the left button.
    Release,
    /// End what the button does, for two fingers.
    Finish,
    /// Move a finger from one place to another (px) while the second one stays at the third.
    Pinch([[f32; 2]; 3]),
}

impl Fingers {
    /// Returns whether a touch is of the first finger, which comes down.
    pub fn begins(&self, touch: &Touch) -> bool {
        self.down.is_empty() && touch.phase == TouchPhase::Started
    }

    /// Returns whether one finger does what the left button would do.
    pub fn is_pressing(&self) -> bool {
        self.gesture == Gesture::Press
    }

    /// Ends what the finger does, until it is lifted.
    pub fn end_press(&mut self) {
        self.gesture = Gesture::None;
    }

    /// Handles a change of a finger at a place (px), which is `taken` if text or a button is there.
    pub fn change(&mut self, id: u64, phase: TouchPhase, at: [f32; 2], taken: bool) -> Effect {
        let known = self.down.iter().position(|(other, _)| *other == id);
        match (phase, known) {
            (TouchPhase::Started, None) => {
                self.down.push((id, at));
                match (self.down.len(), self.gesture) {
                    (1, _) if !taken => {
                        self.gesture = Gesture::Press;
                        Effect::Press
                    }
                    (2, Gesture::Press) => {
                        self.gesture = Gesture::Pinch;
                        Effect::Finish
                    }
                    _ => Effect::Nothing,
                }
            }
            (TouchPhase::Moved, Some(k)) => {
                let before = std::mem::replace(&mut self.down[k].1, at);
                match self.gesture {
                    Gesture::Press => Effect::Move,
                    Gesture::Pinch if k < 2 && self.down.len() > 1 => {
                        Effect::Pinch([before, at, self.down[1 - k].1])
                    }
                    _ => Effect::Nothing,
                }
            }
            (TouchPhase::Ended | TouchPhase::Cancelled, Some(k)) => {
                self.down.remove(k);
                let was = self.gesture;
                if self.down.is_empty() {
                    self.gesture = Gesture::None;
                }
                if was == Gesture::Press { Effect::Release } else { Effect::Nothing }
            }
            _ => Effect::Nothing,
        }
    }
}

/// Returns the place of a finger (px).
pub fn position(touch: &Touch) -> [f32; 2] {
    [touch.location.x as f32, touch.location.y as f32]
}

/// Moves and zooms the view in a tile as a finger moves from one place to another (px) while the
/// second one stays at the third, so that the points of the scene under both stay under them.
pub fn pinch(camera: &mut Camera, tile: Tile, [from, to, other]: [[f32; 2]; 3]) {
    let aspect = tile.aspect();
    let distance = |a: [f32; 2]| (a[0] - other[0]).hypot(a[1] - other[1]).max(1.0);
    let middle = |a: [f32; 2]| tile.place([0.5 * (a[0] + other[0]), 0.5 * (a[1] + other[1])]);
    let ([x, y], [was_x, was_y]) = (middle(to), middle(from));
    camera.pan((was_x - x) * aspect, y - was_y);
    camera.zoom_at(distance(from) / distance(to), [x, y], aspect);
}

#[cfg(test)]
mod tests {
    use TouchPhase::{Cancelled, Ended, Moved, Started};

    use super::*;
    use crate::session::session;

    #[test]
    fn one_finger_is_the_left_button_and_two_are_not() {
        let mut fingers = Fingers::default();
        let [a, b, c] = [[1.0, 2.0], [30.0, 2.0], [60.0, 2.0]];
        assert_eq!(fingers.change(7, Started, a, false), Effect::Press);
        assert_eq!(fingers.change(7, Moved, b, false), Effect::Move);
        assert_eq!(fingers.change(7, Ended, b, false), Effect::Release);
        assert_eq!(fingers.change(7, Started, a, false), Effect::Press);
        assert_eq!(fingers.change(8, Started, b, false), Effect::Finish);
        let moved = fingers.change(8, Moved, c, false);
        assert_eq!(moved, Effect::Pinch([b, c, a]));
        // What is left of a gesture does nothing, and a third finger neither.
        assert_eq!(fingers.change(9, Started, c, false), Effect::Nothing);
        assert_eq!(fingers.change(7, Cancelled, a, false), Effect::Nothing);
        assert_eq!(fingers.change(9, Ended, c, false), Effect::Nothing);
        assert_eq!(fingers.change(8, Moved, a, false), Effect::Nothing);
        assert_eq!(fingers.change(8, Ended, a, false), Effect::Nothing);
        // A finger on a button is egui's, wherever it goes.
        assert_eq!(fingers.change(7, Started, a, true), Effect::Nothing);
        assert_eq!(fingers.change(7, Moved, b, false), Effect::Nothing);
        assert_eq!(fingers.change(7, Ended, b, false), Effect::Nothing);
        assert_eq!(fingers.change(7, Started, a, false), Effect::Press);
        // After a long press, the finger does nothing until it is lifted.
        assert!(fingers.is_pressing());
        fingers.end_press();
        assert!(!fingers.is_pressing());
        assert_eq!(fingers.change(7, Moved, b, false), Effect::Nothing);
        assert_eq!(fingers.change(7, Ended, b, false), Effect::Nothing);
        assert_eq!(fingers.change(7, Started, a, false), Effect::Press);
    }

    #[test]
    fn two_fingers_keep_what_is_between_them() {
        let mut camera = session(&["t", "0.01"]).view.camera;
        let tile = Tile::whole((800, 600));
        let aspect = tile.aspect();
        let far = |camera: &Camera| (camera.eye() - camera.target()).norm();
        let was_far = far(&camera);
        // A point in the plane of the target, between the fingers before and afterwards.
        let [from, to, other] = [[500.0, 300.0], [700.0, 340.0], [300.0, 300.0]];
        let middle = |a: [f32; 2]| [0.5 * (a[0] + other[0]), 0.5 * (a[1] + other[1])];
        let point = camera.unproject(tile.place(middle(from)), was_far, aspect);
        pinch(&mut camera, tile, [from, to, other]);
        let ratio = far(&camera) / was_far;
        assert!((ratio - 200.0 / 400f32.hypot(40.0)).abs() < 1e-4, "{ratio}");
        let ([x, y], _) = camera.project(point, aspect).unwrap();
        let [wanted_x, wanted_y] = tile.place(middle(to));
        assert!((x - wanted_x).abs() < 1e-3 && (y - wanted_y).abs() < 1e-3, "{x} {y}");
    }
}
