//! The stress in solids, for `ParaView`.

use crate::common::{Folder, succeed};
use a3_core::Vector3;

const BAR: &str = r#"
gravity = [9.81, 0, 0]
drag_per_mass = 4

[[solid]]
grid = [7, 3, 3]
size = [0.6, 0.1, 0.1]
density = 1000
young = 1e5
poisson = 0.3
damping = 0.01
at = [0.3, 0, 0]
pin = [{ at = ["left"] }]
"#;

/// Returns the numbers of the array that begins after a word, in rows of N.
fn rows<const N: usize>(file: &str, after: &str) -> Vec<[f64; N]> {
    let array = file.split_once(after).unwrap().1;
    let numbers = array.split_once('>').unwrap().1;
    let numbers = numbers.split_once("</DataArray>").unwrap().0;
    let numbers: Vec<f64> =
        (numbers.split_whitespace().map(str::parse)).collect::<Result<_, _>>().unwrap();
    let (rows, rest) = numbers.as_chunks();
    assert!(rest.is_empty());
    rows.to_vec()
}

/// In a bar that hangs at rest, the stress along it, summed over the volume, is the moment of the
/// weights about the wall: the virial theorem. In the middle of it, half of the weight hangs.
#[test]
fn a_hanging_bar_has_the_stress_of_its_weight() {
    let folder = &Folder::new();
    folder.write("bar.toml", BAR);
    let run = "simulate i 0.02 --scene bar.toml --until 8 --output bar.vtu";
    succeed(folder, run);
    let file = folder.read("bar.vtu");
    let points: Vec<Vector3<f64>> =
        (rows(&file, "<Points>").into_iter()).map(Vector3::from).collect();
    let corners = rows::<4>(&file, "\"connectivity\"");
    let stresses = rows::<9>(&file, "\"stress\"");
    let mises = rows::<1>(&file, "\"von_mises_stress\"");
    let kinds = rows::<1>(&file, "\"types\"");
    assert_eq!(points.len(), 7 * 3 * 3);
    assert_eq!(corners.len(), 6 * 6 * 2 * 2);
    assert_eq!([stresses.len(), mises.len(), kinds.len()], [corners.len(); 3]);
    assert!(kinds.iter().all(|kind| *kind == [10.0]));
    let (mut along, mut volume, mut middle) = (0.0, 0.0, (0.0, 0.0));
    for (k, corners) in corners.iter().enumerate() {
        let [a, b, c, d] = corners.map(|i| points[i as usize]);
        let share = (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0;
        assert!(share > 0.0);
        let stress = stresses[k];
        assert!((stress[1] - stress[3]).abs() <= 1e-9 * mises[k][0]);
        (along, volume) = (along + share * stress[0], volume + share);
        if (0.2..0.4).contains(&(0.25 * (a + b + c + d).x)) {
            middle = (middle.0 + share * mises[k][0], middle.1 + share);
        }
    }
    assert!((volume / 6e-3 - 1.0).abs() < 0.05, "{volume}");
    let weight = 1000.0 * 9.81 * 6e-3;
    // The bar of 0.6 m is longer by rho g L^2 / 2 E = 0.018 m.
    let moment = weight * 0.3;
    assert!((along / moment - 1.0).abs() < 0.05, "{along} {moment}");
    let pull = weight / 2.0 / 0.01;
    assert!((middle.0 / middle.1 / pull - 1.0).abs() < 0.05, "{middle:?} {pull}");
}
