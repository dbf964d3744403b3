//! Sources of scenes: the name of a built-in scene, or a file.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use a3_core::{Grid, Method, Scene, integrators};
use a3_scenes::{Description, Fault, Places, Setup, parse_json, parse_toml};
use serde_json::Value;

use super::files::{Hash, MeshReader, beside, load_mesh, not_a_mesh, read_input, read_text};
use super::hung;
use crate::failure::InputError;

/// Argument that stands for standard input, and its name in messages.
const INPUT: &str = "-";
const INPUT_NAME: &str = "standard input";
/// Name of a scene whose text is in no file.
const TEXT: &str = "scene";

/// Source of a scene: its name or file, with the text and the description that were read.
#[derive(Clone)]
pub struct Source {
    /// Name or path, as it was typed.
    pub typed: String,
    /// Path, if the scene is not a built-in one.
    pub path: Option<PathBuf>,
    /// Description of the scene.
    pub description: Arc<Description>,
    /// Text of the scene.
    text: Arc<str>,
    /// Lines of the keys in that text; none if the program wrote the text.
    places: Arc<Places>,
    /// Hash of the mesh files when the scene was last built.
    meshes: Arc<AtomicU64>,
}

impl Source {
    /// Finds a scene by its name or its file, and reads it.
    pub fn find(typed: &str) -> Result<Self, InputError> {
        if let Some(entry) = a3_scenes::find(typed) {
            let parsed = Description::parse(entry.text);
            return Ok(Self {
                typed: typed.into(),
                path: None,
                description: Arc::new(
                    parsed.map_err(|fault| InputError::Text { file: None, fault })?,
                ),
                text: entry.text.into(),
                places: Arc::default(),
                meshes: Arc::default(),
            });
        }
        let path = Path::new(typed);
        let extension = path.extension().and_then(|e| e.to_str());
        let extension = extension.map(str::to_lowercase);
        let wrong = |file: &str, why: String| InputError::File { file: file.into(), why };
        let read = || read_text(path).map_err(|why| wrong(typed, why));
        let mut is_written = true;
        let (text, json) = match extension.as_deref() {
            None if typed == INPUT => {
                let text = read_input().map_err(|why| wrong(INPUT_NAME, why))?;
                let json = text.trim_start().starts_with('{');
                (text, json)
            }
            Some("toml") => (read()?, false),
            Some("json") => (read()?, true),
            Some(extension) if hung::is_mesh(extension) => {
                is_written = false;
                (hung::scene(path).map_err(|why| wrong(typed, why))?, false)
            }
            Some(extension) if path.is_file() => {
                let scenes = "scenes are in files that end in .toml or .json";
                let why = format!("{}; {scenes}", not_a_mesh(Some(extension)));
                return Err(wrong(typed, why));
            }
            _ => return Err(InputError::Unknown(unknown(typed))),
        };
        let parsed = if json { parse_json(&text) } else { parse_toml(&text) };
        let (mut description, places) =
            parsed.map_err(|fault| InputError::Text { file: Some(said(typed)), fault })?;
        if description.name.is_none() {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let is_input = typed == INPUT;
            description.name = Some(if is_input { "input" } else { &*stem }.into());
        }
        let places = if is_written { places } else { places.without_lines() };
        Ok(Self {
            typed: typed.into(),
            path: Some(path.into()),
            ..Self::of_text(text, description, places)
        })
    }

    /// Returns the same scene as a window begins it: surfaces also touch where a scene asks for
    /// that in the window alone.
    pub fn in_window(mut self) -> Self {
        if self.description.window_self_collision && !self.description.self_collision {
            Arc::make_mut(&mut self.description).self_collision = true;
        }
        self
    }

    /// Returns the same scene, whose surfaces do not touch from the start.
    pub fn without_touch(&self) -> Self {
        let mut description = Description::clone(&self.description);
        description.self_collision = false;
        self.described(description)
    }

    /// Reads a scene from a text in TOML.
    pub fn written(text: &str) -> Result<Self, InputError> {
        let (description, places) = parse_toml(text).map_err(in_text)?;
        Ok(Self::of_text(text.into(), description, places))
    }

    /// Reads a scene from the table of its keys, as JSON.
    pub fn tabulated(json: &str) -> Result<Self, InputError> {
        let whole = |why: String| {
            let (line, key) = (None, String::new());
            in_text(Fault { line, key, why })
        };
        let table: Value = serde_json::from_str(json).map_err(|e| whole(e.to_string()))?;
        let text = toml::to_string(&table).map_err(|e| whole(e.to_string()))?;
        // The lines of this text mean nothing to the user.
        let parsed = parse_toml(&text).map_err(|fault| in_text(unplaced(fault)));
        let (description, places) = parsed?;
        Ok(Self::of_text(text, description, places.without_lines()))
    }

    /// Reads a scene that the program carries under a name, from its text in TOML.
    pub fn carried(name: &str, text: &str) -> Result<Self, InputError> {
        let (mut description, places) = parse_toml(text).map_err(in_text)?;
        let stem = Path::new(name).file_stem().unwrap_or_default();
        let own = || stem.to_string_lossy().into();
        description.name.get_or_insert_with(own);
        Ok(Self {
            typed: name.into(),
            path: None,
            ..Self::of_text(text.into(), description, places)
        })
    }

    fn of_text(text: String, mut description: Description, places: Places) -> Self {
        description.name.get_or_insert_with(|| TEXT.into());
        Self {
            typed: TEXT.into(),
            path: Some(TEXT.into()),
            description: Arc::new(description),
            text: text.into(),
            places: Arc::new(places),
            meshes: Arc::default(),
        }
    }

    /// Returns the table of the scene's keys, as JSON.
    pub fn table(&self) -> Result<String, InputError> {
        let table: Result<Value, _> = a3_scenes::read(&self.text);
        table.map(|table| table.to_string()).map_err(in_text)
    }

    /// Returns the scene with other values for some keys, which `change` sets in the table of its
    /// keys.
    pub fn with(
        &self,
        change: impl FnOnce(&mut Value) -> Result<(), String>,
    ) -> Result<Self, String> {
        let extension = self.path.as_deref().and_then(Path::extension);
        let json = extension.is_some_and(|e| e.eq_ignore_ascii_case("json"))
            || self.is_input() && self.text.trim_start().starts_with('{');
        let mut table: Value = if json {
            serde_json::from_str(&self.text).map_err(|e| e.to_string())?
        } else {
            a3_scenes::read(&self.text).map_err(|fault| fault.to_string())?
        };
        change(&mut table)?;
        let (text, parsed) = if json {
            let text = table.to_string();
            (text.clone(), parse_json(&text))
        } else {
            let text = toml::to_string(&table).map_err(|e| e.to_string())?;
            (text.clone(), parse_toml(&text))
        };
        // The program wrote this text, so its lines mean nothing to the user.
        let parsed = parsed.map_err(|fault| unplaced(fault).to_string());
        let (mut description, places) = parsed?;
        if description.name.is_none() {
            description.name.clone_from(&self.description.name);
        }
        Ok(Self {
            description: Arc::new(description),
            text: text.into(),
            places: Arc::new(places.without_lines()),
            meshes: Arc::default(),
            ..self.clone()
        })
    }

    /// Returns the scene with another description. The text stays as it is.
    pub fn described(&self, description: Description) -> Self {
        Self { description: Arc::new(description), meshes: Arc::default(), ..self.clone() }
    }

    /// Returns whether the scene has a name, or is in a file.
    pub fn is_named(&self) -> bool {
        self.path.as_deref() != Some(Path::new(TEXT))
    }

    /// Returns whether the scene came by standard input, which cannot be read again.
    pub fn is_input(&self) -> bool {
        self.typed == INPUT
    }

    /// Builds the scene, with its own grid of the first cloth or with another one.
    pub fn build(&self, grid: Option<Grid>) -> Result<Setup, InputError> {
        // With another grid, the scene is built twice: with its own grid too.
        let mut reader = MeshReader::new(if grid.is_some() { 2 } else { 1 });
        let mut mesh = |name: &str| {
            let path = beside(self.path.as_deref(), name)?;
            let loaded = load_mesh(&path, &mut reader);
            loaded.map_err(|why| format!("{}: {why}", path.display()))
        };
        let built = self.description.build(grid, &mut mesh);
        self.meshes.store(reader.hash.value(), Ordering::Relaxed);
        built.map_err(|fault| InputError::Text {
            file: self.path.as_ref().map(|_| said(&self.typed)),
            fault: self.places.locate(fault),
        })
    }

    /// Returns the solver that was asked for, or else that of the scene, or else the explicit
    /// trapezoid, which supports every scene.
    pub fn solver_or(&self, asked: Option<&'static Method>) -> &'static Method {
        let own = || integrators::find(self.description.solver.as_deref()?);
        asked
            .or_else(own)
            .or_else(|| integrators::find("trapezoid"))
            .unwrap_or(&integrators::METHODS[0])
    }

    /// Returns the text of the scene.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns a text that identifies the scene that was last built: its name, and for a file also
    /// a hash of its text, of its mesh files and of its state at the start.
    pub fn fingerprint(&self, scene: &Scene) -> String {
        if self.path.is_none() {
            return scene.name.clone();
        }
        let mut hash = Hash::default();
        hash.add(self.text.bytes());
        hash.add(self.meshes.load(Ordering::Relaxed).to_le_bytes());
        hash.add(scene.state.iter().flat_map(|y| y.to_le_bytes()));
        format!("{} {:016x}", scene.name, hash.value())
    }
}

/// Returns the name of a file in messages.
fn said(typed: &str) -> String {
    if typed == INPUT { INPUT_NAME } else { typed }.into()
}

/// Returns a fault without its line.
fn unplaced(fault: Fault) -> Fault {
    Fault { line: None, ..fault }
}

/// Returns the fault of a text that is in no file.
fn in_text(fault: Fault) -> InputError {
    let file = Some(TEXT.into());
    InputError::Text { file, fault }
}

/// Writes the error of an unknown name.
fn unknown(typed: &str) -> String {
    let names: Vec<_> = a3_scenes::SCENES.iter().map(|entry| entry.name).collect();
    let is_folder = Path::new(typed).is_dir();
    let what = ["there is no such scene", "this is a folder"][usize::from(is_folder)];
    let near = a3_scenes::nearest(typed, names.iter().copied());
    let all = format!(
        "scenes are {}, or a file that ends in .toml or .json, or a mesh",
        names.join(", ")
    );
    match near {
        Some(name) => format!("{what}; did you mean {name}? The {all}"),
        None => format!("{what}; the {all}"),
    }
}
