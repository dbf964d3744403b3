//! Pictures without a window, and runs without a display or an adapter.

use crate::common::{Folder, a3, command, gpu_is_missing, text};

#[test]
fn pictures_without_a_window() {
    let folder = &Folder::new();
    let render = |name: &str, more: &str| {
        let words = "render t 0.01 --until 1 --size 320x200 --output";
        let output = a3(folder, format!("{words} {name} {more}"));
        if gpu_is_missing(&output) {
            return None;
        }
        assert!(output.status.success(), "{}", text(&output.stderr));
        let picture = image::open(folder.join(name)).unwrap().to_rgb8();
        assert_eq!(picture.dimensions(), (320, 200));
        let red = picture
            .pixels()
            .filter(|p| p.0[0] > 100 && p.0[0] / 2 > p.0[1] && p.0[0] / 2 > p.0[2])
            .count();
        Some((red, text(&output.stdout).to_owned()))
    };
    let Some((red, _)) = render("shaded.png", "") else {
        return;
    };
    assert!(red > 2000, "a red cloth: {red}");
    let (red, _) = render("wires.png", "--wireframe").unwrap();
    assert!(red < 50, "wires: {red}");
    let (_, listed) = render("springs.png", "--springs-of 210").unwrap();
    assert_eq!(listed.lines().count(), 13, "{listed}");
    for name in ["simple", "pendulum", "chain", "mit-sphere"] {
        render(&format!("{name}.png"), &format!("--scene {name}")).unwrap();
    }
    let words = "render t 0.01 --until 1 --output x.png --size 99999x99999";
    let output = a3(folder, words);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("99999x99999"));
}

/// The legend is a sheet in the lower left corner; a transparent picture has none.
#[test]
fn coloured_pictures_have_their_scale() {
    let folder = &Folder::new();
    let corner = |more: &str| {
        let words = format!("render t 0.01 --until 0.1 --output x.png {more}");
        let output = a3(folder, words);
        if gpu_is_missing(&output) {
            return None;
        }
        assert!(output.status.success(), "{}", text(&output.stderr));
        let picture = image::open(folder.join("x.png")).unwrap().to_rgba8();
        let corner = image::imageops::crop_imm(&picture, 0, 620, 300, 100).to_image();
        // The brightest colour of the scale is a yellow that nothing else has.
        let is_end = |p: &image::Rgba<u8>| p.0[0] > 200 && p.0[1] > 190 && p.0[2] < 90;
        let dark = |p: &image::Rgba<u8>| p.0[..3].iter().all(|c| *c < 150) && p.0[3] > 200;
        let count =
            |is: &dyn Fn(&image::Rgba<u8>) -> bool| corner.pixels().filter(|p| is(p)).count();
        Some((count(&is_end), count(&dark)))
    };
    let Some(plain) = corner("") else { return };
    assert_eq!(plain, (0, 0));
    let (yellow, _) = corner("--colour speed").unwrap();
    assert!(yellow > 50, "{yellow} pixels");
    let (yellow, words) = corner("--arrows velocity").unwrap();
    assert!(yellow == 0 && words > 50, "{words} pixels");
    assert_eq!(corner("--colour speed --transparent"), Some((0, 0)));
}

/// Solvers are compared in panes side by side, with their errors as text and the trails of their
/// particles.
#[test]
fn methods_side_by_side() {
    let folder = &Folder::new();
    let words =
        "compare e:0.05 r:0.05 r:0.025 --scene simple --until 20 --output x.png --size 906x500";
    let output = a3(folder, words);
    if gpu_is_missing(&output) {
        return;
    }
    assert!(output.status.success(), "{}", text(&output.stderr));
    // The text: Euler's radius grows by sqrt(1 + h^2) a step, and RK4 is late by h^4 / 120 a
    // second.
    let stdout = text(&output.stdout);
    let rows: Vec<Vec<&str>> =
        stdout.lines().skip(1).map(|line| line.split_whitespace().collect()).collect();
    let error = |row: usize| rows[row][3].parse::<f64>().unwrap();
    assert_eq!(rows.len(), 3, "{stdout}");
    assert!((error(0) - 0.648).abs() < 0.01, "{stdout}");
    assert!((error(1) - 1.04e-6).abs() < 0.02e-6, "{stdout}");
    assert!((error(2) - 6.5e-8).abs() < 0.1e-8, "{stdout}");
    assert_eq!((rows[0][4], rows[1][4], rows[2][4]), ("20.0", "80.0", "160"));

    // The picture: the trails of the second and the third agree, and the first leads elsewhere.
    let picture = image::open(folder.join("x.png")).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (906, 500));
    let pane = |k: u32| image::imageops::crop_imm(&picture, 303 * k, 205, 300, 295).to_image();
    let different = |a: u32, b: u32| {
        let (a, b) = (pane(a), pane(b));
        let pairs = a.pixels().zip(b.pixels());
        pairs.filter(|(p, q)| p.0.iter().zip(q.0).any(|(p, q)| p.abs_diff(q) > 40)).count()
    };
    let (euler, rk4) = (different(0, 1), different(1, 2));
    assert!(euler > 1000 && 4 * rk4 < euler, "{euler} {rk4}");
    // Dark letters on light paper, in each pane.
    for k in 0..3 {
        let caption = image::imageops::crop_imm(&picture, 303 * k + 12, 45, 180, 130).to_image();
        let dark = caption.pixels().filter(|p| p.0[0] < 90).count();
        let light = caption.pixels().filter(|p| p.0[0] > 225).count();
        assert!(dark > 150 && light > 10_000, "{dark} {light}");
    }

    // A pane that blows up says so, and the others are drawn nevertheless.
    let words = "compare e:0.05 r --scene mit --until 1 --output y.png --size 400x300";
    let output = a3(folder, words);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let stdout = text(&output.stdout);
    assert!(stdout.contains("blew up at step") && stdout.contains("1.00"));
    image::open(folder.join("y.png")).unwrap();
}

#[test]
fn without_a_display_the_job_is_done_all_the_same() {
    let folder = &Folder::new();
    let output = a3(folder, "t 0.01");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let stderr = text(&output.stderr);
    assert!(stderr.starts_with("no display"), "{stderr}");
    let stdout = text(&output.stdout);
    for second in 0..=10 {
        let start = format!("{second}.00");
        assert!(
            stdout.lines().any(|line| line.trim_start().starts_with(&start)),
            "{start} in\n{stdout}"
        );
    }
    if !gpu_is_missing(&output) {
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        assert!(stdout.contains("a3-cloth-1.png"));
        image::open(folder.join("a3-cloth-1.png")).unwrap();
    }
}

#[test]
fn without_a_display_methods_are_compared_all_the_same() {
    let folder = &Folder::new();
    let words = "compare e:0.05 r:0.05 --scene simple";
    let output = a3(folder, words);
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success() && stderr.starts_with("no display"));
    assert!(stdout.contains("euler") && stdout.contains("10.00"), "{stdout}");
    if !gpu_is_missing(&output) {
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        image::open(folder.join("a3-simple-1.png")).unwrap();
    }
}

#[test]
#[cfg(target_os = "linux")]
fn without_an_adapter_it_still_simulates() {
    let folder = &Folder::new();
    let blind = |words: &str| {
        command(folder, words)
            .env("WGPU_BACKEND", "vulkan")
            .env("VK_DRIVER_FILES", "/nowhere")
            .output()
            .unwrap()
    };
    let output = blind("t 0.01");
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{stderr}");
    assert!(stdout.contains("10.00") && stderr.contains("mesa-vulkan-drivers"), "{stdout}{stderr}");
    let output = blind("render t 0.01 --until 1 --output x.png");
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("mesa-vulkan-drivers"));
    assert_eq!(folder.count(), 0);
}
