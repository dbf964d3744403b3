//! The legend over pictures without a window.

use a3_media::painter::{self, Caption};
use a3_media::show::Show;
use a3_render::{Style, TEXT_FORMAT};
use egui::Align2;

use super::legend::legend;
use super::overlay::Overlay;
use super::style::{MARGIN, column, sheet};

/// Returns the legend as the caption of pictures of this size (px), for a show that has colours,
/// arrows or kinds of springs. A transparent picture has none: it is laid over another one.
pub fn caption(show: &Show, size: (u32, u32)) -> Option<Caption> {
    let explains = show.colouring.quantity.is_some()
        || show.field.arrows.is_some()
        || show.style == Style::Springs;
    // Do not shrink text below its normal size: it would be illegible.
    let scale = painter::scale(size).max(1.0);
    let mut overlay = None;
    let write: Caption = Box::new(move |show, gpu, encoder, view| {
        let overlay = overlay.get_or_insert_with(|| Overlay::new(gpu, TEXT_FORMAT));
        overlay.dark = show.dark;
        overlay.write(gpu, encoder, view, (size, scale), |ctx| {
            let corner = [MARGIN, -MARGIN];
            column(ctx, "legend", Align2::LEFT_BOTTOM, corner, |ui| {
                sheet(ui, |ui| legend(ui, show));
            });
        })
    });
    (explains && !show.transparent).then_some(write)
}
