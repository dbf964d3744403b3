//! The table of solvers and kinds of scenes, in Markdown. Each kind is a small scene, which
//! solvers can be asked to serve.

use a3_core::integrators::METHODS;
use a3_core::{Method, Refusal, Scene};
use a3_scenes::{Description, Fault, Mesh};

/// Solvers that serve the same kinds of scenes.
struct Family {
    letters: Vec<String>,
    /// For each kind, why the solvers do not serve it.
    refusals: Vec<Option<Refusal>>,
}

/// Returns the table: a row for each kind and a column for each family of solvers, with numbered
/// reasons below.
pub fn table() -> Result<String, Fault> {
    let kinds = kinds();
    let families = families(&kinds)?;
    let mut reasons: Vec<Refusal> = Vec::new();
    let mut cell = |refusal: Option<Refusal>| {
        let Some(why) = refusal else {
            return "yes".to_owned();
        };
        let known = reasons.iter().position(|known| same(*known, why));
        let number = known.unwrap_or_else(|| {
            reasons.push(why);
            reasons.len() - 1
        });
        format!("no, {}", number + 1)
    };
    let letters = families.iter().map(|family| family.letters.join(" "));
    let heading = ["scenes with".to_owned()].into_iter().chain(letters);
    let mut rows: Vec<Vec<_>> = vec![heading.collect()];
    for (k, kind) in kinds.iter().enumerate() {
        let answers = families.iter().map(|family| cell(family.refusals[k]));
        rows.push([kind.0.to_owned()].into_iter().chain(answers).collect());
    }
    let reason = |(number, why): (usize, Refusal)| format!("{number}. The solver {why}.\n");
    let reasons: String = (1..).zip(reasons).map(reason).collect();
    Ok(format!("{}\n{reasons}", laid_out(&rows)))
}

/// Sorts the solvers into families, in the order of the table of solvers.
fn families(kinds: &[Kind]) -> Result<Vec<Family>, Fault> {
    let scenes = kinds.iter().map(Kind::scene);
    let scenes = scenes.collect::<Result<Vec<_>, _>>()?;
    let mut families: Vec<Family> = Vec::new();
    for method in METHODS {
        let refusal = |scene: &a3_core::Scene| method.refusal(scene.model.system());
        let refusals: Vec<_> = scenes.iter().map(refusal).collect();
        let letter = letter(method);
        let is_same = |family: &&mut Family| family.refusals == refusals;
        match families.iter_mut().find(is_same) {
            Some(family) => family.letters.push(letter),
            None => families.push(Family { letters: vec![letter], refusals }),
        }
    }
    Ok(families)
}

/// Returns the letter of a solver, or its name, as code.
fn letter(method: &Method) -> String {
    let name = method.name.to_owned();
    format!("`{}`", method.letter.map_or(name, String::from))
}

/// Returns whether two reasons are of the same kind; the sizes of scenes in them may differ.
fn same(a: Refusal, b: Refusal) -> bool {
    std::mem::discriminant(&a) == std::mem::discriminant(&b)
}

/// Lays out rows, the heading first, as a table in Markdown.
fn laid_out(rows: &[Vec<String>]) -> String {
    let width = |c: usize| rows.iter().map(|row| row[c].chars().count()).max();
    let widths: Vec<_> = (0..rows[0].len()).filter_map(width).collect();
    let line = |cells: &[String]| {
        let cells = cells.iter().zip(&widths);
        let padded: Vec<_> = cells.map(|(cell, width)| format!("{cell:<width$}")).collect();
        format!("| {} |\n", padded.join(" | "))
    };
    let rule: Vec<_> = widths.iter().map(|width| "-".repeat(*width)).collect();
    line(&rows[0]) + &line(&rule) + &rows[1..].iter().map(|row| line(row)).collect::<String>()
}

/// Kind of scenes: words for it, and an example of it in TOML.
pub struct Kind(pub &'static str, String);

impl Kind {
    /// Builds the example.
    pub fn scene(&self) -> Result<Scene, Fault> {
        let description = Description::parse(&self.1)?;
        Ok(description.build(None, &mut |_| Ok(octahedron()))?.scene)
    }
}

/// Returns all kinds, in the order of the table.
#[rustfmt::skip]
pub fn kinds() -> Vec<Kind> {
    let rod = "constraint = [{ rod = [0, 1] }]\n";
    let touching = "self_collision = true\n";
    let damped = cloth("damping_ratio = 0.1");
    let force = "wind = { on = true, seed = 7, force = [1, 0, 0] }";
    let floor = "floor = { height = -1, friction = 0.4 }";
    let moved = chain("pin = [{ at = ['first'], sine = { amplitude = [0, 0.1, 0], rate = 2 } }]");
    let velocity = "velocity = [3, 0, 1], density = 1.2, drag = 1.2, lift = 0.6";
    let body = "body = [{ parts = [{ box = [0.5, 0.25, 1] }], density = 500, at = [0, 0.5, 0] }]";
    let ball = "joint = [{ bodies = [0, 1], ball = [0.5, 0, 0] }]";
    let below = liquid("").replace("[0.5, 0.5, 0]", "[2, 1.75, 0]");
    vec![
        Kind("first order (`[circle]`)", "circle.start = [1, 0, 0]".into()),
        Kind("springs, drag, moving pins, a wind of one force",
             format!("drag = 0.1\n{force}\n{moved}")),
        Kind("damped springs", damped.clone()),
        Kind("springs that tear, limits of strain, obstacles",
             format!("tear = 1.1\n{floor}\n{}", cloth("strain_limit = 1.2"))),
        Kind("springs that buckle", cloth("buckling = { bending = 1e-4, compression = 20 }")),
        Kind("springs that only pull", chain("tension_only = true")),
        Kind("wind on triangles",
             format!("wind = {{ on = true, seed = 7, {velocity} }}\n{}", cloth(""))),
        Kind("surfaces that touch", format!("{touching}{damped}")),
        Kind("rods, ropes, wires", format!("{rod}{}", chain(""))),
        Kind("rods, ropes, wires where surfaces touch", format!("{touching}{rod}{damped}")),
        Kind("up to 78 rigid bodies", balls(78)),
        Kind("more rigid bodies", balls(79)),
        Kind("rods, ropes, wires on rigid bodies",
             format!("constraint = [{{ rod = [0, 2] }}]\n{}", balls(2))),
        Kind("joints of rigid bodies", format!("{ball}\n{}", balls(2))),
        Kind("gas at constant pressure", balloon("pressure = 50")),
        Kind("an amount of gas", balloon("fill = 1.02")),
        Kind("elastic solids", solid("")),
        Kind("damped elastic solids", solid("damping = 0.004")),
        Kind("liquids", liquid("")),
        Kind("viscous liquids", liquid("viscosity = 0.02")),
        Kind("liquids on surfaces that touch", format!("{touching}{}\n{damped}", liquid(""))),
        Kind("rigid bodies in liquids", format!("{body}\n{below}")),
    ]
}

fn chain(keys: &str) -> String {
    format!(
        "chain = [{{ particles = 3, from = [0, 0, 0], to = [1, 0, 0], mass = 1, stiffness = 25, \
         {keys} }}]"
    )
}

fn cloth(keys: &str) -> String {
    format!(
        "cloth = [{{ grid = [3, 3], width = 1, density = 0.2, stiffness = [40, 20, 5], \
         at = [0, 0, 0], {keys} }}]"
    )
}

/// Balls in a row, which do not touch.
fn balls(count: usize) -> String {
    let ball = |i| format!("[[body]]\nparts = [{{ ball = 0.1 }}]\nmass = 1\nat = [{i}, 0, 0]\n");
    (0..count).map(ball).collect()
}

fn balloon(keys: &str) -> String {
    format!("mesh = [{{ file = 'octahedron.obj', density = 0.3, stiffness = [60, 10], {keys} }}]")
}

fn solid(keys: &str) -> String {
    format!(
        "solid = [{{ grid = [2, 2, 2], size = [1, 1, 1], density = 1000, young = 4e5, \
         poisson = 0.3, at = [0, 0, 0], {keys} }}]"
    )
}

fn liquid(keys: &str) -> String {
    format!(
        "fluid = [{{ dimensions = 2, size = [0.5, 0.5, 0], spacing = 0.125, at = [0, 2, 0], \
         density = 1000, sound = 20, {keys} }}]"
    )
}

/// Returns the mesh of the balloons: a corner on each side of the three axes.
fn octahedron() -> Mesh {
    let corner = |i: usize| {
        let mut place = [0.0; 3];
        place[i / 2] = [1.0, -1.0][i % 2];
        place
    };
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
    let triangles = faces.iter().flat_map(|&[a, b, c]| [[a, b, c], [b, a, 5]]);
    Mesh {
        positions: (0..6).map(corner).collect(),
        triangles: triangles.collect(),
        ..Mesh::default()
    }
}
