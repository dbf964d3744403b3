//! Networks: particles with pins and constraints, and the forces that a scene asks for.

mod air;
mod attraction;
mod bodies;
mod breaking;
mod build;
mod contact_layer;
mod crossings;
mod element;
mod elements;
mod energies;
mod evaluation;
mod held;
mod holding;
mod jump;
mod loads;
mod matrix;
mod mechanics;
mod outflow;
mod particles;
mod parts;
mod project;
mod reading;
mod release;
mod rigid;
mod ropes;
mod springs;
mod strain;
mod surfaces;
mod sweep;
mod tearing;

pub(crate) use attraction::{attract, let_go, mass_behind};
pub use crossings::untangle;
pub use element::Element;
pub(crate) use energies::{add_wind, energy_of_errors, has_motors, is_conservative};
pub(crate) use holding::is_nearly_singular;
pub(crate) use jump::{Jump, Least, fit, tighten};
pub(crate) use outflow::{drained, entered, go_back, outflows, set_drained};
pub use parts::Network;
pub(crate) use project::{contradiction, has_joints, project, project_velocities};
pub(crate) use release::{
    breaks_between, forget_released, jump_near, next_break, next_known_time, next_release, pass_to,
    quarter_period, release_of,
};
pub(crate) use ropes::{
    has_ropes, least_tension, open_ends, ropes_of, set_taut, settle, slack, taut,
};
pub use surfaces::Touch;
