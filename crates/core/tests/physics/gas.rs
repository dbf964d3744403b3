//! Gas in closed surfaces, against closed forms: an octahedron of springs has the volume sqrt(2)/3
//! L^3, where L is the length of its edges, and no other mesh is needed to know where it rests.

use a3_core::elements::{ATMOSPHERE, Gas, GasLaw};
use a3_core::{
    Control, Linearized, Mechanics, Model, Network, Scene, Simulation, Spring, SpringKind,
    SpringLaw,
};

use crate::common::{method, state_random};

const EDGE: f64 = 0.5;
const STIFFNESS: f64 = 40.0;

const TRIANGLES: [[u32; 3]; 8] =
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

/// Octahedron of springs with gas, a particle on each side of the three axes.
fn octahedron(law: GasLaw) -> Scene {
    let mut network = Network::new(vec![0.1; 6]).unwrap();
    let law_of_springs = SpringLaw::new(STIFFNESS, EDGE, 0.2).unwrap();
    for i in 0..6 {
        for j in i + 1..6 {
            if i / 2 != j / 2 {
                let kind = SpringKind::Structural;
                let spring = Spring { kind, i, j, law: law_of_springs };
                network.add_spring(spring).unwrap();
            }
        }
    }
    network.add(Gas::new(law, TRIANGLES.to_vec()).unwrap()).unwrap();
    network.set_drag(0.2).unwrap();
    let mut y = vec![0.0; 36];
    for i in 0..6 {
        y[6 * (i / 2) + i] = EDGE / 2_f64.sqrt() * if i % 2 == 0 { 1.0 } else { -1.0 };
    }
    Scene::new("octahedron", Model::Network(Box::new(network)), y)
}

fn volume(edge: f64) -> f64 {
    2_f64.sqrt() / 3.0 * edge.powi(3)
}

/// Length of the edges at which 12 k (L - r) = p dV/dL, by bisection.
fn rest(pressure: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.5 * EDGE, 1.6 * EDGE);
    for _ in 0..60 {
        let l: f64 = 0.5 * (low + high);
        let push = pressure(volume(l)) * 2_f64.sqrt() * l * l;
        if 12.0 * STIFFNESS * (l - EDGE) < push {
            low = l;
        } else {
            high = l;
        }
    }
    low
}

#[test]
fn a_balloon_rests_where_springs_and_gas_balance() {
    let amount = 1.002 * volume(EDGE);
    let laws = [
        (GasLaw::Pressure(100.0), rest(|_| 100.0)),
        (GasLaw::Pressure(-100.0), rest(|_| -100.0)),
        (GasLaw::Amount(amount), rest(|v| ATMOSPHERE * (amount / v - 1.0))),
    ];
    for (law, expected) in laws {
        for (name, value) in
            [("verlet", 1e-3), ("rk4", 1e-3), ("dopri5", 1e-7), ("implicit", 0.01), ("bdf", 1e-6)]
        {
            let (method, scene) = (method(name), octahedron(law));
            let run = Simulation::new(scene, method, method.control(value));
            if method.is_implicit() && matches!(law, GasLaw::Amount(_)) {
                let why = run.err().unwrap().to_string();
                assert!(why.contains("amounts of gas"), "{why}");
                continue;
            }
            let mut run = run.unwrap();
            run.advance_to(20.0).unwrap();
            let edge = (run.position(0) - run.position(2)).norm();
            assert!((edge - expected).abs() < 1e-6 * expected, "{name} {law:?}: {edge} {expected}");
        }
    }
}

/// The forces are the slope of the energy, and the differential and the couplings that of the
/// forces, by differences.
#[test]
fn energy_forces_differential_and_couplings_agree() {
    for law in [GasLaw::Pressure(300.0), GasLaw::Amount(1.01 * volume(EDGE))] {
        let scene = octahedron(law);
        let whole = scene.model.network().unwrap();
        let mut network = Network::new(vec![0.1; 6]).unwrap();
        network.add(Gas::new(law, TRIANGLES.to_vec()).unwrap()).unwrap();
        assert_eq!(whole.particles(), 6);
        let noise = state_random(36, 5);
        let x: Vec<_> = (0..18).map(|k| scene.state[k] + 0.1 * noise[k]).collect();
        let (d, zero, e) = (&noise[18..], vec![0.0; 18], 1e-6);
        let moved = |s: f64| -> Vec<f64> { x.iter().zip(d).map(|(x, d)| x + s * d).collect() };
        let forces = |x: &[f64]| {
            let mut f = vec![0.0; 18];
            network.forces(0.0, x, &zero, &mut f);
            f
        };
        let work: f64 = forces(&x).iter().zip(d).map(|(f, d)| f * d).sum();
        let energy = |s: f64| network.energy(&moved(s), &zero).total();
        let slope = (energy(e) - energy(-e)) / (2.0 * e);
        assert!((work + slope).abs() < 1e-6 * work.abs(), "{work} {slope}");
        let mut df = vec![0.0; 18];
        network.force_differential(0.0, &x, &zero, d, &zero, &mut df);
        let (ahead, behind) = (forces(&moved(e)), forces(&moved(-e)));
        let size = df.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        for k in 0..18 {
            let difference = (ahead[k] - behind[k]) / (2.0 * e);
            assert!((difference - df[k]).abs() < 1e-6 * size, "{difference} {}", df[k]);
        }
        if !network.lists_all_couplings() {
            continue;
        }
        let mut sum = [0.0; 18];
        network.couplings(0.0, &x, false, &mut |coupling| {
            let a3_core::Coupling::General(it) = coupling else {
                panic!("{coupling:?}");
            };
            let dd = [0, 6, 12].map(|axis| d[axis + it.i] - d[axis + it.j]);
            for a in 0..3 {
                for (b, dd) in dd.iter().enumerate() {
                    sum[6 * a + it.i] -= it.stiffness[3 * a + b] * dd;
                    sum[6 * a + it.j] += it.stiffness[3 * b + a] * dd;
                }
            }
        });
        for k in 0..18 {
            assert!((sum[k] - df[k]).abs() < 1e-9 * size, "{} {}", sum[k], df[k]);
        }
    }
}

#[test]
fn an_open_surface_holds_no_gas() {
    let mut open = TRIANGLES.to_vec();
    open.pop();
    let why = Gas::new(GasLaw::Pressure(1.0), open).unwrap_err().to_string();
    assert!(why.contains("must be closed"), "{why}");
    let mut turned = TRIANGLES.to_vec();
    turned[0].swap(0, 1);
    assert!(Gas::new(GasLaw::Pressure(1.0), turned).is_err());
    assert!(Gas::new(GasLaw::Amount(-1.0), TRIANGLES.to_vec()).is_err());
    let step = Control::Step(0.01);
    assert!(Simulation::new(octahedron(GasLaw::Pressure(1.0)), method("xpbd"), step).is_ok());
}
