//! Command lines. They are read, and no command is run.
#![no_main]
#![allow(dead_code, missing_docs, unused_imports)]

#[path = "../../crates/a3/src/cli/mod.rs"]
mod cli;

use std::ffi::OsString;

use clap::Parser;
use clap::error::ErrorKind;

libfuzzer_sys::fuzz_target!(|line: &str| {
    let words = std::iter::once("a3").chain(line.split_whitespace());
    let words: Vec<OsString> = words.map(OsString::from).collect();
    if let Err(error) = cli::Cli::try_parse_from(&words)
        && !matches!(
            error.kind(),
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
        )
    {
        let _ = cli::explain(&error, &words);
    }
});
