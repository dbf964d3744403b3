//! The floor and the shadows on it, and sharp edges of meshes.

mod common;

use a3_render::{Ball, Camera, Floor, Gpu, Picture, Topology};
use common::{FLOOR, gpu};
use image::RgbaImage;

const SIZE: (u32, u32) = (240, 160);

/// Draws triangles in red, and balls, above a floor or without one.
fn draw(
    gpu: &Gpu,
    topology: &Topology,
    points: &[[f32; 4]],
    balls: &[Ball],
    floor: Option<Floor>,
) -> RgbaImage {
    let picture = Picture { points, balls, floor, ..Picture::new(camera()) };
    common::draw(gpu, SIZE, topology, picture)
}

fn camera() -> Camera {
    Camera::look_at([0.5, 1.6, 4.0], [0.0, 0.3, 0.0])
}

/// Returns the pixel where a point of the world (m) is seen.
fn pixel(picture: &RgbaImage, point: [f32; 3]) -> [u8; 4] {
    let (width, height) = (SIZE.0 as f32, SIZE.1 as f32);
    let ([x, y], _) = camera().project(point, width / height).unwrap();
    picture.get_pixel((x * width) as u32, (y * height) as u32).0
}

/// Horizontal squares of these heights and half sides (m).
fn squares(squares: &[(f32, f32)]) -> (Topology, Vec<[f32; 4]>) {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let square = |(y, half): &(f32, f32)| corners.map(|[x, z]| [half * x, *y, half * z, 0.0]);
    let points: Vec<_> = squares.iter().flat_map(square).collect();
    let triangles = (0..squares.len() as u32)
        .flat_map(|k| [[0, 2, 1], [0, 3, 2]].map(|t| t.map(|i| 4 * k + i)))
        .collect();
    let topology = Topology { points: points.len(), triangles, ..Topology::default() };
    (topology, points)
}

/// Whether a pixel is of cloth.
fn is_red(pixel: image::Rgba<u8>) -> bool {
    i32::from(pixel.0[0]) > i32::from(pixel.0[2]) + 60
}

#[test]
fn a_cloth_on_the_floor_is_seen() {
    let Some(gpu) = gpu() else { return };
    let (topology, points) = squares(&[(0.0, 1.0)]);
    let lying = draw(&gpu, &topology, &points, &[], Some(FLOOR));
    let alone = draw(&gpu, &topology, &points, &[], None);
    let red = |picture: &RgbaImage| picture.pixels().filter(|p| is_red(**p)).count();
    assert!(red(&alone) > 2000 && red(&lying) == red(&alone));
}

/// Where shadows overlap, the darkest is seen, whichever is drawn first.
#[test]
fn overlapping_shadows_have_no_order() {
    let Some(gpu) = gpu() else { return };
    let draw = |heights: [f32; 2]| {
        let (topology, points) = squares(&heights.map(|y| (y, 0.6)));
        draw(&gpu, &topology, &points, &[], Some(FLOOR))
    };
    let (one, other) = (draw([0.5, 0.8]), draw([0.8, 0.5]));
    let differ = one.pixels().zip(other.pixels()).filter(|(a, b)| {
        let channels = a.0.iter().zip(b.0);
        channels.into_iter().any(|(a, b)| a.abs_diff(b) > 1)
    });
    assert_eq!(differ.count(), 0);
}

#[test]
fn a_ball_on_the_floor_has_a_shadow_around_it() {
    let Some(gpu) = gpu() else { return };
    let empty = Topology::default();
    let ball = |height: f32| Ball {
        center: [0.0, 0.3 + height, 0.0],
        radius: 0.3,
        color: [0.3, 0.36, 0.44, 1.0],
    };
    // Just left of the ball, which is the side of the lamp.
    let beside = |height| {
        let picture = draw(&gpu, &empty, &[], &[ball(height)], Some(FLOOR));
        i32::from(pixel(&picture, [-0.2, 0.0, 0.1])[1])
    };
    let (touching, above) = (beside(0.0), beside(0.5));
    assert!(touching < above - 8, "{touching} {above}");
}

/// What is below a floor is hidden, unless the floor only marks a height.
#[test]
fn the_ground_hides_nothing() {
    let Some(gpu) = gpu() else { return };
    let (topology, points) = squares(&[(-0.4, 0.5)]);
    let red = |solid| {
        let floor = Floor { solid, ..FLOOR };
        let picture = draw(&gpu, &topology, &points, &[], Some(floor));
        picture.pixels().filter(|p| is_red(**p)).count()
    };
    assert_eq!(red(true), 0);
    assert!(red(false) > 500);
}

/// At a split point each side has its own normal, so that the sides of a roof are lit evenly.
#[test]
fn edges_are_sharp_where_points_are_split() {
    let Some(gpu) = gpu() else { return };
    let ridge = [[0.5, 0.0], [0.0, 0.7], [-0.5, 0.0]];
    let points = ridge.map(|[x, y]| [[x, y, -1.0, 0.0], [x, y, 1.0, 0.0]]).concat();
    let smooth = vec![[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]];
    let sharp = vec![[0, 1, 6], [6, 1, 7], [8, 9, 4], [4, 9, 5]];
    let spread = |triangles: Vec<[u32; 3]>, splits: Vec<u32>| {
        let topology = Topology { points: points.len(), triangles, splits, ..Topology::default() };
        let picture = draw(&gpu, &topology, &points, &[], None);
        let bright = [0.1, 0.9]
            .map(|share| i32::from(pixel(&picture, [0.5 * (1.0 - share), 0.7 * share, 0.0])[0]));
        (bright[0] - bright[1]).abs()
    };
    let (split, whole) = (spread(sharp, vec![2, 3, 2, 3]), spread(smooth, vec![]));
    assert!(whole > split + 8 && split < 6, "{split} {whole}");
}
