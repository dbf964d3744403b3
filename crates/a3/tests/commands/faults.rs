//! A disk that fails from the n-th operation on, for every n until a command succeeds: each target
//! is the old file or the complete new one, no temporary file remains, and one line says where and
//! why.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::common::{Folder, command, complaint, gpu_is_missing, is_missing, text};

/// Returns the files of a folder, with their contents.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        (name, fs::read(entry.path()).unwrap())
    });
    entries.collect()
}

/// Returns whether a file is as expected, apart from the real time of its run.
fn is_whole(name: &str, bytes: &[u8], whole: &[u8]) -> bool {
    let timeless = |bytes: &[u8]| {
        let lines = String::from_utf8_lossy(bytes).into_owned();
        let lines = lines.lines().filter(|line| !line.contains("wall_time"));
        lines.map(String::from).collect::<Vec<_>>()
    };
    bytes == whole || name == "summary.json" && timeless(bytes) == timeless(whole)
}

/// Makes a command fail at every operation, over files that exist already. It must fail at least
/// `least` times, and its files must exist after it.
fn fail_everywhere(words: &str, files: &[&str], least: usize) {
    let fresh = || {
        let folder = Folder::new();
        for file in files {
            folder.write(file, OLD);
        }
        folder
    };
    let folder = &fresh();
    let output = command(folder, words).output().unwrap();
    if gpu_is_missing(&output) {
        return;
    }
    assert!(output.status.success(), "{words:?}: {}", text(&output.stderr));
    let whole = contents(folder);
    for fault in 1.. {
        let folder = &fresh();
        let output = command(folder, words).env("A3_FAULT", fault.to_string()).output().unwrap();
        let there = contents(folder);
        for (name, bytes) in &there {
            let old = files.contains(&&**name) && bytes == OLD;
            let new = whole.get(name).is_some_and(|whole| is_whole(name, bytes, whole));
            assert!(old || new, "{words:?}, fault {fault}: {name}");
        }
        for name in files {
            assert!(there.contains_key(*name), "{words:?}, fault {fault}: {name}");
        }
        if output.status.success() {
            assert!(fault > least, "{words:?} fails only {} times", fault - 1);
            assert_eq!(there.len(), whole.len(), "{words:?}");
            return;
        }
        let stderr = text(&output.stderr).replace("error: ./", "error: ");
        assert_eq!(output.status.code(), Some(1), "{words:?}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{words:?}: {stderr}");
        let names_place = whole.keys().any(|name| stderr.contains(&format!("error: {name}: ")));
        assert!(names_place || stderr.contains("error: standard output "), "{words:?}: {stderr}");
        assert!(stderr.contains("no storage space"), "{words:?}: {stderr}");
    }
}

const OLD: &[u8] = b"old";

#[test]
fn exports_survive_every_fault() {
    let run = "simulate r 0.01 --scene chain --until 0.1";
    fail_everywhere(&format!("{run} -o -"), &[], 1);
    fail_everywhere(
        &format!("{run} -o x.json --summary summary.json"),
        &["x.json", "summary.json"],
        10,
    );
    fail_everywhere(&format!("{run} -o x.json --fps 30"), &["x.json"], 5);
    fail_everywhere(&format!("{run} -o x.csv"), &["x.csv"], 5);
    fail_everywhere(&format!("{run} -o x.npz"), &["x.npz"], 10);
    fail_everywhere(&format!("{run} -o x.obj"), &["x.obj"], 5);
    fail_everywhere(&format!("{run} -o x-#.obj"), &["x-2.obj"], 20);
    fail_everywhere(&format!("{run} -o x.glb"), &["x.glb"], 7);
    fail_everywhere(&format!("{run} -o x.usda"), &["x.usda"], 7);
}

#[test]
fn pictures_and_films_survive_every_fault() {
    let run = "render r 0.01 --scene chain --until 0.1 --size 64x48 --fps 20";
    let picture = run.replace(" --fps 20", "");
    fail_everywhere(&format!("{picture} -o x.png"), &["x.png"], 5);
    fail_everywhere(&format!("{run} -o x-#.png"), &[], 15);
    fail_everywhere(&format!("{run} -o x.gif"), &["x.gif"], 5);
    if !is_missing("ffmpeg") {
        fail_everywhere(&format!("{run} -o x.mp4"), &["x.mp4"], 4);
    }
}

#[test]
fn charts_and_manuals_survive_every_fault() {
    let run = "chart --scene simple --work evaluations --until 0.1 --solvers r";
    fail_everywhere(&format!("{run} -o x.svg --data d.csv"), &["x.svg"], 12);
    fail_everywhere(&format!("{run} -o x.png --data d.json"), &["x.png"], 12);
    fail_everywhere("stability --scene simple --solvers r -o x.svg", &["x.svg"], 7);
    fail_everywhere("man --output .", &["a3.1", "a3-man.1"], 50);
}

/// A value of `A3_FAULT` that is no number has no effect.
#[test]
fn no_fault_is_asked_for_by_chance() {
    let folder = &Folder::new();
    let words = "simulate --scene simple --until 1 -o -";
    let output = command(folder, words).env("A3_FAULT", "1").output().unwrap();
    assert!(complaint(&output, 1).contains("standard output"));
    let output = command(folder, words).env("A3_FAULT", "").output().unwrap();
    assert!(output.status.success());
}
