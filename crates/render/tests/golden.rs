//! Pictures against golden ones, with a tolerance for differences that nobody would notice.
//! `UPDATE_GOLDEN=1` rewrites them; a failure leaves the picture beside its golden one.

mod common;

use std::path::PathBuf;

use a3_render::{Ball, Camera, Corner, Gpu, Line, Liquid, Picture, Solid, Style, Tile, shaded_by};
use common::{Sheet, gpu};
use image::RgbaImage;

const SIZE: (u32, u32) = (320, 180);

fn draw(gpu: &Gpu, sheet: &Sheet, picture: Picture) -> RgbaImage {
    common::draw(gpu, SIZE, &sheet.topology, picture)
}

/// Share of pixels that differ by more than 12 of 255 in some channel, and the mean error of all
/// channels. A few pixels may differ, because adapters differ along edges; a shader that is
/// slightly too dark changes the mean.
fn difference(a: &RgbaImage, b: &RgbaImage) -> (f64, f64) {
    assert_eq!(a.dimensions(), b.dimensions());
    let (mut off, mut sum) = (0u32, 0u64);
    for (p, q) in a.pixels().zip(b.pixels()) {
        let errors: Vec<_> = p.0.iter().zip(q.0).map(|(p, q)| p.abs_diff(q)).collect();
        off += u32::from(errors.iter().any(|e| *e > 12));
        sum += errors.iter().map(|e| u64::from(*e)).sum::<u64>();
    }
    let pixels = f64::from(a.width() * a.height());
    (f64::from(off) / pixels, sum as f64 / (4.0 * pixels))
}

fn same(a: &RgbaImage, b: &RgbaImage) -> bool {
    let (off, mean) = difference(a, b);
    let percent = 100.0 * off;
    println!("{percent:.3} % of the pixels are off, mean error {mean:.3}");
    off < 0.004 && mean < 0.4
}

/// Adds a box with another value at each corner, a capsule with opposite ones at its ends, and a
/// patch of liquid whose values grow to the right.
fn add_coloured_solids(sheet: &mut Sheet) {
    let axes = |[x, y, z]: [f32; 3]| [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]];
    let along = |value| Solid::value([value, 0.0, 0.0]);
    let color = [0.3, 0.36, 0.44, 1.0];
    sheet.solids = vec![
        Solid {
            center: [-0.8, 0.35, 0.9],
            radius: 0.03,
            axes: axes([0.4, 0.3, 0.2]),
            color,
            values: [0.0, 0.3, 0.4, 0.7, 0.2, 0.5, 0.6, 1.0].map(along),
        },
        Solid {
            center: [0.15, 0.4, 1.1],
            radius: 0.15,
            axes: axes([0.0, 0.3, 0.0]),
            color,
            // Opposite at either end: nothing in the middle.
            values: [-0.9, -0.9, 0.9, 0.9, -0.9, -0.9, 0.9, 0.9].map(along),
        },
    ];
    let corner =
        |x: f32, z: f32, value: f32| Corner { place: [x, 0.05, z], value, normal: [0.0, 1.0, 0.0] };
    let corners = [(-1.2, 2.0, 0.0), (1.2, 2.0, 1.0), (1.2, 1.4, 1.0), (-1.2, 1.4, 0.0)];
    let corners = corners.map(|(x, z, value)| corner(x, z, value));
    sheet.liquid = (corners.into(), vec![[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn pictures_match_the_golden_ones() {
    let Some(gpu) = gpu() else { return };
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let mut wrong = vec![];
    for (name, style) in [
        ("shaded", Style::Shaded),
        ("wireframe", Style::Wireframe),
        ("coloured", Style::Shaded),
        ("coloured-wireframe", Style::Wireframe),
        ("springs", Style::Springs),
        ("coloured-springs", Style::Springs),
        ("coloured-solids", Style::Shaded),
        ("orthographic", Style::Shaded),
        ("from-below", Style::Shaded),
        ("dark", Style::Springs),
    ] {
        let mut sheet = Sheet::new();
        sheet.dark = name == "dark";
        sheet.camera.set_parallel(name == "orthographic");
        if name == "from-below" {
            sheet.camera = Camera::look_at([1.6, -1.1, 4.2], [0.0, 0.8, 0.2]);
        }
        if name == "coloured-solids" {
            add_coloured_solids(&mut sheet);
        }
        if name.starts_with("coloured") {
            for point in &mut sheet.points {
                point[3] = shaded_by(0.55 * (point[0] + 1.0) * point[1]);
            }
        }
        let picture = draw(&gpu, &sheet, sheet.picture(style));
        let path = folder.join(format!("{name}.png"));
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            picture.save(&path).unwrap();
            continue;
        }
        let golden = image::open(&path).unwrap().to_rgba8();
        if !same(&picture, &golden) {
            let actual = folder.join(format!("{name}.actual.png"));
            picture.save(actual).unwrap();
            wrong.push(name);
        }
    }
    let look = "look at the .actual.png files beside the golden ones";
    assert!(wrong.is_empty(), "{wrong:?} differ: {look}");
}

/// Seen from behind, the sheet is lit as well as from the front, and shows its lining.
#[test]
fn both_sides_are_lit() {
    let Some(gpu) = gpu() else { return };
    let mut sheet = Sheet::new();
    sheet.balls.clear();
    sheet.lines.clear();
    sheet.camera = Camera::look_at([-1.6, 1.9, -4.2], [0.0, 1.0, 0.2]);
    let picture = draw(&gpu, &sheet, sheet.picture(Style::Shaded));
    let middle = picture.get_pixel(SIZE.0 / 2, SIZE.1 / 2 - 10).0;
    assert!(middle[0] > 60 && middle[0] > middle[2], "{middle:?}");
}

/// Lines have the requested width in points: twice the scale gives twice the pixels.
#[test]
fn lines_are_as_wide_as_asked_for() {
    let Some(gpu) = gpu() else { return };
    let mut sheet = Sheet::empty([0.0, 0.0, 4.0], [0.0; 3]);
    let black = [0.0, 0.0, 0.0, 1.0];
    sheet.lines = vec![Line::new([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 6.0, black)];
    for scale in [1.0f32, 2.0, 3.0] {
        let picture = Picture { scale, floor: None, ..sheet.picture(Style::Shaded) };
        let picture = draw(&gpu, &sheet, picture);
        let column = |y: u32| picture.get_pixel(SIZE.0 / 2, y).0[0];
        // Ink in the middle column, from the darkness of its pixels.
        let background = f64::from(column(10));
        let ink = (0..SIZE.1).map(|y| 1.0 - f64::from(column(y)) / background);
        let ink: f64 = ink.filter(|ink| *ink > 0.3).sum();
        let off = (ink - 6.0 * f64::from(scale)).abs();
        assert!(off < 1.0, "{ink} pixels at scale {scale}");
    }
}

/// A liquid is drawn in all styles, lit by its own normals, and disappears with its triangles.
#[test]
fn a_liquid_is_lit_by_its_normals() {
    let Some(gpu) = gpu() else { return };
    let sheet = Sheet::empty([0.0, 0.0, 4.0], [0.0; 3]);
    let middle = |style, normal: Option<[f32; 3]>| {
        let places = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        let corners =
            places.map(|place| Corner { place, value: -2.0, normal: normal.unwrap_or_default() });
        let picture = Picture {
            floor: None,
            liquid: Liquid {
                corners: &corners,
                triangles: if normal.is_some() { &[[0, 1, 2]] } else { &[] },
            },
            ..sheet.picture(style)
        };
        let picture = draw(&gpu, &sheet, picture);
        picture.get_pixel(SIZE.0 / 2, SIZE.1 / 2).0.map(i32::from)
    };
    let paper = middle(Style::Shaded, None);
    for style in [Style::Shaded, Style::Wireframe, Style::Springs] {
        let front = middle(style, Some([0.0, 0.0, 1.0]));
        assert!(front[2] > front[0] + 40, "{front:?} is not blue");
        let up = middle(style, Some([-0.62, 0.78, 0.0]));
        assert!(up != front, "{up:?}");
        assert_eq!(middle(style, None), paper);
    }
}

/// Several pictures in one target look as they do alone, and stay in their places.
#[test]
fn pictures_side_by_side() {
    let Some(gpu) = gpu() else { return };
    let sheet = Sheet::new();
    let pictures = [Style::Shaded, Style::Wireframe].map(|style| sheet.picture(style));
    let alone = pictures.map(|picture| draw(&gpu, &sheet, picture));
    let tiles = [(0, 0), (SIZE.0 + 5, 37)].map(|(x, y)| Tile { x, y, ..Tile::whole(SIZE) });
    let size = (2 * SIZE.0 + 10, SIZE.1 + 40);
    let placed = [0, 1].map(|k| (pictures[k], tiles[k]));
    let both = common::draw_tiles(&gpu, size, &sheet.topology, &placed);
    for (alone, tile) in alone.iter().zip(tiles) {
        let part = image::imageops::crop_imm(&both, tile.x, tile.y, tile.width, tile.height);
        let (off, mean) = difference(alone, &part.to_image());
        // The background is dithered by its position in the target.
        assert!(off < 1e-4 && mean < 0.5, "{off} {mean}");
    }
    let gap = both.get_pixel(SIZE.0 + 2, 100);
    let is_empty = (0..size.1).all(|y| both.get_pixel(SIZE.0 + 2, y) == gap);
    assert!(is_empty, "nothing is drawn beside the parts");
}

/// Without floor and background, solid objects look the same, and edges keep their colour.
#[test]
fn transparent_pictures_show_the_same_things() {
    let Some(gpu) = gpu() else { return };
    let mut sheet = Sheet::new();
    sheet.lines[0].color = [0.9, 0.4, 0.02, 1.0];
    let draw = |sheet: &Sheet, transparent| {
        let picture = Picture { transparent, ..sheet.picture(Style::Shaded) };
        draw(&gpu, sheet, picture)
    };
    let (paper, bare) = (draw(&sheet, false), draw(&sheet, true));
    assert!(paper.pixels().all(|p| p.0[3] == 255));
    let solid = |p: &image::Rgba<u8>| p.0[3] == 255;
    let mut both = paper.pixels().zip(bare.pixels());
    assert!(both.all(|(a, b)| !solid(b) || a == b));
    let count = bare.pixels().filter(|p| solid(p)).count();
    let empty = bare.pixels().filter(|p| p.0 == [0; 4]).count();
    let all = (SIZE.0 * SIZE.1) as usize;
    let is_sparse = count > all / 20 && empty > all / 2;
    assert!(is_sparse, "{count} {empty} of {all}");
    assert!(count + empty < all, "edges are smooth");
    // The line alone has one colour, (0.9, 0.4, 0.02) as sRGB, wherever it is visible.
    sheet.balls.clear();
    sheet.points.fill([0.0; 4]);
    for pixel in draw(&sheet, true).pixels().filter(|p| p.0[3] > 60) {
        let off = |c: usize| pixel.0[c].abs_diff([243, 170, 39][c]);
        assert!((0..3).all(|c| off(c) < 12), "{pixel:?}");
    }
}

/// A solid without extents is a ball; with extents it has the right length in any orientation, and
/// its faces are lit flat.
#[test]
fn solids_have_the_shape_asked_for() {
    let Some(gpu) = gpu() else { return };
    let sheet = Sheet::empty([0.0, 1.0, 6.0], [0.0, 1.0, 0.0]);
    let ball = Ball { center: [0.0, 1.0, 0.0], radius: 0.5, color: [0.3, 0.36, 0.44, 1.0] };
    let solid = |radius, [x, y, z]: [f32; 3], turn: f32| {
        let (s, c) = turn.sin_cos();
        let axes = [[c, s, 0.0, x], [-s, c, 0.0, y], [0.0, 0.0, 1.0, z]];
        Solid { values: Solid::PLAIN, center: ball.center, radius, axes, color: ball.color }
    };
    let draw = |balls: &[Ball], solids: &[Solid]| {
        let picture = Picture { balls, solids, ..sheet.picture(Style::Shaded) };
        draw(&gpu, &sheet, picture)
    };
    let round = draw(&[ball], &[]);
    assert!(same(&round, &draw(&[], &[solid(0.5, [0.0; 3], 0.7)])));
    // Upright, a capsule covers the same pixels as lying down, rotated by a right angle.
    let turn = std::f32::consts::FRAC_PI_2;
    let capsule = draw(&[], &[solid(0.3, [0.0, 0.4, 0.0], 0.0)]);
    let lying = draw(&[], &[solid(0.3, [0.4, 0.0, 0.0], turn)]);
    assert!(same(&capsule, &lying));
    let empty = draw(&[], &[]);
    let covered = |picture: &RgbaImage, y: u32| {
        let differs = |x: &u32| picture.get_pixel(*x, y) != empty.get_pixel(*x, y);
        (0..SIZE.0).filter(differs).count()
    };
    // A box of 1.2 m by 0.8 m by 0.4 m from 6 m: its front is 5.8 m away.
    let cuboid = draw(&[], &[solid(0.0, [0.6, 0.4, 0.2], 0.0)]);
    let widest = covered(&cuboid, SIZE.1 / 2) as f32;
    let expected = covered(&round, SIZE.1 / 2) as f32 * 1.2 * (36.0f32 - 0.25).sqrt() / 5.8 / 1.0;
    assert!((widest - expected).abs() < 3.0, "{widest} {expected}");
    let pixel = |x: u32, y: u32| cuboid.get_pixel(x, y).0;
    let (a, b) = (pixel(SIZE.0 / 2 - 15, 80), pixel(SIZE.0 / 2 + 15, 100));
    let is_flat = a.iter().zip(b).all(|(a, b)| a.abs_diff(b) < 16);
    assert!(is_flat, "{a:?} {b:?}");
}
