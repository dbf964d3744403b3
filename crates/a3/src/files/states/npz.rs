//! `.npz`: arrays of times, positions and perhaps velocities, in a ZIP archive.

use std::io::{Cursor, Read};

use zip::ZipArchive;
use zip::result::ZipError;

use super::build::Raw;
use super::digits::Digits;
use super::npy::{self, Array};

/// Largest size of an array that is unpacked (bytes).
const MAX_ARRAY: u64 = 512 << 20;

/// Reads states.
///
/// # Errors
/// The bytes are no archive, or an array is missing, or has another shape.
pub fn read(bytes: &[u8]) -> Result<Raw, String> {
    let archive = ZipArchive::new(Cursor::new(bytes));
    let mut archive = archive.map_err(|e| format!("it is no archive of NumPy arrays: {e}"))?;
    let mut find = |names: &[&str]| {
        let there = names.iter().map(|name| array(&mut archive, name));
        there
            .map(Result::transpose)
            .find_map(|found| found)
            .transpose()
    };
    let wanted = |name: &str| {
        format!(
            "it has no array {name}: write np.savez(file, t=t, x=x), with x of the shape (times, particles, 3)"
        )
    };
    let times = find(&["t", "time", "times"])?.ok_or_else(|| wanted("t"))?;
    let positions = find(&["x", "positions"])?.ok_or_else(|| wanted("x"))?;
    let velocities = find(&["v", "velocities"])?;
    let seconds = find(&["seconds"])?.and_then(|seconds| seconds.numbers.first().copied());
    if times.shape.len() != 1 {
        return Err(format!(
            "its times have the shape {:?}: one axis is wanted",
            times.shape
        ));
    }
    Ok(Raw {
        seconds,
        digits: [&times, &positions].map(|array| Digits::binary(array.share)),
        positions: rows("positions", &positions, &times)?,
        velocities: velocities.map_or(Ok(vec![]), |array| rows("velocities", &array, &times))?,
        times: times.numbers,
    })
}

/// Unpacks an array; `None` if the archive has none of this name.
fn array(archive: &mut ZipArchive<Cursor<&[u8]>>, name: &str) -> Result<Option<Array>, String> {
    let wrong = |why: &dyn std::fmt::Display| format!("its array {name} cannot be read: {why}");
    let file = match archive.by_name(&format!("{name}.npy")) {
        Err(ZipError::FileNotFound) => return Ok(None),
        found => found.map_err(|e| wrong(&e))?,
    };
    let mut bytes = vec![];
    let mut file = file.take(MAX_ARRAY + 1);
    file.read_to_end(&mut bytes).map_err(|e| wrong(&e))?;
    if bytes.len() as u64 > MAX_ARRAY {
        return Err(wrong(&format!("it is larger than {} MiB", MAX_ARRAY >> 20)));
    }
    npy::read(&bytes).map(Some).map_err(|why| wrong(&why))
}

/// Returns the states of an array as matrices in column-major order.
fn rows(name: &str, array: &Array, of: &Array) -> Result<Vec<Vec<f64>>, String> {
    let [times, particles, 3] = array.shape[..] else {
        return Err(format!(
            "its {name} have the shape {:?}: (times, particles, 3) is wanted",
            array.shape
        ));
    };
    if times != of.numbers.len() {
        return Err(format!(
            "it has {} times and {name} for {times}: there must be as many",
            of.numbers.len()
        ));
    }
    let state = |k: usize| {
        let number = move |axis: usize, i: usize| array.numbers[(k * particles + i) * 3 + axis];
        (0..3).flat_map(move |axis| (0..particles).map(move |i| number(axis, i)))
    };
    Ok((0..times).map(|k| state(k).collect()).collect())
}
