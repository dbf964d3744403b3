//! Picking the particle or obstacle at a point of the picture, and dragging it in the scene.

use a3_core::contact::Shape;
use a3_core::{Simulation, Vector3};
use a3_render::Camera;

use a3_media::show::Target;
use a3_media::show::{self, to_f32};
use a3_media::surfaces::tessellation::{self, Tessellation};
use a3_media::surfaces::whole_triangles;

/// The geometry of a grab, which keeps a particle or obstacle under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// Distance from the eye along the view (m).
    distance: f32,
    /// Vector from the pointer to the particle or obstacle, in shares of the picture.
    offset: [f32; 2],
}

impl Grip {
    /// Returns the point (m) to which the pointer drags: in the plane at the initial depth that is
    /// parallel to the picture.
    pub fn target(&self, camera: &Camera, pointer: [f32; 2], aspect: f32) -> [f32; 3] {
        let at = [pointer[0] + self.offset[0], pointer[1] + self.offset[1]];
        camera.unproject(at, self.distance, aspect)
    }
}

/// Returns the particle or the obstacle under the pointer, the nearer one to the eye. On a surface,
/// the particle is the closest corner of the nearest triangle, and on a rigid body the closest of
/// its particles. Elsewhere it is the closest one on the screen within `reach`, a share of the
/// picture's height.
pub fn pick(
    simulation: &Simulation,
    camera: &Camera,
    pointer: [f32; 2],
    aspect: f32,
    reach: f32,
) -> Option<(Target, Grip)> {
    let network = simulation.model().network()?;
    let project = camera.projection(aspect);
    let project = |i: usize| {
        let p = simulation.position(i);
        project([p.x as f32, p.y as f32, p.z as f32])
    };
    let places: Vec<_> = (0..simulation.particles()).map(project).collect();
    // Distance from the pointer, in heights of the picture.
    let gap = |at: [f32; 2]| ((at[0] - pointer[0]) * aspect).hypot(at[1] - pointer[1]);
    let near = |i: &usize| places[*i].map_or(f32::INFINITY, |(at, _)| gap(at));
    let on_surface = {
        whole_triangles(simulation)
            .filter_map(|corners| {
                let corners = corners.map(|i| i as usize);
                let [a, b, c] = corners.map(|i| places[i]);
                Some((depth_in(pointer, [a?, b?, c?])?, corners))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .and_then(|(depth, corners)| {
                corners
                    .into_iter()
                    .min_by(|a, b| near(a).total_cmp(&near(b)))
                    .map(|i| (i, depth))
            })
    };
    let nearest = || {
        let near =
            |(i, place): (usize, &Option<([f32; 2], f32)>)| place.map(|(at, _)| (i, gap(at)));
        places
            .iter()
            .enumerate()
            .filter_map(near)
            .filter(|(i, gap)| *gap < reach && !network.is_wall(*i))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .and_then(|(i, _)| Some((i, places[i]?.1)))
    };
    // On a rigid body, take the nearest of its particles.
    let on_body = tessellation::placed(network, simulation.state())
        .filter_map(|(k, part)| {
            let (depth, _) = meet_part(&part, camera, pointer, aspect)?;
            let body = &network.bodies()[k];
            let own = body.points().chain([body.center()]);
            let i = own.min_by(|a, b| near(a).total_cmp(&near(b)))?;
            Some((i, depth))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let on_surface = on_surface
        .into_iter()
        .chain(on_body)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let particle = on_surface.or_else(nearest).and_then(|(i, depth)| {
        let (at, distance) = places[i]?;
        Some((depth, Target::Particle(i), at, distance))
    });
    let obstacles = (0..network.obstacles().len()).filter_map(|k| {
        let place = network.obstacles()[k].path.at(simulation.time()).position;
        let (at, distance) = camera.project(to_f32(place), aspect)?;
        let (depth, _) = meet_obstacle(simulation, k, camera, pointer, aspect)?;
        Some((depth, Target::Obstacle(k), at, distance))
    });
    let (_, target, at, distance) = obstacles
        .chain(particle)
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let offset = [at[0] - pointer[0], at[1] - pointer[1]];
    Some((target, Grip { distance, offset }))
}

/// Returns the depth (m) at which the line of sight through the pointer first meets a surface, a
/// rigid body or an obstacle, and the normal there.
pub fn meet(
    simulation: &Simulation,
    camera: &Camera,
    pointer: [f32; 2],
    aspect: f32,
) -> Option<(f32, Vector3<f64>)> {
    let network = simulation.model().network()?;
    let points = (0..simulation.particles()).map(|i| simulation.position(i));
    let surface = Tessellation {
        points: points.collect(),
        triangles: whole_triangles(simulation).collect(),
    };
    let bodies = tessellation::placed(network, simulation.state()).map(|(_, part)| part);
    let parts = bodies.chain([surface]);
    let parts = parts.filter_map(|part| meet_part(&part, camera, pointer, aspect));
    let obstacles = 0..network.obstacles().len();
    let obstacles = obstacles.filter_map(|k| meet_obstacle(simulation, k, camera, pointer, aspect));
    parts.chain(obstacles).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Returns the depth (m) at which the line of sight through the pointer first meets obstacle k, and
/// the normal there; `None` for a floor.
fn meet_obstacle(
    simulation: &Simulation,
    k: usize,
    camera: &Camera,
    pointer: [f32; 2],
    aspect: f32,
) -> Option<(f32, Vector3<f64>)> {
    let network = simulation.model().network()?;
    let obstacle = network.obstacles().get(k)?;
    let pose = obstacle.at(simulation.time());
    match &obstacle.shape {
        Shape::Floor => None,
        Shape::Sphere { radius } => {
            let center = pose.place.position;
            let radius = show::drawn_radius(network) * *radius as f32;
            let surface = ball_hit(camera, pointer, aspect, to_f32(center), radius)?;
            let (_, depth) = camera.project(surface, aspect)?;
            Some((depth, (Vector3::from(surface).cast() - center).normalize()))
        }
        shape => meet_part(&Tessellation::at(shape, &pose), camera, pointer, aspect),
    }
}

/// Returns the depth (m) at which the line of sight through the pointer first meets a part of a
/// body or an obstacle, and the normal there.
fn meet_part(
    part: &Tessellation,
    camera: &Camera,
    pointer: [f32; 2],
    aspect: f32,
) -> Option<(f32, Vector3<f64>)> {
    let project = camera.projection(aspect);
    let places: Vec<_> = part.points.iter().map(|p| project(to_f32(*p))).collect();
    let hits = part.triangles.iter().filter_map(|corners| {
        let [a, b, c] = corners.map(|i| places[i as usize]);
        Some((depth_in(pointer, [a?, b?, c?])?, corners))
    });
    let (depth, corners) = hits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let [a, b, c] = corners.map(|i| part.points[i as usize]);
    Some((depth, (b - a).cross(&(c - a)).normalize()))
}

/// Returns the depth (m) of a triangle at the pointer, if that is inside. The triangle is given by
/// the screen positions and depths of its corners.
fn depth_in(pointer: [f32; 2], [a, b, c]: [([f32; 2], f32); 3]) -> Option<f32> {
    let [u, v, w] = weights(pointer, a.0, b.0, c.0)?;
    Some(u * a.1 + v * b.1 + w * c.1)
}

/// Returns the first point (m) at which the line of sight through the pointer meets a ball.
fn ball_hit(
    camera: &Camera,
    pointer: [f32; 2],
    aspect: f32,
    center: [f32; 3],
    radius: f32,
) -> Option<[f32; 3]> {
    let [near, far] = [0.0, 1.0].map(|d| Vector3::from(camera.unproject(pointer, d, aspect)));
    let (way, from) = ((far - near).normalize(), near - Vector3::from(center));
    let b = from.dot(&way);
    let root = (b * b - from.norm_squared() + radius * radius).sqrt();
    // The distance is NaN for a miss, and negative for a ball behind the eye.
    let share = Some(-b - root).filter(|share| *share > 0.0)?;
    Some((near + share * way).into())
}

/// Returns the barycentric coordinates of p in the triangle abc, if it is inside.
fn weights(p: [f32; 2], a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> Option<[f32; 3]> {
    let cross = |a: [f32; 2], b: [f32; 2], c: [f32; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let area = cross(a, b, c);
    let weights = [
        cross(p, b, c) / area,
        cross(a, p, c) / area,
        cross(a, b, p) / area,
    ];
    weights.iter().all(|w| *w >= 0.0).then_some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use a3_core::{Control, Model, integrators};

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
            let target = grip.target(&camera, pointer, 1.6);
            assert!(
                p.iter().zip(target).all(|(a, b)| (a - b).abs() < 1e-3),
                "{p:?} {target:?}"
            );
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
                let (at, _) = camera
                    .project([p.x as f32, p.y as f32, p.z as f32], aspect)
                    .unwrap();
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
        let scene = a3_scenes::find("mit-sphere")
            .unwrap()
            .build(None)
            .unwrap()
            .scene;
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
        let middle = corners
            .map(|i| run.position(i as usize))
            .iter()
            .sum::<Vector3<f64>>()
            / 3.0;
        let (place, _) = camera
            .project([middle.x as f32, middle.y as f32, middle.z as f32], 1.6)
            .unwrap();
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
}
