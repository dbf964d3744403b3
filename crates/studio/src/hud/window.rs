//! A window of egui without a display, for tests.

use egui::epaint::{ClippedShape, MarginF32};
use egui::{Context, Event, Modifiers, PointerButton, Pos2, RawInput, Rect, SafeAreaInsets, Shape};

use super::style::context;
use super::widgets::asked;
use crate::session::Action;

/// A window of egui without a display.
pub struct Window {
    pub ctx: Context,
    /// The whole window (points).
    pub place: Rect,
    /// Pixels per point.
    pub scale: f32,
    /// Time of the last frame, and between frames (s).
    pub time: f64,
    pub step: f64,
    /// What the last frame drew.
    pub shapes: Vec<ClippedShape>,
}

/// Returns the event of a mouse button that is pressed at a place, or released.
pub fn button(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::default(),
    }
}

impl Window {
    /// Creates a window of a size (points).
    pub fn new(size: [f32; 2]) -> Self {
        Self {
            ctx: context(),
            place: Rect::from_min_size(Pos2::ZERO, size.into()),
            scale: 1.0,
            time: 0.0,
            step: 0.05,
            shapes: vec![],
        }
    }

    /// Runs a frame, in which something takes room on the right and below (points), and returns
    /// the action of the mouse.
    pub fn frame(
        &mut self,
        [right, bottom]: [f32; 2],
        events: Vec<Event>,
        mut show: impl FnMut(&Context),
    ) -> Option<Action> {
        self.time += self.step;
        let taken = MarginF32 { right, bottom, ..MarginF32::default() };
        let mut input = RawInput {
            screen_rect: Some(self.place),
            safe_area_insets: Some(SafeAreaInsets(taken)),
            time: Some(self.time),
            events,
            ..RawInput::default()
        };
        let root = input.viewports.entry(egui::ViewportId::ROOT).or_default();
        root.native_pixels_per_point = Some(self.scale);
        let mut output = self.ctx.run_ui(input, |ui| show(ui.ctx()));
        output.textures_delta.set.clear();
        output.textures_delta.free.clear();
        self.shapes = output.shapes;
        asked(&self.ctx)
    }

    /// Runs three frames with the pointer at a place, and clicks there.
    pub fn click(
        &mut self,
        taken: [f32; 2],
        at: Pos2,
        mut show: impl FnMut(&Context),
    ) -> Option<Action> {
        let presses = [None, None, None, Some(true), Some(false)];
        presses.into_iter().fold(None, |action, pressed| {
            let press = pressed.map(|pressed| button(at, pressed));
            let events = [Event::PointerMoved(at)].into_iter().chain(press);
            self.frame(taken, events.collect(), &mut show).or(action)
        })
    }

    /// Returns all text, with its rectangle and the visible part of the window.
    pub fn written(&self) -> Vec<(String, Rect, Rect)> {
        let text = |clipped: &ClippedShape| match &clipped.shape {
            Shape::Text(text) if !text.galley.text().is_empty() => Some((
                text.galley.text().to_owned(),
                text.visual_bounding_rect(),
                clipped.clip_rect.intersect(self.place).expand(1.0),
            )),
            _ => None,
        };
        self.shapes.iter().filter_map(text).collect()
    }

    /// Returns all text, of which nothing may be cut off, with its rectangles.
    pub fn read(&self) -> Vec<(String, Rect)> {
        let all = self.written().into_iter();
        all.map(|(words, rect, seen)| {
            assert!(seen.contains_rect(rect), "{words:?} is cut off at {rect:?}");
            (words, rect)
        })
        .collect()
    }

    /// Returns all words, a text a line.
    pub fn words(&self) -> String {
        let all = self.written().into_iter();
        all.map(|(words, ..)| words + "\n").collect()
    }
}
