//! What is under the pointer in the picture of a run: a particle, an obstacle, a link, or a point.

use a3_core::contact::Shape;
use a3_core::{Constraint, Simulation, SpringKind, Vector3};
use a3_media::show::{self, Target, to_f32};
use a3_media::surfaces::tessellation::{self, Tessellation};
use a3_media::surfaces::whole_triangles;
use a3_render::Camera;

use crate::hud::edit::Aim;

/// Share of a spring at either end in which its particle is found in its place.
const END: f32 = 0.25;
/// Share of its depth by which a spring may be behind a surface on which it lies.
const DEPTH_TOLERANCE: f32 = 1e-3;

/// The geometry of a grab, which keeps a particle or obstacle under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// Distance from the eye along the view (m).
    distance: f32,
    /// Vector from the pointer to the particle or obstacle, in shares of the picture.
    offset: [f32; 2],
}

/// The line of sight through a place in the picture of a run.
#[derive(Clone, Copy)]
pub struct Sight<'a> {
    pub run: &'a Simulation,
    pub camera: &'a Camera,
    /// The place, in shares of the picture.
    pub at: [f32; 2],
    /// Width of the picture over its height.
    pub aspect: f32,
}

impl Sight<'_> {
    /// Returns the point at a depth (m).
    pub fn point(&self, depth: f32) -> Vector3<f64> {
        Vector3::from(self.camera.unproject(self.at, depth, self.aspect)).cast()
    }

    /// Returns the point (m) to which the place drags what a grip holds: in the plane at the
    /// initial depth that is parallel to the picture.
    pub fn dragged(&self, grip: Grip) -> Vector3<f64> {
        let at = [0, 1].map(|k| self.at[k] + grip.offset[k]);
        Self { at, ..*self }.point(grip.distance)
    }

    /// Returns the particle or the obstacle at the place, the nearer one to the eye. On a surface,
    /// the particle is the closest corner of the nearest triangle, and on a rigid body the closest
    /// of its particles. Elsewhere it is the closest one on the screen within `reach`, a share of
    /// the picture's height.
    pub fn pick(&self, reach: f32) -> Option<(Target, Grip)> {
        let (run, pointer) = (self.run, self.at);
        let network = run.model().network()?;
        let project = self.camera.projection(self.aspect);
        let places = (0..run.particles()).map(|i| project(to_f32(run.position(i))));
        let places: Vec<_> = places.collect();
        // Distance from the pointer, in heights of the picture.
        let gap = |at: [f32; 2]| ((at[0] - pointer[0]) * self.aspect).hypot(at[1] - pointer[1]);
        let near = |i: &usize| places[*i].map_or(f32::INFINITY, |(at, _)| gap(at));
        let nearer = |a: &usize, b: &usize| near(a).total_cmp(&near(b));
        let triangles = whole_triangles(run).filter_map(|corners| {
            let corners = corners.map(|i| i as usize);
            let [a, b, c] = corners.map(|i| places[i]);
            Some((depth_in(pointer, [a?, b?, c?])?, corners))
        });
        let on_surface = triangles.min_by(|a, b| a.0.total_cmp(&b.0));
        let on_surface = on_surface
            .and_then(|(depth, corners)| Some((corners.into_iter().min_by(nearer)?, depth)));
        let nearest = || {
            let free = (0..places.len()).filter(|i| near(i) < reach && !network.is_wall(*i));
            let i = free.min_by(nearer)?;
            Some((i, places[i]?.1))
        };
        // On a rigid body, take the nearest of its particles.
        let on_body = tessellation::placed(network, run.state()).filter_map(|(k, part)| {
            let (depth, _) = self.meet_part(&part)?;
            let body = &network.bodies()[k];
            let own = body.points().chain([body.center()]);
            Some((own.min_by(nearer)?, depth))
        });
        let on_surface = on_surface.into_iter().chain(on_body);
        let on_surface = on_surface.min_by(|a, b| a.1.total_cmp(&b.1));
        let particle = on_surface.or_else(nearest).and_then(|(i, depth)| {
            let (at, distance) = places[i]?;
            Some((depth, Target::Particle(i), at, distance))
        });
        let obstacles = (0..network.obstacles().len()).filter_map(|k| {
            let place = network.obstacles()[k].path.at(run.time()).position;
            let (at, distance) = project(to_f32(place))?;
            let (depth, _) = self.meet_obstacle(k)?;
            Some((depth, Target::Obstacle(k), at, distance))
        });
        let all = obstacles.chain(particle);
        let (_, target, at, distance) = all.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let offset = [at[0] - pointer[0], at[1] - pointer[1]];
        Some((target, Grip { distance, offset }))
    }

    /// Returns the particles that the spring, the rod or the rope at the place joins, if there is
    /// one within `reach`, a share of the picture's height, that no surface hides.
    pub fn link(&self, reach: f32) -> Option<[usize; 2]> {
        let (run, pointer, aspect) = (self.run, self.at, self.aspect);
        let network = run.model().network()?;
        let project = self.camera.projection(aspect);
        let front = self.meet();
        let most = front.map_or(f32::INFINITY, |(depth, _)| depth * (1.0 + DEPTH_TOLERANCE));
        let springs = network.all_springs();
        let structural = springs.filter(|it| it.kind == SpringKind::Structural);
        let rods = network.constraints().iter().filter_map(|it| match *it {
            Constraint::Rod { i, j, .. } | Constraint::Rope { i, j, .. } => Some([i, j]),
            _ => None,
        });
        let near = |ends: [usize; 2]| {
            let [a, b] = ends.map(|i| project(to_f32(run.position(i))));
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

    /// Returns where the line of sight ends, above a ground of a height (m) if there is one.
    pub fn aim(&self, ground: Option<f64>) -> Aim {
        let (eye, ahead) = (self.point(0.0), self.point(1.0));
        let met = self.meet().map(|(depth, normal)| (self.point(depth), normal));
        let down = (eye - ahead).y;
        let ground = ground.filter(|height| down > 0.0 && eye.y > *height);
        let ground = ground.map(|height| {
            let share = (eye.y - height) / down;
            (eye + (ahead - eye) * share, Vector3::y())
        });
        let far = |hit: &(Vector3<f64>, Vector3<f64>)| (hit.0 - eye).norm();
        let hit = met.into_iter().chain(ground);
        let hit = hit.min_by(|a, b| far(a).total_cmp(&far(b)));
        let target = Vector3::from(self.camera.target().coords).cast::<f64>();
        let way = (ahead - eye).normalize();
        let distance = (target - eye).dot(&way);
        Aim {
            eye,
            point: hit.map_or(eye + way * distance, |(point, _)| point),
            normal: hit.map(|(_, normal)| normal * -normal.dot(&(ahead - eye)).signum()),
            target: None,
            link: None,
        }
    }

    /// Returns the depth (m) at which the line of sight first meets a surface, a rigid body or an
    /// obstacle, and the normal there.
    fn meet(&self) -> Option<(f32, Vector3<f64>)> {
        let run = self.run;
        let network = run.model().network()?;
        let surface = Tessellation {
            points: (0..run.particles()).map(|i| run.position(i)).collect(),
            triangles: whole_triangles(run).collect(),
        };
        let bodies = tessellation::placed(network, run.state()).map(|(_, part)| part);
        let parts = bodies.chain([surface]);
        let parts = parts.filter_map(|part| self.meet_part(&part));
        let obstacles = (0..network.obstacles().len()).filter_map(|k| self.meet_obstacle(k));
        parts.chain(obstacles).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Returns the depth (m) at which the line of sight first meets obstacle k, and the normal
    /// there; `None` for a floor.
    fn meet_obstacle(&self, k: usize) -> Option<(f32, Vector3<f64>)> {
        let network = self.run.model().network()?;
        let obstacle = network.obstacles().get(k)?;
        let pose = obstacle.at(self.run.time());
        match &obstacle.shape {
            Shape::Floor => None,
            Shape::Sphere { radius } => {
                let center = pose.place.position;
                let radius = show::drawn_radius(network) * *radius as f32;
                let surface = self.ball_hit(to_f32(center), radius)?;
                let (_, depth) = self.camera.project(surface, self.aspect)?;
                Some((depth, (Vector3::from(surface).cast() - center).normalize()))
            }
            shape => self.meet_part(&Tessellation::at(shape, &pose)),
        }
    }

    /// Returns the depth (m) at which the line of sight first meets a part of a body or an
    /// obstacle, and the normal there.
    fn meet_part(&self, part: &Tessellation) -> Option<(f32, Vector3<f64>)> {
        let project = self.camera.projection(self.aspect);
        let places: Vec<_> = part.points.iter().map(|p| project(to_f32(*p))).collect();
        let hits = part.triangles.iter().filter_map(|corners| {
            let [a, b, c] = corners.map(|i| places[i as usize]);
            Some((depth_in(self.at, [a?, b?, c?])?, corners))
        });
        let (depth, corners) = hits.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let [a, b, c] = corners.map(|i| part.points[i as usize]);
        Some((depth, (b - a).cross(&(c - a)).normalize()))
    }

    /// Returns the first point (m) at which the line of sight meets a ball.
    fn ball_hit(&self, center: [f32; 3], radius: f32) -> Option<[f32; 3]> {
        let point = |depth| Vector3::from(self.camera.unproject(self.at, depth, self.aspect));
        let [near, far] = [0.0, 1.0].map(point);
        let (way, from) = ((far - near).normalize(), near - Vector3::from(center));
        let b = from.dot(&way);
        let root = (b * b - from.norm_squared() + radius * radius).sqrt();
        // The distance is NaN for a miss, and negative for a ball behind the eye.
        let share = Some(-b - root).filter(|share| *share > 0.0)?;
        Some((near + share * way).into())
    }
}

/// Returns the depth (m) of a triangle at a place, if that is inside. The triangle is given by the
/// screen positions and depths of its corners.
fn depth_in(p: [f32; 2], [a, b, c]: [([f32; 2], f32); 3]) -> Option<f32> {
    let cross = |a: [f32; 2], b: [f32; 2], c: [f32; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let area = cross(a.0, b.0, c.0);
    // Barycentric coordinates.
    let [u, v, w] =
        [cross(p, b.0, c.0) / area, cross(a.0, p, c.0) / area, cross(a.0, b.0, p) / area];
    let is_inside = [u, v, w].iter().all(|weight| *weight >= 0.0);
    is_inside.then_some(u * a.1 + v * b.1 + w * c.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use a3_core::{Control, Model, integrators};

    use crate::session::{Session, session};

    /// Returns what is picked at a place.
    fn pick(
        run: &Simulation,
        camera: &Camera,
        at: [f32; 2],
        aspect: f32,
        reach: f32,
    ) -> Option<(Target, Grip)> {
        let sight = Sight { run, camera, at, aspect };
        sight.pick(reach)
    }

    fn cloth() -> Simulation {
        let scene = a3_scenes::find("cloth").unwrap().build(None).unwrap().scene;
        Simulation::new(scene, integrators::find("t").unwrap(), Control::Step(0.01)).unwrap()
    }

    #[test]
    fn the_particle_under_the_pointer_is_picked_and_stays_there() {
        let simulation = cloth();
        let camera = Camera::look_at([0.0, 3.0, 9.0], [0.0, 2.5, 0.0]);
        for i in [25, 210, 333, 399] {
            let p = simulation.position(i);
            let p = [p.x as f32, p.y as f32, p.z as f32];
            let (at, _) = camera.project(p, 1.6).unwrap();
            let pointer = [at[0] + 0.002, at[1] - 0.002];
            let (picked, grip) = pick(&simulation, &camera, pointer, 1.6, 0.03).unwrap();
            assert_eq!(picked, Target::Particle(i));
            let sight = Sight { run: &simulation, camera: &camera, at: pointer, aspect: 1.6 };
            let target = sight.dragged(grip);
            let off = (simulation.position(i) - target).abs().max();
            assert!(off < 1e-3, "{p:?} {target:?}");
        }
        assert_eq!(pick(&simulation, &camera, [0.02, 0.02], 1.6, 0.03), None);
    }

    /// The same position in each pane picks the same particle.
    #[test]
    fn picking_is_the_same_in_every_pane() {
        let simulation = cloth();
        let camera = Camera::look_at([0.0, 3.0, 9.0], [0.0, 2.5, 0.0]);
        let p = simulation.position(210);
        for panes in 1..=4 {
            for tile in crate::hud::layout::tiles(panes, (1280, 720), 1.0) {
                let aspect = tile.aspect();
                let (at, _) = camera.project([p.x as f32, p.y as f32, p.z as f32], aspect).unwrap();
                let pointer = [
                    tile.x as f32 + at[0] * tile.width as f32,
                    tile.y as f32 + at[1] * tile.height as f32,
                ];
                assert!(tile.contains(pointer));
                let hit = pick(&simulation, &camera, tile.place(pointer), aspect, 0.03);
                let hit = hit.map(|(target, _)| target);
                assert_eq!(hit, Some(Target::Particle(210)), "{tile:?}");
            }
        }
    }

    /// A side of a body hides the bodies and particles behind it.
    #[test]
    fn a_body_is_picked_by_its_sides() {
        let scene = a3_scenes::find("boxes").unwrap().build(None).unwrap().scene;
        let run =
            Simulation::new(scene, integrators::find("r").unwrap(), Control::Step(0.001)).unwrap();
        let network = run.model().network().unwrap();
        for (height, body) in [(0.25, 0), (1.27, 2), (2.3, 4)] {
            let camera = Camera::look_at([3.0, height, 2.0], [0.0, height, 0.0]);
            let Some((Target::Particle(i), _)) = pick(&run, &camera, [0.5, 0.5], 1.6, 0.03) else {
                panic!("nothing is picked at {height}");
            };
            assert_eq!(network.body_of(i), Some(body));
        }
    }

    /// The nearer one is picked: the sphere from below the cloth, and the cloth from above.
    #[test]
    fn a_sphere_is_picked_unless_cloth_is_in_front() {
        let scene = a3_scenes::find("mit-sphere").unwrap().build(None).unwrap().scene;
        let run =
            Simulation::new(scene, integrators::find("t").unwrap(), Control::Step(0.001)).unwrap();
        let hit = |eye: [f32; 3]| {
            let camera = Camera::look_at(eye, [1.0, -4.0, 0.0]);
            pick(&run, &camera, [0.5, 0.5], 1.6, 0.03)
        };
        let (target, grip) = hit([1.0, -4.0, 8.0]).unwrap();
        assert_eq!(target, Target::Obstacle(0));
        assert_eq!(grip.offset.map(|o| (1e4 * o).round() as i32), [0, 0]);
        assert!((grip.distance - 8.0).abs() < 1e-3);
        // The line of sight meets the cloth first, at height 0.
        let above = hit([1.0, 6.0, 2.0]).unwrap().0;
        assert!(matches!(above, Target::Particle(_)), "{above:?}");
    }

    #[test]
    fn a_hole_is_not_hit() {
        let run = cloth();
        let camera = Camera::look_at([0.0, 3.0, 9.0], [0.0, 2.5, 0.0]);
        let corners = whole_triangles(&run).nth(300).unwrap();
        let middle = corners.map(|i| run.position(i as usize)).iter().sum::<Vector3<f64>>() / 3.0;
        let (place, _) =
            camera.project([middle.x as f32, middle.y as f32, middle.z as f32], 1.6).unwrap();
        let hit = |run: &Simulation| pick(run, &camera, place, 1.6, 0.0).is_some();
        assert!(hit(&run));
        let mut scene = run.scene().clone();
        if let Model::Network(network) = &mut scene.model {
            network.set_tear(Some(1.5)).unwrap();
            let wide: Vec<_> = scene.state[..1200].iter().map(|x| 10.0 * x).collect();
            assert!(network.tear(&wide, 0.0) > 0);
        }
        let torn = Simulation::new(scene, run.method(), Control::Step(0.01)).unwrap();
        assert!(!hit(&torn));
    }

    /// Returns the link found in the middle between two particles.
    fn between(session: &Session, [i, j]: [usize; 2]) -> Option<[usize; 2]> {
        let (run, camera) = (session.runs.first(), &session.view.camera);
        let middle = (run.position(i) + run.position(j)) / 2.0;
        let (place, _) = camera.project(to_f32(middle), 1.6).unwrap();
        let sight = Sight { run, camera, at: place, aspect: 1.6 };
        sight.link(0.02)
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
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/linkage.toml");
        let linkage = session(&["r", "0.002", "--scene", path]);
        let network = linkage.runs.first().model().network().unwrap();
        let centers = [0, 1].map(|k| network.bodies()[k].center());
        assert_eq!(between(&linkage, centers), None);
    }
}
