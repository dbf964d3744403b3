//! Accessors of a glTF file: numbers in views of its buffers, some of them replaced (sparse).

use std::borrow::Cow;

use serde::Deserialize;

// Component types: the codes of glTF.
const I8: u32 = 5120;
const U8: u32 = 5121;
const I16: u32 = 5122;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// Accessor of `count` elements.
#[derive(Clone, Deserialize)]
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
    /// Whether whole numbers are fractions of the largest one of their type.
    #[serde(default)]
    normalized: bool,
}

impl Accessor {
    /// Returns whether its numbers are in a buffer. If not, they are 0, or an extension stores
    /// them.
    pub fn is_stored(&self) -> bool {
        self.buffer_view.is_some() || self.sparse.is_some()
    }

    /// Returns the accessor of its first `count` elements.
    pub fn first(&self, count: usize) -> Self {
        Self {
            count,
            ..self.clone()
        }
    }
}

/// Elements that are replaced (sparse storage).
#[derive(Clone, Deserialize)]
struct Sparse {
    count: usize,
    indices: Part,
    values: Part,
}

/// Part of a view. Only indices have a component type here.
#[derive(Clone, Deserialize)]
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

/// Bytes of a file's buffers, and the views of them.
pub(super) struct Buffers<'a> {
    pub buffers: Vec<Cow<'a, [u8]>>,
    pub views: &'a [View],
}

impl Buffers<'_> {
    /// Reads vectors of three or four numbers, or matrices of sixteen.
    pub fn vectors<const N: usize>(&self, accessor: &Accessor) -> Result<Vec<[f32; N]>, String> {
        let kind = match N {
            3 => "VEC3",
            4 => "VEC4",
            _ => "MAT4",
        };
        refuse!(if accessor.kind != kind => "its type is {}, not {kind}", accessor.kind);
        let Number {
            size,
            largest,
            read,
        } = number(accessor.component_type)?;
        let bytes = self.bytes(accessor, N * size)?;
        let share = |number: f32| {
            if accessor.normalized && largest > 0.0 {
                (number / largest).max(-1.0)
            } else {
                number
            }
        };
        let rows = bytes.chunks_exact(N * size);
        let row = |row: &[u8]| std::array::from_fn(|k| share(read(&row[k * size..][..size])));
        Ok(rows.map(row).collect())
    }

    /// Reads numbers of points.
    pub fn indices(&self, accessor: &Accessor) -> Result<Vec<u32>, String> {
        refuse!(if accessor.kind != "SCALAR" => "indices are single numbers");
        let size = size(accessor.component_type)?;
        Ok(whole(&self.bytes(accessor, size)?, size))
    }

    /// Returns the bytes of all elements of this size (bytes), one after another.
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
            refuse!(if *some > count => "it replaces {some} elements of {count}");
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

    /// Returns the bytes of `count` elements of this size (bytes) in a view, without gaps.
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
        refuse!(if !(size..=252).contains(&stride) =>
            "the stride of view {view} is {stride}: it is from {size} to 252");
        let there = (bytes.len() + stride - size) / stride;
        refuse!(if count > there => "view {view} has {there} elements, not {count}");
        let rows = bytes.chunks(stride).take(count);
        Ok(rows.flat_map(|row| &row[..size]).copied().collect())
    }
}

/// Encoding of the numbers of a type.
struct Number {
    /// Size (bytes).
    size: usize,
    /// Largest number, which stands for 1 in normalized numbers; 0 if the type is never normalized.
    largest: f32,
    read: fn(&[u8]) -> f32,
}

fn number(component_type: u32) -> Result<Number, String> {
    let (size, largest, read): (_, _, fn(&[u8]) -> f32) = match component_type {
        I8 => (1, 127.0, |bytes| f32::from(bytes[0].cast_signed())),
        U8 => (1, 255.0, |bytes| f32::from(bytes[0])),
        I16 => (2, 32767.0, |bytes| {
            f32::from(i16::from_le_bytes([bytes[0], bytes[1]]))
        }),
        U16 => (2, 65535.0, |bytes| {
            f32::from(u16::from_le_bytes([bytes[0], bytes[1]]))
        }),
        F32 => (4, 0.0, |bytes| {
            f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
        }),
        other => {
            return Err(format!(
                "its numbers have the type {other}, which those of points have not"
            ));
        }
    };
    Ok(Number {
        size,
        largest,
        read,
    })
}

/// Returns the size of a whole number of a type (bytes).
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

/// Reads whole numbers of this size (bytes).
fn whole(bytes: &[u8], size: usize) -> Vec<u32> {
    let number = |bytes: &[u8]| bytes.iter().rev().fold(0, |n, b| n << 8 | u32::from(*b));
    bytes.chunks_exact(size).map(number).collect()
}
