//! Universal Scene Description as text (`.usda`; Pixar, *`OpenUSD`*): a mesh of all surfaces,
//! linear curves of the springs of particles without one, these particles as points, and the
//! surface of a fluid as a mesh of its own. Points, normals and extents are time samples, whose
//! times are the numbers of the frames. The mesh stays whole when something tears; the fluid has
//! different triangles in each frame.
//!
//! The samples of an attribute follow one another, so each attribute is written to a temporary file
//! until the run is over.

use std::collections::BTreeMap;
use std::fmt::{Display, Write as _};
use std::io;
use std::io::{BufWriter, Write};

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_files::frames::FrameTimes;
use a3_files::output::{Draft, Scratch};
use a3_files::rounding::{DIGITS, short};
use a3_files::visible::in_a_line;

use super::geometry::{Export, Geometry, Job, positions, vertices};
use crate::surfaces::Liquid;

/// Width of curves and points, over the diagonal of the bounding box of the first frame.
const WIDTH: f32 = 0.005;

/// Approximate length of a vector in the file (bytes).
const VECTOR_LENGTH: f64 = 38.0;
/// Approximate length of a number of a vertex in the file (bytes).
const NUMBER_LENGTH: f64 = 6.0;

// Attributes that change.
const POINTS: &str = "point3f[] points";
const EXTENT: &str = "float3[] extent";
const NORMALS: &str = "normal3f[] normals";
const COUNTS: &str = "int[] faceVertexCounts";
const INDICES: &str = "int[] faceVertexIndices";

/// Attributes of a mesh that do not change.
const MESH: &str = "        uniform bool doubleSided = 1
        uniform token subdivisionScheme = \"none\"
        normal3f[] normals (
            interpolation = \"vertex\"
        )
";

/// A file that is being written.
pub struct Usd {
    draft: Draft,
    frames: FrameTimes,
    /// Number of the next frame.
    next: usize,
    geometry: Geometry,
    /// Name of the scene.
    scene: String,
    width: f32,
    prims: Vec<Prim>,
    liquid: Option<Prim>,
}

/// A primitive: a mesh, curves or points with their attributes.
struct Prim {
    /// Its type and its name.
    kind: &'static str,
    name: &'static str,
    /// Its vertices.
    vertices: Vec<u32>,
    /// Text of the attributes that do not change.
    fixed: String,
    /// Attributes that change.
    samples: Vec<Samples>,
}

/// Time samples of an attribute.
struct Samples {
    /// Its type and its name.
    name: &'static str,
    file: BufWriter<Scratch>,
}

/// Returns the approximate size of the file (bytes).
pub fn size(simulation: &Simulation, frames: FrameTimes) -> f64 {
    let Liquid { corners, triangles } = Liquid::of(simulation, |_| None);
    let vectors = 2.0 * (vertices(simulation) + corners.len()) as f64;
    frames.count as f64 * (VECTOR_LENGTH * vectors + 4.0 * NUMBER_LENGTH * triangles.len() as f64)
}

impl Usd {
    /// Creates a file.
    pub fn new(job: Job) -> Result<Self, Failure> {
        let Job { path, simulation, frames, .. } = job;
        let draft = Draft::new(path)?;
        let geometry = Geometry::of(job.surface, job.simulation);
        let samples = |names: &[&'static str]| -> Result<Vec<_>, Failure> {
            let samples = names.iter().map(|name| {
                let file = BufWriter::new(Scratch::new(path)?);
                Ok(Samples { name, file })
            });
            samples.collect()
        };
        let prim = |[kind, name]: [&'static str; 2], vertices, fixed, names: &[&'static str]| {
            Ok::<_, Failure>(Prim { kind, name, vertices, fixed, samples: samples(names)? })
        };
        let mut prims = vec![];
        if !geometry.triangles.is_empty() {
            let (vertices, corners) = renumbered(geometry.triangles.as_flattened());
            let (counts, corners) = (list(geometry.triangles.iter().map(|_| 3)), list(&corners));
            let fixed =
                format!("{MESH}        {COUNTS} = {counts}\n        {INDICES} = {corners}\n");
            let names = [POINTS, EXTENT, NORMALS];
            prims.push(prim(["Mesh", "surface"], vertices, fixed, &names)?);
        }
        if !geometry.lines.is_empty() {
            let vertices = geometry.lines.as_flattened().to_vec();
            let counts = list(geometry.lines.iter().map(|_| 2));
            let fixed = format!(
                "        uniform token type = \"linear\"\n        int[] curveVertexCounts = {counts}\n"
            );
            prims.push(prim(["BasisCurves", "springs"], vertices, fixed, &[POINTS, EXTENT])?);
        }
        if !geometry.points.is_empty() {
            let (vertices, fixed) = (geometry.points.clone(), String::new());
            prims.push(prim(["Points", "particles"], vertices, fixed, &[POINTS, EXTENT])?);
        }
        let network = simulation.model().network();
        let names = [POINTS, EXTENT, NORMALS, COUNTS, INDICES];
        let has_liquid = network.is_some_and(|network| network.fluid().is_some());
        let liquid = has_liquid.then(|| prim(["Mesh", "liquid"], vec![], MESH.into(), &names));
        let liquid = liquid.transpose()?;
        Ok(Self {
            draft,
            next: frames.first,
            frames,
            geometry,
            scene: simulation.scene().name.clone(),
            width: 0.0,
            prims,
            liquid,
        })
    }

    /// Adds the current state.
    fn write_frame(&mut self, simulation: &Simulation) -> io::Result<()> {
        let all = positions(simulation)?;
        let normals = self.geometry.normals(&all);
        if self.width == 0.0 {
            let [low, high] = extent(&all);
            let diagonal = [0, 1, 2].map(|k| high[k] - low[k]);
            self.width = WIDTH * diagonal.iter().map(|d| d * d).sum::<f32>().sqrt();
        }
        for prim in &mut self.prims {
            let of = |all: &[[f32; 3]]| -> Vec<_> {
                prim.vertices.iter().map(|i| all[*i as usize]).collect()
            };
            let (points, normals) = (of(&all), of(&normals));
            let texts = [vectors(&points), vectors(&extent(&points)), vectors(&normals)];
            prim.add(self.next, texts)?;
        }
        if let Some(prim) = &mut self.liquid {
            let Liquid { corners, triangles } = Liquid::of(simulation, |_| None);
            let points: Vec<_> = corners.iter().map(|corner| corner.place).collect();
            let normals: Vec<_> = corners.iter().map(|corner| corner.normal).collect();
            let texts = [
                vectors(&points),
                vectors(&extent(&points)),
                vectors(&normals),
                list(triangles.iter().map(|_| 3)),
                list(triangles.as_flattened()),
            ];
            prim.add(self.next, texts)?;
        }
        self.next += 1;
        Ok(())
    }

    /// Writes the file.
    fn write(&mut self) -> io::Result<()> {
        let draft = &mut self.draft;
        let (first, last) = (self.frames.first, self.next.saturating_sub(1));
        let rate = short(self.frames.rate, DIGITS);
        let scene = in_a_line(&self.scene);
        let scene = scene.replace('\\', "\\\\").replace('"', "\\\"");
        write!(
            draft,
            "#usda 1.0\n(\n    defaultPrim = \"scene\"\n    doc = \"a3: {scene}\"\n    \
             endTimeCode = {last}\n    framesPerSecond = {rate}\n    metersPerUnit = 1\n    \
             startTimeCode = {first}\n    timeCodesPerSecond = {rate}\n    upAxis = \"Y\"\n)\n\n\
             def Xform \"scene\" (\n    kind = \"component\"\n)\n{{\n"
        )?;
        for prim in self.prims.iter_mut().chain(&mut self.liquid) {
            write!(draft, "    def {} \"{}\"\n    {{\n{}", prim.kind, prim.name, prim.fixed)?;
            if prim.kind != "Mesh" {
                let width = self.width;
                write!(
                    draft,
                    "        float[] widths = [{width}] (\n            \
                               interpolation = \"constant\"\n        )\n"
                )?;
            }
            for samples in &mut prim.samples {
                samples.file.flush()?;
                writeln!(draft, "        {}.timeSamples = {{", samples.name)?;
                io::copy(&mut samples.file.get_ref().reader()?, draft)?;
                writeln!(draft, "        }}")?;
            }
            write!(draft, "    }}\n\n")?;
        }
        writeln!(draft, "}}")
    }
}

impl Prim {
    /// Adds the values of the attributes at a frame, in their order. Further values, of attributes
    /// that this primitive does not have, are left out.
    fn add(&mut self, frame: usize, texts: impl IntoIterator<Item = String>) -> io::Result<()> {
        for (samples, text) in self.samples.iter_mut().zip(texts) {
            writeln!(samples.file, "            {frame}: {text},")?;
        }
        Ok(())
    }
}

impl Export for Usd {
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let written = self.write_frame(simulation);
        written.map_err(|e| self.draft.failure(&e))
    }

    fn finish(mut self: Box<Self>) -> Result<(), Failure> {
        let written = self.write();
        written.map_err(|e| self.draft.failure(&e))?;
        self.draft.place()
    }
}

/// Returns the distinct vertices of some corners, in order, and the index of each corner among
/// these.
fn renumbered(corners: &[u32]) -> (Vec<u32>, Vec<usize>) {
    let mut places: BTreeMap<u32, usize> = corners.iter().map(|i| (*i, 0)).collect();
    for (k, place) in places.values_mut().enumerate() {
        *place = k;
    }
    let renumbered = corners.iter().map(|i| places[i]).collect();
    (places.into_keys().collect(), renumbered)
}

/// Returns the least and the largest coordinates of points; zeros if there are none.
fn extent(points: &[[f32; 3]]) -> [[f32; 3]; 2] {
    let most = |better: fn(f32, f32) -> f32| {
        let all = points.iter().copied();
        let most = all.reduce(|a, b| [0, 1, 2].map(|k| better(a[k], b[k])));
        most.unwrap_or_default()
    };
    [most(f32::min), most(f32::max)]
}

/// Writes an array of values.
fn list<T: Display>(values: impl IntoIterator<Item = T>) -> String {
    let mut text = String::from("[");
    for (k, value) in values.into_iter().enumerate() {
        let comma = if k > 0 { ", " } else { "" };
        let _ = write!(text, "{comma}{value}");
    }
    text + "]"
}

/// Writes an array of vectors.
fn vectors(all: &[[f32; 3]]) -> String {
    list(all.iter().map(|[x, y, z]| format!("({x}, {y}, {z})")))
}
