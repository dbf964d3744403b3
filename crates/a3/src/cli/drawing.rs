//! The options for the look of a picture.

use a3_media::show::{Arrows, Manner, Quantity, style};
use clap::Args;
use clap::builder::TypedValueParser;

use super::values::choice;

/// Creates a parser of the quantity of colours.
fn quantity() -> impl TypedValueParser<Value = Quantity> {
    choice(&Quantity::ALL, |quantity| {
        let help = match quantity {
            Quantity::Speed => "Speed (m/s)",
            Quantity::Strain => "Largest strain of the springs at a particle, or of its tetrahedra",
            Quantity::Force => "Sum of the forces on a particle that is free (N)",
            Quantity::Contact => "Force by which obstacles and surfaces touch a particle (N)",
            Quantity::Error => "Distance from the reference of a comparison (m)",
        };
        (quantity.name(), help)
    })
}

/// Creates a parser of the vector of arrows.
fn arrows() -> impl TypedValueParser<Value = Arrows> {
    choice(&Arrows::ALL, |arrows| {
        let help = match arrows {
            Arrows::Velocity => "Velocity (m/s)",
            Arrows::Force => "Sum of the forces on a particle (N)",
        };
        (arrows.name(), help)
    })
}

/// Options for the look of a picture.
#[expect(clippy::struct_excessive_bools, reason = "each is an option")]
#[derive(Args, Clone, Copy)]
pub struct Drawing {
    /// Draw the wireframe instead of the surface
    #[arg(long, conflicts_with = "springs")]
    pub wireframe: bool,
    /// Draw all springs instead of the surface: structural, shear and bend springs, each in its
    /// own colour and width
    #[arg(long)]
    pub springs: bool,
    /// Draw in parallel projection instead of perspective
    #[arg(long)]
    pub orthographic: bool,
    /// Draw light objects on a dark background, for this run only
    #[arg(long, overrides_with = "light")]
    pub dark: bool,
    /// Draw on a light background, even if the panel of an earlier window chose the dark one
    #[arg(long, overrides_with = "dark")]
    pub light: bool,
    /// Colour each particle by a quantity
    #[arg(long, value_name = "QUANTITY", value_parser = quantity(), alias = "color")]
    pub colour: Option<Quantity>,
    /// Draw an arrow on each particle
    #[arg(long, value_name = "VECTOR", value_parser = arrows())]
    pub arrows: Option<Arrows>,
}

impl Drawing {
    /// Returns the look of a picture, with the springs of a particle highlighted, if one is given.
    pub fn of(self, springs_of: Option<usize>) -> Manner {
        Manner {
            style: style(self.wireframe, self.springs),
            springs_of,
            orthographic: self.orthographic,
            dark: self.dark,
            colour: self.colour,
            arrows: self.arrows,
        }
    }
}
