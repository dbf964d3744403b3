//! Command lines, which are parsed, with the scenes that they name, but not run.
#![no_main]
#![allow(dead_code, missing_docs, unused_imports)]

#[path = "../../crates/a3/src/bounds.rs"]
mod bounds;
#[path = "../../crates/a3/src/cli/mod.rs"]
mod cli;
#[path = "../../crates/a3/src/failure.rs"]
mod failure;
#[path = "../../crates/a3/src/interrupt.rs"]
mod interrupt;
#[path = "../../crates/a3/src/lessons.rs"]
mod lessons;
#[path = "../../crates/a3/src/output/mod.rs"]
mod output;
#[path = "../../crates/a3/src/rounding.rs"]
mod rounding;
#[path = "../../crates/a3/src/scene_file/mod.rs"]
mod scene_file;
#[path = "../../crates/a3/src/share.rs"]
mod share;

use clap::Parser;
use clap::error::ErrorKind;

libfuzzer_sys::fuzz_target!(|line: &str| {
    let words = std::iter::once("a3").chain(line.split_whitespace());
    if let Err(error) = cli::Cli::try_parse_from(words)
        && !matches!(
            error.kind(),
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
        )
    {
        let _ = cli::explain(&error);
    }
});
