//! A window of egui without a display.

use egui::{Context, Event, PointerButton, Pos2, RawInput, Rect, Shape, pos2};

use crate::hud::panel::request::{Request, apply};
use crate::hud::panel::view::{MARGIN, PLACE, place, show};
use crate::hud::style;
use crate::session::Session;

/// A window of egui without a display.
pub struct Screen {
    ctx: Context,
    pub size: [f32; 2],
    pub time: f64,
}

impl Screen {
    pub fn new(size: [f32; 2]) -> Self {
        Self {
            ctx: style::context(),
            size,
            time: 0.0,
        }
    }

    /// Returns the width of the panel (points).
    fn width(&self) -> f32 {
        PLACE.taken(self.size)[0]
    }

    /// Runs a frame, and returns the drawing and the request of the mouse.
    pub fn frame(
        &mut self,
        session: &Session,
        events: Vec<Event>,
    ) -> (egui::FullOutput, Option<Request>) {
        self.time += 0.05;
        let shown = place(session).map(|place| place.taken(self.size));
        let [right, bottom] = shown.unwrap_or_default();
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, self.size.into())),
            safe_area_insets: Some(egui::SafeAreaInsets(egui::epaint::MarginF32 {
                right,
                bottom,
                ..Default::default()
            })),
            time: Some(self.time),
            events,
            ..Default::default()
        };
        let mut request = None;
        let mut output = self.ctx.run_ui(input, |ui| {
            request = show(ui.ctx(), session).or(request);
        });
        output.textures_delta.set.clear();
        output.textures_delta.free.clear();
        (output, request)
    }

    /// Returns all text, with its rectangle and the visible part of the screen.
    pub fn written(&mut self, session: &Session) -> Vec<(String, Rect, Rect)> {
        self.frame(session, vec![]);
        self.frame(session, vec![]);
        self.time += 10.0;
        let (output, _) = self.frame(session, vec![]);
        let screen = Rect::from_min_size(Pos2::ZERO, self.size.into());
        let text = |clipped: &egui::epaint::ClippedShape| match &clipped.shape {
            Shape::Text(text) => Some((
                text.galley.text().to_owned(),
                text.visual_bounding_rect(),
                clipped.clip_rect.intersect(screen).expand(1.0),
            )),
            _ => None,
        };
        output.shapes.iter().filter_map(text).collect()
    }

    /// Returns all text with its rectangles. Nothing may be cut off.
    pub fn read(&mut self, session: &Session) -> Vec<(String, Rect)> {
        let all = self.written(session).into_iter();
        all.map(|(words, rect, seen)| {
            assert!(seen.contains_rect(rect), "{words} is cut off at {rect:?}");
            (words, rect)
        })
        .collect()
    }

    /// Drags the left button from one position to another, or clicks if they are the same, and
    /// applies the requests to the session.
    pub fn click(&mut self, session: &mut Session, from: Pos2, to: Pos2) {
        let button = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::default(),
        };
        for event in [
            vec![Event::PointerMoved(from)],
            vec![button(from, true)],
            vec![Event::PointerMoved(to)],
            vec![button(to, false)],
            vec![],
        ] {
            if let (_, Some(Request::Change(request))) = self.frame(session, event) {
                apply(session, request);
            }
        }
    }

    /// Returns the position of a row's value, and the ends of its slider.
    pub fn place(&mut self, session: &Session, name: &str) -> (Pos2, [Pos2; 2]) {
        let texts = self.read(session);
        let left = self.size[0] - self.width();
        let (_, row) = texts
            .iter()
            .find(|(words, rect)| words == name && rect.left() > left)
            .unwrap();
        let y = row.center().y;
        let at = |x: f32| pos2(left + MARGIN + x, y);
        let wide = self.width() - 2.0 * MARGIN;
        (at(wide - 10.0), [at(82.0), at(wide - 86.0)])
    }
}
