//! Faults have a line and a key, in any text.

use a3_scenes::SCENES;

use super::*;

/// Changes of the cloth, with the messages.
const WRONG: &str = r#"
spacing = 0.5
    spacing = -0.5 => line 5: cloth.spacing: it must be a finite number above 0, not -0.5
    spacing = nan => line 5: cloth.spacing: it must be a number from -1e13 to 1e13
    spacng = 0.5 =>
        line 5: cloth.spacng: there is no key `spacng`; did you mean `spacing`? The valid keys are grid,
     => line 3: cloth: one of the keys `width` and `spacing` is needed
    spacing = 0.5\nwidth = 1 => line 5: cloth.spacing: give either `width` or `spacing`
grid = [3, 4]
     => line 3: cloth: the key `grid` is missing
    grid = [1, 4] => line 4: cloth.grid: a grid has at least 2x2
    grid = [4294967295, 4294967295] => line 4: cloth.grid: a grid has at least 2x2
    grid = "big" =>
        line 4: cloth.grid: it must be a list of 2 numbers in square brackets, not the text "big"
stiffness = [10, 5, 2]
    stiffness = [10, 5] => line 7: cloth.stiffness:
    stiffness = [10, 5, inf] =>
        line 7: cloth.stiffness: it must be a number from -1e13 to 1e13, not inf
mass = 0.1
    mass = 0 => line 6: cloth.mass: it must be a finite number above 0, not 0
at = [0, 2, 0]
    at = [0, 2e300, 0] => line 8: cloth.at: it must be a number from -1e13 to 1e13
    right = [0, 0, 0] => line 8: cloth.right: it must be a direction
    right = [0, 1, 0] => line 8: cloth.right: `right` and `down` must be perpendicular
    pin = [{ at = ["tpo"] }] => line 8: cloth.pin.at: there is no `tpo`; did you mean `top`?
    pin = [{ at = ["first"] }] => line 8: cloth.pin.at: a cloth has top, bottom
    pin = [{ particles = [12] }] =>
        line 8: cloth.pin.particles: there is no particle 12: they are numbered 0 to 11
    pin = [{}] => line 8: cloth.pin: the pin holds nothing
gravity = [0, -9.81, 0]
    gravty = [0, 0, 0] => line 1: gravty: there is no key `gravty`; did you mean `gravity`?
    solver = "rk5" => line 1: solver: there is no `rk5`; did you mean `rk4`? The choices are euler,
    step = 0.1 => line 1: step: a step also needs the key `solver`
    solver = "r"\nstep = 0 => line 2: step: it must be a finite number above 0
    tear = 0.5 => line 1: tear:
[10, 5, 2]
    [10, 5, 2]\nstrain_limit = 1 =>
        line 8: cloth.strain_limit: the limit of strain must be a finite number above 1
gravity = [0, -9.81, 0]
    torn = [[0, 1], [0, 700]] => line 1: torn: there is no spring between particles 0 and 700
    trail = 12 => line 1: trail: there is no particle 12
    springs = [[0, 12, 1, 1, 0]] =>
        line 1: springs: spring 0, counted from 0: 0 and 12 must be two different particles from 0 to 11
    wind = { force = [1, 0, 0], velocity = [1, 0, 0] } => line 1: wind: give one of the keys
    sphere = [{ center = [0, 0, 0], radius = -1 }] =>
        line 1: sphere.radius: it must be a finite number above 0
    sphere = [{ center = [0, 0, 0], radius = 1, friction = -0.1 }] =>
        line 1: sphere.friction: it must be a finite number of at least 0, not -0.1
    box = [{ center = [0, 0, 0], size = [1, 1, 1] }, { center = [0, 0, 0], size = [1, 1, 1], friction = nan }] =>
        line 1: box.1.friction: it must be a number from -1e13 to 1e13, not NaN
    box = [{ center = [0, 0, 0], size = [1, 1, 1], turn = { axis = [0, 0, 0], rate = 1 } }] =>
        line 1: box.turn.axis: it must be a direction, not [0, 0, 0]
    box = [{ center = [0, 0, 0], size = [1, 1, 1], turn = { axis = [0, 1, 0] } }] =>
        line 1: box.turn: one of the keys `rate` and `angle` is needed
    box = [{ center = [0, 0, 0], size = [1, 1, 1], turn = { axis = [0, 1, 0], rate = 1, angle = 2, end = 1 } }] =>
        line 1: box.turn.angle: give either `rate` or `angle`, not both
    box = [{ center = [0, 0, 0], size = [1, 1, 1], turn = { axis = [0, 1, 0], angle = 2 } }] =>
        line 1: box.turn.end: with an `angle`, it is needed
    box = [{ center = [0, 0, 0], size = [1, 1, 1], turn = { axis = [0, 1, 0], rate = 2, start = 1, end = 1 } }] =>
        line 1: box.turn.end: it must be later than 1 s, not 1
    sphere = [{ center = [0, 0, 0], radius = 1, sine = { amplitude = [1, 0, 0], rate = 1 }, turn = { about = [1, 0, 0], axis = [0, 1, 0], rate = 1 } }] =>
        line 1: sphere.turn.about: give either `sine` or `turn.about`, not both
    chain = [{ particles = 3, from = [1, 1, 1], to = [1, 1, 1], mass = 1, stiffness = 1 }] =>
        line 1: chain.to: a chain leads to another point than `from`
    pin = [{ particles = [0], until = 0 }] => line 1: pin.until: it must be a finite number above 0
    pin = [{ particles = [0], body = 0, until = 1 }] =>
        line 1: pin.until: what is attached to a body stays so
    pin = [{ particles = [0], turn = { axis = [0, 1, 0], rate = 2 } }] =>
        line 1: pin.turn.about: the turn of a pin needs it
    obstacle = [{ file = 'square.obj' }] =>
        line 1: obstacle.file: a closed mesh has two triangles at each edge, but at that from point 0 at (0, 0, 0) to point 1 at (1, 0, 0) not 1
    obstacle = [{ file = 'none.obj' }] => line 1: obstacle.file: none.obj: there is no such file
    obstacle = [{ file = 'square.obj', scale = 0 }] =>
        line 1: obstacle.scale: it must be a finite number above 0, not 0
    floor = { height = 0, friction = inf } =>
        line 1: floor.friction: it must be a number from -1e13 to 1e13, not inf
    floor = { height = 0, frition = 0.4 } =>
        line 1: floor.frition: there is no key `frition`; did you mean `friction`? The valid keys are height, friction
    floor = { friction = 0.4 } => line 1: floor: the key `height` is missing
    floor = true =>
        line 1: floor: it must be a height (m), or a table with the keys `height` and `friction`, not true
    circle = { start = [1, 0, 0] } =>
        line 1: circle: a circle is a first-order system and must be the only body
    gravity = [0, -9.81, 0 => line 3:
"#;

#[test]
fn what_is_wrong_is_said_with_line_and_key() {
    assert!(build(CLOTH).is_ok());
    refused(CLOTH, WRONG, said);
    let (_, body) = CLOTH.split_once("\n\n").unwrap();
    let second = body.replace("mass = 0.1", "mass = -1");
    assert!(said(&format!("{CLOTH}\n{second}")).starts_with("line 13: cloth.1.mass: "));
    assert!(said("").contains("the scene is empty: it needs at least one of cloth"));
}

/// Sizes are checked before memory is reserved.
#[test]
fn what_is_too_much_is_refused_at_once() {
    let begun = std::time::Instant::now();
    let jelly = |grid: &str| {
        format!(
            "[[jelly]]\ngrid = {grid}\nsize = [1, 1, 1]\nmass = 1\nstiffness = [1, 1, 1]\nat = [0, 0, 0]"
        )
    };
    for (text, expected) in [
        (jelly("[100000, 100000, 100000]"), "line 1: jelly: the scene would have"),
        (jelly("[9223372036854775807, 9223372036854775807, 3]"), "line 2: jelly.grid: "),
        (jelly("[100, 100, 100]"), "line 1: jelly: the scene would have 1000000 particles, which take 343 MiB"),
        ("[[chain]]\nparticles = 99999999999\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nmass = 1\nstiffness = 1".into(), "line 1: chain: the scene would have 99999999999 particles"),
    ] {
        assert!(said(&text).starts_with(expected), "{}", said(&text));
    }
    let deep = format!("a = {}", "[".repeat(100_000));
    assert!(said(&deep).starts_with("line 1: "), "{}", said(&deep));
    assert!(begun.elapsed().as_secs() < 5);
}

/// Texts that are damaged at random are read or refused without a panic, and the forces of a scene
/// that is read are finite.
#[test]
fn damaged_texts_are_refused_or_read() {
    let mut share = random(1);
    let mut random = |below: usize| (share() * below as f64) as usize;
    let words = "-1 0 nan 1e400 [ ] {} \" = \n 999999999999 [[cloth]] true é";
    let words: Vec<_> = words.split(' ').collect();
    let (mut refused, mut read) = (0, 0);
    for k in 0..4000 {
        let mut text: Vec<char> = SCENES[k % SCENES.len()].text.chars().collect();
        for _ in 0..=random(3) {
            let at = random(text.len().max(1));
            match random(3) {
                0 if at < text.len() => drop(text.remove(at)),
                1 => text.truncate(at.max(1)),
                _ => drop(text.splice(at..at, words[random(words.len())].chars())),
            }
        }
        let text: String = text.into_iter().collect();
        match build(&text) {
            Err(fault) => {
                let is_line = !fault.why.is_empty() && !fault.to_string().contains('\n');
                assert!(is_line, "{fault}");
                refused += 1;
            }
            Ok(scene) => {
                let system = scene.model.system();
                if system.dim() < 10_000 {
                    let mut f = vec![0.0; system.dim()];
                    system.eval_f(0.0, &scene.state, &mut f);
                    assert!(f.iter().all(|f| f.is_finite()), "{text}");
                }
                read += 1;
            }
        }
    }
    assert!(refused > 500 && read > 500, "{refused} {read}");
}
