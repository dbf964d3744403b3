//! The camera of all runs.

use std::f32::consts::FRAC_PI_2;

use a3_core::Simulation;
use a3_media::show;
use a3_render::Camera;
use a3_scenes::Splice;

use super::pane::Pane;

/// Yaw and pitch (rad) of the views that a key cycles through, and messages.
const VIEWS: [([f32; 2], &str); 3] = [
    ([0.0, 0.0], "The view is from the front."),
    ([FRAC_PI_2, 0.0], "The view is from the right."),
    // The camera stops just before the pole.
    ([0.0, FRAC_PI_2], "The view is from above."),
];

/// Longest time whose motion the camera takes in when a scene begins (s).
pub const SEEN_TIME: f64 = 10.0;

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
        Self { camera, followed: None }
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
        if parallel { "The projection is orthographic." } else { "The projection is perspective." }
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
            Some(Followed { particle, ..followed })
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
            self.camera.shift([0, 1, 2].map(|axis| now[axis] - followed.at[axis]));
            followed.at = now;
        }
    }

    /// Moves the camera, without turning it, so that all particles and bodies of all panes are
    /// visible, and the obstacles and the floor near them.
    pub fn see_all(&mut self, panes: &[Pane]) {
        show::see_all(&mut self.camera, panes.iter().map(|pane| &pane.simulation));
    }

    /// Moves the camera of a scene that begins, without turning it, so that the motion of a run
    /// until a time (s) fills most of the picture, as far as a short computation gets.
    pub fn see_motion(&mut self, panes: &mut [Pane], run: Simulation, until: f64) {
        let mut presentation = panes[0].show.presentation.clone();
        show::see_motion(&mut presentation, run, until);
        for pane in &mut *panes {
            pane.show.presentation = presentation.clone();
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

    /// A scene without a camera begins with one that takes in what moves; one with a camera keeps
    /// its own.
    #[test]
    fn a_scene_without_a_camera_is_seen_as_far_as_it_moves() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("slide.toml");
        let text = "gravity = [0, -9.81, 0]\nfloor = 0\n[[body]]\nparts = [{ box = [0.2, 0.1, 0.2] }]\nmass = 1\n\
            at = [0, 0.052, 0]\nvelocity = [2.5, 0, 0]\nfriction = 0.5\n";
        let open = |text: &str| {
            std::fs::write(&path, text).unwrap();
            session(&["r", "0.005", "--scene", path.to_str().unwrap()])
        };
        let mut opened = open(text);
        let start = opened.runs.first().position(0);
        frames(&mut opened, 1.0);
        let end = opened.runs.first().position(0);
        assert!(end.x - start.x > 0.3, "{end}");
        let at = |place| {
            let ([x, _], _) = opened.view.camera.project(show::to_f32(place), 1.5).unwrap();
            x
        };
        let (first, last) = (at(start), at(end));
        assert!(first > 0.05 && last < 0.95 && last - first > 0.25, "{first} to {last}");
        let named = format!("{text}[camera]\neye = [0, 1, 4]\ntarget = [0, 0.1, 0]\n");
        let eye = open(&named).view.camera.eye();
        assert!((eye.z - 4.0).abs() < 1e-5, "{eye}");
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
                assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y), "{i}: {x} {y}");
            }
        }
        // The fourth view is from the front again.
        let (_, _, towards) = session.view.camera.axes();
        assert!(towards.z > 0.999);
    }
}
