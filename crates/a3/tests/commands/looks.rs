//! Pictures of every built-in scene, drawn by `a3 render`, against golden ones: its first frame,
//! and one some seconds later. `A3_BLESS=1 cargo test -p a3-simulator --test commands looks` takes
//! them again; look at them before you commit them.

use std::fs::File;
use std::path::Path;
use std::sync::Mutex;
use std::thread;

use a3_scenes::SCENES;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, RgbImage, imageops};

use crate::common::{Folder, a3, gpu_is_missing, text};

const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/looks");
/// Folder of the pictures that are wrong.
const WRONG: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/looks");
/// Size of a picture (px); a golden file has two of them side by side.
const SIZE: (u32, u32) = (320, 200);
/// Golden colours are two more than multiples of this, so that their files are small.
const COARSE: u8 = 4;
/// Pictures are compared after each pixel took the mean of those up to this distance (px), because
/// adapters differ along edges.
const REACH: usize = 2;
/// Largest difference of a channel, of 255 levels, in pictures by other adapters.
const UNSEEN: u8 = 8;
/// Largest number of pixels that may differ by more. A small ball that moves by two pixels changes
/// a hundred.
const MAX_OFF: usize = 40;
/// Largest mean difference of all channels, in levels from 0 to 255. Rounding the golden pictures'
/// colours alone makes 0.9.
const MAX_MEAN: f64 = 1.5;

/// Returns the time of the second picture (s): two seconds, or less where a scene ends before,
/// takes long, or has more to see.
fn later(scene: &str) -> f64 {
    match scene {
        "boxes" => 0.5,
        "dam-break" => 0.6,
        "dominoes" | "drop" => 0.8,
        "ball-on-cloth" => 1.0,
        _ => 2.0,
    }
}

/// Returns both pictures of a scene side by side, as the program writes them to this folder; `None`
/// without an adapter.
fn shoot(folder: &Path, scene: &str) -> Option<RgbImage> {
    let later = later(scene);
    let words = [
        ["render", "--light"],
        ["--scene", scene],
        ["--until", &later.to_string()],
        ["--fps", &(1.0 / later).to_string()],
        ["--size", &format!("{}x{}", SIZE.0, SIZE.1)],
        ["--output", &format!("{scene}-#.png")],
    ];
    let output = a3(folder, words.concat());
    if gpu_is_missing(&output) {
        return None;
    }
    assert!(output.status.success(), "{}", text(&output.stderr));
    let mut both = RgbImage::new(2 * SIZE.0, SIZE.1);
    for k in 0..2 {
        let picture = image::open(folder.join(format!("{scene}-{}.png", k + 1))).unwrap();
        imageops::replace(&mut both, &picture.to_rgb8(), i64::from(k * SIZE.0), 0);
    }
    Some(both)
}

/// Replaces each of these channels by the mean of its neighbours, `stride` apart, in each part of
/// `length` channels.
fn blur(channels: &[u8], stride: usize, length: usize) -> Vec<u8> {
    let mut means = Vec::with_capacity(channels.len());
    for part in channels.chunks(length) {
        let mut sums = vec![(0, 0); stride];
        for k in 0..length + REACH * stride {
            let (sum, count) = &mut sums[k % stride];
            if k < length {
                *sum += u32::from(part[k]);
                *count += 1;
            }
            if k >= (2 * REACH + 1) * stride {
                *sum -= u32::from(part[k - (2 * REACH + 1) * stride]);
                *count -= 1;
            }
            if k >= REACH * stride {
                means.push(((*sum + *count / 2) / *count) as u8);
            }
        }
    }
    means
}

/// Returns the differences of two pictures, apart from what differs along edges alone.
fn difference(a: &RgbImage, b: &RgbImage) -> RgbImage {
    assert_eq!(a.dimensions(), b.dimensions());
    let row = 3 * a.width() as usize;
    let blurred = |picture: &RgbImage| {
        let across = blur(picture.as_raw(), 3, row);
        blur(&across, row, across.len())
    };
    let (a_means, b_means) = (blurred(a), blurred(b));
    let pairs = a_means.iter().zip(&b_means);
    let channels = pairs.map(|(a, b)| a.abs_diff(*b)).collect();
    RgbImage::from_raw(a.width(), a.height(), channels).unwrap()
}

/// Returns by what a picture differs from its golden one, if that can be seen.
fn fault(difference: &RgbImage) -> Option<String> {
    let channels = difference.as_raw();
    let sum: u64 = channels.iter().map(|c| u64::from(*c)).sum();
    let mean = sum as f64 / channels.len() as f64;
    let pixels = channels.chunks(3);
    let off = pixels.filter(|p| p.iter().any(|c| *c > UNSEEN)).count();
    let words = format!("{off} pixels differ, and the mean difference is {mean:.2} of 255 levels");
    (off > MAX_OFF || mean > MAX_MEAN).then_some(words)
}

fn save(picture: &RgbImage, path: &Path) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let file = File::create(path).unwrap();
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::NoFilter);
    let (width, height) = picture.dimensions();
    let written = encoder.write_image(picture.as_raw(), width, height, ExtendedColorType::Rgb8);
    written.unwrap();
}

/// Compares a picture of a scene with its golden one, or replaces the golden one if `A3_BLESS` is
/// set. Returns a message if they differ.
fn check(scene: &str, mut picture: RgbImage) -> Option<String> {
    let path = Path::new(GOLDEN).join(format!("{scene}.png"));
    if std::env::var_os("A3_BLESS").is_some() {
        for channel in picture.iter_mut() {
            *channel = *channel / COARSE * COARSE + COARSE / 2;
        }
        save(&picture, &path);
        return None;
    }
    let (mut difference, why) = match image::open(&path) {
        Ok(golden) => {
            let difference = difference(&picture, &golden.to_rgb8());
            let why = fault(&difference);
            (difference, why)
        }
        Err(why) => (picture.clone(), Some(why.to_string())),
    };
    if why.is_some() {
        for channel in difference.iter_mut() {
            *channel = channel.saturating_mul(8);
        }
        save(&picture, &Path::new(WRONG).join(format!("{scene}.png")));
        let path = Path::new(WRONG).join(format!("{scene}-difference.png"));
        save(&difference, &path);
    }
    why.map(|why| format!("{scene}: {why}"))
}

#[test]
fn scenes_look_as_they_did() {
    let folder = &Folder::new();
    let scenes = Mutex::new(SCENES.iter());
    let wrong = Mutex::new(vec![]);
    thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let scene = scenes.lock().unwrap().next_back();
                    let Some(scene) = scene else { return };
                    let Some(picture) = shoot(folder, scene.name) else {
                        return;
                    };
                    let why = check(scene.name, picture);
                    wrong.lock().unwrap().extend(why);
                }
            });
        }
    });
    let wrong = wrong.into_inner().unwrap();
    assert!(
        wrong.is_empty(),
        "{wrong:#?}\nThe new pictures are in {WRONG}, with eight times their differences from those \
         in {GOLDEN}"
    );
}

/// A body that moves by five pixels is noticed in each golden picture, and noise in none.
#[test]
fn moved_bodies_are_noticed() {
    for scene in SCENES {
        let path = Path::new(GOLDEN).join(format!("{}.png", scene.name));
        let golden = image::open(path).unwrap().to_rgb8();
        let part = |x| imageops::crop_imm(&golden, x, 0, SIZE.0 - 5, SIZE.1).to_image();
        for first in [0, SIZE.0] {
            let still = part(first);
            let mut noisy = still.clone();
            for (k, channel) in noisy.iter_mut().enumerate() {
                *channel = channel.saturating_add_signed([-2, 1, 2, -1][k * k % 11 % 4]);
            }
            for (other, is_noticed) in [(part(first + 5), true), (noisy, false)] {
                let why = fault(&difference(&other, &still));
                assert_eq!(why.is_some(), is_noticed, "{}: {why:?}", scene.name);
            }
        }
    }
}
