//! Colours, fonts, text styles, and the sheets behind the text.

use std::sync::Arc;

use egui::{
    Align2, Area, Color32, Context, FontData, FontDefinitions, FontId, FontTweak, Frame, Id,
    Margin, Painter, Pos2, RichText, Ui,
};
use epaint_default_fonts::EMOJI_ICON;

/// Colour of text.
pub const TEXT: Color32 = Color32::from_rgb(24, 28, 40);
/// Colour of names and notes.
pub const FAINT: Color32 = Color32::from_rgb(92, 98, 114);
/// Colour of keys, of controls, and of values that differ from the scene's own.
pub const INK: Color32 = Color32::from_rgb(38, 84, 132);
/// Colour of sheets, slightly transparent.
pub const PAPER: Color32 = Color32::from_rgba_premultiplied(216, 216, 214, 222);
/// Mark of a step well within its limit.
pub const SAFE: Mark = Mark { symbol: '✔', colour: Color32::from_rgb(12, 106, 52) };
/// Mark of a step near its limit, and of a spurious gain of energy.
pub const WARNING: Mark = Mark { symbol: '⚠', colour: Color32::from_rgb(158, 84, 0) };
/// Mark of a step past its limit, and of a blow-up.
pub const ALARM: Mark = Mark { symbol: '✖', colour: Color32::from_rgb(170, 22, 30) };
/// Ground of marked text.
const MARKED: Color32 = Color32::from_rgb(176, 208, 246);
/// Distance of sheets from the edge of the window (points).
pub const MARGIN: f32 = 12.0;

/// A grade of safety: a colour, and a symbol for those who cannot distinguish colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    pub symbol: char,
    /// Colour of the symbol and of the text beside it.
    pub colour: Color32,
}

impl Mark {
    /// Returns text of normal size, with this mark.
    pub fn text(self, words: &str) -> RichText {
        text(format!("{} {words}", self.symbol)).color(self.colour)
    }
}

/// Returns a colour of the same hue and opacity with inverted lightness (1 minus it), which turns
/// the light theme into the dark one and back.
pub fn invert_lightness(color: Color32) -> Color32 {
    let [r, g, b, a] = color.to_srgba_unmultiplied();
    let (low, high) = (r.min(g).min(b), r.max(g).max(b));
    // The smallest plus the largest channel is twice the lightness. Shift all channels alike.
    let shift = 255 - i16::from(low) - i16::from(high);
    let [r, g, b] = [r, g, b].map(|channel| (i16::from(channel) + shift).clamp(0, 255) as u8);
    Color32::from_rgba_unmultiplied(r, g, b, a)
}

/// Creates an egui context with two fonts: one for letters, one for the symbols of the marks.
pub fn context() -> Context {
    let mut fonts = FontDefinitions::empty();
    for (name, bytes, scale) in [("letters", a3_plot::FONT, 1.0), ("symbols", EMOJI_ICON, 0.9)] {
        let tweak = FontTweak { scale, ..FontTweak::default() };
        let data = FontData::from_static(bytes).tweak(tweak);
        fonts.font_data.insert(name.into(), Arc::new(data));
        for family in fonts.families.values_mut() {
            family.push(name.into());
        }
    }
    let context = Context::default();
    context.set_fonts(fonts);
    // Tooltips are light like all else: the dark theme inverts every colour.
    let mut visuals = egui::Visuals::light();
    visuals.window_fill = PAPER.to_opaque();
    visuals.window_stroke.color = FAINT.gamma_multiply(0.4);
    visuals.override_text_color = Some(TEXT);
    visuals.popup_shadow = egui::Shadow::NONE;
    context.set_theme(egui::Theme::Light);
    context.set_visuals(visuals);
    context
}

/// Draws a column of sheets, without taking clicks.
pub fn column(
    ctx: &Context,
    name: &str,
    anchor: Align2,
    offset: [f32; 2],
    contents: impl FnOnce(&mut Ui),
) {
    Area::new(Id::unique(name)).anchor(anchor, offset).interactable(false).show(ctx, |ui| {
        ui.spacing_mut().item_spacing = egui::vec2(8.0, 6.0);
        ui.set_max_width((ctx.content_rect().width() - 2.0 * MARGIN).clamp(60.0, 760.0));
        contents(ui);
    });
}

/// Draws a sheet behind its contents.
pub fn sheet(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    Frame::new().fill(PAPER).corner_radius(7).inner_margin(Margin::symmetric(12, 9)).show(
        ui,
        |ui| {
            ui.spacing_mut().item_spacing = egui::vec2(8.0, 3.0);
            contents(ui);
        },
    );
}

/// Returns the title of a sheet.
pub fn title(words: impl Into<String>) -> RichText {
    RichText::new(words).color(TEXT).size(17.0).strong()
}

/// Returns text of normal size.
pub fn text(words: impl Into<String>) -> RichText {
    RichText::new(words).color(TEXT).size(13.5)
}

/// Returns a name or a note, in small faint text.
pub fn faint(words: impl Into<String>) -> RichText {
    RichText::new(words).color(FAINT).size(12.5)
}

/// Draws text that is typed, marked or with a cursor at its end.
pub fn typed(painter: &Painter, at: Pos2, align: Align2, typed: &str, is_marked: bool) {
    let end = if is_marked { "" } else { "_" };
    let (words, font) = (format!("{typed}{end}"), FontId::proportional(14.0));
    let line = painter.layout_no_wrap(words, font, Color32::BLACK);
    let place = align.anchor_size(at, line.size());
    if is_marked {
        painter.rect_filled(place.expand(1.0), 1.0, MARKED);
    }
    painter.galley(place.min, line, Color32::BLACK);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_is_inverted_and_back() {
        assert_eq!(invert_lightness(Color32::WHITE), Color32::BLACK);
        assert_eq!(invert_lightness(Color32::TRANSPARENT), Color32::TRANSPARENT);
        for color in [TEXT, FAINT, SAFE.colour, ALARM.colour] {
            let other = invert_lightness(color);
            assert!(other.intensity() > color.intensity() + 0.1, "{other:?}");
            assert_eq!(invert_lightness(other), color);
        }
    }

    #[test]
    fn every_mark_has_its_own_symbol_and_the_font_has_them() {
        let ctx = context();
        let mut output = ctx.run_ui(egui::RawInput::default(), |_| {});
        output.textures_delta.set.clear();
        output.textures_delta.free.clear();
        let font = egui::FontId::proportional(13.5);
        let has = |symbol| ctx.fonts_mut(|fonts| fonts.has_glyph(&font, symbol));
        assert!(!has('\u{E000}'));
        let symbols = [SAFE, WARNING, ALARM].map(|mark| mark.symbol);
        assert!(symbols.iter().all(|symbol| has(*symbol)), "{symbols:?}");
        assert!(symbols[0] != symbols[1] && symbols[1] != symbols[2] && symbols[0] != symbols[2]);
    }
}
