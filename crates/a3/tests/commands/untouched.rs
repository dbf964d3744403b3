//! Files that are not the program's own are left alone, and files that it cannot read are refused
//! by name.

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::process::Stdio;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::common::{Folder, a3, command, complaint, succeed, text};

const CHAIN: &str =
    "[[chain]]\nparticles = 2\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nmass = 1\nstiffness = 5\n";

/// A link in the place of a run's file is not followed.
#[test]
fn runs_of_a_sweep_replace_no_end_of_a_link() {
    let folder = &Folder::new();
    let sweep = "scene = \"chain\"\nsolver = \"rk4\"\nstep = [0.01]\nuntil = 0.1\n";
    folder.write("s.toml", sweep);
    folder.write("letter.txt", "dear reader");
    let plan = a3(folder, "sweep s.toml --plan");
    let id = text(&plan.stdout).split('\t').next().unwrap();
    fs::create_dir(folder.join("a3-sweep-s")).unwrap();
    for target in ["../letter.txt", "../gone.txt"] {
        let link = folder.join(format!("a3-sweep-s/{id}.csv"));
        symlink(target, &link).unwrap();
        let said = complaint(&a3(folder, "sweep s.toml"), 1);
        assert!(said.contains("it is no ordinary file: take it away"), "{said}");
        let letter = folder.read("letter.txt");
        assert!(letter == "dear reader" && !folder.join("gone.txt").exists());
        fs::remove_file(link).unwrap();
    }
}

/// A plan shows names with escapes, and has one line for each run.
#[test]
fn names_in_a_plan_move_no_cursor() {
    let folder = &Folder::new();
    folder.write("c.toml", format!("name = \"a\\u001b[31m\\nb\\tc\"\n{CHAIN}"));
    let sweep = "scene = \"c.toml\"\nsolver = \"rk4\"\nstep = [0.01, 0.02]\nuntil = 0.1\n";
    folder.write("s.toml", sweep);
    let plan = a3(folder, "sweep s.toml --plan");
    let plan = text(&plan.stdout);
    assert_eq!(plan.lines().count(), 2, "{plan}");
    assert!(!plan.contains('\u{1b}'), "{plan}");
}

/// A file of points of a mesh, too, is refused outside the folder of the scene.
#[test]
fn points_outside_the_folder_are_not_read() {
    let (folder, outside) = (&Folder::new(), &Folder::new());
    let node = "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
    outside.write("secret.node", node);
    folder.write("t.ele", "1 4 0\n1 1 2 3 4\n");
    symlink(outside.join("secret.node"), folder.join("t.node")).unwrap();
    let words = "simulate --scene t.ele --until 0.1 --output -";
    let said = complaint(&a3(folder, words), 2);
    assert!(said.contains("`t.node` leads out of the scene's folder by a link"), "{said}");
    fs::remove_file(folder.join("t.node")).unwrap();
    folder.write("t.node", node);
    succeed(folder, words);
}

/// A chart whose data another process has locked says that it waits, and fails in the end.
#[test]
fn locked_data_is_waited_for_a_while() {
    let folder = &Folder::new();
    folder.write("c.toml", CHAIN.replace("mass", "velocity = [0, 1, 0]\nmass"));
    let words = "chart --scene c.toml --solvers r --until 0.2 --work evaluations --data c.csv --output c.svg";
    let lock = File::open(folder).unwrap();
    lock.lock().unwrap();
    let begun = Instant::now();
    let output = a3(folder, words);
    assert!(begun.elapsed() > Duration::from_secs(9));
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("c.csv: waits for another process that has locked its folder\n"),
        "{said}"
    );
    assert!(
        said.contains("error: c.csv: another process has locked its folder for 10 s"),
        "{said}"
    );
    lock.unlock().unwrap();
    succeed(folder, words);
}

/// A wrong ending is reported before a scene is built, which may take long or fail.
#[test]
fn endings_are_looked_at_first() {
    let folder = &Folder::new();
    folder.write("m.toml", "[[obstacle]]\nfile = \"gone.obj\"\n");
    for (what, output) in [("render", "o.JSON"), ("simulate", "o.png")] {
        let words = format!("{what} --scene m.toml --until 1 --output {output}");
        let said = complaint(&a3(folder, words), 2);
        assert!(said.contains("the name of the file must end in"), "{said}");
    }
}

/// Endings that are not read, names that are not UTF-8, and texts that are.
#[test]
fn files_that_are_not_read_are_named() {
    let folder = &Folder::new();
    let simulate = |scene: &str| {
        let words = format!("simulate --scene {scene} --until 0.1 --output -");
        a3(folder, words)
    };
    let refused = |scene: &str| complaint(&simulate(scene), 2);
    for name in ["a.dae", "b.FBX", "c.usda"] {
        folder.write(name, "x");
        let ending = name[2..].to_lowercase();
        let expected = format!(
            "{name}: .{ending} files are not read: a3 reads meshes from files that end in .obj"
        );
        assert!(refused(name).contains(&expected), "{}", refused(name));
        assert!(refused(name).contains("scenes are in files that end in .toml or .json"));
        folder.write("m.toml", format!("[[obstacle]]\nfile = \"{name}\"\n{CHAIN}"));
        assert!(refused("m.toml").contains(&expected), "{}", refused("m.toml"));
    }
    folder.write("wide.toml", CHAIN.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<_>>());
    assert!(refused("wide.toml").contains("wide.toml: it is UTF-16 text: save it as UTF-8"));
    let name = std::ffi::OsStr::from_bytes(b"caf\xe9.toml");
    folder.write(name, CHAIN);
    let output =
        command(folder, "simulate --until 0.1 --output - --scene").arg(name).output().unwrap();
    let said = complaint(&output, 2);
    assert_eq!(said, "error: `caf\u{fffd}.toml` is not UTF-8: give the file a name in UTF-8");
    for written in
        [format!("\u{feff}{CHAIN}"), CHAIN.replace('\n', "\r\n"), CHAIN.replace('\n', "\r")]
    {
        folder.write("c.toml", written);
        assert!(simulate("c.toml").status.success());
    }
}

/// Scenes are read from standard input, as TOML or as JSON.
#[test]
fn scenes_come_by_standard_input() {
    let folder = &Folder::new();
    let piped = |scene: &str, words: &str| {
        let mut child = command(folder, words).stdin(Stdio::piped()).spawn().unwrap();
        // A program that refuses its command line reads nothing.
        let _ = child.stdin.take().unwrap().write_all(scene.as_bytes());
        child.wait_with_output().unwrap()
    };
    let words = "simulate r 0.01 --scene - --until 0.1 --output -";
    let list = "{\"mass\": [1], \"pinned\": [], \"positions\": [[0, 0, 0]], \"velocities\": [[1, 0, 0]], \"springs\": []}";
    for scene in [CHAIN, list] {
        let output = piped(scene, words);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let state: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!((&state["scene"], &state["time"]), (&"input".into(), &0.1.into()));
    }
    let said = complaint(&piped("[[chian]]\n", words), 2);
    assert!(said.starts_with("error: standard input:1: chian: there is no key"), "{said}");
    let said = complaint(&piped(CHAIN, "--scene - --watch"), 2);
    assert!(said.contains("--watch needs a scene file"), "{said}");
}
