//! `a3 chart`: speed against accuracy, measured on the user's own scene.

mod asked;
mod command;
pub mod data;
mod each;
pub mod measure;
pub mod picture;
pub mod record;
pub mod table;
mod value;
mod words;

pub use asked::{check_contact, check_methods, check_metric, check_scene, methods, scope};
pub use command::run;
pub use command::{PICTURES, write_picture};
pub use record::Record;
pub use value::{Chart, ChartOptions, chart};
pub use value::{check_motion, look_ahead};
pub use words::{Label, describe, unit};
