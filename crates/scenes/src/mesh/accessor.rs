//! Accessors of a glTF file: numbers in views of its buffers, some of them replaced (sparse).

use std::borrow::Cow;

use serde::Deserialize;

// The codes of glTF for types of numbers.
const U8: u32 = 5121;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// Accessor of `count` elements.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    pub count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<Sparse>,
}

/// Elements that are replaced.
#[derive(Deserialize)]
struct Sparse {
    count: usize,
    indices: Part,
    values: Part,
}

/// Part of a view; the component type is that of indices.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Part {
    buffer_view: usize,
    #[serde(default)]
    byte_offset: usize,
    component_type: Option<u32>,
}

/// View of a buffer.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

/// The bytes of a file's buffers, and the views of them.
pub(super) struct Buffers<'a> {
    pub buffers: Vec<Cow<'a, [u8]>>,
    pub views: &'a [View],
}

impl Buffers<'_> {
    /// Vectors of three numbers.
    pub fn vectors(&self, accessor: &Accessor) -> Result<Vec<[f32; 3]>, String> {
        if (accessor.kind.as_str(), accessor.component_type) != ("VEC3", F32) {
            return Err("positions are vectors of three floats".into());
        }
        let bytes = self.bytes(accessor, 12)?;
        let (numbers, _) = bytes.as_chunks::<4>();
        let (rows, _) = numbers.as_chunks::<3>();
        Ok(rows.iter().map(|row| row.map(f32::from_le_bytes)).collect())
    }

    /// Numbers of points.
    pub fn indices(&self, accessor: &Accessor) -> Result<Vec<u32>, String> {
        if accessor.kind != "SCALAR" {
            return Err("indices are single numbers".into());
        }
        let size = size(accessor.component_type)?;
        Ok(whole(&self.bytes(accessor, size)?, size))
    }

    /// The bytes of all elements, each of that size, one after another.
    fn bytes(&self, accessor: &Accessor, size: usize) -> Result<Vec<u8>, String> {
        let count = accessor.count;
        let mut bytes = match accessor.buffer_view {
            None => vec![0; count.checked_mul(size).ok_or("its count is too large")?],
            Some(view) => self.packed(view, accessor.byte_offset, count, size)?,
        };
        if let Some(Sparse {
            count: some,
            indices,
            values,
        }) = &accessor.sparse
        {
            let wide = self::size(indices.component_type.unwrap_or(0))?;
            let places = self.packed(indices.buffer_view, indices.byte_offset, *some, wide)?;
            let values = self.packed(values.buffer_view, values.byte_offset, *some, size)?;
            for (k, value) in whole(&places, wide)
                .into_iter()
                .zip(values.chunks_exact(size))
            {
                let place = bytes.chunks_exact_mut(size).nth(k as usize);
                place
                    .ok_or_else(|| format!("it replaces element {k} of {count}"))?
                    .copy_from_slice(value);
            }
        }
        Ok(bytes)
    }

    /// The bytes of `count` elements of that size in a view, without those between them.
    fn packed(
        &self,
        view: usize,
        from: usize,
        count: usize,
        size: usize,
    ) -> Result<Vec<u8>, String> {
        let View {
            buffer,
            byte_offset,
            byte_length,
            byte_stride,
        } = self
            .views
            .get(view)
            .ok_or_else(|| format!("there is no view {view}"))?;
        let bytes = self.buffers.get(*buffer);
        let bytes = bytes
            .and_then(|bytes| bytes.get(*byte_offset..)?.get(..*byte_length)?.get(from..))
            .ok_or_else(|| format!("view {view} is not within its buffer"))?;
        let stride = byte_stride.unwrap_or(size);
        if !(size..=252).contains(&stride) {
            return Err(format!(
                "the stride of view {view} is {stride}: it is from {size} to 252"
            ));
        }
        let there = (bytes.len() + stride - size) / stride;
        if count > there {
            return Err(format!("view {view} has {there} elements, not {count}"));
        }
        let rows = bytes.chunks(stride).take(count);
        Ok(rows.flat_map(|row| &row[..size]).copied().collect())
    }
}

/// Size of a whole number of that type (bytes).
fn size(component_type: u32) -> Result<usize, String> {
    match component_type {
        U8 => Ok(1),
        U16 => Ok(2),
        U32 => Ok(4),
        other => Err(format!(
            "its numbers have the type {other}, which indices have not"
        )),
    }
}

/// The whole numbers in bytes, each of that size.
fn whole(bytes: &[u8], size: usize) -> Vec<u32> {
    let number = |bytes: &[u8]| bytes.iter().rev().fold(0, |n, b| n << 8 | u32::from(*b));
    bytes.chunks_exact(size).map(number).collect()
}
