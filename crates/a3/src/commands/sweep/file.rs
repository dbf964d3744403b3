//! The file of a sweep.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use a3_core::accuracy::{Metric, Scope};
use a3_core::{Method, integrators};
use a3_files::bounds::{LARGEST_STEP, SMALLEST_STEP, TOLERANCES};
use a3_files::failure::InputError;
use a3_files::output;
use a3_files::scene_file::Source;
use a3_files::terminal;
use serde::Deserialize;
use serde_json::Value;

use super::values::{all, flat};

/// Largest size of the file (bytes).
const MAX_SIZE: u64 = 1 << 20;
/// Key of the factor of the stiffness, among the names of swept keys.
const STIFFNESS: &str = "stiffness";

/// The keys of the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    scene: Value,
    solver: Option<Value>,
    step: Option<Value>,
    tolerance: Option<Value>,
    until: Option<f64>,
    stiffness: Option<Value>,
    error: Option<String>,
    particle: Option<usize>,
    #[serde(default)]
    at_end: bool,
    #[serde(default)]
    keys: BTreeMap<String, Value>,
}

/// A sweep: its scenes, solvers, steps, tolerances and values of keys.
pub struct Sweep {
    /// Path of the file as it was typed.
    pub file: String,
    /// Name of the file.
    pub name: String,
    pub scenes: Vec<Source>,
    /// The chosen solvers; empty for all.
    pub methods: Vec<&'static Method>,
    pub steps: Vec<f64>,
    pub tolerances: Vec<f64>,
    /// End of the runs (s), if it is not the scene's own.
    pub until: Option<f64>,
    /// Factors of the stiffness of all springs; `None` where it is not swept.
    pub stiffness: Option<Vec<f64>>,
    pub error: Metric,
    pub scope: Scope,
    /// Keys of the scenes, with their values.
    pub keys: Vec<(String, Vec<Value>)>,
}

impl Sweep {
    /// Reads the file.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let file = path.to_string_lossy().into_owned();
        let wrong = |why: String| InputError::File { file: file.clone(), why };
        let size = fs::metadata(path)
            .map_err(|e| wrong(format!("it could not be read: {}", terminal::reason(&e))))?;
        if !size.is_file() || size.len() > MAX_SIZE {
            return Err(wrong("it is no ordinary file of at most 1 MiB".into()));
        }
        output::is_read(path);
        let text = fs::read_to_string(path).map_err(|e| wrong(terminal::reason(&e)))?;
        let text: Text = a3_scenes::read(&text)
            .map_err(|fault| InputError::Text { file: Some(file.clone()), fault })?;
        Self::new(path, &text).map_err(wrong)
    }

    fn new(path: &Path, text: &Text) -> Result<Self, String> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let scenes = texts("scene", Some(&text.scene))?;
        let scenes = scenes.iter().map(|name| match a3_scenes::find(name) {
            Some(_) => Source::find(name),
            None => Source::find(&folder.join(name).to_string_lossy()),
        });
        let scenes = scenes.map(|scene| scene.map_err(|error| error.to_string()));
        let methods = texts("solver", text.solver.as_ref())?;
        let methods = methods.iter().map(|name| {
            let names = integrators::METHODS.iter().map(|m| m.name);
            integrators::find(name).ok_or_else(|| match a3_scenes::nearest(name, names) {
                Some(near) => format!("solver: there is no solver {name}; did you mean {near}?"),
                None => format!("solver: there is no solver {name}; `a3 solvers` lists them"),
            })
        });
        let error = match &text.error {
            None => Metric::default(),
            Some(error) => {
                let mut all = Metric::OF_PARTICLES.into_iter();
                all.find(|metric| metric.name() == error).ok_or_else(|| {
                    let all = Metric::OF_PARTICLES.map(Metric::name).join(", ");
                    format!("error: the choices are {all}, not {error}")
                })?
            }
        };
        let keys = flat(&text.keys).into_iter().map(|(path, values)| {
            let values = all(&values).map_err(|why| format!("keys.{path}: {why}"))?;
            Ok((path, values))
        });
        let (until, stem) = (text.until, path.file_stem().unwrap_or_default());
        if until.is_some_and(|until| !(until > 0.0 && until <= 1e4)) {
            return Err("until: it must be a number of seconds above 0 and at most 10000".into());
        }
        let (factors, steps) = (1e-9..=1e9, SMALLEST_STEP..=LARGEST_STEP);
        let sweep = Self {
            file: path.display().to_string(),
            name: stem.to_string_lossy().into_owned(),
            scenes: scenes.collect::<Result<_, _>>()?,
            methods: methods.collect::<Result<_, _>>()?,
            steps: numbers("step", text.step.as_ref(), &steps)?,
            tolerances: numbers("tolerance", text.tolerance.as_ref(), &TOLERANCES)?,
            until,
            stiffness: match &text.stiffness {
                None => None,
                factor => Some(numbers(STIFFNESS, factor.as_ref(), &factors)?),
            },
            error,
            scope: Scope { particle: text.particle, at_end: text.at_end },
            keys: keys.collect::<Result<_, String>>()?,
        };
        for method in &sweep.methods {
            if sweep.settings(method).is_empty() {
                let (what, other) = if is_adaptive(method) {
                    ("tolerance", "a tolerance")
                } else {
                    ("step", "steps")
                };
                let name = method.name;
                let why = format!("the solver {name} takes {other}: the key `{what}` is missing");
                return Err(why);
            }
        }
        if sweep.steps.is_empty() && sweep.tolerances.is_empty() {
            return Err("one of the keys `step` and `tolerance` is missing".into());
        }
        Ok(sweep)
    }

    /// Returns the steps or tolerances of a method.
    pub fn settings(&self, method: &Method) -> &[f64] {
        if is_adaptive(method) { &self.tolerances } else { &self.steps }
    }

    /// Returns the names of the swept keys, including the stiffness.
    pub fn names(&self) -> Vec<&str> {
        let names = self.keys.iter().map(|(path, _)| path.as_str());
        let factor = self.stiffness.as_ref().map(|_| STIFFNESS);
        names.chain(factor).collect()
    }
}

fn is_adaptive(method: &Method) -> bool {
    method.control(1e-3).step().is_none()
}

/// Reads the values of a key, each by `read`, which says what a wrong one must be; none without the
/// key.
fn values<T>(
    key: &str,
    value: Option<&Value>,
    read: impl Fn(&Value) -> Result<T, String>,
) -> Result<Vec<T>, String> {
    let values = value.map_or(Ok(vec![]), all);
    let values = values.and_then(|values| {
        let wrong = |value| move |must| format!("{must}, not {value}");
        let read = |value| read(value).map_err(wrong(value));
        values.iter().map(read).collect()
    });
    values.map_err(|why| format!("{key}: {why}"))
}

/// Reads the numbers of a key, each within a range.
fn numbers(
    key: &str,
    value: Option<&Value>,
    range: &std::ops::RangeInclusive<f64>,
) -> Result<Vec<f64>, String> {
    values(key, value, |value| {
        let number = value.as_f64().filter(|number| range.contains(number));
        let (low, high) = (range.start(), range.end());
        number.ok_or_else(|| format!("each must be a number from {low:e} to {high:e}"))
    })
}

/// Reads the texts of a key.
fn texts(key: &str, value: Option<&Value>) -> Result<Vec<String>, String> {
    values(key, value, |value| {
        let text = value.as_str().map(str::to_owned);
        text.ok_or_else(|| "it must be a name or a list of names".into())
    })
}
