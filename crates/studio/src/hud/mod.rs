//! Everything that egui draws: the text over the picture, the bar below it, lists, and the panel of
//! knobs and plots.

mod all;
mod bar;
mod charts;
mod dock;
pub mod edit;
mod help;
pub mod layout;
mod legend;
mod lessons;
mod list;
mod marks;
mod measure;
mod offers;
mod overlay;
mod panel;
#[cfg(not(target_arch = "wasm32"))]
mod picture;
pub mod plotting;
mod style;
mod text;
mod widgets;
#[cfg(test)]
mod window;
mod words;

pub use all::show_all;
pub use overlay::Overlay;
pub use panel::csv;
#[cfg(not(target_arch = "wasm32"))]
pub use picture::{Studio, caption};
pub use widgets::asked;
#[cfg(not(target_arch = "wasm32"))]
pub use words::digits;

#[cfg(test)]
pub use tests::{pane, read};

#[cfg(test)]
mod tests {
    //! Panes for tests, and a reader of the text over them.

    use a3_core::{Simulation, integrators};
    use a3_media::show::{Manner, Show};
    use egui::{Rect, Shape};

    use super::style::PAPER;
    use super::text::show_text;
    use super::window::Window;
    use crate::session::{Pane, Readings};

    /// Returns the text over panes in a window of a size (points), and the rectangles of the
    /// sheets. Nothing may be cut off.
    pub fn read(panes: &[Pane], readings: &Readings, size: [f32; 2]) -> (String, Vec<Rect>) {
        fn sheets(shape: &Shape, found: &mut Vec<Rect>) {
            match shape {
                Shape::Rect(rect) if rect.fill == PAPER => found.push(rect.rect),
                Shape::Vec(shapes) => shapes.iter().for_each(|shape| sheets(shape, found)),
                _ => {}
            }
        }
        let mut window = Window::new(size);
        window.step = 1.0;
        // The first pass measures the layout, the next ones draw it.
        for _ in 0..3 {
            window.frame([0.0; 2], vec![], |ctx| show_text(ctx, panes, readings));
        }
        window.read();
        let mut found = vec![];
        for clipped in &window.shapes {
            sheets(&clipped.shape, &mut found);
        }
        (window.words(), found)
    }

    pub fn pane(scene: &str, method: &str, step: f64) -> Pane {
        let setup = a3_scenes::find(scene).unwrap().build(None).unwrap();
        let method = integrators::find(method).unwrap();
        let simulation = Simulation::new(setup.scene, method, method.control(step)).unwrap();
        Pane::new(simulation, Show::new(setup.presentation, Manner::default()))
    }
}
