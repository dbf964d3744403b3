//! Mutated command lines, data of charts, and states of other programs: each is accepted or
//! refused, without a panic.

#[path = "../../scenes/tests/hostile/mutation.rs"]
mod mutation;

#[cfg(feature = "window")]
use a3_files::failure::Failure;
use a3_files::rows::{Row, read};
use a3_files::states::parse;
use a3_lab::chart::record::Record;
#[cfg(feature = "window")]
use a3_media::show::{Arrows, Quantity};
#[cfg(feature = "window")]
use a3_render::Style;
#[cfg(feature = "window")]
use a3_studio::session::{Opening, read as read_words};
use clap::Parser;
use clap::error::ErrorKind;
use mutation::{Random, seeds};

#[cfg(feature = "window")]
use crate::cli::Command;
use crate::cli::{Cli, explain};

/// Number of inputs of each kind.
const INPUTS: usize = 10_000;

/// Gives mutated seeds to a reader, and returns how many it accepted.
fn feed(seeds: &[Vec<u8>], mut takes: impl FnMut(&str) -> bool) -> usize {
    let mut random = Random(1);
    let taken = (0..INPUTS).filter(|_| takes(&String::from_utf8_lossy(&random.mutated(seeds))));
    taken.count()
}

#[test]
fn command_lines_are_taken_or_refused() {
    let lines = seeds("command").concat();
    let lines: Vec<_> = lines.split(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    let taken = feed(&lines, |line| {
        let words = std::iter::once("a3").chain(line.split_ascii_whitespace());
        let Err(error) = Cli::try_parse_from(words) else {
            return true;
        };
        if !matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
            let why = explain(&error, &[]).unwrap_err().to_string();
            assert!(!why.is_empty() && !why.contains('\n'), "{line}: {why}");
        }
        false
    });
    assert!(taken > INPUTS / 25, "{taken}");
}

/// Command lines that open a window, and some that are refused.
#[cfg(feature = "window")]
const OF_WINDOWS: &str = "
t
t 0.01 --scene flag --wind --swing --self-collision
--scene mit r 1/60 --grid 5x5 --paused --status
r --grid=5x5 --colour speed --arrows=force --springs-of 3 --orthographic --no-config
dopri5 1e-4 --absolute 1e-6 --max-step 0.1 --threads 2
t --color strain --dark --light
t --light --dark --wireframe
v 0.005 --no-self-collision --springs --watch
--resume run.checkpoint
compare e:0.05 r --scene simple --dark --paused
compare e r v t --no-config --no-self-collision
t -1
t 0.01 0.02
t 1,5
t 10ms
t --scene
t --scene --wind
t --grid 5
t --grid -5x5
t --threads 0
t --absolute -1
t --springs-of -1
t --colour spead
t --colour zzzzzz
t --wind=1
t --wind --wind
t --wireframe --springs
t --self-collision --no-self-collision
t --resume run.checkpoint
compare e
compare e r v t a
compare e:x r
compare e r --watch
t --sceen flag
t -s";

/// Reads the words that follow the name of the program as the program does.
#[cfg(feature = "window")]
fn of_program(words: &[String]) -> Result<Opening, Failure> {
    let program = ["a3".to_owned()];
    let cli = Cli::try_parse_from(program.iter().chain(words));
    let cli = cli.map_err(|error| explain(&error, &[]).err().unwrap_or(Failure::usage(error)))?;
    match cli.command {
        None => Ok(cli.window.opening()),
        Some(Command::Compare(options)) => options.opening(),
        Some(_) => Err(Failure::usage("a page has no command except compare")),
    }
}

/// The page reads command lines as the program does, and says the same about wrong values.
#[cfg(feature = "window")]
#[test]
fn the_page_reads_command_lines_as_the_program_does() {
    let lines = seeds("command").concat();
    let mut lines: Vec<_> = lines.split(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    lines.extend(OF_WINDOWS.lines().map(|line| line.as_bytes().to_vec()));
    let read = |line: &str| {
        let words: Vec<_> = line.split_whitespace().map(str::to_owned).collect();
        let by = |read: fn(&[String]) -> Result<Opening, Failure>| {
            let opening = read(&words).map_err(|why| why.to_string())?;
            let methods = opening.methods.iter();
            let methods: Vec<_> = methods.map(|(m, step)| (m.map(|m| m.name), *step)).collect();
            let Opening { scene, options, limits, manner, resume, .. } = &opening;
            let look = (
                manner.style == Style::Wireframe,
                manner.style == Style::Springs,
                manner.springs_of,
                [manner.orthographic, manner.dark],
                manner.colour.map(Quantity::name),
                manner.arrows.map(Arrows::name),
            );
            let switches = [
                opening.no_contact,
                opening.light,
                opening.paused,
                opening.no_settings,
                opening.watch,
                opening.status,
            ];
            Ok::<_, String>(format!(
                "{scene} {options:?} {methods:?} {limits:?} {look:?} {resume:?} {switches:?}"
            ))
        };
        (by(of_program), by(read_words))
    };
    for line in OF_WINDOWS.lines() {
        match read(line) {
            (Err(program), Err(page)) => assert!(program.starts_with(&page), "{program}: {page}"),
            (program, page) => assert_eq!(program, page, "{line}"),
        }
    }
    // The program prints its help.
    let prints = |line: &str| ["-h", "-V", "--h", "--v"].iter().any(|it| line.contains(it));
    let taken = feed(&lines, |line| {
        if prints(line) {
            return false;
        }
        let (program, page) = read(line);
        if let Err(why) = &page {
            assert!(!why.is_empty() && !why.contains('\n'), "{line}: {why}");
        }
        assert!(program.is_err() || program == page, "{line}: {page:?}");
        page.is_ok()
    });
    assert!(taken > INPUTS / 10, "{taken}");
}

#[test]
fn data_of_charts_are_taken_or_refused() {
    let [csv, json] = &seeds("data")[..] else { panic!("other seeds") };
    for (seed, is_json) in [(csv, false), (json, true)] {
        let taken = feed(std::slice::from_ref(seed), |text| {
            let Ok(records) = read::<Record>(text, is_json) else {
                return false;
            };
            // These comparisons of runs must not panic either.
            let same = records.iter().filter(|r| r.is_same(&records[0]) && !r.is_held());
            assert!(same.count() <= records.len());
            true
        });
        assert!(taken > INPUTS / 25, "{taken}");
    }
}

#[test]
fn states_are_taken_or_refused() {
    let endings = ["json", "csv", "npz", "npz", "json", "csv"];
    let seeds = seeds("states");
    assert_eq!(seeds.len(), endings.len());
    for (seed, ending) in seeds.iter().zip(endings) {
        let original = parse(seed, ending, 2).unwrap();
        assert_eq!(original.times, [0.0, 0.5, 1.0], "{ending}");
        let mut random = Random(1);
        let mut taken = 0;
        for _ in 0..INPUTS {
            let bytes = random.mutated(std::slice::from_ref(seed));
            let Ok(states) = parse(&bytes, ending, 2) else {
                continue;
            };
            taken += 1;
            assert!(states.times.windows(2).all(|pair| pair[0] < pair[1]));
            let rows = states.positions.iter().chain(states.velocities.iter().flatten());
            assert!(rows.into_iter().all(|row| row.len() == 6));
            let mut numbers = states.positions.iter().flatten();
            assert!(numbers.all(|x| x.is_finite()));
        }
        assert!(taken > INPUTS / 100, "{ending}: {taken}");
    }
}
