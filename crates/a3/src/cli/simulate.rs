//! The options of `a3 simulate`.

use std::path::PathBuf;

use clap::Args;

use super::run::RunOptions;
use super::values::{pause, rate};

#[derive(Args)]
#[command(after_help = "Outputs, all in m and s, y up:\n  \
    FILE.json      the final state at full precision; with --fps, the states of all frames\n  \
    FILE.csv       all frames at full precision: frame,time,particle,x,y,z,vx,vy,vz\n  \
    FILE.npz       arrays of all frames for NumPy: time, positions, velocities and masses\n  \
    FILE.obj       the final surface with normals, or points and lines where there is no surface\n  \
    FILE-####.obj  one such file for each frame, numbered with as many digits as there are #\n  \
    FILE.pc2       a point cache (PC2), and beside it FILE.obj, the mesh that it moves\n  \
    FILE.glb       glTF 2.0 with a morph target for each frame, at most 600\n  \
    FILE.usda      Universal Scene Description: meshes, curves and points with time samples\n\n\
    Frames are at exactly k / N, from 0 to --until; no step is shortened for them. Particles keep\n\
    their order and numbers in all files. OBJ, PC2, GLB and USD are in single precision. A run that\n\
    blows up or is interrupted leaves no file, except for the finished files of a sequence. In Blender,\n\
    load a PC2 with the modifier Mesh Cache and leave its axes as they are.")]
pub struct Simulate {
    #[command(flatten)]
    pub run: RunOptions,
    /// File to write, whose ending chooses the format; - writes JSON to standard output
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Frames per second of outputs that have several; 30 by default
    #[arg(long, value_name = "N", value_parser = rate, allow_negative_numbers = true)]
    pub fps: Option<f64>,
    /// File for a summary in JSON: energy at the start and at the end, its largest drift, the
    /// largest stretch, steps, evaluations and real time; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub summary: Option<PathBuf>,
    /// Fail if surfaces pass through one another: every edge is checked against every triangle,
    /// exactly, sixty times a simulated second
    #[arg(long)]
    pub check: bool,
    /// File to which the whole run is saved from time to time, when it is interrupted, and at the
    /// end
    #[arg(long, value_name = "FILE.checkpoint")]
    pub checkpoint: Option<PathBuf>,
    /// Real time between two checkpoints, in seconds
    #[arg(long, value_name = "S", default_value = "60", value_parser = pause, requires = "checkpoint")]
    pub every: f64,
    /// Continue a run of this scene from a checkpoint, with the solver and the step of that run;
    /// the results are exactly those of a run that had never stopped
    #[arg(long, value_name = "FILE.checkpoint")]
    pub resume: Option<PathBuf>,
}
