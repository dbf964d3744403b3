//! From a description to a scene.

use std::sync::Arc;

use a3_core::colliders::{Capsule, Cuboid, Floor, Sphere};
use a3_core::elements::{Air, Buckling, Sheet, Wind};
use a3_core::{
    Constraint, Error, Grid, MAX_PARTICLES, Model, Network, Path, Scene, Spring, SpringKind,
    SpringLaw, Surface, Swing, Vector3, View, integrators,
};

use crate::bodies::{Body, Woven, in_body};
use crate::check::{at_least, positive};
use crate::circle::Circling;
use crate::{ConstraintSpec, Description, Fault, Mesh, Pin, Shift, Sine, SpringSpec, Triple};

/// The most springs that are in no grid.
const MAX_SPRINGS: usize = 1 << 23;
/// The most pieces of one kind.
const MAX_OBSTACLES: usize = 1000;

/// How much there is of a body.
pub(super) struct Sizes {
    pub particles: usize,
    pub springs: usize,
}

/// What bodies put together.
#[derive(Default)]
pub(super) struct Assembly {
    pub masses: Vec<f64>,
    pub positions: Vec<Vector3<f64>>,
    pub velocities: Vec<Vector3<f64>>,
    /// Of the first cloth.
    pub sheet: Option<Sheet>,
    pub grid: Option<Grid>,
    pub surface: Surface,
    springs: Vec<Spring>,
    strips: Vec<Buckling>,
    pub rods: Vec<Constraint>,
    pins: Vec<(usize, Path)>,
}

impl Assembly {
    /// Springs between particles that are numbered from `first` on.
    pub fn add_springs(&mut self, first: usize, springs: impl IntoIterator<Item = Spring>) {
        self.springs.extend(springs.into_iter().map(|s| Spring {
            i: s.i + first,
            j: s.j + first,
            ..s
        }));
    }

    /// Buckling springs between particles that are numbered from `first` on.
    pub fn add_strips(&mut self, first: usize, strips: Vec<Buckling>) {
        self.strips.extend(strips.into_iter().map(|s| Buckling {
            i: s.i + first,
            j: s.j + first,
            ..s
        }));
    }

    /// The particles so far are those of bodies with a surface.
    pub fn end_surface(&mut self) {
        self.surface.bodies.push(self.masses.len());
    }

    fn add(&mut self, key: &str, body: &dyn Body) -> Result<(), Fault> {
        let wrong = |wrong| in_body(key, wrong);
        let sizes = body.sizes().map_err(wrong)?;
        let particles = self.masses.len().saturating_add(sizes.particles);
        if particles > MAX_PARTICLES {
            return Err(Fault::new(
                key,
                format!(
                    "that makes {particles} particles, and a scene has at most {MAX_PARTICLES}"
                ),
            ));
        }
        // Springs of the first cloth are those of a grid.
        let springs = self.springs.len().saturating_add(sizes.springs);
        if springs > MAX_SPRINGS && !(key.starts_with("cloth") && self.masses.is_empty()) {
            return Err(Fault::new(
                key,
                format!(
                    "that makes some {springs} springs, and there are at most {MAX_SPRINGS} beside those of the first cloth"
                ),
            ));
        }
        let first = self.masses.len();
        body.add_to(self).map_err(wrong)?;
        let positions = &self.positions[first..];
        let pins = pins(key, body.pins(), positions, |spot| {
            body.spot(spot, positions)
        })?;
        self.pins
            .extend(pins.into_iter().map(|(i, path)| (first + i, path)));
        Ok(())
    }
}

/// The particles of pins, with their paths.
fn pins(
    body: &str,
    pins: &[Pin],
    positions: &[Vector3<f64>],
    spot: impl Fn(crate::Spot) -> Option<Vec<usize>>,
) -> Result<Vec<(usize, Path)>, Fault> {
    let mut all = vec![];
    for (k, pin) in pins.iter().enumerate() {
        let key = |part: &str| {
            let key = if pins.len() == 1 {
                "pin".into()
            } else {
                format!("pin.{k}")
            };
            let key = if body.is_empty() {
                key
            } else {
                format!("{body}.{key}")
            };
            format!("{key}.{part}")
        };
        let mut particles = pin.particles.clone();
        if let Some(i) = particles.iter().find(|i| **i >= positions.len()) {
            return Err(Fault::new(
                key("particles"),
                format!(
                    "there is no particle {i}: they are numbered 0 to {}",
                    positions.len() - 1
                ),
            ));
        }
        for place in &pin.at {
            let Some(there) = spot(*place) else {
                return Err(Fault::new(
                    key("at"),
                    "a cloth has top, bottom, left, right, top-left, top-right, bottom-left, bottom-right; a jelly top, \
                     bottom, left, right; a mesh top, bottom; a chain first, last; others are pinned by `particles`",
                ));
            };
            particles.extend(there);
        }
        if particles.is_empty() {
            return Err(Fault::new(
                key("").trim_end_matches('.'),
                "pins nothing: it needs the key `at` or `particles`",
            ));
        }
        for i in particles {
            let path = path(positions[i], pin.sine.as_ref(), pin.shift.as_ref())
                .map_err(|(part, why)| Fault::new(key(part), why))?;
            all.push((i, path));
        }
    }
    Ok(all)
}

/// What is at `from` at first.
fn path(
    from: Vector3<f64>,
    sine: Option<&Sine>,
    shift: Option<&Shift>,
) -> Result<Path, (&'static str, String)> {
    match (sine, shift) {
        (None, None) => Ok(Path::Still(from)),
        (Some(sine), None) => Ok(Path::Sine {
            center: match sine.center {
                None => from,
                Some(center) => finite(center).map_err(|why| ("sine.center", why))?,
            },
            amplitude: finite(sine.amplitude).map_err(|why| ("sine.amplitude", why))?,
            rate: number(sine.rate).map_err(|why| ("sine.rate", why))?,
            phase: number(sine.phase).map_err(|why| ("sine.phase", why))?,
        }),
        (None, Some(shift)) => {
            let by = finite(shift.by).map_err(|why| ("shift.by", why))?;
            let start = number(shift.start).map_err(|why| ("shift.start", why))?;
            let end = number(shift.end).map_err(|why| ("shift.end", why))?;
            if end <= start {
                return Err((
                    "shift.end",
                    format!("it must be later than {start} s, not {end}"),
                ));
            }
            Ok(Path::Line {
                from,
                to: from + by,
                start,
                end,
            })
        }
        (Some(_), Some(_)) => Err(("shift", "give either `sine` or `shift`, not both".into())),
    }
}

/// Numbers past this are slips (m, m/s, rad, s).
const LARGEST: f64 = 1e9;

pub(super) fn number(x: f64) -> Result<f64, String> {
    if x.abs() <= LARGEST {
        Ok(x)
    } else {
        Err(format!(
            "it must be a number from {:e} to {LARGEST:e}, not {x}",
            -LARGEST
        ))
    }
}

pub(super) fn finite(triple: Triple) -> Result<Vector3<f64>, String> {
    for x in triple {
        number(x)?;
    }
    Ok(triple.into())
}

/// Springs among `particles` particles.
pub(super) fn springs(list: &[SpringSpec], particles: usize) -> Result<Vec<Spring>, String> {
    let spring = |(k, &(i, j, stiffness, rest_length, damping)): (usize, &SpringSpec)| {
        let wrong = |why: String| format!("spring {k}, counted from 0: {why}");
        if i.max(j) >= particles || i == j {
            return Err(wrong(format!(
                "{i} and {j} are no two particles of 0 to {}",
                particles - 1
            )));
        }
        let law =
            SpringLaw::new(stiffness, rest_length, damping).map_err(|e| wrong(e.to_string()))?;
        Ok(Spring {
            kind: SpringKind::Structural,
            i,
            j,
            law,
        })
    };
    list.iter().enumerate().map(spring).collect()
}

impl Description {
    /// The scene, with this grid of its first cloth instead of its own, if one is given. `mesh` reads a file of triangles.
    ///
    /// # Errors
    /// A number makes no sense, and why; or there is no such file.
    pub fn build(
        &self,
        grid: Option<Grid>,
        mesh: &mut dyn FnMut(&str) -> Result<Mesh, String>,
    ) -> Result<Scene, Fault> {
        let Some(grid) = grid else {
            return self.assemble(mesh);
        };
        let Some(own) = self.cloth.first() else {
            return Err(Fault::new(
                "",
                format!(
                    "the scene {} has no grid",
                    self.name.as_deref().unwrap_or_default()
                ),
            ));
        };
        let own_spacing = own.spacing().map_err(|w| in_body("cloth", w))?;
        let mut other = self.clone();
        other.cloth[0].grid = [grid.rows(), grid.cols()];
        let spacing = other.cloth[0].spacing().map_err(|w| in_body("cloth", w))?;
        let mut scene = other.assemble(mesh)?;
        scene.step_scale = (spacing / own_spacing).min(1.0);
        // From as far away as it is larger.
        if let Ok(own) = self.assemble(mesh) {
            let (was, small) = own.extent();
            let (is, large) = scene.extent();
            let zoom = (large / small).max(1.0);
            for point in [&mut scene.view.eye, &mut scene.view.target] {
                *point = is + (*point - was) * zoom;
            }
        }
        Ok(scene)
    }

    fn assemble(&self, mesh: &mut dyn FnMut(&str) -> Result<Mesh, String>) -> Result<Scene, Fault> {
        let (model, mut state, surface, grid) = match &self.circle {
            Some(circle) => {
                let start = finite(circle.start).map_err(|why| Fault::new("circle.start", why))?;
                let model = Model::FirstOrder(Arc::new(Circling));
                (model, start.as_slice().to_vec(), Surface::default(), None)
            }
            None => self.masses_and_springs(mesh)?,
        };
        if self.circle.is_some() && self.bodies() > 0 {
            return Err(Fault::new(
                "circle",
                "it is of first order, and goes with no other body",
            ));
        }
        if let Some(given) = &self.state {
            write_state(given, model.particles(), &mut state)?;
        }
        let n = model.particles();
        if let Some(trail) = self.trail.filter(|i| *i >= n) {
            return Err(Fault::new(
                "trail",
                format!(
                    "there is no particle {trail}: they are numbered 0 to {}",
                    n - 1
                ),
            ));
        }
        let mut scene = Scene::new(self.name.clone().unwrap_or_default(), model, state);
        (scene.grid, scene.surface, scene.trail) = (grid, surface.into(), self.trail);
        if let Some(camera) = &self.camera {
            scene.view = View {
                eye: finite(camera.eye).map_err(|why| Fault::new("camera.eye", why))?,
                target: finite(camera.target).map_err(|why| Fault::new("camera.target", why))?,
            };
            if scene.view.eye == scene.view.target {
                return Err(Fault::new("camera.eye", "it must not be at the target"));
            }
        }
        if let Some(reach) = self.reach {
            at_least(1.0, "it", reach).map_err(|e| Fault::new("reach", e))?;
            scene.reach = reach;
        }
        if let Some(swing) = &self.swing {
            scene.swing = Some(Swing {
                amplitude: finite(swing.amplitude)
                    .map_err(|why| Fault::new("swing.amplitude", why))?,
                rate: number(swing.rate).map_err(|why| Fault::new("swing.rate", why))?,
            });
        }
        scene.wind = self.wind(scene.model.network())?;
        if let Model::Network(network) = &mut scene.model
            && self.wind.as_ref().is_some_and(|wind| wind.on)
        {
            network.set_wind(scene.wind);
        }
        self.how_it_runs(&mut scene)?;
        Ok(scene)
    }

    /// How many bodies there are, but for the circle.
    fn bodies(&self) -> usize {
        self.cloth.len()
            + self.jelly.len()
            + self.mesh.len()
            + self.chain.len()
            + usize::from(self.particles.is_some())
    }

    fn how_it_runs(&self, scene: &mut Scene) -> Result<(), Fault> {
        scene.solver = match self.solver.as_deref() {
            None => None,
            Some(name) => Some(integrators::find(name).ok_or_else(|| {
                let names: Vec<_> = integrators::METHODS.iter().map(|m| m.name).collect();
                Fault::new(
                    "solver",
                    format!("there is no `{name}`: there are {}", names.join(", ")),
                )
            })?),
        };
        for (key, number) in [("step", self.step), ("duration", self.duration)] {
            if let Some(number) = number {
                positive("it", number).map_err(|e| Fault::new(key, e))?;
            }
        }
        if self.step.is_some() && self.solver.is_none() {
            return Err(Fault::new("step", "a step needs the key `solver` too"));
        }
        let own = scene.solver.zip(self.step);
        scene.control = own.map(|(solver, step)| solver.control(step));
        scene.duration = self.duration;
        Ok(())
    }

    /// Everything but the circle.
    fn masses_and_springs(
        &self,
        mesh: &mut dyn FnMut(&str) -> Result<Mesh, String>,
    ) -> Result<(Model, Vec<f64>, Surface, Option<Grid>), Fault> {
        if self.bodies() == 0 {
            return Err(Fault::new(
                "",
                "there is nothing in the scene: it needs at least one of cloth, jelly, mesh, chain, particles, circle",
            ));
        }
        let mut assembly = Assembly::default();
        let name = |kind: &str, k: usize, count: usize| Place::of(kind, k, count).0;
        for (k, body) in self.cloth.iter().enumerate() {
            assembly.add(&name("cloth", k, self.cloth.len()), body)?;
        }
        for (k, body) in self.jelly.iter().enumerate() {
            assembly.add(&name("jelly", k, self.jelly.len()), body)?;
        }
        for (k, cloth) in self.mesh.iter().enumerate() {
            let key = name("mesh", k, self.mesh.len());
            let mesh = mesh(&cloth.file).map_err(|why| Fault::new(format!("{key}.file"), why))?;
            let mesh = mesh.welded();
            assembly.add(&key, &Woven { cloth, mesh })?;
        }
        for (k, body) in self.chain.iter().enumerate() {
            assembly.add(&name("chain", k, self.chain.len()), body)?;
        }
        if let Some(body) = &self.particles {
            assembly.add("particles", body)?;
        }
        let n = assembly.masses.len();
        let between = springs(&self.springs, n).map_err(|why| Fault::new("springs", why))?;
        assembly.springs.extend(between);
        let given = self.state.as_ref().map(|state| &state.positions);
        let given = given.filter(|positions| positions.len() == n);
        let given = given.map(|all| all.iter().map(|p| Vector3::from(*p)).collect::<Vec<_>>());
        let places = given.as_ref().unwrap_or(&assembly.positions);
        let more = pins("", &self.pin, places, |_| None)?;
        assembly.pins.extend(more);
        let state: Vec<_> = column_major(&assembly.positions)
            .chain(column_major(&assembly.velocities))
            .collect();
        let Assembly {
            masses,
            sheet,
            springs,
            strips,
            rods,
            pins,
            surface,
            grid,
            ..
        } = assembly;
        let whole = |e: Error| Fault::new("", e);
        let mut network = Network::new(masses).map_err(whole)?;
        if let Some(sheet) = sheet {
            network.set_sheet(sheet).map_err(whole)?;
        }
        network.add_springs(springs).map_err(whole)?;
        for (k, strip) in strips.into_iter().enumerate() {
            let wrong = |e| Fault::new("buckling", format!("bend spring {k}, counted from 0: {e}"));
            network.add_buckling(strip).map_err(wrong)?;
        }
        for rod in rods {
            network.add_constraint(rod).map_err(whole)?;
        }
        self.add_constraints(&mut network, &state)?;
        let triangles = surface.triangles.iter();
        network
            .set_triangles(triangles.map(|t| t.map(|i| i as usize)))
            .map_err(whole)?;
        for (i, path) in pins {
            network.pin(i, path).map_err(whole)?;
        }
        self.set_forces(&mut network)?;
        Ok((Model::Network(Box::new(network)), state, surface, grid))
    }

    fn add_constraints(&self, network: &mut Network, state: &[f64]) -> Result<(), Fault> {
        if let Some(w) = self.feedback {
            let set = network.set_feedback(w);
            set.map_err(|e| Fault::new("feedback", e))?;
        }
        let n = network.particles();
        for (k, spec) in self.constraint.iter().enumerate() {
            let at = Place::of("constraint", k, self.constraint.len());
            let constraint = match spec {
                ConstraintSpec {
                    rod: Some([i, j]),
                    length,
                    particle: None,
                    point: None,
                    line: None,
                    circle: None,
                    sphere: None,
                } => {
                    for end in [i, j] {
                        at.check("rod", network.check_particle(*end))?;
                    }
                    let point = |i: usize| Vector3::new(state[i], state[n + i], state[2 * n + i]);
                    Constraint::Rod {
                        i: *i,
                        j: *j,
                        length: length.unwrap_or((point(*i) - point(*j)).norm()),
                    }
                }
                ConstraintSpec {
                    rod: None,
                    length: None,
                    particle: Some(particle),
                    ..
                } => {
                    at.check("particle", network.check_particle(*particle))?;
                    at.wire(*particle, spec)?
                }
                _ => {
                    return Err(at.wrong(
                        "takes either `rod`, of two particles, or `particle` with one of `point`, `line`, `circle`, `sphere`",
                    ));
                }
            };
            let added = network.add_constraint(constraint);
            added.map_err(|e| at.wrong(e))?;
        }
        Ok(())
    }

    fn set_forces(&self, network: &mut Network) -> Result<(), Fault> {
        if let Some(g) = self.gravity {
            network.set_gravity(finite(g).map_err(|why| Fault::new("gravity", why))?);
        }
        let drag = match (self.drag, self.drag_per_mass) {
            (Some(_), Some(_)) => {
                return Err(Fault::new(
                    "drag_per_mass",
                    "give either `drag` or `drag_per_mass`, not both",
                ));
            }
            (Some(drag), None) => Some(("drag", drag)),
            (None, Some(rate)) => Some(("drag_per_mass", rate * mean(network.masses()))),
            (None, None) => None,
        };
        if let Some((key, drag)) = drag {
            network.set_drag(drag).map_err(|e| Fault::new(key, e))?;
        }
        if let Some(height) = self.floor {
            let height = number(height).map_err(|why| Fault::new("floor", why))?;
            network.set_floor(Floor { height });
        }
        network
            .set_tear(self.tear)
            .map_err(|e| Fault::new("tear", e))?;
        network
            .break_springs(&self.torn)
            .map_err(|e| Fault::new("torn", e))?;
        self.add_obstacles(network)
    }

    fn add_obstacles(&self, network: &mut Network) -> Result<(), Fault> {
        for (key, count) in [
            ("sphere", self.sphere.len()),
            ("box", self.boxes.len()),
            ("capsule", self.capsule.len()),
        ] {
            if count > MAX_OBSTACLES {
                let why = format!("there are at most {MAX_OBSTACLES}, not {count}");
                return Err(Fault::new(key, why));
            }
        }
        for (k, sphere) in self.sphere.iter().enumerate() {
            let at = Place::of("sphere", k, self.sphere.len());
            at.check("radius", positive("it", sphere.radius))?;
            let center = at.vector("center", sphere.center)?;
            network.add_sphere(Sphere {
                path: at.path(center, sphere.sine.as_ref(), sphere.shift.as_ref())?,
                radius: sphere.radius,
            });
        }
        for (k, cuboid) in self.boxes.iter().enumerate() {
            let at = Place::of("box", k, self.boxes.len());
            let center = at.vector("center", cuboid.center)?;
            let path = at.path(center, cuboid.sine.as_ref(), cuboid.shift.as_ref())?;
            let size = at.vector("size", cuboid.size)?;
            let turn = at.vector("rotation", cuboid.rotation.unwrap_or_default())?;
            for edge in cuboid.size {
                at.check("size", positive("each edge", edge))?;
            }
            network.add_box(at.check("size", Cuboid::new(path, 0.5 * size, turn))?);
        }
        for (k, capsule) in self.capsule.iter().enumerate() {
            let at = Place::of("capsule", k, self.capsule.len());
            let (from, to) = (
                at.vector("from", capsule.from)?,
                at.vector("to", capsule.to)?,
            );
            let path = at.path(from, capsule.sine.as_ref(), capsule.shift.as_ref())?;
            let ends = [Vector3::zeros(), to - from];
            let capsule = Capsule::new(path, ends, capsule.radius);
            network.add_capsule(at.check("radius", capsule)?);
        }
        Ok(())
    }

    fn wind(&self, network: Option<&Network>) -> Result<Option<Wind>, Fault> {
        let (Some(wind), Some(network)) = (&self.wind, network) else {
            return Ok(None);
        };
        let given = [
            ("wind.force", wind.force),
            ("wind.force_per_mass", wind.force_per_mass),
            ("wind.velocity", wind.velocity),
        ];
        let given: Vec<_> = given
            .into_iter()
            .filter_map(|(key, x)| Some((key, x?)))
            .collect();
        let [(key, blow)] = given[..] else {
            return Err(Fault::new(
                "wind",
                "give one of the keys `force`, `force_per_mass` and `velocity`",
            ));
        };
        let ahead = number(wind.ahead).map_err(|why| Fault::new("wind.ahead", why))?;
        let blow = finite(blow).map_err(|why| Fault::new(key, why))?;
        let air = [
            ("wind.density", wind.density, 1.2),
            ("wind.drag", wind.drag, 1.2),
            ("wind.lift", wind.lift, 0.6),
        ];
        if key != "wind.velocity" {
            if let Some((key, ..)) = air.iter().find(|(_, given, _)| given.is_some()) {
                return Err(Fault::new(*key, "it is for a wind with a `velocity`"));
            }
            let of_particles = if key == "wind.force" {
                1.0
            } else {
                mean(network.masses())
            };
            return Ok(Some(Wind::new(wind.seed, blow * of_particles).ahead(ahead)));
        }
        for (key, given, usual) in air {
            at_least(0.0, "it", given.unwrap_or(usual)).map_err(|e| Fault::new(key, e))?;
        }
        let [density, drag, lift] = air.map(|(_, given, usual)| given.unwrap_or(usual));
        let air = Air::new(density, drag, lift).map_err(|e| Fault::new("wind", e))?;
        Ok(Some(Wind::on_triangles(wind.seed, blow, air).ahead(ahead)))
    }
}

/// The key of one of several pieces.
struct Place(String);

impl Place {
    fn of(kind: &str, k: usize, count: usize) -> Self {
        Self(if count == 1 {
            kind.into()
        } else {
            format!("{kind}.{k}")
        })
    }

    fn wrong(&self, why: impl std::fmt::Display) -> Fault {
        Fault::new(self.0.clone(), why)
    }

    /// What a particle stays on.
    fn wire(&self, particle: usize, spec: &ConstraintSpec) -> Result<Constraint, Fault> {
        Ok(match (spec.point, &spec.line, &spec.circle, &spec.sphere) {
            (Some(position), None, None, None) => Constraint::Point {
                particle,
                position: self.vector("point", position)?,
            },
            (None, Some(line), None, None) => Constraint::Line {
                particle,
                point: self.vector("line.point", line.point)?,
                direction: self.vector("line.direction", line.direction)?,
            },
            (None, None, Some(circle), None) => Constraint::Circle {
                particle,
                center: self.vector("circle.center", circle.center)?,
                normal: self.vector("circle.normal", circle.normal)?,
                radius: circle.radius,
            },
            (None, None, None, Some(sphere)) => Constraint::Sphere {
                particle,
                center: self.vector("sphere.center", sphere.center)?,
                radius: sphere.radius,
            },
            _ => {
                return Err(self.wrong("takes one of `point`, `line`, `circle`, `sphere`"));
            }
        })
    }

    fn check<T>(&self, part: &str, result: Result<T, Error>) -> Result<T, Fault> {
        result.map_err(|e| Fault::new(format!("{}.{part}", self.0), e))
    }

    fn vector(&self, part: &str, triple: Triple) -> Result<Vector3<f64>, Fault> {
        finite(triple).map_err(|why| Fault::new(format!("{}.{part}", self.0), why))
    }

    fn path(
        &self,
        from: Vector3<f64>,
        sine: Option<&Sine>,
        shift: Option<&Shift>,
    ) -> Result<Path, Fault> {
        path(from, sine, shift).map_err(|(part, why)| Fault::new(format!("{}.{part}", self.0), why))
    }
}

/// All x, then all y, then all z.
fn column_major(points: &[Vector3<f64>]) -> impl Iterator<Item = f64> {
    (0..3).flat_map(|axis| points.iter().map(move |p| p[axis]))
}

fn mean(masses: &[f64]) -> f64 {
    // The same number, where they are all the same.
    if masses.iter().all(|m| *m == masses[0]) {
        masses[0]
    } else {
        masses.iter().sum::<f64>() / masses.len() as f64
    }
}

/// Sets a state to what is given of it: of a system of first order, positions only.
fn write_state(given: &crate::State, particles: usize, state: &mut [f64]) -> Result<(), Fault> {
    let parts = [
        ("state.positions", &given.positions),
        ("state.velocities", &given.velocities),
    ];
    state[3 * particles..].fill(0.0);
    for ((key, rows), out) in parts.into_iter().zip(state.chunks_exact_mut(3 * particles)) {
        if key == "state.velocities" && rows.is_empty() {
            continue;
        }
        if rows.len() != particles {
            let why = format!("there are {} for {particles} particles", rows.len());
            return Err(Fault::new(key, why));
        }
        for (i, row) in rows.iter().enumerate() {
            let row = finite(*row).map_err(|why| Fault::new(key, why))?;
            for axis in 0..3 {
                out[axis * particles + i] = row[axis];
            }
        }
    }
    Ok(())
}
