//! A program of a course: masses and springs that are stepped in the ways that courses teach. It
//! has nothing from a3 but the list of a scene.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::said;

pub type Triple = [f64; 3];

/// Masses and springs from `a3 scenes --list`, as a course's program has them.
pub struct Course {
    pub mass: Vec<f64>,
    pub pinned: Vec<usize>,
    springs: Vec<(usize, usize, f64, f64, f64)>,
    pub gravity: Triple,
    drag: f64,
    x: Vec<Triple>,
    pub v: Vec<Triple>,
    /// Pull of a spring (N) from its stiffness (N/m), its length (m) and its rest length (m).
    pub spring: fn(f64, f64, f64) -> f64,
    /// Whether the force acts on both ends.
    pub on_both: bool,
}

impl Course {
    pub fn of(list: &str) -> Self {
        let list: Value = serde_json::from_str(list).unwrap();
        let get = |key: &str| list[key].clone();
        Self {
            mass: serde_json::from_value(get("mass")).unwrap(),
            pinned: serde_json::from_value(get("pinned")).unwrap(),
            springs: serde_json::from_value(get("springs")).unwrap(),
            gravity: serde_json::from_value(get("gravity")).unwrap(),
            drag: list["drag"].as_f64().unwrap(),
            x: serde_json::from_value(get("positions")).unwrap(),
            v: serde_json::from_value(get("velocities")).unwrap(),
            spring: |k, length, rest| k * (length - rest),
            on_both: true,
        }
    }

    /// Accelerations of all particles, one coordinate after another.
    fn accelerations(&self, x: &[Triple], v: &[Triple]) -> Vec<Triple> {
        let mut all = vec![[0.0; 3]; x.len()];
        for (i, a) in all.iter_mut().enumerate() {
            if self.pinned.contains(&i) {
                continue;
            }
            for axis in 0..3 {
                let mut force = self.mass[i] * self.gravity[axis] - self.drag * v[i][axis];
                for &(p, q, k, rest, c) in &self.springs {
                    let other = match (p == i, q == i) {
                        (true, _) => q,
                        (_, true) if self.on_both => p,
                        _ => continue,
                    };
                    let apart: Vec<f64> = (0..3).map(|b| x[other][b] - x[i][b]).collect();
                    let length = apart.iter().map(|d| d * d).sum::<f64>().sqrt();
                    let rate: f64 = (0..3).map(|b| (v[other][b] - v[i][b]) * apart[b]).sum();
                    let pull = (self.spring)(k, length, rest) + c * rate / length;
                    force += pull * apart[axis] / length;
                }
                a[axis] = force / self.mass[i];
            }
        }
        all
    }

    /// States of a run of symplectic Euler's method in single precision.
    pub fn run_single(&self, h: f32, count: usize) -> Vec<[Vec<Triple>; 2]> {
        let single = |all: &[Triple]| all.iter().map(|v| v.map(|v| v as f32)).collect::<Vec<_>>();
        let double = |all: &[[f32; 3]]| all.iter().map(|v| v.map(f64::from)).collect::<Vec<_>>();
        let (mut x, mut v) = (single(&self.x), single(&self.v));
        let mut states = vec![[double(&x), double(&v)]];
        for _ in 0..count {
            let mut f = vec![[0f32; 3]; x.len()];
            for (i, f) in f.iter_mut().enumerate() {
                for axis in 0..3 {
                    f[axis] = self.mass[i] as f32 * self.gravity[axis] as f32
                        - self.drag as f32 * v[i][axis];
                }
            }
            for &(p, q, k, rest, c) in &self.springs {
                let apart: [f32; 3] = std::array::from_fn(|a| x[q][a] - x[p][a]);
                let length = apart.iter().map(|d| d * d).sum::<f32>().sqrt();
                let rate: f32 = (0..3).map(|a| (v[q][a] - v[p][a]) * apart[a]).sum();
                let pull = k as f32 * (length - rest as f32) + c as f32 * rate / length;
                for a in 0..3 {
                    f[p][a] += pull * apart[a] / length;
                    f[q][a] -= pull * apart[a] / length;
                }
            }
            for i in (0..x.len()).filter(|i| !self.pinned.contains(i)) {
                for a in 0..3 {
                    v[i][a] += h * f[i][a] / self.mass[i] as f32;
                    x[i][a] += h * v[i][a];
                }
            }
            states.push([double(&x), double(&v)]);
        }
        states
    }

    /// States of a run of steps of length h (s), with the start.
    pub fn run(&self, step: Step, h: f64, count: usize) -> Vec<[Vec<Triple>; 2]> {
        let mut states = vec![[self.x.clone(), self.v.clone()]];
        for _ in 0..count {
            let [x, v] = states.last().unwrap();
            states.push(step(self, h, x, v));
        }
        states
    }
}

pub type Step = fn(&Course, f64, &[Triple], &[Triple]) -> [Vec<Triple>; 2];

fn plus(y: &[Triple], h: f64, f: &[Triple]) -> Vec<Triple> {
    let both = y.iter().zip(f);
    both.map(|(y, f)| [y[0] + h * f[0], y[1] + h * f[1], y[2] + h * f[2]]).collect()
}

pub fn euler(course: &Course, h: f64, x: &[Triple], v: &[Triple]) -> [Vec<Triple>; 2] {
    [plus(x, h, v), plus(v, h, &course.accelerations(x, v))]
}

pub fn symplectic(course: &Course, h: f64, x: &[Triple], v: &[Triple]) -> [Vec<Triple>; 2] {
    let v = plus(v, h, &course.accelerations(x, v));
    [plus(x, h, &v), v]
}

pub fn positions_first(course: &Course, h: f64, x: &[Triple], v: &[Triple]) -> [Vec<Triple>; 2] {
    let x = plus(x, h, v);
    let a = course.accelerations(&x, v);
    [x, plus(v, h, &a)]
}

pub fn trapezoid(course: &Course, h: f64, x: &[Triple], v: &[Triple]) -> [Vec<Triple>; 2] {
    let a = course.accelerations(x, v);
    let (x1, v1) = (plus(x, h, v), plus(v, h, &a));
    let b = course.accelerations(&x1, &v1);
    let half = |y: &[Triple], f: &[Triple], g: &[Triple]| plus(&plus(y, h / 2.0, f), h / 2.0, g);
    [half(x, v, &v1), half(v, &a, &b)]
}

/// The velocities lose a hundredth in each step.
pub fn slowed(course: &Course, h: f64, x: &[Triple], v: &[Triple]) -> [Vec<Triple>; 2] {
    let v = plus(v, h, &course.accelerations(x, v));
    let v: Vec<_> = v.into_iter().map(|v| v.map(|v| 0.99 * v)).collect();
    [plus(x, h, &v), v]
}

/// The second evaluation is at the velocity before the step.
pub fn trapezoid_late(course: &Course, h: f64, x: &[Triple], v: &[Triple]) -> [Vec<Triple>; 2] {
    let a = course.accelerations(x, v);
    let b = course.accelerations(&plus(x, h, v), v);
    let half = |y: &[Triple], f: &[Triple], g: &[Triple]| plus(&plus(y, h / 2.0, f), h / 2.0, g);
    [half(x, v, &plus(v, h, &a)), half(v, &a, &b)]
}

/// Writes states as CSV with a row for each time.
pub fn write(path: &Path, h: f64, states: &[[Vec<Triple>; 2]], velocities: bool) {
    let n = states[0][0].len();
    let mut names = vec!["t".to_owned()];
    for prefix in if velocities { &["", "v"][..] } else { &[""] } {
        names.extend((0..n).flat_map(|i| ["x", "y", "z"].map(|axis| format!("{prefix}{axis}{i}"))));
    }
    let mut lines = vec![names.join(",")];
    for (k, state) in states.iter().enumerate() {
        let mut cells = vec![(k as f64 * h).to_string()];
        for part in state.iter().take(1 + usize::from(velocities)) {
            cells.extend(part.as_flattened().iter().map(f64::to_string));
        }
        lines.push(cells.join(","));
    }
    fs::write(path, lines.join("\n")).unwrap();
}

/// Judges files in JSON.
pub fn judged(folder: &Path, scene: &str, files: &str) -> Vec<Value> {
    let report = said(folder, format!("judge --scene {scene} --summary - {files}"));
    serde_json::from_str(&report).unwrap()
}

/// A small cloth with damped springs, a thousand times smaller if `small`.
pub fn cloth(small: bool) -> String {
    let scale = if small { 1e-3 } else { 1.0 };
    format!(
        "gravity = [0, {g}, 0]\ndrag = 0.002\n[[cloth]]\ngrid = [3, 4]\nspacing = {d}\nmass = 0.02\n\
         stiffness = [40, 20, 10]\ndamping = 0.02\nat = [0, 0, 0]\nright = [1, 0, 0]\ndown = [0, 0, 1]\n\
         sway = [0, 0, {g}]\npin = [{{ at = [\"top-left\", \"top-right\"] }}]\n",
        g = -9.81 * scale,
        d = 0.1 * scale
    )
}
