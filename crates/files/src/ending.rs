//! The formats of films that the window writes.

use serde::{Deserialize, Serialize};

/// A format, by the ending of its files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ending {
    #[default]
    Gif,
    Mp4,
    /// Numbered pictures.
    Png,
}

impl Ending {
    /// All formats.
    pub const ALL: [Self; 3] = [Self::Gif, Self::Mp4, Self::Png];

    /// Returns the name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gif => "GIF",
            Self::Mp4 => "MP4",
            Self::Png => "PNG files",
        }
    }

    /// Returns the ending of the names of its files.
    pub fn of_files(self) -> &'static str {
        match self {
            Self::Gif => ".gif",
            Self::Mp4 => ".mp4",
            Self::Png => "-####.png",
        }
    }

    /// Frames per second. A frame lasts a whole number of frames of a window at 60 Hz, and in a GIF
    /// a whole number of hundredths of a second.
    pub fn rate(self) -> f64 {
        match self {
            Self::Gif => 20.0,
            Self::Mp4 | Self::Png => 30.0,
        }
    }

    /// Returns the size (px) of a film of a picture of `size` (px): at most the largest of this
    /// format, with the same proportions and with even sides, as MP4 needs them. GIFs compress
    /// badly, so they are smaller.
    pub fn fit(self, (width, height): (u32, u32)) -> (u32, u32) {
        let most = match self {
            Self::Gif => 640.0,
            Self::Mp4 | Self::Png => 1920.0,
        };
        let shrink = (most / f64::from(width.max(height))).min(1.0);
        let side = |side: u32| ((f64::from(side) * shrink / 2.0).round() as u32 * 2).max(2);
        (side(width), side(height))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_keep_their_proportions_and_have_even_sides() {
        assert_eq!(Ending::Mp4.fit((1280, 720)), (1280, 720));
        assert_eq!(Ending::Gif.fit((1280, 720)), (640, 360));
        assert_eq!(Ending::Png.fit((3840, 2160)), (1920, 1080));
        assert_eq!(Ending::Gif.fit((63, 1001)), (40, 640));
        assert_eq!(Ending::Mp4.fit((1, 1)), (2, 2));
    }
}
