//! Colours of pictures, as linear red, green, blue and opacity.

pub const INK: [f32; 4] = [0.035, 0.05, 0.09, 1.0];
pub const STEEL: [f32; 4] = [0.30, 0.36, 0.44, 1.0];
pub const RED: [f32; 4] = [0.62, 0.045, 0.06, 1.0];
pub const AMBER: [f32; 4] = [0.95, 0.42, 0.02, 1.0];
pub const TEAL: [f32; 4] = [0.0, 0.33, 0.36, 1.0];
pub const ALARM: [f32; 4] = [0.75, 0.02, 0.02, 1.0];
pub const BLUE: [f32; 4] = [0.02, 0.24, 0.46, 1.0];
pub const VIOLET: [f32; 4] = [0.30, 0.10, 0.55, 1.0];
/// Colours of rigid bodies, one after another.
pub const BODIES: [[f32; 4]; 4] = [
    [0.48, 0.24, 0.09, 1.0],
    [0.05, 0.30, 0.33, 1.0],
    [0.62, 0.33, 0.06, 1.0],
    [0.25, 0.13, 0.38, 1.0],
];
