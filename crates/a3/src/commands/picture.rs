//! Pictures of commands: written to their file, named, and shown if that is asked for.

use std::path::Path;

use a3_files::failure::Failure;
use a3_files::terminal;
use a3_lab::figure_file::write_picture;
use a3_plot::Figure;

/// Writes a chart to its file, prints the path, and, if `open`, shows it in the desktop's viewer.
pub fn finish(path: &Path, figure: &Figure, open: bool) -> Result<(), Failure> {
    write_picture(path, figure)?;
    terminal::say(&format!("chart: {}\n", path.display()))?;
    if !open {
        return Ok(());
    }
    // A viewer may read a relative path as the address of a web page.
    let whole = std::path::absolute(path).map_err(Failure::run)?;
    open::that_detached(whole).map_err(|_| {
        let path = path.display();
        Failure::run(format!("{path}: it is written, but no viewer opens it"))
    })
}
