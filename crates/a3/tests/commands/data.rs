//! Data of `a3 chart` and `a3 stability`: orders of methods and limits of steps that are known in
//! closed form.

use crate::charts::CHAIN;
use crate::common::{Folder, a3, said};

/// The order between runs is that of their method, the errors of single particles agree with those
/// of all, and the errors at neighbouring tolerances are similar.
#[test]
fn orders_particles_and_spread_are_in_the_data() {
    let folder = &Folder::new();
    let words = "--solvers t,r,x --until 3 --spread --data d.csv --each e.csv -o c.svg";
    said(folder, format!("{CHAIN} {words}"));
    let read = |name: &str| -> Vec<std::collections::HashMap<String, String>> {
        let mut reader = csv::Reader::from_path(folder.join(name)).unwrap();
        reader.deserialize().map(Result::unwrap).collect()
    };
    let (runs, each) = (read("d.csv"), read("e.csv"));
    for (solver, order) in [("trapezoid", 2.0), ("rk4", 4.0)] {
        let of = runs.iter().filter(|run| run["solver"] == solver);
        let orders: Vec<f64> = of.filter_map(|run| run["order"].parse().ok()).collect();
        let finest = orders[orders.len() - 2];
        assert!((finest - order).abs() < 0.2, "{solver}: {orders:?}");
    }
    let number = |row: &std::collections::HashMap<String, String>, key: &str| -> f64 {
        row[key].parse().unwrap()
    };
    let mut beside = 0;
    for run in &runs {
        if !run["beside"].is_empty() {
            beside += 1;
            assert!((number(run, "setting") / number(run, "beside") - 1.0).abs() < 0.05);
            continue;
        }
        let own = each
            .iter()
            .filter(|row| row["solver"] == run["solver"] && row["setting"] == run["setting"]);
        let (mut sum, mut count) = (0.0, 0.0);
        for row in own {
            sum += ["x", "y", "z"].map(|axis| number(row, axis).powi(2)).iter().sum::<f64>();
            count += 1.0;
        }
        if run["lost_at"].is_empty() {
            let (all, together) = ((sum / count).sqrt(), number(run, "error_position"));
            assert!((0.999..5.0).contains(&(all / together)), "{all} {together}");
        }
    }
    assert!(beside > 9, "{beside}");
    let svg = folder.read("c.svg");
    assert!(svg.contains("fill-opacity=\"0.25\"") && svg.contains("within 4 %"));
}

/// In linear motion the limits of Verlet's method and RK4 are sharp and known: 2 and 2 sqrt(2) over
/// the fastest frequency. Explicit Euler has no sharp limit: an interval stands in its place.
#[test]
fn limits_are_written_as_data() {
    let folder = &Folder::new();
    let words = "stability --scene chain --solvers e,r,v --data l.json -o l.svg";
    let text = said(folder, words);
    assert!(text.contains("a\u{2013}b"), "{text}");
    let data = folder.read("l.json");
    let rows: Vec<serde_json::Value> = serde_json::from_str(&data).unwrap();
    assert_eq!(rows.len(), 3);
    let number = |row: usize, key: &str, part: &str| rows[row][key][part].as_f64().unwrap();
    let euler = ["shortest_failed", "longest_held"].map(|part| number(0, "moving_bounded", part));
    assert!(euler[0] < 0.5 * euler[1], "{euler:?}");
    let seen = number(0, "rest_observed", "longest_held");
    let by_modes = rows[0]["rest_tenfold"].as_f64().unwrap();
    assert!((seen / by_modes - 1.0).abs() < 0.03, "{seen} {by_modes}");
    let [rk4, verlet] = [1, 2].map(|row| number(row, "rest_observed", "longest_held"));
    assert!((rk4 / verlet - 2f64.sqrt()).abs() < 0.03, "{rk4} {verlet}");
    assert_eq!(rows[2]["rest_observed"]["sharp"], true);
    for words in ["stability --data s.csv", "chart --each e.json"] {
        let refused = a3(folder, words);
        let said = String::from_utf8(refused.stderr).unwrap();
        assert!(said.contains("must end in ."), "{said}");
    }
    let svg = folder.read("l.svg");
    assert!(svg.contains("not sharp: the shortest step that failed"));
}
