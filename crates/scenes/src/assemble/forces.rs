//! Gravity, drag, tearing and wind.

use a3_core::elements::{Air, Region, Wind};
use a3_core::{Network, Vector3};

use super::motion::motion;
use crate::check::{at, at_least, positive};
use crate::description::{Description, RegionSpec, WindSpec};
use crate::fault::Fault;

/// Density of air (kg/m3), drag coefficient and lift coefficient, where they are not given.
const AIR: [(&str, f64); 3] = [("density", 1.2), ("drag", 1.2), ("lift", 0.6)];

/// Sets gravity, drag and the stretch at which springs break, and breaks the springs that are torn.
pub(super) fn set(description: &Description, network: &mut Network) -> Result<(), Fault> {
    if let Some(g) = description.gravity {
        network.set_gravity(Vector3::from(g));
    }
    let drag = match (description.drag, description.drag_per_mass) {
        (Some(_), Some(_)) => return Err(Fault::not_both("drag", "drag_per_mass")),
        (Some(drag), None) => Some(("drag", drag)),
        (None, Some(rate)) => Some(("drag_per_mass", rate * mean_mass(network))),
        (None, None) => None,
    };
    if let Some((key, drag)) = drag {
        at(key, network.set_drag(drag))?;
    }
    at("tear", network.set_tear(description.tear))?;
    at("torn", network.break_springs(&description.torn))
}

/// Creates the wind on the particles or the triangles of a network.
pub(super) fn wind(spec: &WindSpec, network: &Network) -> Result<Wind, Fault> {
    let given = [
        ("force", spec.force),
        ("force_per_mass", spec.force_per_mass),
        ("velocity", spec.velocity),
    ];
    let given: Vec<_> = given
        .into_iter()
        .filter_map(|(key, x)| Some((key, x?)))
        .collect();
    let [(key, mean_wind)] = given[..] else {
        return Err(Fault::new(
            "",
            "give one of the keys `force`, `force_per_mass` and `velocity`",
        ));
    };
    let mean_wind = Vector3::from(mean_wind);
    let coefficients = [spec.density, spec.drag, spec.lift];
    if key != "velocity" {
        for ((key, _), given) in AIR.iter().zip(coefficients) {
            if given.is_some() {
                return Err(Fault::new(
                    *key,
                    "only a wind with a `velocity` has this key",
                ));
            }
        }
        let factor = if key == "force" {
            1.0
        } else {
            mean_mass(network)
        };
        return blown(spec, Wind::new(spec.seed, mean_wind * factor));
    }
    let mut air = AIR.map(|(_, usual)| usual);
    for (((key, _), given), number) in AIR.iter().zip(coefficients).zip(&mut air) {
        *number = given.unwrap_or(*number);
        at(key, at_least(0.0, "it", *number))?;
    }
    let [density, drag, lift] = air;
    let air = at("", Air::new(density, drag, lift))?;
    blown(spec, Wind::on_triangles(spec.seed, mean_wind, air))
}

/// Sets the region of a wind, shifts it in time, and leaves out its gusts if it is steady.
fn blown(spec: &WindSpec, mut wind: Wind) -> Result<Wind, Fault> {
    if let Some(region) = &spec.region {
        let region = self::region(region).map_err(|fault| fault.within("region"))?;
        wind = at("region", wind.within(region))?;
    }
    if spec.steady {
        wind = wind.steady();
    }
    Ok(wind.ahead(spec.ahead))
}

fn region(spec: &RegionSpec) -> Result<Region, Fault> {
    let length = spec.length.unwrap_or(spec.radius);
    at("radius", positive("it", spec.radius))?;
    at("length", positive("it", length))?;
    let (path, turn) = motion(
        spec.sine.as_ref(),
        spec.shift.as_ref(),
        spec.turn.as_ref(),
        Vector3::from(spec.at),
    )?;
    Ok(Region {
        path,
        turn,
        radius: spec.radius,
        length,
    })
}

/// Returns the mean mass (kg) of the particles. Points of rigid bodies have none, and do not count.
fn mean_mass(network: &Network) -> f64 {
    let masses = network.masses().iter().copied().filter(|m| *m > 0.0);
    let masses: Vec<_> = masses.collect();
    // The mean of equal masses is their common value, without rounding.
    if masses.iter().all(|m| *m == masses[0]) {
        masses[0]
    } else {
        masses.iter().sum::<f64>() / masses.len() as f64
    }
}
