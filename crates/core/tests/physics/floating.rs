//! Rigid bodies in a fluid: Archimedes' principle, and conserved momenta.

use a3_core::{Control, Scene, Simulation, Vector3};

use crate::common::{described, method};

fn run(scene: Scene, step: f64) -> Simulation {
    Simulation::new(scene, method("verlet"), Control::Step(step)).unwrap()
}

/// A raft of half the water's density floats half below the surface, whose height follows from the
/// volumes of both; the water's weight compresses it a little. A heavy one sinks.
#[test]
fn a_raft_displaces_its_weight() {
    let raft = |density: f64| {
        described(&format!(
            "gravity = [0, -9.81, 0]
            [[body]]
            parts = [{{ box = [0.4, 0.2, 1] }}]
            density = {density}
            at = [0, 0.5, 0]
            [[fluid]]
            dimensions = 2
            size = [0.8, 0.4, 0]
            spacing = 0.025
            at = [0, 0.2, 0]
            density = 1000
            sound = 20
            viscosity = 0.04
            tank = {{ size = [0.8, 0.8, 0], at = [0, 0.4, 0] }}"
        ))
    };
    let scene = raft(500.0);
    let center = scene.model.network().unwrap().bodies()[0].center();
    let mut floating = run(scene, 1e-3);
    let level = (0.8 * 0.4 + 0.4 * 0.1) / 0.8;
    let level = level - 9.81 * level * level / (2.0 * 20.0 * 20.0);
    floating.advance_to(2.4).unwrap();
    let off = floating.position(center).y - level;
    assert!(off.abs() < 0.02 * 0.1, "{off} m of a draught of 0.1 m");
    let mut sinking = run(raft(3000.0), 1e-3);
    sinking.advance_to(0.8).unwrap();
    let height = sinking.position(center).y;
    assert!(height < 0.25, "{height}");
}

/// A box that flies into a blob and turns there keeps the momentum and the angular momentum of
/// both together, in two dimensions and in three.
#[test]
fn a_body_and_a_blob_keep_their_momenta() {
    for (dimensions, depth) in [(2, 0.0), (3, 0.4)] {
        let scene = described(&format!(
            "[[body]]
            parts = [{{ box = [0.3, 0.2, 1] }}]
            density = 700
            at = [-0.55, 0.1, 0]
            velocity = [2, 0.2, 0]
            spin = [0, 0, 3]
            [[fluid]]
            shape = 'ball'
            dimensions = {dimensions}
            size = [0.6, 0.6, {depth}]
            spacing = 0.1
            at = [0, 0, 0]
            density = 1000
            sound = 20
            viscosity = 0.02"
        ));
        let mut run = run(scene, 2e-3);
        let momenta = |run: &Simulation| {
            let network = run.model().network().unwrap();
            let (n, v) = (run.particles(), run.velocities());
            let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
            for (i, mass) in network.masses().iter().enumerate() {
                if !network.is_carried(i) {
                    let p = *mass * Vector3::new(v[i], v[n + i], v[2 * n + i]);
                    linear += p;
                    angular += run.position(i).cross(&p);
                }
            }
            angular += network.rotation(0, run.state()).momentum;
            [linear, angular]
        };
        let (before, speed) = (momenta(&run), run.velocities()[0]);
        run.advance_to(0.4).unwrap();
        let after = momenta(&run);
        let scale: f64 = before[0].norm();
        for (a, b) in after.iter().zip(before) {
            assert!((a - b).norm() < 1e-11 * scale, "{a} {b}");
        }
        assert!(run.velocities()[0] < 0.9 * speed, "the body has hit the blob");
    }
}

/// The points of a body that the fluid touches have its volume, whatever its shape.
#[test]
fn a_ball_has_as_many_points_as_its_volume_has_cells() {
    for radius in [0.2, 0.24, 0.31] {
        let scene = described(&format!(
            "[[body]]
            parts = [{{ ball = {radius} }}]
            density = 500
            at = [0, 2, 0]
            [[fluid]]
            size = [0.5, 0.5, 0.5]
            spacing = 0.1
            at = [0, 0, 0]
            density = 1000
            sound = 20"
        ));
        let body = &scene.model.network().unwrap().bodies()[0];
        let count = body.points().len() - 1;
        let exact = 4.0 / 3.0 * std::f64::consts::PI * (radius / 0.1_f64).powi(3);
        // Three layers are all of these small balls; points of equal distance stay together.
        assert!((count as f64 - exact).abs() <= 12.5, "{count} of {exact}");
    }
}

/// Obstacles keep a fluid out also where surfaces touch: in a basin of thick walls, and beside a
/// body that floats in it.
#[test]
fn a_basin_of_obstacles_holds_water_where_surfaces_touch() {
    let basin = |thickness: &str, body: &str| {
        described(&format!(
            "gravity = [0, -9.81, 0]
            floor = {{ height = 0 {thickness} }}
            {body}
            [[box]]
            center = [0.45, 0.3, 0]
            size = [0.1, 1, 1]
            [[capsule]]
            from = [-0.5, -0.5, 0]
            to = [-0.5, 1, 0]
            radius = 0.1
            [[fluid]]
            dimensions = 2
            size = [0.6, 0.4, 0]
            spacing = 0.05
            at = [0, 0.3, 0]
            density = 1000
            sound = 20
            viscosity = 0.05"
        ))
    };
    let raft = "[[body]]\nparts = [{ box = [0.3, 0.1, 1] }]\ndensity = 500\nat = [0, 0.6, 0]\n";
    for scene in [basin(", thickness = 0.01", ""), basin("", raft)] {
        let mut run = run(scene, 1e-3);
        run.advance_to(0.6).unwrap();
        for i in 0..run.particles() {
            let x = run.position(i);
            let inside = x.y > -1e-9 && x.y < 0.9 && x.x > -0.401 && x.x < 0.401;
            assert!(inside, "particle {i} is at {x}");
        }
    }
}
