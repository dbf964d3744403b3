//! `.npz`: arrays of times, positions and perhaps velocities, in a ZIP archive. Each is in the
//! format of `NumPy` (Kern, *NEP 1*, 2007): a header, which is a Python literal, and numbers.

use std::io::{Cursor, Read};

use zip::ZipArchive;
use zip::result::ZipError;

use super::build::{Digits, States};

/// Largest size of the arrays that are unpacked, together (bytes).
const MAX_SIZE: u64 = 256 << 20;
/// Largest length of a header (bytes).
const MAX_HEADER: usize = 1 << 16;

/// Reads states.
///
/// # Errors
/// The bytes are no archive, or an array is missing, or has another shape.
pub fn read(bytes: &[u8]) -> Result<States, String> {
    let archive = ZipArchive::new(Cursor::new(bytes));
    let mut archive = archive.map_err(|e| format!("it is no archive of NumPy arrays: {e}"))?;
    let mut left = MAX_SIZE;
    let mut find = |names: &[&str]| {
        let there = names.iter().map(|name| array(&mut archive, name, &mut left));
        there.map(Result::transpose).find_map(|found| found).transpose()
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
        return Err(format!("its times have the shape {:?}: one axis is wanted", times.shape));
    }
    let digits = [&times, &positions].map(|array| Digits::binary(array.share));
    let positions = rows("positions", &positions, &times)?;
    let velocities = velocities.map(|array| rows("velocities", &array, &times));
    let velocities = velocities.transpose()?;
    Ok(States {
        seconds,
        digits,
        positions,
        velocities: velocities.filter(|rows| !rows.is_empty()),
        times: times.numbers,
        not_finite_at: None,
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
    let too_large =
        format!("the arrays are larger than {} MiB together: write fewer rows", MAX_SIZE >> 20);
    if file.size() > *left {
        return Err(wrong(&too_large));
    }
    let mut bytes = vec![];
    // The size that the archive tells may be wrong.
    let mut file = file.take(*left + 1);
    file.read_to_end(&mut bytes).map_err(|e| wrong(&e))?;
    *left = left.checked_sub(bytes.len() as u64).ok_or_else(|| wrong(&too_large))?;
    read_array(&bytes).map(Some).map_err(|why| wrong(&why))
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

/// Array of numbers.
struct Array {
    /// Length along each axis.
    shape: Vec<usize>,
    /// Numbers in row-major order.
    numbers: Vec<f64>,
    /// Share of a number by which it is rounded at most.
    share: f64,
}

/// Reads an array.
///
/// # Errors
/// The bytes are no array of numbers, or are too few.
fn read_array(bytes: &[u8]) -> Result<Array, String> {
    let damaged = || "it is no array of NumPy".to_owned();
    let rest = bytes.strip_prefix(b"\x93NUMPY").ok_or_else(damaged)?;
    let (version, rest) = rest.split_at_checked(2).ok_or_else(damaged)?;
    let width = if version[0] == 1 { 2 } else { 4 };
    let (length, rest) = rest.split_at_checked(width).ok_or_else(damaged)?;
    let length = length.iter().rev().fold(0, |sum, b| sum << 8 | usize::from(*b));
    if length > MAX_HEADER {
        return Err(damaged());
    }
    let (header, data) = rest.split_at_checked(length).ok_or_else(damaged)?;
    let header = str::from_utf8(header).map_err(|_| damaged())?;
    let kind = value(header, "descr").ok_or_else(damaged)?;
    let kind = kind.trim_matches(['\'', '"']);
    let fortran = value(header, "fortran_order") == Some("True");
    let shape = value(header, "shape").ok_or_else(damaged)?;
    let shape = shape.trim_matches(['(', ')']).split(',').map(str::trim);
    let shape = shape.filter(|part| !part.is_empty()).map(str::parse);
    let shape: Vec<usize> = shape.collect::<Result<_, _>>().map_err(|_| damaged())?;
    let count = shape.iter().try_fold(1usize, |count, n| count.checked_mul(*n));
    let (size, number): (usize, fn([u8; 8]) -> f64) =
        match kind.trim_start_matches(['<', '>', '=', '|']) {
            "f8" => (8, f64::from_le_bytes),
            "f4" => (4, |[a, b, c, d, ..]| f32::from_le_bytes([a, b, c, d]).into()),
            "i8" => (8, |bytes| i64::from_le_bytes(bytes) as f64),
            "i4" => (4, |[a, b, c, d, ..]| i32::from_le_bytes([a, b, c, d]).into()),
            _ => {
                return Err(format!(
                    "its numbers are of the type {kind}: save it as float64 or float32"
                ));
            }
        };
    let is_there = |bytes| bytes <= data.len();
    let fits = |count: &usize| count.checked_mul(size).is_some_and(is_there);
    let few = "it has fewer numbers than its shape says";
    let count = count.filter(fits).ok_or(few)?;
    let big = kind.starts_with('>');
    let numbers = data.chunks_exact(size).take(count).map(|chunk| {
        let mut bytes = [0; 8];
        bytes[..size].copy_from_slice(chunk);
        if big {
            bytes[..size].reverse();
        }
        number(bytes)
    });
    let numbers: Vec<_> = numbers.collect();
    Ok(Array {
        numbers: if fortran { transposed(&shape, &numbers) } else { numbers },
        shape,
        share: if kind.ends_with("f4") { f64::from(f32::EPSILON) / 2.0 } else { 0.0 },
    })
}

/// Returns the value of a key of a Python dictionary of simple values.
fn value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = header.split_once(&format!("'{key}'"))?;
    let rest = rest.trim_start().strip_prefix(':')?.trim_start();
    let end = if rest.starts_with('(') { rest.find(')')? + 1 } else { rest.find([',', '}'])? };
    Some(rest[..end].trim())
}

/// Returns numbers in column-major order (Fortran's) as ones in row-major order.
fn transposed(shape: &[usize], numbers: &[f64]) -> Vec<f64> {
    let mut place = vec![0; shape.len()];
    let mut rows = Vec::with_capacity(numbers.len());
    for _ in 0..numbers.len() {
        let offset = place.iter().zip(shape).rev().fold(0, |sum, (k, n)| sum * n + k);
        rows.push(numbers[offset]);
        for axis in (0..shape.len()).rev() {
            place[axis] += 1;
            if place[axis] < shape[axis] {
                break;
            }
            place[axis] = 0;
        }
    }
    rows
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
            writer.start_file(name, SimpleFileOptions::default()).unwrap();
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

    #[test]
    fn column_major_arrays_are_transposed() {
        // NumPy: np.asfortranarray(np.arange(6).reshape(1, 2, 3)).ravel("K").
        let rows = transposed(&[1, 2, 3], &[0.0, 3.0, 1.0, 4.0, 2.0, 5.0]);
        assert_eq!(rows, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }

    #[test]
    fn a_header_allocates_nothing() {
        for shape in ["(1000000000000, 3)", "(18446744073709551615, 2)", "(4294967296, 4294967296)"]
        {
            let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
            let mut bytes = b"\x93NUMPY\x01\0".to_vec();
            bytes.extend((header.len() as u16).to_le_bytes());
            bytes.extend(header.as_bytes());
            bytes.extend([0; 64]);
            let why = read_array(&bytes).err().unwrap();
            assert!(why.contains("fewer numbers"), "{why}");
        }
    }
}
