//! What is to be seen.

use bytemuck::{Pod, Zeroable};

use crate::camera::Camera;

/// How many looks a surface can have: cloth in four colours, and then jelly in four.
/// The shader has their colours.
pub const LOOKS: usize = 8;

/// How a surface is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Its wires.
    Wireframe,
    /// A smooth mesh. What has no triangles is still drawn by its wires.
    Shaded,
}

/// How particles hang together: what stays the same from frame to frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// Number of particles.
    pub points: usize,
    /// Corners of the triangles of a surface, wound alike. Empty for a system without one.
    pub triangles: Vec<[u32; 3]>,
    /// Ends of the wires.
    pub wires: Vec<[u32; 2]>,
}

/// A shaded ball.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Ball {
    /// In m.
    pub center: [f32; 3],
    /// In m.
    pub radius: f32,
    /// Linear red, green, blue, and 1.
    pub color: [f32; 4],
}

/// A shaded box with round edges. Without rounding it is a box, without half extents a ball, with one a capsule.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Solid {
    /// In m.
    pub center: [f32; 3],
    /// Of its edges (m); beyond the half extents.
    pub radius: f32,
    /// Along each side a unit vector, across the others, and half the extent (m).
    pub axes: [[f32; 4]; 3],
    /// Linear red, green, blue, and 1.
    pub color: [f32; 4],
}

/// A straight line that is not a wire.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Line {
    /// One end (m).
    pub from: [f32; 3],
    /// In points: pixels on a screen of ordinary density.
    pub width: f32,
    /// The other end (m).
    pub to: [f32; 3],
    /// Unused.
    pub padding: f32,
    /// Linear red, green, blue and opacity.
    pub color: [f32; 4],
}

impl Line {
    /// A line between two points (m), `width` points wide.
    #[must_use]
    pub fn new(from: [f32; 3], to: [f32; 3], width: f32, color: [f32; 4]) -> Self {
        Self {
            from,
            width,
            to,
            padding: 0.0,
            color,
        }
    }
}

/// One frame.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// From where.
    pub camera: Camera,
    /// How.
    pub style: Style,
    /// Pixels per point: 1 on a screen of ordinary density, 2 on a dense one.
    pub scale: f32,
    /// Positions of the particles (m), and which of the [`LOOKS`](crate::LOOKS) their surface has.
    pub points: &'a [[f32; 4]],
    /// Balls: particles of small systems, pins, obstacles.
    pub balls: &'a [Ball],
    /// Boxes and capsules.
    pub solids: &'a [Solid],
    /// Lines: trails, highlighted springs.
    pub lines: &'a [Line],
    /// Height of the floor (m), if there is one.
    pub floor: Option<f32>,
    /// Without floor, shadows and background: to be laid over something else.
    pub transparent: bool,
}

/// A part of the target (px), inside it and not empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tile {
    /// From the left.
    pub x: u32,
    /// From the top.
    pub y: u32,
    /// At least 1.
    pub width: u32,
    /// At least 1.
    pub height: u32,
}

impl Tile {
    /// All of a target of this size.
    #[must_use]
    pub fn whole((width, height): (u32, u32)) -> Self {
        Self {
            x: 0,
            y: 0,
            width,
            height,
        }
    }

    /// Width over height.
    #[must_use]
    pub fn aspect(&self) -> f32 {
        self.width as f32 / self.height as f32
    }

    /// Whether that place of the target (px) is in it.
    #[must_use]
    pub fn contains(&self, [x, y]: [f32; 2]) -> bool {
        let (left, top) = (self.x as f32, self.y as f32);
        (left..left + self.width as f32).contains(&x)
            && (top..top + self.height as f32).contains(&y)
    }

    /// That place of the target (px) in shares of the part: 0..1 from its left and from its top.
    #[must_use]
    pub fn place(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [
            (x - self.x as f32) / self.width as f32,
            (y - self.y as f32) / self.height as f32,
        ]
    }
}
