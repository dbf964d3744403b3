//! Colour quantisation: a few colours for a picture that has many. The cube of colours is divided
//! into boxes: repeatedly, the box with the largest variance along an axis is split at its mean on
//! that axis (Heckbert, *Color Image Quantization*, 1982; by variance as in Wu, *Graphics Gems II*,
//! 1991).

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
struct Cell {
    /// The number of the cell.
    number: usize,
    /// The number of pixels.
    count: f64,
    /// The mean colour.
    mean: [f64; 3],
}

/// Cells that share a colour of the palette.
struct ColorBox {
    cells: Vec<Cell>,
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
                boxes.push(ColorBox {
                    spread: 0.0,
                    ..ColorBox::of([low, high].concat())
                });
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
        let colors = boxes
            .iter()
            .map(|group| group.mean.map(|c| c.round() as u8));
        Self {
            colors: colors.collect(),
            index,
        }
    }

    /// Returns the index of the colour that replaces `color`, which must be one of those that the
    /// palette was made for.
    pub fn index(&self, color: [u8; 3]) -> u8 {
        self.index[cell_of(color)]
    }
}

impl ColorBox {
    /// Creates the box of these cells.
    fn of(cells: Vec<Cell>) -> Self {
        let count: f64 = cells.iter().map(|cell| cell.count).sum();
        let sum =
            |of: &dyn Fn(&Cell) -> f64| cells.iter().map(|cell| cell.count * of(cell)).sum::<f64>();
        let mean = [0, 1, 2].map(|axis| sum(&|cell| cell.mean[axis]) / count);
        let squares = [0, 1, 2].map(|axis| sum(&|cell| (cell.mean[axis] - mean[axis]).powi(2)));
        let axis = (0..3).fold(0, |a, b| if squares[b] > squares[a] { b } else { a });
        Self {
            mean,
            axis,
            spread: if cells.len() > 1 { squares[axis] } else { 0.0 },
            cells,
        }
    }

    /// Splits the cells into those below the mean on the axis of the box, and the others.
    fn halves(self) -> (Vec<Cell>, Vec<Cell>) {
        let (axis, mean) = (self.axis, self.mean);
        self.cells
            .into_iter()
            .partition(|cell| cell.mean[axis] < mean[axis])
    }
}

/// Returns the cells that contain these colours.
fn cells(colors: impl Iterator<Item = [u8; 3]>) -> Vec<Cell> {
    let mut colors: Vec<_> = colors.map(|color| (cell_of(color), color)).collect();
    colors.sort_unstable();
    let groups = colors.chunk_by(|a, b| a.0 == b.0);
    groups
        .map(|group| {
            let count = group.len() as f64;
            let sum = |axis: usize| group.iter().map(|(_, c)| f64::from(c[axis])).sum::<f64>();
            Cell {
                number: group[0].0,
                count,
                mean: [0, 1, 2].map(|axis| sum(axis) / count),
            }
        })
        .collect()
}

/// Returns the number of the cell of a colour.
fn cell_of(color: [u8; 3]) -> usize {
    color.iter().fold(0, |number, &c| {
        number << BITS | usize::from(c) >> (8 - BITS)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colors_are_kept_as_they_are() {
        let colors = [
            [0, 0, 0],
            [255, 255, 255],
            [200, 30, 40],
            [90, 90, 90],
            [90, 90, 96],
        ];
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
                assert!(
                    shown[0].abs_diff(color[0]) <= worst,
                    "{most}: {color:?} as {shown:?}"
                );
            }
        }
    }
}
