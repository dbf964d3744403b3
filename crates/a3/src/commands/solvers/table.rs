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
    let mut rows = vec![
        ["scenes with".to_owned()]
            .into_iter()
            .chain(families.iter().map(|family| family.letters.join(" ")))
            .collect::<Vec<_>>(),
    ];
    for (k, kind) in kinds.iter().enumerate() {
        let answers = families.iter().map(|family| cell(family.refusals[k]));
        rows.push([kind.words.to_owned()].into_iter().chain(answers).collect());
    }
    let reason = |(number, why): (usize, Refusal)| format!("{number}. The solver {why}.\n");
    let reasons: String = (1..).zip(reasons).map(reason).collect();
    Ok(format!("{}\n{reasons}", laid_out(&rows)))
}

/// Sorts the solvers into families, in the order of the table of solvers.
fn families(kinds: &[Kind]) -> Result<Vec<Family>, Fault> {
    let scenes = kinds
        .iter()
        .map(Kind::scene)
        .collect::<Result<Vec<_>, _>>()?;
    let mut families: Vec<Family> = Vec::new();
    for method in METHODS {
        let refusal = |scene: &a3_core::Scene| method.refusal(scene.model.system());
        let refusals: Vec<_> = scenes.iter().map(refusal).collect();
        let letter = letter(method);
        match families
            .iter_mut()
            .find(|family| family.refusals == refusals)
        {
            Some(family) => family.letters.push(letter),
            None => families.push(Family {
                letters: vec![letter],
                refusals,
            }),
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
        let padded: Vec<_> = cells
            .map(|(cell, width)| format!("{cell:<width$}"))
            .collect();
        format!("| {} |\n", padded.join(" | "))
    };
    let rule: Vec<_> = widths.iter().map(|width| "-".repeat(*width)).collect();
    line(&rows[0]) + &line(&rule) + &rows[1..].iter().map(|row| line(row)).collect::<String>()
}

/// Kind of scenes.
pub struct Kind {
    /// Words for the kind.
    pub words: &'static str,
    /// An example of it, in TOML.
    example: String,
}

impl Kind {
    fn new(words: &'static str, example: impl Into<String>) -> Self {
        let example = example.into();
        Self { words, example }
    }

    /// Builds the example.
    pub fn scene(&self) -> Result<Scene, Fault> {
        let description = Description::parse(&self.example)?;
        Ok(description.build(None, &mut |_| Ok(octahedron()))?.scene)
    }
}

/// Returns all kinds, in the order of the table.
pub fn kinds() -> Vec<Kind> {
    let rod = "constraint = [{ rod = [0, 1] }]";
    let touching = "self_collision = true";
    vec![
        Kind::new("first order (`[circle]`)", "circle.start = [1, 0, 0]"),
        Kind::new(
            "springs, drag, moving pins, a wind of one force",
            "drag = 0.1\nwind = { on = true, seed = 7, force = [1, 0, 0] }\n".to_owned()
                + &chain(
                    "pin = [{ at = ['first'], sine = { amplitude = [0, 0.1, 0], rate = 2 } }]",
                ),
        ),
        Kind::new("damped springs", cloth("damping_ratio = 0.1")),
        Kind::new(
            "springs that tear, limits of strain, obstacles",
            "tear = 1.1\nfloor = { height = -1, friction = 0.4 }\n".to_owned()
                + &cloth("strain_limit = 1.2"),
        ),
        Kind::new(
            "springs that buckle",
            cloth("buckling = { bending = 1e-4, compression = 20 }"),
        ),
        Kind::new("springs that only pull", chain("tension_only = true")),
        Kind::new(
            "wind on triangles",
            "wind = { on = true, seed = 7, velocity = [3, 0, 1], density = 1.2, drag = 1.2, \
             lift = 0.6 }\n"
                .to_owned()
                + &cloth(""),
        ),
        Kind::new(
            "surfaces that touch",
            format!("{touching}\n{}", cloth("damping_ratio = 0.1")),
        ),
        Kind::new("rods, ropes, wires", format!("{rod}\n{}", chain(""))),
        Kind::new(
            "rods, ropes, wires where surfaces touch",
            format!("{touching}\n{rod}\n{}", cloth("damping_ratio = 0.1")),
        ),
        Kind::new("up to 78 rigid bodies", balls(78)),
        Kind::new("more rigid bodies", balls(79)),
        Kind::new(
            "rods, ropes, wires on rigid bodies",
            format!("constraint = [{{ rod = [0, 2] }}]\n{}", balls(2)),
        ),
        Kind::new(
            "joints of rigid bodies",
            format!(
                "joint = [{{ bodies = [0, 1], ball = [0.5, 0, 0] }}]\n{}",
                balls(2)
            ),
        ),
        Kind::new("gas at constant pressure", balloon("pressure = 50")),
        Kind::new("an amount of gas", balloon("fill = 1.02")),
        Kind::new("elastic solids", solid("")),
        Kind::new("damped elastic solids", solid("damping = 0.004")),
        Kind::new("liquids", liquid("")),
        Kind::new("viscous liquids", liquid("viscosity = 0.02")),
        Kind::new(
            "liquids on surfaces that touch",
            format!(
                "{touching}\n{}\n{}",
                liquid(""),
                cloth("damping_ratio = 0.1")
            ),
        ),
        Kind::new(
            "rigid bodies in liquids",
            "body = [{ parts = [{ box = [0.5, 0.25, 1] }], density = 500, at = [0, 0.5, 0] }]\n"
                .to_owned()
                + &liquid("").replace("[0.5, 0.5, 0]", "[2, 1.75, 0]"),
        ),
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
    let corner = |axis: usize, side: f64| {
        let mut place = [0.0; 3];
        place[axis] = side;
        place
    };
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
    Mesh {
        positions: (0..6)
            .map(|i| corner(i / 2, if i % 2 == 0 { 1.0 } else { -1.0 }))
            .collect(),
        triangles: faces
            .iter()
            .flat_map(|&[a, b, c]| [[a, b, c], [b, a, 5]])
            .collect(),
        ..Mesh::default()
    }
}
