//! `a3 chart`: speed against accuracy, measured on the user's own scene.

mod asked;
mod command;
pub mod data;
mod each;
mod files;
mod horizon;
pub mod measure;
pub mod picture;
pub mod record;
pub mod single;
pub mod style;
pub mod table;
pub mod text;
mod value;
mod vision;
mod words;

pub use asked::{check_contact, check_methods, check_metric, check_scene, methods, scope};
pub use command::run;
pub use files::{PICTURES, write_picture};
pub use horizon::{check_motion, look_ahead};
pub use record::Record;
pub use value::{Chart, ChartOptions, chart};
pub use words::{Label, describe, unit};
