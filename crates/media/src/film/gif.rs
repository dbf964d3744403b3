//! Animated GIFs. Each frame has a palette of up to 255 colours, and contains only the part that
//! has changed since the frame before.
//!
//! Colour quantisation: a few colours for a picture that has many. The cube of colours is divided
//! into boxes: repeatedly, the box with the largest variance along an axis is split at its mean on
//! that axis (Heckbert, *Color Image Quantization*, 1982; by variance as in Wu, *Graphics Gems II*,
//! 1991).

use std::io;
use std::ops::Range;
use std::path::Path;

use a3_files::failure::Failure;
use a3_files::output::{Draft, not_written};
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};

use super::shoot::Film;

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
                Failure::usage(format!("the sides of a GIF must be at most {} pixels", u16::MAX))
            })
        };
        let (across, down) = (side(width)?, side(height)?);
        let encoder = Encoder::new(Draft::new(path)?, across, down, &[]);
        let mut encoder = encoder.map_err(|e| not_written(path, &cause(e)))?;
        encoder.set_repeat(Repeat::Infinite).map_err(|e| failure(&encoder, e))?;
        Ok(Self { encoder, size: (width, height), delay: delay as u16, shown: None, transparent })
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
        let new: Vec<bool> =
            pixels.chunks_exact(4).enumerate().map(|(k, pixel)| self.is_new(k, pixel)).collect();
        let sent = || (0..new.len()).filter(|&k| new[k]);
        let palette = Palette::of(sent().map(color), 255);
        // The index after the last colour stands for transparent pixels.
        let none = palette.colors.len() as u8;
        let index = |k: usize| {
            if new[k] { palette.index(color(k)) } else { none }
        };
        let (columns, rows) = bounds(sent(), width);
        let part = rows.clone().flat_map(|y| columns.clone().map(move |x| y * width + x));
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
        self.encoder.write_frame(&frame).map_err(|e| failure(&self.encoder, e))
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

/// Bits of each channel that distinguish the cells of the cube.
const BITS: usize = 7;

/// The colours of a picture, and the index of the colour that replaces each other one.
pub struct Palette {
    /// The colours in sRGB.
    pub colors: Vec<[u8; 3]>,
    /// The index of the colour of each cell.
    index: Vec<u8>,
}

/// The colours of a picture in one cell of the cube.
#[derive(Clone, Copy)]
struct ColourCell {
    /// The number of the cell.
    number: usize,
    /// The number of pixels.
    count: f64,
    /// The mean colour.
    mean: [f64; 3],
}

/// Cells that share a colour of the palette.
struct ColorBox {
    cells: Vec<ColourCell>,
    /// The mean colour.
    mean: [f64; 3],
    /// The axis with the largest variance.
    axis: usize,
    /// The sum of squared deviations on that axis.
    spread: f64,
}

impl Palette {
    /// Chooses at most `most` colours for these colours. `most` is at most 256.
    pub fn of(colors: impl Iterator<Item = [u8; 3]>, most: usize) -> Self {
        let mut boxes: Vec<_> = Some(cells(colors))
            .filter(|cells| !cells.is_empty())
            .map(ColorBox::of)
            .into_iter()
            .collect();
        while boxes.len() < most {
            let widest =
                (0..boxes.len()).max_by(|&a, &b| boxes[a].spread.total_cmp(&boxes[b].spread));
            let Some(widest) = widest.filter(|&k| boxes[k].spread > 0.0) else {
                break;
            };
            let (low, high) = boxes.swap_remove(widest).halves();
            // Because of rounding, the mean may be at an end of the box.
            if low.is_empty() || high.is_empty() {
                boxes.push(ColorBox { spread: 0.0, ..ColorBox::of([low, high].concat()) });
                continue;
            }
            boxes.extend([ColorBox::of(low), ColorBox::of(high)]);
        }
        let mut index = vec![0; 1 << (3 * BITS)];
        for (k, group) in boxes.iter().enumerate() {
            for cell in &group.cells {
                index[cell.number] = k as u8;
            }
        }
        let colors = boxes.iter().map(|group| group.mean.map(|c| c.round() as u8));
        Self { colors: colors.collect(), index }
    }

    /// Returns the index of the colour that replaces `color`, which must be one of those that the
    /// palette was made for.
    pub fn index(&self, color: [u8; 3]) -> u8 {
        self.index[cell_of(color)]
    }
}

impl ColorBox {
    /// Creates the box of these cells.
    fn of(cells: Vec<ColourCell>) -> Self {
        let count: f64 = cells.iter().map(|cell| cell.count).sum();
        let sum = |of: &dyn Fn(&ColourCell) -> f64| {
            cells.iter().map(|cell| cell.count * of(cell)).sum::<f64>()
        };
        let mean = [0, 1, 2].map(|axis| sum(&|cell| cell.mean[axis]) / count);
        let squares = [0, 1, 2].map(|axis| sum(&|cell| (cell.mean[axis] - mean[axis]).powi(2)));
        let axis = (0..3).fold(0, |a, b| if squares[b] > squares[a] { b } else { a });
        Self { mean, axis, spread: if cells.len() > 1 { squares[axis] } else { 0.0 }, cells }
    }

    /// Splits the cells into those below the mean on the axis of the box, and the others.
    fn halves(self) -> (Vec<ColourCell>, Vec<ColourCell>) {
        let (axis, mean) = (self.axis, self.mean);
        self.cells.into_iter().partition(|cell| cell.mean[axis] < mean[axis])
    }
}

/// Returns the cells that contain these colours.
fn cells(colors: impl Iterator<Item = [u8; 3]>) -> Vec<ColourCell> {
    let mut colors: Vec<_> = colors.map(|color| (cell_of(color), color)).collect();
    colors.sort_unstable();
    let groups = colors.chunk_by(|a, b| a.0 == b.0);
    groups
        .map(|group| {
            let count = group.len() as f64;
            let sum = |axis: usize| group.iter().map(|(_, c)| f64::from(c[axis])).sum::<f64>();
            ColourCell { number: group[0].0, count, mean: [0, 1, 2].map(|axis| sum(axis) / count) }
        })
        .collect()
}

/// Returns the number of the cell of a colour.
fn cell_of(color: [u8; 3]) -> usize {
    color.iter().fold(0, |number, &c| number << BITS | usize::from(c) >> (8 - BITS))
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
            .map(|frame| (frame.left, frame.top, frame.width, frame.height, frame.buffer.to_vec()))
            .collect();
        let (blue, none) = ([0, 0, 255, 255], [0; 4]);
        let part = [blue, none, none, none, none, blue].concat();
        assert_eq!(places.len(), 3);
        assert_eq!(places[0], (0, 0, 5, 4, [200, 100, 50, 255].repeat(20)));
        assert_eq!(places[1], (0, 0, 1, 1, none.to_vec()));
        assert_eq!(places[2], (1, 1, 3, 2, part));
    }

    #[test]
    fn few_colors_are_kept_as_they_are() {
        let colors = [[0, 0, 0], [255, 255, 255], [200, 30, 40], [90, 90, 90], [90, 90, 96]];
        let palette = Palette::of(colors.iter().chain(&colors[1..3]).copied(), 255);
        assert_eq!(palette.colors.len(), colors.len());
        for color in colors {
            assert_eq!(palette.colors[usize::from(palette.index(color))], color);
        }
        assert!(Palette::of(std::iter::empty(), 255).colors.is_empty());
    }

    #[test]
    fn many_colors_are_told_apart_evenly() {
        let ramp = |n: u8| {
            (0..=255).flat_map(move |k| [[k, k / 2, k / 4]; 3].into_iter().take(usize::from(n)))
        };
        for (most, worst) in [(64, 4), (16, 12), (2, 80)] {
            let palette = Palette::of(ramp(2), most);
            assert!(palette.colors.len() <= most);
            for color in ramp(1) {
                let shown = palette.colors[usize::from(palette.index(color))];
                assert!(shown[0].abs_diff(color[0]) <= worst, "{most}: {color:?} as {shown:?}");
            }
        }
    }
}
