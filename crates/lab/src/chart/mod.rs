//! Charts: speed against accuracy, measured on the user's own scene.

pub mod asked;
pub mod measure;
pub mod picture;
pub mod record;
pub mod table;
pub mod value;

pub use asked::{Label, describe, unit};
pub use asked::{check_contact, check_methods, check_metric, check_scene, check_until, methods};
pub use measure::Chart;
pub use record::Record;
pub use value::{ChartOptions, chart};
pub use value::{check_motion, look_ahead};
