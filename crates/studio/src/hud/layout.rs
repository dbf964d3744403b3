//! Layout of the window: picture, panes and bars.

use a3_render::Tile;
use egui::{Context, Rect, pos2};

use super::dock::Pane;
use super::{lessons, measure, panel, plotting};
use crate::session::{IS_PAGE, RunAction, Session};

/// Distance between panes (points).
const PANE_GAP: f32 = 3.0;

/// Height of the bar below the picture (points).
const BAR_HEIGHT: f32 = 40.0;
/// Height of the bar for fingers (points).
const TOUCH_BAR_HEIGHT: f32 = 48.0;

/// Height of the timeline where it lies above the buttons of the bar (points).
const TIMELINE_HEIGHT: f32 = 32.0;
/// Width of a window in which the timeline has room between the buttons (points).
const WIDTH_OF_ONE_ROW: f32 = 670.0;
/// Height of a window that has room for both (points).
const HEIGHT_OF_TWO_ROWS: f32 = 420.0;

/// Returns the heights of the timeline above the buttons of the bar below the picture, or 0 where
/// it lies between them, and of the buttons, in a window of a size (points). For fingers buttons
/// are higher, and a small window has none.
pub fn bar_rows(session: &Session, [width, height]: [f32; 2]) -> [f32; 2] {
    if width < 280.0 || height < 240.0 {
        return [0.0; 2];
    }
    let narrower = beside(session).filter(|_| !is_bar_whole(session, width));
    let room = width - narrower.map_or(0.0, |pane| pane.taken([width, height])[0]);
    let is_above =
        room < WIDTH_OF_ONE_ROW && height >= HEIGHT_OF_TWO_ROWS && !session.panel.editor.open;
    let buttons = if session.readings.touch { TOUCH_BAR_HEIGHT } else { BAR_HEIGHT };
    [if is_above { TIMELINE_HEIGHT } else { 0.0 }, buttons]
}

/// Returns the height of the bar below the picture, in a window of a size (points).
pub fn bar_height(session: &Session, window: [f32; 2]) -> f32 {
    bar_rows(session, window).iter().sum()
}

/// Returns the pane that is open beside the picture, if one is, and the help does not hide it.
pub fn beside(session: &Session) -> Option<&'static Pane> {
    match session.panel.beside.filter(|_| !session.readings.help)? {
        RunAction::Panel => Some(&panel::PANE),
        RunAction::Lessons => Some(&lessons::PANE),
        RunAction::Measure if !IS_PAGE => Some(&measure::PANE),
        RunAction::Plots => Some(&plotting::PANE),
        _ => None,
    }
}

/// Returns whether the bar runs below both the picture and the open pane, in a window of a width
/// (points).
pub fn is_bar_whole(session: &Session, width: f32) -> bool {
    beside(session).is_some_and(|pane| pane.is_narrow(width))
}

/// Returns whether what is open covers the picture, in a window of a size (points).
pub fn is_covered(session: &Session, window: [f32; 2]) -> bool {
    beside(session).is_some_and(|pane| pane.covers(window))
}

/// Returns the size (px) of the picture beside what is open, and above the bar, in a window of
/// `size` (px) at `scale` pixels per point.
pub fn picture_size(session: &Session, size: (u32, u32), scale: f32) -> (u32, u32) {
    let window = [size.0, size.1].map(|side| side as f32 / scale);
    let [right, below] = beside(session).map_or([0.0; 2], |pane| pane.taken(window));
    let [right, below] =
        [right, below + bar_height(session, window)].map(|a| (a * scale).round() as u32);
    let [width, height] =
        [(size.0, right), (size.1, below)].map(|(a, b)| a.saturating_sub(b).max(1));
    (width, height)
}

/// Returns the width on the right and the height below that are not available to text (points).
pub fn insets(session: &Session, size: (u32, u32), scale: f32) -> [f32; 2] {
    let picture = picture_size(session, size, scale);
    [size.0 - picture.0, size.1 - picture.1].map(|side| side as f32 / scale)
}

/// Returns the height of the bar above several panes, in a window of a width (points). In a narrow
/// window it has two lines.
pub fn bar(width: f32) -> f32 {
    if width < 640.0 { 48.0 } else { 30.0 }
}

/// Returns the parts of a target of `size` (px), at `scale` pixels per point, for a number of
/// panes. One pane fills the target. Several are below the bar: in a row, a column, or two rows of
/// two, whichever makes them closest to squares.
pub fn tiles(panes: usize, size: (u32, u32), scale: f32) -> Vec<Tile> {
    if panes < 2 {
        return vec![Tile::whole(size)];
    }
    let gap = (PANE_GAP * scale).round().max(1.0) as u32;
    let bar = (bar(size.0 as f32 / scale) * scale).round() as u32;
    // In the smallest windows, the bar takes at most a third.
    let bar = (bar + gap).min(size.1 / 3);
    let room = (size.0, size.1 - bar);
    let part = |side: u32, count: u32| (side.saturating_sub(gap * (count - 1)) / count).max(1);
    let count = panes as u32;
    let grids = [(count, 1), (1, count), (2, 2)];
    let lengthiness = |(columns, rows): &(u32, u32)| {
        (part(room.0, *columns) as f32 / part(room.1, *rows) as f32).ln().abs()
    };
    let (columns, rows) = grids
        .into_iter()
        .filter(|(columns, rows)| columns * rows == count)
        .min_by(|a, b| lengthiness(a).total_cmp(&lengthiness(b)))
        .unwrap_or((count, 1));
    let span = |k: u32, side: u32, count: u32| {
        let (from, to) = (k * (side + gap) / count, (k + 1) * (side + gap) / count);
        // Keep a pane inside the target even if that is smaller than the gaps.
        let from = from.min(side - 1);
        (from, to.saturating_sub(from + gap).clamp(1, side - from))
    };
    (0..count)
        .map(|k| {
            let (x, width) = span(k % columns, room.0, columns);
            let (y, height) = span(k / columns, room.1, rows);
            Tile { x, y: bar + y, width, height }
        })
        .collect()
}

/// Returns the parts of a window (px) for a number of panes, each with its place (points).
pub fn tiles_in(ctx: &Context, panes: usize) -> Vec<(Tile, Rect)> {
    let (size, scale) = (ctx.content_rect().size(), ctx.pixels_per_point());
    let size = [size.x, size.y].map(|side| (side * scale).round() as u32);
    let place = |tile: Tile| {
        let corner = pos2(tile.x as f32, tile.y as f32) / scale;
        let size = points(tile, scale).into();
        (tile, Rect::from_min_size(corner, size))
    };
    let tiles = tiles(panes, size.into(), scale).into_iter();
    tiles.map(place).collect()
}

/// Width and height of the readings of a single pane (points).
const READINGS: [f32; 2] = [300.0, 235.0];
/// Height of the most important ones, and of the time alone (points).
const FEW_READINGS: [f32; 2] = [84.0, 62.0];
/// Smallest width of the caption of one of several panes (points), and its share of the pane's
/// width.
const CAPTION_WIDTH: (f32, f32) = (210.0, 0.42);
/// Heights of the caption of one of several panes: of all text, the most important one, and a name
/// (points).
const CAPTION_HEIGHTS: [f32; 3] = [180.0, 84.0, 44.0];
/// Smallest width of a pane with more than a name (points).
const MIN_CAPTION_WIDTH: f32 = 150.0;
/// Share of the shorter side of a pane that its free part has at least beside each amount of text.
const MIN_FREE: [f32; 3] = [0.65, 0.42, 0.4];

/// Amount of text in a pane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Text {
    Whole,
    /// The most important text.
    Few,
    /// The name of what is shown.
    Name,
}

impl Text {
    /// Returns how much text each of a number of panes of a size (points) has room for.
    pub fn of(panes: usize, pane: [f32; 2]) -> Self {
        let fits = |text: &Self| {
            let size = text.size(panes, pane);
            let [beside, below] = free(pane, size);
            let is_free = beside.max(below) >= MIN_FREE[*text as usize] * pane[0].min(pane[1]);
            is_free && size[1] <= pane[1]
        };
        let few = Some(Self::Few).filter(|_| pane[0] >= MIN_CAPTION_WIDTH);
        let more = [Some(Self::Whole), few].into_iter().flatten().find(fits);
        more.unwrap_or(Self::Name)
    }

    /// Returns the size of the text in each of a number of panes of a size (points).
    fn size(self, panes: usize, [width, _]: [f32; 2]) -> [f32; 2] {
        match (self, panes) {
            (Self::Whole, 1) => READINGS,
            (Self::Few, 1) => [width, FEW_READINGS[0]],
            (Self::Name, 1) => [width, FEW_READINGS[1]],
            (Self::Whole, _) => [caption_width(width), CAPTION_HEIGHTS[0]],
            (Self::Few, _) => [width, CAPTION_HEIGHTS[1]],
            (Self::Name, _) => [width, CAPTION_HEIGHTS[2]],
        }
    }
}

/// Returns the width and height of a part of a target (points), at `scale` pixels per point.
pub fn points(tile: Tile, scale: f32) -> [f32; 2] {
    [tile.width, tile.height].map(|side| side as f32 / scale)
}

/// Returns the width and the height beside and below a text of a size in a pane of a size (points),
/// each of them no longer than the other side of the pane.
fn free([width, height]: [f32; 2], [wide, high]: [f32; 2]) -> [f32; 2] {
    [(width - wide).min(height), width.min(height - high)]
}

/// Returns the width of the caption of one of several panes, in a pane of a width (points).
pub fn caption_width(width: f32) -> f32 {
    (CAPTION_WIDTH.1 * width).max(CAPTION_WIDTH.0).min(width)
}

/// Returns the part of each of a number of panes of a size (points) in which no text hides the
/// scene: left, top, width and height, as shares of the pane. It is beside the text or below it,
/// whichever is larger, or the whole pane if neither has room.
pub fn focus(panes: usize, pane: [f32; 2]) -> [f32; 4] {
    let [width, height] = pane;
    let text = Text::of(panes, pane);
    let [wide, high] = text.size(panes, pane);
    let [beside, below] = free(pane, [wide, high]);
    if beside.max(below) < MIN_FREE[text as usize] * width.min(height) {
        [0.0, 0.0, 1.0, 1.0]
    } else if beside >= below {
        [wide / width, 0.0, 1.0 - wide / width, 1.0]
    } else {
        [0.0, high / height, 1.0, 1.0 - high / height]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(panes: usize, size: (u32, u32)) -> Vec<(bool, bool)> {
        let tiles = tiles(panes, size, 1.0);
        let first = tiles[0];
        tiles.iter().map(|t| (t.x > first.x, t.y > first.y)).collect()
    }

    #[test]
    fn rows_columns_and_squares() {
        let (right, below) = ((true, false), (false, true));
        assert_eq!(tiles(1, (640, 480), 1.0), [Tile::whole((640, 480))]);
        assert_eq!(corners(2, (1280, 720)), [(false, false), right]);
        assert_eq!(corners(2, (260, 860)), [(false, false), below]);
        assert_eq!(corners(3, (1280, 720)), [(false, false), right, right]);
        assert_eq!(corners(3, (260, 860)), [(false, false), below, below]);
        assert_eq!(corners(4, (1280, 720)), [(false, false), right, below, (true, true)]);
        assert_eq!(corners(4, (260, 860)), [(false, false), below, below, below]);
    }

    #[test]
    fn the_scene_is_beside_the_text_or_below_it() {
        let near = |a: [f32; 4], b: [f32; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.01);
        assert!(near(focus(1, [1200.0, 700.0]), [0.25, 0.0, 0.75, 1.0]));
        assert!(near(focus(1, [500.0, 940.0]), [0.0, 0.25, 1.0, 0.75]));
        assert!(near(focus(2, [640.0, 720.0]), [0.0, 0.25, 1.0, 0.75]));
        assert!(near(focus(4, [1280.0, 400.0]), [0.42, 0.0, 0.58, 1.0]));
        assert!(near(focus(1, [320.0, 240.0]), [0.0, 0.35, 1.0, 0.65]));
        assert!(near(focus(1, [160.0, 120.0]), [0.0, 0.52, 1.0, 0.48]));
        assert!(near(focus(1, [100.0, 60.0]), [0.0, 0.0, 1.0, 1.0]));
    }

    #[test]
    fn tiles_fill_the_target_and_do_not_overlap() {
        for panes in 2..=4 {
            for size in [(1, 1), (2, 9), (64, 48), (333, 777), (1280, 720), (16384, 3)] {
                for scale in [0.5, 1.0, 2.75] {
                    let tiles = tiles(panes, size, scale);
                    assert_eq!(tiles.len(), panes);
                    for t in &tiles {
                        assert!(t.width > 0 && t.height > 0, "{t:?}");
                        assert!(
                            t.x + t.width <= size.0 && t.y + t.height <= size.1,
                            "{t:?} in {size:?}"
                        );
                    }
                    let end = |t: &Tile| (t.x + t.width, t.y + t.height);
                    assert_eq!(tiles.iter().map(end).max(), Some(size));
                    if size.0.min(size.1) > 40 {
                        for (k, a) in tiles.iter().enumerate() {
                            for b in &tiles[..k] {
                                assert!(
                                    end(a).0 < b.x
                                        || end(b).0 < a.x
                                        || end(a).1 < b.y
                                        || end(b).1 < a.y,
                                    "a gap between {a:?} and {b:?}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }
}
