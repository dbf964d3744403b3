//! The legend of colours and arrows.

use a3_render::ramp;
use egui::{
    Align2, Color32, FontId, Mesh, Pos2, Rect, Sense, Shape, Stroke, Ui, epaint::Vertex, vec2,
};

use super::style::{FAINT, TEXT};
use super::words::digits;
use crate::show::Show;

/// Width and height of the bar (points).
const BAR: [f32; 2] = [200.0, 10.0];
/// Number of pieces of the bar, between which its colours are mixed.
const PIECES: u32 = 35;

/// Draws a bar of the colours with the ends of its scale and a mark at each tenth, as the surface
/// has them, and says what arrows mean, where there are any.
pub fn legend(ui: &mut Ui, show: &Show) {
    let (colouring, field) = (&show.colouring, &show.field);
    if let Some(quantity) = colouring.quantity {
        let width = BAR[0].min(ui.available_width());
        let (rect, _) = ui.allocate_exact_size(vec2(width, BAR[1] + 17.0), Sense::hover());
        let bar = Rect::from_min_size(rect.min, vec2(width, BAR[1]));
        draw(ui, bar);
        let end = digits(colouring.scale.end());
        let fixed = if colouring.scale.fixed.is_some() {
            ", fixed"
        } else {
            ""
        };
        let write = |at: Pos2, align, words: String| {
            let font = FontId::proportional(12.5);
            ui.painter().text(at, align, words, font, FAINT);
        };
        write(rect.left_bottom(), Align2::LEFT_BOTTOM, "0".into());
        let name = format!("{}{fixed}", quantity.name());
        write(rect.center_bottom(), Align2::CENTER_BOTTOM, name);
        let end = format!("{end}{}", quantity.unit());
        write(rect.right_bottom(), Align2::RIGHT_BOTTOM, end);
    }
    if let Some(arrows) = field.arrows {
        let end = digits(field.scale.end());
        let words = format!(
            "arrows: {}, the longest {end}{}",
            arrows.name(),
            arrows.unit()
        );
        ui.label(super::style::faint(words));
    }
}

fn draw(ui: &Ui, bar: Rect) {
    let mut mesh = Mesh::default();
    for k in 0..=PIECES {
        let share = k as f32 / PIECES as f32;
        let [r, g, b, _] = ramp(share);
        let color = Color32::from(egui::Rgba::from_rgb(r, g, b));
        let x = bar.left() + share * bar.width();
        for y in [bar.top(), bar.bottom()] {
            mesh.vertices.push(Vertex {
                pos: Pos2::new(x, y),
                uv: egui::epaint::WHITE_UV,
                color,
            });
        }
        if k > 0 {
            let last = 2 * k;
            mesh.add_triangle(last - 2, last - 1, last);
            mesh.add_triangle(last - 1, last, last + 1);
        }
    }
    ui.painter().add(Shape::mesh(mesh));
    for tenth in 1..10 {
        let x = bar.left() + 0.1 * tenth as f32 * bar.width();
        let stroke = Stroke::new(1.0, TEXT.gamma_multiply(0.45));
        ui.painter().vline(x, bar.y_range(), stroke);
    }
}
