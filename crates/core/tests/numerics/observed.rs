//! Stability limits found by runs of the scenes, at rest and in motion, against those by modes.

use crate::common::{described, method, scene_with_grid};
use a3_core::integrators;
use a3_core::stability::{Budget, Motion, largest_step, observe_at_rest, rest};
use approx::assert_relative_eq;

/// Three particles on springs without rest length, whose motion is linear.
const LINEAR: &str = "
    gravity = [0, -9.81, 0]
    [particles]
    positions = [[0, 0, 0], [0.7, 0.2, 0], [1.2, -0.3, 0.4]]
    masses = [1, 0.5, 0.25]
    springs = [[0, 1, 30, 0, 0], [1, 2, 12, 0, 0]]
    pin = [{ particles = [0] }]
";

/// In linear motion the limits by the modes are exact, however large the errors: symplectic methods
/// are bounded far beyond the steps at which they are accurate.
#[test]
fn motion_is_bounded_where_it_is_not_accurate() {
    let scene = described(LINEAR);
    let motion = Motion::of(&scene, || true).unwrap().unwrap();
    assert_eq!(motion.predictable, 10.0);
    for name in ["rk4", "symplectic", "verlet", "pefrl", "dop853"] {
        let m = method(name);
        let limit = largest_step(m, &motion.modes).unwrap().unwrap().step;
        let seen = motion.bounded(m, &Budget::unlimited(), || true).unwrap().unwrap();
        assert!(seen.is_sharp(), "{name}: {seen:?}");
        assert_relative_eq!(seen.held, limit, max_relative = 0.03);
        let accurate =
            motion.accurate(m, seen.held, &Budget::unlimited(), || true).unwrap().unwrap();
        assert!(accurate < 0.7 * limit, "{name}: {accurate}");
        if name == "symplectic" {
            assert!(accurate < 0.05 * limit, "{name}: {accurate}");
        }
    }
    let euler = motion.bounded(method("euler"), &Budget::unlimited(), || true).unwrap().unwrap();
    assert!(euler.failed < euler.held, "{euler:?}");
    let implicit =
        motion.bounded(method("implicit"), &Budget::unlimited(), || true).unwrap().unwrap();
    assert_eq!((implicit.held, implicit.is_open()), (1.0, true));
}

/// Undamped chain of soft springs that falls: with Verlet's method it gains energy slowly already
/// at two thirds of the limit of its modes. The observed limit is smaller, and not sharp.
#[test]
fn slow_heating_in_motion_is_seen_and_marked() {
    let list = |count: u32, item: fn(f64) -> String| -> String {
        (0..count).map(|i| item(f64::from(i)) + ", ").collect()
    };
    let positions = list(8, |i| format!("[{}, 0, {}]", 0.3 * i, 0.05 * i.sin()));
    let springs = list(7, |i| format!("[{i}, {}, 10, 0.3, 0]", i + 1.0));
    let scene = described(&format!(
        "gravity = [0, -9.81, 0]
        [particles]
        positions = [{positions}]
        mass = 0.2
        springs = [{springs}]
        pin = [{{ particles = [0] }}]"
    ));
    let motion = Motion::of(&scene, || true).unwrap().unwrap();
    let verlet = method("verlet");
    let limit = largest_step(verlet, &motion.modes).unwrap().unwrap();
    assert!(limit.is_sharp());
    let seen = motion.bounded(verlet, &Budget::unlimited(), || true).unwrap().unwrap();
    assert!(
        (0.3..0.75).contains(&(seen.failed / limit.step)) && seen.failed < seen.held,
        "{seen:?} {limit:?}"
    );
}

/// Predicted limits agree with those observed on the nonlinear scene: the step at which a
/// disturbance of the cloth at rest begins to grow, and the step at which the falling cloth gains
/// energy.
#[test]
fn limits_are_seen_on_the_cloth() {
    let cloth = scene_with_grid("cloth", 8, 8);
    let rest = rest(&cloth, || true).unwrap().unwrap();
    let motion = Motion::of(&cloth, || true).unwrap().unwrap();
    for m in integrators::METHODS.iter().filter(|m| !m.positions_only() && !m.plain_only()) {
        let predicted = largest_step(m, &rest.modes).unwrap().unwrap();
        if m.needs_springs() {
            // With every step the cloth hangs elsewhere, and moving there is no growth.
            assert!(predicted.step.is_infinite(), "{}", m.name);
            continue;
        }
        let seen = observe_at_rest(&rest, m, Some(&predicted), &Budget::unlimited(), || true)
            .unwrap()
            .unwrap();
        if m.is_implicit() {
            assert!(predicted.step.is_infinite() && seen.is_open());
            continue;
        }
        let ratio = seen.held / predicted.step;
        assert!((0.98..1.01).contains(&ratio), "{} at rest: {ratio}", m.name);
        let in_motion = largest_step(m, &motion.modes).unwrap().unwrap();
        let seen = motion.bounded(m, &Budget::unlimited(), || true).unwrap().unwrap();
        // A fast mode may be over before it has grown. If a limit is not sharp, growth is so slow
        // that the cloth changes its shape first.
        let most = if seen.is_sharp() && in_motion.is_sharp() { 1.25 } else { 5.0 };
        let ratio = seen.held / in_motion.step;
        assert!((0.95..most).contains(&ratio), "{} falling: {ratio}, {seen:?}", m.name);
    }
}

/// A scene with moving pins has no state of rest, and a scene is brought to rest without tearing.
#[test]
fn rest_is_without_tears_and_not_of_what_moves() {
    let cloth = "
        gravity = [0, -9.81, 0]
        drag = 0.1
        tear = TEAR
        [[cloth]]
        grid = [4, 4]
        width = 1
        mass = 0.1
        stiffness = [40, 20, 5]
        pin = [{ at = [\"top\"] MOVES }]
    ";
    let build = |tear: &str, moves: &str| {
        let text = cloth.replace("TEAR", tear).replace("MOVES", moves);
        described(&text)
    };
    let [whole, torn] =
        ["100", "1.2"].map(|tear| rest(&build(tear, ""), || true).unwrap().unwrap());
    assert_eq!(whole.scene.state, torn.scene.state);
    assert_eq!(whole.modes, torn.modes);
    assert!(torn.scene.model.network().unwrap().tear_limit().is_none());
    let moves = ", shift = { by = [0, 0, 1], start = 0.1, end = 0.2 }";
    assert!(rest(&build("100", moves), || true).unwrap().is_none());
}

/// Boxes that stand on the floor far from one another, within a tenth of a millimetre of it: no
/// push on the way to rest lets them cross it.
#[test]
fn what_lies_close_comes_to_rest() {
    let body = |x: f64| {
        format!(
            "[[body]]
            parts = [{{ box = [0.4, 0.2, 0.4] }}]
            mass = 1
            at = [{x}, 0.10005, {x}]
            thickness = 0.0001\n"
        )
    };
    let text = "self_collision = true\ngravity = [0, -9.81, 0]\nfloor = 0\n";
    let scene = described(&(text.to_owned() + &body(0.0) + &body(2.0)));
    let rest = rest(&scene, || true).unwrap().expect("it comes to rest");
    let network = rest.scene.model.network().unwrap();
    network.check_apart(0.0, &rest.scene.state[..3 * network.particles()]).unwrap();
}

/// A small cloth whose motion is slower by a factor has a limit larger by that factor.
#[test]
fn limits_at_rest_do_not_depend_on_the_unit_of_time() {
    let limit = |slower: f64| {
        let scene = described(&format!(
            "gravity = [0, {}, 0]
            drag = {}
            [[cloth]]
            grid = [5, 6]
            spacing = 0.002
            mass = {}
            stiffness = [2, 1, 0.3]
            damping = {}
            down = [0, 0, 1]
            pin = [{{ particles = [0, 5] }}]",
            -9.81 / slower.powi(2),
            2e-5 * slower,
            2e-5 * slower.powi(2),
            1e-4 * slower,
        ));
        let rest = rest(&scene, || true).unwrap().expect("it comes to rest");
        let found = rest.largest_step(method("rk4")).unwrap();
        found.expect("a limit").step / slower
    };
    let own = limit(10.0);
    for slower in [0.1, 1.0] {
        assert_relative_eq!(limit(slower), own, max_relative = 0.01);
    }
}
