//! Tanks of fluids as the edges of the space inside them.

use a3_render::Line;
use a3_scenes::TANK_LAYERS;

use super::colours::STEEL;

/// Returns the edges of the space inside a tank, which is open at the top. `walls` are the places
/// of the particles of its walls, whose layers are `spacing` apart (m).
pub fn edges(walls: &[[f32; 4]], spacing: f32) -> impl Iterator<Item = Line> + use<> {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for point in walls {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    // The walls are as thick as their layers; in two dimensions there are none across z.
    let wall = (TANK_LAYERS as f32 - 0.5) * spacing;
    for axis in 0..3 {
        let flat = high[axis] - low[axis] < wall;
        low[axis] += if flat { -0.5 * spacing } else { wall };
        high[axis] += match axis {
            1 => 0.5 * spacing,
            _ if flat => 0.5 * spacing,
            _ => -wall,
        };
    }
    let corner = move |k: usize| [0, 1, 2].map(|a| if k >> a & 1 == 1 { high[a] } else { low[a] });
    (0..3).flat_map(move |axis| {
        let from = (0..8).filter(move |k| k >> axis & 1 == 0);
        from.map(move |from| Line::new(corner(from), corner(from | 1 << axis), 1.6, STEEL))
    })
}
