//! The camera of all runs.

use std::f32::consts::FRAC_PI_2;

use std::sync::Arc;

use a3_core::{Control, Network, Simulation, Vector3, integrators};
use a3_media::show;
use a3_render::Camera;
use a3_scenes::{Splice, Viewpoint, surroundings};

use super::pane::Pane;

/// Yaw and pitch (rad) of the views that a key cycles through, and messages.
const VIEWS: [([f32; 2], &str); 3] = [
    ([0.0, 0.0], "The view is from the front."),
    ([FRAC_PI_2, 0.0], "The view is from the right."),
    // The camera stops just before the pole.
    ([0.0, FRAC_PI_2], "The view is from above."),
];

/// Time between two states of a run whose motion is looked at (s).
const SEEN_EVERY: f64 = 1.0 / 30.0;
/// Most work of such a run: evaluations times particles.
const MAX_WORK: f64 = 1e6;
/// Room around the motion, for methods that err.
const MARGIN: f64 = 1.2;

/// The camera, which all panes share, and the particle that it follows.
pub struct View {
    /// The camera.
    pub camera: Camera,
    followed: Option<Followed>,
}

/// A particle that the camera follows.
#[derive(Clone, Copy)]
struct Followed {
    /// Index of the particle's pane.
    pane: usize,
    particle: usize,
    /// Position of the particle when the camera was last moved (m).
    at: [f32; 3],
}

impl View {
    /// Creates a view whose camera follows nothing.
    pub fn new(camera: Camera) -> Self {
        Self {
            camera,
            followed: None,
        }
    }

    /// Replaces the camera, and keeps the projection.
    pub fn set_camera(&mut self, camera: Camera) {
        let parallel = self.camera.is_parallel();
        self.camera = camera;
        self.camera.set_parallel(parallel);
    }

    /// Switches between perspective and orthographic projection, and returns a message.
    pub fn toggle_projection(&mut self) -> &'static str {
        let parallel = !self.camera.is_parallel();
        self.camera.set_parallel(parallel);
        if parallel {
            "The projection is orthographic."
        } else {
            "The projection is perspective."
        }
    }

    /// Follows a particle of a pane, or stops if it is already followed or `None`. Returns a
    /// message.
    pub fn follow(&mut self, panes: &[Pane], pane: usize, particle: Option<usize>) -> String {
        let before = self.followed.take();
        let again = |i: &usize| before.is_some_and(|it| (it.pane, it.particle) == (pane, *i));
        let Some(particle) = particle.filter(|i| !again(i)) else {
            return match before {
                Some(_) => "The camera follows no particle now.".into(),
                None => "There is no particle under the pointer to follow.".into(),
            };
        };
        let at = show::to_f32(panes[pane].simulation.position(particle));
        self.followed = Some(Followed { pane, particle, at });
        format!("The camera follows particle {particle}.")
    }

    /// Stops following a particle.
    pub fn stop_following(&mut self) {
        self.followed = None;
    }

    /// Follows the same particle by its number since an edit, or stops if it was removed.
    pub fn renumber(&mut self, particles: Splice) {
        self.followed = self.followed.and_then(|followed| {
            let particle = particles.number(followed.particle)?;
            Some(Followed {
                particle,
                ..followed
            })
        });
    }

    /// Returns the particle that the camera follows.
    pub fn followed(&self) -> Option<usize> {
        self.followed.map(|followed| followed.particle)
    }

    /// Moves the camera by the motion of the followed particle.
    pub fn track_followed(&mut self, panes: &[Pane]) {
        if let Some(followed) = &mut self.followed {
            let run = &panes[followed.pane].simulation;
            let now = show::to_f32(run.position(followed.particle));
            self.camera
                .shift([0, 1, 2].map(|axis| now[axis] - followed.at[axis]));
            followed.at = now;
        }
    }

    /// Moves the camera, without turning it, so that all particles of all panes are visible, and
    /// the obstacles and the floor near them. Liquid that has flowed out is not looked for.
    pub fn see_all(&mut self, panes: &[Pane]) {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for pane in panes {
            let run = &pane.simulation;
            let fluid = run.model().network().and_then(Network::fluid);
            let has_left = |i: &usize| fluid.is_some_and(|fluid| fluid.members().has_left(*i));
            let seen = (0..run.particles()).filter(|i| !has_left(i));
            for point in seen.map(|i| run.position(i)) {
                for axis in 0..3 {
                    low[axis] = low[axis].min(point[axis] as f32);
                    high[axis] = high[axis].max(point[axis] as f32);
                }
            }
        }
        let middle = [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis]));
        let [x, y, z] = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]));
        // Leave room for what is drawn around particles.
        let radius = x.hypot(y).hypot(z) + 0.1 * self.camera.unit();
        let middle = Vector3::from(middle.map(f64::from));
        let (middle, radius) = panes
            .iter()
            .fold((middle, f64::from(radius)), |ball, pane| {
                surroundings(pane.simulation.model(), pane.simulation.time(), ball)
            });
        self.camera.see(show::to_f32(middle), radius as f32);
    }

    /// Moves the camera of a scene that begins, without turning it, so that the motion until a time
    /// (s) fills most of the picture. The motion is that of an accurate run, as far as a short
    /// computation gets.
    pub fn see_motion(&mut self, panes: &mut [Pane], until: f64) {
        let scene = panes[0].simulation.scene().clone();
        let (Some(method), tolerance) = (integrators::find("dop853"), Control::Tolerance(1e-5))
        else {
            return;
        };
        let Ok(mut run) = Simulation::new(scene, method, tolerance) else {
            return;
        };
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        loop {
            for point in (0..run.particles()).map(|i| run.position(i)) {
                for axis in 0..3 {
                    low[axis] = low[axis].min(point[axis]);
                    high[axis] = high[axis].max(point[axis]);
                }
            }
            let work = run.work().evaluations as f64 * run.particles() as f64;
            let next = run.time() + SEEN_EVERY;
            if next > until || work > MAX_WORK || run.advance_to(next).is_err() {
                break;
            }
        }
        let [low, high] = [low, high].map(Vector3::from);
        let (middle, radius) = (0.5 * (low + high), 0.5 * MARGIN * (high - low).norm());
        if radius == 0.0 {
            return;
        }
        let mut camera = self.camera;
        camera.see(show::to_f32(middle), radius as f32);
        let viewpoint = Viewpoint {
            eye: camera.eye().coords.cast(),
            target: camera.target().coords.cast(),
        };
        for pane in &mut *panes {
            Arc::make_mut(&mut pane.show.presentation).viewpoint = viewpoint;
        }
        self.set_camera(panes[0].show.camera());
    }

    /// Turns the camera to the next view (from the front, from the right, or from above), and
    /// returns a message.
    pub fn next_view(&mut self) -> &'static str {
        let seen = |[yaw, pitch]: [f32; 2]| {
            let mut turned = self.camera;
            turned.turn_to(yaw, pitch);
            turned == self.camera
        };
        let now = VIEWS.iter().position(|(view, _)| seen(*view));
        let ([yaw, pitch], name) = VIEWS[now.map_or(0, |now| (now + 1) % VIEWS.len())];
        self.camera.turn_to(yaw, pitch);
        name
    }
}

#[cfg(test)]
mod tests {
    use a3_core::{Control, Simulation, integrators};
    use a3_files::lessons::ALL;
    use a3_media::show;

    use crate::begin;
    use crate::session::{RunAction, Session, frames, session};

    #[test]
    fn the_camera_follows_a_particle_forth_and_back() {
        let mut session = session(&["v", "0.005", "--scene", "pendulum"]);
        session.readings.in_window = true;
        let last = session.runs.first().particles() - 1;
        let offset = |session: &Session| {
            let p = session.runs.first().position(last);
            let t = session.view.camera.target();
            [p.x as f32 - t.x, p.y as f32 - t.y, p.z as f32 - t.z]
        };
        let near = |a: [f32; 3], b: [f32; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-4);
        let before = offset(&session);
        session.view.follow(&session.runs.panes, 0, Some(last));
        let begun = session.view.camera.target();
        frames(&mut session, 0.7);
        session.view.track_followed(&session.runs.panes);
        assert!(
            near(offset(&session), before) && (session.view.camera.target() - begun).norm() > 0.1
        );
        session.act(RunAction::Scrub(-20), 0);
        session.view.track_followed(&session.runs.panes);
        assert!(near(offset(&session), before));
        // Following the same particle again, or another scene, ends following.
        session.view.follow(&session.runs.panes, 0, Some(last));
        assert_eq!(session.view.followed(), None);
        session.view.follow(&session.runs.panes, 0, Some(0));
        assert_eq!(session.view.followed(), Some(0));
        session.act(RunAction::NextScene, 0);
        assert_eq!(session.view.followed(), None);
    }

    #[test]
    fn the_projection_stays_with_another_scene_and_when_the_camera_goes_home() {
        let mut session = session(&["v", "0.005", "--orthographic"]);
        assert!(session.view.camera.is_parallel());
        for action in [RunAction::NextScene, RunAction::Camera] {
            session.act(action, 0);
            assert!(session.view.camera.is_parallel());
        }
        session.act(RunAction::Projection, 0);
        session.act(RunAction::NextScene, 0);
        assert!(!session.view.camera.is_parallel());
    }

    /// In every step of a lesson, what moves fills half of the picture and does not leave it.
    #[test]
    fn the_motion_of_a_lesson_fills_its_picture() {
        for lesson in ALL.iter() {
            for step in &lesson.steps {
                let session = begin::step(step).unwrap();
                let aspect = 1.2;
                let project = session.view.camera.projection(aspect);
                let scene = session.runs.first().scene().clone();
                let method = integrators::find("dop853").unwrap();
                let mut run = Simulation::new(scene, method, Control::Tolerance(1e-6)).unwrap();
                let (mut low, mut high) = ([1f32; 2], [0f32; 2]);
                for k in 0..60 {
                    let until = step.until.unwrap_or(10.0).min(10.0);
                    run.advance_to(until * f64::from(k) / 60.0).unwrap();
                    for i in 0..run.particles() {
                        let (at, _) = project(show::to_f32(run.position(i))).unwrap();
                        for axis in 0..2 {
                            low[axis] = low[axis].min(at[axis]);
                            high[axis] = high[axis].max(at[axis]);
                        }
                    }
                }
                let [wide, tall] = [high[0] - low[0], high[1] - low[1]];
                assert!(
                    wide.max(tall) > 0.5 && low[0].min(low[1]) > 0.0 && high[0].max(high[1]) < 1.0,
                    "{}: {low:?} to {high:?}",
                    step.title
                );
            }
        }
    }

    #[test]
    fn all_is_seen_from_every_side() {
        let mut session = session(&["v", "0.005", "--scene", "mit"]);
        for _ in 0..4 {
            session.act(RunAction::NextView, 0);
            session.view.camera.pan(30.0, 5.0);
            session.act(RunAction::SeeAll, 0);
            let run = session.runs.first();
            for i in 0..run.particles() {
                let p = run.position(i);
                let point = [p.x as f32, p.y as f32, p.z as f32];
                let ([x, y], _) = session.view.camera.project(point, 1.6).unwrap();
                assert!(
                    (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y),
                    "{i}: {x} {y}"
                );
            }
        }
        // The fourth view is from the front again.
        let (_, _, towards) = session.view.camera.axes();
        assert!(towards.z > 0.999);
    }
}
