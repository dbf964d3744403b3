//! Materials by name: fabrics and solids with their measured constants, and the keys of bodies that
//! follow from them. `docs/scenes.md` names the sources.

use std::f64::consts::TAU;

use crate::wording::unknown_choice;

/// Material with a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Name in scene files.
    pub name: &'static str,
    /// Description in a few words.
    pub about: &'static str,
    /// Constants.
    pub stuff: Stuff,
}

/// Constants of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stuff {
    /// Fabric, of cloths.
    Fabric {
        /// Mass per area (kg/m2).
        density: f64,
        /// Stiffness of stretch, the mean of warp and weft (N/m).
        stretch: f64,
        /// Stiffness of shear (N/m).
        shear: f64,
        /// Bending stiffness over width (N m).
        bending: f64,
    },
    /// Matter of jellies, elastic solids and rigid bodies.
    Matter {
        /// Mass per volume (kg/m3).
        density: f64,
        /// Young's modulus (Pa).
        young: f64,
        /// Poisson's ratio.
        poisson: f64,
        /// Loss factor: the energy that is lost in a radian of an oscillation, over its energy.
        loss: f64,
    },
}

/// Loss factor of fabrics. It was not measured with the other constants.
const FABRIC_LOSS: f64 = 0.05;

/// Frequency at which damping has the loss factor of the material (Hz).
const DAMPED_AT: f64 = 10.0;

/// Stiffness of the structural and the shear springs of a cubic lattice, over Young's modulus times
/// the spacing. With these, the lattice is isotropic: sums over the springs of a cell give
/// C11 = (k1 + 10/3 ks) / a and C12 = C44 = 7/3 ks / a, so C11 - C12 = 2 C44 if k1 = 11/3 ks, and
/// E = 5/2 C44.
const LATTICE: [f64; 3] = [22.0 / 35.0, 6.0 / 35.0, 0.0];

const fn fabric(
    name: &'static str,
    about: &'static str,
    [density, stretch, shear, bending]: [f64; 4],
) -> Material {
    let stuff = Stuff::Fabric { density, stretch, shear, bending };
    Material { name, about, stuff }
}

const fn matter(
    name: &'static str,
    about: &'static str,
    [density, young, poisson, loss]: [f64; 4],
) -> Material {
    let stuff = Stuff::Matter { density, young, poisson, loss };
    Material { name, about, stuff }
}

/// All materials: fabrics, and then solids from soft to stiff.
#[rustfmt::skip]
pub static MATERIALS: [Material; 16] = [
    fabric("silk", "habotai of 10 momme", [0.0434, 2015.0, 19.2, 1.0e-6]),
    fabric("jersey", "a T-shirt, knitted", [0.187, 25.5, 36.9, 18.7e-6]),
    fabric("nylon", "a swimsuit, knitted", [0.204, 76.3, 60.8, 55.6e-6]),
    fabric("polyester", "a tablecloth, woven", [0.128, 2015.0, 19.2, 41.5e-6]),
    fabric("denim", "jeans of 11 oz", [0.324, 610.0, 53.4, 80.6e-6]),
    fabric("blanket", "a blanket of polyester", [0.228, 198.0, 30.3, 88.4e-6]),
    fabric("cotton", "trousers of cotton and polyester, woven", [0.22, 2026.0, 105.0, 125e-6]),
    matter("gelatine", "a dessert of 5 % gelatine", [1010.0, 1.2e4, 0.48, 0.1]),
    matter("rubber", "soft rubber", [1100.0, 2.76e6, 0.48, 0.1]),
    matter("cork", "cork, across the grain", [170.0, 1.3e7, 0.05, 0.15]),
    matter("oak", "oak, along the grain", [720.0, 1.24e10, 0.3, 0.01]),
    matter("concrete", "dense concrete", [2300.0, 2.7e10, 0.15, 0.01]),
    matter("glass", "window glass", [2500.0, 6.9e10, 0.2, 0.001]),
    matter("aluminium", "an alloy of aluminium", [2800.0, 7.2e10, 0.33, 1e-5]),
    matter("brass", "red brass", [8500.0, 1.04e11, 0.34, 1e-4]),
    matter("steel", "structural steel", [7800.0, 2.1e11, 0.3, 1e-3]),
];

/// Keys that materials give, and the alternatives of these.
#[rustfmt::skip]
pub(crate) const KEYS: [&str; 8] = [
    "density", "mass", "stiffness", "damping", "damping_ratio", "buckling", "young", "poisson",
];

/// Value of a key that a material gives.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Given {
    Number(f64),
    List(Vec<f64>),
    Table(Vec<(&'static str, f64)>),
}

/// Returns the names of the materials of fabrics, or those of solids.
pub(crate) fn names(of_fabrics: bool) -> Vec<&'static str> {
    let is_fabric = |material: &&Material| matches!(material.stuff, Stuff::Fabric { .. });
    let all = MATERIALS.iter().filter(|material| is_fabric(material) == of_fabrics);
    all.map(|material| material.name).collect()
}

/// Returns the keys that a material gives to a table of a kind, whose own keys are read by `own`.
/// Keys that the table has itself, or that have an alternative there, are left out. A table of
/// another kind has no material.
///
/// # Errors
/// There is no such material, or it is none of the kind.
pub(crate) fn keys(
    kind: &str,
    name: &str,
    own: &dyn Fn(&str) -> Option<Vec<f64>>,
) -> Result<Vec<(&'static str, Given)>, String> {
    let of_fabrics = match kind {
        "Cloth" | "MeshCloth" => true,
        "Jelly" | "Solid" | "RigidBody" => false,
        _ => return Ok(vec![]),
    };
    let known = names(of_fabrics);
    let Some(material) = MATERIALS.iter().find(|it| it.name == name) else {
        return Err(unknown_choice(name, &known));
    };
    if !known.contains(&name) {
        let words = [("a fabric", "a solid body"), ("a solid", "a cloth")];
        let (is, bodies) = words[usize::from(of_fabrics)];
        let known = known.join(", ");
        refuse!("`{name}` is {is}: the materials of {bodies} are {known}");
    }
    let all = match material.stuff {
        Stuff::Fabric { density, stretch, shear, bending } => {
            of_fabric(kind, [density, stretch, shear, bending], own)
        }
        Stuff::Matter { density, young, poisson, loss } => {
            of_matter(kind, [density, young, poisson, loss], own)
        }
    };
    let is_given = |key: &str| own(key).is_some();
    let is_free = |key: &&str| match *key {
        "density" => !is_given("density") && !is_given("mass"),
        "damping" => !is_given("damping") && !is_given("damping_ratio"),
        key => !is_given(key),
    };
    Ok(all.into_iter().filter(|(key, _)| is_free(key)).collect())
}

/// Returns the keys of a cloth. Its rows and columns of structural springs stretch like the fabric,
/// and its bend springs are strips as wide as a cell, which buckle. The springs across the edges of
/// a mesh have no stiffness, because that would depend on the mesh.
fn of_fabric(
    kind: &str,
    [density, stretch, shear, bending]: [f64; 4],
    own: &dyn Fn(&str) -> Option<Vec<f64>>,
) -> Vec<(&'static str, Given)> {
    let mut all =
        vec![("density", Given::Number(density)), ("damping", Given::Number(damping(FABRIC_LOSS)))];
    if kind == "MeshCloth" {
        // A sheet of equilateral triangles of such springs stretches like the fabric.
        let structural = 0.75_f64.sqrt() * stretch;
        all.push(("stiffness", Given::List(vec![structural, 0.0])));
        return all;
    }
    all.push(("stiffness", Given::List(vec![stretch, shear, 0.0])));
    let of = |key: &str, k: usize| own(key).and_then(|all| all.get(k).copied());
    let cells = of("grid", 1).unwrap_or(2.0).max(2.0) - 1.0;
    let spacing = of("spacing", 0).or_else(|| Some(of("width", 0)? / cells));
    let strip = strip(stretch, bending, spacing.unwrap_or(1.0));
    all.push(("buckling", Given::Table(strip.to_vec())));
    all
}

/// Returns the bending stiffness (N m2) and the stiffness under compression (N/m) of the strips of
/// the fabric of a name, which are as wide as a cell (m); `None` if there is no such fabric.
pub(crate) fn strip_of(name: &str, spacing: f64) -> Option<[f64; 2]> {
    match MATERIALS.iter().find(|it| it.name == name)?.stuff {
        Stuff::Fabric { stretch, bending, .. } => {
            Some(strip(stretch, bending, spacing).map(|(_, value)| value))
        }
        Stuff::Matter { .. } => None,
    }
}

/// Returns the keys of the strips of a fabric of this stiffness of stretch (N/m) and of bending
/// (N m), which are as wide as a cell (m).
fn strip(stretch: f64, bending: f64, spacing: f64) -> [(&'static str, f64); 2] {
    // A strip that were softer before it buckles would have no law.
    let least = 5.0 * bending / (spacing * spacing);
    [("bending", bending * spacing), ("compression", stretch.max(least))]
}

/// Returns the keys of a jelly, an elastic solid or a rigid body.
fn of_matter(
    kind: &str,
    [density, young, poisson, loss]: [f64; 4],
    own: &dyn Fn(&str) -> Option<Vec<f64>>,
) -> Vec<(&'static str, Given)> {
    let mut all = vec![("density", Given::Number(density))];
    match kind {
        "Solid" => {
            all.extend([("young", Given::Number(young)), ("poisson", Given::Number(poisson))]);
        }
        "Jelly" => {
            let cell = |axis: usize| {
                let [size, grid] = ["size", "grid"].map(|key| own(key)?.get(axis).copied());
                Some(size? / (grid?.max(2.0) - 1.0))
            };
            let cells = (0..3).map(|axis| cell(axis).unwrap_or(1.0));
            let stiffness = lattice(young, cells.product::<f64>().cbrt());
            all.push(("stiffness", Given::List(stiffness.to_vec())));
        }
        _ => return all,
    }
    all.push(("damping", Given::Number(damping(loss))));
    all
}

/// Returns the damping over stiffness (s) of a loss factor.
fn damping(loss: f64) -> f64 {
    // Printing and reading removes needless digits.
    let time = loss / (TAU * DAMPED_AT);
    format!("{time:.2e}").parse().unwrap_or(time)
}

/// Returns the stiffness of the springs of a lattice (N/m) from Young's modulus (Pa) and the
/// spacing (m).
pub(crate) fn lattice(young: f64, spacing: f64) -> [f64; 3] {
    LATTICE.map(|share| share * young * spacing)
}
