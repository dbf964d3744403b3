//! A run as a picture: balls, lines and triangles from particles, springs and obstacles; the
//! surfaces of fluids, and the edges of their tanks; the path of a particle, and the pull of the
//! mouse.

use std::collections::VecDeque;
use std::sync::Arc;

use a3_core::elements::Fluid;
use a3_core::{Network, Simulation, Spring, SpringKind, Vector3};
use a3_render::{Ball, Camera, Corner, Floor, Line, Picture, Solid, Style, Topology};
use a3_scenes::{Presentation, TANK_LAYERS};

use super::arrows::Field;
use super::colouring::{Colouring, Scale};
use super::colours::{ALARM, AMBER, BLUE, INK, RED, STEEL, TEAL};
use super::manner::Manner;
use super::parts::Parts;
use super::springs::{KINDS, has_springs, kind_look, springs_of};
use super::vectors::{perpendicular, to_f32};
use super::{ground, obstacles, parts, wires};
use crate::surfaces;

/// Largest number of springs or particles without a surface that are drawn as coils and balls. More
/// of them are drawn as lines and small balls, because a coil has 170 lines.
const MAX_COILS: usize = 60;

/// Radius of balls for particles without a surface where they are few, in units of length of the
/// scene.
const BALL: f32 = 0.085;

/// The view of a run: its options, and the buffers of its picture.
#[derive(Clone)]
pub struct Show {
    /// Presentation of the scene: its surface, camera and trail.
    pub presentation: Arc<Presentation>,
    /// Surface, wires or springs.
    pub style: Style,
    /// The particle whose springs are highlighted.
    pub springs_of: Option<usize>,
    /// Colours by a quantity.
    pub colouring: Colouring,
    /// Arrows on particles.
    pub field: Field,
    /// Whether floor and background are left out.
    pub transparent: bool,
    /// Whether the background is dark and text is light.
    pub dark: bool,
    /// Whether the scene is first seen in an orthographic projection.
    orthographic: bool,
    /// Particle or obstacle under the pointer, which a press would take.
    pub hovered: Option<Target>,
    /// Point to which the mouse pulls (m).
    pub hand: Option<Vector3<f64>>,
    /// A particle, and the point (m) to which a line from it is drawn.
    pub joining: Option<(usize, Vector3<f64>)>,
    /// Path of the particle that leaves a trail.
    trail: Trail,
    parts: Parts,
    points: Vec<[f32; 4]>,
    balls: Vec<Ball>,
    solids: Vec<Solid>,
    lines: Vec<Line>,
    liquid: Liquid,
    floor: Option<Floor>,
    /// Unit of length of the scene (m).
    unit: f32,
}

impl Show {
    /// Creates the view of a scene.
    pub fn new(presentation: Arc<Presentation>, manner: Manner) -> Self {
        let mut colouring = Colouring::default();
        colouring.set_quantity(manner.colour);
        let mut field = Field::default();
        field.set_arrows(manner.arrows);
        let unit = camera(&presentation).unit();
        Self {
            presentation,
            style: manner.style,
            springs_of: manner.springs_of,
            colouring,
            field,
            transparent: false,
            dark: manner.dark,
            orthographic: manner.orthographic,
            hovered: None,
            hand: None,
            joining: None,
            trail: Trail::default(),
            parts: Parts::default(),
            points: vec![],
            balls: vec![],
            solids: vec![],
            lines: vec![],
            liquid: Liquid::default(),
            floor: None,
            unit,
        }
    }

    /// Changes to another scene, with the same options.
    pub fn set_presentation(&mut self, presentation: Arc<Presentation>) {
        self.presentation = presentation;
        self.unit = camera(&self.presentation).unit();
        self.springs_of = None;
        self.hovered = None;
        self.colouring.forget();
        self.field.scale = Scale::default();
        self.clear_trail();
    }

    /// Returns the camera that first shows the scene.
    pub fn camera(&self) -> Camera {
        let mut camera = camera(&self.presentation);
        camera.set_parallel(self.orthographic);
        camera
    }

    /// Returns whether the scene has a surface.
    pub fn has_surface(&self, simulation: &Simulation) -> bool {
        let network = simulation.model().network();
        let flows = network.is_some_and(|network| network.fluid().is_some());
        flows || !self.presentation.surface.triangles.is_empty()
    }

    /// Returns the styles in which the scene looks different, in the order of key w.
    pub fn styles(simulation: &Simulation) -> &'static [Style] {
        if has_springs(simulation) {
            &[Style::Shaded, Style::Wireframe, Style::Springs]
        } else {
            &[Style::Shaded, Style::Wireframe]
        }
    }

    /// Returns the kinds of springs that are drawn in their colours; none in other styles.
    pub fn kinds(&self) -> &[SpringKind] {
        match self.style {
            Style::Springs => self.parts.kinds(),
            Style::Shaded | Style::Wireframe => &[],
        }
    }

    /// Returns the triangles and wires, which stay the same from frame to frame until something
    /// tears.
    pub fn topology(&self, simulation: &Simulation) -> Topology {
        parts::topology(&self.presentation.surface, simulation)
    }

    /// Forgets the trail.
    pub fn clear_trail(&mut self) {
        self.trail.clear();
    }

    /// Returns the points of the trail (m).
    pub fn trail(&self) -> impl Iterator<Item = &[f32; 3]> {
        self.trail.points()
    }

    /// Returns whether a particle leaves a trail.
    pub fn has_trail(&self) -> bool {
        self.presentation.trail.is_some()
    }

    /// Continues the trail to the present place of its particle.
    pub fn follow(&mut self, simulation: &Simulation) {
        if let Some(i) = self.presentation.trail {
            let point = to_f32(simulation.position(i));
            self.trail.add(simulation.time(), point);
        }
    }

    /// Returns the height of the floor or the ground in the picture composed last (m).
    pub fn ground(&self) -> Option<f64> {
        self.floor.as_ref().map(|floor| f64::from(floor.height))
    }

    /// Composes the picture of the present state of the run.
    pub fn compose(&mut self, simulation: &Simulation) {
        let n = simulation.particles();
        let (x, rest) = simulation.state().split_at(n);
        let (y, z) = rest.split_at(n);
        self.points.clear();
        self.points.extend(
            x.iter().zip(y).zip(z).map(|((x, y), z)| [*x as f32, *y as f32, *z as f32, 0.0]),
        );
        self.parts.update(&self.presentation, simulation);
        self.parts.paint(&mut self.points);
        self.colouring.update(simulation);
        self.colouring.paint(&mut self.points);
        self.balls.clear();
        self.solids.clear();
        self.lines.clear();
        self.floor = None;
        if self.presentation.trail.is_some() {
            self.lines.extend(self.trail.lines(simulation.time(), TEAL));
        }
        self.draw_parts(simulation);
        self.draw_tanks(simulation);
        self.liquid = Liquid::of(simulation, self.style, &self.colouring);
        if let Some(network) = simulation.model().network() {
            let time = simulation.time();
            let floor = obstacles::draw(network, time, &mut self.balls, &mut self.solids);
            let solid = |height| Floor { height, solid: true };
            let ground = || ground::below(simulation.scene(), network, &self.presentation);
            self.floor = floor.map(solid).or_else(ground);
            obstacles::add_points(network, time, &mut self.points);
            self.lines.extend(obstacles::meridians(network, time));
            let (balls, solids) = (&mut self.balls, &mut self.solids);
            let (state, lines) = (simulation.state(), &mut self.lines);
            obstacles::draw_bodies(network, state, &self.colouring, balls, solids, lines);
        }
        self.field.draw(simulation, &self.points, &mut self.lines);
        if let Some(i) = self.springs_of {
            self.draw_springs_of(simulation, i);
        }
        self.highlight(simulation);
        if let Some((i, to)) = self.joining.filter(|(i, _)| *i < n) {
            self.ball(i, 0.055, AMBER);
            let line = Line::new(self.at(i), to_f32(to), 3.0, AMBER);
            self.lines.push(line);
        }
        if let Some(i) = simulation.grabbed() {
            self.ball(i, 0.055, AMBER);
            if let Some((line, ball)) =
                self.hand.and_then(|hand| pull(simulation, i, hand, self.unit))
            {
                self.lines.push(line);
                self.balls.push(ball);
            }
        }
    }

    /// Returns the picture composed last, seen by `camera`.
    pub fn picture(&self, camera: Camera, scale: f32) -> Picture<'_> {
        Picture {
            camera,
            // Without springs the picture would be empty.
            style: match self.style {
                Style::Springs if self.parts.kinds().is_empty() => Style::Wireframe,
                style => style,
            },
            scale,
            points: &self.points,
            balls: &self.balls,
            solids: &self.solids,
            lines: &self.lines,
            liquid: self.liquid.as_drawn(),
            floor: self.floor,
            transparent: self.transparent,
            dark: self.dark,
        }
    }

    /// Returns the radius of the balls that particles without a surface are drawn as (m), where
    /// these are few.
    #[must_use]
    pub fn ball_radius(&self) -> f32 {
        BALL * self.unit
    }

    /// Returns the position of particle i (m).
    fn at(&self, i: usize) -> [f32; 3] {
        let [x, y, z, _] = self.points[i];
        [x, y, z]
    }

    /// Draws a ball at particle i. Its radius is in units of length of the scene.
    fn ball(&mut self, i: usize, radius: f32, color: [f32; 4]) {
        self.balls.push(Ball { center: self.at(i), radius: radius * self.unit, color });
    }

    /// Draws springs and particles that have no surface: as coils and balls, or as lines and small
    /// balls where there are many. Of bodies with a surface it draws only pinned particles, and
    /// those that were torn out.
    fn draw_parts(&mut self, simulation: &Simulation) {
        let network = simulation.model().network();
        let covered = self.presentation.surface.particles();
        for (i, _) in network.into_iter().flat_map(Network::pins) {
            if i < covered {
                self.ball(i, 0.032, INK);
            }
        }
        for i in self.parts.crumbs().to_vec() {
            let color = self.colouring.of(i, RED);
            self.ball(i, 0.032, color);
        }
        let many = self.parts.loose().len().max(self.parts.single().len()) > MAX_COILS;
        for spring in self.parts.loose() {
            let ends = [spring.i, spring.j];
            let (own, width) = match self.style {
                Style::Springs => kind_look(spring.kind),
                Style::Shaded | Style::Wireframe => (STEEL, 1.6),
            };
            if many {
                let [a, b] = ends.map(|i| self.at(i));
                let color = self.colouring.of(spring.i, own);
                self.lines.push(Line::new(a, b, width, color).with_shadow());
                continue;
            }
            let [a, b] = ends.map(|i| simulation.position(i));
            let points = coil(a, b, spring, f64::from(self.unit));
            let half = points.len() / 2;
            for (k, part) in points.windows(2).enumerate() {
                let end = if k < half { spring.i } else { spring.j };
                let color = self.colouring.of(end, own);
                let width = 1.5 * width;
                self.lines.push(Line::new(part[0], part[1], width, color).with_shadow());
            }
        }
        if let Some(network) = network {
            let points = &self.points;
            let at = |i: usize| [points[i][0], points[i][1], points[i][2]];
            let pose = |k: usize| network.pose(k, simulation.state());
            let unit = f64::from(self.unit);
            self.lines.extend(wires::lines(network, at, pose, unit, STEEL));
        }
        let fluid = network.and_then(Network::fluid);
        for i in self.parts.single().to_vec() {
            if fluid.is_some_and(|fluid| fluid.members().contains(i)) {
                self.draw_drop(simulation, i);
                continue;
            }
            let pinned = network.is_some_and(|n| n.is_pinned(i)) && simulation.grabbed() != Some(i);
            let (radius, color) = match (pinned, many) {
                (true, false) => (0.045, INK),
                (true, true) => (0.032, INK),
                (false, false) => (BALL, RED),
                (false, true) => (0.028, RED),
            };
            let color = if pinned { color } else { self.colouring.of(i, color) };
            self.ball(i, radius, color);
        }
    }

    /// Draws a particle of fluid as a small ball, in the styles without surfaces.
    fn draw_drop(&mut self, simulation: &Simulation, i: usize) {
        let fluid = simulation.model().network().and_then(Network::fluid);
        let in_wall = self.presentation.tanks.iter().any(|tank| tank.contains(&i));
        let shows = |fluid: &&Fluid| {
            self.style != Style::Shaded && !in_wall && !fluid.members().has_left(i)
        };
        if let Some(fluid) = fluid.filter(shows) {
            let color = self.colouring.of(i, BLUE);
            self.ball(i, 0.3 * fluid.law().spacing as f32 / self.unit, color);
        }
    }

    /// Draws the edges of the space inside each tank.
    fn draw_tanks(&mut self, simulation: &Simulation) {
        let fluid = simulation.model().network().and_then(Network::fluid);
        if let Some(fluid) = fluid {
            let spacing = fluid.law().spacing as f32;
            for tank in &self.presentation.tanks {
                let walls = &self.points[tank.clone()];
                self.lines.extend(edges(walls, spacing));
            }
        }
    }

    /// Highlights the particle or the obstacle under the pointer.
    fn highlight(&mut self, simulation: &Simulation) {
        let network = simulation.model().network();
        match (self.hovered, network) {
            (Some(Target::Particle(i)), _) if i < simulation.particles() => {
                self.ball(i, 0.045, AMBER);
            }
            (Some(Target::Obstacle(k)), Some(network)) => {
                let outline = obstacles::outline(network, k, simulation.time(), AMBER);
                self.lines.extend(outline);
            }
            _ => {}
        }
    }

    /// Highlights the springs of particle i.
    fn draw_springs_of(&mut self, simulation: &Simulation, i: usize) {
        let mut springs = springs_of(simulation, i);
        springs.sort_by_key(|spring| KINDS.iter().position(|kind| *kind == spring.kind));
        for spring in springs {
            let (color, width) = kind_look(spring.kind);
            let [a, b] = [spring.i, spring.j].map(|end| self.at(end));
            self.lines.push(Line::new(a, b, 2.5 * width, color));
            let other = spring.i + spring.j - i;
            self.ball(other, 0.035, color);
        }
        self.ball(i, 0.06, AMBER);
    }
}

/// Number of turns of a coil.
const TURNS: usize = 12;
/// Number of straight pieces of a turn.
const PIECES: usize = 14;

/// Returns the points of a coil from a to b (m) with straight ends. `unit` is the unit of length of
/// the scene (m). A stretched coil is thinner.
pub fn coil(a: Vector3<f64>, b: Vector3<f64>, spring: &Spring, unit: f64) -> Vec<[f32; 3]> {
    let along = b - a;
    let length = along.norm();
    if length < 1e-6 * unit {
        return vec![];
    }
    let side = perpendicular(along);
    let other = along.cross(&side) / length;
    let rest = spring.law.rest_length.max(1e-3 * unit);
    let radius = 0.07 * rest.min(unit) * (rest / length).clamp(0.4, 1.5).sqrt();
    let count = TURNS * PIECES;
    let mut points = vec![to_f32(a)];
    points.extend((0..=count).map(|k| {
        let share = k as f64 / count as f64;
        // The radius grows from the ends to the middle, so that the coil leaves its axis smoothly.
        let radius = radius * (12.0 * share.min(1.0 - share)).min(1.0);
        let (sin, cos) = (std::f64::consts::TAU * TURNS as f64 * share).sin_cos();
        to_f32(a + along * (0.1 + 0.8 * share) + (side * cos + other * sin) * radius)
    }));
    points.push(to_f32(b));
    points
}

/// The surface of a fluid.
#[derive(Clone, Default)]
pub struct Liquid {
    corners: Vec<Corner>,
    triangles: Vec<[u32; 3]>,
}

impl Liquid {
    /// Computes the present surface of the fluid of a run, coloured or not; empty in styles without
    /// surfaces.
    pub fn of(simulation: &Simulation, style: Style, colouring: &Colouring) -> Self {
        if style != Style::Shaded {
            return Self::default();
        }
        let surface = surfaces::Liquid::of(simulation, |i| colouring.share(i));
        let corners = surface.corners.iter().map(|corner| Corner {
            place: corner.place,
            value: corner.value,
            normal: corner.normal,
        });
        Self { corners: corners.collect(), triangles: surface.triangles }
    }

    /// Returns the surface in the form of the renderer.
    pub fn as_drawn(&self) -> a3_render::Liquid<'_> {
        a3_render::Liquid { corners: &self.corners, triangles: &self.triangles }
    }
}

/// Returns the edges of the space inside a tank, which is open at the top. `walls` are the places
/// of the particles of its walls, whose layers are `spacing` apart (m).
pub fn edges(walls: &[[f32; 4]], spacing: f32) -> impl Iterator<Item = Line> + use<> {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for point in walls {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    // The walls are as thick as their layers; in two dimensions there are none across z.
    let wall = (TANK_LAYERS as f32 - 0.5) * spacing;
    for axis in 0..3 {
        let flat = high[axis] - low[axis] < wall;
        low[axis] += if flat { -0.5 * spacing } else { wall };
        high[axis] += match axis {
            1 => 0.5 * spacing,
            _ if flat => 0.5 * spacing,
            _ => -wall,
        };
    }
    let corner = move |k: usize| [0, 1, 2].map(|a| if k >> a & 1 == 1 { high[a] } else { low[a] });
    obstacles::edges_of_box(corner, STEEL)
}

/// Largest number of points of a trail.
const MAX_POINTS: usize = 7200;
/// Width of the line (points).
const WIDTH: f32 = 2.2;

/// Points on the path of a particle (m), with their times (s).
#[derive(Clone, Default)]
pub struct Trail(VecDeque<(f64, [f32; 3])>);

impl Trail {
    /// Forgets all points.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Returns the points (m).
    pub fn points(&self) -> impl Iterator<Item = &[f32; 3]> {
        self.0.iter().map(|(_, point)| point)
    }

    /// Adds the point (m) where the particle is at `time` (s). Points of later times are dropped,
    /// because the user may have gone back in time.
    pub fn add(&mut self, time: f64, point: [f32; 3]) {
        while self.0.back().is_some_and(|(last, _)| *last > time) {
            self.0.pop_back();
        }
        if self.0.back().map(|(_, last)| last) != Some(&point) {
            self.0.push_back((time, point));
        }
        if self.0.len() > MAX_POINTS {
            self.0.pop_front();
        }
    }

    /// Returns lines along the path up to `time` (s), the older the fainter.
    pub fn lines(&self, time: f64, [r, g, b, _]: [f32; 4]) -> impl Iterator<Item = Line> {
        let n = self.0.partition_point(|(then, _)| *then <= time);
        let points = move || self.0.iter().take(n).map(|(_, point)| *point);
        points().zip(points().skip(1)).enumerate().map(move |(k, (from, to))| {
            let age = 1.0 - (k + 1) as f32 / n as f32;
            Line::new(from, to, WIDTH, [r, g, b, 0.12 + 0.8 * (1.0 - age)])
        })
    }
}

/// Length of a pull from which on it is drawn with the strongest line, as a share of the scene's
/// radius.
const MAX_PULL: f64 = 0.5;

/// Returns a line from particle i to the pointer (m), thicker and redder the longer it is, and a
/// ball at its end; `None` while the pointer is at the particle. `unit` is the unit of length of
/// the scene (m).
pub fn pull(
    simulation: &Simulation,
    i: usize,
    hand: Vector3<f64>,
    unit: f32,
) -> Option<(Line, Ball)> {
    let place = simulation.position(i);
    let strength = (hand - place).norm() / simulation.extent().1;
    if strength < 0.01 {
        return None;
    }
    let share = (strength / MAX_PULL).min(1.0) as f32;
    let color = [0, 1, 2, 3].map(|k| AMBER[k] + share * (ALARM[k] - AMBER[k]));
    let to = to_f32(hand);
    let ball = Ball { center: to, radius: 0.035 * unit, color };
    let line = Line::new(to_f32(place), to, 2.0 + 6.0 * share, color);
    Some((line, ball))
}

/// Returns the camera that first shows a scene.
pub fn camera(presentation: &Presentation) -> Camera {
    let viewpoint = presentation.viewpoint;
    Camera::look_at(to_f32(viewpoint.eye), to_f32(viewpoint.target))
}

/// A particle or an obstacle, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    Particle(usize),
    Obstacle(usize),
}

impl Target {
    /// Returns the number of the particle, if the target is one.
    pub fn particle(self) -> Option<usize> {
        match self {
            Self::Particle(i) => Some(i),
            Self::Obstacle(_) => None,
        }
    }
}
