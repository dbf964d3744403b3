//! Scenes as they are asked for: by name or by file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use a3_core::contact::Shape;
use a3_core::{Grid, Method, Network, Scene, Vector3, integrators};
use a3_scenes::{Description, Setup};

use super::files::{beside, read_text};
use super::mesh;

/// A scene, by name or in a file.
#[derive(Clone)]
pub struct Source {
    /// The name or the path, as it was typed.
    pub typed: String,
    /// The path, if the scene is in a file.
    pub path: Option<PathBuf>,
    /// The description in the text.
    pub description: Arc<Description>,
    /// The text of the file, also of a built-in scene.
    text: Arc<str>,
}

impl Source {
    /// Finds a scene by its name or its file, and reads it.
    pub fn find(typed: &str) -> Result<Self, String> {
        if let Some(entry) = a3_scenes::find(typed) {
            return Ok(Self {
                typed: typed.into(),
                path: None,
                description: Arc::new(entry.description().map_err(|e| e.to_string())?),
                text: entry.text.into(),
            });
        }
        let path = Path::new(typed);
        let extension = path
            .extension()
            .and_then(|e| e.to_str())
            .map(str::to_lowercase);
        let json = match extension.as_deref() {
            Some("toml") => false,
            Some("json") => true,
            _ => return Err(unknown(typed)),
        };
        let text = read_text(path).map_err(|why| format!("{typed}: {why}"))?;
        let parsed = if json {
            Description::parse_json(&text)
        } else {
            Description::parse(&text)
        };
        let mut description = parsed.map_err(|fault| place(typed, &fault.to_string()))?;
        if description.name.is_none() {
            let stem = path
                .file_stem()
                .map(|stem| stem.to_string_lossy().into_owned());
            description.name = stem;
        }
        Ok(Self {
            typed: typed.into(),
            path: Some(path.into()),
            description: Arc::new(description),
            text: text.into(),
        })
    }

    /// Builds the scene, with this grid of its cloth or with its own.
    pub fn build(&self, grid: Option<Grid>) -> Result<Setup, String> {
        // With a grid of its own, a scene is built with both.
        let mut left = mesh::LONGEST * if grid.is_some() { 2 } else { 1 };
        let mut mesh = |name: &str| mesh::load(&beside(self.path.as_deref(), name)?, &mut left);
        self.description.build(grid, &mut mesh).map_err(|fault| {
            let fault = fault.locate(&self.text);
            match &self.path {
                Some(_) => place(&self.typed, &fault.to_string()),
                None => fault.to_string(),
            }
        })
    }

    /// The solver that was asked for, or else the scene's own, or else the explicit trapezoid,
    /// which serves every scene.
    pub fn solver_or(&self, asked: Option<&'static Method>) -> &'static Method {
        let own = || integrators::find(self.description.solver.as_deref()?);
        asked
            .or_else(own)
            .or_else(|| integrators::find("trapezoid"))
            .unwrap_or(&integrators::METHODS[0])
    }

    /// The text of the file.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// A text by which the scene differs from others: its name, and for a file a hash of its text,
    /// and of its state and the points of its obstacles, which depend on its meshes.
    pub fn fingerprint(&self, scene: &Scene) -> String {
        if self.path.is_none() {
            return scene.name.clone();
        }
        let network = scene.model.network().into_iter();
        let meshes = network.flat_map(Network::obstacles).filter_map(|obstacle| {
            let Shape::Mesh(mesh) = &obstacle.shape else {
                return None;
            };
            Some(mesh.points())
        });
        let points = meshes.flatten().flat_map(Vector3::as_slice);
        let state = scene.state.iter().chain(points);
        let state = state.flat_map(|y| y.to_le_bytes());
        // FNV-1a, which is the same on every platform.
        let hash = self
            .text
            .bytes()
            .chain(state)
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            });
        format!("{} {hash:016x}", scene.name)
    }

    /// The files on which the scene depends: its own and those of its meshes.
    pub fn files(&self) -> Vec<PathBuf> {
        let Description {
            mesh,
            obstacle,
            solid,
            ..
        } = &*self.description;
        let bodies = mesh.iter().map(|mesh| &mesh.file);
        let solids = solid.iter().filter_map(|solid| solid.file.as_ref());
        let bodies = bodies.chain(solids);
        let names = bodies.chain(obstacle.iter().map(|obstacle| &obstacle.file));
        let meshes = names.filter_map(|name| beside(self.path.as_deref(), name).ok());
        self.path.iter().cloned().chain(meshes).collect()
    }
}

/// An error with its place: `FILE:LINE: error` if it names a line, as compilers write it.
fn place(file: &str, why: &str) -> String {
    match why.strip_prefix("line ") {
        Some(rest) => format!("{file}:{rest}"),
        None => format!("{file}: {why}"),
    }
}

/// The error of an unknown name.
fn unknown(typed: &str) -> String {
    let names = || a3_scenes::SCENES.iter().map(|entry| entry.name);
    let near = names()
        .map(|name| (strsim::normalized_damerau_levenshtein(typed, name), name))
        .filter(|(likeness, _)| *likeness > 0.55)
        .max_by(|a, b| a.0.total_cmp(&b.0));
    let hint = near.map_or(String::new(), |(_, name)| format!("; did you mean {name}?"));
    let names: Vec<_> = names().collect();
    format!(
        "the scenes are {}, or a file that ends in .toml or .json{hint}",
        names.join(", ")
    )
}
