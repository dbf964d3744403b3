//! Networks: particles with pins and constraints, and the forces that a scene asks for.

mod attraction;
mod bodies;
mod build;
mod crossings;
mod elements;
mod evaluation;
mod holding;
mod jump;
mod mechanics;
mod outflow;
mod particles;
mod parts;
mod reading;
mod release;
mod rigid;
mod surfaces;
mod tearing;

pub(crate) use attraction::{attract, let_go, mass_behind};
pub use crossings::untangle;
pub use elements::Element;
pub(crate) use evaluation::{
    add_wind, constraint_power, energy_of_errors, has_motors, is_conservative, is_loose,
};
pub(crate) use holding::is_nearly_singular;
pub(crate) use holding::{contradiction, project, project_velocities};
pub(crate) use jump::{Jump, Least, fit, tighten};
pub(crate) use jump::{
    add, has_ropes, is_held, least_tension, open_ends, pass_on, pulls, ropes_of, set_taut, settle,
    slack, slacken, taut, tensions,
};
pub(crate) use outflow::{drained, entered, go_back, outflows, set_drained};
pub use parts::Network;
pub(crate) use release::{
    breaks_between, forget_released, jump_near, next_break, next_known_time, next_release, pass_to,
    quarter_period, release_of,
};
pub use surfaces::Touch;
