//! Parts of a scene that can be left out or replaced by simpler ones.

use crate::assemble::{air, damping_time};
use crate::description::{Description, Floor, Jelly};
use crate::material::lattice;

/// Part of a scene that can be left out or replaced by a simpler one.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Name of the part, in words.
    pub name: String,
    /// How the part is left out.
    pub change: Change,
}

/// Keys of the kinds of obstacles.
const OBSTACLES: [&str; 4] = ["sphere", "box", "capsule", "obstacle"];

/// Names of the kinds of springs.
const SPRINGS: [&str; 3] = ["structural springs", "shear springs", "bend springs"];

/// Lists the parts of the scene that can be left out or replaced by simpler ones.
#[must_use]
pub fn parts(scene: &Description) -> Vec<Part> {
    let named = |change, name: &str| Part { name: name.into(), change };
    let mut all =
        vec![named(Change::Drag, "drag"), named(Change::Damping, "damping of springs and solids")];
    all.extend((0..3).map(|kind| named(Change::Springs(kind), SPRINGS[kind])));
    all.extend([
        named(Change::Buckling, "buckling of bend springs"),
        named(Change::StrainLimit, "limit of strain"),
        named(Change::TensionOnly, "springs that only pull: that push too"),
        named(Change::Ropes, "ropes"),
        named(Change::Gas, "gas in meshes"),
        named(Change::Tear, "tearing"),
        named(Change::Viscosity, "viscosity"),
        named(Change::Gravity, "gravity"),
        named(Change::Wind, "wind"),
        named(Change::Gusts, "gusts"),
        named(Change::WindByParticles, "wind on triangles: on particles"),
        named(Change::Friction, "friction"),
        named(Change::Restitution, "restitution"),
        named(Change::SelfCollision, "self-collision"),
        named(Change::Floor, "floor"),
    ]);
    let (spheres, boxes) = (scene.sphere.len(), scene.boxes.len());
    let counts = [spheres, boxes, scene.capsule.len(), scene.obstacle.len()];
    for (kind, (name, count)) in OBSTACLES.iter().zip(counts).enumerate() {
        let numbered = |k: usize| match count {
            1 => (*name).to_owned(),
            _ => format!("{name} {}", k + 1),
        };
        all.extend((0..count).map(|k| named(Change::Obstacle(kind, k), &numbered(k))));
    }
    all.extend([
        named(Change::Rods, "springs of chains: rods"),
        named(Change::Jelly, "solids: jellies of springs"),
    ]);
    all.retain(|part| without(scene, [part]) != *scene);
    all
}

/// Returns the scene without some of its [`parts`].
///
/// ```
/// let scene = a3_scenes::find("cloth").unwrap().description()?;
/// let parts = a3_scenes::parts(&scene);
/// let gravity = parts.iter().find(|part| part.name == "gravity").unwrap();
/// assert!(scene.gravity.is_some() && a3_scenes::without(&scene, [gravity]).gravity.is_none());
/// # Ok::<(), a3_core::Error>(())
/// ```
#[must_use]
pub fn without<'a>(scene: &Description, parts: impl IntoIterator<Item = &'a Part>) -> Description {
    let mut changed = scene.clone();
    let mut obstacles = vec![];
    for part in parts {
        match part.change {
            Change::Obstacle(kind, k) => obstacles.push((kind, k)),
            change => leave_out(&mut changed, change),
        }
    }
    // The last is removed first, so that the indices of the others stay.
    obstacles.sort_unstable();
    for (kind, k) in obstacles.into_iter().rev() {
        match kind {
            0 => drop(changed.sphere.remove(k)),
            1 => drop(changed.boxes.remove(k)),
            2 => drop(changed.capsule.remove(k)),
            _ => drop(changed.obstacle.remove(k)),
        }
    }
    changed
}

/// Makes a change, except for obstacles, whose indices depend on one another.
fn leave_out(scene: &mut Description, change: Change) {
    match change {
        Change::Gravity => scene.change_gravity(None),
        Change::Drag => (scene.drag, scene.drag_per_mass) = (None, None),
        Change::Damping => leave_out_damping(scene),
        Change::Springs(kind) => leave_out_springs(scene, kind),
        Change::Buckling => {
            let laws = scene.bodies_mut().filter_map(|body| body.buckling);
            laws.for_each(|law| *law = None);
        }
        Change::StrainLimit => {
            let limits = scene.bodies_mut().filter_map(|body| body.strain_limit);
            limits.for_each(|limit| *limit = None);
        }
        Change::TensionOnly => {
            let all = scene.bodies_mut().filter_map(|body| body.tension_only);
            all.for_each(|only| *only = false);
            scene.tension_only = false;
        }
        Change::Gas => {
            let meshes = scene.mesh.iter_mut();
            meshes.for_each(|mesh| (mesh.pressure, mesh.fill) = (None, None));
        }
        Change::Ropes => scene.constraint.retain(|it| it.rope.is_none()),
        Change::Tear => scene.tear = None,
        Change::Viscosity => scene.fluid.iter_mut().for_each(|it| it.viscosity = 0.0),
        Change::Wind => scene.wind.iter_mut().for_each(|wind| wind.on = false),
        Change::Gusts => scene.wind.iter_mut().for_each(|wind| wind.steady |= wind.on),
        Change::WindByParticles => simplify_wind(scene),
        Change::Friction => {
            each_contact(scene, |[friction, _]| *friction = 0.0);
            (scene.body.iter_mut()).for_each(|body| body.rolling_friction = 0.0);
        }
        Change::Restitution => each_contact(scene, |[_, restitution]| *restitution = 0.0),
        Change::SelfCollision => scene.self_collision = false,
        Change::Floor => scene.floor = None,
        Change::Obstacle(..) => {}
        Change::Rods => {
            for chain in &mut scene.chain {
                let holds = chain.stiffness > 0.0 && !chain.tension_only;
                chain.rigid |= holds && chain.buckling.is_none();
                if chain.rigid {
                    (chain.stiffness, chain.damping) = (0.0, 0.0);
                }
            }
        }
        Change::Jelly => replace_solids(scene),
    }
}

/// Sets the damping of all springs and solids to zero.
fn leave_out_damping(scene: &mut Description) {
    for body in scene.bodies_mut() {
        let numbers = body.damping.into_iter().chain(body.damping_ratio);
        numbers.for_each(|number| *number = None);
    }
    scene.solid.iter_mut().for_each(|solid| solid.damping = 0.0);
    scene.chain.iter_mut().for_each(|chain| chain.damping = 0.0);
    let particles = scene.particles.iter_mut();
    let own = particles.flat_map(|particles| &mut particles.springs);
    for spring in own.chain(&mut scene.springs) {
        spring.4 = 0.0;
    }
}

/// Leaves out the springs of a kind, by its index in [`SPRINGS`]. Meshes have no shear springs.
/// The other springs keep their damping, also if it was given relative to structural springs.
fn leave_out_springs(scene: &mut Description, kind: usize) {
    for cloth in scene.cloth.iter_mut().filter(|_| kind == 0) {
        let mass = cloth.checked_mass().unwrap_or_default();
        let (damping, ratio) = (cloth.damping, cloth.damping_ratio);
        if let Ok(time) = damping_time(damping, ratio, mass, cloth.stiffness[0]) {
            (cloth.damping, cloth.damping_ratio) = (Some(time), None);
        }
    }
    for body in scene.bodies_mut() {
        match body.stiffness {
            Some([structural, _]) if kind == 0 => *structural = 0.0,
            Some([_, bend]) if kind == 2 => *bend = 0.0,
            Some([_, _]) | None => {}
            Some(all) => all[kind] = 0.0,
        }
        if let Some(law) = body.buckling.filter(|_| kind == 2) {
            *law = None;
        }
    }
}

/// Calls a function with the friction and the restitution of each body and obstacle.
fn each_contact(scene: &mut Description, mut change: impl FnMut([&mut f64; 2])) {
    let bodies = scene.bodies_mut().filter_map(|body| body.contact);
    bodies.for_each(&mut change);
    macro_rules! change {
        ($($obstacles:expr),*) => {
            $(for it in &mut $obstacles {
                change([&mut it.friction, &mut it.restitution]);
            })*
        };
    }
    change!(scene.sphere, scene.boxes, scene.capsule, scene.obstacle);
    if let Some(Floor::Table(floor)) = &mut scene.floor {
        change([&mut floor.friction, &mut floor.restitution]);
    }
    for rope in &mut scene.constraint {
        change([&mut 0.0, &mut rope.restitution]);
    }
}

/// Replaces a wind on the triangles of cloths by forces on particles: the drag of a cloth that
/// stands across the wind.
fn simplify_wind(scene: &mut Description) {
    let is_alone = scene.fluid.is_empty() && scene.bodies_mut().count() == scene.cloth.len();
    let is_cloth_alone = is_alone && !scene.cloth.is_empty();
    let (mut area, mut mass) = (0.0, 0.0);
    for cloth in &scene.cloth {
        let (Ok(spacing), Ok(share)) = (cloth.checked_spacing(), cloth.checked_mass()) else {
            return;
        };
        let [rows, cols] = cloth.grid.map(|n| n as f64);
        area += spacing * spacing * (rows - 1.0) * (cols - 1.0);
        mass += share * rows * cols;
    }
    let Some(wind) = scene.wind.as_mut().filter(|wind| wind.on && is_cloth_alone) else {
        return;
    };
    let Some(velocity) = wind.velocity else {
        return;
    };
    let speed = velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
    let [density, drag, _] = air(wind);
    let each = 0.5 * density * drag * speed * area / mass;
    wind.force_per_mass = Some(velocity.map(|v| each * v));
    (wind.velocity, wind.force) = (None, None);
    (wind.density, wind.drag, wind.lift) = (None, None, None);
}

/// Replaces boxes of elastic solids by jellies that are equally stiff under small strains. It
/// changes nothing if there are meshes, whose particles would get other numbers, or solids from
/// files.
fn replace_solids(scene: &mut Description) {
    if !scene.mesh.is_empty() || scene.solid.iter().any(|solid| solid.file.is_some()) {
        return;
    }
    for solid in std::mem::take(&mut scene.solid) {
        let grid = solid.grid.unwrap_or_default();
        let size = solid.size.unwrap_or_default();
        let cell = |axis: usize| size[axis] / (grid[axis].max(2) - 1) as f64;
        let spacing = (cell(0) * cell(1) * cell(2)).cbrt();
        scene.jelly.push(Jelly {
            grid,
            size,
            density: Some(solid.density),
            stiffness: lattice(solid.young, spacing),
            damping: Some(solid.damping),
            at: solid.at,
            rotation: solid.rotation,
            velocity: solid.velocity,
            thickness: solid.thickness,
            friction: solid.friction,
            restitution: solid.restitution,
            pin: solid.pin,
            ..Jelly::default()
        });
    }
}

/// Change of a description that leaves a part out, or replaces it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Gravity.
    Gravity,
    /// Drag on particles.
    Drag,
    /// Damping of springs and solids.
    Damping,
    /// Springs of a kind: 0 for structural ones, 1 for shear, 2 for bend.
    Springs(usize),
    /// Buckling of bend springs.
    Buckling,
    /// Limit of strain.
    StrainLimit,
    /// Springs that only pull, replaced by springs that also push.
    TensionOnly,
    /// Ropes.
    Ropes,
    /// Gas in closed meshes.
    Gas,
    /// Tearing.
    Tear,
    /// Viscosity of fluids.
    Viscosity,
    /// Wind.
    Wind,
    /// Gusts of the wind.
    Gusts,
    /// Wind that blows on triangles, replaced by forces on particles.
    WindByParticles,
    /// Friction.
    Friction,
    /// Restitution.
    Restitution,
    /// Contact of surfaces with one another and themselves.
    SelfCollision,
    /// Floor.
    Floor,
    /// Obstacle: its kind (0 for a sphere, 1 a box, 2 a capsule, 3 a mesh), and its index among
    /// those of its kind.
    Obstacle(usize, usize),
    /// Springs of chains, replaced by rods.
    Rods,
    /// Boxes of elastic solids, replaced by jellies.
    Jelly,
}
