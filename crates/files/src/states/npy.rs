//! Arrays in the format of `NumPy` (Kern, *NEP 1*, 2007): a header, which is a Python literal, and
//! numbers.

/// Largest length of a header (bytes).
const MAX_HEADER: usize = 1 << 16;

/// Array of numbers.
pub struct Array {
    /// Length along each axis.
    pub shape: Vec<usize>,
    /// Numbers in row-major order.
    pub numbers: Vec<f64>,
    /// Share of a number by which it is rounded at most.
    pub share: f64,
}

/// Reads an array.
///
/// # Errors
/// The bytes are no array of numbers, or are too few.
pub fn read(bytes: &[u8]) -> Result<Array, String> {
    let damaged = || "it is no array of NumPy".to_owned();
    let rest = bytes.strip_prefix(b"\x93NUMPY").ok_or_else(damaged)?;
    let (version, rest) = rest.split_at_checked(2).ok_or_else(damaged)?;
    let width = if version[0] == 1 { 2 } else { 4 };
    let (length, rest) = rest.split_at_checked(width).ok_or_else(damaged)?;
    let length = length
        .iter()
        .rev()
        .fold(0, |sum, b| sum << 8 | usize::from(*b));
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
    let count = shape
        .iter()
        .try_fold(1usize, |count, n| count.checked_mul(*n));
    let (size, number): (usize, fn(&[u8]) -> f64) =
        match kind.trim_start_matches(['<', '>', '=', '|']) {
            "f8" => (8, |b| b.try_into().map_or(f64::NAN, f64::from_le_bytes)),
            "f4" => (4, |b| {
                b.try_into()
                    .map_or(f64::NAN, |b| f32::from_le_bytes(b).into())
            }),
            "i8" => (8, |b| {
                b.try_into()
                    .map_or(f64::NAN, |b| i64::from_le_bytes(b) as f64)
            }),
            "i4" => (4, |b| {
                b.try_into()
                    .map_or(f64::NAN, |b| i32::from_le_bytes(b).into())
            }),
            _ => {
                return Err(format!(
                    "its numbers are of the type {kind}: save it as float64 or float32"
                ));
            }
        };
    let fits = |count: &usize| {
        count
            .checked_mul(size)
            .is_some_and(|bytes| bytes <= data.len())
    };
    let count = count
        .filter(fits)
        .ok_or("it has fewer numbers than its shape says")?;
    let big = kind.starts_with('>');
    let numbers = data.chunks_exact(size).take(count).map(|chunk| {
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..size];
        bytes.copy_from_slice(chunk);
        if big {
            bytes.reverse();
        }
        number(bytes)
    });
    let numbers: Vec<_> = numbers.collect();
    Ok(Array {
        numbers: if fortran {
            transposed(&shape, &numbers)
        } else {
            numbers
        },
        shape,
        share: if kind.ends_with("f4") {
            f64::from(f32::EPSILON) / 2.0
        } else {
            0.0
        },
    })
}

/// Returns the value of a key of a Python dictionary of simple values.
fn value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = header.split_once(&format!("'{key}'"))?;
    let rest = rest.trim_start().strip_prefix(':')?.trim_start();
    let end = if rest.starts_with('(') {
        rest.find(')')? + 1
    } else {
        rest.find([',', '}'])?
    };
    Some(rest[..end].trim())
}

/// Returns numbers in column-major order (Fortran's) as ones in row-major order.
fn transposed(shape: &[usize], numbers: &[f64]) -> Vec<f64> {
    let mut place = vec![0; shape.len()];
    let mut rows = Vec::with_capacity(numbers.len());
    for _ in 0..numbers.len() {
        let offset = place
            .iter()
            .zip(shape)
            .rev()
            .fold(0, |sum, (k, n)| sum * n + k);
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
    use super::*;

    #[test]
    fn column_major_arrays_are_transposed() {
        // NumPy: np.asfortranarray(np.arange(6).reshape(1, 2, 3)).ravel("K").
        let rows = transposed(&[1, 2, 3], &[0.0, 3.0, 1.0, 4.0, 2.0, 5.0]);
        assert_eq!(rows, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }

    #[test]
    fn a_header_allocates_nothing() {
        for shape in [
            "(1000000000000, 3)",
            "(18446744073709551615, 2)",
            "(4294967296, 4294967296)",
        ] {
            let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
            let mut bytes = b"\x93NUMPY\x01\0".to_vec();
            bytes.extend((header.len() as u16).to_le_bytes());
            bytes.extend(header.as_bytes());
            bytes.extend([0; 64]);
            let why = read(&bytes).err().unwrap();
            assert!(why.contains("fewer numbers"), "{why}");
        }
    }
}
