//! Figures in files.

use std::path::Path;

use a3_files::failure::Failure;
use a3_files::output;
use a3_plot::Figure;

/// Extensions of the picture formats.
pub const PICTURES: &[&str] = &["svg", "pdf", "png"];

/// Writes a figure as SVG, PDF or PNG, by the extension of the path.
pub fn write_picture(path: &Path, figure: &Figure) -> Result<(), Failure> {
    if output::ends_in(path, "png") {
        output::write(path, &figure.png(1.0).map_err(Failure::run)?)
    } else if output::ends_in(path, "pdf") {
        output::write(path, &figure.pdf())
    } else {
        output::write(path, figure.svg().as_bytes())
    }
}
