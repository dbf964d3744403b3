//! Files that are never overwritten: inputs of the command, another of its outputs, a protected
//! file, and the runs of another chart.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;

use crate::common::{Folder, a3, command, complaint, succeed, text};

/// A sheet of two triangles, and a scene that hangs it up.
fn write_scene(folder: &Path, scene: &str, mesh: &str) {
    let triangles = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n";
    fs::write(folder.join(mesh), triangles).unwrap();
    let text = format!(
        "[[mesh]]\nfile = '{mesh}'\ndensity = 0.3\nstiffness = [40, 10]\npin = [{{ at = ['top'] }}]\n"
    );
    fs::write(folder.join(scene), text).unwrap();
}

/// All files of a folder, with their contents.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        (name, fs::read(entry.path()).unwrap_or_default())
    });
    let mut all: Vec<_> = entries.collect();
    all.sort();
    all
}

#[test]
fn no_output_overwrites_an_input_or_another_output() {
    let folder = &Folder::new();
    let path = |name: &str| folder.join(name);
    write_scene(folder, "sheet.toml", "sheet.obj");
    write_scene(folder, "frames.toml", "frame-0003.obj");
    let list = r#"{"mass": [1], "positions": [[0, 0, 0]]}"#;
    fs::write(path("list.json"), list).unwrap();
    fs::hard_link(path("sheet.obj"), path("hard.obj")).unwrap();
    symlink("sheet.obj", path("soft.obj")).unwrap();
    symlink("new.json", path("link.json")).unwrap();
    fs::write(path("notes.csv"), "buy milk\n").unwrap();
    fs::write(path("notes.json"), "[]").unwrap();
    let before = contents(folder);
    let sheet = |output: &str| format!("simulate --scene sheet.toml --output {output}");
    let (reads, two, no_chart) =
        ("reads this file", "two outputs", "does not hold the data of a chart");
    for (words, says) in [
        (sheet("./sheet.obj"), reads),
        (sheet("hard.obj"), reads),
        (sheet("soft.obj"), reads),
        ("simulate --scene frames.toml -o frame-####.obj".into(), reads),
        ("simulate --scene list.json -o list.json".into(), reads),
        (sheet("a.json --summary a.json"), two),
        (sheet("link.json --summary new.json"), two),
        ("chart --data notes.csv".into(), no_chart),
        ("chart --data notes.json".into(), no_chart),
    ] {
        let words = words.replace("simulate", "simulate --until 0.2");
        let line = complaint(&a3(folder, &words), 2);
        assert!(line.contains(says), "{words:?}: {line}");
        assert!(contents(folder) == before, "{words:?}");
    }
    // One frame that is the mesh by a link is found before it is written.
    fs::remove_file(path("frame-0003.obj")).unwrap();
    symlink("sheet.obj", path("frame-0003.obj")).unwrap();
    let line = complaint(&a3(folder, sheet("frame-####.obj --until 0.2")), 2);
    assert!(line.contains("frame-0003.obj") && line.contains(reads), "{line}");
    assert_eq!(fs::read(path("sheet.obj")).unwrap(), fs::read(path("hard.obj")).unwrap());
    // A path that only looks similar is written.
    for output in ["sheet.json", "sheet.glb", "other-####.obj"] {
        succeed(folder, sheet(output) + " --until 0");
    }
}

#[test]
fn a_protected_file_stays_and_a_link_is_followed() {
    let folder = &Folder::new();
    let path = |name: &str| folder.join(name);
    let run = |output| {
        let words = format!("simulate --scene simple --until 1 -o {output}");
        a3(folder, words)
    };
    fs::write(path("old.json"), "old").unwrap();
    fs::set_permissions(path("old.json"), fs::Permissions::from_mode(0o444)).unwrap();
    let line = complaint(&run("old.json"), 1);
    assert!(line.contains("old.json: ") && line.contains("protected"), "{line}");
    assert_eq!(fs::read(path("old.json")).unwrap(), b"old");
    symlink("below/new.json", path("link.json")).unwrap();
    let line = complaint(&run("link.json"), 1);
    assert!(line.contains("link.json: there is no folder below"), "{line}");
    fs::create_dir(path("below")).unwrap();
    assert!(run("link.json").status.success());
    assert!(fs::symlink_metadata(path("link.json")).unwrap().is_symlink());
    assert!(path("below/new.json").exists());
    symlink("loop.json", path("loop.json")).unwrap();
    assert!(complaint(&run("loop.json"), 1).contains("loop.json: "));
}

#[test]
fn a_scene_reads_nothing_outside_its_folder() {
    let folder = &Folder::new();
    let scenes = folder.join("scenes");
    fs::create_dir(&scenes).unwrap();
    write_scene(&scenes, "sheet.toml", "sheet.obj");
    let words = "simulate --scene scenes/sheet.toml --until 0 -o -";
    succeed(folder, words);
    fs::rename(scenes.join("sheet.obj"), folder.join("secret.obj")).unwrap();
    symlink("../secret.obj", scenes.join("sheet.obj")).unwrap();
    let line = complaint(&a3(folder, words), 2);
    assert!(line.contains("`sheet.obj` leads out of the scene's folder"), "{line}");
    fs::remove_file(scenes.join("sheet.obj")).unwrap();
    fs::rename(folder.join("secret.obj"), scenes.join("mesh.obj")).unwrap();
    symlink("mesh.obj", scenes.join("sheet.obj")).unwrap();
    succeed(folder, words);
}

/// After two charts at the same time, the file has the runs of both.
#[test]
fn two_charts_keep_the_runs_of_both() {
    let folder = &Folder::new();
    let words = |more: &str| {
        format!("chart --scene chain --work evaluations --until 1 --data d.csv --solvers {more}")
    };
    let both = ["r,v,t --output 1.svg", "e,m,s --output 2.svg"];
    for child in both.map(|more| command(folder, words(more)).spawn()) {
        let output = child.unwrap().wait_with_output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let data = folder.read("d.csv");
    for solver in ["rk4", "verlet", "trapezoid", "euler", "midpoint", "symplectic"] {
        assert!(data.contains(&format!(",{solver},")), "{solver}");
    }
    // Nothing is measured again.
    succeed(folder, words("r,v,t,e,m,s --output 3.svg"));
    assert_eq!(folder.read("d.csv"), data);
}

/// At a limit for the size of files, every format says which file and why.
#[test]
fn a_limit_is_named_by_every_format() {
    let folder = &Folder::new();
    let program = env!("CARGO_BIN_EXE_a3");
    for words in [
        "simulate v 0.01 --until 1 --fps 60 --output x.json",
        "simulate v 0.01 --until 1 --output x.csv",
        "simulate v 0.01 --until 1 --output x.obj",
        "simulate v 0.01 --until 1 --output x.glb",
        "render v 0.01 --until 1 --output x.png",
        "render v 0.01 --until 1 --output x.gif",
        "render v 0.01 --until 1 --output x.mp4",
    ] {
        if words.ends_with("mp4") && crate::common::is_missing("ffmpeg") {
            continue;
        }
        // The limit is in blocks of 512 or of 1024 bytes.
        let script = format!("ulimit -f 8; exec '{program}' {words}");
        let output = std::process::Command::new("sh")
            .args(["-c", &script])
            .current_dir(folder)
            .env("XDG_RUNTIME_DIR", &**folder)
            .output()
            .unwrap();
        if crate::common::gpu_is_missing(&output) {
            continue;
        }
        let line = complaint(&output, 1);
        // The point cache has a mesh beside it, of the same name.
        assert!(line.starts_with("error: x."), "{line}");
        assert!(line.contains("File too large"), "{line}");
        assert_eq!(folder.count(), 0, "{words}");
    }
}
