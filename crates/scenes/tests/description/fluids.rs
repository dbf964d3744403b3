//! Fluids: the places of their particles and walls, and their faults.

use a3_core::Mechanics;

use super::*;

/// A fluid has its particles in the middle of the cells of its box, and walls on the same lattice
/// around the sides and the bottom of its tank.
#[test]
fn fluids_stand_in_tanks() {
    let text = "[[fluid]]\nsize = [0.4, 0.2, 0.2]\nspacing = 0.1\nat = [0.2, 0.1, 0.1]\n\
        density = 500\nsound = 10\nvelocity = [1, 0, 0]\nstrain = [0, 2, 0]\n\
        tank = { size = [0.5, 0.3, 0.2], at = [0.25, 0.15, 0.1] }";
    let setup = set_up(text).unwrap();
    let scene = setup.scene;
    let network = scene.model.network().unwrap();
    let walls = 11 * 6 * 8 - 5 * 3 * 2;
    assert_eq!(network.particles(), 16 + walls);
    assert_eq!(setup.presentation.tanks, vec![16..16 + walls; 1]);
    assert_eq!(network.pins().count(), walls);
    assert!(network.is_wall(16) && !network.is_wall(0));
    assert!(network.masses().iter().all(|m| (m - 0.5).abs() < 1e-12));
    let n = network.particles();
    let first: Vec<f64> = (0..6).map(|k| scene.state[k * n]).collect();
    let expected = [0.05, 0.05, 0.05, 1.0, -0.1, 0.0];
    for (number, expected) in first.iter().zip(expected) {
        assert!((number - expected).abs() < 1e-12, "{first:?}");
    }
    let fluid = network.fluid().unwrap();
    let x = &scene.state[..3 * n];
    let (_, nearest) = fluid.nearest_pair(x).unwrap();
    assert!((nearest - 0.1).abs() < 1e-12);
    // A particle with all its neighbours has the rest density.
    let inside = fluid.densities(x)[0];
    assert!(inside < 500.0 && inside > 400.0, "{inside}");
}

/// Changes of a fluid in a tank, with the messages.
const WRONG_FLUID: &str = r#"
density = 1000
    density = 0 => line 6: fluid.density: it must be a finite number above 0
sound = 45
    sound = -45 => line 7: fluid.sound: it must be a finite number above 0
     => line 1: fluid: the key `sound` is missing
    sound = 45\nviscosity = -1 => line 8: fluid.viscosity: it must be a finite number of at least 0
    sound = 45\nshape = "cone" => line 8: fluid.shape:
spacing = 0.125
    spacing = 0.13 =>
        line 3: fluid.size: each edge must be a whole multiple of the spacing 0.13, not 1
    spacing = 1e-5 => line 1: fluid: the scene would have 20002700018 particles
[4, 2.5, 0]
    [4, 2.51, 0] => line 8: fluid.tank.size: each edge must be a whole multiple
[1, 2, 0]
    [1, 2, 1] => line 3: fluid.size: in two dimensions, its last number is 0, not 1
dimensions = 2
    dimensions = 4 => line 2: fluid.dimensions: it must be 2 or 3, not 4
at = [0.5, 1, 0]
    at = [0.4, 1, 0] =>
        line 5: fluid.at: the fluid would reach from x = -0.09999999999999998 to 0.9, outside the tank's walls at 0 and 4
    at = [0.5, 0.9, 0] => line 5: fluid.at: the fluid would reach from y = -0.09999999999999998
tank = { size = [4, 2.5, 0], at = [2, 1.25, 0] }
    [[body]]\nparts = [{ box = [0.5, 0.5, 1] }]\ndensity = 500\nat = [0.5, 1, 0] =>
        line 8: body: a point of it and a particle of the liquid would begin
"#;

#[test]
fn what_is_wrong_with_a_fluid_is_said() {
    let fluid = "[[fluid]]
dimensions = 2
size = [1, 2, 0]
spacing = 0.125
at = [0.5, 1, 0]
density = 1000
sound = 45
tank = { size = [4, 2.5, 0], at = [2, 1.25, 0] }
";
    refused(fluid, WRONG_FLUID, said);
    let (alone, _) = fluid.split_once("tank").unwrap();
    let moved = |x: &str| alone.replace("at = [0.5", &format!("at = [{x}"));
    assert!(build(&(fluid.to_owned() + &moved("2.5"))).is_ok());
    let near = alone.to_owned() + &moved("0.55");
    assert!(said(&near).starts_with("line 1: fluid: particles 0 and 128 would begin 0.05"));
    let other = fluid.to_owned() + &moved("2.5").replace("sound = 45", "sound = 40");
    assert!(said(&other).starts_with("line 9: fluid.1: all fluids of a scene are one liquid"));
}

/// A tank into which liquid flows through its left wall, and then no more.
const FILLED: &str = "[[fluid]]
dimensions = 2
size = [0, 0, 0]
spacing = 0.125
at = [0, 0, 0]
density = 1000
sound = 45
tank = { size = [4, 2.5, 0], at = [2, 1.25, 0] }
inflow = { size = [0, 0.5, 0], at = [0, 1, 0], velocity = [2, 0, 0], duration = 1 }
";

/// Sixteen layers flow in, one each 1/16 s, and three more close the hole in the wall.
#[test]
fn liquid_flows_in_through_a_hole_in_the_wall() {
    let setup = set_up(FILLED).unwrap();
    let network = setup.scene.model.network().unwrap();
    let (column, hole) = (4 * (16 + 3), 4 * 3);
    let walls = 38 * 23 - 32 * 20 - hole;
    assert_eq!(network.particles(), column + walls);
    let pins: Vec<_> = network.all_pins().take(column).collect();
    for pin in &pins {
        let x = pin.path.at(0.0).position.x;
        let layer = (-x / 0.125 - 0.5).round();
        let until = (layer < 16.0).then_some((layer + 0.5) / 16.0);
        assert_eq!(pin.until, until, "{x}");
        let stops = -0.125 * (layer - 16.0 + 0.5);
        let stays = (pin.at(2.0).position.x - stops).abs() < 1e-12;
        assert!(layer < 16.0 || stays, "{layer}: {:?}", pin.at(2.0));
    }
    let mut times: Vec<_> = pins.iter().filter_map(|pin| pin.until).collect();
    times.dedup();
    times.sort_by(f64::total_cmp);
    times.dedup();
    assert_eq!(times.len(), 16);
}

/// Changes of that inflow, with the messages.
const WRONG_INFLOW: &str = r"
velocity = [2, 0, 0]
    velocity = [0, 0, 0] =>
        line 9: fluid.inflow.velocity: it must be along one of the axes x, y, not
    velocity = [0, 0, 1] =>
        line 9: fluid.inflow.velocity: it must be along one of the axes x, y, not
    velocity = [2, 1, 0] => line 9: fluid.inflow.velocity: it must be along
    velocity = [0, -2, 0] =>
        line 9: fluid.inflow.size: along the velocity, the opening has the length 0, not 0.5
size = [0, 0.5, 0]
    size = [0, 0.45, 0] =>
        line 9: fluid.inflow.size: each edge must be a whole multiple of the spacing
    size = [0, 0, 0] => line 9: fluid.inflow.size: each edge must be a finite number above 0
duration = 1
    duration = -1 => line 9: fluid.inflow.duration: it must be a finite number above 0
    duration = 1e9 => line 1: fluid: the scene would have 64000000246 particles, which take
    duration = 1, ahead = -1 => line 9: fluid.inflow.ahead: it must be a finite number of at least 0
";

#[test]
fn what_is_wrong_with_an_inflow_is_said() {
    refused(FILLED, WRONG_INFLOW, said);
    let without = FILLED.replacen("inflow", "# ", 1);
    assert!(said(&without).starts_with("line 3: fluid.size: each edge must be"));
}

/// A box in which a fluid leaves the scene makes a hole in the walls of the tank, and what begins
/// there has left.
#[test]
fn outflows_open_walls() {
    let outflow = "outflow = [{ size = [0.25, 0.375, 0], at = [2, -0.1875, 0] }]\n";
    let text = FILLED.replacen("inflow", &format!("{outflow}# "), 1);
    let text = text.replacen("size = [0, 0, 0]", "size = [0.25, 0.25, 0]", 1);
    let text = text.replacen("at = [0, 0, 0]", "at = [0.125, 0.125, 0]", 1);
    let fluid = |text: &str| set_up(text).unwrap().scene.model;
    let (open, closed) = (fluid(&text), fluid(&text.replacen("outflow", "# ", 1)));
    assert_eq!(open.particles() + 2 * 3, closed.particles());
    let liquid = open.network().unwrap().fluid().unwrap();
    assert!(liquid.members().drained().is_empty());
    let within = text.replacen("at = [2, -0.1875, 0]", "at = [0, 0.1, 0]", 1);
    let within = fluid(&within);
    let network = within.network().unwrap();
    let drained = network.fluid().unwrap().members().drained();
    assert!(drained.len() == 2 && drained.iter().all(|i| network.is_pinned(*i as usize)));
    let wrong = r"
size = [0.25, 0.375, 0]
    size = [0.25, 0, 0] => ... outflow[0].size: each edge must be a finite number above 0
    size = [0.25, 0.375, 1] =>
        ... outflow[0].size: in two dimensions, its last number is 0, not 1
at = [2, -0.1875, 0]
    to = 3 => ... outflow";
    refused(&text, wrong, said);
    let more = "{ size = [1, 1, 0], at = [9, 9, 0] },".repeat(100);
    let many = text.replacen("outflow = [", &format!("outflow = [{more}"), 1);
    assert!(said(&many).contains("fluid: there are 101 outflows, more than 100"));
}

/// What has flowed in before the start has flown straight on, at its distance from all else, and a
/// swing leaves the column as it is.
#[test]
fn a_flow_may_have_begun_before() {
    let ahead = FILLED.replacen("duration = 1 }", "duration = 1, ahead = 0.4 }", 1);
    let swing = "[swing]\namplitude = [0.1, 0, 0]\nrate = 3\n";
    for text in [ahead.clone(), ahead.replacen("[[fluid]]", &format!("{swing}[[fluid]]"), 1)] {
        let scene = set_up(&text).unwrap().scene;
        let n = scene.model.particles();
        let network = scene.model.network().unwrap();
        let fluid = network.fluid().unwrap();
        let (_, nearest) = fluid.nearest_pair(&scene.state[..3 * n]).unwrap();
        assert!(nearest > 0.9 * fluid.law().spacing, "{nearest}");
        // Layers that have flown for 0.4 s at 2 m/s, less half of one.
        let farthest = scene.state[..n].iter().zip(network.inverse_masses());
        let farthest = farthest.filter(|(_, w)| **w > 0.0).map(|(x, _)| *x);
        let farthest = farthest.fold(f64::NEG_INFINITY, f64::max);
        assert!((farthest - (0.8 - 0.0625)).abs() < 1e-9, "{farthest}");
        let mut run = run(scene, "verlet", 0.001);
        run.set_swinging(true);
        run.advance_to(0.7).unwrap();
        let network = run.model().network().unwrap();
        // Sixteen layers in all, of four particles; the three last ones close the hole.
        assert_eq!((0..n).filter(|i| !network.is_pinned(*i)).count(), 4 * 16);
    }
}

/// Cups with walls too thin to hold the liquid are named. Plates that float, and cups with walls
/// that are thick enough, are not.
#[test]
fn cups_that_leak_are_named() {
    let notes = |parts: &str, dimensions: u8| {
        let size = [0.36, 0.36, if dimensions == 2 { 0.0 } else { 0.36 }];
        let setup = set_up(&format!(
            "[[body]]\nparts = [{parts}]\ndensity = 2000\nat = [0, -1, 0]\n\
             [[fluid]]\ndimensions = {dimensions}\nsize = {size:?}\nspacing = 0.04\n\
             at = [0, 0.5, 0]\ndensity = 1000\nsound = 30"
        ));
        setup.unwrap().presentation.notes.clone()
    };
    let cup = |thickness: f64| {
        let wall = |x: f64| format!("{{ box = [{thickness}, 0.6, 1], at = [{x}, 0.3, 0] }}");
        let walls = [wall(-0.4), wall(0.4)].join(", ");
        format!("{{ box = [0.9, {thickness}, 1] }}, {walls}")
    };
    for dimensions in [2, 3] {
        for thickness in [0.01, 0.02, 0.04, 0.06] {
            let told = &notes(&cup(thickness), dimensions)[0];
            let whole = "body: the liquid can pass through walls that are only ";
            let whole = format!("{whole}{thickness:.2} m thick");
            assert!(told.starts_with(&whole), "{told}");
            assert!(told.contains("at least 0.08 m thick, 2 spacings"), "{told}");
        }
        for holds in [
            cup(0.08),
            cup(0.1),
            "{ box = [0.6, 0.05, 1] }".into(),
            "{ ball = 0.06 }".into(),
            // A hull with a mast.
            "{ box = [0.6, 0.2, 1] }, { box = [0.02, 0.5, 0.02], at = [0, 0.3, 0] }".into(),
        ] {
            assert_eq!(notes(&holds, dimensions), Vec::<String>::new(), "{holds}");
        }
        // A film between the layers of the lattice, which no liquid feels.
        let told = &notes("{ box = [0.6, 0.005, 1] }", 2)[0];
        let thin = "body: it is too thin for the liquid to feel it";
        assert!(told.starts_with(thin), "{told}");
    }
}
