//! Liquid that flows out, against laws of physics.

use crate::common::{described, method};
use a3_core::{Control, Simulation};

/// Particles that have flowed out, and free ones that have not.
fn counts(run: &Simulation) -> [usize; 2] {
    let network = run.model().network().unwrap();
    let fluid = network.fluid().unwrap();
    let flowing = fluid.particles().iter();
    let free = flowing.filter(|i| !network.is_pinned(**i as usize));
    [fluid.members().drained().len(), free.count()]
}

/// A stream through a channel without gravity: once it has filled the channel, as much flows out as
/// flows in.
#[test]
fn as_much_flows_out_as_in() {
    for dimensions in [2, 3] {
        let depth = 0.2 * f64::from(dimensions - 2);
        let scene = described(&format!(
            "[[fluid]]
            dimensions = {dimensions}
            size = [0, 0, 0]
            spacing = 0.05
            at = [0, 0, 0]
            density = 1000
            sound = 20
            inflow = {{ size = [0, 0.2, {depth}], at = [0, 0.1, 0], velocity = [1, 0, 0], duration = 1.5 }}
            outflow = [{{ size = [0.2, 0.4, {depth}], at = [0.6, 0.1, 0] }}]"
        ));
        let each = 4_usize.pow(dimensions - 1);
        let mut run = Simulation::new(scene, method("verlet"), Control::Step(1e-3)).unwrap();
        for k in 1..=14 {
            let t = 0.1 * f64::from(k);
            run.advance_to(t).unwrap();
            let [out, flowing] = counts(&run);
            // Layers are let go every 0.05 s, the first at half of that, and leave 0.5 m later.
            let layers = (t / 0.05).round() as usize;
            let left = ((t - 0.5).max(0.0) / 0.05).round() as usize;
            assert_eq!(out + flowing, layers * each, "{dimensions}: {t}");
            assert!(out.abs_diff(left * each) <= each, "{dimensions}: {t}, {out}");
        }
    }
}

/// A tank empties through a slit in its floor: the root of the level falls in proportion to time
/// (Torricelli), and the water that passes is 0.6 to 1 of area times (2 g h)^(1/2).
#[test]
fn a_tank_empties() {
    let scene = described(
        "gravity = [0, -10, 0]
        [[fluid]]
        dimensions = 2
        size = [1, 0.8, 0]
        spacing = 0.04
        at = [0.5, 0.4, 0]
        density = 1000
        sound = 40
        viscosity = 0.02
        tank = { size = [1, 1, 0], at = [0.5, 0.5, 0] }
        outflow = [{ size = [0.12, 0.2, 0], at = [0.5, -0.1, 0] }]",
    );
    let mut run = Simulation::new(scene, method("verlet"), Control::Step(5e-4)).unwrap();
    let mut root = || {
        run.advance_to(run.time() + 0.3).unwrap();
        (counts(&run)[1] as f64 * 0.04 * 0.04).sqrt()
    };
    let roots = [(); 5].map(|()| root());
    let falls: Vec<f64> = roots.windows(2).map(|two| two[0] - two[1]).collect();
    let mean = falls.iter().sum::<f64>() / 4.0;
    for fall in &falls {
        assert!((fall / mean - 1.0).abs() < 0.15, "{falls:?}");
    }
    let passed = mean / (0.3 * 0.12 * 5_f64.sqrt());
    assert!((0.61..1.0).contains(&passed), "{passed}");
}
