//! The archive to hand in: made, unpacked, and used as its recipient would.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{Folder, asked, complaint, is_missing, text};

/// Copies the sources and commits them to a repository of their own.
fn repository(folder: &Path) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for entry in fs::read_dir(&root).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name != "target" && name != ".git" {
            let from = root.join(&name).display().to_string();
            asked(folder, "cp", ["-R", &from, "."]);
        }
    }
    asked(folder, "git", ["init", "-q"]);
    asked(folder, "git", ["add", "-A"]);
    let who = ["-c", "user.name=a", "-c", "user.email=a@b"];
    let commit = ["-c", "commit.gpgsign=false", "commit", "-q", "-m", "All"];
    asked(folder, "git", [&who[..], &commit].concat());
}

fn hand_in(from: &Path, script: &Path, program: &Path, words: &[&str]) -> Output {
    Command::new(script).args(words).current_dir(from).env("A3_BINARY", program).output().unwrap()
}

#[test]
fn the_archive_has_the_sources_the_program_and_the_readme() {
    if ["git", "tar", "strip"].into_iter().any(is_missing) {
        return;
    }
    let (folder, other) = (&Folder::new(), &Folder::new());
    repository(folder);
    let script = folder.join("hand-in");
    // Debug information would take long to pack.
    let programs = &Folder::new();
    let program = programs.join("a3");
    asked(programs, "strip", ["-o", "a3", env!("CARGO_BIN_EXE_a3")]);

    // From another folder, into that one.
    let output = hand_in(other, &script, &program, &["mine.tar.gz"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("mine.tar.gz"));
    assert_eq!(other.count(), 1);
    asked(other, "tar", "-xzf mine.tar.gz");
    let unpacked = other.join("a3");
    let readme = fs::read_to_string(unpacked.join("README.txt")).unwrap();
    let parts = ["README.md", "docs/assignment.md"];
    let parts = parts.map(|part| fs::read_to_string(folder.join(part)).unwrap());
    assert_eq!(readme, parts.concat());
    for question in [
        "## How to build and run it",
        "## Who collaborated",
        "## References",
        "## Known problems, their causes and fixes",
        "## Extra credit and how to use it",
        "## Comments",
    ] {
        assert!(readme.contains(question), "{question}");
    }
    // The archive has every file of the commit, unchanged.
    let sources = asked(folder, "git", "ls-files");
    assert!(sources.lines().count() > 100 && sources.contains("crates/core/src/lib.rs"));
    for source in sources.lines() {
        let [here, there] = [folder.bytes(source), fs::read(unpacked.join(source)).unwrap()];
        assert!(here == there, "{source}");
    }
    let state = asked(&unpacked, "./a3", "simulate t 0.01 --until 0.1 --output -");
    let state: serde_json::Value = serde_json::from_str(&state).unwrap();
    assert_eq!(state["steps"], 10);

    // Uncommitted changes are refused, because the archive would lack them.
    folder.write("crates/core/src/new.rs", "");
    let line = complaint(&hand_in(folder, &script, &program, &[]), 1);
    assert!(line.starts_with("error: ") && line.contains("crates/core/src/new.rs"), "{line}");
    assert!(!folder.join("a3-handin.tar.gz").exists());
    for words in [&["a.tar.gz", "b.tar.gz"][..], &["--help"], &["nowhere/a.tar.gz"]] {
        let line = complaint(&hand_in(folder, &script, &program, words), 1);
        assert!(line.starts_with("error: "), "{line}");
    }
}
