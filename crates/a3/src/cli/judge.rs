//! The options of `a3 judge`.

use std::path::PathBuf;

use a3_files::arguments::step;
use clap::Args;

use super::run::SceneArgs;
use super::values::{error, horizon, picture_size, seconds};

#[derive(Args)]
#[command(
    after_help = "Files, with times in s from 0 on, positions in m, and velocities in m/s if the program has them:\n  \
    FILE.csv   t,x0,y0,z0,x1,... and perhaps vx0,vy0,vz0,...: a row for each time; or, as a3 simulate\n             \
               writes them, time,particle,x,y,z,vx,vy,vz: a row for each particle. The names in the first\n             \
               line decide: other columns are left out, and a column seconds is the computing time;\n             \
               FILE.txt and FILE.tsv too\n  \
    FILE.json  {\"t\": [0, ...], \"x\": [[[x, y, z], ...], ...], \"v\": ..., \"seconds\": 0.5}, or the JSON of a3\n             \
               simulate\n  \
    FILE.npz   np.savez(FILE, t=t, x=x, v=v), with x and v of the shape (times, particles, 3)\n\n\
    Particles are in the order of the scene, which a3 scenes --print NAME --list tells together with all\n\
    masses, springs and pins. Steps that the rows lie apart by, or whole parts of this time, are tried with\n\
    every solver, and with the usual mistakes."
)]
pub struct Judge {
    /// Files with the states of other programs, ending in .csv, .txt, .tsv, .json or .npz; give
    /// several runs of a program with different steps to see its order
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub what: SceneArgs,
    /// Fail, with exit code 1, if the positions of a file err by more than this at any time, in m
    #[arg(long, value_name = "E", value_parser = error, allow_negative_numbers = true)]
    pub within: Option<f64>,
    /// Step of the program in seconds; by default, the distance of the states and whole parts of it
    /// are tried
    #[arg(long, value_name = "H", value_parser = step, allow_negative_numbers = true)]
    pub step: Option<f64>,
    /// Judge the states up to this time, in seconds; by default, as long as errors are meaningful
    /// on this scene
    #[arg(long, value_name = "T", value_parser = horizon, allow_negative_numbers = true)]
    pub until: Option<f64>,
    /// Computing time of each file's run in seconds, in the order of the files, such as 0.8,1.6
    #[arg(long, value_name = "S", value_delimiter = ',', value_parser = seconds, allow_negative_numbers = true)]
    pub seconds: Vec<f64>,
    /// Chart of speed against accuracy of all solvers with the files in it, ending in .svg, .pdf or
    /// .png
    #[arg(long, value_name = "FILE")]
    pub chart: Option<PathBuf>,
    /// Width and height of the chart in pixels, 96 to the inch, or `column`, 340x360, for a column
    /// of a paper
    #[arg(long, value_name = "WxH", default_value = "1200x800", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
    /// File for the judgements in JSON, with the errors at all times; - is standard output, in
    /// place of the text
    #[arg(long, value_name = "FILE.json")]
    pub summary: Option<PathBuf>,
}
