//! `.npz`: arrays of times, positions and perhaps velocities, in a ZIP archive.

use std::io::{Cursor, Read};

use zip::ZipArchive;
use zip::result::ZipError;

use super::build::Raw;
use super::digits::Digits;
use super::npy::{self, Array};

/// Largest size of the arrays that are unpacked, together (bytes).
const MAX_SIZE: u64 = 256 << 20;

/// Reads states.
///
/// # Errors
/// The bytes are no archive, or an array is missing, or has another shape.
pub fn read(bytes: &[u8]) -> Result<Raw, String> {
    let archive = ZipArchive::new(Cursor::new(bytes));
    let mut archive = archive.map_err(|e| format!("it is no archive of NumPy arrays: {e}"))?;
    let mut left = MAX_SIZE;
    let mut find = |names: &[&str]| {
        let there = names
            .iter()
            .map(|name| array(&mut archive, name, &mut left));
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

/// Unpacks an array, of at most as many bytes as are `left`; `None` if the archive has none of this
/// name.
fn array(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    name: &str,
    left: &mut u64,
) -> Result<Option<Array>, String> {
    let wrong = |why: &dyn std::fmt::Display| format!("its array {name} cannot be read: {why}");
    let file = match archive.by_name(&format!("{name}.npy")) {
        Err(ZipError::FileNotFound) => return Ok(None),
        found => found.map_err(|e| wrong(&e))?,
    };
    let too_large = format!(
        "the arrays are larger than {} MiB together: write fewer rows",
        MAX_SIZE >> 20
    );
    if file.size() > *left {
        return Err(wrong(&too_large));
    }
    let mut bytes = vec![];
    // The size that the archive tells may be wrong.
    let mut file = file.take(*left + 1);
    file.read_to_end(&mut bytes).map_err(|e| wrong(&e))?;
    *left = left
        .checked_sub(bytes.len() as u64)
        .ok_or_else(|| wrong(&too_large))?;
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

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;

    /// An archive of arrays of 100 zeros each, which it packs into a few bytes.
    fn archive(names: &[&str]) -> Vec<u8> {
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (100,), }";
        let mut array = b"\x93NUMPY\x01\0".to_vec();
        array.extend((header.len() as u16).to_le_bytes());
        array.extend(header.as_bytes());
        array.extend([0; 800]);
        let mut writer = ZipWriter::new(Cursor::new(vec![]));
        for name in names {
            let name = format!("{name}.npy");
            writer
                .start_file(name, SimpleFileOptions::default())
                .unwrap();
            writer.write_all(&array).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    #[test]
    fn arrays_are_limited_together() {
        let bytes = archive(&["t", "x"]);
        let mut archive = ZipArchive::new(Cursor::new(&bytes[..])).unwrap();
        let mut left = 1500;
        let first = array(&mut archive, "t", &mut left).unwrap().unwrap();
        assert_eq!((first.numbers.len(), left < 700), (100, true));
        let why = array(&mut archive, "x", &mut left).err().unwrap();
        assert!(why.contains("larger than 256 MiB together"), "{why}");
        // The size that the archive tells is wrong.
        let central = bytes.windows(4).rposition(|four| four == b"PK\x01\x02");
        let mut forged = bytes.clone();
        forged[central.unwrap() + 24..][..4].copy_from_slice(&9u32.to_le_bytes());
        let mut archive = ZipArchive::new(Cursor::new(&forged[..])).unwrap();
        assert!(array(&mut archive, "x", &mut 100).is_err());
    }
}
