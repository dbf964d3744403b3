//! The legend of colours, arrows and springs.

use a3_media::show::{self, Show};
use a3_render::ramp;
use egui::{Align2, Color32, Mesh, Pos2, Rect, Sense, Shape, Stroke, Ui, epaint::Vertex, vec2};

use super::style::{FAINT, TEXT, invert_lightness};
use super::widgets::write;
use super::words::digits;

/// Width and height of the colour bar (points).
const BAR_SIZE: [f32; 2] = [200.0, 10.0];
/// Number of pieces of the colour bar, within which colours are interpolated.
const BAR_PIECES: u32 = 35;

/// Draws the colour bar, with the ends of its scale and the same marks at tenths as on the surface.
/// Also explains arrows and kinds of springs, if there are any.
pub fn legend(ui: &mut Ui, show: &Show) {
    let (colouring, field) = (&show.colouring, &show.field);
    let coloured = colouring.shown();
    if let Some(quantity) = coloured {
        let width = BAR_SIZE[0].min(ui.available_width());
        let (rect, _) = ui.allocate_exact_size(vec2(width, BAR_SIZE[1] + 17.0), Sense::hover());
        let bar = Rect::from_min_size(rect.min, vec2(width, BAR_SIZE[1]));
        draw(ui, bar, show.dark);
        let scale = &colouring.scale;
        let power = |end: f64| match end {
            small if small < 1e-3 => format!("{small:.0e}"),
            end => end.to_string(),
        };
        let (start, end, kind) = if scale.logarithmic {
            let least = power(scale.end() / 10f64.powi(show::DECADES));
            (format!("\u{2264} {least}"), power(scale.end()), ", log.")
        } else {
            ("0".into(), digits(scale.end()), "")
        };
        let fixed = if scale.fixed.is_some() { ", fixed" } else { "" };
        let name = format!("{}{kind}{fixed}", quantity.name());
        let end = format!("{end}{}", quantity.unit());
        for (at, align, words) in [
            (rect.left_bottom(), Align2::LEFT_BOTTOM, start),
            (rect.center_bottom(), Align2::CENTER_BOTTOM, name),
            (rect.right_bottom(), Align2::RIGHT_BOTTOM, end),
        ] {
            write(ui.painter(), at, align, words, 12.5, FAINT);
        }
    }
    if let Some(arrows) = field.arrows {
        let end = digits(field.scale.end());
        let words = format!("arrows: {}, the longest {end}{}", arrows.name(), arrows.unit());
        ui.label(super::style::faint(words));
    }
    if !show.kinds().is_empty() {
        ui.horizontal_wrapped(|ui| springs(ui, show, coloured.is_none()));
    }
}

/// Draws a sample of each kind of springs, in its width, and in its colour if `in_colours`.
fn springs(ui: &mut Ui, show: &Show, in_colours: bool) {
    for kind in show.kinds().iter().rev() {
        let ([r, g, b, _], width) = show::kind_look(*kind);
        let (rect, _) = ui.allocate_exact_size(vec2(20.0, 14.0), Sense::hover());
        let colour = if in_colours { Color32::from(egui::Rgba::from_rgb(r, g, b)) } else { FAINT };
        let stroke = Stroke::new(width, colour);
        ui.painter().hline(rect.x_range(), rect.center().y, stroke);
        ui.label(super::style::faint(show::kind_name(*kind)));
    }
}

/// Draws the bar, for the dark theme or the light one.
fn draw(ui: &Ui, bar: Rect, dark: bool) {
    let mut mesh = Mesh::default();
    for k in 0..=BAR_PIECES {
        let share = k as f32 / BAR_PIECES as f32;
        let [r, g, b, _] = ramp(share);
        let color = Color32::from(egui::Rgba::from_rgb(r, g, b));
        // Colours of values are the same in both themes, so undo the inversion in advance.
        let color = if dark { invert_lightness(color) } else { color };
        let x = bar.left() + share * bar.width();
        for y in [bar.top(), bar.bottom()] {
            mesh.vertices.push(Vertex { pos: Pos2::new(x, y), uv: egui::epaint::WHITE_UV, color });
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

#[cfg(test)]
mod tests {
    use a3_media::show::Quantity;
    use a3_render::Style;

    use crate::hud::{pane, read};
    use crate::session::Readings;

    /// Returns the text over a scene that is drawn in a style and coloured by a quantity.
    fn said(scene: &str, style: Style, quantity: Option<Quantity>) -> String {
        let mut pane = pane(scene, "r", 1e-3);
        pane.show.style = style;
        pane.show.colouring.set_quantity(quantity);
        pane.simulation.take_steps(5).unwrap();
        pane.show.compose(&pane.simulation);
        read(&[pane], &Readings::default(), [1280.0, 720.0]).0
    }

    #[test]
    fn the_legend_explains_what_is_drawn_and_no_more() {
        let springs = said("mit", Style::Springs, None);
        assert!(springs.contains("structural\nshear\nbend\n"), "{springs}");
        let wires = said("mit", Style::Wireframe, Some(Quantity::Strain));
        assert!(!wires.contains("shear") && wires.contains("strain\n"), "{wires}");
        let none = said("mit", Style::Shaded, Some(Quantity::Contact));
        assert!(!none.contains("contact\n"), "{none}");
        let both = said("chain", Style::Springs, Some(Quantity::Speed));
        assert!(both.contains("structural\n") && both.contains("speed\n"), "{both}");
        assert!(!both.contains("shear"), "{both}");
    }
}
