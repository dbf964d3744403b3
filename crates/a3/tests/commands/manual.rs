//! The manual and the completion scripts, read by man and by shells.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::common::{a3, asked, complaint, is_missing, text};

const COMMANDS: [&str; 14] = [
    "simulate",
    "render",
    "chart",
    "stability",
    "choose",
    "simplify",
    "judge",
    "sweep",
    "compare",
    "scenes",
    "solvers",
    "lessons",
    "completions",
    "man",
];

fn said(folder: &Path, words: &[&str]) -> String {
    let output = a3(folder, words);
    assert!(output.status.success() && output.stderr.is_empty());
    text(&output.stdout).to_owned()
}

#[test]
fn every_shell_completes_every_command() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = said(folder.path(), &["completions", shell]);
        for command in COMMANDS {
            assert!(script.contains(command), "{shell}: {command}");
        }
        assert!(script.contains("transparent"), "{shell}");
        // The generator gives the other shells no values.
        if ["bash", "zsh", "fish"].contains(&shell) {
            for offered in ["ball-on-cloth", "implicit-midpoint"] {
                assert!(script.contains(offered), "{shell}: {offered}");
            }
        }
    }
    let line = complaint(&a3(folder.path(), &["completions", "tcsh"]), 2);
    assert!(line.contains("bash") && line.contains("zsh"), "{line}");
}

#[test]
fn bash_takes_its_script() {
    if is_missing("bash") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("a3.bash"),
        said(folder.path(), &["completions", "bash"]),
    )
    .unwrap();
    asked(folder.path(), "bash", &["-n", "a3.bash"]);
    let complete = |typed: &str, last: usize| {
        let words = format!(
            "source ./a3.bash; COMP_WORDS=({typed}); COMP_CWORD={last}; _a3 a3 \"${{COMP_WORDS[{last}]}}\" \"${{COMP_WORDS[{last}-1]}}\"; \
             echo \"${{COMPREPLY[@]}}\""
        );
        asked(folder.path(), "bash", &["-c", &words])
    };
    assert_eq!(complete("a3 simu", 1).trim(), "simulate");
    assert_eq!(complete("a3 render --tr", 2).trim(), "--transparent");
    assert_eq!(complete("a3 --scene mi", 2).trim(), "mit mit-sphere");
    assert_eq!(complete("a3 chart --scene dom", 3).trim(), "dominoes");
    // Where nothing is offered, bash completes files.
    assert_eq!(complete("a3 --scene own", 2).trim(), "");
    assert!(said(folder.path(), &["completions", "bash"]).contains("-o bashdefault -o default a3"));
    assert_eq!(complete("a3 trap", 1).trim(), "trapezoid");
    assert_eq!(complete("a3 simulate symp", 2).trim(), "symplectic");
    assert_eq!(complete("a3 chart --solvers eu", 3).trim(), "euler");
    assert_eq!(complete("a3 --pa", 1).trim(), "--paused");
    // A hidden option of the window, for tests.
    assert_eq!(complete("a3 --sta", 1).trim(), "");
    assert_eq!(complete("a3 sweep --sta", 2).trim(), "--status");
}

#[test]
fn the_manual_has_every_command_and_is_set_without_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let manual = said(folder.path(), &["man"]);
    assert_eq!(manual.matches(".TH ").count(), 1);
    for command in COMMANDS {
        assert!(
            manual.contains(&format!("\n.SH \"a3 {command}\"\n")),
            "{command}"
        );
    }
    if is_missing("groff") {
        return;
    }
    fs::write(folder.path().join("a3.1"), manual).unwrap();
    let output = Command::new("groff")
        .args(["-man", "-Tascii", "-P-cbou", "-ww", "a3.1"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(output.status.success());
    assert_eq!(text(&output.stderr), "");
    let page = text(&output.stdout);
    for part in [
        "NAME",
        "FILE-####.obj",
        "--transparent",
        "FILE.mp4",
        "--budget",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn a_page_for_each_command() {
    let folder = tempfile::tempdir().unwrap();
    said(folder.path(), &["man", "--output", "."]);
    let page = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(page("a3.1").starts_with(".ie"));
    for command in COMMANDS {
        assert!(
            page(&format!("a3-{command}.1")).contains(&format!("a3 {command}").replace('-', "\\-"))
        );
    }
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        1 + COMMANDS.len()
    );
    let output = a3(folder.path(), &["man", "--output", "nowhere"]);
    assert!(complaint(&output, 1).contains("there is no folder nowhere"));
}
