//! The options of sweeps.

use std::path::PathBuf;

use a3_files::arguments::threads;
use clap::Args;

use super::values::picture_size;
use crate::cli::share::Only;

#[derive(Args)]
#[command(after_help = "A sweep is a file such as\n\n  \
    scene = \"chain\"                                 # or a list of names and files\n  \
    solver = [\"euler\", \"rk4\", \"dopri5\"]             # by default all that can run the scene\n  \
    step = { from = 1e-4, to = 0.1, count = 12 }      # or a list; of solvers with fixed steps\n  \
    tolerance = [1e-3, 1e-5, 1e-7]                    # of adaptive solvers\n  \
    until = 2                                         # simulated seconds\n\n  \
    [keys]                                            # of the scene's file\n  \
    chain.stiffness = [5, 25, 125]\n  \
    wind.seed = { from = 1, to = 10, count = 10, spacing = \"linear\" }\n\n\
    Each run has a file in the folder, which is there whole or not at all: whatever was killed is run\n\
    again by the same command, and several processes and machines may work in one folder. A run that\n\
    blows up is a result. docs/sweeps.md has recipes for GNU parallel and Slurm.")]
pub struct Sweep {
    /// File that describes the sweep, in TOML
    #[arg(value_name = "FILE.toml")]
    pub file: PathBuf,
    /// Print the runs, one a line: id, scene, solver, step or tolerance, seconds, and the keys
    #[arg(long, conflicts_with_all = ["collect", "status", "only"])]
    pub plan: bool,
    /// Make a share of the runs: the K-th of N, or those with these ids, separated by commas
    #[arg(long, value_name = "K/N|IDS", value_parser = Only::parse)]
    pub only: Option<Only>,
    /// Join the runs that are done into FOLDER.csv and its chart, FOLDER.svg
    #[arg(long, conflicts_with_all = ["status", "only"])]
    pub collect: bool,
    /// Say how many runs are done, have blown up, and are missing
    #[arg(long, conflicts_with = "only")]
    pub status: bool,
    /// Folder of the runs; by default a3-sweep-FILE
    #[arg(long, short, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Number of threads; by default one for each processor, or as many as the environment variable
    /// `RAYON_NUM_THREADS` says
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Width and height of the chart in pixels
    #[arg(long, value_name = "WxH", default_value = "1600x1000", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
}
