//! Everything that egui draws: the text over the picture, the bar below it, lists, and the panel of
//! knobs and plots.

mod all;
mod bar;
mod blow_up;
#[cfg(not(target_arch = "wasm32"))]
mod caption;
mod charts;
mod docked;
pub mod edit;
mod help;
mod hint;
pub mod layout;
mod legend;
pub mod lessons;
mod list;
mod measure;
mod offer;
mod overlay;
mod pane_buttons;
pub mod panel;
mod panes;
#[cfg(not(target_arch = "wasm32"))]
mod picture;
pub mod plotting;
mod question;
mod ruler;
mod selection;
mod single;
#[cfg(test)]
mod small;
mod style;
mod text;
mod timeline;
mod words;

pub use all::show_all;
#[cfg(not(target_arch = "wasm32"))]
pub use caption::caption;
pub use overlay::Overlay;
#[cfg(not(target_arch = "wasm32"))]
pub use picture::Studio;
#[cfg(not(target_arch = "wasm32"))]
pub use words::digits;

#[cfg(test)]
pub use tests::{pane, read};

#[cfg(test)]
mod tests {
    //! Panes for tests, and a reader of the text over them.

    use a3_core::{Simulation, integrators};
    use a3_media::show::{Manner, Show};

    use super::style::PAPER;
    use super::text::show;
    use crate::session::{Pane, Readings};

    /// Returns the text over panes in a window of a size (points), and the rectangles of the
    /// sheets. Nothing may be cut off.
    pub fn read(panes: &[Pane], readings: &Readings, size: [f32; 2]) -> (String, Vec<egui::Rect>) {
        fn collect(shape: &egui::Shape, words: &mut String, sheets: &mut Vec<egui::Rect>) {
            match shape {
                egui::Shape::Text(text) => words.extend([text.galley.text(), "\n"]),
                egui::Shape::Rect(rect) if rect.fill == PAPER => sheets.push(rect.rect),
                egui::Shape::Vec(shapes) => shapes
                    .iter()
                    .for_each(|shape| collect(shape, words, sheets)),
                _ => {}
            }
        }
        let ctx = crate::hud::style::context();
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        let mut output = egui::FullOutput::default();
        // The first pass measures the layout, the next ones draw it.
        for pass in 0..3 {
            let input = egui::RawInput {
                screen_rect: Some(screen),
                time: Some(f64::from(pass)),
                ..Default::default()
            };
            output.textures_delta.set.clear();
            output.textures_delta.free.clear();
            output = ctx.run_ui(input, |ui| {
                let _ = show(ui.ctx(), panes, readings);
            });
        }
        let (mut words, mut sheets) = (String::new(), vec![]);
        for clipped in &output.shapes {
            let cut = clipped.clip_rect.intersect(screen).expand(1.0);
            if let egui::Shape::Text(text) = &clipped.shape {
                let rect = text.visual_bounding_rect();
                assert!(
                    cut.contains_rect(rect),
                    "{:?} is cut off in {size:?}",
                    text.galley.text()
                );
            }
            collect(&clipped.shape, &mut words, &mut sheets);
        }
        output.textures_delta.set.clear();
        output.textures_delta.free.clear();
        (words, sheets)
    }

    pub fn pane(scene: &str, method: &str, step: f64) -> Pane {
        let setup = a3_scenes::find(scene).unwrap().build(None).unwrap();
        let method = integrators::find(method).unwrap();
        let simulation = Simulation::new(setup.scene, method, method.control(step)).unwrap();
        Pane::new(simulation, Show::new(setup.presentation, Manner::default()))
    }
}
