//! The manual and the completion scripts, read by man and by shells.

use std::process::Command;

use crate::common::{Folder, a3, asked, complaint, is_missing, said, text};

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

#[test]
fn every_shell_completes_every_command() {
    let folder = &Folder::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = said(folder, format!("completions {shell}"));
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
    let line = complaint(&a3(folder, "completions tcsh"), 2);
    assert!(line.contains("bash") && line.contains("zsh"), "{line}");
}

#[test]
fn bash_takes_its_script() {
    if is_missing("bash") {
        return;
    }
    let folder = &Folder::new();
    folder.write("a3.bash", said(folder, "completions bash"));
    asked(folder, "bash", "-n a3.bash");
    let complete = |typed: &str, last: usize| {
        let words = format!(
            "source ./a3.bash; COMP_WORDS=({typed}); COMP_CWORD={last}; _a3 a3 \"${{COMP_WORDS[{last}]}}\" \"${{COMP_WORDS[{last}-1]}}\"; \
             echo \"${{COMPREPLY[@]}}\""
        );
        asked(folder, "bash", ["-c", &words])
    };
    assert_eq!(complete("a3 simu", 1).trim(), "simulate");
    assert_eq!(complete("a3 render --tr", 2).trim(), "--transparent");
    assert_eq!(complete("a3 --scene mi", 2).trim(), "mit mit-sphere");
    assert_eq!(complete("a3 chart --scene dom", 3).trim(), "dominoes");
    // Where nothing is offered, bash completes files.
    assert_eq!(complete("a3 --scene own", 2).trim(), "");
    assert!(said(folder, "completions bash").contains("-o bashdefault -o default a3"));
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
    let folder = &Folder::new();
    let manual = said(folder, "man");
    assert_eq!(manual.matches(".TH ").count(), 1);
    for command in COMMANDS {
        assert!(manual.contains(&format!("\n.SH \"a3 {command}\"\n")), "{command}");
    }
    if is_missing("groff") {
        return;
    }
    folder.write("a3.1", manual);
    let output = Command::new("groff")
        .args(["-man", "-Tascii", "-P-cbou", "-ww", "a3.1"])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success());
    assert_eq!(text(&output.stderr), "");
    let page = text(&output.stdout);
    for part in ["NAME", "FILE-####.obj", "--transparent", "FILE.mp4", "--budget"] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn a_page_for_each_command() {
    let folder = &Folder::new();
    said(folder, "man --output .");
    let page = |name: &str| folder.read(name);
    assert!(page("a3.1").starts_with(".ie"));
    for command in COMMANDS {
        assert!(
            page(&format!("a3-{command}.1")).contains(&format!("a3 {command}").replace('-', "\\-"))
        );
    }
    assert_eq!(folder.count(), 1 + COMMANDS.len());
    let output = a3(folder, "man --output nowhere");
    assert!(complaint(&output, 1).contains("there is no folder nowhere"));
}
