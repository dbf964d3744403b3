//! glTF 2.0 in one binary file (Khronos, *glTF 2.0 Specification*). The first frame is a mesh,
//! every other frame a morph target, and an animation blends from each to the next. The mesh stays
//! whole when something tears. The surface of a fluid has different triangles in each frame, so
//! each frame has a mesh of its own: the animation scales one after another from 0 to its full
//! size.

use std::io::{self, Write};

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_files::frames::FrameTimes;
use a3_files::output::{Draft, Scratch};
use serde_json::{Value, json};

use super::geometry::{Export, Geometry, Job, positions, rows};
use crate::surfaces::Liquid;

/// Largest number of frames. The animation has a weight for each morph target in each frame, so
/// that its size grows with the square of their number.
const MAX_FRAMES: usize = 600;

// The codes of glTF for types of numbers, for uses of buffers, and for kinds of primitives.
const F32: u32 = 5126;
const U32: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
const POINTS: u32 = 0;
const LINES: u32 = 1;
const TRIANGLES: u32 = 4;

/// A binary glTF file that is being written.
pub struct Glb {
    draft: Draft,
    geometry: Geometry,
    frames: FrameTimes,
    scene: String,
    binary: Binary,
    /// Positions and normals of the first frame.
    first: Option<[Vec<[f32; 3]>; 2]>,
    /// The accessors of each frame: positions or displacements, and normals if there is a surface.
    attributes: Vec<Value>,
    /// The surface of the fluid in each frame, or null.
    liquids: Vec<Value>,
}

/// The binary chunk, which stays in a temporary file until the length of the chunk before it is
/// known.
struct Binary {
    file: io::BufWriter<Scratch>,
    /// Number of bytes so far.
    length: usize,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

/// Returns the size of the binary chunk (bytes).
pub fn size(job: Job) -> f64 {
    let geometry = Geometry::of(job.surface, job.simulation);
    let (n, count) = (geometry.vertices as f64, job.frames.count as f64);
    let Liquid { corners, triangles } = Liquid::of(job.simulation, |_| None);
    let liquid = 24.0 * corners.len() as f64 + 12.0 * triangles.len() as f64;
    (24.0 * n + liquid) * count + 12.0 * geometry.triangles.len() as f64 + 4.0 * count * count
}

/// Refuses too many frames.
pub fn check(frames: FrameTimes) -> Result<(), Failure> {
    if frames.count <= MAX_FRAMES {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "{} frames are too many for a .glb, which has at most {MAX_FRAMES}: use a lower --fps, a .usda, or film-####.obj",
        frames.count
    )))
}

impl Glb {
    /// Creates a file.
    pub fn new(job: Job) -> Result<Self, Failure> {
        let draft = Draft::new(job.path)?;
        let file = Scratch::new(job.path)?;
        Ok(Self {
            draft,
            geometry: Geometry::of(job.surface, job.simulation),
            frames: job.frames,
            scene: job.simulation.scene().name.clone(),
            binary: Binary {
                file: io::BufWriter::new(file),
                length: 0,
                views: vec![],
                accessors: vec![],
            },
            first: None,
            attributes: vec![],
            liquids: vec![],
        })
    }

    /// Returns whether there is a surface.
    fn has_surface(&self) -> bool {
        !self.geometry.triangles.is_empty()
    }

    /// Writes the positions and normals of a frame.
    fn write_frame(&mut self, simulation: &Simulation) -> io::Result<()> {
        let mut x = positions(simulation)?;
        let mut normals = if self.has_surface() { self.geometry.normals(&x) } else { vec![] };
        if let Some([x0, normals0]) = &self.first {
            subtract(&mut x, x0);
            subtract(&mut normals, normals0);
        } else {
            self.first = Some([x.clone(), normals.clone()]);
        }
        let mut attributes = json!({ "POSITION": self.binary.vectors(&x, Some(VERTICES), true)? });
        if self.has_surface() {
            attributes["NORMAL"] = self.binary.vectors(&normals, Some(VERTICES), false)?.into();
        }
        self.attributes.push(attributes);
        let liquid = self.binary.liquid(&Liquid::of(simulation, |_| None))?;
        self.liquids.push(liquid);
        Ok(())
    }

    /// Writes the primitives: triangles of the surface, and lines and points of particles without
    /// one.
    fn primitives(&mut self) -> io::Result<Vec<Value>> {
        let parts = [
            (TRIANGLES, self.geometry.triangles.as_flattened()),
            (LINES, self.geometry.lines.as_flattened()),
            (POINTS, &self.geometry.points[..]),
        ];
        let mut primitives = vec![];
        for (mode, indices) in parts {
            if indices.is_empty() {
                continue;
            }
            let indices = self.binary.indices(indices)?;
            // Only triangles have normals.
            let attributes = self.attributes.iter().map(|attributes| {
                let mut attributes = attributes.clone();
                if let Some(names) = attributes.as_object_mut().filter(|_| mode != TRIANGLES) {
                    names.remove("NORMAL");
                }
                attributes
            });
            let mut attributes: Vec<_> = attributes.collect();
            let targets = attributes.split_off(1);
            let mut primitive = json!({
                "mode": mode, "attributes": attributes[0], "indices": indices, "material": 0,
            });
            if !targets.is_empty() {
                primitive["targets"] = targets.into();
            }
            primitives.push(primitive);
        }
        Ok(primitives)
    }

    /// Writes the animation from each frame to the next. In frame k > 0 the weight of morph target
    /// k - 1 is 1, and all others are 0.
    fn animation(&mut self) -> io::Result<Value> {
        let times: Vec<f32> = self.frames.times().map(|time| time as f32).collect();
        let targets = times.len() - 1;
        let row =
            |k: usize| (0..targets).map(move |target| if target + 1 == k { 1.0 } else { 0.0 });
        let input = self.binary.times(&times)?;
        let output = self.binary.scalars((0..times.len()).flat_map(row))?;
        let mut samplers =
            vec![json!({ "input": input, "output": output, "interpolation": "LINEAR" })];
        let mut channels =
            vec![json!({ "sampler": 0, "target": { "node": 0, "path": "weights" } })];
        let shown = (0..times.len()).filter(|k| !self.liquids[*k].is_null());
        for (node, k) in (1..).zip(shown) {
            // The scale is 0 at first, 1 in this frame, and 0 from the next one on.
            let mut keys = vec![(times[k], 1.0)];
            if k > 0 {
                keys.insert(0, (times[0], 0.0));
            }
            keys.extend(times.get(k + 1).map(|time| (*time, 0.0)));
            let (keys, sizes): (Vec<_>, Vec<_>) = keys.into_iter().unzip();
            let input = self.binary.times(&keys)?;
            let sizes: Vec<_> = sizes.into_iter().map(|size: f32| [size; 3]).collect();
            let output = self.binary.vectors(&sizes, None, false)?;
            channels.push(json!({
                "sampler": samplers.len(), "target": { "node": node, "path": "scale" }
            }));
            samplers.push(json!({ "input": input, "output": output, "interpolation": "STEP" }));
        }
        Ok(json!([{ "name": "simulation", "samplers": samplers, "channels": channels }]))
    }

    /// Adds a mesh and a node for the surface of the fluid in each frame.
    fn add_liquids(&self, document: &mut Value) {
        let (mut nodes, mut meshes, mut roots) = (vec![], vec![], vec![]);
        for (k, liquid) in self.liquids.iter().enumerate().filter(|(_, l)| !l.is_null()) {
            roots.push(json!(nodes.len() + 1));
            let (name, size) = (format!("liquid {k}"), u8::from(k == 0));
            nodes.push(
                json!({ "name": name, "mesh": meshes.len() + 1, "scale": [size, size, size] }),
            );
            meshes.push(json!({ "name": name, "primitives": [liquid] }));
        }
        if nodes.is_empty() {
            return;
        }
        let water = json!({
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.02, 0.24, 0.46, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.2,
            },
        });
        for (key, more) in [("nodes", nodes), ("meshes", meshes), ("materials", vec![water])] {
            if let Some(list) = document[key].as_array_mut() {
                list.extend(more);
            }
        }
        if let Some(all) = document["scenes"][0]["nodes"].as_array_mut() {
            all.extend(roots);
        }
    }

    /// Writes the whole file.
    fn write(&mut self) -> io::Result<()> {
        let mut document = json!({
            "asset": { "version": "2.0", "generator": concat!("a3 ", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "name": self.scene, "mesh": 0 }],
            "meshes": [{ "name": self.scene, "primitives": self.primitives()? }],
            "materials": [{
                "pbrMetallicRoughness": {
                    "baseColorFactor": [0.62, 0.045, 0.06, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.7,
                },
                "doubleSided": true,
            }],
        });
        self.add_liquids(&mut document);
        if self.frames.count > 1 {
            document["animations"] = self.animation()?;
        }
        let Self { draft, binary, .. } = self;
        document["bufferViews"] = std::mem::take(&mut binary.views).into();
        document["accessors"] = std::mem::take(&mut binary.accessors).into();
        document["buffers"] = json!([{ "byteLength": binary.length }]);
        let mut text = serde_json::to_vec(&document)?;
        text.resize(text.len().next_multiple_of(4), b' ');
        binary.file.flush()?;
        let mut data = binary.file.get_ref().reader()?;
        draft.write_all(b"glTF")?;
        for number in [2, 28 + text.len() + binary.length, text.len()] {
            draft.write_all(&(number as u32).to_le_bytes())?;
        }
        draft.write_all(b"JSON")?;
        draft.write_all(&text)?;
        draft.write_all(&(binary.length as u32).to_le_bytes())?;
        draft.write_all(b"BIN\0")?;
        io::copy(&mut data, draft)?;
        Ok(())
    }
}

impl Export for Glb {
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        self.write_frame(simulation).map_err(|e| self.draft.failure(&e))
    }

    fn finish(mut self: Box<Self>) -> Result<(), Failure> {
        self.write().map_err(|e| self.draft.failure(&e))?;
        self.draft.place()
    }
}

impl Binary {
    /// Adds an accessor of the bytes that were just written, and returns its number.
    fn accessor(&mut self, bytes: usize, target: Option<u32>, mut accessor: Value) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.length, "byteLength": bytes });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        accessor["bufferView"] = self.views.len().into();
        self.views.push(view);
        self.accessors.push(accessor);
        self.length += bytes;
        self.accessors.len() - 1
    }

    /// Writes the surface of a fluid, and returns its primitive, or null where it is empty.
    fn liquid(&mut self, liquid: &Liquid) -> io::Result<Value> {
        if liquid.triangles.is_empty() {
            return Ok(Value::Null);
        }
        let corners = liquid.corners.iter();
        let (places, normals): (Vec<_>, Vec<_>) = corners.map(|c| (c.place, c.normal)).unzip();
        let positions = self.vectors(&places, Some(VERTICES), true)?;
        let normals = self.vectors(&normals, Some(VERTICES), false)?;
        let indices = self.indices(liquid.triangles.as_flattened())?;
        Ok(json!({
            "mode": TRIANGLES, "material": 1, "indices": indices,
            "attributes": { "POSITION": positions, "NORMAL": normals },
        }))
    }

    /// Writes vectors, and returns the number of their accessor. An accessor of
    /// positions must have a range.
    fn vectors(
        &mut self,
        vectors: &[[f32; 3]],
        target: Option<u32>,
        with_range: bool,
    ) -> io::Result<usize> {
        rows(&mut self.file, vectors)?;
        let mut accessor = json!({ "componentType": F32, "type": "VEC3", "count": vectors.len() });
        if with_range {
            let of = |start: f32, pick: fn(f32, f32) -> f32| {
                [0, 1, 2].map(|axis| vectors.iter().map(|v| v[axis]).fold(start, pick))
            };
            accessor["min"] = json!(of(f32::INFINITY, f32::min));
            accessor["max"] = json!(of(f32::NEG_INFINITY, f32::max));
        }
        Ok(self.accessor(12 * vectors.len(), target, accessor))
    }

    /// Writes indices, and returns the number of their accessor.
    fn indices(&mut self, indices: &[u32]) -> io::Result<usize> {
        for index in indices {
            self.file.write_all(&index.to_le_bytes())?;
        }
        let accessor = json!({ "componentType": U32, "type": "SCALAR", "count": indices.len() });
        Ok(self.accessor(4 * indices.len(), Some(INDICES), accessor))
    }

    /// Writes scalars, and returns the number of their accessor.
    fn scalars(&mut self, scalars: impl Iterator<Item = f32>) -> io::Result<usize> {
        let mut count = 0;
        for scalar in scalars {
            self.file.write_all(&scalar.to_le_bytes())?;
            count += 1;
        }
        let accessor = json!({ "componentType": F32, "type": "SCALAR", "count": count });
        Ok(self.accessor(4 * count, None, accessor))
    }

    /// Writes times, in order, and returns the number of their accessor, which has a range.
    fn times(&mut self, times: &[f32]) -> io::Result<usize> {
        let accessor = self.scalars(times.iter().copied())?;
        self.accessors[accessor]["min"] = json!([times[0]]);
        self.accessors[accessor]["max"] = json!([times[times.len() - 1]]);
        Ok(accessor)
    }
}

/// Subtracts the others from the vectors.
fn subtract(vectors: &mut [[f32; 3]], others: &[[f32; 3]]) {
    for (v, other) in vectors.iter_mut().zip(others) {
        *v = [0, 1, 2].map(|k| v[k] - other[k]);
    }
}
