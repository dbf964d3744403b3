//! From a place in the picture to a particle, and back to a place in the world.

use a3_core::Simulation;
use a3_render::Camera;

use crate::show;

/// A particle in the hand: what keeps it under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// Its distance from the eye along the view (m).
    distance: f32,
    /// From the pointer to the particle, as shares of the picture.
    offset: [f32; 2],
}

impl Grip {
    /// Where the particle goes when the pointer is at that place: the camera's plane at the particle's depth.
    pub fn target(&self, camera: &Camera, pointer: [f32; 2], aspect: f32) -> [f32; 3] {
        let at = [pointer[0] + self.offset[0], pointer[1] + self.offset[1]];
        camera.unproject(at, self.distance, aspect)
    }
}

/// The particle under the pointer: of the nearest triangle of a cloth that it hits the closest corner, else the
/// particle that is nearest on the screen within `reach`, as a share of the picture's height.
pub fn pick(
    simulation: &Simulation,
    camera: &Camera,
    pointer: [f32; 2],
    aspect: f32,
    reach: f32,
) -> Option<(usize, Grip)> {
    simulation.model().network()?;
    let project = |i: usize| {
        let p = simulation.position(i);
        camera.project([p.x as f32, p.y as f32, p.z as f32], aspect)
    };
    let places: Vec<_> = (0..simulation.particles()).map(project).collect();
    // On the screen, in units of its height.
    let gap = |at: [f32; 2]| ((at[0] - pointer[0]) * aspect).hypot(at[1] - pointer[1]);
    let on_surface = {
        show::whole_triangles(simulation)
            .filter_map(|corners| {
                let corners = corners.map(|i| i as usize);
                let [a, b, c] = corners.map(|i| places[i]);
                let (a, b, c) = (a?, b?, c?);
                let [u, v, w] = weights(pointer, a.0, b.0, c.0)?;
                Some((u * a.1 + v * b.1 + w * c.1, corners))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .and_then(|(_, corners)| {
                let near = |i: &usize| places[*i].map_or(f32::INFINITY, |(at, _)| gap(at));
                corners
                    .into_iter()
                    .min_by(|a, b| near(a).total_cmp(&near(b)))
            })
    };
    let nearest = || {
        let near =
            |(i, place): (usize, &Option<([f32; 2], f32)>)| place.map(|(at, _)| (i, gap(at)));
        places
            .iter()
            .enumerate()
            .filter_map(near)
            .filter(|(_, gap)| *gap < reach)
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(i, _)| i)
    };
    let i = on_surface.or_else(nearest)?;
    let (at, distance) = places[i]?;
    Some((
        i,
        Grip {
            distance,
            offset: [at[0] - pointer[0], at[1] - pointer[1]],
        },
    ))
}

/// Barycentric coordinates of p in the triangle abc, if it is inside.
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
    use a3_core::{Simulation, integrators, scenes};

    fn cloth() -> Simulation {
        let scene = scenes::find("cloth").unwrap().build(None).unwrap();
        Simulation::new(scene, integrators::find("t").unwrap(), 0.01).unwrap()
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
            assert_eq!(picked, i);
            let target = grip.target(&camera, pointer, 1.6);
            assert!(
                p.iter().zip(target).all(|(a, b)| (a - b).abs() < 1e-3),
                "{p:?} {target:?}"
            );
        }
        assert_eq!(pick(&simulation, &camera, [0.02, 0.02], 1.6, 0.03), None);
    }

    /// The same particle at the same place of every pane.
    #[test]
    fn panes_are_picked_in_alike() {
        let simulation = cloth();
        let camera = Camera::look_at([0.0, 3.0, 9.0], [0.0, 2.5, 0.0]);
        let p = simulation.position(210);
        for panes in 1..=4 {
            for tile in crate::app::layout::tiles(panes, (1280, 720), 1.0) {
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
                assert_eq!(hit.map(|(i, _)| i), Some(210), "{tile:?}");
            }
        }
    }
}
