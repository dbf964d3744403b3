//! Help, lists, and standard output that is closed or full.

use std::fs;
use std::process::Stdio;

use crate::common::{Folder, a3, command, text};

#[test]
fn help_and_version() {
    let folder = &Folder::new();
    for words in ["--help", "-h", "simulate --help", "--version"] {
        let output = a3(folder, words);
        assert!(output.status.success() && output.stderr.is_empty());
        assert!(!output.stdout.is_empty());
    }
    let help = a3(folder, "--help");
    for word in [
        "simulate",
        "render",
        "compare",
        "scenes",
        "solvers",
        "--scene",
        "--grid",
        "--springs-of",
        "--colour",
        "--arrows",
        "a3 t 0.01",
    ] {
        assert!(text(&help.stdout).contains(word), "{word}");
    }
    assert!(!text(&help.stdout).contains("--status"));
}

#[test]
fn lists() {
    let folder = &Folder::new();
    let scenes = a3(folder, "scenes");
    let row = |name: &str| {
        let stdout = text(&scenes.stdout).to_owned();
        let row = stdout
            .lines()
            .find(|line| line.split_whitespace().next() == Some(name))
            .map(str::to_owned);
        row.unwrap_or_else(|| panic!("no {name} in\n{stdout}"))
    };
    for number in ["15x15", "225", "1202", "1350", "gravity", "drag", "sphere", "floor"] {
        assert!(row("mit-sphere").contains(number), "{number}");
    }
    assert!(row("simple").contains(" 3 "));
    let solvers = a3(folder, "solvers");
    for solver in a3_core::integrators::METHODS {
        let start = format!("{}  {} ", solver.letter.unwrap(), solver.name);
        assert!(text(&solvers.stdout).lines().any(|line| line.starts_with(&start)), "{start}");
    }
}

#[test]
fn a_closed_or_full_output_is_no_panic() {
    let folder = &Folder::new();
    for words in ["scenes", "t 0.01 --scene pendulum", "solvers", "--help", "chart --help"] {
        let mut child =
            command(folder, words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success() && !text(&output.stderr).contains("panicked"), "{words:?}");
        #[cfg(target_os = "linux")]
        {
            let full = fs::File::options().write(true).open("/dev/full").unwrap();
            let output =
                command(folder, words).stdout(full).stderr(Stdio::piped()).spawn().unwrap();
            let output = output.wait_with_output().unwrap();
            assert_eq!(output.status.code(), Some(1), "{words:?}");
            assert!(text(&output.stderr).contains("standard output"));
        }
    }
}
