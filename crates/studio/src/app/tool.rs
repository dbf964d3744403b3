//! The tools at the pointer: the targets of clicks and drags, and the edits that they make.

use a3_core::{Constraint, Simulation, Vector3};
use a3_media::show::{Target, to_f32};
use a3_render::Camera;

use super::pick;
use super::pointer::Pointer;
use super::screen::Screen;
use crate::hud::edit::{self, Aim, Throw, click, join};
use crate::session::{Session, Tool};

/// Factor of the mass of a heavy ball.
const HEAVY: f64 = 10.0;
/// Factor of the speed that a drag by the height of the picture adds.
const PULL: f32 = 4.0;
/// Distance from the pointer within which a spring, a rod or a rope is found (points).
const LINK_DISTANCE: f32 = 9.0;
/// Share of a spring at either end in which its particle is found in its place.
const END: f32 = 0.25;
/// Share of its depth by which a spring may be behind a surface on which it lies.
const DEPTH_TOLERANCE: f32 = 1e-3;

/// Edits the scene after the button was released in pane `at`: where it clicked, or between the
/// particle `from` and that under the pointer.
pub fn release(
    pointer: &Pointer,
    from: Option<usize>,
    session: &mut Session,
    screen: &Screen,
    at: usize,
) {
    let other = || {
        pointer
            .hit(session, screen, at)
            .and_then(|(target, _)| target.particle())
    };
    match from.filter(|_| !pointer.is_click()) {
        Some(i) => {
            if let Some(j) = other() {
                join(session, [i, j]);
            } else {
                let why = "There is no particle here to join.";
                session.readings.say(why);
            }
        }
        None if pointer.is_click() => {
            let aim = aim(pointer, session, screen, at);
            click(session, &aim);
        }
        None if session.panel.editor.tool.throws() => {
            let height = screen.tile(session, at).height as f32;
            let how = Throw {
                speed: f64::from(1.0 + PULL * pointer.dragged() / height),
                ..Throw::default()
            };
            let aim = sight(pointer.position, session, screen, at);
            edit::throw(session, &aim, how);
        }
        None => {}
    }
}

/// Throws a light or a heavy ball to the pointer or, if that is elsewhere, into the picture.
pub fn throw(pointer: &Pointer, heavy: bool, session: &mut Session, screen: &Screen, at: usize) {
    let tile = screen.tile(session, at);
    let middle = [tile.x + tile.width / 2, tile.y + tile.height / 2].map(|px| px as f32);
    let is_over = pointer.is_over_picture(session, screen);
    let place = if is_over { pointer.position } else { middle };
    let aim = sight(place, session, screen, at);
    let mass = if heavy { HEAVY } else { 1.0 };
    let how = Throw {
        mass,
        ..Throw::default()
    };
    let chosen = std::mem::replace(&mut session.panel.editor.tool, Tool::ThrowBall);
    edit::throw(session, &aim, how);
    session.panel.editor.tool = chosen;
}

/// Returns where a line from particle i ends (m): at the pointer, or at the particle under it.
pub fn end(
    pointer: &Pointer,
    i: usize,
    session: &Session,
    screen: &Screen,
    at: usize,
) -> Option<Vector3<f64>> {
    let hit = pointer
        .hit(session, screen, at)
        .and_then(|(target, _)| target.particle());
    let tile = screen.tile(session, at);
    let (place, aspect) = (tile.place(pointer.position), tile.aspect());
    let run = &session.runs.panes[at].simulation;
    let camera = &session.view.camera;
    match hit.filter(|j| *j < run.particles()) {
        Some(j) => Some(run.position(j)),
        None => camera
            .project(to_f32(run.position(i)), aspect)
            .map(|(_, depth)| Vector3::from(camera.unproject(place, depth, aspect)).cast()),
    }
}

/// Returns what the chosen tool would act on under the pointer, if it acts on something.
pub fn target(pointer: &Pointer, session: &Session, screen: &Screen, at: usize) -> Option<Target> {
    let (hit, _) = pointer.hit(session, screen, at)?;
    match session.panel.editor.tool {
        Tool::Delete => Some(hit),
        tool if tool.joins() => Some(hit).filter(|hit| hit.particle().is_some()),
        _ => None,
    }
}

/// Returns the particle, body, spring or obstacle under the pointer in pane `at`.
fn aim(pointer: &Pointer, session: &Session, screen: &Screen, at: usize) -> Aim {
    let target = pointer.hit(session, screen, at);
    Aim {
        target: target.map(|(target, _)| target),
        link: link_at(pointer, session, screen, at),
        ..sight(pointer.position, session, screen, at)
    }
}

/// Returns the particles that the spring, the rod or the rope under the pointer in pane `at` joins.
pub fn link_at(
    pointer: &Pointer,
    session: &Session,
    screen: &Screen,
    at: usize,
) -> Option<[usize; 2]> {
    let tile = screen.tile(session, at);
    link(
        &session.runs.panes[at].simulation,
        &session.view.camera,
        tile.place(pointer.position),
        tile.aspect(),
        LINK_DISTANCE * screen.scale() / tile.height as f32,
    )
}

/// Returns where the line of sight through a place (px) in pane `at` ends.
fn sight(place: [f32; 2], session: &Session, screen: &Screen, at: usize) -> Aim {
    let tile = screen.tile(session, at);
    let (place, aspect) = (tile.place(place), tile.aspect());
    let pane = &session.runs.panes[at];
    let (run, camera) = (&pane.simulation, &session.view.camera);
    let point = |depth: f32| Vector3::from(camera.unproject(place, depth, aspect)).cast::<f64>();
    let (eye, ahead) = (point(0.0), point(1.0));
    let met = pick::meet(run, camera, place, aspect);
    let met = met.map(|(depth, normal)| (point(depth), normal));
    let down = (eye - ahead).y;
    let ground = pane
        .show
        .ground()
        .filter(|height| down > 0.0 && eye.y > *height);
    let ground = ground.map(|height| {
        let share = (eye.y - height) / down;
        (eye + (ahead - eye) * share, Vector3::y())
    });
    let far = |hit: &(Vector3<f64>, Vector3<f64>)| (hit.0 - eye).norm();
    let hit = met.into_iter().chain(ground);
    let hit = hit.min_by(|a, b| far(a).total_cmp(&far(b)));
    let target = Vector3::from(camera.target().coords).cast::<f64>();
    let distance = (target - eye).dot(&(ahead - eye).normalize());
    Aim {
        eye,
        point: hit.map_or(eye + (ahead - eye).normalize() * distance, |(point, _)| {
            point
        }),
        normal: hit.map(|(_, normal)| normal * -normal.dot(&(ahead - eye)).signum()),
        target: None,
        link: None,
    }
}

/// Returns the particles that the spring, the rod or the rope at the pointer joins, if there is one
/// within `reach`, a share of the picture's height, that no surface hides.
fn link(
    simulation: &Simulation,
    camera: &Camera,
    pointer: [f32; 2],
    aspect: f32,
    reach: f32,
) -> Option<[usize; 2]> {
    let network = simulation.model().network()?;
    let project = camera.projection(aspect);
    let front = pick::meet(simulation, camera, pointer, aspect);
    let most = front.map_or(f32::INFINITY, |(depth, _)| depth * (1.0 + DEPTH_TOLERANCE));
    let springs = network.all_springs();
    let structural = springs.filter(|it| it.kind == a3_core::SpringKind::Structural);
    let rods = network.constraints().iter().filter_map(|it| match *it {
        Constraint::Rod { i, j, .. } | Constraint::Rope { i, j, .. } => Some([i, j]),
        _ => None,
    });
    let near = |ends: [usize; 2]| {
        let [a, b] = ends.map(|i| project(to_f32(simulation.position(i))));
        let ((a, near), (b, far)) = (a?, b?);
        let along = [(b[0] - a[0]) * aspect, b[1] - a[1]];
        let to = [(pointer[0] - a[0]) * aspect, pointer[1] - a[1]];
        let squared = along[0] * along[0] + along[1] * along[1];
        let share = (along[0] * to[0] + along[1] * to[1]) / squared;
        let gap = (to[0] - share * along[0]).hypot(to[1] - share * along[1]);
        let depth = near + share * (far - near);
        let is_there = (END..=1.0 - END).contains(&share) && gap < reach && depth <= most;
        is_there.then_some((gap, ends))
    };
    let all = structural.map(|it| [it.i, it.j]).chain(rods);
    let nearest = all.filter_map(near).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, ends)| ends)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::session;

    /// Returns the link found in the middle between two particles.
    fn between(session: &Session, [i, j]: [usize; 2]) -> Option<[usize; 2]> {
        let (run, camera) = (session.runs.first(), &session.view.camera);
        let middle = (run.position(i) + run.position(j)) / 2.0;
        let (place, _) = camera.project(to_f32(middle), 1.6).unwrap();
        link(run, camera, place, 1.6, 0.02)
    }

    /// A rod is found between its particles, and nothing between bodies that a joint joins.
    #[test]
    fn rods_are_links_and_joints_are_not() {
        let rods = session(&["r", "0.001", "--scene", "double-pendulum"]);
        let network = rods.runs.first().model().network().unwrap();
        let mut all = network.constraints().iter();
        let rod = all.find_map(|it| Some([it.ends().0, it.ends().1?]));
        let rod = rod.unwrap();
        assert_eq!(between(&rods, rod), Some(rod));
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../docs/scenes/linkage.toml"
        );
        let linkage = session(&["r", "0.002", "--scene", path]);
        let network = linkage.runs.first().model().network().unwrap();
        let centers = [0, 1].map(|k| network.bodies()[k].center());
        assert_eq!(between(&linkage, centers), None);
    }
}
