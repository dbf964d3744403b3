//! Pictures: the data of a frame.

use bytemuck::{Pod, Zeroable};

use crate::camera::Camera;

/// The number of looks of a surface: cloth in four colours, jelly in four, then [`STEEL_LOOK`]. The
/// shader contains the colours.
pub const LOOKS: usize = 9;

/// The look of steel.
pub const STEEL_LOOK: usize = 8;

/// The style in which surfaces are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Smooth meshes. A scene without triangles is drawn as wires.
    #[default]
    Shaded,
    /// Wires.
    Wireframe,
    /// Springs, each kind in its own colour.
    Springs,
}

/// The connections between particles, which do not change between frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    /// Number of particles.
    pub points: usize,
    /// Corners of the triangles of a surface, all with the same orientation. Empty without a
    /// surface. A corner `points + k` is at the point `splits[k]`.
    pub triangles: Vec<[u32; 3]>,
    /// Points at sharp edges, once for each group of triangles that are smooth among themselves.
    pub splits: Vec<u32>,
    /// Ends of the wires.
    pub wires: Vec<[u32; 2]>,
    /// Springs that replace the wires in the style [`Style::Springs`]: later ones are drawn over
    /// earlier ones.
    pub springs: Vec<Spring>,
}

impl Topology {
    /// Returns the point at which a corner of a triangle is.
    pub(crate) fn point_of(&self, corner: u32) -> u32 {
        match (corner as usize).checked_sub(self.points) {
            Some(split) => self.splits[split],
            None => corner,
        }
    }
}

/// A spring between two particles.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Spring {
    /// Particles at its ends.
    pub ends: [u32; 2],
    /// Width in points.
    pub width: f32,
    /// Linear red, green and blue, used if no value colours the spring.
    pub color: [f32; 3],
}

/// A shaded ball.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Ball {
    /// Centre (m).
    pub center: [f32; 3],
    /// Radius (m).
    pub radius: f32,
    /// Linear red, green and blue, then 1.
    pub color: [f32; 4],
}

/// A shaded box with round edges. It is a ball if all half extents are 0, and a capsule if two are.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Solid {
    /// Centre (m).
    pub center: [f32; 3],
    /// Radius of the edges (m), which is added to the half extents.
    pub radius: f32,
    /// Directions of the sides, which are orthogonal unit vectors, each with its half extent (m).
    pub axes: [[f32; 4]; 3],
    /// Linear red, green and blue, then 1.
    pub color: [f32; 4],
    /// One vector for each corner, whose length, from 0 to 1, colours it. The index of a corner is
    /// the sum of 1, 2 and 4 for those of the three axes along which it lies.
    pub values: [[f32; 4]; 8],
}

impl Solid {
    /// Values of a solid without coloured values.
    pub const PLAIN: [[f32; 4]; 8] = [[0.0, 0.0, 0.0, 1.0]; 8];

    /// Returns a vector as a value of a corner.
    #[must_use]
    pub fn value([x, y, z]: [f32; 3]) -> [f32; 4] {
        [x, y, z, 0.0]
    }
}

/// A straight line that is drawn in all styles.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Line {
    /// One end (m).
    pub from: [f32; 3],
    /// Width in points, which are pixels on a screen of ordinary density.
    pub width: f32,
    /// The other end (m).
    pub to: [f32; 3],
    /// 1 if the line casts a shadow, 0 if not.
    pub shadow: f32,
    /// Linear red, green and blue, and opacity.
    pub color: [f32; 4],
}

impl Line {
    /// Creates a line between two points (m), `width` points wide.
    #[must_use]
    pub fn new(from: [f32; 3], to: [f32; 3], width: f32, color: [f32; 4]) -> Self {
        Self { from, width, to, shadow: 0.0, color }
    }

    /// Gives the line a shadow.
    #[must_use]
    pub fn with_shadow(self) -> Self {
        Self { shadow: 1.0, ..self }
    }
}

/// Vertex of the surface of a liquid.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Corner {
    /// Position (m).
    pub place: [f32; 3],
    /// Value from 0 to 1 that colours it; for the colour of the liquid, -2 less its depth: from -1
    /// in spray through 0 at the surface to 1 deep below it.
    pub value: f32,
    /// Unit normal.
    pub normal: [f32; 3],
}

/// Surface of a liquid, whose triangles change with each frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct Liquid<'a> {
    /// Vertices.
    pub corners: &'a [Corner],
    /// Corners of each triangle.
    pub triangles: &'a [[u32; 3]],
}

/// Horizontal plane on which shadows fall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor {
    /// Height (m).
    pub height: f32,
    /// Whether it hides bodies below it from a camera above it. Otherwise, it only marks a height.
    pub solid: bool,
}

/// All data of one frame.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// The camera.
    pub camera: Camera,
    /// The style in which surfaces are drawn.
    pub style: Style,
    /// Pixels per point: 1 on a screen of ordinary density, 2 on a dense one.
    pub scale: f32,
    /// Positions of the particles (m). The fourth number is the look of the surface, below
    /// [`LOOKS`], or the result of [`shaded_by`](crate::shaded_by) for a value that colours it.
    pub points: &'a [[f32; 4]],
    /// Balls, such as particles of small systems, pins and obstacles.
    pub balls: &'a [Ball],
    /// Boxes and capsules.
    pub solids: &'a [Solid],
    /// Lines, such as trails and highlighted springs.
    pub lines: &'a [Line],
    /// Surface of a liquid, which is drawn in all styles.
    pub liquid: Liquid<'a>,
    /// The floor, if there is one.
    pub floor: Option<Floor>,
    /// Whether floor, shadows and background are left out, so that the picture can be laid over
    /// another one.
    pub transparent: bool,
    /// Whether the background is dark.
    pub dark: bool,
}

impl Picture<'_> {
    /// Creates a picture of nothing but the background.
    #[must_use]
    pub fn new(camera: Camera) -> Self {
        Self {
            camera,
            style: Style::default(),
            scale: 1.0,
            points: &[],
            balls: &[],
            solids: &[],
            lines: &[],
            liquid: Liquid::default(),
            floor: None,
            transparent: false,
            dark: false,
        }
    }
}

/// A non-empty rectangular part of the target.
///
/// ```
/// let tile = a3_render::Tile::whole((1280, 720));
/// assert_eq!(tile.aspect(), 16.0 / 9.0);
/// assert!(tile.contains([1000.0, 700.0]) && !tile.contains([1000.0, 721.0]));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tile {
    /// Distance from the left (px).
    pub x: u32,
    /// Distance from the top (px).
    pub y: u32,
    /// Width (px), at least 1.
    pub width: u32,
    /// Height (px), at least 1.
    pub height: u32,
}

impl Tile {
    /// Returns the whole of a target of this width and height (px).
    #[must_use]
    pub fn whole((width, height): (u32, u32)) -> Self {
        Self { x: 0, y: 0, width, height }
    }

    /// Returns the width over the height.
    #[must_use]
    pub fn aspect(&self) -> f32 {
        self.width as f32 / self.height as f32
    }

    /// Returns whether a point of the target (px) is in this part.
    #[must_use]
    pub fn contains(&self, [x, y]: [f32; 2]) -> bool {
        let (left, top) = (self.x as f32, self.y as f32);
        (left..left + self.width as f32).contains(&x)
            && (top..top + self.height as f32).contains(&y)
    }

    /// Returns the place of a point of the target (px) in this part: from 0 to 1 from its left and
    /// from its top.
    #[must_use]
    pub fn place(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [(x - self.x as f32) / self.width as f32, (y - self.y as f32) / self.height as f32]
    }
}
