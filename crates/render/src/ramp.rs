//! The colours of values: from dark blue through green to yellow, with increasing brightness, so
//! that they can also be distinguished without red and green (viridis, of matplotlib).

/// Colours at equal distances, as linear red, green and blue. The shader has the same list.
pub(crate) const RAMP: [[f32; 3]; 8] = [
    [0.058, 0.0, 0.089],
    [0.061, 0.032, 0.209],
    [0.037, 0.107, 0.266],
    [0.02, 0.212, 0.27],
    [0.014, 0.356, 0.242],
    [0.068, 0.533, 0.153],
    [0.352, 0.701, 0.041],
    [0.982, 0.799, 0.019],
];

/// Returns the colour of a value from 0 to 1, as linear red, green and blue, then 1. Values beyond
/// the ends have the colours of the ends.
///
/// ```
/// let [low, high] = [0.0, 1.0].map(a3_render::ramp);
/// assert!(low != high && low[3] == 1.0);
/// ```
#[must_use]
pub fn ramp(value: f32) -> [f32; 4] {
    let last = RAMP.len() - 1;
    let at = value.clamp(0.0, 1.0) * last as f32;
    let below = (at as usize).min(last - 1);
    let share = at - below as f32;
    let [from, to] = [RAMP[below], RAMP[below + 1]];
    let mixed = |k: usize| from[k] + share * (to[k] - from[k]);
    [mixed(0), mixed(1), mixed(2), 1.0]
}

/// Returns the fourth number of a point whose surface is coloured by a value from 0 to 1, instead
/// of the number of a look.
#[must_use]
pub fn shaded_by(value: f32) -> f32 {
    -1.0 - value.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipelines::SOURCE;

    #[test]
    fn the_shader_has_the_same_colours() {
        let stops = RAMP.map(|[r, g, b]| format!("vec3({r:?}, {g:?}, {b:?})"));
        let mut rest = SOURCE;
        for stop in &stops {
            let (_, after) = rest.split_once(stop).unwrap_or_else(|| panic!("{stop}"));
            rest = after;
        }
    }

    #[test]
    fn values_have_colours_between_the_stops_ever_brighter() {
        assert_eq!(ramp(0.0)[..3], RAMP[0]);
        assert_eq!(ramp(7.0)[..3], RAMP[RAMP.len() - 1]);
        assert_eq!(ramp(-1.0), ramp(0.0));
        let bright = |k: i32| {
            let [r, g, b, _] = ramp(k as f32 / 100.0);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!((0..100).all(|k| bright(k) < bright(k + 1)));
        assert_eq!([shaded_by(0.25), shaded_by(9.0)], [-1.25, -2.0]);
    }
}
