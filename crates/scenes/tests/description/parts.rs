//! Parts of scenes that can be left out.

use a3_scenes::{Description, parts, without};

fn names(text: &str) -> Vec<String> {
    let parts = parts(&Description::parse(text).unwrap());
    parts.into_iter().map(|part| part.name).collect()
}

#[test]
fn a_scene_has_the_parts_that_it_names() {
    let chain =
        "[[chain]]\nparticles = 3\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nmass = 1\nstiffness = 9\n";
    assert_eq!(names(chain), ["springs of chains: rods"]);
    let more = format!(
        "drag = 0.1\ntear = 2.0\nfloor = {{ height = -1, friction = 0.5 }}\n{chain}damping = 0.1\n"
    );
    let all =
        "drag, damping of springs and solids, tearing, friction, floor, springs of chains: rods";
    assert_eq!(names(&more).join(", "), all);
}

#[test]
fn obstacles_are_left_out_by_their_numbers() {
    let ball = |x: i32| format!("[[sphere]]\ncenter = [{x}, 0, 0]\nradius = 1\n");
    let scene = Description::parse(&(0..3).map(ball).collect::<String>()).unwrap();
    let parts = parts(&scene);
    let left = without(&scene, [&parts[0], &parts[2]]);
    assert_eq!(left.sphere, [scene.sphere[1].clone()]);
}
