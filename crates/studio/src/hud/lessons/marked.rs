//! Text of a lesson with its marks: code, and words in italics or bold.

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId};

use super::super::panel::INK;

/// Lays out words in a colour, in lines of a width. Code and emphasised words stand out, without
/// their marks.
pub fn job(words: &str, size: f32, colour: Color32, width: f32) -> LayoutJob {
    let mut job = LayoutJob::default();
    job.wrap.max_width = width;
    let line_height = Some((1.36 * size).round());
    let mut add = |part: &str, colour| {
        let format = TextFormat {
            line_height,
            ..TextFormat::simple(FontId::proportional(size), colour)
        };
        job.append(part, 0.0, format);
    };
    for (k, part) in words.split('`').enumerate() {
        if k % 2 == 1 {
            add(part, INK);
            continue;
        }
        for (k, part) in part.replace("**", "*").split('*').enumerate() {
            add(part, if k % 2 == 1 { INK } else { colour });
        }
    }
    job
}
