//! What a run looks like: from particles, springs and obstacles to balls, lines and triangles.

mod parts;
mod wires;

use std::collections::VecDeque;

use a3_core::contact::Shape;
use a3_core::{Network, Scene, Simulation, Spring, SpringKind, SpringLaw, Vector3};
use a3_render::{Ball, Camera, Line, Picture, Solid, Style};

use parts::Parts;

pub use parts::{topology, whole_triangles};

/// Linear colours.
const INK: [f32; 4] = [0.035, 0.05, 0.09, 1.0];
const STEEL: [f32; 4] = [0.30, 0.36, 0.44, 1.0];
const RED: [f32; 4] = [0.62, 0.045, 0.06, 1.0];
const AMBER: [f32; 4] = [0.95, 0.42, 0.02, 1.0];
const TEAL: [f32; 4] = [0.0, 0.33, 0.36, 1.0];
const ALARM: [f32; 4] = [0.75, 0.02, 0.02, 1.0];
const VIOLET: [f32; 4] = [0.30, 0.10, 0.55, 1.0];

/// Turns of a drawn coil, and pieces a turn.
const TURNS: usize = 12;
const PIECES: usize = 14;

/// More springs or particles than these without a surface are drawn as lines and small balls: a coil is 170 lines.
const MANY: usize = 60;

/// A pull over this share of the scene's radius is drawn as the strongest.
const STRONG: f64 = 0.5;

/// The share of its radius that a sphere in the way is drawn with.
pub const SHOWN: f32 = 0.965;

/// The most places a trail remembers.
const TRAIL: usize = 3600;

/// How a run is shown, and the buffers of its picture.
pub struct Show {
    /// Mesh or wires.
    pub style: Style,
    /// The particle whose springs are highlighted.
    pub springs_of: Option<usize>,
    /// Without floor and background.
    pub transparent: bool,
    /// Where the hand wants what it holds (m).
    pub hand: Option<Vector3<f64>>,
    /// Where and when (s) the trailing particle was.
    trail: VecDeque<(f64, [f32; 3])>,
    parts: Parts,
    points: Vec<[f32; 4]>,
    balls: Vec<Ball>,
    solids: Vec<Solid>,
    lines: Vec<Line>,
    floor: Option<f32>,
}

impl Show {
    pub fn new(wireframe: bool, springs_of: Option<usize>) -> Self {
        Self {
            style: if wireframe {
                Style::Wireframe
            } else {
                Style::Shaded
            },
            springs_of,
            transparent: false,
            hand: None,
            trail: VecDeque::new(),
            parts: Parts::default(),
            points: vec![],
            balls: vec![],
            solids: vec![],
            lines: vec![],
            floor: None,
        }
    }

    /// Forgets the way so far.
    pub fn clear_trail(&mut self) {
        self.trail.clear();
    }

    /// Where the trailing particle has been.
    #[cfg(test)]
    pub fn trail(&self) -> impl Iterator<Item = &[f32; 3]> {
        self.trail.iter().map(|(_, place)| place)
    }

    /// Remembers where the trailing particle is.
    pub fn follow(&mut self, simulation: &Simulation) {
        let Some(i) = simulation.scene().trail else {
            return;
        };
        let (now, here) = (simulation.time(), to_f32(simulation.position(i)));
        // After going back in time.
        while self.trail.back().is_some_and(|(time, _)| *time > now) {
            self.trail.pop_back();
        }
        if self.trail.back().map(|(_, place)| place) != Some(&here) {
            self.trail.push_back((now, here));
        }
        if self.trail.len() > TRAIL {
            self.trail.pop_front();
        }
    }

    /// Turns the state of the run into a picture.
    pub fn compose(&mut self, simulation: &Simulation) {
        let n = simulation.particles();
        let (x, rest) = simulation.state().split_at(n);
        let (y, z) = rest.split_at(n);
        self.points.clear();
        self.points.extend(
            x.iter()
                .zip(y)
                .zip(z)
                .map(|((x, y), z)| [*x as f32, *y as f32, *z as f32, 0.0]),
        );
        self.parts.look_at(simulation);
        self.parts.paint(&mut self.points);
        self.balls.clear();
        self.solids.clear();
        self.lines.clear();
        self.floor = None;
        if simulation.scene().trail.is_some() {
            self.draw_trail(simulation.time());
        }
        self.draw_parts(simulation);
        self.draw_obstacles(simulation);
        if let Some(i) = self.springs_of {
            self.draw_springs_of(simulation, i);
        }
        if let Some(i) = simulation.grabbed() {
            self.ball(i, 0.055, AMBER);
            self.draw_pull(simulation, i);
        }
    }

    /// The picture composed last, seen by `camera`.
    pub fn picture(&self, camera: Camera, scale: f32) -> Picture<'_> {
        Picture {
            camera,
            style: self.style,
            scale,
            points: &self.points,
            balls: &self.balls,
            solids: &self.solids,
            lines: &self.lines,
            floor: self.floor,
            transparent: self.transparent,
        }
    }

    fn at(&self, i: usize) -> [f32; 3] {
        let [x, y, z, _] = self.points[i];
        [x, y, z]
    }

    fn ball(&mut self, i: usize, radius: f32, color: [f32; 4]) {
        self.balls.push(Ball {
            center: self.at(i),
            radius,
            color,
        });
    }

    /// Older parts are fainter.
    fn draw_trail(&mut self, now: f64) {
        let n = self.trail.partition_point(|(time, _)| *time <= now);
        let places = || self.trail.iter().take(n).map(|(_, place)| place);
        for (k, (a, b)) in places().zip(places().skip(1)).enumerate() {
            let age = 1.0 - (k + 1) as f32 / n as f32;
            let [r, g, b_, _] = TEAL;
            self.lines
                .push(Line::new(*a, *b, 2.2, [r, g, b_, 0.12 + 0.8 * (1.0 - age)]));
        }
    }

    /// What has no surface: coils for its springs, balls for its particles; lines and small balls where there are many. Of
    /// what has one, pins.
    fn draw_parts(&mut self, simulation: &Simulation) {
        let network = simulation.model().network();
        let covered = simulation.scene().surface.particles();
        for (i, _) in network.into_iter().flat_map(Network::pins) {
            if i < covered {
                self.ball(i, 0.032, INK);
            }
        }
        let many = self
            .parts
            .loose()
            .len()
            .max(simulation.particles() - covered)
            > MANY;
        for spring in self.parts.loose() {
            let ends = [spring.i, spring.j];
            if many {
                let [a, b] = ends.map(|i| self.at(i));
                self.lines.push(Line::new(a, b, 1.6, STEEL));
                continue;
            }
            let [a, b] = ends.map(|i| simulation.position(i));
            let points = coil(a, b, spring);
            self.lines.extend(
                points
                    .windows(2)
                    .map(|ends| Line::new(ends[0], ends[1], 2.4, STEEL)),
            );
        }
        if let Some(network) = network {
            let points = &self.points;
            let at = |i: usize| [points[i][0], points[i][1], points[i][2]];
            self.lines.extend(wires::lines(network, at, STEEL));
        }
        for i in covered..simulation.particles() {
            let pinned = network.is_some_and(|n| n.is_pinned(i)) && simulation.grabbed() != Some(i);
            let (radius, color) = match (pinned, many) {
                (true, false) => (0.045, INK),
                (true, true) => (0.032, INK),
                (false, false) => (0.085, RED),
                (false, true) => (0.028, RED),
            };
            self.ball(i, radius, color);
        }
    }

    fn draw_obstacles(&mut self, simulation: &Simulation) {
        let Some(network) = simulation.model().network() else {
            return;
        };
        // A little smaller than they are, so that the flat triangles between particles on them stay outside.
        let inside = |radius: f64| SHOWN * radius as f32;
        for obstacle in network.obstacles() {
            let place = obstacle.path.at(simulation.time()).position;
            match obstacle.shape {
                Shape::Sphere { radius } => self.balls.push(Ball {
                    center: to_f32(place),
                    radius: inside(radius),
                    color: STEEL,
                }),
                Shape::Box { half_extents, axes } => {
                    let least = half_extents.min();
                    let (gap, round) = (0.02 * least, 0.06 * least);
                    self.solids.push(Solid {
                        center: to_f32(place),
                        radius: round as f32,
                        axes: [0, 1, 2].map(|k| axis(axes[k], half_extents[k] - gap - round)),
                        color: STEEL,
                    });
                }
                Shape::Capsule {
                    ends: [a, b],
                    radius,
                } => {
                    let (along, side) = (b - a, a_side(b - a));
                    let y = along.try_normalize(0.0).unwrap_or(Vector3::y());
                    self.solids.push(Solid {
                        center: to_f32(place + 0.5 * (a + b)),
                        radius: inside(radius),
                        axes: [
                            axis(side, 0.0),
                            axis(y, 0.5 * along.norm()),
                            axis(side.cross(&y), 0.0),
                        ],
                        color: STEEL,
                    });
                }
                Shape::Floor => self.floor = Some(place.y as f32),
            }
        }
    }

    /// From the particle to where the hand wants it: thicker and redder, the farther that is.
    fn draw_pull(&mut self, simulation: &Simulation, i: usize) {
        let Some(hand) = self.hand else { return };
        let strength = (hand - simulation.position(i)).norm() / simulation.extent().1;
        if strength < 0.01 {
            return;
        }
        let share = (strength / STRONG).min(1.0) as f32;
        let color = [0, 1, 2, 3].map(|k| AMBER[k] + share * (ALARM[k] - AMBER[k]));
        let to = to_f32(hand);
        self.lines
            .push(Line::new(self.at(i), to, 2.0 + 6.0 * share, color));
        self.balls.push(Ball {
            center: to,
            radius: 0.035,
            color,
        });
    }

    fn draw_springs_of(&mut self, simulation: &Simulation, i: usize) {
        // Bend springs lie over structural ones: the widest first.
        let mut springs = springs_of(simulation, i);
        springs.sort_by_key(|spring| spring.kind != SpringKind::Bend);
        for spring in springs {
            let (width, color) = match spring.kind {
                SpringKind::Structural => (4.0, AMBER),
                SpringKind::Shear => (4.0, TEAL),
                SpringKind::Bend => (8.0, VIOLET),
            };
            self.lines.push(Line::new(
                self.at(spring.i),
                self.at(spring.j),
                width,
                color,
            ));
            let other = spring.i + spring.j - i;
            self.ball(other, 0.035, color);
        }
        self.ball(i, 0.06, AMBER);
    }
}

/// The springs attached to particle i.
pub fn springs_of(simulation: &Simulation, i: usize) -> Vec<Spring> {
    simulation
        .model()
        .network()
        .into_iter()
        .flat_map(|n| n.springs_of(i))
        .collect()
}

/// What it is called.
pub fn kind(kind: SpringKind) -> &'static str {
    match kind {
        SpringKind::Structural => "structural",
        SpringKind::Shear => "shear",
        SpringKind::Bend => "bend",
    }
}

/// The springs attached to particle i, a line each.
pub fn list_springs_of(simulation: &Simulation, i: usize) -> String {
    let springs = springs_of(simulation, i);
    let line = |s: &Spring| {
        let kind = kind(s.kind);
        let SpringLaw {
            stiffness,
            rest_length,
            damping,
        } = s.law;
        let to = s.i + s.j - i;
        format!(
            "  {kind:<10}  to {to:>5}   k = {stiffness:.4} N/m   rest length {rest_length:.4} m   \
             damping {damping:.4} N s/m\n"
        )
    };
    let lines: String = springs.iter().map(line).collect();
    format!("particle {i} has {} springs\n{lines}", springs.len())
}

/// Where the run's scene wants to be looked at from.
pub fn camera(simulation: &Simulation) -> Camera {
    camera_of(simulation.scene())
}

/// Where a scene wants to be looked at from.
pub fn camera_of(scene: &Scene) -> Camera {
    let view = scene.view;
    Camera::look_at(to_f32(view.eye), to_f32(view.target))
}

fn to_f32(v: Vector3<f64>) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// Half axis of a solid: its direction and its length.
fn axis(direction: Vector3<f64>, half: f64) -> [f32; 4] {
    let [x, y, z] = to_f32(direction);
    [x, y, z, half as f32]
}

/// A unit vector across `along`.
fn a_side(along: Vector3<f64>) -> Vector3<f64> {
    let up = if along.y.abs() < 0.9 * along.norm() {
        Vector3::y()
    } else {
        Vector3::x()
    };
    along.cross(&up).try_normalize(0.0).unwrap_or(Vector3::z())
}

/// A coil from a to b with straight ends. Stretched, it gets thinner.
fn coil(a: Vector3<f64>, b: Vector3<f64>, spring: &Spring) -> Vec<[f32; 3]> {
    let along = b - a;
    let length = along.norm();
    if length < 1e-6 {
        return vec![];
    }
    let side = a_side(along);
    let other = along.cross(&side) / length;
    let rest = spring.law.rest_length.max(1e-3);
    let radius = 0.07 * rest.min(1.0) * (rest / length).clamp(0.4, 1.5).sqrt();
    let count = TURNS * PIECES;
    let mut points = vec![to_f32(a)];
    points.extend((0..=count).map(|k| {
        let share = k as f64 / count as f64;
        // Wider from the ends to the middle, so that the coil leaves the axis smoothly.
        let radius = radius * (12.0 * share.min(1.0 - share)).min(1.0);
        let (sin, cos) = (std::f64::consts::TAU * TURNS as f64 * share).sin_cos();
        to_f32(a + along * (0.1 + 0.8 * share) + (side * cos + other * sin) * radius)
    }));
    points.push(to_f32(b));
    points
}
