//! The lessons are true: their commands run, make the files that are named, and print the output
//! that is shown.

use std::fs;
use std::path::Path;

use super::common::{Folder, a3, gpu_is_missing, text};
use super::refused;

const LESSONS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/lessons");
const COUNT: usize = 8;

/// Returns the code blocks of a page: their languages and their texts.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let parts = page.split("```").skip(1).step_by(2);
    parts.filter_map(|block| block.split_once('\n')).collect()
}

/// Follows a lesson in a folder of its own.
fn follow(name: &str, page: &str) {
    let folder = &Folder::new();
    let (mut said, mut made) = (String::new(), vec![]);
    for (language, block) in blocks(page) {
        match language {
            // A scene, whose first line begins with the name under which it is saved.
            "toml" => {
                let file = block.strip_prefix("# ").unwrap().split_once(':').unwrap().0;
                folder.write(file, block);
            }
            "sh" => {
                for line in block.lines() {
                    let (line, code) = line.split_once('#').unwrap_or((line, "exit code 0"));
                    let code = code.trim().strip_prefix("exit code ").unwrap();
                    let mut words = line.split_whitespace();
                    assert_eq!(words.next(), Some("a3"), "{name}: {line}");
                    let words: Vec<_> = words.collect();
                    let output = a3(folder, &words);
                    let stderr = text(&output.stderr);
                    if gpu_is_missing(&output) {
                        return;
                    }
                    assert_eq!(output.status.code(), code.parse().ok(), "{name}: {line}: {stderr}");
                    said += text(&output.stdout);
                    said += stderr;
                    let makes = |word: &&&str| !["--output", "--chart"].contains(*word);
                    let file = words.iter().skip_while(makes).nth(1);
                    if let Some(file) = file.filter(|file| **file != "-" && code == "0") {
                        assert!(folder.join(file).is_file(), "{name}: {line}");
                        made.push(*file);
                    }
                }
            }
            "text" => {
                for line in block.lines() {
                    assert!(said.contains(line), "{name}: not said:\n{line}\nbut\n{said}");
                }
            }
            _ => panic!("{name}: a block of {language}"),
        }
    }
    // Each picture is made by a command of its lesson.
    let pictures: Vec<_> = page.split("](pictures/").skip(1).collect();
    for picture in &pictures {
        let file = picture.split(')').next().unwrap();
        assert!(made.contains(&file), "{name}: no command makes {file}");
        assert!(Path::new(LESSONS).join("pictures").join(file).is_file());
    }
    assert!(page.contains("**Question.**") && page.contains("<summary>Answer</summary>"));
    assert!(!pictures.is_empty() && page.lines().count() <= 150, "{name}");
}

#[test]
fn the_lessons_are_true() {
    let index = fs::read_to_string(Path::new(LESSONS).join("README.md")).unwrap();
    let links = index.split("](").skip(1);
    let names: Vec<_> = links.map(|link| link.split(')').next().unwrap()).collect();
    assert_eq!(names.len(), COUNT);
    for name in names {
        follow(name, &fs::read_to_string(Path::new(LESSONS).join(name)).unwrap());
    }
}

#[test]
fn a_lesson_is_printed() {
    let folder = &Folder::new();
    for (words, beginning) in [
        ("lessons", "Lessons\n-------\n"),
        ("lessons 1", "1. Euler spirals\n-----"),
        ("lessons 8", "8. How fine a cloth?\n-----"),
    ] {
        let output = a3(folder, words);
        assert!(text(&output.stdout).starts_with(beginning), "{words:?}");
    }
    let said = |words: &str| text(&a3(folder, words).stdout).to_owned();
    let (asked, told) = (said("lessons 2"), said("lessons 2 --answers"));
    assert!(asked.contains("Answer: a3 lessons 2 --answers") && !asked.contains("Yes: 56 ms"));
    assert!(told.contains("Yes: 56 ms") && !told.contains("--answers"), "{told}");
    let line = refused(folder, "lessons 9", 2);
    assert!(line.contains("`9`: lessons are numbered 1 to 8"), "{line}");
}
