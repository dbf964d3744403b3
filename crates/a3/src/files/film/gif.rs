//! Animated GIFs. Each frame has a palette of up to 255 colours, and contains only the part that
//! has changed since the frame before.

use std::io;
use std::ops::Range;
use std::path::Path;

use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};

use super::format::Film;
use super::palette::Palette;
use crate::base::failure::Failure;
use crate::files::output::{Draft, not_written};

/// Shortest delay that players obey (1/100 s).
const MIN_DELAY: f64 = 2.0;

/// Largest difference of a channel, of 255 levels, at which a pixel counts as unchanged.
const MAX_UNSEEN: u8 = 3;

/// An animated GIF that is being written.
pub struct Gif {
    encoder: Encoder<Draft>,
    /// Width and height (px).
    size: (u32, u32),
    /// Delay of each frame (1/100 s).
    delay: u16,
    /// The colours on the screen after the last frame.
    shown: Option<Vec<[u8; 3]>>,
    transparent: bool,
}

/// Returns the whole delay (1/100 s) that is nearest to a rate (frames per second).
pub fn delay(fps: f64) -> f64 {
    (100.0 / fps).round().max(MIN_DELAY)
}

impl Gif {
    /// Creates a GIF of this size (px), whose frames have this delay (1/100 s).
    pub fn new(
        path: &Path,
        (width, height): (u32, u32),
        delay: f64,
        transparent: bool,
    ) -> Result<Self, Failure> {
        let side = |side| {
            u16::try_from(side).map_err(|_| {
                Failure::usage(format!(
                    "the sides of a GIF must be at most {} pixels",
                    u16::MAX
                ))
            })
        };
        let (across, down) = (side(width)?, side(height)?);
        let encoder = Encoder::new(Draft::new(path)?, across, down, &[]);
        let mut encoder = encoder.map_err(|e| not_written(path, &cause(e)))?;
        encoder
            .set_repeat(Repeat::Infinite)
            .map_err(|e| failure(&encoder, e))?;
        Ok(Self {
            encoder,
            size: (width, height),
            delay: delay as u16,
            shown: None,
            transparent,
        })
    }

    /// Returns whether pixel k is part of the next frame: in a transparent film if it is opaque, in
    /// any other if it has changed.
    fn is_new(&self, k: usize, pixel: &[u8]) -> bool {
        match &self.shown {
            _ if self.transparent => pixel[3] >= 128,
            None => true,
            Some(shown) => (0..3).any(|c| shown[k][c].abs_diff(pixel[c]) > MAX_UNSEEN),
        }
    }
}

impl Film for Gif {
    fn add(&mut self, pixels: &[u8]) -> Result<(), Failure> {
        let width = self.size.0 as usize;
        let color = |k: usize| [pixels[4 * k], pixels[4 * k + 1], pixels[4 * k + 2]];
        let new: Vec<bool> = pixels
            .chunks_exact(4)
            .enumerate()
            .map(|(k, pixel)| self.is_new(k, pixel))
            .collect();
        let sent = || (0..new.len()).filter(|&k| new[k]);
        let palette = Palette::of(sent().map(color), 255);
        // The index after the last colour stands for transparent pixels.
        let none = palette.colors.len() as u8;
        let index = |k: usize| {
            if new[k] {
                palette.index(color(k))
            } else {
                none
            }
        };
        let (columns, rows) = bounds(sent(), width);
        let part = rows
            .clone()
            .flat_map(|y| columns.clone().map(move |x| y * width + x));
        let mut frame = Frame {
            delay: self.delay,
            left: columns.start as u16,
            top: rows.start as u16,
            width: columns.len() as u16,
            height: rows.len() as u16,
            transparent: Some(none),
            palette: Some([&palette.colors[..], &[[0; 3]]].concat().concat()),
            buffer: part.map(index).collect::<Vec<_>>().into(),
            ..Frame::default()
        };
        if self.transparent {
            // The frame is cleared before the next one, because a frame cannot make pixels
            // transparent again.
            frame.dispose = DisposalMethod::Background;
        }
        let shown = self.shown.get_or_insert_with(|| vec![[0; 3]; new.len()]);
        for k in sent() {
            shown[k] = palette.colors[usize::from(palette.index(color(k)))];
        }
        self.encoder
            .write_frame(&frame)
            .map_err(|e| failure(&self.encoder, e))
    }

    fn finish(self: Box<Self>) -> Result<(), Failure> {
        let path = self.encoder.get_ref().path().to_owned();
        let draft = self.encoder.into_inner();
        draft.map_err(|e| not_written(&path, &cause(e)))?.place()
    }
}

/// Returns the columns and the rows of the smallest rectangle around these pixels; one pixel if
/// there are none.
fn bounds(pixels: impl Iterator<Item = usize>, width: usize) -> (Range<usize>, Range<usize>) {
    let join = |a: Range<usize>, b: Range<usize>| a.start.min(b.start)..a.end.max(b.end);
    pixels
        .map(|k| (k % width, k / width))
        .map(|(x, y)| (x..x + 1, y..y + 1))
        .reduce(|a, b| (join(a.0, b.0), join(a.1, b.1)))
        .unwrap_or((0..1, 0..1))
}

/// Converts an error of the encoder.
fn failure(encoder: &Encoder<Draft>, error: EncodingError) -> Failure {
    encoder.get_ref().failure(&cause(error))
}

/// Returns the I/O error in an error of the encoder.
fn cause(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        error => io::Error::other(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame is the smallest rectangle around the changed pixels, or one pixel if none changed.
    #[test]
    fn only_what_changed_is_sent() {
        let folder = tempfile::tempdir().ok().unwrap();
        let path = folder.path().join("x.gif");
        let mut film = Box::new(Gif::new(&path, (5, 4), 4.0, false).ok().unwrap());
        let mut picture = [200, 100, 50, 255].repeat(20);
        let mut add = |picture: &[u8]| assert!(film.add(picture).is_ok());
        add(&picture);
        // A change too small to be seen.
        picture[0] = 201;
        add(&picture);
        for pixel in [1 + 5, 3 + 5 * 2] {
            picture[4 * pixel..4 * pixel + 3].copy_from_slice(&[0, 0, 255]);
        }
        add(&picture);
        assert!(film.finish().is_ok());
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let file = std::fs::File::open(path).ok().unwrap();
        let mut decoder = options.read_info(file).ok().unwrap();
        let mut next = || decoder.read_next_frame().ok().flatten().cloned();
        let places: Vec<_> = std::iter::from_fn(&mut next)
            .map(|frame| {
                (
                    frame.left,
                    frame.top,
                    frame.width,
                    frame.height,
                    frame.buffer.to_vec(),
                )
            })
            .collect();
        let (blue, none) = ([0, 0, 255, 255], [0; 4]);
        let part = [blue, none, none, none, none, blue].concat();
        assert_eq!(places.len(), 3);
        assert_eq!(places[0], (0, 0, 5, 4, [200, 100, 50, 255].repeat(20)));
        assert_eq!(places[1], (0, 0, 1, 1, none.to_vec()));
        assert_eq!(places[2], (1, 1, 3, 2, part));
    }
}
