//! Sheets at the edges of the window, and the panes on them, which open beside the picture one at
//! a time, below it in a narrow window, or over it in a small one.

use egui::{Area, Context, Id, Rect, Sense, Stroke, Ui, pos2, vec2};

use super::style::{FAINT, TEXT};
use super::widgets::{Asks, EDGE, LEFT, RIGHT, SHEET, cross, write};
use crate::session::{RunAction, Session};

/// Draws a sheet at an edge of the window, with lines where it meets the picture, and its contents
/// on it.
pub fn docked(ctx: &Context, name: &str, rect: Rect, contents: impl FnOnce(&mut Ui)) {
    let window = ctx.viewport_rect();
    Area::new(Id::unique(name))
        .fixed_pos(rect.min)
        // An area that was moved would grow to reach from there to its sheet, for good.
        .constrain_to(window)
        .constrain(false)
        .fade_in(false)
        .show(ctx, |ui| {
            ui.allocate_rect(rect, Sense::click());
            ui.style_mut().interaction.selectable_labels = false;
            let (painter, edge) = (ui.painter(), Stroke::new(1.0, EDGE));
            painter.rect_filled(rect, 0.0, SHEET);
            if rect.left() > window.left() {
                painter.vline(rect.left(), rect.y_range(), edge);
            }
            if rect.top() > window.top() {
                painter.hline(rect.x_range(), rect.top(), edge);
            }
            contents(ui);
        });
}

/// A pane that opens beside the picture.
pub struct Pane {
    /// The title, if the contents do not draw it themselves.
    pub title: &'static str,
    /// The action that opens the pane and closes it, and its key.
    pub action: RunAction,
    pub key: &'static str,
    /// Distance of the contents from the edges, and of the middle of the title from the top
    /// (points).
    pub margins: [f32; 2],
    /// Draws the contents in a room.
    pub contents: fn(&mut Ui, Rect, &Session),
    /// Smallest and largest width beside the picture (points), and its share of the window's width
    /// between them.
    pub width: (f32, f32, f32),
    /// Smallest width of a window with the pane beside the picture (points).
    pub min_width_beside: f32,
    /// Share of the height of a narrow window that is higher than wide.
    pub share_below: f32,
    /// Width beside the picture in another narrow window (points); `None` if the pane covers the
    /// picture there.
    pub narrow: Option<f32>,
}

/// Smallest width of a picture beside a pane (points).
const MIN_PICTURE_WIDTH: f32 = 150.0;
/// Smallest width of a heading that names its key (points).
const MIN_KEY_WIDTH: f32 = 220.0;

impl Pane {
    /// Draws the pane: its heading with the button that closes it, and its contents.
    pub fn show(&self, ctx: &Context, session: &Session) {
        let rect = self.rect(ctx);
        docked(ctx, self.key, rect, |ui| {
            ui.set_clip_rect(rect);
            let [side, line] = self.margins;
            let room = rect.shrink2(vec2(side, 0.0));
            let [left, right] = [room.left(), room.right() - 8.0];
            let [left, right] = [left, right].map(|x| pos2(x, room.top() + line));
            cross(ui, right).asks(self.action);
            let painter = ui.painter();
            if room.width() > MIN_KEY_WIDTH {
                let at = right - vec2(16.0, 0.0);
                write(painter, at, RIGHT, self.key, 12.5, FAINT);
            }
            write(painter, left, LEFT, self.title, 17.0, TEXT);
            (self.contents)(ui, room, session);
        });
    }

    /// Returns the width on the right and the height below the picture that the pane takes, in a
    /// window of a size (points). One that covers the picture takes nothing.
    pub fn taken(&self, [width, height]: [f32; 2]) -> [f32; 2] {
        let (least, most, share) = self.width;
        if !self.is_narrow(width) {
            [(share * width).round().clamp(least, most), 0.0]
        } else if height > width {
            [0.0, (self.share_below * height).round()]
        } else {
            let narrow = self.narrow.filter(|it| it + MIN_PICTURE_WIDTH <= width);
            [narrow.unwrap_or(0.0), 0.0]
        }
    }

    /// Returns whether a window of a width (points) is so narrow that the pane is above the bar.
    pub fn is_narrow(&self, width: f32) -> bool {
        width < self.min_width_beside
    }

    /// Returns whether the pane covers the picture in a window of a size (points).
    pub fn covers(&self, window: [f32; 2]) -> bool {
        self.taken(window) == [0.0, 0.0]
    }

    /// Returns the rectangle of the pane: the right side, the room between the picture and the bar,
    /// or all above the bar.
    fn rect(&self, ctx: &Context) -> Rect {
        let (window, picture) = (ctx.viewport_rect(), ctx.content_rect());
        match self.taken([window.width(), window.height()]) {
            [0.0, 0.0] => picture,
            [0.0, below] => {
                let top = picture.bottom();
                window.with_min_y(top).with_max_y(top + below)
            }
            [right, _] => {
                let is_above = self.is_narrow(window.width());
                let bottom = if is_above { picture } else { window }.bottom();
                window.with_min_x(window.right() - right).with_max_y(bottom)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::hud::window::Window;
    use crate::hud::{all::show_all, layout};
    use crate::session::{apply, session};

    /// One pane is open at a time, and its cross closes it.
    #[test]
    fn a_cross_closes_each_pane() {
        let mut session = session(&["t", "0.01"]);
        session.measuring.answerer = Some(|_, _| unreachable!());
        session.act(RunAction::Panel, 0);
        let actions = [RunAction::Plots, RunAction::Measure, RunAction::Lessons];
        for action in actions.into_iter().chain([RunAction::Panel]) {
            session.act(action, 0);
            let pane = layout::beside(&session).unwrap();
            assert_eq!(pane.action, action);
            let taken = layout::insets(&session, (1280, 720), 1.0);
            let at = pos2(1280.0 - pane.margins[0] - 8.0, pane.margins[1]);
            let mut window = Window::new([1280.0, 720.0]);
            let all = |ctx: &_| show_all(ctx, &session, &HashMap::new());
            let clicked = window.click(taken, at, all).unwrap();
            assert!(!apply(&mut session, clicked, 0));
            assert!(layout::beside(&session).is_none(), "{action:?}");
        }
    }
}
