//! What is seen of the runs: colours by a quantity, arrows, and from where.

use std::f32::consts::FRAC_PI_2;

use a3_scenes::Presentation;

use a3_render::Style;

use super::followed::Followed;
use super::state::Session;
use crate::show::{self, Arrows, Quantity, Show};

/// Yaw and pitch (rad) of the views of a key, and their names.
const VIEWS: [([f32; 2], &str); 3] = [
    ([0.0, 0.0], "from the front"),
    ([FRAC_PI_2, 0.0], "from the right"),
    // Almost: the camera does not pass over the poles.
    ([0.0, FRAC_PI_2], "from above"),
];

impl Session {
    /// Sees another scene as it is first seen, in the same projection.
    pub(super) fn see_scene(&mut self, presentation: &Presentation) {
        let parallel = self.camera.is_parallel();
        self.camera = show::camera(presentation);
        self.camera.set_parallel(parallel);
    }

    /// Draws light things on a dark background, or the other way round.
    pub fn set_dark(&mut self, dark: bool) {
        for pane in &mut self.panes {
            pane.show.dark = dark;
        }
    }

    /// Goes from perspective to an orthographic projection, or back.
    pub(super) fn toggle_projection(&mut self) {
        let parallel = !self.camera.is_parallel();
        self.camera.set_parallel(parallel);
        self.say(if parallel {
            "The projection is orthographic."
        } else {
            "The projection is perspective."
        });
    }

    /// Lets the camera go along with a particle of a pane, or with none: then too where it goes
    /// along with that one already.
    pub fn follow(&mut self, pane: usize, particle: Option<usize>) {
        let before = self.followed.take();
        let again = |i: &usize| before.is_some_and(|it| (it.pane, it.particle) == (pane, *i));
        let Some(particle) = particle.filter(|i| !again(i)) else {
            return self.say(match before {
                Some(_) => "The camera stays where it is.",
                None => "Nothing is there that the camera could follow.",
            });
        };
        let at = show::to_f32(self.panes[pane].simulation.position(particle));
        self.followed = Some(Followed { pane, particle, at });
        self.say(format!("The camera follows particle {particle}."));
    }

    /// The particle that the camera follows.
    pub fn followed(&self) -> Option<usize> {
        self.followed.map(|followed| followed.particle)
    }

    /// Moves the camera as the particle that it follows has moved.
    pub fn go_along(&mut self) {
        if let Some(followed) = &mut self.followed {
            let run = &self.panes[followed.pane].simulation;
            let now = show::to_f32(run.position(followed.particle));
            self.camera
                .shift([0, 1, 2].map(|axis| now[axis] - followed.at[axis]));
            followed.at = now;
        }
    }

    /// Moves the camera so that all particles of all panes are seen, from the same side.
    pub(super) fn see_all(&mut self) {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for pane in &self.panes {
            let run = &pane.simulation;
            for point in (0..run.particles()).map(|i| run.position(i)) {
                for axis in 0..3 {
                    low[axis] = low[axis].min(point[axis] as f32);
                    high[axis] = high[axis].max(point[axis] as f32);
                }
            }
        }
        let middle = [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis]));
        let [x, y, z] = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]));
        // What is drawn around particles is seen too.
        let radius = x.hypot(y).hypot(z) + 0.1;
        self.camera.see(middle, radius);
    }

    /// Turns the camera to the next view: from the front, from the right, or from above.
    pub(super) fn next_view(&mut self) {
        let seen = |[yaw, pitch]: [f32; 2]| {
            let mut turned = self.camera;
            turned.turn_to(yaw, pitch);
            turned == self.camera
        };
        let now = VIEWS.iter().position(|(view, _)| seen(*view));
        let ([yaw, pitch], name) = VIEWS[now.map_or(0, |now| (now + 1) % VIEWS.len())];
        self.camera.turn_to(yaw, pitch);
        self.say(name);
    }

    /// Draws the runs in the next style in which they look different.
    pub(super) fn next_style(&mut self) {
        let styles = Show::styles(self.first());
        let next = after(styles, Some(self.panes[0].show.style));
        self.set_style(next.unwrap_or_default());
    }

    /// Whether the runs can be coloured by a quantity.
    pub fn has(&self, quantity: Quantity) -> bool {
        quantity.is_in(self.first(), self.panes.len() > 1)
    }

    /// Colours by the next quantity that the runs have, and after the last by none.
    pub(super) fn next_colour(&mut self) {
        let has = |quantity: &Quantity| self.has(*quantity);
        let all: Vec<_> = Quantity::ALL.into_iter().filter(has).collect();
        let next = after(&all, self.panes[0].show.colouring.quantity);
        self.set_colour(next);
        self.say(match next {
            Some(quantity) => format!("colours show the {}", quantity.name()),
            None => "colours are those of the scene".into(),
        });
    }

    /// Draws the next arrows that the scene has, and after the last none.
    pub(super) fn next_arrows(&mut self) {
        let run = self.first();
        let has = |arrows: &Arrows| arrows.is_in(run);
        let all: Vec<_> = Arrows::ALL.into_iter().filter(has).collect();
        let next = after(&all, self.panes[0].show.field.arrows);
        self.set_arrows(next);
        self.say(match next {
            Some(arrows) => format!("arrows show the {}", arrows.name()),
            None => "arrows are off".into(),
        });
    }

    /// Draws all panes in a style.
    pub fn set_style(&mut self, style: Style) {
        for pane in &mut self.panes {
            pane.show.style = style;
        }
    }

    /// Colours all panes by a quantity, or by none.
    pub fn set_colour(&mut self, quantity: Option<Quantity>) {
        for pane in &mut self.panes {
            pane.show.colouring.set_quantity(quantity);
        }
    }

    /// Draws arrows in all panes, or none.
    pub fn set_arrows(&mut self, arrows: Option<Arrows>) {
        for pane in &mut self.panes {
            pane.show.field.set_arrows(arrows);
        }
    }

    /// Fixes the end of the scale of colours in all panes, or lets it follow the values.
    pub fn fix_scale(&mut self, end: Option<f64>) {
        for pane in &mut self.panes {
            pane.show.colouring.scale.fixed = end;
        }
    }
}

/// The one after this one; none after the last, and the first after none.
fn after<T: Copy + PartialEq>(all: &[T], now: Option<T>) -> Option<T> {
    let place = now.and_then(|now| all.iter().position(|one| *one == now));
    all.get(place.map_or(0, |place| place + 1)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{Action, compared, frames, session};

    #[test]
    fn colours_and_arrows_come_round_as_far_as_the_scene_has_them() {
        let mut cloth = session(&["v", "0.005"]);
        let colours = [0; 5].map(|_| {
            cloth.act(Action::Colour, 0);
            cloth.panes[0].show.colouring.quantity
        });
        let [speed, strain, force, contact, _] = Quantity::ALL.map(Some);
        assert_eq!(colours, [speed, strain, force, contact, None]);
        let mut circle = session(&["t", "0.01", "--scene", "simple"]);
        let colours = [0; 2].map(|_| {
            circle.act(Action::Colour, 0);
            circle.panes[0].show.colouring.quantity
        });
        assert_eq!(colours, [Some(Quantity::Speed), None]);
        circle.act(Action::Arrows, 0);
        assert_eq!(circle.panes[0].show.field.arrows, Some(Arrows::Velocity));
    }

    #[test]
    fn contact_is_there_where_something_touches_and_errors_where_there_is_a_reference() {
        let mut flag = session(&["v", "0.005", "--scene", "mit"]);
        assert!(!flag.has(Quantity::Contact) && !flag.has(Quantity::Error));
        flag.act(Action::Touch, 0);
        assert!(flag.has(Quantity::Contact));
        let mut two = compared(&["e:0.0005", "r:0.01", "--scene", "mit"], 0.0);
        for _ in 0..4 {
            two.act(Action::Colour, 0);
        }
        assert_eq!(two.panes[1].show.colouring.quantity, Some(Quantity::Error));
        crate::session::frames(&mut two, 0.3);
        let ends = [0, 1].map(|k| {
            let pane = &mut two.panes[k];
            pane.show.compose(&pane.simulation);
            assert_eq!(pane.show.colouring.shown(), Some(Quantity::Error));
            pane.show.colouring.scale.end()
        });
        // One scale, to the power of ten above the errors of the worse run. The largest of these is
        // above their root mean square, and below what all make together.
        let [worse, better] = [0, 1].map(|k| two.panes[k].error.unwrap());
        let most = worse * (two.panes[0].simulation.particles() as f64).sqrt();
        assert!(worse > 100.0 * better);
        assert_eq!(ends[0], ends[1]);
        assert!((worse..10.0 * most).contains(&ends[0]), "{ends:?} {worse}");
        let share = |k: usize| two.panes[k].show.colouring.share(5).unwrap();
        assert!(share(0) > share(1) + 0.2 && share(1) > 0.0);
        two.act(Action::Reset, 0);
        let pane = &mut two.panes[0];
        pane.show.compose(&pane.simulation);
        assert_eq!(pane.show.colouring.shown(), None);
    }

    #[test]
    fn surface_wires_and_springs_come_round_as_far_as_they_differ() {
        let styles = |scene: &str| {
            let mut session = session(&["t", "0.001", "--scene", scene]);
            [0; 3].map(|_| {
                session.act(Action::Wireframe, 0);
                session.panes[0].show.style
            })
        };
        assert_eq!(
            styles("mit"),
            [Style::Wireframe, Style::Springs, Style::Shaded]
        );
        assert_eq!(
            styles("drop"),
            [Style::Wireframe, Style::Shaded, Style::Wireframe]
        );
    }

    #[test]
    fn the_camera_follows_a_particle_forth_and_back() {
        let mut session = session(&["v", "0.005", "--scene", "pendulum"]);
        session.readings.in_window = true;
        let last = session.first().particles() - 1;
        let offset = |session: &Session| {
            let p = session.first().position(last);
            let t = session.camera.target();
            [p.x as f32 - t.x, p.y as f32 - t.y, p.z as f32 - t.z]
        };
        let near = |a: [f32; 3], b: [f32; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-4);
        let before = offset(&session);
        session.follow(0, Some(last));
        let begun = session.camera.target();
        frames(&mut session, 0.7);
        session.go_along();
        assert!(near(offset(&session), before) && (session.camera.target() - begun).norm() > 0.1);
        session.act(Action::Scrub(-20), 0);
        session.go_along();
        assert!(near(offset(&session), before));
        // The same particle again, or none, ends it; and so does another scene.
        session.follow(0, Some(last));
        assert_eq!(session.followed(), None);
        session.follow(0, Some(0));
        assert_eq!(session.followed(), Some(0));
        session.act(Action::NextScene, 0);
        assert_eq!(session.followed(), None);
    }

    #[test]
    fn the_projection_stays_with_another_scene_and_when_the_camera_goes_home() {
        let mut session = session(&["v", "0.005", "--orthographic"]);
        assert!(session.camera.is_parallel());
        for action in [Action::NextScene, Action::Camera] {
            session.act(action, 0);
            assert!(session.camera.is_parallel());
        }
        session.act(Action::Projection, 0);
        session.act(Action::NextScene, 0);
        assert!(!session.camera.is_parallel());
    }

    #[test]
    fn all_is_seen_from_every_side() {
        let mut session = session(&["v", "0.005", "--scene", "mit"]);
        for _ in 0..4 {
            session.act(Action::NextView, 0);
            session.camera.pan(30.0, 5.0);
            session.act(Action::SeeAll, 0);
            let run = session.first();
            for i in 0..run.particles() {
                let p = run.position(i);
                let point = [p.x as f32, p.y as f32, p.z as f32];
                let ([x, y], _) = session.camera.project(point, 1.6).unwrap();
                assert!(
                    (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y),
                    "{i}: {x} {y}"
                );
            }
        }
        // From the front again, after the right and the top.
        let (_, _, towards) = session.camera.axes();
        assert!(towards.z > 0.999);
    }
}
