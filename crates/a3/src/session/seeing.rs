//! What is seen of the runs: colours by a quantity, and arrows.

use super::state::Session;
use crate::show::{Arrows, Quantity};

impl Session {
    /// Colours by the next quantity that the scene has, and after the last by none.
    pub(super) fn next_colour(&mut self) {
        let run = self.first();
        let has = |quantity: &Quantity| !quantity.values(run).is_empty();
        let all: Vec<_> = Quantity::ALL.into_iter().filter(has).collect();
        let next = after(&all, self.panes[0].show.colouring.quantity);
        self.set_colour(next);
        self.say(match next {
            Some(quantity) => format!("colours show the {}", quantity.name()),
            None => "colours of the scene".into(),
        });
    }

    /// Draws the next arrows that the scene has, and after the last none.
    pub(super) fn next_arrows(&mut self) {
        let run = self.first();
        let has = |arrows: &Arrows| !arrows.vectors(run).is_empty();
        let all: Vec<_> = Arrows::ALL.into_iter().filter(has).collect();
        let next = after(&all, self.panes[0].show.field.arrows);
        self.set_arrows(next);
        self.say(match next {
            Some(arrows) => format!("arrows show the {}", arrows.name()),
            None => "no arrows".into(),
        });
    }

    /// Colours all panes by a quantity, or by none.
    pub fn set_colour(&mut self, quantity: Option<Quantity>) {
        for pane in &mut self.panes {
            pane.show.colouring.set_quantity(quantity);
        }
    }

    /// Draws arrows in all panes, or none.
    pub fn set_arrows(&mut self, arrows: Option<Arrows>) {
        for pane in &mut self.panes {
            pane.show.field.set_arrows(arrows);
        }
    }

    /// Fixes the end of the scale of colours in all panes, or lets it follow the values.
    pub fn fix_scale(&mut self, end: Option<f64>) {
        for pane in &mut self.panes {
            pane.show.colouring.scale.fixed = end;
        }
    }
}

/// The one after this one; none after the last, and the first after none.
fn after<T: Copy + PartialEq>(all: &[T], now: Option<T>) -> Option<T> {
    let place = now.and_then(|now| all.iter().position(|one| *one == now));
    all.get(place.map_or(0, |place| place + 1)).copied()
}
