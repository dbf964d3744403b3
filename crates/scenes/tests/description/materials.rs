//! Materials by name: the keys that they give, those that win, and the names that are refused.

use a3_scenes::{BucklingSpec, MATERIALS, Stuff};

use super::*;

const DENIM: &str = "[[cloth]]\nmaterial = \"denim\"\ngrid = [4, 5]\nwidth = 0.2\n";

#[test]
fn a_fabric_gives_the_keys_of_a_cloth_that_are_not_there() {
    let cloth = read(DENIM).cloth.remove(0);
    assert_eq!(cloth.density, Some(0.324));
    assert_eq!(cloth.stiffness, [610.0, 53.4, 0.0]);
    let Some(BucklingSpec { bending, compression }) = cloth.buckling else {
        panic!("it does not buckle");
    };
    assert!((bending / (80.6e-6 * 0.05) - 1.0).abs() < 1e-12);
    assert_eq!((compression, cloth.damping), (610.0, Some(7.96e-4)));
    let own = "mass = 0.01\nstiffness = [1, 2, 3]\ndamping_ratio = 0.1\n\
        buckling = { bending = 1e-4, compression = 30 }\n";
    let named = read(&format!("{DENIM}{own}"));
    let mut plain = read(&format!("{DENIM}{own}").replace("material = \"denim\"\n", ""));
    assert_eq!(plain.cloth[0].material.take(), None);
    plain.cloth[0].material = Some("denim".into());
    assert_eq!(named, plain);
    let mesh = "[[mesh]]\nfile = \"square.obj\"\nmaterial = \"silk\"\n";
    let sheet = &read(mesh).mesh[0];
    assert_eq!(sheet.density, 0.0434);
    assert!((sheet.stiffness[0] / 2015.0).powi(2) - 0.75 < 1e-12);
    for text in [DENIM, mesh] {
        build(text).unwrap();
        // What is written says the same.
        assert_eq!(read(&read(text).to_toml().unwrap()), read(text));
    }
}

#[test]
fn a_solid_gives_the_keys_of_jellies_solids_and_bodies() {
    let block = "grid = [3, 3, 3]\nsize = [0.2, 0.2, 0.2]\nat = [0, 1, 0]\n";
    let text = format!(
        "[[jelly]]\nmaterial = \"gelatine\"\n{block}\n[[solid]]\nmaterial = \"rubber\"\n{block}\n\
         [[body]]\nmaterial = \"steel\"\nparts = [{{ ball = 0.1 }}]\n"
    );
    let scene = read(&text);
    // Springs that are as stiff as the solid: E a 22 / 35 and E a 6 / 35.
    let [structural, shear, bend] = scene.jelly[0].stiffness;
    assert!((structural / (1.2e4 * 0.1 * 22.0 / 35.0) - 1.0).abs() < 1e-12);
    assert!((structural / shear - 22.0 / 6.0).abs() < 1e-12 && bend == 0.0);
    let solid = &scene.solid[0];
    let keys = [solid.density, solid.young, solid.poisson, solid.damping];
    assert_eq!(keys, [1100.0, 2.76e6, 0.48, 1.59e-3]);
    assert_eq!(scene.body[0].density, Some(7800.0));
    build(&text).unwrap();
    let heavy = &read(&text.replace("\"steel\"\n", "\"steel\"\nmass = 2\n")).body[0];
    assert_eq!((heavy.density, heavy.mass), (None, Some(2.0)));
}

#[test]
fn each_material_makes_its_bodies() {
    for material in &MATERIALS {
        let kinds = match material.stuff {
            Stuff::Fabric { .. } => vec!["[[cloth]]\ngrid = [9, 9]\nwidth = 0.1\n"],
            Stuff::Matter { .. } => vec![
                "[[jelly]]\ngrid = [3, 3, 3]\nsize = [1, 1, 1]\nat = [0, 0, 0]\n",
                "[[solid]]\ngrid = [3, 3, 3]\nsize = [1, 1, 1]\nat = [0, 0, 0]\n",
                "[[body]]\nparts = [{ box = [1, 1, 1] }]\n",
            ],
        };
        for kind in kinds {
            build(&format!("{kind}material = \"{}\"\n", material.name)).unwrap();
        }
    }
}

#[test]
fn another_grid_has_strips_of_its_own_width() {
    let scene = read(DENIM);
    let of = |grid: Option<Grid>| {
        let scene = scene.build(grid, &mut mesh).unwrap().scene;
        network(&scene).buckling().next().unwrap().bending
    };
    let finer = Grid::new(7, 9).unwrap();
    assert!((of(None) / of(Some(finer)) - 2.0).abs() < 1e-12);
}

/// Changes of the cloth of denim, with the messages.
const WRONG: &str = r#"
denim
    denin =>
        line 2: cloth.material: there is no `denin`; did you mean `denim`? The choices are silk,
    steel => line 2: cloth.material: `steel` is a solid: the materials of a cloth are silk, jersey,
"denim"
    7 => line 2: cloth.material: it must be a text in quotes, not 7
width = 0.2
    width = "a" => line 4: cloth.width: it must be a number
material = "denim"\n
     => line 1: cloth: the key `stiffness` is missing
"#;

#[test]
fn unknown_materials_are_refused_with_the_nearest_name() {
    refused(DENIM, WRONG, said);
    let why = "`silk` is a fabric: the materials of a solid body are gelatine,";
    let body = said("[[body]]\nparts = [{ ball = 1 }]\nmaterial = 'silk'\n");
    begins(body, &format!("line 3: body.material: {why}"));
    let chain = said("[[chain]]\nmaterial = 'steel'\n");
    begins(chain, "line 2: chain.material: there is no key `material`");
}
