//! Cloths, rectangular ones and those from files of triangles.

use a3_core::elements::{Gas, GasLaw, Sheet};
use a3_core::{Grid, SpringKind, SpringLaw, Vector3};

use super::assembly::{Assembly, Body, Files, SkinSpec, placed};
use super::motion::extreme;
use super::springs::{damping_time, strip};
use crate::budget::{SPRINGS, STRIPS, TRIANGLES};
use crate::description::{Cloth, MeshCloth, Spot};
use crate::fault::{Fault, at, at_least, positive, positive_one};

impl Cloth {
    fn checked_grid(&self) -> Result<Grid, Fault> {
        let [rows, cols] = self.grid;
        at("grid", Grid::new(rows, cols))
    }

    /// Returns the distance between neighbouring particles (m).
    pub(crate) fn checked_spacing(&self) -> Result<f64, Fault> {
        let (by_width, size) = positive_one(("width", self.width), ("spacing", self.spacing))?;
        let cells = self.grid[1].max(2) - 1;
        Ok(if by_width { size / cells as f64 } else { size })
    }

    /// Returns the mass of each particle (kg): an equal share of the density times the area.
    pub(crate) fn checked_mass(&self) -> Result<f64, Fault> {
        let (grid, spacing) = (self.checked_grid()?, self.checked_spacing()?);
        let (by_area, mass) = positive_one(("density", self.density), ("mass", self.mass))?;
        let cells = (grid.rows() - 1) * (grid.cols() - 1);
        let share = spacing * spacing * (cells as f64 / grid.particles() as f64);
        Ok(if by_area { mass * share } else { mass })
    }

    /// Returns the unit vector along the direction that a key gives.
    fn axis(&self, key: &str) -> Result<Vector3<f64>, Fault> {
        let (given, usual) = match key {
            "right" => (self.right, Vector3::x()),
            _ => (self.down, -Vector3::y()),
        };
        let axis = given.map_or(usual, Vector3::from);
        let axis = axis.try_normalize(1e-9).filter(|axis| axis.iter().all(|x| x.is_finite()));
        axis.ok_or_else(|| Fault::new(key, "it must be a direction, such as [1, 0, 0]"))
    }
}

impl Body for Cloth {
    fn add_to(&self, assembly: &mut Assembly, files: &mut Files) -> Result<(), Fault> {
        let grid = self.checked_grid()?;
        let particles = grid.particles();
        let strips = 2 * particles * usize::from(self.buckling.is_some());
        files.spend(particles, &[(strips, STRIPS)])?;
        let (rows, cols, spacing) = (grid.rows(), grid.cols(), self.checked_spacing()?);
        let mass = self.checked_mass()?;
        let [structural, shear, bend] = self.stiffness;
        let time = damping_time(self.damping, self.damping_ratio, mass, structural)?;
        let first = assembly.masses.len();
        let mut sheet = at("stiffness", Sheet::new(grid, spacing, self.stiffness, time))?;
        if let Some(law) = &self.buckling {
            let ends = sheet.springs().filter(|s| s.kind == SpringKind::Bend);
            let ends = ends.map(|s| [s.i, s.j].map(|i| first + i));
            let tension = [bend, bend * time];
            let strips = ends.map(|ends| strip(law, ends, 2.0 * spacing, tension));
            assembly.strips.extend(strips);
            let others = Sheet::new(grid, spacing, [structural, shear, 0.0], time);
            sheet = at("stiffness", others)?;
        }
        let (right, down) = (self.axis("right")?, self.axis("down")?);
        if right.dot(&down).abs() > 1e-6 {
            let key = if self.down.is_some() { "down" } else { "right" };
            return Err(Fault::new(key, "`right` and `down` must be perpendicular"));
        }
        let height = down * (spacing * (rows - 1) as f64);
        let top = match (self.at, self.foot) {
            (Some(_), Some(_)) => return Err(Fault::not_both("at", "foot")),
            (_, Some(_)) => Vector3::from(self.foot.unwrap_or_default()) - height,
            _ => Vector3::from(self.at.unwrap_or_default()),
        };
        for (key, number) in [("folds", self.folds), ("turn", self.turn)] {
            at(key, at_least(0.0, "it", number))?;
        }
        let row = gathered(cols, spacing, self.folds, self.turn);
        let middle = 0.5 * row[cols - 1][0];
        let out = down.cross(&right);
        let velocity = Vector3::from(self.velocity.unwrap_or_default());
        let sway = Vector3::from(self.sway.unwrap_or_default());
        for i in 0..rows {
            let share = i as f64 / (rows - 1) as f64;
            for [along, outwards] in &row {
                let in_row = top + right * (along - middle) + out * *outwards;
                assembly.positions.push(in_row + down * (i as f64 * spacing));
                assembly.velocities.push(velocity + sway * share);
            }
        }
        let skin = SkinSpec::of(self, assembly.gravity, [structural, time]);
        let masses = vec![mass; particles];
        assembly.skins.extend(skin.uniform(&masses, spacing)?);
        assembly.masses.extend(masses);
        assembly.add_surface(first, grid.triangles().map(|t| t.map(|i| i as u32)));
        assembly.sheets.push(sheet.starting_at(first));
        assembly.strain_limit = self.strain_limit;
        Ok(())
    }

    fn spot(&self, spot: Spot, _: &[Vector3<f64>]) -> Option<Vec<usize>> {
        let [rows, cols] = self.grid;
        let last = (rows - 1) * cols;
        Some(match spot {
            Spot::Top => (0..cols).collect(),
            Spot::Bottom => (last..rows * cols).collect(),
            Spot::Left => (0..rows).map(|i| i * cols).collect(),
            Spot::Right => (0..rows).map(|i| i * cols + cols - 1).collect(),
            Spot::TopLeft => vec![0],
            Spot::TopRight => vec![cols - 1],
            Spot::BottomLeft => vec![last],
            Spot::BottomRight => vec![rows * cols - 1],
            Spot::First | Spot::Last => return None,
        })
    }
}

/// Places a row of particles on a sine-generated curve: the offset of each along the row and across
/// it (m).
///
/// The direction of the curve oscillates, and its length is that of the straight row, so that no
/// spring is stretched.
fn gathered(cols: usize, spacing: f64, folds: f64, turn: f64) -> Vec<[f64; 2]> {
    let steps = (0..cols).map(|j| {
        let s = (j as f64 + 0.5) / (cols - 1) as f64;
        let angle = turn * libm::cos(std::f64::consts::TAU * folds * s);
        [libm::cos(angle) * spacing, libm::sin(angle) * spacing]
    });
    let mut here = [0.0, 0.0];
    let places = steps.map(|[along, out]| {
        let next = [here[0] + along, here[1] + out];
        std::mem::replace(&mut here, next)
    });
    places.collect()
}

/// Returns the volume (m3) that triangles between these positions (m) enclose; it is negative if
/// they are clockwise from outside.
fn volume(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    let of_one = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| Vector3::from(positions[i as usize]));
        a.dot(&b.cross(&c)) / 6.0
    };
    triangles.iter().map(of_one).sum()
}

impl Body for MeshCloth {
    fn add_to(&self, assembly: &mut Assembly, files: &mut Files) -> Result<(), Fault> {
        let mesh = files.read(&self.file)?;
        files.budget.spend("", mesh.triangles.len(), TRIANGLES)?;
        let mesh = mesh.welded();
        refuse!(if mesh.triangles.is_empty() => "file": "the mesh has no triangles");
        files.spend(mesh.positions.len(), &[(3 * mesh.triangles.len(), SPRINGS)])?;
        let scale = self.scale.unwrap_or(1.0);
        at("scale", positive("it", scale))?;
        at("density", positive("it", self.density))?;
        let scaled = mesh.scaled(scale);
        let areas = scaled.areas();
        let masses: Vec<_> = areas.iter().map(|area| area * self.density).collect();
        if let Some(bad) = masses.iter().position(|m| !m.is_finite() || *m <= 0.0) {
            let (number, [x, y, z]) = (mesh.number(bad), mesh.positions[bad]);
            let point = format!("point {number} at ({x}, {y}, {z})");
            refuse!("file": "the triangles around {point} have no area");
        }
        let mean = masses.iter().sum::<f64>() / masses.len() as f64;
        let structural = self.stiffness[0];
        let time = damping_time(self.damping, self.damping_ratio, mean, structural)?;
        let law = |kind, length| {
            let k = self.stiffness[usize::from(kind == SpringKind::Bend)];
            SpringLaw::new(k, length, k * time)
        };
        let springs = at("stiffness", scaled.springs(law))?;
        let points = scaled.positions.iter().map(|p| Vector3::from(*p));
        let places = points.map(placed(self.at.unwrap_or_default(), self.rotation));
        let first = assembly.add_particles(&masses, places, self.velocity);
        let law = match (self.pressure, self.fill) {
            (Some(_), Some(_)) => return Err(Fault::not_both("pressure", "fill")),
            (Some(pressure), None) => Some(("pressure", GasLaw::Pressure(pressure))),
            (None, Some(fill)) => {
                at("fill", positive("it", fill))?;
                let volume = volume(&scaled.positions, &mesh.triangles).abs();
                at("fill", positive("the volume of the mesh", volume))?;
                Some(("fill", GasLaw::Amount(fill * volume)))
            }
            (None, None) => None,
        };
        if let Some((key, law)) = law {
            let mut triangles = mesh.triangles.clone();
            if volume(&scaled.positions, &triangles) < 0.0 {
                for t in &mut triangles {
                    t.swap(1, 2);
                }
            }
            for i in triangles.iter_mut().flatten() {
                *i += first as u32;
            }
            assembly.gases.push(at(key, Gas::new(law, triangles))?);
        }
        let skin = SkinSpec::of(self, assembly.gravity, [structural, time]);
        let skins = skin.fitted(&masses, &scaled.heights())?;
        assembly.skins.extend(skins);
        assembly.add_surface(first, mesh.triangles.iter().copied());
        assembly.add_springs(first, springs, self.tension_only);
        assembly.strain_limit = self.strain_limit;
        Ok(())
    }

    fn spot(&self, spot: Spot, positions: &[Vector3<f64>]) -> Option<Vec<usize>> {
        match spot {
            Spot::Top | Spot::Bottom => extreme(spot, positions),
            _ => None,
        }
    }
}
