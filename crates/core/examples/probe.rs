//! Probe.
use a3_core::*;
use std::time::Instant;
fn chain(n: usize) -> Scene {
    let mut net = Network::new(vec![0.01; n + 1]).unwrap();
    net.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    let l = 10.0 / n as f64;
    let mut y = vec![0.0; 6 * (n + 1)];
    for i in 0..=n {
        y[i] = l * i as f64 * 0.6;
        y[n + 1 + i] = -l * i as f64 * 0.8;
    }
    for i in 0..n {
        net.add_constraint(Constraint::Rod {
            i,
            j: i + 1,
            length: l,
        })
        .unwrap();
    }
    net.pin(0, Path::Still(Vector3::zeros())).unwrap();
    Scene::new("chain", Model::Network(Box::new(net)), y)
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    if args[1] == "chain" {
        for n in [250, 500, 1000, 2000] {
            for m in ["implicit", "tr-bdf2", "implicit-midpoint", "bdf", "rk4"] {
                let method = integrators::find(m).unwrap();
                let c = if m == "bdf" {
                    Control::Tolerance(1e-3)
                } else if m == "rk4" {
                    Control::Step(1e-4)
                } else {
                    Control::Step(0.005)
                };
                let scene = chain(n);
                let net = match &scene.model {
                    Model::Network(n) => (**n).clone(),
                    _ => panic!(),
                };
                let mut run = Simulation::new(scene, method, c).unwrap();
                let t0 = Instant::now();
                let r = run.advance_to(if m == "rk4" { 0.005 } else { 0.1 });
                let t = t0.elapsed().as_secs_f64();
                let y = run.state();
                let (x, _v) = y.split_at(y.len() / 2);
                println!(
                    "{n} {m} {:?} steps {} time {t:.3} us/step/rod {:.3} err {:?} work {:?}",
                    r.is_ok(),
                    run.steps(),
                    t * 1e6 / run.steps() as f64 / n as f64,
                    net.constraint_error(x),
                    run.work()
                );
                if let Err(e) = r {
                    println!("{e}");
                }
            }
        }
        return;
    }
    let text = std::fs::read_to_string(&args[1]).ok();
    let until: f64 = args[2].parse().unwrap();
    for m in args[3].split(',') {
        for c in args[4].split(',') {
            let c: f64 = c.parse().unwrap();
            let scene = match &text {
                Some(t) => {
                    a3_scenes::Description::parse(t)
                        .unwrap()
                        .build(None, &mut |_| Err(String::new()))
                        .unwrap()
                        .scene
                }
                None => {
                    a3_scenes::find(&args[1])
                        .unwrap()
                        .build(None)
                        .unwrap()
                        .scene
                }
            };
            let net = match &scene.model {
                Model::Network(n) => (**n).clone(),
                _ => panic!(),
            };
            let method = integrators::find(m).unwrap();
            let control = if method.is_adaptive() && c < 0.0 {
                Control::Tolerance(-c)
            } else {
                Control::Step(c)
            };
            let mut run = Simulation::new(scene, method, control).unwrap();
            let y = run.state();
            let e0 = net
                .energy_at(0.0, &y[..y.len() / 2], &y[y.len() / 2..])
                .total();
            let mut worst: f64 = 0.0;
            let mut k = 0;
            let mut ok = true;
            while k < 100 {
                k += 1;
                if let Err(e) = run.advance_to(until * k as f64 / 100.0) {
                    println!("{m} {c}: {e}");
                    ok = false;
                    break;
                }
            }
            if !ok {
                continue;
            }
            let y = run.state();
            let (x, v) = y.split_at(y.len() / 2);
            worst = worst.max(net.constraint_error(x).unwrap_or(0.0));
            let e1 = net.energy_at(0.0, x, v).total();
            println!(
                "{m} {c} err {worst:e} dE {:e} of {e0} work {:.0} steps {} y {}",
                e1 - e0,
                run.work().total(),
                run.steps(),
                y.iter()
                    .map(|a| format!("{a:.14}"))
                    .collect::<Vec<_>>()
                    .join(" ")
            );
        }
    }
}
