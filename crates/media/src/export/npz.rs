//! `.npz`: an array of doubles for each quantity, for `numpy.load`.
//!
//! It is a ZIP archive of files `NAME.npy` that are stored without compression (PKWARE, *APPNOTE*).
//! Each has a header that is a Python literal, and the numbers after it in row-major order (Kern,
//! *NEP 1*, 2007). The frames of an array follow one another, so each array is written to a
//! temporary file until the run is over.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_files::frames::FrameTimes;
use a3_files::output::{Draft, Scratch};
use a3_files::rounding::{DIGITS, short};
use crc32fast::Hasher;

use super::geometry::{Export, velocities};

/// Alignment of the numbers, to which the header is padded (bytes).
const ALIGNMENT: usize = 64;

/// Length of the bytes before a header: a magic string, a version and the header's own length.
const BEFORE_HEADER: usize = 10;

/// Version of ZIP that a reader has to support (2.0).
const VERSION: u16 = 20;

/// The first of January 1980, in the place of the real date, so that the same run writes the same
/// bytes.
const DATE: u16 = 0x21;

/// An archive that is being written.
pub struct Npz {
    draft: Draft,
    time: Array,
    positions: Array,
    velocities: Array,
    /// Masses (kg), unless the scene is of first order.
    masses: Option<Array>,
}

/// An array of the archive: the file `NAME.npy`.
struct Array {
    name: &'static str,
    file: BufWriter<Scratch>,
    checksum: Hasher,
    bytes: usize,
}

/// Returns the approximate size of the archive (bytes).
pub fn size(particles: f64, frames: FrameTimes) -> f64 {
    (48.0 * frames.count as f64 + 8.0) * particles + 8.0 * frames.count as f64
}

impl Npz {
    /// Creates an archive for these frames of the simulation.
    pub fn new(path: &Path, simulation: &Simulation, frames: FrameTimes) -> Result<Self, Failure> {
        let draft = Draft::new(path)?;
        let (count, n) = (frames.count, simulation.particles());
        let array = |name, shape: &[usize]| -> Result<Array, Failure> {
            let begun = Array::new(name, shape, Scratch::new(path)?);
            begun.map_err(|e| draft.failure(&e))
        };
        let time = array("time", &[count])?;
        let positions = array("positions", &[count, n, 3])?;
        let velocities = array("velocities", &[count, n, 3])?;
        let masses = if let Some(network) = simulation.model().network() {
            let mut masses = array("masses", &[n])?;
            let written = masses.numbers(network.masses().iter().copied());
            written.map_err(|e| draft.failure(&e))?;
            Some(masses)
        } else {
            None
        };
        Ok(Self { draft, time, positions, velocities, masses })
    }
}

impl Export for Npz {
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let (n, x, v) = (simulation.particles(), simulation.state(), velocities(simulation)?);
        let rows = |columns: &[f64]| -> Vec<f64> {
            let row = |i| [0, n, 2 * n].map(|column| columns[column + i]);
            (0..n).flat_map(row).collect()
        };
        let time = short(simulation.time(), DIGITS);
        let written = self.time.numbers([time]);
        let written = written.and_then(|()| self.positions.numbers(rows(x)));
        let written = written.and_then(|()| self.velocities.numbers(rows(&v)));
        written.map_err(|e| self.draft.failure(&e))
    }

    fn finish(self: Box<Self>) -> Result<(), Failure> {
        let mut draft = self.draft;
        let arrays = [self.time, self.positions, self.velocities];
        let written = archive(&mut draft, arrays.into_iter().chain(self.masses));
        written.map_err(|e| draft.failure(&e))?;
        draft.place()
    }
}

impl Array {
    /// Creates an array of this shape, without its numbers.
    fn new(name: &'static str, shape: &[usize], file: Scratch) -> io::Result<Self> {
        let shape: Vec<_> = shape.iter().map(usize::to_string).collect();
        let shape = shape.join(",");
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape},), }}");
        let filled = (BEFORE_HEADER + header.len() + 1).next_multiple_of(ALIGNMENT);
        let width = filled - BEFORE_HEADER - 1;
        let mut array =
            Self { name, file: BufWriter::new(file), checksum: Hasher::new(), bytes: 0 };
        array.write(b"\x93NUMPY\x01\0")?;
        array.write(&(width as u16 + 1).to_le_bytes())?;
        array.write(format!("{header:width$}\n").as_bytes())?;
        Ok(array)
    }

    /// Writes numbers.
    fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) -> io::Result<()> {
        for number in numbers {
            self.write(&number.to_le_bytes())?;
        }
        Ok(())
    }

    /// Writes bytes, and counts them.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.checksum.update(bytes);
        self.bytes += bytes.len();
        self.file.write_all(bytes)
    }
}

/// Writes the archive: the arrays, each after its name, the directory, and the offset of the
/// directory.
fn archive(file: &mut dyn Write, arrays: impl Iterator<Item = Array>) -> io::Result<()> {
    let (mut directory, mut offset, mut count) = (vec![], 0, 0u16);
    for mut array in arrays {
        array.file.flush()?;
        let name = format!("{}.npy", array.name);
        let [version, date, length_of_name] =
            [VERSION, DATE, name.len() as u16].map(u16::to_le_bytes);
        let checksum = array.checksum.finalize().to_le_bytes();
        let [bytes, start] = [length(array.bytes)?, length(offset)?].map(u32::to_le_bytes);
        // What stands both before the array and in the directory. The flags, the method (stored)
        // and the time of day are 0, and so is the length of extras.
        let shared =
            [&version[..], &[0; 6], &date, &checksum, &bytes, &bytes, &length_of_name, &[0; 2]];
        let (shared, name) = (&shared.concat()[..], name.as_bytes());
        let head = [b"PK\x03\x04", shared, name].concat();
        file.write_all(&head)?;
        io::copy(&mut array.file.get_ref().reader()?, file)?;
        // The length of a comment, the disk and the attributes are 0.
        let entry = [b"PK\x01\x02", &version[..], shared, &[0; 10], &start, name];
        directory.extend(entry.concat());
        offset += head.len() + array.bytes;
        count += 1;
    }
    file.write_all(&directory)?;
    let count = count.to_le_bytes();
    let [size, start] = [length(directory.len())?, length(offset)?].map(u32::to_le_bytes);
    // First the numbers of this disk and of the directory's disk, last the length of a comment.
    let end = [b"PK\x05\x06", &[0; 4][..], &count, &count, &size, &start, &[0; 2]];
    file.write_all(&end.concat())
}

/// Converts a length to the 32 bits of ZIP.
fn length(bytes: usize) -> io::Result<u32> {
    u32::try_from(bytes).map_err(|_| io::Error::other("a .npz has at most 4 GiB"))
}
