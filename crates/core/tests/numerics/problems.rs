//! Systems with published states at their ends (Mazzia, Magherini, *Test set for initial value
//! problem solvers*, 2008), which count the calls of f.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use a3_core::{Ode, Scene};

/// A system: f, the start, the end (s), and the published state there.
pub struct Problem {
    pub system: Ode,
    pub start: Vec<f64>,
    pub until: f64,
    pub end: Vec<f64>,
    /// Number of evaluations until now.
    pub calls: Arc<AtomicU64>,
}

impl Problem {
    pub fn scene(self) -> Scene {
        Scene::new("problem", self.system, self.start)
    }
}

fn problem(
    f: impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static,
    start: &[f64],
    until: f64,
    end: &[f64],
) -> Problem {
    let calls = Arc::new(AtomicU64::new(0));
    let counter = calls.clone();
    let counted = move |_: f64, y: &[f64], dydt: &mut [f64]| {
        counter.fetch_add(1, Ordering::Relaxed);
        f(y, dydt);
    };
    Problem {
        system: Ode::new(start.len(), counted).unwrap(),
        start: start.to_vec(),
        until,
        end: end.to_vec(),
        calls,
    }
}

/// Van der Pol's oscillator with epsilon = 1e-6.
pub fn van_der_pol() -> Problem {
    let f = |y: &[f64], dydt: &mut [f64]| {
        dydt[0] = y[1];
        dydt[1] = ((1.0 - y[0] * y[0]) * y[1] - y[0]) / 1e-6;
    };
    let end = [1.706_167_732_170_48, -0.892_809_701_024_798];
    problem(f, &[2.0, 0.0], 2.0, &end)
}

pub fn hires() -> Problem {
    let f = |y: &[f64], dydt: &mut [f64]| {
        dydt[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007;
        dydt[1] = 1.71 * y[0] - 8.75 * y[1];
        dydt[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4];
        dydt[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3];
        dydt[4] = -1.745 * y[4] + 0.43 * (y[5] + y[6]);
        dydt[5] = -280.0 * y[5] * y[7] + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6];
        dydt[6] = 280.0 * y[5] * y[7] - 1.81 * y[6];
        dydt[7] = -dydt[6];
    };
    let end = [
        7.371_312_573_325_668e-4,
        1.442_485_726_316_185e-4,
        5.888_729_740_967_575e-5,
        1.175_651_343_283_149e-3,
        2.386_356_198_831_331e-3,
        6.238_968_252_742_796e-3,
        2.849_998_395_185_769e-3,
        2.850_001_604_814_231e-3,
    ];
    let start = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
    problem(f, &start, 321.8122, &end)
}

pub fn oregonator() -> Problem {
    let f = |y: &[f64], dydt: &mut [f64]| {
        dydt[0] = 77.27 * (y[1] + y[0] * (1.0 - 8.375e-6 * y[0] - y[1]));
        dydt[1] = (y[2] - (1.0 + y[0]) * y[1]) / 77.27;
        dydt[2] = 0.161 * (y[0] - y[2]);
    };
    let end = [1.000_814_870_318_523, 1.228_178_521_549_917e3, 1.320_554_942_846_706e2];
    problem(f, &[1.0, 2.0, 3.0], 360.0, &end)
}

pub fn robertson() -> Problem {
    let f = |y: &[f64], dydt: &mut [f64]| {
        let [slow, fast] = [0.04 * y[0], 1e4 * y[1] * y[2]];
        dydt[0] = fast - slow;
        dydt[2] = 3e7 * y[1] * y[1];
        dydt[1] = slow - fast - dydt[2];
    };
    let end = [2.083_340_149_701_255e-8, 8.333_360_770_334_713e-14, 0.999_999_979_166_505];
    problem(f, &[1.0, 0.0, 0.0], 1e11, &end)
}

/// A spacecraft near the moon's orbit, which is back where it began after a period (Arenstorf).
pub fn arenstorf() -> Problem {
    let moon = 0.012_277_471;
    let f = move |y: &[f64], dydt: &mut [f64]| {
        let [x, z, u, v] = [y[0], y[1], y[2], y[3]];
        let cubed = |x: f64| (x * x + z * z).powf(1.5);
        let [earth, near] = [(1.0 - moon) / cubed(x + moon), moon / cubed(x - 1.0 + moon)];
        let along = x + 2.0 * v - earth * (x + moon) - near * (x - 1.0 + moon);
        let across = z - 2.0 * u - earth * z - near * z;
        dydt.copy_from_slice(&[u, v, along, across]);
    };
    let start = [0.994, 0.0, 0.0, -2.001_585_106_379_082_5];
    problem(f, &start, 17.065_216_560_157_964, &start)
}

/// Seven stars in a plane (Hairer, Norsett, Wanner, II.10).
pub fn pleiades() -> Problem {
    let f = |y: &[f64], dydt: &mut [f64]| {
        let (places, speeds) = y.split_at(14);
        let (x, z) = places.split_at(7);
        dydt[..14].copy_from_slice(speeds);
        for i in 0..7 {
            let mut pull = [0.0; 2];
            for j in (0..7).filter(|j| *j != i) {
                let apart = [x[j] - x[i], z[j] - z[i]];
                let cubed = (apart[0] * apart[0] + apart[1] * apart[1]).powf(1.5);
                pull = [0, 1].map(|k| pull[k] + (j + 1) as f64 * apart[k] / cubed);
            }
            (dydt[14 + i], dydt[21 + i]) = (pull[0], pull[1]);
        }
    };
    let mut start = vec![3.0, 3.0, -1.0, -3.0, 2.0, -2.0, 2.0];
    start.extend([3.0, -3.0, 2.0, 0.0, 0.0, -4.0, 4.0]);
    start.extend([0.0, 0.0, 0.0, 0.0, 0.0, 1.75, -1.5]);
    start.extend([0.0, 0.0, 0.0, -1.25, 1.0, 0.0, 0.0]);
    let end = [
        0.370_613_914_397_050_2,
        3.237_284_092_057_233,
        -3.222_559_032_418_324,
        0.659_709_145_577_531,
        0.342_558_170_715_658_4,
        1.562_172_101_400_631,
        -0.700_309_292_221_249_5,
        -3.943_437_585_517_392,
        -3.271_380_973_972_55,
        5.225_081_843_456_543,
        -2.590_612_434_977_47,
        1.198_213_693_392_275,
        -0.242_968_234_493_582_4,
        1.091_449_240_428_98,
    ];
    problem(f, &start, 3.0, &end)
}
