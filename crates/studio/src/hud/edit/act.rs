//! What the chosen tool does to the scene where the mouse clicks.

use std::f64::consts::FRAC_PI_2;

use a3_core::{Network, Vector3};
use a3_files::rounding::short;
use a3_media::show::Target;
use a3_scenes::{ConstraintSpec, Edit, PartChange, PartSpec, RigidBody};

use crate::session::panel::{edit, of_one_body, turn_part, undo};
use crate::session::{Measure, Session, Tool, Turn, exchange};

/// Coefficient of friction of bodies that are added.
const FRICTION: f64 = 0.4;
/// Coefficient of restitution of balls that are added.
const RESTITUTION: f64 = 0.3;
/// Damping ratio of springs that are added.
const DAMPING_RATIO: f64 = 0.1;
/// Distance of an added body from the surface on which it is put, over its size.
const GAP: f64 = 0.05;
/// Distance from the eye at which a throw begins, over the size of the body.
const ARM: f64 = 2.0;
/// Number of places in a row from which bodies are thrown.
const ROW: usize = 5;
/// Distance of these places, over the size of the body.
const SPACING: f64 = 1.5;
/// Number of places that are tried for a throw.
const MAX_PLACES: usize = 4;
/// Largest difference of the lengths that a rod would need, relative to its length.
const ROD_TOLERANCE: f64 = 1e-3;

/// What is under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// Position of the eye (m).
    pub eye: Vector3<f64>,
    /// Point under the pointer: of a surface, an obstacle or the ground, or else one as far away as
    /// the point that the camera looks at (m).
    pub point: Vector3<f64>,
    /// Normal of the surface in that point, if there is one.
    pub normal: Option<Vector3<f64>>,
    /// The particle or the obstacle under the pointer.
    pub target: Option<Target>,
    /// The particles that a spring, a rod or a rope under the pointer joins.
    pub link: Option<[usize; 2]>,
}

/// An edit, its name in the list of changes, and the message that is shown once it is made.
type Planned = (Edit, String, String);

/// Does what the chosen tool does by a click, and shows a message.
pub fn click(session: &mut Session, aim: &Aim) {
    let done = match session.panel.editor.tool {
        Tool::ThrowBall | Tool::ThrowBox => thrown(session, aim, Throw::default()),
        Tool::AddBall | Tool::AddBox => carry_out(session, another_body(session, aim)),
        Tool::Particle => {
            let position = aim.point.into();
            let mass = session.panel.editor.value(Measure::PointMass);
            let add = Edit::AddParticle { position, mass };
            let said = "There is another particle now.".into();
            carry_out(session, (add, "particle".into(), said))
        }
        Tool::Spring | Tool::Rod | Tool::Rope => {
            Err("Drag from one particle to another to join them.".into())
        }
        Tool::Delete => delete(session, aim),
    };
    session.readings.say(done.unwrap_or_else(|why| why));
}

/// Joins two particles by a spring, a rod or a rope, and shows a message.
pub fn join(session: &mut Session, ends: [usize; 2]) {
    let done = link(session, ends).and_then(|planned| carry_out(session, planned));
    session.readings.say(done.unwrap_or_else(|why| why));
}

/// Makes a planned edit, and returns its message.
fn carry_out(session: &mut Session, (change, name, said): Planned) -> Result<String, String> {
    edit(session, &change, &name).map(|()| said)
}

/// A throw of the body of the chosen tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Throw {
    /// Factor of the mass that is set.
    pub mass: f64,
    /// Factor of the speed that is set.
    pub speed: f64,
}

impl Default for Throw {
    fn default() -> Self {
        Self { mass: 1.0, speed: 1.0 }
    }
}

/// Throws a body, and shows a message.
pub fn throw(session: &mut Session, aim: &Aim, how: Throw) {
    session.panel.editor.fit(&session.runs);
    let done = thrown(session, aim, how);
    session.readings.say(done.unwrap_or_else(|why| why));
}

/// Returns whether the scene has a liquid that is a sheet across z, 1 m deep.
fn is_sheet(session: &Session) -> bool {
    let network = session.runs.first().model().network();
    let fluid = network.and_then(Network::fluid);
    fluid.is_some_and(|fluid| fluid.law().dimensions == 2)
}

/// Makes the body of the chosen tool, and names it. In a liquid that is a sheet, it reaches across.
fn body(session: &Session, at: Vector3<f64>, velocity: Vector3<f64>) -> (RigidBody, &'static str) {
    let editor = &session.panel.editor;
    let size = editor.value(Measure::Size);
    let is_ball = matches!(editor.tool, Tool::ThrowBall | Tool::AddBall);
    // With its ends, a capsule of this length has the volume of a disc of 1 m.
    let length = Some(1.0 - 2.0 / 3.0 * size).filter(|length| is_sheet(session) && *length > 0.0);
    let mut part = PartSpec::default();
    match (is_ball, length) {
        (true, None) => part.ball = Some(0.5 * size),
        (true, Some(length)) => {
            part.capsule = Some([length, 0.5 * size]);
            part.rotation = Some([FRAC_PI_2, 0.0, 0.0]);
        }
        (false, _) => {
            let depth = if is_sheet(session) { 1.0 } else { size };
            part.cuboid = Some([size, size, depth]);
        }
    }
    let body = RigidBody {
        parts: vec![part],
        mass: Some(editor.value(Measure::Mass)),
        at: Some(at.into()),
        velocity: Some(velocity.into()).filter(|v| *v != [0.0; 3]),
        friction: FRICTION,
        restitution: if is_ball { RESTITUTION } else { 0.0 },
        ..RigidBody::default()
    };
    (body, if is_ball { "ball" } else { "box" })
}

/// Throws a body from the eye so that it falls on the point under the pointer: from beside or
/// behind earlier ones, which a reset throws again at the same time, and from where there is room.
/// Surfaces that cross already are brought apart first.
fn thrown(session: &mut Session, aim: &Aim, how: Throw) -> Result<String, String> {
    let network = session.runs.first().model().network();
    let count = network.map_or(0, |network| network.bodies().len());
    let touched = network.is_none_or(|network| network.contact_layer().is_some());
    let own = session.scenes.unedited().source.description.body.len();
    let first = count.saturating_sub(own);
    let mut done = Err(String::new());
    for place in first..first + MAX_PLACES {
        if done.is_err() {
            done = thrown_from(session, aim, how, place);
        }
    }
    // What lies on an obstacle without thickness may cross it.
    if touched || done.is_ok() || session.come_apart().is_err() {
        return done.map(|name| format!("A {name} flies."));
    }
    let done = thrown_from(session, aim, how, first).inspect_err(|_| undo(session, false))?;
    Ok(format!("A {done} flies. The surfaces of the scene came apart for it, and touch now."))
}

/// Throws a body from a place, by its number in rows beside the eye.
fn thrown_from(
    session: &mut Session,
    aim: &Aim,
    how: Throw,
    place: usize,
) -> Result<&'static str, String> {
    let editor = &session.panel.editor;
    let size = editor.value(Measure::Size);
    let speed = how.speed * editor.value(Measure::Speed);
    let way = aim.point - aim.eye;
    let right = way.cross(&Vector3::y());
    let right = right.try_normalize(0.0).unwrap_or_else(Vector3::x);
    // The middle of a row, then right and left in turn.
    let (row, column) = (place / ROW, place % ROW);
    let sideways = [1.0, -1.0][column % 2] * column.div_ceil(2) as f64;
    let arm = (ARM * size).min(0.5 * way.norm()) - SPACING * size * row as f64;
    let mut start = aim.eye + way.normalize() * arm + right * (SPACING * size * sideways);
    let show = &session.runs.panes[0].show;
    if let Some(ground) = show.ground() {
        start.y = start.y.max(ground + size);
    }
    let mut point = aim.point;
    if is_sheet(session) {
        // It falls within the sheet, from above all particles, now and at the start.
        let run = session.runs.first();
        let n = run.particles();
        let heights = |y: &[f64]| y[n..2 * n].iter().copied().fold(start.y, f64::max);
        start.y = heights(run.state()).max(heights(&run.scene().state)) + size;
        (start.z, point.z) = (0.0, 0.0);
    }
    let network = session.runs.first().model().network();
    let gravity = network.and_then(Network::gravity).unwrap_or_default();
    let time = (point - start).norm() / speed;
    let velocity = (point - start) / time - 0.5 * time * gravity;
    let (mut body, name) = body(session, start, velocity);
    body.mass = body.mass.map(|mass| short(how.mass * mass, 2));
    edit(session, &Edit::AddBody(body), &format!("throw of a {name}"))?;
    session.pulled = true;
    Ok(name)
}

/// Plans a body on the surface under the pointer.
fn another_body(session: &Session, aim: &Aim) -> Planned {
    let size = session.panel.editor.value(Measure::Size);
    let reach = |normal: Vector3<f64>| match session.panel.editor.tool {
        Tool::AddBox => 0.5 * size * normal.abs().sum(),
        _ => 0.5 * size,
    };
    let offset = aim.normal.map(|n| n * (reach(n) + GAP * size));
    let mut at = aim.point + offset.unwrap_or_default();
    if is_sheet(session) {
        // Where the line of sight crosses the sheet.
        let share = aim.eye.z / (aim.eye.z - aim.point.z);
        if share.is_finite() && share > 0.0 {
            at = aim.eye + (aim.point - aim.eye) * share;
        }
        at.z = 0.0;
    }
    let (body, name) = body(session, at, Vector3::zeros());
    let said = format!("There is another {name} now.");
    (Edit::AddBody(body), name.into(), said)
}

/// Plans a spring, a rod or a rope between two particles.
fn link(session: &Session, [i, j]: [usize; 2]) -> Result<Planned, String> {
    let editor = &session.panel.editor;
    let run = session.runs.first();
    let network = run.model().network().ok_or("There are no masses here.")?;
    if of_one_body(network, [i, j]) {
        return Err("Both ends are on the same rigid body.".into());
    }
    let distance = |y: &[f64]| {
        let n = run.particles();
        let along = (0..3).map(|axis| y[axis * n + i] - y[axis * n + j]);
        along.map(|d| d * d).sum::<f64>().sqrt()
    };
    let now = distance(run.state());
    let panes = session.runs.panes.iter();
    let others = panes.map(|pane| distance(pane.simulation.state()));
    let lengths: Vec<_> = others.chain([distance(&run.scene().state)]).collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let constraint = |rod, rope, length| {
        let length = Some(length);
        Edit::AddConstraint(ConstraintSpec { rod, rope, length, ..ConstraintSpec::default() })
    };
    let (name, add) = match editor.tool {
        Tool::Spring => {
            let stiffness = editor.value(Measure::Stiffness);
            let mass = network.masses()[i].min(network.masses()[j]);
            let damping = 2.0 * DAMPING_RATIO * (stiffness * mass).sqrt();
            let spring = (i, j, stiffness, now, short(damping, 3));
            ("spring", Edit::AddSpring(spring))
        }
        Tool::Rope => ("rope", constraint(None, Some([i, j]), longest)),
        _ => {
            let other = lengths.iter().find(|it| (*it - now).abs() > ROD_TOLERANCE * now);
            if let Some(other) = other {
                let [now, other] = [now, *other].map(|length| short(length, 3));
                let elsewhere = match session.runs.panes.len() {
                    1 => "at the start",
                    _ => "at the start or in another pane",
                };
                return Err(format!(
                    "A rod never changes its length, but its ends would be {now} m apart here and {other} m \
                     {elsewhere}: reset the scene (r) first, or take a spring or a rope."
                ));
            }
            ("rod", constraint(Some([i, j]), None, now))
        }
    };
    let said = format!("A {name} joins the particles {i} and {j}.");
    Ok((add, format!("{name} between {i} and {j}"), said))
}

fn delete(session: &mut Session, aim: &Aim) -> Result<String, String> {
    let network = session.runs.first().model().network();
    let network = network.ok_or("There are no masses here.")?;
    let body_of = |target: Target| network.body_of(target.particle()?);
    let (edits, name) = match (aim.target, aim.link) {
        (Some(Target::Obstacle(k)), _) => {
            let part = part_of_obstacle(session, network, k)?;
            turn_part(session, part, Turn::To(0.0));
            return Ok(session.readings.message.clone().unwrap_or_default());
        }
        (Some(target), _) if body_of(target).is_some() => {
            let k = body_of(target).unwrap_or_default();
            (Edit::RemoveBody(k), format!("body {k}"))
        }
        (_, Some([i, j])) => {
            let name = format!("what joined {i} and {j}");
            (Edit::Disjoin([i, j]), name)
        }
        (Some(Target::Particle(i)), None) => (Edit::RemoveParticle(i), format!("particle {i}")),
        (None, None) => return Err("There is nothing under the pointer to delete.".into()),
    };
    let count = network.particles();
    edit(session, &edits, &format!("removal of {name}"))?;
    let stays = session.runs.first().particles() == count;
    Ok(match edits {
        Edit::RemoveParticle(i) if stays => {
            format!(
                "Particle {i} is torn out of its body, which keeps all its particles: it is loose now."
            )
        }
        _ => format!("Removed: {name}."),
    })
}

/// Returns the part of the scene that an obstacle is, as the panel's page of parts lists it.
fn part_of_obstacle(session: &Session, network: &Network, k: usize) -> Result<usize, String> {
    let ids = exchange::obstacle_ids(network, &session.tuning.changes());
    let id = ids.into_iter().find(|(number, _)| *number == k);
    let change = id.map(|(_, (kind, own))| PartChange::Obstacle(kind, own));
    let mut parts = session.tuning.parts.iter();
    let part = parts.position(|part| Some(part.change) == change);
    part.ok_or("This obstacle cannot be deleted.".into())
}
