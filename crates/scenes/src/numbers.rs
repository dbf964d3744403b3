//! Check of every number of a description, whatever its key: none is beyond the bounds.

use std::fmt::Display;

use serde::ser::{self, Serialize, Serializer};

use crate::check::{BOUNDS, within};
use crate::description::Description;
use crate::fault::Fault;

/// `Ok` if every number of a description is within the bounds.
pub(crate) fn check(description: &Description) -> Result<(), Fault> {
    description.serialize(&mut Walk::default())
}

impl ser::Error for Fault {
    fn custom<T: Display>(why: T) -> Self {
        Self::new("", why)
    }
}

/// A way through all values, with the key of the one that is visited.
#[derive(Default)]
struct Walk {
    key: Vec<String>,
    /// Place in a list of several, which is part of the key if a table is there.
    place: Option<usize>,
}

/// The values of a list or a table.
struct Within<'a> {
    walk: &'a mut Walk,
    /// Number of values, and of those so far.
    count: Option<usize>,
    next: usize,
    /// Length of the key of the list or the table itself.
    depth: usize,
}

impl Walk {
    fn list(&mut self, count: Option<usize>) -> Within<'_> {
        let depth = self.key.len();
        Within {
            walk: self,
            count,
            next: 0,
            depth,
        }
    }

    fn table(&mut self) -> Within<'_> {
        let depth = self.key.len();
        let place = self.place.take();
        self.key.extend(place.map(|k| k.to_string()));
        Within {
            depth,
            ..self.list(None)
        }
    }
}

impl Within<'_> {
    fn item(&mut self, value: &(impl Serialize + ?Sized)) -> Result<(), Fault> {
        self.walk.place = (self.count != Some(1)).then_some(self.next);
        self.next += 1;
        value.serialize(&mut *self.walk)
    }

    fn entry(&mut self, key: &str, value: &(impl Serialize + ?Sized)) -> Result<(), Fault> {
        self.walk.place = None;
        self.walk.key.push(key.into());
        value.serialize(&mut *self.walk)?;
        self.walk.key.pop();
        Ok(())
    }

    fn leave(self) {
        self.walk.key.truncate(self.depth);
    }
}

/// Values that are no numbers, and whole numbers, which have checks of their own.
macro_rules! others {
    ($($name:ident($($kind:ty),*);)*) => {
        $(fn $name(self, $(_: $kind),*) -> Result<(), Fault> {
            Ok(())
        })*
    };
}

impl<'a> Serializer for &'a mut Walk {
    type Ok = ();
    type Error = Fault;
    type SerializeSeq = Within<'a>;
    type SerializeTuple = Within<'a>;
    type SerializeTupleStruct = Within<'a>;
    type SerializeTupleVariant = Within<'a>;
    type SerializeMap = Within<'a>;
    type SerializeStruct = Within<'a>;
    type SerializeStructVariant = Within<'a>;

    others! {
        serialize_bool(bool);
        serialize_i8(i8);
        serialize_i16(i16);
        serialize_i32(i32);
        serialize_i64(i64);
        serialize_u8(u8);
        serialize_u16(u16);
        serialize_u32(u32);
        serialize_u64(u64);
        serialize_char(char);
        serialize_str(&str);
        serialize_bytes(&[u8]);
        serialize_none();
        serialize_unit();
        serialize_unit_struct(&'static str);
        serialize_unit_variant(&'static str, u32, &'static str);
    }

    fn serialize_f32(self, x: f32) -> Result<(), Fault> {
        self.serialize_f64(x.into())
    }

    fn serialize_f64(self, x: f64) -> Result<(), Fault> {
        if within(x) {
            return Ok(());
        }
        Err(Fault::new(
            self.key.join("."),
            format!("{BOUNDS}, not {x:e}"),
        ))
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), Fault> {
        value.serialize(self)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        value: &T,
    ) -> Result<(), Fault> {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        value: &T,
    ) -> Result<(), Fault> {
        value.serialize(self)
    }

    fn serialize_seq(self, count: Option<usize>) -> Result<Within<'a>, Fault> {
        Ok(self.list(count))
    }

    fn serialize_tuple(self, count: usize) -> Result<Within<'a>, Fault> {
        Ok(self.list(Some(count)))
    }

    fn serialize_tuple_struct(self, _: &'static str, n: usize) -> Result<Within<'a>, Fault> {
        Ok(self.list(Some(n)))
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        count: usize,
    ) -> Result<Within<'a>, Fault> {
        Ok(self.list(Some(count)))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Within<'a>, Fault> {
        Ok(self.table())
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Within<'a>, Fault> {
        Ok(self.table())
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Within<'a>, Fault> {
        Ok(self.table())
    }
}

/// The lists of serde, whose items are visited in order, and its tables.
macro_rules! lists {
    ($($name:ident::$item:ident($($key:ident)?);)*) => {
        $(impl ser::$name for Within<'_> {
            type Ok = ();
            type Error = Fault;

            fn $item<T: Serialize + ?Sized>(
                &mut self,
                $($key: &'static str,)?
                value: &T,
            ) -> Result<(), Fault> {
                lists!(@ self, value $(, $key)?)
            }

            fn end(self) -> Result<(), Fault> {
                self.leave();
                Ok(())
            }
        })*
    };
    (@ $self:ident, $value:ident) => { $self.item($value) };
    (@ $self:ident, $value:ident, $key:ident) => { $self.entry($key, $value) };
}

lists! {
    SerializeSeq::serialize_element();
    SerializeTuple::serialize_element();
    SerializeTupleStruct::serialize_field();
    SerializeTupleVariant::serialize_field();
    SerializeStruct::serialize_field(key);
    SerializeStructVariant::serialize_field(key);
}

impl ser::SerializeMap for Within<'_> {
    type Ok = ();
    type Error = Fault;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, _: &T) -> Result<(), Fault> {
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Fault> {
        self.item(value)
    }

    fn end(self) -> Result<(), Fault> {
        self.leave();
        Ok(())
    }
}
