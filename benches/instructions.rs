//! Instructions of the main kernels, counted by callgrind, to detect slowdowns on any machine.
//!
//! `cargo bench --bench instructions` compares with the limits below, some 15 % above the counts at
//! the time. Callgrind supports vectors of four numbers, so kernels are counted with those. Without
//! `valgrind` nothing is counted, unless `A3_REQUIRE_VALGRIND` is set.

use std::hint::black_box;
use std::process::{Command, ExitCode};

use a3_core::{Grid, Integrator, Linearized, Network, Scene, integrators};

/// Limits on a cloth of 32 x 32 particles, in thousands of instructions, compiled for release and
/// for tests, which check for overflow.
const LIMITS: [(&str, [u64; 2]); 9] = [
    ("forces of a sheet", [155, 160]),
    ("forces of a damped sheet", [185, 195]),
    ("forces of single springs", [255, 255]),
    ("force differential", [335, 560]),
    ("step of rk4", [970, 1020]),
    ("step of verlet", [690, 720]),
    ("step of pefrl", [3700, 3900]),
    ("step of dopri5", [1670, 2010]),
    ("step of implicit", [5600, 6700]),
];

/// Numbers of runs of a kernel; the instructions between them are counted.
const RUNS: [u64; 2] = [2, 6];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["run", kernel, times] => {
            run(kernel, times.parse().expect("a number of times"));
            ExitCode::SUCCESS
        }
        _ if arguments.iter().any(|argument| argument == "--test") => ExitCode::SUCCESS,
        _ => compare(),
    }
}

/// Counts all kernels, and reports those above their limits.
fn compare() -> ExitCode {
    let mut good = true;
    println!("instructions by callgrind, in thousands, and what they may be at most");
    for (kernel, limits) in LIMITS {
        let most = limits[usize::from(cfg!(debug_assertions))];
        let counts = RUNS.map(|times| count(kernel, times));
        let [Some(few), Some(many)] = counts else {
            println!("valgrind does not run here: nothing was counted");
            return if std::env::var_os("A3_REQUIRE_VALGRIND").is_some() {
                ExitCode::FAILURE
            } else {
                ExitCode::SUCCESS
            };
        };
        let thousands = (many - few) / (RUNS[1] - RUNS[0]) / 1000;
        let mark = if thousands > most { "  TOO MANY" } else { "" };
        println!("{kernel:<26} {thousands:>6} {most:>6}{mark}");
        good &= thousands <= most;
    }
    if good { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Instructions of this program when it runs the kernel `times` times.
fn count(kernel: &str, times: u64) -> Option<u64> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(std::env::current_exe().ok()?)
        .args(["run", kernel, &times.to_string()])
        .output()
        .ok()?;
    let text = String::from_utf8(output.stderr).ok()?;
    let line = text.lines().find(|line| line.contains("Collected"))?;
    line.split_whitespace().last()?.parse().ok()
}

fn cloth(name: &str) -> Scene {
    let grid = Grid::new(32, 32).expect("a grid");
    let entry = a3_scenes::find(name).expect("a scene");
    entry.build(Some(grid)).expect("a cloth").scene
}

fn network(scene: &Scene) -> &Network {
    scene.model.network().expect("a cloth is a network")
}

fn run(kernel: &str, times: u64) {
    let scene = cloth(if kernel == "forces of a sheet" { "mit" } else { "cloth" });
    let network = network(&scene);
    let (x, v) = scene.state.split_at(scene.state.len() / 2);
    let mut f = vec![0.0; x.len()];
    match kernel {
        "forces of a sheet" | "forces of a damped sheet" => {
            for _ in 0..times {
                network.spring_forces(black_box(x), v, &mut f);
            }
        }
        "forces of single springs" => {
            let mut list = Network::new(vec![1.0; network.particles()]).expect("a network");
            list.add_springs(network.springs()).expect("springs");
            for _ in 0..times {
                list.spring_forces(black_box(x), v, &mut f);
            }
        }
        "force differential" => {
            // Of springs that move, are damped, and whose position and velocity change.
            for _ in 0..times {
                network.force_differential(0.0, black_box(x), x, x, x, &mut f);
            }
        }
        step => {
            let name = step.trim_start_matches("step of ");
            let method = integrators::find(name).expect("a method");
            let system = scene.model.system();
            let mut integrator: Box<dyn Integrator> = method.integrator(system).expect("it serves");
            let mut y = scene.state.clone();
            for _ in 0..times {
                integrator.step(system, 0.0, 1e-3, black_box(&mut y)).expect("a step");
            }
        }
    }
    black_box(f);
}
