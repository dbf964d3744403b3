//! Numbers of all frames as JSON, CSV and `.npz`, and the summary of a run.

use std::collections::BTreeMap;

use super::{COUNT, RATE, row, run, write};
use crate::common::Folder;
use serde_json::Value;

#[test]
fn json_has_the_states_of_all_frames_to_the_bit() {
    let folder = &Folder::new();
    for scene in ["cloth", "simple", "chain"] {
        write(folder, scene, "x.json --fps 25");
        let read = folder.read("x.json");
        let frames: Vec<Value> = serde_json::from_str(&read).unwrap();
        assert_eq!(frames.len(), COUNT);
        run(scene, |k, simulation| {
            let (n, v) = (simulation.particles(), simulation.velocities());
            assert_eq!(frames[k]["time"], k as f64 / RATE);
            let rows =
                |matrix: &[f64]| -> Vec<[f64; 3]> { (0..n).map(|i| row(matrix, i)).collect() };
            let x = &simulation.state()[..3 * n];
            assert_eq!(frames[k]["positions"], serde_json::json!(rows(x)));
            assert_eq!(frames[k]["velocities"], serde_json::json!(rows(&v)));
        });
    }
}

#[test]
fn csv_has_a_row_a_frame_and_particle_to_the_bit() {
    let folder = &Folder::new();
    for scene in ["cloth", "simple", "pendulum"] {
        write(folder, scene, "x.csv --fps 25");
        let mut reader = csv::Reader::from_path(folder.join("x.csv")).unwrap();
        let head = ["frame", "time", "particle", "x", "y", "z", "vx", "vy", "vz"];
        assert_eq!(reader.headers().unwrap(), &head[..]);
        let mut rows = reader.deserialize::<(usize, f64, usize, [f64; 3], [f64; 3])>();
        run(scene, |k, simulation| {
            let (n, v) = (simulation.particles(), simulation.velocities());
            for i in 0..n {
                let right =
                    (k, k as f64 / RATE, i, row(&simulation.state()[..3 * n], i), row(&v, i));
                assert_eq!(rows.next().unwrap().unwrap(), right);
            }
        });
        assert!(rows.next().is_none());
    }
}

/// By the definitions of ZIP and of `.npy` files: the directory is found from its end, and every
/// file that it lists is a header and numbers.
fn arrays(bytes: &[u8]) -> BTreeMap<String, (String, Vec<f64>)> {
    let number = |at: usize, length: usize| {
        let bytes = bytes[at..at + length].iter().rev();
        bytes.fold(0, |number, byte| number << 8 | usize::from(*byte))
    };
    let end = bytes.len() - 22;
    assert_eq!(&bytes[end..end + 4], b"PK\x05\x06");
    let (count, mut at) = (number(end + 10, 2), number(end + 16, 4));
    assert_eq!(at + number(end + 12, 4), end);
    let entry = |_| {
        assert_eq!(&bytes[at..at + 4], b"PK\x01\x02");
        let (checksum, length) = (number(at + 16, 4), number(at + 24, 4));
        let (name_length, start) = (number(at + 28, 2), number(at + 42, 4));
        let name = &bytes[at + 46..at + 46 + name_length];
        at += 46 + name_length;
        // The header before the file agrees with the directory.
        assert_eq!(&bytes[start..start + 4], b"PK\x03\x04");
        assert_eq!((number(start + 14, 4), number(start + 22, 4)), (checksum, length));
        let content = start + 30 + name_length;
        assert_eq!(&bytes[start + 30..content], name);
        let file = &bytes[content..content + length];
        assert_eq!(crc32fast::hash(file) as usize, checksum);
        assert_eq!(&file[..8], b"\x93NUMPY\x01\0");
        let first = 10 + number(content + 8, 2);
        let header = String::from_utf8(file[10..first].to_vec()).unwrap();
        assert!(first.is_multiple_of(64) && header.ends_with('\n'), "{header}");
        let numbers = file[first..].chunks_exact(8);
        let numbers = numbers.map(|b| f64::from_le_bytes(b.try_into().unwrap()));
        let name = String::from_utf8(name.to_vec()).unwrap();
        (name, (header.trim_end().to_owned(), numbers.collect()))
    };
    (0..count).map(entry).collect()
}

#[test]
fn npz_has_an_array_of_each_quantity_to_the_bit() {
    let folder = &Folder::new();
    for scene in ["cloth", "simple", "pendulum"] {
        write(folder, scene, "x.npz --fps 25");
        let arrays = arrays(&folder.bytes("x.npz"));
        let (mut times, mut x, mut v, mut n, mut masses) = (vec![], vec![], vec![], 0, None);
        run(scene, |k, simulation| {
            n = simulation.particles();
            times.push(k as f64 / RATE);
            x.extend((0..n).flat_map(|i| row(&simulation.state()[..3 * n], i)));
            v.extend((0..n).flat_map(|i| row(&simulation.velocities(), i)));
            let network = simulation.model().network();
            masses = network.map(|network| network.masses().to_vec());
        });
        let header = |shape: &str| {
            format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}")
        };
        let all = format!("{COUNT},{n},3,");
        let mut right = BTreeMap::from([
            ("time.npy".into(), (header(&format!("{COUNT},")), times)),
            ("positions.npy".into(), (header(&all), x)),
            ("velocities.npy".into(), (header(&all), v)),
        ]);
        // A system of first order has no masses.
        assert_eq!(masses.is_none(), scene == "simple");
        right.extend(masses.map(|m| ("masses.npy".into(), (header(&format!("{n},")), m))));
        assert_eq!(arrays, right, "{scene}");
    }
}

#[test]
fn a_summary_says_what_became_of_the_energy() {
    let folder = &Folder::new();
    let read = |name: &str| -> Value { folder.json(name) };
    write(folder, "cloth", "x.json --fps 25 --summary s.json");
    let (summary, states) = (read("s.json"), read("x.json"));
    let last = &states[COUNT - 1];
    assert_eq!(summary["frames"], COUNT);
    for number in ["time", "steps", "evaluations"] {
        assert_eq!(summary[number], last[number]);
    }
    let energy = |k: usize| states[k]["energy"].as_f64().unwrap();
    assert_eq!(summary["energy"]["begin"], energy(0));
    assert_eq!(summary["energy"]["end"], energy(COUNT - 1));
    let drift = summary["energy"]["largest_drift"].as_f64().unwrap();
    let at_frames = (0..COUNT).map(|k| (energy(k) - energy(0)).abs());
    assert!(drift >= at_frames.fold(0.0, f64::max) && drift > 0.0);
    let stretch = summary["largest_stretch"].as_f64().unwrap();
    assert!(stretch > 1.0 && stretch < 3.0, "{stretch}");
    assert!(summary["wall_time"].as_f64().unwrap() > 0.0);
    // A system without forces has no energy and no springs.
    let said = write(folder, "simple", "x.csv --summary -");
    let summary: Value = serde_json::from_str(&said).unwrap();
    assert!(summary["energy"].is_null() && summary["largest_stretch"].is_null());
    assert_eq!(summary["frames"], 7);
}
