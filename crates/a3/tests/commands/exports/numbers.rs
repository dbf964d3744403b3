//! Numbers of all frames as JSON and CSV, and the summary of a run.

use std::fs;

use super::{COUNT, RATE, row, run, write};
use serde_json::Value;

#[test]
fn json_has_the_states_of_all_frames_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    for scene in ["cloth", "simple", "chain"] {
        write(folder.path(), scene, "x.json", &["--fps", "25"]);
        let read = fs::read_to_string(folder.path().join("x.json")).unwrap();
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
    let folder = tempfile::tempdir().unwrap();
    for scene in ["cloth", "simple", "pendulum"] {
        write(folder.path(), scene, "x.csv", &["--fps", "25"]);
        let mut reader = csv::Reader::from_path(folder.path().join("x.csv")).unwrap();
        let head = ["frame", "time", "particle", "x", "y", "z", "vx", "vy", "vz"];
        assert_eq!(reader.headers().unwrap(), &head[..]);
        let mut rows = reader.deserialize::<(usize, f64, usize, [f64; 3], [f64; 3])>();
        run(scene, |k, simulation| {
            let (n, v) = (simulation.particles(), simulation.velocities());
            for i in 0..n {
                let right = (
                    k,
                    k as f64 / RATE,
                    i,
                    row(&simulation.state()[..3 * n], i),
                    row(&v, i),
                );
                assert_eq!(rows.next().unwrap().unwrap(), right);
            }
        });
        assert!(rows.next().is_none());
    }
}

#[test]
fn a_summary_says_what_became_of_the_energy() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| -> Value {
        serde_json::from_slice(&fs::read(folder.path().join(name)).unwrap()).unwrap()
    };
    write(
        folder.path(),
        "cloth",
        "x.json",
        &["--fps", "25", "--summary", "s.json"],
    );
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
    let said = write(folder.path(), "simple", "x.csv", &["--summary", "-"]);
    let summary: Value = serde_json::from_str(&said).unwrap();
    assert!(summary["energy"].is_null() && summary["largest_stretch"].is_null());
    assert_eq!(summary["frames"], 7);
}
