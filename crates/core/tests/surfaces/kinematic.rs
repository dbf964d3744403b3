//! The collision safeguard with kinematic vertices: pins that move past surfaces, and pins that
//! leave no room.

use a3_core::contact::{Obstacle, Shape, Skin};
use a3_core::{Cause, Control, Error, Model, Network, Path, Scene, Simulation, Touch, Vector3};

use crate::common::method;

/// Step (s).
const STEP: f64 = 0.002;

/// A run of particles that fly from one place to another in a step; those in `led` are pinned. A
/// triangle connects the last three, and an edge the first two. No force acts.
fn flight(ways: &[[[f64; 3]; 2]; 5], led: &[usize]) -> Simulation {
    let mut network = Network::new(vec![0.001; 5]).unwrap();
    network.set_triangles([[2, 3, 4]]).unwrap();
    for &i in led {
        let [from, to] = ways[i].map(Vector3::from);
        let (start, end) = (0.0, STEP);
        let path = Path::Line { from, to, start, end };
        network.pin(i, path).unwrap();
    }
    let skin = Skin { thickness: 0.02, stiffness: 1e-9, ..Skin::default() };
    let touch = Touch { skins: vec![skin; 5], edges: vec![[0, 1]], drops: vec![], bodies: true };
    network.set_touch(Some(touch)).unwrap();
    let place = |axis: usize, i: usize| ways[i][0][axis];
    let speed = |axis: usize, i: usize| (ways[i][1][axis] - ways[i][0][axis]) / STEP;
    let all = |f: &dyn Fn(usize, usize) -> f64| {
        let entries = (0..3).flat_map(|axis| (0..5).map(move |i| (axis, i)));
        entries.map(|(axis, i)| f(axis, i)).collect::<Vec<_>>()
    };
    let state = [all(&place), all(&speed)].concat();
    let scene = Scene::new("flight", Model::Network(Box::new(network)), state);
    Simulation::new(scene, method("verlet"), Control::Step(STEP)).unwrap()
}

/// An edge of pins that rotates past a long triangle comes near it, moves away, and crosses it
/// later in the same step.
#[test]
fn what_comes_near_and_parts_is_followed_to_the_end_of_the_step() {
    let mut run = flight(
        &[
            [
                [-0.118_712_350_800_248_88, 0.643_745_713_163_718, -0.323_086_207_942_433_37],
                [-0.119_859_905_527_565_23, 0.643_031_747_506_402, -0.324_264_199_807_394_35],
            ],
            [
                [0.100_378_959_284_346_43, 1.0, 0.261_542_013_498_336_6],
                [0.100_378_959_284_346_43, 1.0, 0.261_530_846_974_942_67],
            ],
            [
                [0.009_342_508_704_774_606, 0.967_544_453_790_258_1, 0.207_152_386_216_788_75],
                [0.006_233_714_101_509_009, 0.978_824_802_405_873_4, 0.199_683_551_389_946_28],
            ],
            [
                [-0.013_264_690_130_954_465, 0.968_239_745_936_303_1, 0.260_338_295_856_388_85],
                [-0.018_922_058_162_956_883, 0.966_605_090_876_933_7, 0.264_793_248_344_899],
            ],
            [
                [-0.082_822_546_202_639_14, 0.683_272_692_893_820_9, -0.257_983_364_395_780_5],
                [-0.082_799_248_234_769_99, 0.680_520_197_766_944_2, -0.258_156_306_025_637_44],
            ],
        ],
        &[0, 1],
    );
    run.take_steps(1).unwrap();
    let x = &run.state()[..15];
    assert_eq!(run.model().network().unwrap().crossed(STEP, x), []);
}

/// A ball that moves into a pin leaves no room, and the run reports that instead of passing
/// through.
#[test]
fn what_is_led_through_a_pin_ends_the_run() {
    let still = |x: f64, y: f64, z: f64| [[x, y, z]; 2];
    let run = flight(
        &[
            still(0.0, 0.0, 0.0),
            still(1.0, 0.0, 0.0),
            still(5.0, 0.0, 0.0),
            still(6.0, 0.0, 0.0),
            still(5.0, 1.0, 0.0),
        ],
        &[0, 1, 2, 3, 4],
    );
    let mut scene = run.scene().clone();
    if let Model::Network(network) = &mut scene.model {
        let path = Path::Line {
            from: Vector3::new(0.0, 1.0, 0.0),
            to: Vector3::new(0.0, -1.0, 0.0),
            start: 0.0,
            end: 1.0,
        };
        let ball = Obstacle::smooth(Shape::Sphere { radius: 0.2 }, path);
        network.add_obstacle(ball).unwrap();
    }
    let mut run = Simulation::new(scene, method("verlet"), Control::Step(0.01)).unwrap();
    let Err(Error::BlowUp(lost)) = run.advance_to(1.0) else {
        panic!("the ball went through the pin");
    };
    assert!(matches!(lost.cause, Cause::Pinched { .. }), "{lost}");
    assert!((lost.time - 0.4).abs() < 0.011, "{lost}");
}
