//! Pictures against golden ones, with a tolerance for differences that nobody would notice.
//! `UPDATE_GOLDEN=1` rewrites them; a failure leaves the picture beside its golden one.

mod common;

use std::path::PathBuf;

use a3_render::{Gpu, OFFSCREEN_FORMAT, Offscreen, Renderer, Style, shaded_by};
use common::{Sheet, gpu};
use image::RgbaImage;

const SIZE: (u32, u32) = (320, 180);

fn draw(gpu: &Gpu, sheet: &Sheet, style: Style) -> RgbaImage {
    let samples = gpu.samples(OFFSCREEN_FORMAT);
    let mut renderer = Renderer::new(gpu, OFFSCREEN_FORMAT, samples, &sheet.topology);
    let offscreen = Offscreen::new(gpu, SIZE).unwrap();
    let pixels = offscreen
        .render(gpu, &mut renderer, &sheet.picture(style))
        .unwrap();
    RgbaImage::from_raw(SIZE.0, SIZE.1, pixels).unwrap()
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
    println!(
        "{:.3} % of the pixels are off, mean error {mean:.3}",
        100.0 * off
    );
    off < 0.004 && mean < 0.4
}

/// Adds a box with another value at each corner, a capsule with opposite ones at its ends, and a
/// patch of liquid whose values grow to the right.
fn add_coloured_solids(sheet: &mut Sheet) {
    let axes = |[x, y, z]: [f32; 3]| [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]];
    let along = |value| a3_render::Solid::value([value, 0.0, 0.0]);
    let color = [0.3, 0.36, 0.44, 1.0];
    sheet.solids = vec![
        a3_render::Solid {
            center: [-0.8, 0.35, 0.9],
            radius: 0.03,
            axes: axes([0.4, 0.3, 0.2]),
            color,
            values: [0.0, 0.3, 0.4, 0.7, 0.2, 0.5, 0.6, 1.0].map(along),
        },
        a3_render::Solid {
            center: [0.15, 0.4, 1.1],
            radius: 0.15,
            axes: axes([0.0, 0.3, 0.0]),
            color,
            // Opposite at either end: nothing in the middle.
            values: [-0.9, -0.9, 0.9, 0.9, -0.9, -0.9, 0.9, 0.9].map(along),
        },
    ];
    let corner = |x: f32, z: f32, value: f32| a3_render::Corner {
        place: [x, 0.05, z],
        value,
        normal: [0.0, 1.0, 0.0],
    };
    sheet.liquid = (
        vec![
            corner(-1.2, 2.0, 0.0),
            corner(1.2, 2.0, 1.0),
            corner(1.2, 1.4, 1.0),
            corner(-1.2, 1.4, 0.0),
        ],
        vec![[0, 1, 2], [0, 2, 3]],
    );
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
            sheet.camera = a3_render::Camera::look_at([1.6, -1.1, 4.2], [0.0, 0.8, 0.2]);
        }
        if name == "coloured-solids" {
            add_coloured_solids(&mut sheet);
        }
        if name.starts_with("coloured") {
            for point in &mut sheet.points {
                point[3] = shaded_by(0.55 * (point[0] + 1.0) * point[1]);
            }
        }
        let picture = draw(&gpu, &sheet, style);
        let path = folder.join(format!("{name}.png"));
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            picture.save(&path).unwrap();
            continue;
        }
        let golden = image::open(&path).unwrap().to_rgba8();
        if !same(&picture, &golden) {
            picture
                .save(folder.join(format!("{name}.actual.png")))
                .unwrap();
            wrong.push(name);
        }
    }
    assert!(
        wrong.is_empty(),
        "{wrong:?} differ: look at the .actual.png files beside the golden ones"
    );
}

/// Seen from behind, the sheet is lit as well as from the front, and shows its lining.
#[test]
fn both_sides_are_lit() {
    let Some(gpu) = gpu() else { return };
    let mut sheet = Sheet::new();
    sheet.balls.clear();
    sheet.lines.clear();
    sheet.camera = a3_render::Camera::look_at([-1.6, 1.9, -4.2], [0.0, 1.0, 0.2]);
    let picture = draw(&gpu, &sheet, Style::Shaded);
    let middle = picture.get_pixel(SIZE.0 / 2, SIZE.1 / 2 - 10).0;
    assert!(middle[0] > 60 && middle[0] > middle[2], "{middle:?}");
}

/// Lines have the requested width in points: twice the scale gives twice the pixels.
#[test]
fn lines_are_as_wide_as_asked_for() {
    let Some(gpu) = gpu() else { return };
    let mut sheet = Sheet::new();
    sheet.topology = a3_render::Topology::default();
    sheet.points.clear();
    sheet.balls.clear();
    sheet.camera = a3_render::Camera::look_at([0.0, 0.0, 4.0], [0.0; 3]);
    sheet.lines = vec![a3_render::Line::new(
        [-1.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        6.0,
        [0.0, 0.0, 0.0, 1.0],
    )];
    let mut renderer = Renderer::new(
        &gpu,
        OFFSCREEN_FORMAT,
        gpu.samples(OFFSCREEN_FORMAT),
        &sheet.topology,
    );
    let offscreen = Offscreen::new(&gpu, SIZE).unwrap();
    for scale in [1.0f32, 2.0, 3.0] {
        let picture = a3_render::Picture {
            scale,
            floor: None,
            ..sheet.picture(Style::Shaded)
        };
        let pixels = offscreen.render(&gpu, &mut renderer, &picture).unwrap();
        let column = |y: u32| pixels[4 * (y * SIZE.0 + SIZE.0 / 2) as usize];
        // Ink in the middle column, from the darkness of its pixels.
        let background = f64::from(column(10));
        let ink: f64 = (0..SIZE.1)
            .map(|y| 1.0 - f64::from(column(y)) / background)
            .filter(|ink| *ink > 0.3)
            .sum();
        assert!(
            (ink - 6.0 * f64::from(scale)).abs() < 1.0,
            "{ink} pixels at scale {scale}"
        );
    }
}

/// A liquid is drawn in all styles, lit by its own normals, and disappears with its triangles.
#[test]
fn a_liquid_is_lit_by_its_normals() {
    let Some(gpu) = gpu() else { return };
    let mut sheet = Sheet::new();
    sheet.topology = a3_render::Topology::default();
    sheet.points.clear();
    sheet.balls.clear();
    sheet.lines.clear();
    sheet.camera = a3_render::Camera::look_at([0.0, 0.0, 4.0], [0.0; 3]);
    let samples = gpu.samples(OFFSCREEN_FORMAT);
    let mut renderer = Renderer::new(&gpu, OFFSCREEN_FORMAT, samples, &sheet.topology);
    let offscreen = Offscreen::new(&gpu, SIZE).unwrap();
    let mut middle = |style, normal: Option<[f32; 3]>| {
        let places = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        let corners = places.map(|place| a3_render::Corner {
            place,
            value: -2.0,
            normal: normal.unwrap_or_default(),
        });
        let picture = a3_render::Picture {
            floor: None,
            liquid: a3_render::Liquid {
                corners: &corners,
                triangles: if normal.is_some() { &[[0, 1, 2]] } else { &[] },
            },
            ..sheet.picture(style)
        };
        let pixels = offscreen.render(&gpu, &mut renderer, &picture).unwrap();
        let at = 4 * (SIZE.1 / 2 * SIZE.0 + SIZE.0 / 2) as usize;
        [0, 1, 2].map(|k| i32::from(pixels[at + k]))
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
    let alone = [Style::Shaded, Style::Wireframe].map(|style| draw(&gpu, &sheet, style));
    let tiles = [(0, 0), (SIZE.0 + 5, 37)].map(|(x, y)| a3_render::Tile {
        x,
        y,
        ..a3_render::Tile::whole(SIZE)
    });
    let pictures = [
        (sheet.picture(Style::Shaded), tiles[0]),
        (sheet.picture(Style::Wireframe), tiles[1]),
    ];
    let samples = gpu.samples(OFFSCREEN_FORMAT);
    let mut renderer = Renderer::new(&gpu, OFFSCREEN_FORMAT, samples, &sheet.topology);
    let size = (2 * SIZE.0 + 10, SIZE.1 + 40);
    let offscreen = Offscreen::new(&gpu, size).unwrap();
    let pixels = offscreen
        .render_tiles(&gpu, &mut renderer, &pictures, |_, _| vec![])
        .unwrap();
    let both = RgbaImage::from_raw(size.0, size.1, pixels).unwrap();
    for (alone, tile) in alone.iter().zip(tiles) {
        let part = image::imageops::crop_imm(&both, tile.x, tile.y, tile.width, tile.height);
        let (off, mean) = difference(alone, &part.to_image());
        // The background is dithered by its position in the target.
        assert!(off < 1e-4 && mean < 0.5, "{off} {mean}");
    }
    let gap = both.get_pixel(SIZE.0 + 2, 100);
    assert!(
        (0..size.1).all(|y| both.get_pixel(SIZE.0 + 2, y) == gap),
        "nothing is drawn beside the parts"
    );
}

/// Without floor and background, solid objects look the same, and edges keep their colour.
#[test]
fn transparent_pictures_show_the_same_things() {
    let Some(gpu) = gpu() else { return };
    let mut sheet = Sheet::new();
    sheet.lines[0].color = [0.9, 0.4, 0.02, 1.0];
    let samples = gpu.samples(OFFSCREEN_FORMAT);
    let mut renderer = Renderer::new(&gpu, OFFSCREEN_FORMAT, samples, &sheet.topology);
    let offscreen = Offscreen::new(&gpu, SIZE).unwrap();
    let mut draw = |sheet: &Sheet, transparent| {
        let picture = a3_render::Picture {
            transparent,
            ..sheet.picture(Style::Shaded)
        };
        let pixels = offscreen.render(&gpu, &mut renderer, &picture).unwrap();
        RgbaImage::from_raw(SIZE.0, SIZE.1, pixels).unwrap()
    };
    let (paper, bare) = (draw(&sheet, false), draw(&sheet, true));
    assert!(paper.pixels().all(|p| p.0[3] == 255));
    let solid = |p: &image::Rgba<u8>| p.0[3] == 255;
    assert!(
        paper
            .pixels()
            .zip(bare.pixels())
            .all(|(a, b)| !solid(b) || a == b)
    );
    let count = bare.pixels().filter(|p| solid(p)).count();
    let empty = bare.pixels().filter(|p| p.0 == [0; 4]).count();
    let all = (SIZE.0 * SIZE.1) as usize;
    assert!(
        count > all / 20 && empty > all / 2,
        "{count} {empty} of {all}"
    );
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
    let mut sheet = Sheet::new();
    sheet.topology = a3_render::Topology::default();
    sheet.points.clear();
    sheet.lines.clear();
    sheet.camera = a3_render::Camera::look_at([0.0, 1.0, 6.0], [0.0, 1.0, 0.0]);
    let ball = a3_render::Ball {
        center: [0.0, 1.0, 0.0],
        radius: 0.5,
        color: [0.3, 0.36, 0.44, 1.0],
    };
    let solid = |radius, [x, y, z]: [f32; 3], turn: f32| {
        let (s, c) = turn.sin_cos();
        let axes = [[c, s, 0.0, x], [-s, c, 0.0, y], [0.0, 0.0, 1.0, z]];
        a3_render::Solid {
            values: a3_render::Solid::PLAIN,
            center: ball.center,
            radius,
            axes,
            color: ball.color,
        }
    };
    let draw = |balls: &[a3_render::Ball], solids: &[a3_render::Solid]| {
        let samples = gpu.samples(OFFSCREEN_FORMAT);
        let mut renderer = Renderer::new(&gpu, OFFSCREEN_FORMAT, samples, &sheet.topology);
        let picture = a3_render::Picture {
            balls,
            solids,
            ..sheet.picture(Style::Shaded)
        };
        let offscreen = Offscreen::new(&gpu, SIZE).unwrap();
        let pixels = offscreen.render(&gpu, &mut renderer, &picture).unwrap();
        RgbaImage::from_raw(SIZE.0, SIZE.1, pixels).unwrap()
    };
    let round = draw(&[ball], &[]);
    assert!(same(&round, &draw(&[], &[solid(0.5, [0.0; 3], 0.7)])));
    // Upright, a capsule covers the same pixels as lying down, rotated by a right angle.
    let turn = std::f32::consts::FRAC_PI_2;
    let capsule = draw(&[], &[solid(0.3, [0.0, 0.4, 0.0], 0.0)]);
    assert!(same(
        &capsule,
        &draw(&[], &[solid(0.3, [0.4, 0.0, 0.0], turn)])
    ));
    let empty = draw(&[], &[]);
    let covered = |picture: &RgbaImage, y: u32| {
        (0..SIZE.0)
            .filter(|x| picture.get_pixel(*x, y) != empty.get_pixel(*x, y))
            .count()
    };
    // A box of 1.2 m by 0.8 m by 0.4 m from 6 m: its front is 5.8 m away.
    let cuboid = draw(&[], &[solid(0.0, [0.6, 0.4, 0.2], 0.0)]);
    let widest = covered(&cuboid, SIZE.1 / 2) as f32;
    let expected = covered(&round, SIZE.1 / 2) as f32 * 1.2 * (36.0f32 - 0.25).sqrt() / 5.8 / 1.0;
    assert!((widest - expected).abs() < 3.0, "{widest} {expected}");
    let pixel = |x: u32, y: u32| cuboid.get_pixel(x, y).0;
    let (a, b) = (pixel(SIZE.0 / 2 - 15, 80), pixel(SIZE.0 / 2 + 15, 100));
    assert!(
        a.iter().zip(b).all(|(a, b)| a.abs_diff(b) < 16),
        "{a:?} {b:?}"
    );
}
