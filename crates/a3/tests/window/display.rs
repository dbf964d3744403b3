//! A virtual display with a window manager.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::app::App;
use crate::common::{Folder, Words};
use crate::screen::Screen;

/// Longest time to wait for anything.
pub const MAX_WAIT: Duration = Duration::from_secs(30);

/// Returns a command without input and output.
pub fn quiet(program: &str) -> Command {
    let mut command = Command::new(program);
    command.stdout(Stdio::null()).stderr(Stdio::null()).stdin(Stdio::null());
    command
}

/// Waits until `probe` returns something, and returns it.
pub fn until<T>(what: &str, mut probe: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = probe() {
            return found;
        }
        assert!(begun.elapsed() < MAX_WAIT, "waited in vain: {what}");
        sleep(Duration::from_millis(20));
    }
}

/// Lock for one display at a time: two servers and two software renderers would slow each other
/// down on two cores.
static DISPLAY_LOCK: Mutex<()> = Mutex::new(());

/// A virtual display with a window manager; closed when dropped.
pub struct Display {
    server: Child,
    manager: Child,
    name: String,
    folder: Folder,
    /// Folder of the program and its settings.
    pub home: Folder,
    _lock: MutexGuard<'static, ()>,
}

impl Display {
    /// Opens a display, or returns `None`, with a message, if a tool is missing.
    pub fn open() -> Option<Self> {
        let missing: Vec<_> = ["Xvfb", "openbox", "xdotool", "wmctrl", "xclip"]
            .into_iter()
            .filter(|tool| {
                quiet("which").arg(tool).status().map_or(true, |status| !status.success())
            })
            .collect();
        if !missing.is_empty() {
            assert!(
                std::env::var_os("A3_REQUIRE_DISPLAY").is_none(),
                "A3_REQUIRE_DISPLAY is set: no {missing:?}"
            );
            // Bypass the test runner, which hides the output of passing tests.
            let _ =
                writeln!(std::io::stderr(), "SKIPPED, NOT TESTED: the window needs {missing:?}");
            return None;
        }
        // A failed test has released the display too.
        let lock = DISPLAY_LOCK.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = Folder::new();
        let mut server = quiet("Xvfb")
            .args("-displayfd 1 -screen 0 1400x900x24 -noreset -nolisten tcp -fbdir".split(' '))
            .arg(&*folder)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let name = format!(":{}", number.trim());
        let manager = quiet("openbox").env("DISPLAY", &name).spawn().unwrap();
        let display = Self { server, manager, name, folder, home: Folder::new(), _lock: lock };
        // A window that opens before the manager runs gets no focus.
        until("a window manager", || {
            display.command("wmctrl").arg("-m").status().unwrap().success().then_some(())
        });
        Some(display)
    }

    /// Opens the program in its window, in at most three tries.
    pub fn open_app(&self, words: &str) -> App<'_> {
        (0..3).find_map(|_| App::try_open(self, words)).expect("no window in three tries")
    }

    pub fn command(&self, program: &str) -> Command {
        let mut command = quiet(program);
        command.env("DISPLAY", &self.name).env_remove("WAYLAND_DISPLAY");
        command
    }

    pub fn xdotool(&self, words: impl Words) -> String {
        let output =
            self.command("xdotool").args(words.list()).stdout(Stdio::piped()).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    }

    /// Returns the present contents of the screen.
    pub fn screen(&self) -> Screen {
        let file = self.folder.join("Xvfb_screen0");
        Screen::of(&fs::read(file).unwrap())
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
