//! The lessons of the folder `lessons`, embedded in the program, so that they can be read wherever
//! it is installed: opened from the window, or printed.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, thread};

use crate::base::failure::Failure;
use crate::base::terminal;
use crate::cli::LESSONS;
use crate::files::output;

macro_rules! carried {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_bytes!(concat!("../../lessons/", $name)))),*]
    };
}

/// The files by their names: the index, then the lessons in their order, then their pictures.
static FILES: &[(&str, &[u8])] = carried![
    "README.md",
    "1-euler-spirals.md",
    "2-heun-without-damping.md",
    "3-stiffness-and-the-step.md",
    "4-order-and-cost.md",
    "5-symplectic-or-not.md",
    "6-implicit-methods.md",
    "7-contact-and-order.md",
    "8-how-fine-a-cloth.md",
    "pictures/energy.png",
    "pictures/floor.png",
    "pictures/free.png",
    "pictures/heun.png",
    "pictures/implicit.png",
    "pictures/models.png",
    "pictures/order.png",
    "pictures/spiral.png",
    "pictures/stiff.png",
];

// The index comes first, and then the lessons.
const _: () = assert!((LESSONS as usize) < FILES.len());

/// Command that opens a file with the user's program for it.
const OPENER: &str = if cfg!(target_os = "macos") {
    "open"
} else if cfg!(windows) {
    "explorer"
} else {
    "xdg-open"
};

/// Prints a lesson, or the index.
pub fn print(lesson: Option<u8>) -> Result<(), Failure> {
    let (_, text) = FILES[usize::from(lesson.unwrap_or(0))];
    terminal::send(&String::from_utf8_lossy(text))
}

/// Writes the lessons to the user's cache folder, opens the index, and returns a message that says
/// so.
pub fn open() -> Result<String, Failure> {
    let folder = folder();
    write(&folder)?;
    Ok(open_with(OPENER, &folder.join(FILES[0].0)))
}

/// Returns the folder of the lessons in the user's cache folder.
fn folder() -> PathBuf {
    let named = |name| env::var_os(name).map(PathBuf::from);
    let absolute = |path: &PathBuf| path.is_absolute();
    let cache = named(if cfg!(windows) {
        "LOCALAPPDATA"
    } else {
        "XDG_CACHE_HOME"
    });
    cache
        .filter(absolute)
        .or_else(|| Some(env::home_dir().filter(absolute)?.join(".cache")))
        .unwrap_or_else(env::temp_dir)
        .join("a3")
        .join("lessons")
}

/// Writes the files that are missing or differ.
fn write(folder: &Path) -> Result<(), Failure> {
    for (name, bytes) in FILES {
        let path = folder.join(name);
        if fs::read(&path).is_ok_and(|there| there == *bytes) {
            continue;
        }
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)
                .map_err(|why| Failure::run(format!("{}: {why}", folder.display())))?;
        }
        output::write(&path, bytes)?;
    }
    Ok(())
}

/// Opens a file with a program, without waiting for it. Returns a message with the path of the
/// file.
fn open_with(opener: &str, path: &Path) -> String {
    let child = Command::new(opener)
        .arg(path)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    let path = path.display();
    match child {
        Ok(mut child) => {
            // A child process stays as a zombie until it is waited for.
            thread::spawn(move || child.wait());
            format!("opened {path}")
        }
        Err(_) => {
            format!("The lessons are in {path}; {opener}, which would open them, is not installed.")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/lessons");

    #[test]
    fn every_file_of_the_lessons_is_carried_and_written() {
        let folder = tempfile::tempdir().unwrap();
        let lessons = folder.path().join("a3/lessons");
        write(&lessons).unwrap();
        fs::write(lessons.join("README.md"), "of another version").unwrap();
        write(&lessons).unwrap();
        let mut count = 0;
        for part in ["", "pictures"] {
            for entry in fs::read_dir(Path::new(SOURCE).join(part)).unwrap() {
                let path = entry.unwrap().path();
                if path.is_file() {
                    let copy = lessons.join(part).join(path.file_name().unwrap());
                    assert!(
                        fs::read(&copy).unwrap() == fs::read(&path).unwrap(),
                        "{copy:?}"
                    );
                    count += 1;
                }
            }
        }
        assert_eq!(count, FILES.len());
        assert!(
            FILES[usize::from(LESSONS)]
                .0
                .starts_with(&LESSONS.to_string())
        );
        assert!(FILES[usize::from(LESSONS) + 1].0.starts_with("pictures/"));
    }

    #[test]
    fn where_nothing_opens_them_it_says_where_they_are() {
        let said = open_with("no-such-opener", Path::new("/some/README.md"));
        for word in ["/some/README.md", "no-such-opener", "not installed"] {
            assert!(said.contains(word), "{said}");
        }
    }
}
