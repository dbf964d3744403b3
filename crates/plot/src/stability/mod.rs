//! Stability regions in the plane of h λ, with the eigenvalues of a problem times the
//! step, and a panel for each method.

mod region;

pub use region::Region;

use crate::error::Error;
use crate::figure::Figure;
use crate::geometry::{Point, Rect};
use crate::label::{GREY, Label};
use crate::layout::{self, Level, Sign};
use region::{Extent, Fate, beyond, region_paint, sign};

/// A chart of the stability regions of several methods.
pub struct StabilityRegions {
    /// The title.
    pub title: String,
    /// A line below the title; left out if there is no space for it.
    pub subtitle: String,
    /// A note on the titles of the panels, at the end of the explanation below them; may be empty.
    pub note: String,
    /// The regions, with a panel for each.
    pub regions: Vec<Region>,
}

/// Largest real or imaginary part that panels show for any regions.
const MAX_PART: f64 = 8.0;

/// The explanation below the panels.
const FOOT: &str = "h in s, λ in 1/s, so h λ has no unit. Real parts are growth or decay, \
    imaginary parts oscillation; what lies in the region does not grow.";

impl StabilityRegions {
    /// Draws the chart on a sheet of this width and height.
    ///
    /// # Errors
    /// [`Error::Empty`] if there is no region; [`Error::Sheet`] or [`Error::TooSmall`] if the chart
    /// does not fit on the sheet.
    pub fn draw(&self, width: f64, height: f64) -> Result<Figure, Error> {
        if self.regions.is_empty() {
            return Err(Error::Empty("no method to draw"));
        }
        let extent = self.extent();
        layout::fit([width, height], |figure, level| self.try_draw(figure, level, extent))
    }

    /// Returns the extent of all panels: that of the largest region, limited so that small ones are
    /// still visible beside it.
    fn extent(&self) -> Extent {
        let own = self.regions.iter().map(Region::extent);
        let all = own.reduce(Extent::with_all).unwrap_or_default();
        all.within(MAX_PART)
    }

    /// Draws the chart at this level; `None` if its panels would be too small.
    fn try_draw(&self, mut figure: Figure, level: Level, extent: Extent) -> Option<Figure> {
        let size = level.size;
        let foot = format!("{FOOT} {}", self.note);
        let foot = foot.trim_end();
        let mut left = layout::headings(&mut figure, [&self.title, &self.subtitle, foot], level);
        layout::legend(&mut figure, &mut left, &self.entries(size, extent), size);
        let inner = Rect::new(left.x0 + 1.6 * size, left.y0, left.x1, left.y1 - 1.5 * size);
        let (below, beside) = (left.across(inner.x0, left.x1), left.down_to(inner.y1));
        layout::label_below(&mut figure, below, "Re(h λ)", "", size);
        layout::label_left(&mut figure, beside, "Im(h λ)", "", size);
        let small = 0.85 * size;
        let room = |[w, h]: Point| [w - 2.4 * small, h - 4.6 * size];
        let merit = |cell: Point| {
            let [w, h] = room(cell);
            extent.unit(w, h)
        };
        let (rooms, _) = layout::grid(self.regions.len(), inner, 1.2 * size, merit);
        let width = rooms[0].width();
        // Each panel has as many lines above it as the longest text needs, so that the panels of a
        // row are aligned.
        let words = |region: &Region| {
            [(&region.title, size), (&region.subtitle, small)]
                .map(|(text, size)| layout::wrap(text, size, width))
        };
        let mut words: Vec<_> = self.regions.iter().map(words).collect();
        if level.full && words.iter().flatten().any(|lines| lines.len() > 3) {
            return None;
        }
        if !level.full {
            let all = words.iter_mut().flatten();
            all.for_each(|lines| lines.truncate(1));
        }
        let depth = |k: usize| words.iter().map(|words| words[k].len()).max();
        let depth = [0, 1].map(|k| depth(k).unwrap_or(0) as f64);
        let above = 1.2 * size * depth[0] + 1.2 * small * depth[1] + 0.3 * size;
        for (k, (region, cell)) in self.regions.iter().zip(rooms).enumerate() {
            let [title, subtitle] = &words[k];
            let mut y = cell.y0;
            for line in title {
                figure.text([cell.x0, y + 0.8 * size], Label::new(line, size).bold());
                y += 1.2 * size;
            }
            for line in subtitle {
                let label = Label::new(line, small).colour(GREY);
                figure.text([cell.x0, y + 0.8 * small], label);
                y += 1.2 * small;
            }
            let (x0, y0) = (cell.x0 + 2.4 * small, cell.y0 + above);
            let area = Rect::new(x0, y0, cell.x1, cell.y1 - 1.3 * small);
            if area.width() < 4.5 * size || area.height() < 4.5 * size {
                return None;
            }
            region.draw(&mut figure, area, extent, small);
        }
        Some(figure)
    }

    /// Lists the entries of the legend.
    fn entries(&self, size: f64, extent: Extent) -> Vec<(String, Sign<'_>)> {
        let sample: Sign = Box::new(move |figure, [x, y]| {
            let room = Rect::spread([x, y], 1.2 * size, 0.45 * size);
            figure.rect(room, region_paint(GREY, 0.1 * size));
        });
        let mark =
            |fate| -> Sign { Box::new(move |figure, at| sign(figure, at, 0.85 * size, fate)) };
        let mut entries = vec![
            ("stable region".to_owned(), sample),
            ("eigenvalue times step".to_owned(), mark(Fate::Bounded)),
            ("the same, growing slowly".to_owned(), mark(Fate::Slow)),
            ("the same, growing fast".to_owned(), mark(Fate::Fast)),
        ];
        let mut all = self.regions.iter().flat_map(|region| &region.eigenvalues);
        if all.any(|z| extent.with(*z) != extent) {
            let wedge: Sign = Box::new(move |figure, [x, y]| {
                beyond(figure, [x, y], [x - 1.0, y], 0.3 * size, GREY);
            });
            entries.push(("farther out".to_owned(), wedge));
        }
        entries
    }
}
