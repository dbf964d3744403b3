//! VTK's XML files of unstructured grids, as `ParaView` and meshio read them: all particles with
//! their velocities, and the tetrahedra of solids with the stress in them.

use std::io::{self, Write};

use a3_core::{Element, Simulation};
use a3_files::failure::Failure;
use a3_scenes::Surface;
use nalgebra::Matrix3;

/// VTK's number of a cell with four corners.
const TETRAHEDRON: &str = "10";

/// Size of a particle and of a tetrahedron in a file (bytes).
const SIZES: [f64; 2] = [120.0, 260.0];

/// A tetrahedron: its corners, and the stress in it (Pa).
type Cell = ([u32; 4], Matrix3<f64>);

/// Returns the tetrahedra of all solids in the current state.
fn cells(simulation: &Simulation) -> Vec<Cell> {
    let network = simulation.model().network();
    let elements = network.map_or(&[][..], |network| network.elements());
    let (x, v) = (simulation.state(), simulation.velocities());
    let x = &x[..3 * simulation.particles()];
    let solids = elements.iter().filter_map(|element| match element {
        Element::Solid(solid) => Some(solid),
        _ => None,
    });
    let each = solids.flat_map(|solid| solid.tetrahedra().zip(solid.stresses(x, &v)));
    each.collect()
}

/// Returns the approximate size of a file (bytes).
///
/// # Errors
/// The scene has no solids.
pub fn size(simulation: &Simulation) -> Result<f64, Failure> {
    let cells = cells(simulation).len();
    if cells == 0 {
        return Err(Failure::usage(format!(
            "a .vtu has the stress in solids, of which the scene {} has none: write .obj or .npz",
            simulation.scene().name
        )));
    }
    Ok(SIZES[0] * simulation.particles() as f64 + SIZES[1] * cells as f64)
}

/// Writes the current state in double precision.
pub fn write(file: &mut dyn Write, _surface: &Surface, simulation: &Simulation) -> io::Result<()> {
    let (n, cells) = (simulation.particles(), cells(simulation));
    let rows = |columns: &[f64]| {
        let row = |i: usize| [i, n + i, 2 * n + i].map(|k| columns[k]);
        (0..n).map(row).collect::<Vec<_>>()
    };
    let stresses = cells.iter().map(|(_, stress)| stress);
    // Rows and columns of a symmetric matrix are alike.
    let tensors = stresses.clone().map(|s| <[f64; 9]>::try_from(s.as_slice()));
    let tensors: Vec<_> = tensors.map(Result::unwrap_or_default).collect();
    let mises: Vec<_> = stresses.map(|s| [von_mises(s)]).collect();
    writeln!(file, "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\">")?;
    writeln!(file, "<UnstructuredGrid>\n<FieldData>")?;
    let time = [[simulation.time()]];
    array(file, "Float64", "Name=\"TimeValue\" NumberOfTuples=\"1\"", &time)?;
    writeln!(file, "</FieldData>")?;
    let count = cells.len();
    writeln!(file, "<Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{count}\">\n<PointData>")?;
    let vector = "NumberOfComponents=\"3\"";
    let velocities = rows(&simulation.velocities());
    array(file, "Float64", &format!("Name=\"velocity\" {vector}"), &velocities)?;
    writeln!(file, "</PointData>\n<CellData>")?;
    array(file, "Float64", "Name=\"von_mises_stress\"", &mises)?;
    array(file, "Float64", "Name=\"stress\" NumberOfComponents=\"9\"", &tensors)?;
    writeln!(file, "</CellData>\n<Points>")?;
    array(file, "Float64", vector, &rows(simulation.state()))?;
    writeln!(file, "</Points>\n<Cells>")?;
    let corners: Vec<_> = cells.iter().map(|(corners, _)| *corners).collect();
    array(file, "Int64", "Name=\"connectivity\"", &corners)?;
    let ends: Vec<_> = (1..=count).map(|k| [4 * k]).collect();
    array(file, "Int64", "Name=\"offsets\"", &ends)?;
    array(file, "UInt8", "Name=\"types\"", &vec![[TETRAHEDRON]; count])?;
    writeln!(file, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
}

/// Writes an array of rows of numbers.
fn array<T: std::fmt::Display, const N: usize>(
    file: &mut dyn Write,
    kind: &str,
    about: &str,
    rows: &[[T; N]],
) -> io::Result<()> {
    writeln!(file, "<DataArray type=\"{kind}\" {about} format=\"ascii\">")?;
    for row in rows {
        let words = row.each_ref().map(ToString::to_string);
        writeln!(file, "{}", words.join(" "))?;
    }
    writeln!(file, "</DataArray>")
}

/// Returns the stress at which a material that is pulled in one direction is strained as much in
/// shape (Pa): the root of 3/2 of the squares of the stress without its mean.
fn von_mises(stress: &Matrix3<f64>) -> f64 {
    let mean = stress.trace() / 3.0;
    (1.5 * (stress - Matrix3::from_diagonal_element(mean)).norm_squared()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pull, a pressure, and shear, for which it is the root of 3 times as large.
    #[test]
    fn von_mises_counts_the_change_of_shape() {
        let pull = Matrix3::new(5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        assert!((von_mises(&pull) - 5.0).abs() < 1e-14);
        assert!(von_mises(&Matrix3::from_diagonal_element(-7.0)) < 1e-14);
        let shear = Matrix3::new(0.0, 2.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        assert!((von_mises(&shear) - 12.0_f64.sqrt()).abs() < 1e-14);
    }
}
