//! The table of knobs: everything that can be tuned during a run, by mouse or keys.

use a3_core::contact::Shape;
use a3_core::{Network, Vector3};
use a3_files::ending::Ending;
use a3_media::show::{Arrows, Quantity, Show};
use a3_scenes::PartChange;

use super::values::{arrows, colour, film, film_seconds, frame_limit, full_colour, style};
use super::values::{
    damping, drag, floor, gravity, gusts, material, network, own, radii, solver, sphere,
    springs_of, step, stiffness, strain_limit, strain_limits, switch,
};
use crate::session::{Change, Dial, DialScale, RunAction, Session, Tuning, Turn, looks};

/// A knob: a row of the table.
#[derive(Clone, Copy)]
pub struct Knob {
    /// Name of the row.
    pub name: &'static str,
    /// Description for the tooltip, with the unit.
    pub about: &'static str,
    /// Whether the row starts a group.
    pub starts_group: bool,
    /// Whether the knob tunes the scene, so that a checkpoint must store its value separately.
    pub tunes_scene: bool,
    /// Returns the dial for a session and a pane, if the knob applies to them.
    pub read: fn(&Session, usize) -> Option<Dial>,
    /// Sets the value in a session and a pane.
    pub(super) set: fn(&mut Session, usize, f64),
}

/// Creates a knob that starts no group and does not tune the scene.
const fn knob(
    name: &'static str,
    about: &'static str,
    read: fn(&Session, usize) -> Option<Dial>,
    set: fn(&mut Session, usize, f64),
) -> Knob {
    Knob { name, about, starts_group: false, tunes_scene: false, read, set }
}

/// Makes a knob start a group.
const fn starts_group(knob: Knob) -> Knob {
    Knob { starts_group: true, ..knob }
}

/// Marks a knob as one that tunes the scene.
const fn tunes_scene(knob: Knob) -> Knob {
    Knob { tunes_scene: true, ..knob }
}

/// All knobs, from top to bottom.
pub static KNOBS: &[Knob] = &[
    knob("solver", "The integrator.", solver, |session, at, i| {
        session.act(RunAction::Solver(i as usize), at);
    }),
    knob(
        "step",
        "The step in seconds, or the relative tolerance of an adaptive solver.",
        step,
        |session, at, value| {
            session.set_step_of(at, value);
        },
    ),
    starts_group(knob(
        "material",
        "What cloths, or solids and bodies, are made of: their density, stiffness and damping.",
        material,
        |session, _, k| session.panel.material = Some(k as usize),
    )),
    tunes_scene(knob(
        "stiffness",
        "Stiffness of all springs and, in a liquid, square of the speed of sound, as a multiple of the scene's own.",
        stiffness,
        |session, _, factor| {
            session.tuning.stiffness = factor;
            set_springs(session);
        },
    )),
    tunes_scene(knob(
        "damping",
        "Damping of all springs, and viscosity of a liquid, as a multiple of the scene's own.",
        damping,
        |session, _, factor| {
            session.tuning.damping = factor;
            set_springs(session);
        },
    )),
    tunes_scene(knob(
        "strain limit",
        "Largest length of a spring over its rest length. Longer ones are shortened after each step.",
        strain_limit,
        |session, _, value| {
            let limits: Vec<_> = own(session).into_iter().flat_map(strain_limits).collect();
            let Some(&(_, first)) = limits.first() else {
                return;
            };
            session.adjust(|network| {
                for (particles, own) in &limits {
                    // Scale all limits above 1 in proportion to that of the first body.
                    let limit = match (first, own) {
                        (Some(first), Some(own)) => {
                            1.0 + (own - 1.0) * (value - 1.0) / (first - 1.0)
                        }
                        _ => value,
                    };
                    let limit = (value > 1.0).then_some(limit);
                    // The value is within its scale, so this does not fail.
                    let _ = network.set_strain_limit(particles.clone(), limit);
                }
            });
        },
    )),
    tunes_scene(knob(
        "drag",
        "Air drag on each particle over its velocity, in kg/s.",
        drag,
        |session, _, drag| {
            session.adjust(|network| {
                // The value is within its scale, so this does not fail.
                let _ = network.set_drag(drag);
            });
        },
    )),
    tunes_scene(knob("gravity", "Downward acceleration, in m/s².", gravity, |session, _, g| {
        session.adjust(|network| {
            let sideways = network.gravity().unwrap_or_default();
            network.set_gravity(Vector3::new(sideways.x, -g, sideways.z));
        });
    })),
    starts_group(knob(
        "wind",
        "Whether the wind blows.",
        |session, _| {
            session.runs.first().scene().wind?;
            Some(switch(session.runs.first().windy(), false))
        },
        |session, at, _| {
            session.act(RunAction::Wind, at);
        },
    )),
    tunes_scene(knob(
        "gusts",
        "Force or velocity of the wind, as a multiple of the scene's own.",
        gusts,
        |session, _, factor| {
            session.tuning.gusts = factor;
            if let Some(wind) = session.tuning.own.wind {
                session.runs.change_all(|run| run.change_wind(wind.scaled(factor)));
            }
        },
    )),
    knob(
        "swing",
        "Whether the pins swing.",
        |session, _| {
            session.runs.first().scene().swing?;
            Some(switch(session.runs.first().swinging(), false))
        },
        |session, at, _| {
            session.act(RunAction::Swing, at);
        },
    ),
    knob(
        "pins",
        "Whether the scene's pins hold.",
        |session, _| {
            own(session)?.pins().next()?;
            Some(switch(session.runs.first().pinned(), true))
        },
        |session, _, on| session.runs.change_all(|run| run.set_pinned(on != 0.0)),
    ),
    knob(
        "self-collision",
        "Whether surfaces touch one another and themselves, or pass through.",
        |session, _| {
            session.runs.first().scene().touch.as_ref()?;
            let own = own(session).and_then(Network::touch);
            let own = own.is_some_and(|touch| touch.bodies);
            Some(switch(session.runs.first().touching(), own))
        },
        |session, at, _| {
            session.act(RunAction::Touch, at);
        },
    ),
    tunes_scene(knob(
        "sphere",
        "Radius of the sphere, in m. Other spheres grow in proportion.",
        sphere,
        |session, _, radius| {
            let radii: Vec<_> = own(session).into_iter().flat_map(radii).collect();
            let Some(&(_, first)) = radii.first() else {
                return;
            };
            session.adjust(|network| {
                for &(k, own) in &radii {
                    let radius = own * (radius / first);
                    let _ = network.reshape_obstacle(k, Shape::Sphere { radius });
                }
            });
        },
    )),
    tunes_scene(knob(
        "floor",
        "Whether there is a floor.",
        |session, _| {
            floor(own(session)?)?;
            let there = floor(network(session)?).is_some();
            Some(switch(there, true))
        },
        |session, _, on| {
            let own = own(session).and_then(floor).filter(|_| on != 0.0);
            let own = own.map(|(_, floor)| floor.clone());
            session.adjust(|network| {
                if let Some((k, _)) = floor(network) {
                    let _ = network.remove_obstacle(k);
                }
                if let Some(floor) = &own {
                    let _ = network.add_obstacle(floor.clone());
                }
            });
        },
    )),
    starts_group(knob(
        "springs of",
        "The particle whose springs are listed and highlighted, by its number.",
        springs_of,
        |session, _, i| {
            let particle = (i >= 0.0).then_some(i as usize);
            looks::each(&mut session.runs.panes, |show| show.springs_of = particle);
        },
    )),
    knob("colour by", "The quantity that colours show.", colour, |session, _, k| {
        let chosen = Quantity::ALL.get(k as usize).copied();
        let panes = &mut session.runs.panes;
        looks::each(panes, |show| show.colouring.set_quantity(chosen));
    }),
    knob(
        "full colour",
        "Upper end of the colour scale. It follows the largest value until it is set.",
        full_colour,
        |session, at, end| {
            let fits = end == session.runs.panes[at].show.colouring.scale.fitting;
            let (panes, end) = (&mut session.runs.panes, (!fits).then_some(end));
            looks::each(panes, |show| show.colouring.scale.fixed = end);
        },
    ),
    knob("arrows", "The vectors that arrows show.", arrows, |session, _, k| {
        let chosen = Arrows::ALL.get(k as usize).copied();
        let panes = &mut session.runs.panes;
        looks::each(panes, |show| show.field.set_arrows(chosen));
    }),
    knob(
        "drawn as",
        "The surface, its wires, or all springs, each kind in its colour and width.",
        style,
        |session, _, k| {
            let styles = Show::styles(session.runs.first());
            let style = styles.get(k as usize).copied().unwrap_or_default();
            looks::each(&mut session.runs.panes, |show| show.style = style);
        },
    ),
    starts_group(knob(
        "dark",
        "Whether the dark theme is on.",
        |session, _| Some(switch(session.runs.panes[0].show.dark, false)),
        |session, _, on| {
            session.panel.dark = Some(on != 0.0);
            looks::each(&mut session.runs.panes, |show| show.dark = on != 0.0);
        },
    )),
    knob(
        "frames",
        "Largest frame rate, to spare the processor. The simulation still keeps up with real time.",
        frame_limit,
        |session, _, limit| session.panel.frame_limit = limit as u32,
    ),
    knob("film as", "Format of the films that keys n and m make.", film, |session, _, k| {
        session.panel.film = Ending::ALL.get(k as usize).copied().unwrap_or_default();
    }),
    knob(
        "film of",
        "Simulated time that key n films, in s.",
        film_seconds,
        |session, _, seconds| {
            session.panel.film_seconds = seconds;
        },
    ),
];

/// Returns the row of a knob of the table.
pub fn row_of(name: &str) -> usize {
    let row = KNOBS.iter().position(|knob| knob.name == name);
    row.unwrap_or(0)
}

/// Returns whether a knob tunes a part that is left out.
pub fn is_left_out(session: &Session, knob: &str) -> bool {
    let changes = session.tuning.changes().into_iter();
    let mut tuned = changes.filter_map(|change| match change {
        PartChange::Gravity => Some("gravity"),
        PartChange::Drag => Some("drag"),
        PartChange::Damping => Some("damping"),
        PartChange::StrainLimit => Some("strain limit"),
        _ => None,
    });
    tuned.any(|name| name == knob)
}

impl Knob {
    /// Turns the knob, if it applies, and records the change in the history.
    pub fn turn(&self, session: &mut Session, at: usize, turn: Turn) {
        let Some(dial) = (self.read)(session, at) else {
            return;
        };
        if is_left_out(session, self.name) {
            let words = format!("{} is left out: bring it back among the parts.", self.name);
            return session.readings.say(words);
        }
        let to = match turn {
            Turn::To(value) => dial.scale.nearest(value),
            Turn::By { up, other } => dial.scale.next(dial.value, up, other),
            Turn::Toggle if dial.scale == DialScale::Switch => 1.0 - dial.value,
            Turn::Toggle | Turn::Own => dial.own,
            Turn::Exactly(value) => value,
        };
        if to != dial.value {
            (self.set)(session, at, to);
            // A material is an edit of the scene.
            if session.panel.material.is_some() {
                return;
            }
            let change = Change::Knob { row: row_of(self.name), pane: at, from: dial.value, to };
            session.history.record(change, None);
        }
    }
}

/// Scales the springs of the scene to the tuned stiffness and damping.
fn set_springs(session: &mut Session) {
    let Tuning { own, stiffness, damping, .. } = session.tuning.clone();
    let Some(own) = own.model.network() else {
        return;
    };
    session.adjust(|network| {
        // The springs are of the same scene and the factors within their scales, so this does not
        // fail.
        let _ = network.copy_springs(own).and_then(|()| network.scale_springs(stiffness, damping));
    });
}
