//! Films: their frames, as other programs read them, and the frames of films that end early.

mod endings;
mod gif;
mod mp4;
mod pictures;

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use crate::common::{Words, a3, gpu_is_missing, text};
use image::codecs::gif::GifDecoder;
use image::{AnimationDecoder, Frame, RgbaImage};

/// Returns the arguments of a film of the cloth, with its file and further arguments.
fn with(output: &str) -> String {
    format!("render v 0.01 --until 0.5 --size 160x120 --output {output}")
}

/// Makes a film. Returns false if there is no adapter to draw with.
fn made(folder: &Path, words: impl Words) -> bool {
    let output = a3(folder, &words);
    if gpu_is_missing(&output) {
        return false;
    }
    assert!(output.status.success(), "{words:?}: {}", text(&output.stderr));
    true
}

fn frames(path: &Path) -> Vec<Frame> {
    let decoder = GifDecoder::new(BufReader::new(File::open(path).unwrap())).unwrap();
    decoder.into_frames().collect_frames().unwrap()
}

fn picture(folder: &Path, name: &str) -> RgbaImage {
    image::open(folder.join(name)).unwrap().to_rgba8()
}

/// Returns the largest and the mean difference of a channel.
fn difference(a: &RgbaImage, b: &RgbaImage) -> (u8, f64) {
    assert_eq!(a.dimensions(), b.dimensions());
    let off: Vec<u8> = a.iter().zip(b.iter()).map(|(a, b)| a.abs_diff(*b)).collect();
    let sum: f64 = off.iter().map(|off| f64::from(*off)).sum();
    (off.iter().copied().max().unwrap_or(0), sum / off.len() as f64)
}
