//! The surface of a fluid: the places at a fixed distance from the weighted mean of the particles
//! around them (Zhu, Bridson, *Animating sand as a fluid*, 2005). So a level surface lies half a
//! spacing beyond its particles, and a single particle is a ball of about its volume. It is meshed
//! by naive surface nets: a vertex in each cell of a grid through which the surface passes, and two
//! triangles across each edge of the grid that it cuts (Gibson, *Constrained elastic surface nets*,
//! 1998).

use a3_core::Simulation;

/// Distance up to which particles count, in spacings.
const REACH: f64 = 2.0;
/// Distance of the surface from the mean of the particles around it, in spacings.
const RADIUS: f32 = 0.6;
/// Least sum of the weights of particles within the surface: less than at the surface of a single
/// particle, and more than halfway between two that are farther apart than 2.2 spacings.
const LEAST_WEIGHT: f32 = 0.7;
/// Mean weight around a vertex below which it is spray.
const SPRAY_WEIGHT: f32 = 1.0;
/// Height of liquid that takes a share of 1 - 1/e from the light, in spacings.
const DEEP: f32 = 12.0;
/// Width of a cell of the grid, in spacings.
const CELL_WIDTH: f64 = 0.55;
/// Largest number of nodes of the grid: it is coarser where drops have flown far apart.
const MAX_NODES: f64 = 3e6;

/// Vertex of the surface of a fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Position (m).
    pub place: [f32; 3],
    /// Value from 0 to 1 that colours the vertex; without one, -2 less its depth: from -1 in spray
    /// through 0 at the surface to 1 deep below it.
    pub value: f32,
    /// Unit normal.
    pub normal: [f32; 3],
}

/// Surface of a fluid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Liquid {
    /// Vertices.
    pub corners: Vec<Corner>,
    /// Corners of each triangle, counterclockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Field on the nodes of a grid.
struct NodeField {
    counts: [usize; 3],
    /// Position of the first node, and the distance of nodes (m).
    origin: [f64; 3],
    cell: f64,
    /// Distance of nodes, in spacings.
    step: f32,
    /// Sum of the weights of the particles around each node, and of their places from there, in
    /// spacings, times their weights.
    sums: Vec<[f32; 4]>,
    /// Depth of each node below the surface, in spacings; negative outside.
    depths: Vec<f32>,
    /// Sum of the weights, each times the value that colours its particle; empty without colours.
    coloured: Vec<f32>,
    /// Height of the liquid above each node, in spacings; 0 outside. Empty with colours.
    heights: Vec<f32>,
}

impl Liquid {
    /// Computes the present surface of the fluid of a run, coloured by the values from 0 to 1 of
    /// its particles, if all have one; empty without a fluid.
    pub fn of(simulation: &Simulation, value: impl Fn(usize) -> Option<f32>) -> Self {
        let network = simulation.model().network();
        let Some((network, fluid)) = network.and_then(|n| Some((n, n.fluid()?))) else {
            return Self::default();
        };
        let free = fluid.particles().iter().map(|i| *i as usize);
        let free = free.filter(|i| !network.is_wall(*i) && !network.is_pinned(*i));
        let is_placed = |i: &usize| simulation.position(*i).iter().all(|x| x.is_finite());
        let free: Vec<_> = free.filter(is_placed).collect();
        let places: Vec<_> = free.iter().map(|i| simulation.position(*i).into()).collect();
        let values: Option<Vec<f32>> = free.into_iter().map(value).collect();
        Self::around(&places, fluid.law().spacing, values.as_deref())
    }

    /// Computes the surface around particles at these places (m), with this spacing (m) and these
    /// values.
    fn around(places: &[[f64; 3]], spacing: f64, values: Option<&[f32]>) -> Self {
        if places.is_empty() {
            return Self::default();
        }
        NodeField::around(places, spacing, values).surface()
    }
}

impl NodeField {
    fn around(places: &[[f64; 3]], spacing: f64, values: Option<&[f32]>) -> Self {
        let (mut low, mut high) = (places[0], places[0]);
        for place in places {
            for axis in 0..3 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
        let nodes = |cell: f64| {
            let reach = REACH / CELL_WIDTH * cell + cell;
            let count = |axis: usize| ((high[axis] - low[axis] + 2.0 * reach) / cell).ceil() + 1.0;
            [0, 1, 2].map(count)
        };
        let mut cell = CELL_WIDTH * spacing;
        while nodes(cell).iter().product::<f64>() > MAX_NODES {
            cell *= 1.1;
        }
        let counts = nodes(cell).map(|count| count as usize);
        let radius = REACH / CELL_WIDTH * cell;
        let mut field = Self {
            counts,
            origin: low.map(|low| low - radius - cell),
            cell,
            step: (cell / spacing) as f32,
            sums: vec![[0.0; 4]; counts.iter().product()],
            depths: vec![],
            coloured: vec![0.0; values.map_or(0, |_| counts.iter().product())],
            heights: vec![],
        };
        for (k, place) in places.iter().enumerate() {
            field.add(place, radius, values.map_or(0.0, |values| values[k]));
        }
        field.depths = field.sums.iter().map(depth).collect();
        if values.is_none() {
            field.find_heights();
        }
        field
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.counts[1] + j) * self.counts[0] + i
    }

    /// Adds a particle with its weight (1 - r^2 / reach^2)^3 and the value that colours it.
    fn add(&mut self, place: &[f64; 3], radius: f64, value: f32) {
        let at: [f64; 3] = std::array::from_fn(|a| (place[a] - self.origin[a]) / self.cell);
        let reach = radius / self.cell;
        let range = |axis: usize| {
            let last = self.counts[axis] - 1;
            let [low, high] = [at[axis] - reach, at[axis] + reach];
            low.ceil().max(0.0) as usize..=(high.floor().max(0.0) as usize).min(last)
        };
        let [x, y, z] = [0, 1, 2].map(range);
        for k in z {
            for j in y.clone() {
                for i in x.clone() {
                    let d = [i as f64 - at[0], j as f64 - at[1], k as f64 - at[2]];
                    let square = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / (reach * reach);
                    let node = self.index([i, j, k]);
                    let weight = (1.0 - square).max(0.0).powi(3) as f32;
                    let [x, y, z] = d.map(|d| (d * CELL_WIDTH) as f32);
                    let parts = [1.0, x, y, z].map(|part| weight * part);
                    for (sum, part) in self.sums[node].iter_mut().zip(parts) {
                        *sum += part;
                    }
                    if let Some(sum) = self.coloured.get_mut(node) {
                        *sum += weight * value;
                    }
                }
            }
        }
    }

    /// Returns the vertex in a cell: the mean of the points at which the surface cuts its edges,
    /// with the direction in which the field falls; `None` if the surface does not pass through the
    /// cell.
    fn vertex(&self, cell: [usize; 3]) -> Option<Corner> {
        let nodes: [usize; 8] = std::array::from_fn(|corner| {
            self.index([0, 1, 2].map(|axis| cell[axis] + (corner >> axis & 1)))
        });
        let values = nodes.map(|node| self.depths[node]);
        let inside = values.iter().filter(|value| **value > 0.0).count();
        if inside == 0 || inside == 8 {
            return None;
        }
        let (mut sum, mut normal, mut cuts) = ([0.0_f32; 3], [0.0_f32; 3], 0.0);
        for axis in 0..3 {
            for from in (0..8).filter(|corner| corner >> axis & 1 == 0) {
                let [a, b] = [values[from], values[from | 1 << axis]];
                normal[axis] += a - b;
                if (a > 0.0) != (b > 0.0) {
                    for (other, sum) in sum.iter_mut().enumerate() {
                        *sum +=
                            if other == axis { a / (a - b) } else { (from >> other & 1) as f32 };
                    }
                    cuts += 1.0;
                }
            }
        }
        let length = normal.iter().map(|n| n * n).sum::<f32>().sqrt().max(1e-20);
        let place = std::array::from_fn(|axis| {
            let share = cell[axis] as f64 + f64::from(sum[axis] / cuts);
            (self.origin[axis] + self.cell * share) as f32
        });
        Some(Corner { place, value: self.colour(nodes), normal: normal.map(|n| n / length) })
    }

    /// Finds the heights of the liquid above the nodes, from above down. Each is the mean over the
    /// node above and its neighbours, so that a drop above casts no sharp shadow.
    fn find_heights(&mut self) {
        let [x, y, z] = self.counts;
        self.heights = vec![0.0; self.sums.len()];
        for j in (0..y - 1).rev() {
            for k in 0..z {
                for i in 0..x {
                    let node = self.index([i, j, k]);
                    if self.depths[node] > 0.0 {
                        let sides = [
                            [i.saturating_sub(1), k],
                            [i + 1, k],
                            [i, k.saturating_sub(1)],
                            [i, k + 1],
                        ];
                        let above = [[i, k]].into_iter().chain(sides);
                        let above = above.filter(|[i, k]| *i < x && *k < z);
                        let above = above.map(|[i, k]| self.index([i, j + 1, k]));
                        let wet = above.filter(|node| self.depths[*node] > 0.0);
                        let (sum, count) = wet.fold((0.0, 0.0_f32), |(sum, count), node| {
                            (sum + self.heights[node], count + 1.0)
                        });
                        self.heights[node] = sum / count.max(1.0) + self.step;
                    }
                }
            }
        }
    }

    /// Returns the mean of the values around some nodes, weighted as they are; without colours, -2
    /// less the depth.
    fn colour(&self, nodes: [usize; 8]) -> f32 {
        let weights: f32 = nodes.iter().map(|node| self.sums[*node][0]).sum();
        if self.coloured.is_empty() {
            let height = nodes.iter().map(|node| self.heights[*node]).fold(0.0, f32::max);
            let spray = (SPRAY_WEIGHT - weights / 8.0).clamp(0.0, 0.5) / 0.5;
            return -2.0 - (1.0 - (-height / DEEP).exp() - spray);
        }
        let coloured: f32 = nodes.iter().map(|node| self.coloured[*node]).sum();
        coloured / weights
    }

    fn surface(&self) -> Liquid {
        let mut liquid = Liquid::default();
        // Number of the vertex of each cell.
        let mut vertices = vec![u32::MAX; self.sums.len()];
        let [x, y, z] = self.counts.map(|count| 0..count - 1);
        for k in z.clone() {
            for j in y.clone() {
                for i in x.clone() {
                    if let Some(vertex) = self.vertex([i, j, k]) {
                        vertices[self.index([i, j, k])] = liquid.corners.len() as u32;
                        liquid.corners.push(vertex);
                    }
                }
            }
        }
        for k in z.skip(1) {
            for j in y.clone().skip(1) {
                for i in x.clone().skip(1) {
                    let node = [i, j, k];
                    for axis in 0..3 {
                        let mut next = node;
                        next[axis] += 1;
                        let [a, b] = [node, next].map(|n| self.depths[self.index(n)] > 0.0);
                        if a == b {
                            continue;
                        }
                        // The four cells around the edge, anticlockwise as seen against the axis.
                        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                        let around = [[1, 1], [0, 1], [0, 0], [1, 0]].map(|[du, dv]| {
                            let mut cell = node;
                            (cell[u], cell[v]) = (cell[u] - du, cell[v] - dv);
                            vertices[self.index(cell)]
                        });
                        let [p, q, r, s] = around;
                        liquid.triangles.extend(if a {
                            [[p, q, r], [p, r, s]]
                        } else {
                            [[p, r, q], [p, s, r]]
                        });
                    }
                }
            }
        }
        liquid
    }
}

/// Returns the depth of a node below the surface, in spacings, by the sums there; negative outside.
fn depth([weight, x, y, z]: &[f32; 4]) -> f32 {
    let distance = (x * x + y * y + z * z).sqrt() / weight.max(f32::MIN_POSITIVE);
    (RADIUS - distance).min(weight - LEAST_WEIGHT)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Particles of a ball on a lattice.
    fn ball(radius: f64, spacing: f64) -> Vec<[f64; 3]> {
        let range = || -20..=20_i32;
        let mut places = vec![];
        for x in range() {
            for y in range() {
                for z in range() {
                    let place = [x, y, z].map(|x| spacing * f64::from(x));
                    if place.iter().map(|x| x * x).sum::<f64>() <= radius * radius {
                        places.push(place);
                    }
                }
            }
        }
        places
    }

    /// The surface of a ball is closed, as round as its particles allow, and oriented outwards. It
    /// encloses the cells of the particles.
    #[test]
    fn the_surface_of_a_ball_is_a_sphere() {
        let spacing = 0.1;
        let places = ball(1.0, spacing);
        let liquid = Liquid::around(&places, spacing, None);
        let mut edges: Vec<_> =
            liquid.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.sort_unstable();
        assert!(edges.len() > 3000);
        for [a, b] in &edges {
            assert!(edges.binary_search(&[*b, *a]).is_ok(), "an open edge");
        }
        for Corner { place, value, normal } in &liquid.corners {
            assert!(*value < 0.0, "{value}");
            let radius = place.iter().map(|x| x * x).sum::<f32>().sqrt();
            assert!((0.9..1.08).contains(&radius), "{radius}");
            let along: f32 = place.iter().zip(normal).map(|(x, n)| x * n / radius).sum();
            // Particles show through as bumps.
            assert!(along > 0.65, "{along}");
        }
        let volume: f64 = liquid
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| liquid.corners[i as usize].place.map(f64::from));
                let cross = [0, 1, 2]
                    .map(|k| b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3]);
                (0..3).map(|k| a[k] * cross[k]).sum::<f64>() / 6.0
            })
            .sum();
        let cells = places.len() as f64 * spacing.powi(3);
        assert!((volume / cells - 1.0).abs() < 0.05, "{volume} of {cells}");
    }

    #[test]
    fn drops_that_flew_far_apart_have_a_surface_too() {
        let places = [[0.0; 3], [1e6, 2e6, -3e6], [1e6, 2e6, -3e6]];
        let liquid = Liquid::around(&places, 0.01, None);
        assert!(liquid.triangles.len() >= 16);
        let mut corners = liquid.corners.iter();
        assert!(corners.all(|corner| {
            let mut numbers = corner.place.iter().chain(&corner.normal);
            numbers.all(|x| x.is_finite())
        }));
        assert_eq!(Liquid::around(&[], 1.0, None), Liquid::default());
    }

    /// Below the surface of a ball its liquid grows deeper, and a lone drop is spray.
    #[test]
    fn the_surface_has_the_depth_of_the_liquid_above_it() {
        let mut places = ball(1.0, 0.1);
        places.push([0.0, 2.0, 0.0]);
        let liquid = Liquid::around(&places, 0.1, None);
        let depth = |range: std::ops::Range<f32>| {
            let corners = liquid.corners.iter();
            let within = corners.filter(|corner| range.contains(&corner.place[1]));
            let depths: Vec<_> = within.map(|corner| -2.0 - corner.value).collect();
            depths.iter().sum::<f32>() / depths.len() as f32
        };
        let [top, middle, bottom] = [0.9..1.2, -0.2..0.2, -1.2..-0.9].map(depth);
        assert!(-0.05 < top && top + 0.1 < middle, "{top} {middle}");
        // Twenty spacings of twelve that take a share of 1 - 1/e.
        let exact = 1.0 - (-20.0_f32 / 12.0).exp();
        assert!((bottom - exact).abs() < 0.05, "{bottom} {exact}");
        assert!(depth(1.5..2.5) < -0.5);
    }

    /// Values that grow along x are those of the vertices, near the ends too.
    #[test]
    fn the_surface_has_the_values_of_the_particles_below_it() {
        let places = ball(1.0, 0.1);
        let values: Vec<_> = places.iter().map(|x| (0.5 + 0.4 * x[0]) as f32).collect();
        let liquid = Liquid::around(&places, 0.1, Some(&values));
        for corner in &liquid.corners {
            let exact = 0.5 + 0.4 * corner.place[0];
            assert!((corner.value - exact).abs() < 0.06, "{} {exact}", corner.value);
        }
    }
}
