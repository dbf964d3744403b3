//! The appearance of all panes: styles, colours by a quantity, and arrows.

use a3_media::show::{Arrows, Quantity, Show};

use super::pane::Pane;

/// Changes how all panes are drawn.
pub fn each(panes: &mut [Pane], change: impl Fn(&mut Show)) {
    for pane in panes {
        change(&mut pane.show);
    }
}

/// Draws all panes in the next style that differs for their scene.
pub fn next_style(panes: &mut [Pane]) {
    let styles = Show::styles(&panes[0].simulation);
    let next = next_after(styles, Some(panes[0].show.style));
    each(panes, |show| show.style = next.unwrap_or_default());
}

/// Returns whether the runs can be coloured by a quantity.
pub fn has_quantity(panes: &[Pane], quantity: Quantity) -> bool {
    quantity.is_in(&panes[0].simulation, panes.len() > 1)
}

/// Colours by the next quantity that the runs have, or by none after the last. Returns a message.
pub fn next_colour(panes: &mut [Pane]) -> String {
    let has = |quantity: &Quantity| has_quantity(panes, *quantity);
    let all: Vec<_> = Quantity::ALL.into_iter().filter(has).collect();
    let next = next_after(&all, panes[0].show.colouring.quantity);
    each(panes, |show| show.colouring.set_quantity(next));
    match next {
        Some(quantity) => format!("Colours show the {}.", quantity.name()),
        None => "Colours are those of the scene.".into(),
    }
}

/// Draws the next kind of arrows that the scene has, or none after the last. Returns a message.
pub fn next_arrows(panes: &mut [Pane]) -> String {
    let run = &panes[0].simulation;
    let has = |arrows: &Arrows| arrows.is_in(run);
    let all: Vec<_> = Arrows::ALL.into_iter().filter(has).collect();
    let next = next_after(&all, panes[0].show.field.arrows);
    each(panes, |show| show.field.set_arrows(next));
    match next {
        Some(arrows) => format!("Arrows show the {}.", arrows.name()),
        None => "Arrows are off.".into(),
    }
}

/// Returns the item after `now`: `None` after the last, and the first after `None` or an unknown
/// one.
fn next_after<T: Copy + PartialEq>(all: &[T], now: Option<T>) -> Option<T> {
    let place = now.and_then(|now| all.iter().position(|one| *one == now));
    all.get(place.map_or(0, |place| place + 1)).copied()
}

#[cfg(test)]
mod tests {
    use a3_render::Style;

    use super::*;
    use crate::session::{RunAction, compared, session};

    #[test]
    fn colours_and_arrows_come_round_as_far_as_the_scene_has_them() {
        let mut cloth = session(&["v", "0.005"]);
        let colours = [0; 5].map(|_| {
            cloth.act(RunAction::Colour, 0);
            cloth.runs.panes[0].show.colouring.quantity
        });
        let [speed, strain, force, contact, _] = Quantity::ALL.map(Some);
        assert_eq!(colours, [speed, strain, force, contact, None]);
        let mut circle = session(&["t", "0.01", "--scene", "simple"]);
        let colours = [0; 2].map(|_| {
            circle.act(RunAction::Colour, 0);
            circle.runs.panes[0].show.colouring.quantity
        });
        assert_eq!(colours, [Some(Quantity::Speed), None]);
        circle.act(RunAction::Arrows, 0);
        assert_eq!(circle.runs.panes[0].show.field.arrows, Some(Arrows::Velocity));
    }

    #[test]
    fn contact_is_there_where_something_touches_and_errors_where_there_is_a_reference() {
        let mut flag = session(&["v", "0.005", "--scene", "mit"]);
        assert!(
            !has_quantity(&flag.runs.panes, Quantity::Contact)
                && !has_quantity(&flag.runs.panes, Quantity::Error)
        );
        flag.act(RunAction::Touch, 0);
        assert!(has_quantity(&flag.runs.panes, Quantity::Contact));
        let mut two = compared(&["e:0.0005", "r:0.01", "--scene", "mit"], 0.0);
        for _ in 0..4 {
            two.act(RunAction::Colour, 0);
        }
        assert_eq!(two.runs.panes[1].show.colouring.quantity, Some(Quantity::Error));
        crate::session::frames(&mut two, 0.3);
        let ends = [0, 1].map(|k| {
            let pane = &mut two.runs.panes[k];
            pane.show.compose(&pane.simulation);
            assert_eq!(pane.show.colouring.shown(), Some(Quantity::Error));
            pane.show.colouring.scale.end()
        });
        // Both panes share a scale that ends at the power of ten above the largest error. That
        // error is at least the root mean square of the worse run, and at most this times the
        // square root of the number of particles.
        let [worse, better] = [0, 1].map(|k| two.runs.panes[k].error.unwrap());
        let most = worse * (two.runs.panes[0].simulation.particles() as f64).sqrt();
        assert!(worse > 100.0 * better);
        assert_eq!(ends[0], ends[1]);
        assert!((worse..10.0 * most).contains(&ends[0]), "{ends:?} {worse}");
        let share = |k: usize| two.runs.panes[k].show.colouring.share(5).unwrap();
        assert!(share(0) > share(1) + 0.2 && share(1) > 0.0);
        two.act(RunAction::Reset, 0);
        let pane = &mut two.runs.panes[0];
        pane.show.compose(&pane.simulation);
        assert_eq!(pane.show.colouring.shown(), None);
    }

    #[test]
    fn surface_wires_and_springs_come_round_as_far_as_they_differ() {
        let styles = |scene: &str| {
            let mut session = session(&["t", "0.001", "--scene", scene]);
            [0; 3].map(|_| {
                session.act(RunAction::Wireframe, 0);
                session.runs.panes[0].show.style
            })
        };
        assert_eq!(styles("mit"), [Style::Wireframe, Style::Springs, Style::Shaded]);
        assert_eq!(styles("drop"), [Style::Wireframe, Style::Shaded, Style::Wireframe]);
    }
}
