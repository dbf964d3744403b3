//! Forces and steps, over the tables of scenes and methods; `cargo bench -- forces` runs a part.

#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod steps;

use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use a3_core::{
    Control, Grid, Linearized, Mechanics, Model, Network, Scene, Sheet, Simulation, Spring,
    integrators,
};
use a3_scenes::{Description, Mesh};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group};

const SIDES: [usize; 7] = [8, 16, 32, 64, 128, 256, 512];

fn cloth(name: &str, side: usize) -> Scene {
    a3_scenes::find(name).unwrap().build(Some(Grid::new(side, side).unwrap())).unwrap().scene
}

fn network(scene: &Scene) -> &Network {
    match &scene.model {
        Model::Network(network) => network,
        Model::FirstOrder(_) | Model::Points(_) => unreachable!("cloth is a network"),
    }
}

/// The baseline: a simple loop over a list of springs.
fn plain_spring_list<const DAMPED: bool>(springs: &[Spring], x: &[f64], v: &[f64], f: &mut [f64]) {
    f.fill(0.0);
    let n = x.len() / 3;
    let (x, y, z) = (&x[..n], &x[n..2 * n], &x[2 * n..]);
    let (vx, vy, vz) = (&v[..n], &v[n..2 * n], &v[2 * n..]);
    let (fx, f) = f.split_at_mut(n);
    let (fy, fz) = f.split_at_mut(n);
    for &Spring { i, j, law, .. } in springs {
        let (dx, dy, dz) = (x[i] - x[j], y[i] - y[j], z[i] - z[j]);
        let length = (dx * dx + dy * dy + dz * dz).sqrt();
        if length == 0.0 {
            continue;
        }
        let mut pull = law.stiffness * (length - law.rest_length);
        if DAMPED {
            let rate = (vx[i] - vx[j]) * dx + (vy[i] - vy[j]) * dy + (vz[i] - vz[j]) * dz;
            pull += law.damping * rate / length;
        }
        let pull = pull / length;
        fx[i] -= pull * dx;
        fy[i] -= pull * dy;
        fz[i] -= pull * dz;
        fx[j] += pull * dx;
        fy[j] += pull * dy;
        fz[j] += pull * dz;
    }
}

/// Spring forces of both cloths, as sheets and by the baseline. Throughput is in springs.
fn forces(c: &mut Criterion) {
    for name in ["cloth", "mit"] {
        let mut group = c.benchmark_group(format!("forces/{name}"));
        for side in SIDES {
            let scene = cloth(name, side);
            let network = network(&scene);
            let springs: Vec<Spring> = network.springs().collect();
            let (x, v) = scene.state.split_at(scene.state.len() / 2);
            let mut f = vec![0.0; x.len()];
            group.throughput(Throughput::Elements(springs.len() as u64));
            group.bench_function(BenchmarkId::new("sheet", side), |b| {
                b.iter(|| {
                    network.spring_forces(black_box(x), black_box(v), &mut f);
                });
            });
            let rest = vec![0.0; x.len()];
            let damped = springs[0].law.damping > 0.0;
            group.bench_function(BenchmarkId::new("differential at rest", side), |b| {
                let dv = if damped { x } else { &rest };
                b.iter(|| network.force_differential(0.0, black_box(x), &rest, x, dv, &mut f));
            });
            group.bench_function(BenchmarkId::new("plain list", side), |b| {
                b.iter(|| {
                    let springs = black_box(&springs);
                    if damped {
                        plain_spring_list::<true>(springs, black_box(x), black_box(v), &mut f);
                    } else {
                        plain_spring_list::<false>(springs, black_box(x), black_box(v), &mut f);
                    }
                });
            });
        }
        group.finish();
    }
}

/// Spring forces of the same springs one by one, in their order and shuffled.
fn forces_of_a_list(c: &mut Criterion) {
    let mut group = c.benchmark_group("forces/list");
    for (side, shuffled) in SIDES.into_iter().flat_map(|side| [(side, false), (side, true)]) {
        let scene = cloth("mit", side);
        let mut springs: Vec<Spring> = network(&scene).springs().collect();
        let mut random = 1u64;
        for k in (1..springs.len()).rev().filter(|_| shuffled) {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            springs.swap(k, (random >> 33) as usize % (k + 1));
        }
        let mut list = Network::new(vec![1.0; side * side]).unwrap();
        list.add_springs(springs.iter().copied()).unwrap();
        let (x, v) = scene.state.split_at(scene.state.len() / 2);
        let mut f = vec![0.0; x.len()];
        let order = if shuffled { ", shuffled" } else { "" };
        group.throughput(Throughput::Elements(springs.len() as u64));
        group.bench_function(BenchmarkId::new(format!("network{order}"), side), |b| {
            b.iter(|| list.spring_forces(black_box(x), black_box(v), &mut f));
        });
        group.bench_function(BenchmarkId::new(format!("plain list{order}"), side), |b| {
            b.iter(|| plain_spring_list::<false>(&springs, black_box(x), black_box(v), &mut f));
        });
    }
    group.finish();
}

/// Cloth of 100 x 100 particles, alone and beside other elements, and bodies of about that size.
fn mixed() -> Vec<(&'static str, Scene)> {
    const SIDE: usize = 100;
    let pure = cloth("cloth", SIDE);
    let changed = |change: &dyn Fn(&mut Network)| {
        let mut scene = pure.clone();
        if let Model::Network(network) = &mut scene.model {
            change(network);
        }
        scene
    };
    let described = |text: &str, mesh: &Mesh| {
        Description::parse(text)
            .and_then(|description| description.build(None, &mut |_| Ok(mesh.clone())))
            .unwrap()
            .scene
    };
    let grid = Grid::new(71, 72).unwrap();
    let place = |i: usize| [(i % 72) as f64 / 72.0, (i / 72) as f64 / 71.0, 0.0];
    let mesh = Mesh {
        positions: (0..grid.particles()).map(place).collect(),
        triangles: grid.triangles().map(|t| t.map(|i| i as u32)).collect(),
        ..Mesh::default()
    };
    let spring = network(&pure).springs().next().unwrap();
    let i = SIDE * SIDE / 2;
    let half = |at: f64| {
        format!(
            "[[cloth]]
            grid = [{}, {SIDE}]
            width = 4
            density = 0.2
            stiffness = [20, 10, 5]
            damping_ratio = 0.02
            at = [0, 0, {at}]
            pin = [{{ at = ['top-left', 'top-right'] }}]",
            SIDE / 2
        )
    };
    let two = [0.0, 1.0].map(half).join("\n");
    let two = format!("gravity = [0, -9.81, 0]\ndrag_per_mass = 0.3\n{two}");
    let jelly = "[[jelly]]
        grid = [21, 22, 22]
        size = [1, 1, 1]
        mass = 0.05
        stiffness = [200, 125, 85]
        damping_ratio = 0.1
        at = [0, 0, 0]";
    let of_mesh = "[[mesh]]
        file = 'mesh.obj'
        density = 0.2
        stiffness = [50, 10]
        damping_ratio = 0.02";
    vec![
        ("cloth", pure.clone()),
        (
            "cloth and one spring",
            changed(&|network| {
                let far = Spring { j: SIDE * SIDE - 1, ..spring };
                network.add_spring(far).unwrap();
            }),
        ),
        ("two cloths", described(&two, &mesh)),
        (
            "cloth with one torn spring",
            changed(&|network| network.break_springs(&[[i, i + 1]]).unwrap()),
        ),
        ("jelly", described(jelly, &mesh)),
        ("mesh of 10,000 triangles", described(of_mesh, &mesh)),
    ]
}

/// Forces and steps of networks of several elements. Throughput is in springs.
fn elements(c: &mut Criterion) {
    for (name, scene) in mixed() {
        let network = network(&scene);
        let (x, v) = scene.state.split_at(scene.state.len() / 2);
        let mut f = vec![0.0; x.len()];
        let mut group = c.benchmark_group(format!("elements/{name}"));
        group.throughput(Throughput::Elements(network.springs().count() as u64));
        group.bench_function("forces", |b| {
            b.iter(|| network.forces(0.0, black_box(x), black_box(v), &mut f));
        });
        let springs: Vec<Spring> = network.springs().collect();
        group.bench_function("plain list", |b| {
            b.iter(|| plain_spring_list::<true>(&springs, black_box(x), black_box(v), &mut f));
        });
        steps::step(&mut group, &scene, integrators::find("rk4").unwrap());
        group.finish();
    }
}

/// One evaluation of all forces of every scene.
fn evaluation(c: &mut Criterion) {
    let mut group = c.benchmark_group("evaluation");
    for entry in a3_scenes::SCENES {
        let scene = entry.build(None).unwrap().scene;
        let system = scene.model.system();
        let mut dydt = vec![0.0; system.dim()];
        group.bench_function(entry.name, |b| {
            b.iter(|| system.eval_f(0.0, black_box(&scene.state), &mut dydt));
        });
    }
    group.finish();
}

/// One evaluation of moving chains of rods: constraints. Throughput is in rods.
fn rods(c: &mut Criterion) {
    let mut group = c.benchmark_group("evaluation/rods");
    for rods in [1u32, 10, 100, 1000, 10_000] {
        let text = format!(
            "gravity = [0, -9.81, 0]
            [[chain]]
            particles = {}
            from = [0, 0, 0]
            to = [{}, 0, 0]
            mass = 0.2
            rigid = true
            pin = [{{ at = ['first'] }}]",
            rods + 1,
            0.5 * f64::from(rods)
        );
        let scene = Description::parse(&text)
            .and_then(|description| description.build(None, &mut |_| Err("no mesh".into())))
            .unwrap()
            .scene;
        let mut run =
            Simulation::new(scene, integrators::find("rk4").unwrap(), Control::Step(1e-3)).unwrap();
        run.advance_to(0.5).unwrap();
        let system = run.model().system();
        let mut dydt = vec![0.0; system.dim()];
        group.throughput(Throughput::Elements(u64::from(rods)));
        group.bench_function(BenchmarkId::from_parameter(rods), |b| {
            b.iter(|| system.eval_f(0.5, black_box(run.state()), &mut dydt));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(1));
    targets = forces, forces_of_a_list, elements, evaluation, rods, steps::on_scenes, steps::by_size
}

fn main() {
    let begun = SystemTime::now();
    // Inside the thread pool, as a run takes its steps.
    rayon::scope(|_| benches());
    Criterion::default().configure_from_args().final_summary();
    ratios(begun);
}

/// Prints springs per second of this run, and their ratio to the plain list.
fn ratios(begun: SystemTime) {
    let home = std::env::var_os("CRITERION_HOME").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/criterion"),
        PathBuf::from,
    );
    let mean = |path: String| -> Option<f64> {
        let file = home.join(path).join("new/estimates.json");
        let fresh = file.metadata().ok()?.modified().ok()? >= begun;
        let text = std::fs::read_to_string(file).ok().filter(|_| fresh)?;
        let estimates: serde_json::Value = serde_json::from_str(&text).ok()?;
        estimates["mean"]["point_estimate"].as_f64()
    };
    for (group, kernel, plain, what) in [
        ("forces_cloth", "sheet", "plain list", "sheet, damped"),
        ("forces_mit", "sheet", "plain list", "sheet, undamped"),
        ("forces_list", "network", "plain list", "single springs"),
        ("forces_list", "network, shuffled", "plain list, shuffled", "single springs, shuffled"),
    ] {
        for side in SIDES {
            let mean = |kernel| mean(format!("{group}/{kernel}/{side}"));
            let found = mean(kernel).zip(mean(plain));
            if let Some((kernel, plain)) = found {
                let grid = Grid::new(side, side).unwrap();
                let springs = Sheet::new(grid, 1.0, [1.0; 3], 0.0).unwrap().springs().count();
                println!(
                    "{what:<26} {side:>4} x {side:<4} {:>6.0} million springs/s, {:>4.2} times the plain list",
                    1e3 * springs as f64 / kernel,
                    plain / kernel
                );
            }
        }
    }
    for what in ["forces", "plain list", "rk4"] {
        let mut pure = None;
        for (name, scene) in mixed() {
            let Some(time) = mean(format!("elements_{name}/{what}")) else {
                continue;
            };
            let speed = 1e3 * network(&scene).springs().count() as f64 / time;
            let pure = *pure.get_or_insert(speed);
            println!(
                "{what:<10} {name:<28} {speed:>6.0} million springs/s, {:>4.2} times the cloth alone",
                speed / pure
            );
        }
    }
}
