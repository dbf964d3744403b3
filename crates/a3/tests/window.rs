//! The window for real: the built program on a virtual display, with real keys, a real mouse and a window manager.
//!
//! Needs Xvfb, openbox, xdotool and wmctrl. Without them the tests are skipped with a loud word, unless
//! `A3_REQUIRE_DISPLAY` forbids that.

#![cfg(target_os = "linux")]
#![allow(missing_docs, reason = "a test")]

use std::collections::HashMap;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::ops::Range;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// In the order of key t, after the cloth.
const SCENES: [&str; 9] = [
    "simple",
    "pendulum",
    "chain",
    "mit",
    "mit-sphere",
    "double-pendulum",
    "flag",
    "jelly",
    "cloth",
];

const PATIENCE: Duration = Duration::from_secs(30);

fn quiet(program: &str) -> Command {
    let mut command = Command::new(program);
    command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .stdin(Stdio::null());
    command
}

fn until<T>(what: &str, mut probe: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = probe() {
            return found;
        }
        assert!(begun.elapsed() < PATIENCE, "waited in vain: {what}");
        sleep(Duration::from_millis(20));
    }
}

/// One display at a time: two servers and two software renderers on two cores are in one another's way.
static TURN: Mutex<()> = Mutex::new(());

/// A display with a window manager, gone when dropped.
struct Display {
    server: Child,
    manager: Child,
    name: String,
    folder: TempDir,
    _turn: MutexGuard<'static, ()>,
}

impl Display {
    fn open() -> Option<Self> {
        let missing: Vec<_> = ["Xvfb", "openbox", "xdotool", "wmctrl"]
            .into_iter()
            .filter(|tool| {
                quiet("which")
                    .arg(tool)
                    .status()
                    .map_or(true, |status| !status.success())
            })
            .collect();
        if !missing.is_empty() {
            assert!(
                std::env::var_os("A3_REQUIRE_DISPLAY").is_none(),
                "A3_REQUIRE_DISPLAY is set: no {missing:?}"
            );
            // Past the test runner, which keeps what a passing test prints.
            let _ = writeln!(
                std::io::stderr(),
                "SKIPPED, NOT TESTED: the window needs {missing:?}"
            );
            return None;
        }
        // A test that failed has had its turn all the same.
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = tempfile::tempdir().unwrap();
        let mut server = quiet("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                "1400x900x24",
                "-noreset",
                "-nolisten",
                "tcp",
                "-fbdir",
            ])
            .arg(folder.path())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap())
            .read_line(&mut number)
            .unwrap();
        let name = format!(":{}", number.trim());
        let manager = quiet("openbox").env("DISPLAY", &name).spawn().unwrap();
        let display = Self {
            server,
            manager,
            name,
            folder,
            _turn: turn,
        };
        // A window that is mapped before the manager is up gets no focus.
        until("a window manager", || {
            display
                .command("wmctrl")
                .arg("-m")
                .status()
                .unwrap()
                .success()
                .then_some(())
        });
        Some(display)
    }

    fn command(&self, program: &str) -> Command {
        let mut command = quiet(program);
        command
            .env("DISPLAY", &self.name)
            .env_remove("WAYLAND_DISPLAY");
        command
    }

    fn xdotool(&self, words: &[&str]) -> String {
        let output = self
            .command("xdotool")
            .args(words)
            .stdout(Stdio::piped())
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap()
    }

    /// The screen as it is: red, green and blue by rows.
    fn screen(&self) -> Screen {
        // An XWD file, kept up to date by the server.
        let bytes = fs::read(self.folder.path().join("Xvfb_screen0")).unwrap();
        let word =
            |k: usize| u32::from_be_bytes(bytes[4 * k..4 * k + 4].try_into().unwrap()) as usize;
        let (width, height, stride, start) = (word(4), word(5), word(12), word(0) + 12 * word(19));
        assert_eq!(
            (word(7), word(11)),
            (0, 32),
            "four bytes a pixel, blue first"
        );
        let pixel = |x: usize, y: usize| {
            let at = start + y * stride + 4 * x;
            [bytes[at + 2], bytes[at + 1], bytes[at]]
        };
        let pixels = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| pixel(x, y));
        Screen {
            width,
            pixels: pixels.collect(),
        }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        for child in [&mut self.manager, &mut self.server] {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

struct Screen {
    width: usize,
    pixels: Vec<[u8; 3]>,
}

fn is_red([r, g, b]: [u8; 3]) -> bool {
    r > 100 && r / 2 > g && r / 2 > b
}

/// The grabbed particle's ball.
fn is_amber([r, g, b]: [u8; 3]) -> bool {
    r > 170 && g > 100 && g < r && u16::from(b) * 2 < u16::from(g) + 60 && b < 110
}

impl Screen {
    fn count(&self, is: impl Fn([u8; 3]) -> bool) -> usize {
        self.pixels.iter().filter(|pixel| is(**pixel)).count()
    }

    fn count_within(&self, x: Range<i32>, y: Range<i32>, is: impl Fn([u8; 3]) -> bool) -> usize {
        let inside = |k: &usize| {
            x.contains(&((k % self.width) as i32)) && y.contains(&((k / self.width) as i32))
        };
        (0..self.pixels.len())
            .filter(inside)
            .filter(|k| is(self.pixels[*k]))
            .count()
    }

    /// Mean difference of the channels.
    fn difference(&self, other: &Self) -> f64 {
        let pairs = self
            .pixels
            .iter()
            .flatten()
            .zip(other.pixels.iter().flatten());
        pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>()
            / (3.0 * self.pixels.len() as f64)
    }

    /// The middle of the pixels that are like that.
    fn middle(&self, is: impl Fn([u8; 3]) -> bool) -> (i32, i32) {
        let places: Vec<_> = (0..self.pixels.len())
            .filter(|k| is(self.pixels[*k]))
            .collect();
        assert!(!places.is_empty(), "nothing of that colour on the screen");
        let x = places.iter().map(|k| k % self.width).sum::<usize>() / places.len();
        let y = places.iter().map(|k| k / self.width).sum::<usize>() / places.len();
        (x as i32, y as i32)
    }
}

/// The program in its window, gone when dropped.
struct App<'d> {
    display: &'d Display,
    child: Child,
    window: String,
    lines: Arc<Mutex<Vec<String>>>,
}

impl<'d> App<'d> {
    /// Starts the program. Now and then its window does not show up, and why is not known: up to three tries, said aloud.
    fn open(display: &'d Display, folder: &Path, words: &[&str]) -> Self {
        (0..3)
            .find_map(|_| Self::try_open(display, folder, words))
            .expect("no window in three tries")
    }

    fn try_open(display: &'d Display, folder: &Path, words: &[&str]) -> Option<Self> {
        let mut child = display
            .command(env!("CARGO_BIN_EXE_a3"))
            .args(words)
            .arg("--status")
            .current_dir(folder)
            .env("XDG_RUNTIME_DIR", folder)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = Arc::new(Mutex::new(vec![]));
        let (sink, stderr) = (lines.clone(), child.stderr.take().unwrap());
        std::thread::spawn(move || {
            for line in BufReader::new(stderr).lines().map_while(Result::ok) {
                sink.lock().unwrap().push(line);
            }
        });
        let begun = Instant::now();
        let window = loop {
            let found = display.xdotool(&["search", "--onlyvisible", "--name", "^a3: "]);
            if let Some(window) = found.lines().next() {
                break window.to_owned();
            }
            if let Some(status) = child.try_wait().unwrap() {
                panic!(
                    "it left before its window opened, {status}: {:?}",
                    lines.lock().unwrap()
                );
            }
            if begun.elapsed() > PATIENCE / 3 {
                child.kill().unwrap();
                child.wait().unwrap();
                let lines = lines.lock().unwrap();
                let _ = writeln!(std::io::stderr(), "NO WINDOW, TRYING AGAIN: {lines:?}");
                return None;
            }
            sleep(Duration::from_millis(20));
        };
        display.xdotool(&["windowactivate", "--sync", &window]);
        let app = Self {
            display,
            child,
            window,
            lines,
        };
        until("a first frame", || {
            (app.number("frames")? > 2.0).then_some(())
        });
        Some(app)
    }

    fn status(&self) -> Option<HashMap<String, String>> {
        let lines = self.lines.lock().unwrap();
        let line = lines
            .iter()
            .rev()
            .find_map(|line| line.strip_prefix("status "))?;
        let pairs = line
            .split_whitespace()
            .filter_map(|word| word.split_once('='));
        Some(
            pairs
                .map(|(key, value)| (key.to_owned(), value.to_owned()))
                .collect(),
        )
    }

    fn get(&self, key: &str) -> String {
        self.status()
            .and_then(|status| status.get(key).cloned())
            .unwrap_or_default()
    }

    fn number(&self, key: &str) -> Option<f64> {
        self.status()?.get(key)?.parse().ok()
    }

    /// Left and top of the window on the screen.
    fn corner(&self) -> (i32, i32) {
        let text = self
            .display
            .xdotool(&["getwindowgeometry", "--shell", &self.window]);
        let value = |name| {
            text.lines()
                .find_map(|line| line.strip_prefix(name)?.parse().ok())
                .unwrap()
        };
        (value("X="), value("Y="))
    }

    fn expect(&self, key: &str, value: &str) {
        until(&format!("{key}={value}, is {}", self.get(key)), || {
            (self.get(key) == value).then_some(())
        });
    }

    fn press(&self, key: &str) {
        self.display.xdotool(&["key", key]);
    }

    /// Presses a key, and waits for its effect.
    fn press_for(&self, key: &str, name: &str, value: &str) {
        self.display.xdotool(&["key", key]);
        self.expect(name, value);
    }

    fn frames_go_on(&self) {
        let before = self.number("frames").unwrap();
        until("more frames", || {
            (self.number("frames")? > before + 2.0).then_some(())
        });
    }

    /// Waits until what is paused is drawn, and looks.
    fn settled(&self) -> Screen {
        let mut last = self.display.screen();
        until("a still picture", || {
            sleep(Duration::from_millis(250));
            let now = self.display.screen();
            let still = now.difference(&last) == 0.0;
            last = now;
            still.then_some(())
        });
        last
    }

    fn processor_ticks(&self) -> u64 {
        let text = fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap();
        let fields: Vec<_> = text
            .rsplit(')')
            .next()
            .unwrap()
            .split_whitespace()
            .collect();
        fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap()
    }

    fn exit(mut self) -> ExitStatus {
        let status = until("the end", || self.child.try_wait().unwrap());
        let lines = self.lines.lock().unwrap();
        assert!(
            !lines.iter().any(|line| line.contains("panicked")),
            "{lines:#?}"
        );
        status
    }
}

impl Drop for App<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn keys() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let app = App::open(&display, folder.path(), &["t", "0.01"]);
    for (key, value) in [
        ("scene", "cloth"),
        ("solver", "trapezoid"),
        ("step", "0.01"),
        ("size", "1280x720"),
    ] {
        assert_eq!(app.get(key), value);
    }

    // Simulated time keeps up with real time, in steps of exactly that size.
    let (time, begun) = (app.number("time").unwrap(), Instant::now());
    sleep(Duration::from_secs(2));
    let factor = (app.number("time").unwrap() - time) / begun.elapsed().as_secs_f64();
    assert!((0.5..1.25).contains(&factor), "{factor} times real time");
    let (time, steps) = (app.number("time").unwrap(), app.number("steps").unwrap());
    assert!(
        (time - 0.01 * steps).abs() < 1e-3,
        "{time} s after {steps} steps"
    );

    app.press_for("s", "swing", "true");
    app.press_for("d", "wind", "true");
    app.press_for("s", "swing", "false");
    app.press_for("d", "wind", "false");

    app.press_for("plus", "step", "0.012");
    app.press_for("minus", "step", "0.01");
    app.press_for("4", "solver", "rk4");
    app.press_for("6", "solver", "verlet");
    app.press_for("2", "solver", "trapezoid");

    app.press("p");
    let picture = folder.path().join("a3-cloth-1.png");
    until("a picture", || picture.exists().then_some(()));
    let picture = image::open(&picture).unwrap();
    assert_eq!((picture.width(), picture.height()), (1280, 720));

    for scene in SCENES {
        app.press_for("t", "scene", scene);
    }
    until("some time", || (app.number("time")? > 1.0).then_some(()));
    app.press("r");
    until("the beginning", || {
        (app.number("time")? < 0.9).then_some(())
    });
    app.press("Escape");
    assert!(app.exit().success());
}

#[test]
fn pausing_looking_and_help() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let app = App::open(&display, folder.path(), &["t", "0.01"]);

    // Paused it stands still, costs nothing, and takes single steps.
    app.press_for("space", "paused", "true");
    let shaded = app.settled();
    let (steps, ticks) = (app.number("steps").unwrap(), app.processor_ticks());
    sleep(Duration::from_secs(2));
    assert!(
        app.processor_ticks() - ticks <= 4,
        "paused, it takes {} ticks",
        app.processor_ticks() - ticks
    );
    assert_eq!(app.number("steps").unwrap(), steps);
    app.press("period");
    until("a step", || {
        (app.number("steps")? == steps + 1.0).then_some(())
    });

    // The surface is red, the wires are not.
    assert!(
        shaded.count(is_red) > 20_000,
        "{} red pixels",
        shaded.count(is_red)
    );
    app.press_for("w", "style", "Wireframe");
    let wires = app.settled();
    assert!(
        wires.count(is_red) < 100,
        "{} red pixels",
        wires.count(is_red)
    );
    assert!(wires.difference(&shaded) > 2.0);
    app.press_for("w", "style", "Shaded");

    // Help comes and goes without a trace.
    let before = app.settled();
    app.press_for("h", "help", "true");
    until("the help", || {
        (display.screen().difference(&before) > 1.0).then_some(())
    });
    app.press_for("question", "help", "false");
    until("no help", || {
        (display.screen().difference(&before) < 0.1).then_some(())
    });

    // Wheel and drag move the camera, c brings it home.
    display.xdotool(&[
        "mousemove",
        "--window",
        &app.window,
        "1150",
        "600",
        "click",
        "4",
        "click",
        "4",
    ]);
    display.xdotool(&[
        "mousedown",
        "1",
        "mousemove_relative",
        "--",
        "-200",
        "20",
        "mouseup",
        "1",
    ]);
    until("another view", || {
        (display.screen().difference(&before) > 1.0).then_some(())
    });
    app.press("c");
    until("the first view", || {
        (display.screen().difference(&before) < 0.1).then_some(())
    });

    app.press_for("space", "paused", "false");
    until("more steps", || {
        (app.number("steps")? > steps + 5.0).then_some(())
    });
    display.xdotool(&["key", "Escape"]);
    assert!(app.exit().success());
}

/// By keys and by the mouse, which turns nothing else then; and what was tuned is written and goes on.
#[test]
fn tuning() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let app = App::open(&display, folder.path(), &["r", "0.01"]);
    app.press_for("Tab", "panel", "true");
    app.press("Down");
    app.press_for("Right", "step", "0.0126");
    app.press_for("shift+Right", "step", "0.0129");
    app.press_for("Return", "step", "0.01");
    app.press_for("s", "swing", "true");
    // The slider of the same row: to its end, past the panel's edge.
    let slide = |words: &[&str]| {
        display.xdotool(&[&["mousemove", "--window", &app.window], words].concat());
    };
    slide(&["1120", "70", "mousedown", "1"]);
    app.frames_go_on();
    slide(&["700", "300"]);
    app.expect("step", "0.00001");
    assert_eq!(app.get("grabbed"), "-");
    display.xdotool(&["mouseup", "1"]);
    app.frames_go_on();
    slide(&["1250", "70", "click", "--repeat", "2", "--delay", "60", "1"]);
    app.expect("step", "0.01");
    app.press("f");
    let file = folder.path().join("a3-cloth-1.toml");
    until("a scene file", || file.exists().then_some(()));
    app.press_for("Tab", "panel", "false");
    app.press("Escape");
    assert!(app.exit().success());
    let again = ["--scene", "a3-cloth-1.toml"];
    let app = App::open(&display, folder.path(), &again);
    for (key, value) in [("scene", "cloth"), ("solver", "rk4"), ("step", "0.01")] {
        assert_eq!(app.get(key), value);
    }
    app.press("Escape");
    assert!(app.exit().success());
}

#[test]
fn pulling() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let app = App::open(&display, folder.path(), &["t", "0.01"]);
    until("the cloth to hang", || {
        (app.number("time")? > 2.0).then_some(())
    });
    // Places in the window from now on.
    let (x, y) = display.screen().middle(is_red);
    let (left, top) = app.corner();
    let (x, y) = (x - left, y - top);
    let go = |x: i32, y: i32| {
        display.xdotool(&[
            "mousemove",
            "--window",
            &app.window,
            &x.to_string(),
            &y.to_string(),
        ]);
    };
    go(x, y);
    display.xdotool(&["mousedown", "1"]);
    until("a grip", || (app.get("grabbed") != "-").then_some(()));
    let particle = app.get("grabbed");
    let hand = || {
        let (x, y) = app
            .get("hand")
            .split_once(',')
            .map(|(x, y)| (x.parse(), y.parse()))?;
        Some((x.ok()?, y.ok()?))
    };
    let (hx, hy): (i32, i32) = until("a hand", hand);
    assert!(
        hx.abs_diff(x) < 40 && hy.abs_diff(y) < 40,
        "the particle {hx},{hy} is near the pointer {x},{y}"
    );
    // A fast drag: all of the way at once, then here and there. The particle stays where it is under the pointer.
    let (mut seen, off) = (0, (hx - x, hy - y));
    for (dx, dy) in [(150, -60), (-170, -40), (120, 60)] {
        go(x + dx, y + dy);
        until("the particle under the pointer", || {
            let (hx, hy) = hand()?;
            (hx.abs_diff(x + dx + off.0) < 3 && hy.abs_diff(y + dy + off.1) < 3).then_some(())
        });
        assert_eq!(app.get("grabbed"), particle);
        app.frames_go_on();
        seen = seen.max(display.screen().count(is_amber));
    }
    assert!(seen > 10, "the particle in the hand is marked");
    display.xdotool(&["mouseup", "1"]);
    app.expect("grabbed", "-");
    app.expect("blown", "false");
    // Off the cloth there is nothing to grab.
    display.xdotool(&[
        "mousemove",
        "--window",
        &app.window,
        "1200",
        "650",
        "mousedown",
        "1",
    ]);
    app.frames_go_on();
    assert_eq!(app.get("grabbed"), "-");
    display.xdotool(&["mouseup", "1"]);
    app.press("Escape");
    assert!(app.exit().success());
}

/// A right click pins and lets go, a right drag does not; a double click lists springs; time goes slowly, and back.
#[test]
fn clicks_slow_motion_and_going_back() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let app = App::open(&display, folder.path(), &["t", "0.01"]);
    until("some time", || (app.number("time")? > 1.5).then_some(()));
    app.press_for("bracketleft", "slowness", "1");
    app.press_for("bracketleft", "slowness", "2");
    let (time, begun) = (app.number("time").unwrap(), Instant::now());
    sleep(Duration::from_secs(2));
    let factor = (app.number("time").unwrap() - time) / begun.elapsed().as_secs_f64();
    assert!((0.1..0.32).contains(&factor), "{factor} times real time");
    app.press_for("bracketright", "slowness", "1");
    app.press_for("space", "paused", "true");
    let now = app.number("time").unwrap();
    app.press_for("comma", "scrubbed", "true");
    app.press("less");
    until("a time before", || {
        (app.number("time")? < now - 0.15).then_some(())
    });
    app.press("period");
    app.press_for("greater", "scrubbed", "false");
    until("the same time", || {
        (app.number("time")? == now).then_some(())
    });
    // Along the bar.
    app.press_for("comma", "scrubbed", "true");
    let go = |x: &str| display.xdotool(&["mousemove", "--window", &app.window, x, "682"]);
    go("800");
    display.xdotool(&["mousedown", "1"]);
    go("420");
    until("long before", || {
        (app.number("time")? < 0.4 * now).then_some(())
    });
    go("1200");
    app.expect("scrubbed", "false");
    display.xdotool(&["mouseup", "1"]);
    until("the same time", || {
        (app.number("time")? == now).then_some(())
    });

    let (x, y) = display.screen().middle(is_red);
    let (left, top) = app.corner();
    let place = [(x - left).to_string(), (y - top).to_string()];
    let click = |words: &[&str]| {
        let there = ["mousemove", "--window", &app.window, &place[0], &place[1]];
        display.xdotool(&[&there[..], words].concat());
    };
    assert_eq!(app.get("pins"), "20");
    click(&["click", "3"]);
    app.expect("pins", "21");
    click(&["click", "3"]);
    app.expect("pins", "20");
    click(&["click", "--repeat", "2", "--delay", "60", "1"]);
    until("springs", || (app.get("springs_of") != "-").then_some(()));
    // Two clicks far apart are not one of two.
    let beside = |x: &'static str| ["mousemove", "--window", &app.window, x, "600", "click", "1"];
    display.xdotool(&[beside("1100"), beside("1200")].concat());
    app.frames_go_on();
    assert_ne!(app.get("springs_of"), "-");
    let before = app.settled();
    click(&[
        "mousedown",
        "3",
        "mousemove_relative",
        "60",
        "20",
        "mouseup",
        "3",
    ]);
    until("another view", || {
        (display.screen().difference(&before) > 0.5).then_some(())
    });
    assert_eq!(app.get("pins"), "20");
    display.xdotool(&["mousemove", "--window", &app.window, "1200", "650"]);
    display.xdotool(&["click", "--repeat", "2", "--delay", "60", "1"]);
    app.expect("springs_of", "-");
    app.press("Escape");
    assert!(app.exit().success());
}

#[test]
fn sizes_minimising_a_lost_device_and_closing() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let app = App::open(&display, folder.path(), &["r", "0.01", "--wind"]);
    for (width, height) in [
        ("90", "70"),
        ("4000", "3000"),
        ("333", "777"),
        ("1280", "720"),
    ] {
        display.xdotool(&["windowsize", &app.window, width, height]);
        app.expect("size", &format!("{width}x{height}"));
        app.frames_go_on();
    }
    // A flood of sizes.
    for k in 0..40 {
        display.xdotool(&[
            "windowsize",
            &app.window,
            &(300 + 17 * k).to_string(),
            &(700 - 11 * k).to_string(),
        ]);
    }
    display.xdotool(&["windowsize", &app.window, "1280", "720"]);
    app.expect("size", "1280x720");

    display.xdotool(&["windowminimize", &app.window]);
    app.expect("visible", "false");
    let (time, frames) = (app.number("time").unwrap(), app.number("frames").unwrap());
    sleep(Duration::from_secs(2));
    assert!(
        app.number("frames").unwrap() <= frames + 1.0,
        "drawn while minimised"
    );
    display.xdotool(&["windowmap", &app.window, "windowactivate", &app.window]);
    app.expect("visible", "true");
    app.frames_go_on();
    assert!(
        app.number("time").unwrap() < time + 1.5,
        "time ran on while minimised"
    );

    // The device is lost, and the picture comes back, the simulation untouched.
    for lost in 1..=3 {
        let steps = app.number("steps").unwrap();
        app.press_for("F12", "devices", &(1 + lost).to_string());
        app.frames_go_on();
        assert!(app.number("steps").unwrap() > steps);
    }
    assert!(display.screen().count(is_red) > 10_000);

    display
        .command("wmctrl")
        .args(["-i", "-c", &app.window])
        .status()
        .unwrap();
    assert!(app.exit().success());
}

/// When a run blows up, the window says so, stands still, and starts again with r.
#[test]
fn blowing_up() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let app = App::open(&display, folder.path(), &["e", "0.05", "--scene", "mit"]);
    app.expect("blown", "true");
    let steps = app.number("steps").unwrap();
    sleep(Duration::from_millis(500));
    assert_eq!(app.number("steps").unwrap(), steps);
    // In red, on the sheet below the first one, where nothing else can be red.
    let (left, top) = app.corner();
    let screen = app.settled();
    let told = screen.count_within(left + 12..left + 320, top + 200..top + 300, |[r, g, b]| {
        r > 150 && g < 90 && b < 90
    });
    assert!(told > 100, "it says so in red: {told} pixels");
    for _ in 0..40 {
        app.press("minus");
    }
    until("a small step", || {
        (app.number("step")? < 0.0003).then_some(())
    });
    app.press_for("r", "blown", "false");
    app.frames_go_on();
    app.press("Escape");
    assert!(app.exit().success());
}

/// Where the hands are in the left and in the right pane (px).
fn hands(app: &App) -> Option<((i32, i32), (i32, i32))> {
    let hands = app.get("hands");
    let place = |hand: &str| {
        let (x, y) = hand.split_once(',')?;
        Some((x.parse().ok()?, y.parse().ok()?))
    };
    let (a, b) = hands.split_once(';')?;
    Some((place(a)?, place(b)?))
}

/// Several methods at the same time: each in its pane, with its own error; keys and hands for all.
#[test]
fn comparing() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let words = ["compare", "e:0.05", "r:0.05", "--scene", "simple"];
    let app = App::open(&display, folder.path(), &words);
    assert_eq!(app.get("solvers"), "euler,rk4");
    let both = |key: &str| -> Option<(f64, f64)> {
        let values = app.get(key);
        let (a, b) = values.split_once(',')?;
        Some((a.parse().ok()?, b.parse().ok()?))
    };
    until("two errors", || {
        let (euler, rk4) = both("errors")?;
        (euler > 0.05 && rk4 < 1e-5).then_some(())
    });
    let (a, b) = both("times").unwrap();
    assert!((a - b).abs() < 0.051, "{a} {b}");

    // Plus is for all; a digit for the pane under the pointer.
    app.press_for("plus", "step_sizes", "0.06,0.06");
    display.xdotool(&["mousemove", "--window", &app.window, "1000", "600"]);
    app.press_for("2", "solvers", "euler,trapezoid");
    display.xdotool(&["mousemove", "--window", &app.window, "200", "600"]);
    app.press_for("4", "solvers", "rk4,trapezoid");

    app.press("p");
    let picture = folder.path().join("a3-simple-1.png");
    until("a picture", || picture.exists().then_some(()));
    let picture = image::open(&picture).unwrap();
    assert_eq!((picture.width(), picture.height()), (1280, 720));

    // Sizes in which the panes are elsewhere.
    for (width, height) in [("260", "860"), ("90", "70"), ("1280", "720")] {
        display.xdotool(&["windowsize", &app.window, width, height]);
        app.expect("size", &format!("{width}x{height}"));
        app.frames_go_on();
    }

    // The next scene is there in both panes, and a pull in the right one is a pull in both.
    for scene in &SCENES[1..] {
        app.press_for("t", "scene", scene);
    }
    for _ in 0..12 {
        app.press("minus");
    }
    app.press_for("r", "lost", "false,false");
    until("the cloth to hang", || {
        (app.number("time")? > 1.0).then_some(())
    });
    let (left, top) = app.corner();
    let halves = |screen: &Screen, is: fn([u8; 3]) -> bool| {
        let half = |k: i32| left + 642 * k..left + 642 * k + 638;
        [0, 1].map(|k| screen.count_within(half(k), top + 40..top + 720, is))
    };
    let screen = display.screen();
    assert!(
        halves(&screen, is_red).into_iter().all(|red| red > 3000),
        "{:?}",
        halves(&screen, is_red)
    );
    let (x, y) = (1280 * 3 / 4 + 40, 330);
    let go = |x: i32, y: i32| {
        let (x, y) = (x.to_string(), y.to_string());
        display.xdotool(&["mousemove", "--window", &app.window, &x, &y]);
    };
    go(x, y);
    display.xdotool(&["mousedown", "1"]);
    let hands = || hands(&app);
    let (_, near) = until("a hand in each pane", hands);
    assert!(
        near.0.abs_diff(x) < 40 && near.1.abs_diff(y) < 40,
        "{near:?}"
    );
    go(x + 60, y - 40);
    until("both hands at the same place of their panes", || {
        let (a, b) = hands()?;
        let moved = b.0.abs_diff(near.0 + 60) < 4 && b.1.abs_diff(near.1 - 40) < 4;
        (moved && a.0.abs_diff(b.0 - 641) < 4 && a.1.abs_diff(b.1) < 4).then_some(())
    });
    // A fold of the cloth may lie before a mark for a while.
    let mut elsewhere = [(-120, -60), (60, -40)].into_iter().cycle();
    until("a mark in each pane", || {
        let marked = halves(&display.screen(), is_amber);
        if marked.into_iter().all(|amber| amber > 5) {
            return Some(());
        }
        let (dx, dy) = elsewhere.next()?;
        go(x + dx, y + dy);
        None
    });
    display.xdotool(&["mouseup", "1"]);
    app.expect("grabbed", "-");
    app.expect("lost", "false,false");

    // The device is lost, and both pictures come back.
    app.press_for("F12", "devices", "2");
    app.frames_go_on();
    assert!(
        halves(&display.screen(), is_red)
            .into_iter()
            .all(|red| red > 3000)
    );
    app.press("Escape");
    assert!(app.exit().success());
}

/// A scene file that is saved is loaded again; one with a fault leaves the scene as it is, until it is mended. Also while
/// all stands still.
#[test]
fn watching() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.toml");
    let save = |step: &str, pins: &str| {
        let cloth = "[[cloth]]\ngrid = [5, 5]\nwidth = 1\nmass = 0.1\nstiffness = [20, 10, 5]\n";
        let pin = format!("pin = [{{ at = [{pins}] }}]\n");
        fs::write(&file, format!("solver = 'r'\nstep = {step}\n{cloth}{pin}")).unwrap();
    };
    save("0.01", "'top'");
    let app = App::open(
        &display,
        folder.path(),
        &["--scene", "mine.toml", "--watch"],
    );
    app.expect("pins", "5");
    app.frames_go_on();
    save("0.005", "'top-left', 'top-right'");
    app.expect("pins", "2");
    app.expect("step", "0.005");
    fs::write(&file, "step = 0.002\n[[cloth]]\ngrid = [5,").unwrap();
    sleep(Duration::from_secs(1));
    app.frames_go_on();
    assert_eq!(
        (app.get("pins"), app.get("step")),
        ("2".into(), "0.005".into())
    );
    app.press_for("space", "paused", "true");
    save("0.002", "'bottom'");
    app.expect("pins", "5");
    app.expect("step", "0.002");
    app.press("Escape");
    assert!(app.exit().success());
}
