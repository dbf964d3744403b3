//! The palette: a button with a drawing for each tool, and sliders for what it adds.

use a3_files::rounding::short;
use egui::{
    Color32, Context, CursorIcon, Id, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui,
    pos2, vec2,
};

use super::super::style::{FAINT, INK, TEXT};
use super::super::widgets::{Asks, LEFT, MIDDLE, SHEET, ask, fixed, slider, write};
use crate::session::{Dial, DialScale, Measure, PanelRequest, Session, Tool, Turn};

/// Smallest and largest width of a button, and its height (points).
const BUTTON: [f32; 3] = [49.0, 62.0, 46.0];
/// Height of the row of sliders (points).
const SLIDERS: f32 = 28.0;
/// Smallest and largest width of a slider with its name and its value (points).
const SLIDER: [f32; 2] = [140.0, 184.0];
/// Distance from the contents to the edge (points).
const PAD: f32 = 6.0;
/// Distance from the bar and from the sides of the picture (points).
const GAP: f32 = 10.0;
/// Factor from the value that fits the scene to either end of a slider.
const SPAN: f64 = 20.0;
/// Colour of the chosen tool.
const CHOSEN: Color32 = Color32::from_rgb(246, 246, 244);
/// Colour of the tool under the pointer.
const HOVERED: Color32 = Color32::from_rgb(214, 216, 220);

/// Draws the palette, if it is open.
pub fn show(ctx: &Context, session: &Session) {
    let (readings, editor) = (&session.readings, &session.panel.editor);
    if !editor.open || readings.help || readings.asks_to_quit || session.list.is_some() {
        return;
    }
    let room = ctx.content_rect().shrink(GAP);
    let count = Tool::ALL.len();
    let inside = room.width() - 2.0 * PAD;
    let [least, most, high] = BUTTON;
    let button_size = vec2((inside / count as f32).clamp(least, most), high);
    let columns = ((inside / button_size.x) as usize).clamp(1, count);
    let rows = count.div_ceil(columns);
    let width = columns as f32 * button_size.x + 2.0 * PAD;
    let measures = editor.tool.measures();
    let beside = (((width - 2.0 * PAD) / SLIDER[0]) as usize).clamp(1, 3);
    let slider_width = ((width - 2.0 * PAD) / beside as f32).min(SLIDER[1]);
    let lines = measures.len().div_ceil(beside).max(1);
    let height = rows as f32 * BUTTON[2] + lines as f32 * SLIDERS + 2.0 * PAD;
    let left = room.center().x - 0.5 * width;
    let place = Rect::from_min_size(pos2(left, room.bottom() - height), vec2(width, height));
    fixed(ctx, Id::unique("tools"), place.min, |ui| {
        ui.allocate_rect(place, Sense::click_and_drag());
        let edge = Stroke::new(1.0, FAINT.gamma_multiply(0.35));
        ui.painter().rect(place, 9.0, SHEET, edge, StrokeKind::Inside);
        let inside = place.shrink(PAD);
        let cell = |k: usize, of: usize| vec2((k % of) as f32, (k / of) as f32);
        for k in 0..count {
            let at = inside.min + cell(k, columns) * button_size;
            let rect = Rect::from_min_size(at, button_size);
            button(ui, rect, k, editor.tool);
        }
        let top = inside.top() + rows as f32 * button_size.y;
        let all = measures.len().min(beside) as f32 * slider_width;
        let left = inside.center().x - 0.5 * all;
        for (k, measure) in measures.iter().enumerate() {
            let size = vec2(slider_width, SLIDERS);
            let rect = Rect::from_min_size(pos2(left, top) + cell(k, beside) * size, size);
            quantity(ui, rect, session, *measure);
        }
        if measures.is_empty() {
            let at = pos2(inside.center().x, top + 0.5 * SLIDERS);
            let (.., help) = Tool::ALL[editor.tool as usize];
            write(ui.painter(), at, MIDDLE, help, 12.5, FAINT);
        }
    });
}

/// Draws the button of tool k.
fn button(ui: &Ui, rect: Rect, k: usize, chosen: Tool) {
    let (tool, name, help) = Tool::ALL[k];
    let chosen = tool == chosen;
    let id = Id::unique(("tool", k));
    let response = ui.interact(rect, id, Sense::click());
    let painter = ui.painter();
    let inside = rect.shrink(2.0);
    if chosen {
        let edge = Stroke::new(1.2, INK);
        painter.rect(inside, 7.0, CHOSEN, edge, StrokeKind::Inside);
    } else if response.hovered() {
        painter.rect_filled(inside, 7.0, HOVERED);
    }
    let colour = if chosen { INK } else { TEXT };
    draw(painter, tool, rect.center() - vec2(0.0, 7.0), colour);
    let at = pos2(rect.center().x, rect.bottom() - 11.0);
    let size = if rect.width() < 56.0 { 9.5 } else { 11.0 };
    write(painter, at, MIDDLE, name, size, colour);
    let response = response.on_hover_cursor(CursorIcon::PointingHand);
    let response = response.on_hover_text(help);
    response.asks(PanelRequest::Tool(tool));
}

/// Draws the name, the slider and the value of a quantity.
fn quantity(ui: &Ui, rect: Rect, session: &Session, measure: Measure) {
    let [fitting, value] = session.panel.editor.both(measure);
    let (name, unit) = match measure {
        Measure::Size => ("size", "m"),
        Measure::Speed => ("speed", "m/s"),
        Measure::Mass | Measure::PointMass => ("mass", "kg"),
        Measure::Stiffness => ("stiffness", "N/m"),
    };
    let scale = DialScale::Log([fitting / SPAN, fitting * SPAN]);
    let words = format!("{} {unit}", short(value, 2));
    let dial = Dial::new(value, fitting, scale, words);
    let (painter, y) = (ui.painter(), rect.center().y);
    let at = pos2(rect.left() + 6.0, y);
    let written = write(painter, at, LEFT, name, 12.0, FAINT);
    let right = rect.right() - 62.0;
    let track = Rect::from_x_y_ranges(written.right() + 4.0..=right, rect.y_range());
    let at = pos2(right + 2.0, y);
    write(painter, at, LEFT, &dial.words, 12.0, TEXT);
    let id = Id::unique(("measure", measure as usize));
    if let Some(Turn::To(value)) = slider(ui, track, id, &dial) {
        ask(ui, PanelRequest::SetMeasure(measure, short(value, 2)));
    }
}

/// Draws the icon of a tool around a point, about 20 points wide.
pub fn draw(painter: &Painter, tool: Tool, at: Pos2, colour: Color32) {
    let stroke = Stroke::new(1.7, colour);
    let point = |x: f32, y: f32| at + vec2(x, y);
    let line = |points: &[[f32; 2]]| {
        let points = points.iter().map(|[x, y]| point(*x, *y)).collect();
        painter.add(Shape::line(points, stroke));
    };
    let dot = |x: f32, y: f32| painter.circle_filled(point(x, y), 2.8, colour);
    let cube = |x: f32, y: f32, side: f32| {
        let rect = Rect::from_center_size(point(x, y), vec2(side, side));
        painter.rect_stroke(rect, 1.5, stroke, StrokeKind::Middle);
    };
    match tool {
        Tool::ThrowBall | Tool::ThrowBox => {
            for (y, from) in [(-3.0, -9.0), (1.0, -11.0), (5.0, -8.0)] {
                line(&[[from, y], [-2.5, y - 1.0]]);
            }
            if tool == Tool::ThrowBall {
                painter.circle_stroke(point(5.0, 0.0), 5.2, stroke);
            } else {
                cube(5.0, 0.0, 9.4);
            }
        }
        Tool::AddBall | Tool::AddBox => {
            if tool == Tool::AddBall {
                painter.circle_stroke(point(0.0, 0.2), 5.2, stroke);
            } else {
                cube(0.0, 0.6, 9.4);
            }
            line(&[[-10.0, 7.4], [10.0, 7.4]]);
        }
        Tool::Particle => {
            painter.circle_filled(at, 3.8, colour);
        }
        Tool::Spring => {
            dot(-10.0, 0.0);
            dot(10.0, 0.0);
            let turns = (0..9).map(|k| {
                let y = match k {
                    0 | 8 => 0.0,
                    k if k % 2 == 0 => 4.4,
                    _ => -4.4,
                };
                [-8.0 + 2.0 * k as f32, y]
            });
            line(&turns.collect::<Vec<_>>());
        }
        Tool::Rod => {
            dot(-9.0, 4.0);
            dot(9.0, -4.0);
            line(&[[-9.0, 4.0], [9.0, -4.0]]);
        }
        Tool::Rope => {
            dot(-9.5, -4.0);
            dot(9.5, -4.0);
            let sag = (0..=12).map(|k| {
                let x = k as f32 / 6.0 - 1.0;
                [9.5 * x, 5.0 - 9.0 * x * x]
            });
            line(&sag.collect::<Vec<_>>());
        }
        Tool::Delete => {
            line(&[[-5.5, -5.5], [5.5, 5.5]]);
            line(&[[-5.5, 5.5], [5.5, -5.5]]);
        }
    }
}
