//! Sweeps: runs that are made in any order, by several processes, or again after kills, give the
//! same files.

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

use crate::common::{Folder, a3, command, complaint, said};

/// Three solvers, one of which blows up, with four settings each, on six chains.
const SWEEP: &str = "scene = \"chain\"
solver = [\"euler\", \"rk4\", \"dopri5\"]
step = { from = 0.3, to = 0.01, count = 4 }
tolerance = [1e-2, 1e-3, 1e-4, 1e-5]
until = 1
stiffness = [1, 100]
[keys]
chain.mass = [0.5, 1, 2]
";

/// Returns the table and the chart of a sweep that was made by one command.
fn whole() -> [Vec<u8>; 2] {
    let folder = &begun(SWEEP);
    let told = said(folder, "sweep s.toml");
    assert!(told.contains("72 runs, of which "), "{told}");
    collected(folder)
}

fn begun(sweep: &str) -> Folder {
    let folder = Folder::new();
    folder.write("s.toml", sweep);
    folder
}

fn collected(folder: &Path) -> [Vec<u8>; 2] {
    ["csv", "svg"].map(|end| fs::read(folder.join(format!("a3-sweep-s.{end}"))).unwrap())
}

/// Returns the files of the runs, with their bytes.
fn runs(folder: &Path) -> Vec<(std::path::PathBuf, Vec<u8>)> {
    let files = fs::read_dir(folder.join("a3-sweep-s")).unwrap();
    let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    let read = |path: std::path::PathBuf| (path.clone(), fs::read(path).unwrap());
    files.into_iter().map(read).collect()
}

#[test]
fn shares_in_any_order_are_one_run() {
    let whole = whole();
    let folder = &begun(SWEEP);
    for share in ["3/3", "1/3", "2/3"] {
        assert!(!folder.join("a3-sweep-s.csv").exists());
        said(folder, format!("sweep s.toml --only {share}"));
    }
    said(folder, "sweep s.toml --collect");
    assert!(collected(folder) == whole);
    // One run by its id, as on another machine.
    let plan = said(folder, "sweep s.toml --plan");
    assert_eq!(plan.lines().count(), 72);
    let id = plan.lines().nth(40).unwrap().split('\t').next().unwrap();
    let other = &begun(SWEEP);
    let told = said(other, format!("sweep s.toml --only {id}"));
    assert!(told.contains("72 runs, 1 done"), "{told}");
    let [(path, bytes)] = runs(other).try_into().unwrap();
    let there = folder.join("a3-sweep-s").join(path.file_name().unwrap());
    assert!(path.file_stem().unwrap() == id && fs::read(there).unwrap() == bytes);
    // The table has a line for each run, with its keys, and the time at which a run blew up.
    let mut table = csv::Reader::from_reader(&whole[0][..]);
    let head = table.headers().unwrap().clone();
    assert_eq!(head.iter().take(3).collect::<Vec<_>>(), ["id", "chain.mass", "stiffness"]);
    let column = |name: &str| head.iter().position(|h| h == name).unwrap();
    let (solver, lost) = (column("solver"), column("lost_at"));
    let lines: Vec<_> = table.records().map(Result::unwrap).collect();
    assert_eq!(lines.len(), 72);
    let blown: Vec<_> = lines.iter().filter(|line| !line[lost].is_empty()).collect();
    let is_fixed = |line: &&&csv::StringRecord| &line[solver] != "dopri5";
    assert!(!blown.is_empty() && blown.iter().all(|line| is_fixed(&line)));
    let svg = String::from_utf8_lossy(&whole[1]).into_owned();
    assert!(svg.contains("chain.mass = 0.5, stiffness = 100"));
}

#[test]
fn kills_at_random_moments_lose_nothing() {
    let whole = whole();
    let folder = &begun(SWEEP);
    let mut moment: u64 = 1;
    for _ in 0..20 {
        moment = moment.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let mut child = command(folder, "sweep s.toml").spawn().unwrap();
        sleep(Duration::from_millis(moment >> 58));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    said(folder, "sweep s.toml");
    assert!(collected(folder) == whole);
    assert_eq!(runs(folder).len(), 72);
}

#[test]
fn two_processes_work_in_one_folder() {
    let whole = whole();
    let folder = &begun(SWEEP);
    let children = [(); 2].map(|()| command(folder, "sweep s.toml").spawn().unwrap());
    for mut child in children {
        assert!(child.wait().unwrap().success());
    }
    assert!(collected(folder) == whole);
    assert_eq!(runs(folder).len(), 72);
}

#[test]
fn a_damaged_run_is_done_again() {
    let folder = &begun(&SWEEP.replace("[0.5, 1, 2]", "1"));
    said(folder, "sweep s.toml");
    let all = runs(folder);
    let whole = collected(folder);
    let (path, bytes) = &all[5];
    let mut changed = bytes.clone();
    let at = bytes.len() - 40;
    changed[at] ^= 1;
    for wrong in [&changed[..], &bytes[..at], b""] {
        fs::write(path, wrong).unwrap();
        let output = a3(folder, "sweep s.toml --status");
        let line = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(line.contains("it is damaged") && line.lines().count() == 1, "{line}");
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(told.contains("24 runs, 23 done") && told.contains("1 missing"), "{told}");
        let line = a3(folder, "sweep s.toml --collect");
        assert_eq!(line.status.code(), Some(1));
        assert!(a3(folder, "sweep s.toml").status.success());
        assert!(runs(folder) == all && collected(folder) == whole);
    }
}

#[test]
fn runs_of_other_versions_and_sweeps_are_left_alone() {
    let folder = &begun(&SWEEP.replace("[0.5, 1, 2]", "1"));
    said(folder, "sweep s.toml");
    let all = runs(folder);
    // An older version wrote this one.
    let text = String::from_utf8(all[0].1.clone()).unwrap();
    let version = env!("CARGO_PKG_VERSION");
    let (before, _) = text.trim_end().rsplit_once(',').unwrap();
    let before = format!("{},", before.replacen(&format!("\n{version}"), "\n0.0.9", 1));
    let old = format!("{before}{:08x}\n", crc32fast::hash(before.as_bytes()));
    let there = folder.join("a3-sweep-s/0123456789abcdef.csv");
    fs::write(&there, &old).unwrap();
    for words in ["sweep s.toml", "sweep s.toml --status"] {
        let output = a3(folder, words);
        let line = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{line}");
        assert!(line.contains("1 other runs, of a3 0.0.9") && line.lines().count() == 1, "{line}");
    }
    assert_eq!(fs::read_to_string(&there).unwrap(), old);
}

#[test]
fn a_sweep_that_cannot_be_is_refused_in_a_line() {
    let base = "scene = \"chain\"\nstep = 0.01\nuntil = 1\n";
    let with = |more: &str| format!("{base}{more}");
    for (sweep, words, why) in [
        (with("[keys]\nchain.stifness = 3"), "", "did you mean `stiffness`?"),
        (with("[keys]\nchain.3.mass = 3"), "", "keys.chain.3.mass: there is no number 3"),
        (with("[keys]\nsprings = 3"), "", "springs"),
        (with("[keys]\nchain.mass = -3"), "", "chain.mass"),
        (with("[keys]\nchain.mass = []"), "", "the list is empty"),
        (with("[keys]\nchain.mass = { from = 1, to = 2 }"), "", "`count`"),
        (
            with("[keys]\ndrag = { from = 1, to = 2, count = 1000000 }\nchain.mass = [1, 2]"),
            "",
            "at most 1000000",
        ),
        (with("stepp = 3"), "", "did you mean `step`?"),
        (with("solver = \"rk5\""), "", "did you mean rk4?"),
        (with("solver = \"dopri5\""), "", "the key `tolerance` is missing"),
        (with("error = \"speed\""), "", "the choices are position"),
        (with("particle = 9"), "", "has no particle 9"),
        (with("solver = 3"), "", "solver: it must be a name"),
        ("scene = \"chain\"\nuntil = 1".into(), "", "one of the keys `step` and `tolerance`"),
        ("scene = \"chain\"\nstep = 0.01".into(), "", "has no duration: give `until`"),
        ("scene = \"chian\"\nstep = 0.01\nuntil = 1".into(), "", "did you mean chain?"),
        (
            "scene = \"simple\"\nsolver = \"verlet\"\nstep = 0.01\nuntil = 1".into(),
            "",
            "the sweep has no runs",
        ),
        ("scene = \"chain\"\nstep = 20\nuntil = 1".into(), "", "step: each must be a number"),
        ("scene = \"chain\"\nstep = 0,5\nuntil = 1".into(), "", "s.toml:2: "),
        (base.into(), "--only 4/3", "a share is K/N"),
        (base.into(), "--only 0123456789abcdef", "no run of this id"),
        (base.into(), "--plan --status", "not both"),
    ] {
        let folder = &begun(&sweep);
        let of_file = words.is_empty();
        let line = complaint(&a3(folder, format!("sweep s.toml {words}")), 2);
        assert!(line.contains(why), "{sweep}: {line}");
        assert!(!of_file || line.starts_with("error: s.toml:"), "{line}");
        assert_eq!(folder.count(), 1, "{sweep}: nothing is left behind");
    }
    let folder = &begun(base);
    let line = complaint(&a3(folder, "sweep s.toml --collect"), 1);
    assert!(
        line.contains("16 of 16 runs are missing") || line.contains("runs are missing"),
        "{line}"
    );
    assert!(complaint(&a3(folder, "sweep no.toml"), 2).contains("no.toml: it could not be read"));
}
