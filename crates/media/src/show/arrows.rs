//! Arrows on particles.

use a3_core::Simulation;
use a3_render::Line;

use super::colouring::Scale;
use super::colours::INK;
use super::quantity::Arrows;

/// Largest number of arrows. If there are more particles, only every second or third one has an
/// arrow, and so on.
const MAX_ARROWS: usize = 1200;
/// Length of an arrow at the end of the scale, as a share of the scene's radius.
const MAX_LENGTH: f64 = 0.25;
/// Shares of an arrow's length that are its shaft and its head, with their widths (points).
const PIECES: [(f32, f32, f32); 3] = [(0.0, 0.8, 1.4), (0.8, 0.92, 4.2), (0.92, 1.0, 2.2)];

/// Arrows on particles, and their scale.
#[derive(Clone, Debug, Default)]
pub struct Field {
    /// Vectors that the arrows show, if there are arrows.
    pub arrows: Option<Arrows>,
    /// Scale of their lengths.
    pub scale: Scale,
}

impl Field {
    /// Sets the vectors that are shown, or none.
    pub fn set_arrows(&mut self, arrows: Option<Arrows>) {
        self.arrows = arrows;
        self.scale = Scale::default();
    }

    /// Adds the arrows of a run, which begin at its points (m).
    pub fn draw(&mut self, simulation: &Simulation, points: &[[f32; 4]], lines: &mut Vec<Line>) {
        let Some(arrows) = self.arrows else { return };
        let vectors = arrows.vectors(simulation);
        let n = vectors.len() / 3;
        let vector = |i: usize| [0, 1, 2].map(|axis| vectors[axis * n + i]);
        let length = |[x, y, z]: [f64; 3]| x.hypot(y).hypot(z);
        let largest = (0..n).map(|i| length(vector(i))).fold(0.0, f64::max);
        self.scale.follow(largest);
        let longest = MAX_LENGTH * simulation.extent().1;
        for i in (0..n).step_by(n.div_ceil(MAX_ARROWS).max(1)) {
            let length = length(vector(i));
            let share = f64::from(self.scale.share(length));
            // Shorter ones are dots.
            if share < 0.01 || !length.is_finite() {
                continue;
            }
            let [x, y, z, _] = points[i];
            let way = vector(i).map(|part| (share * longest * part / length) as f32);
            let at = |part: f32| [x + part * way[0], y + part * way[1], z + part * way[2]];
            for (from, to, width) in PIECES {
                lines.push(Line::new(at(from), at(to), width, INK));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use a3_core::{Control, integrators};

    #[test]
    fn arrows_begin_at_particles_and_point_along_their_vectors() {
        let scene = a3_scenes::find("mit").unwrap().build(None).unwrap().scene;
        let method = integrators::find("rk4").unwrap();
        let mut run = Simulation::new(scene, method, Control::Step(0.002)).unwrap();
        run.take_steps(50).unwrap();
        let points: Vec<_> = (0..run.particles())
            .map(|i| {
                let p = run.position(i);
                [p.x as f32, p.y as f32, p.z as f32, 0.0]
            })
            .collect();
        let (mut field, mut lines) = (Field::default(), vec![]);
        field.draw(&run, &points, &mut lines);
        assert!(lines.is_empty());
        field.set_arrows(Some(Arrows::Velocity));
        field.draw(&run, &points, &mut lines);
        assert!(lines.len() > 3 * 100 && lines.len() % 3 == 0);
        let (n, v) = (run.particles(), run.velocities());
        let longest = MAX_LENGTH * run.extent().1;
        for arrow in lines.chunks(3) {
            let i = points.iter().position(|p| p[..3] == arrow[0].from).unwrap();
            for axis in 0..3 {
                let way = f64::from(arrow[2].to[axis] - arrow[0].from[axis]);
                let wanted = longest * v[axis * n + i] / field.scale.end();
                assert!((way - wanted).abs() < 1e-5, "{way} {wanted}");
            }
        }
    }
}
