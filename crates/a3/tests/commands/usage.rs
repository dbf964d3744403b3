//! Arguments that are refused in one line, which says what would be right.

use std::time::{Duration, Instant};

use crate::common::Folder;
use crate::refused;

#[test]
fn limits_of_adaptive_steps_are_for_adaptive_solvers() {
    let folder = &Folder::new();
    for (words, says) in [
        ("simulate t 0.01 --until 1 --output x.json --absolute 1e-6", "leave out --absolute"),
        ("simulate t 0.01 --until 1 --output x.json --max-step 0.1", "leave out --max-step"),
        ("x 1e-6 --absolute 0", "such as 1e-6"),
        ("x 1e-6 --max-step -1", "such as 0.01"),
    ] {
        let line = refused(folder, words, 2);
        assert!(line.contains(says), "{words:?}: {line}");
    }
}

#[test]
fn wrong_usage_is_one_line_that_says_what_is_right() {
    let folder = &Folder::new();
    for (words, says) in [
        ("q", "`a3 solvers` the solvers"),
        ("0.01", "as in `r 0.01`"),
        ("t -0.01", "such as 0.01"),
        ("t -1e-3", "such as 0.01"),
        ("t -inf", "such as 0.01"),
        ("simulat", "simulate"),
        ("t 0.01 --scene simple --wind", "leave out --wind"),
        ("--scene simple --self-collision", "leave out"),
        ("t 0.01 --scene simple --springs-of 0", "no springs"),
        ("t 0", "such as 0.01"),
        ("t -0", "such as 0.01"),
        ("t nan", "such as 0.01"),
        ("t inf", "such as 0.01"),
        ("t 1e9", "such as 0.01"),
        ("t 1e-300", "such as 0.01"),
        ("t fast", "such as 0.01"),
        ("t 0.01 0.02", "`0.02` is one word too many"),
        ("t 0.01 --scene rug", "mit-sphere"),
        ("t 0.01 --grid 1x5", "at least 2x2"),
        ("t 0.01 --grid 5", "such as 20x30"),
        ("t 0.01 --grid -3x5", "20x30"),
        ("t 0.01 --grid 4294967295x4294967295", "at most 4194304"),
        ("t 0.01 --grid 99999999999999999999x2", "20x30"),
        ("t 0.01 --grid 5x5 --scene chain", "has no grid"),
        ("t 0.01 --springs-of 400", "0 to 399"),
        ("t 0.01 --springs-of -1", "whole number"),
        ("v 0.01 --scene simple", "first order"),
        ("t 0.01 --wire", "--wireframe"),
        ("simulate t 0.01 --output x.json", "--until"),
        ("simulate t 0.01 --until 1", "--output"),
        ("simulate t 0.01 --until -1 --output x.json", "such as 10"),
        ("simulate t 0.01 --until inf --output x.json", "such as 10"),
        ("simulate t 0.01 --until 1 --output x.txt", ".json"),
        ("simulate t 0.01 --until 1 --output x.json --grid 3x0", "at least 2x2"),
        ("render t 0.01 --until 1 --output x.jpg", ".png"),
        ("render t 0.01 --until 1 --output x.png --size 0x5", "1280x720"),
        ("render t 0.01 --until 1 --output x.png --springs-of 999", "0 to 399"),
    ] {
        let line = refused(folder, words, 2);
        println!("a3 {words}\n{line}");
        assert!(line.contains(says), "{words:?}: {line}");
    }
}

#[test]
fn what_a_scene_cannot_show_is_refused() {
    let folder = &Folder::new();
    for (words, says) in [
        ("t 0.01 --scene simple --colour strain", "has no strain to show: leave out --colour"),
        ("compare e t --scene simple --arrows force", "has no force to show: leave out --arrows"),
        (
            "t 0.01 --scene mit --colour contact",
            "nothing can touch in the scene mit: leave out --colour",
        ),
        ("t 0.01 --colour error", "a3 compare runs: leave out --colour"),
        ("t 0.01 --scene cantilever --springs", "has no springs to show: leave out --springs"),
        ("t 0.01 --colour heat", "speed, strain, force"),
    ] {
        let line = refused(folder, words, 2);
        assert!(line.contains(says), "{words:?}: {line}");
    }
}

#[test]
fn wrong_comparisons_too() {
    let folder = &Folder::new();
    for (words, says) in [
        ("compare", "2 to 4"),
        ("compare e:0.05", "a3 compare e:0.05 r:0.05"),
        ("compare e t r s v", "not 5"),
        ("compare e:0.05 q:0.05", "`a3 solvers`"),
        ("compare e:0.05 r:", "such as 0.01"),
        ("compare e:0.05 r:-1", "such as 0.01"),
        ("compare e r:0.01:0.02", "such as 0.01"),
        ("compare e v --scene simple", "first order"),
        ("compare e r --springs-of 3", "--springs-of"),
        ("compare e r --until 1", "--output"),
        ("compare e r --output x.png", "--until"),
        ("compare e r --size 80x60", "--output"),
        ("compare e r --until 1 --output x.jpg", ".png"),
        ("compare e r --paused --until 1 --output x.png", "--paused"),
    ] {
        let line = refused(folder, words, 2);
        assert!(line.contains(says), "{words:?}: {line}");
    }
}

#[test]
fn huge_grids_are_refused_before_memory_is_taken() {
    let folder = &Folder::new();
    let begun = Instant::now();
    refused(folder, "t 0.01 --grid 2000000x2000000", 2);
    // A program that tried to allocate it would take much longer.
    assert!(begun.elapsed() < Duration::from_secs(5));
}
