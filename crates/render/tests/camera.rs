//! Places of points in pictures, and back.

use a3_render::Camera;

fn assert_near(a: [f32; 3], b: [f32; 3]) {
    assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-4), "{a:?} {b:?}");
}

/// The focus shows what a picture of its size would, and places in it are found again.
#[test]
fn the_focus_is_a_picture_in_the_picture() {
    for aspect in [0.5, 1.7] {
        for parallel in [false, true] {
            let mut camera = Camera::look_at([3.0, 2.0, 5.0], [0.1, 1.0, -0.2]);
            camera.set_parallel(parallel);
            let whole = camera;
            let [left, top, width, height] = [0.25, 0.1, 0.6, 0.8];
            camera.set_focus([left, top, width, height]);
            assert!(whole != camera && whole.shows_as(&camera));
            for point in [[0.1, 1.0, -0.2], [1.0, 2.0, 0.5], [-0.4, 0.3, -1.0]] {
                let (part, _) = whole.project(point, aspect * width / height).unwrap();
                let (at, depth) = camera.project(point, aspect).unwrap();
                let expected = [left + width * part[0], top + height * part[1]];
                assert!((0..2).all(|k| (at[k] - expected[k]).abs() < 1e-5), "{at:?}");
                let back = camera.unproject(at, depth, aspect);
                assert_near(point, back);
            }
            let ([_, before], _) = camera.project([0.1, 1.0, -0.2], aspect).unwrap();
            let mut panned = camera;
            panned.pan(0.0, 0.1);
            assert!(!whole.shows_as(&panned));
            let ([_, after], _) = panned.project([0.1, 1.0, -0.2], aspect).unwrap();
            if aspect > 1.0 {
                assert!((after - before - 0.1).abs() < 0.01, "{before} {after}");
            }
        }
    }
}

#[test]
fn projecting_and_back() {
    let camera = Camera::look_at([3.0, 2.0, 5.0], [0.1, 1.0, -0.2]);
    for aspect in [0.4, 1.0, 1.7] {
        for point in [[0.0, 0.0, 0.0], [1.0, 2.0, 0.5], [-1.0, 0.3, -3.0]] {
            let (at, distance) = camera.project(point, aspect).unwrap();
            let back = camera.unproject(at, distance, aspect);
            assert_near(point, back);
        }
    }
    let ([x, y], _) = camera.project([0.1, 1.0, -0.2], 1.5).unwrap();
    let off = (x - 0.5).abs().max((y - 0.5).abs());
    assert!(off < 1e-5, "the target is in the middle: {x} {y}");
    assert_eq!(camera.project([6.0, 4.0, 10.0], 1.0), None);
}
