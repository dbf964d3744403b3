//! `a3 man` and `a3 completions`: the manual and the completion scripts, made from the definition
//! of the command line.

use std::io;
use std::path::Path;

use a3_files::failure::{EXIT_CODES, Failure};
use a3_files::output;
use a3_files::terminal;
use clap::{Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;

use crate::cli::Cli;

/// Prints the script with which a shell completes words.
pub fn completions(shell: Shell) -> Result<(), Failure> {
    let mut script = vec![];
    clap_complete::generate(shell, &mut visible(&Cli::command()), "a3", &mut script);
    say(script)
}

/// Prints one page with all commands, or writes a page for each command into a folder.
pub fn run(folder: Option<&Path>) -> Result<(), Failure> {
    let command = command();
    let Some(folder) = folder else {
        let mut page = vec![];
        whole(&command, &mut page).map_err(Failure::run)?;
        return say(page);
    };
    if !folder.is_dir() {
        return Err(Failure::run(format!("there is no folder {}", folder.display())));
    }
    for command in [&command].into_iter().chain(command.get_subcommands()) {
        let (man, mut page) = (Man::new(command.clone()), vec![]);
        man.render(&mut page).map_err(Failure::run)?;
        exit_status(&mut page);
        let page = text(page).map_err(Failure::run)?;
        output::write(&folder.join(man.get_filename()), page.as_bytes())?;
    }
    Ok(())
}

/// Returns the command line with full names, and without the command `help`, which duplicates
/// `--help`.
fn command() -> Command {
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    command
}

/// Returns a command without its hidden options, which clap would complete.
fn visible(command: &Command) -> Command {
    let args = command.get_arguments().filter(|arg| !arg.is_hide_set());
    let about = command.get_about().cloned().unwrap_or_default();
    Command::new(command.get_name().to_owned())
        .about(about)
        .version(env!("CARGO_PKG_VERSION"))
        .disable_version_flag(command.get_version().is_none())
        .disable_help_subcommand(true)
        .args(args.cloned())
        .subcommands(command.get_subcommands().map(visible))
}

/// Writes the page of the program, with a section for each command.
fn whole(command: &Command, page: &mut Vec<u8>) -> io::Result<()> {
    let man = Man::new(command.clone());
    man.render_title(page)?;
    man.render_name_section(page)?;
    man.render_synopsis_section(page)?;
    man.render_options_section(page)?;
    man.render_extra_section(page)?;
    for command in command.get_subcommands() {
        let (man, mut part) = (Man::new(command.clone()), vec![]);
        man.render_synopsis_section(&mut part)?;
        man.render_description_section(&mut part)?;
        man.render_options_section(&mut part)?;
        if command.get_after_help().is_some() {
            man.render_extra_section(&mut part)?;
        }
        let name = command.get_bin_name().unwrap_or_default();
        page.extend(format!(".SH \"{name}\"\n").bytes());
        // The sections of a command become subsections below its name.
        page.extend(text(part)?.replace(".SH ", ".SS ").bytes());
    }
    exit_status(page);
    man.render_version_section(page)
}

/// Writes the section of the exit codes.
fn exit_status(page: &mut Vec<u8>) {
    page.extend(b".SH \"EXIT STATUS\"\n");
    for (code, meaning) in EXIT_CODES {
        // In a man page, a backslash makes a hyphen one that can be typed.
        let meaning = meaning.replace('-', "\\-");
        page.extend(format!(".TP\n\\fB{code}\\fR\n{meaning}\n").bytes());
    }
}

fn say(bytes: Vec<u8>) -> Result<(), Failure> {
    terminal::send(&text(bytes).map_err(Failure::run)?)
}

/// Returns the text of a page, in which the section after the options is called notes.
fn text(bytes: Vec<u8>) -> io::Result<String> {
    let text = String::from_utf8(bytes).map_err(io::Error::other)?;
    Ok(text.replace(".SH EXTRA", ".SH NOTES"))
}
