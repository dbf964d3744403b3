//! A running program with its window.

use std::collections::HashMap;
use std::ffi::OsString;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::sleep;
use std::time::{Duration, Instant};
use std::{env, fmt, fs};

use crate::common::Words;
use crate::display::{Display, MAX_WAIT, until};
use crate::screen::Screen;

fn first_in_path(folder: &Path) -> OsString {
    let path = env::var_os("PATH").unwrap_or_default();
    env::join_paths([folder.to_owned()].into_iter().chain(env::split_paths(&path))).unwrap()
}

/// A running program with its window; killed when dropped.
pub struct App<'d> {
    display: &'d Display,
    child: Child,
    pub window: String,
    lines: Arc<Mutex<Vec<String>>>,
    /// Lines on its standard output so far.
    said: Arc<Mutex<Vec<String>>>,
}

/// Collects the lines of a stream on a thread.
fn collect(stream: impl Read + Send + 'static) -> Arc<Mutex<Vec<String>>> {
    let lines = Arc::new(Mutex::new(vec![]));
    let sink = lines.clone();
    std::thread::spawn(move || {
        for line in BufReader::new(stream).lines().map_while(Result::ok) {
            sink.lock().unwrap().push(line);
        }
    });
    lines
}

impl<'d> App<'d> {
    /// Starts the program; `None`, with a message, if its window does not appear, which happens
    /// occasionally, for an unknown reason.
    pub fn try_open(display: &'d Display, words: &str) -> Option<Self> {
        let folder = &display.home;
        let mut child = display
            .command(env!("CARGO_BIN_EXE_a3"))
            .args(words.list())
            .arg("--status")
            .current_dir(folder)
            .env("XDG_RUNTIME_DIR", &**folder)
            .stdout(Stdio::piped())
            .env("XDG_CACHE_HOME", &**folder)
            .env("XDG_CONFIG_HOME", &**folder)
            // A test may put programs there that replace the system's own.
            .env("PATH", first_in_path(folder))
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = collect(child.stderr.take().unwrap());
        let said = collect(child.stdout.take().unwrap());
        let begun = Instant::now();
        let window = loop {
            let found = display.xdotool(["search", "--onlyvisible", "--name", "^a3: "]);
            if let Some(window) = found.lines().next() {
                break window.to_owned();
            }
            if let Some(status) = child.try_wait().unwrap() {
                panic!("it left before its window opened, {status}: {:?}", lines.lock().unwrap());
            }
            if begun.elapsed() > MAX_WAIT / 3 {
                child.kill().unwrap();
                child.wait().unwrap();
                let lines = lines.lock().unwrap();
                let _ = writeln!(std::io::stderr(), "NO WINDOW, TRYING AGAIN: {lines:?}");
                return None;
            }
            sleep(Duration::from_millis(20));
        };
        display.xdotool(["windowactivate", "--sync", &window]);
        let app = Self { display, child, window, lines, said };
        app.wait("frames", |frames| frames > 2.0);
        Some(app)
    }

    /// Returns its standard output so far.
    pub fn said(&self) -> String {
        self.said.lock().unwrap().join("\n")
    }

    /// Returns the last status line, by its keys.
    pub fn status(&self) -> Option<HashMap<String, String>> {
        let lines = self.lines.lock().unwrap();
        let line = lines.iter().rev().find_map(|line| line.strip_prefix("status "))?;
        let pairs = line.split_whitespace().filter_map(|word| word.split_once('='));
        Some(pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect())
    }

    pub fn get(&self, key: &str) -> String {
        self.status().and_then(|status| status.get(key).cloned()).unwrap_or_default()
    }

    pub fn number(&self, key: &str) -> Option<f64> {
        self.status()?.get(key)?.parse().ok()
    }

    /// Returns left and top of the window on the screen (px).
    pub fn corner(&self) -> (i32, i32) {
        let text = self.display.xdotool(["getwindowgeometry", "--shell", &self.window]);
        let value =
            |name| text.lines().find_map(|line| line.strip_prefix(name)?.parse().ok()).unwrap();
        (value("X="), value("Y="))
    }

    /// Waits until a key of the status has a value.
    pub fn expect(&self, key: &str, value: &str) {
        until(&format!("{key}={value}, is {}", self.get(key)), || {
            (self.get(key) == value).then_some(())
        });
    }

    pub fn press(&self, key: &str) {
        self.display.xdotool(["key", key]);
    }

    /// Moves the pointer to a place in the window (px).
    pub fn point(&self, x: impl fmt::Display, y: impl fmt::Display) {
        self.point_and(x, y, "");
    }

    /// Moves the pointer to a place in the window (px), and does what further words say.
    pub fn point_and(&self, x: impl fmt::Display, y: impl fmt::Display, words: &str) {
        let words = format!("mousemove --window {} {x} {y} {words}", self.window);
        self.display.xdotool(words);
    }

    /// Waits until a number of the status is as wanted.
    pub fn wait(&self, key: &str, is_so: impl Fn(f64) -> bool) {
        until(key, || is_so(self.number(key)?).then_some(()));
    }

    /// Sets the size of the window (px).
    pub fn resize(&self, [width, height]: [u32; 2]) {
        let words = format!("windowsize {} {width} {height}", self.window);
        self.display.xdotool(words);
    }

    /// Presses a key, and waits for its effect.
    pub fn press_for(&self, key: &str, name: &str, value: &str) {
        self.press(key);
        self.expect(name, value);
    }

    /// Waits for further frames.
    pub fn expect_frames(&self) {
        let before = self.number("frames").unwrap();
        self.wait("frames", |frames| frames > before + 2.0);
    }

    /// Waits until a paused program draws no more, and returns the screen.
    pub fn still_screen(&self) -> Screen {
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

    pub fn processor_ticks(&self) -> u64 {
        let text = fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap();
        let fields: Vec<_> = text.rsplit(')').next().unwrap().split_whitespace().collect();
        fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap()
    }

    /// Quits as a user does: Esc asks, and Enter answers.
    pub fn quit(self) {
        self.press_for("Escape", "asks", "true");
        self.press("Return");
        assert!(self.exit().success());
    }

    pub fn exit(mut self) -> ExitStatus {
        let status = until("the end", || self.child.try_wait().unwrap());
        let lines = self.lines.lock().unwrap();
        assert!(!lines.iter().any(|line| line.contains("panicked")), "{lines:#?}");
        status
    }
}

impl Drop for App<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
