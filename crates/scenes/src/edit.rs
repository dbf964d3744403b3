//! Edits of a scene: bodies, particles, springs, rods and ropes that come or go, and the numbers of
//! the others since then.

use a3_core::Network;
use a3_core::elements::Fluid as Liquid;
use a3_core::rigid::Body;

use crate::description::{
    ConstraintSpec, Description, Fluid, Particles, Pin, RigidBody, SpringSpec, Triple,
};
use crate::snapshot::rows;

/// Edit of a scene. Particles have the numbers that they have before the edit.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// A rigid body is added.
    AddBody(RigidBody),
    /// A particle at rest is added: its position (m) and its mass (kg).
    AddParticle {
        /// Position (m).
        position: Triple,
        /// Mass (kg).
        mass: f64,
    },
    /// A spring is added.
    AddSpring(SpringSpec),
    /// A rod or a rope is added.
    AddConstraint(ConstraintSpec),
    /// What joins two particles is removed: rods and ropes or, where there are none, springs.
    Disjoin([usize; 2]),
    /// A single particle is removed with all that is joined to it. One of a cloth or of another
    /// body of springs stays, but its springs are torn.
    RemoveParticle(usize),
    /// A rigid body is removed, by its number, with all that is joined to it.
    RemoveBody(usize),
    /// All bodies that can be of a material become of it.
    NameMaterial(&'static str),
}

/// An edited scene, and the numbers of its particles and rigid bodies.
///
/// ```
/// use a3_scenes::Edit;
///
/// let entry = a3_scenes::find("chain").unwrap();
/// let (chain, scene) = (entry.description()?, entry.build(None)?.scene);
/// let add = Edit::AddParticle { position: [0.0, 2.0, 0.0], mass: 0.1 };
/// let edited = add.apply(&chain, scene.model.network().unwrap())?;
/// assert_eq!(edited.particles.added, 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Edited {
    /// The scene.
    pub description: Description,
    /// How particles are numbered since the edit.
    pub particles: Splice,
    /// How rigid bodies are numbered since the edit.
    pub bodies: Splice,
}

impl Edit {
    /// Edits a scene whose network is `network`.
    ///
    /// # Errors
    /// The scene does not allow this edit. The text is a sentence for the user.
    pub fn apply(&self, scene: &Description, network: &Network) -> Result<Edited, String> {
        let mut edited = Edited {
            description: scene.clone(),
            particles: Splice::default(),
            bodies: Splice::default(),
        };
        match self {
            Self::AddBody(body) => edited.add_body(body, network)?,
            Self::AddParticle { position, mass } => {
                edited.add_particle(*position, *mass, network);
            }
            Self::AddSpring(spring) => {
                check_ends(network, [spring.0, spring.1])?;
                refuse!(if network.is_torn(spring.0, spring.1) =>
                    "Springs between these particles are torn, and a new one would be too.");
                edited.description.springs.push(*spring);
            }
            Self::AddConstraint(link) => {
                check_ends(network, link.rod.or(link.rope).unwrap_or_default())?;
                edited.description.constraint.push(link.clone());
            }
            Self::Disjoin(ends) => edited.disjoin(*ends, network)?,
            Self::NameMaterial(name) => {
                let named = edited.description.name_material(name);
                named.map_err(|fault| fault.to_string())?;
            }
            Self::RemoveParticle(i) => edited.remove_particle(*i, network)?,
            Self::RemoveBody(k) => {
                let body = network.bodies().get(*k).ok_or("There is no such body.")?;
                edited.description.body.remove(*k);
                edited.remove(body.center(), 1 + body.points().len());
                edited.forget_body(*k);
            }
        }
        Ok(edited)
    }
}

/// Checks that two particles can be joined.
fn check_ends(network: &Network, [i, j]: [usize; 2]) -> Result<(), String> {
    refuse!(if i == j => "Two particles are needed to join.");
    let fluid = network.fluid();
    let has = |i| fluid.is_some_and(|fluid| fluid.members().contains(i));
    refuse!(if has(i) || has(j) => "Particles of a fluid cannot be joined.");
    Ok(())
}

/// Returns the number of the first particle of the fluids, which are the last, in a network without
/// rigid bodies.
fn first_of_fluid(network: &Network) -> usize {
    let n = network.particles();
    let first = |fluid: &Liquid| {
        let all = fluid.particles().iter().chain(fluid.members().drained());
        all.min().copied()
    };
    let first = network.fluid().and_then(first);
    first.map_or(n, |i| i as usize)
}

/// Returns the number after that of the last single particle: rigid bodies and fluids follow.
fn end_of_single(network: &Network) -> usize {
    let body = network.bodies().first();
    body.map_or_else(|| first_of_fluid(network), Body::center)
}

/// Returns the number after that of the last particle of the rigid bodies: fluids follow.
fn end_of_bodies(network: &Network) -> usize {
    let end = |body: &Body| body.center() + 1 + body.points().len();
    let last = network.bodies().last();
    last.map_or_else(|| first_of_fluid(network), end)
}

impl Edited {
    fn add_body(&mut self, body: &RigidBody, network: &Network) -> Result<(), String> {
        let fluid = self.description.fluid.first();
        let alone = Description {
            body: vec![body.clone()],
            // The body carries points that the liquid touches.
            fluid: fluid.map(Fluid::drop_of).into_iter().collect(),
            ..Description::default()
        };
        let mut no_file = |_: &str| Err("a file has no place here".into());
        let alone = alone.build(None, &mut no_file);
        let alone = alone.map_err(|fault| fault.to_string())?.scene;
        let n = alone.model.particles();
        let own = n - usize::from(fluid.is_some());
        self.description.body.push(body.clone());
        let mut halves = alone.state.chunks_exact(3 * n);
        let mut next = || {
            let mut all = halves.next().map(rows).unwrap_or_default();
            all.truncate(own);
            all
        };
        self.insert(end_of_bodies(network), (next(), next()));
        self.bodies = Splice::new(network.bodies().len(), 0, 1);
        if let Some(state) = &mut self.description.state {
            let turned = &alone.state[6 * n..];
            let orientation = [0, 1, 2, 3].map(|k| turned[k]);
            self.bodies.of(&mut state.orientations, [orientation]);
            let momentum = [4, 5, 6].map(|k| turned[k]);
            self.bodies.of(&mut state.angular_momenta, [momentum]);
        }
        Ok(())
    }

    fn add_particle(&mut self, position: Triple, mass: f64, network: &Network) {
        let own = self.description.particles.get_or_insert_default();
        let before = own.positions.len();
        own.positions.push(position);
        if !own.velocities.is_empty() {
            own.velocities.push([0.0; 3]);
        }
        match own.mass {
            None if own.masses.is_empty() => own.mass = Some(mass),
            None => own.masses.push(mass),
            Some(same) if same == mass => {}
            Some(other) => {
                own.masses = vec![other; before];
                own.masses.push(mass);
                own.mass = None;
            }
        }
        self.insert(end_of_single(network), (vec![position], vec![[0.0; 3]]));
    }

    fn disjoin(&mut self, ends: [usize; 2], network: &Network) -> Result<(), String> {
        let [i, j] = ends;
        let joins = |a: usize, b: usize| [a, b] == ends || [b, a] == ends;
        let all = &mut self.description.constraint;
        let count = all.len();
        all.retain(|it| !(it.rod.or(it.rope)).is_some_and(|[a, b]| joins(a, b)));
        if all.len() < count {
            return Ok(());
        }
        let springs = network.all_springs();
        let there = springs.filter(|it| joins(it.i, it.j)).count();
        refuse!(if there == 0 => "Nothing that could be removed joins the particles {i} and {j}.");
        let listed = self.remove_listed(network, joins);
        if listed < there {
            self.description.torn.push([i.min(j), i.max(j)]);
        }
        Ok(())
    }

    /// Removes those springs of the lists whose ends `joins` chooses, and returns their number.
    fn remove_listed(&mut self, network: &Network, joins: impl Fn(usize, usize) -> bool) -> usize {
        let between = &mut self.description.springs;
        let mut count = between.len();
        between.retain(|it| !joins(it.0, it.1));
        count -= between.len();
        if let Some(own) = &mut self.description.particles {
            let first = end_of_single(network) - own.positions.len();
            count += own.springs.len();
            own.springs.retain(|it| !joins(first + it.0, first + it.1));
            count -= own.springs.len();
        }
        count
    }

    fn remove_particle(&mut self, i: usize, network: &Network) -> Result<(), String> {
        let single = self.description.particles.as_ref();
        let count = single.map_or(0, |own| own.positions.len());
        let end = end_of_single(network);
        let own = i.checked_sub(end - count).filter(|own| *own < count);
        if let Some((own, all)) = own.zip(self.description.particles.as_mut()) {
            all.remove(own);
            if all.positions.is_empty() {
                self.description.particles = None;
            }
            self.remove(i, 1);
            return Ok(());
        }
        let springs = network.springs_of(i);
        let mut pairs: Vec<_> = springs.map(|it| [it.i.min(it.j), it.i.max(it.j)]).collect();
        refuse!(if pairs.is_empty() => "Particle {i} cannot be removed from its body.");
        refuse!(if network.is_held(i) => "Rods or ropes hold particle {i}: remove these first.");
        // Springs that were added by hand go; those of a body are torn.
        for it in &self.description.springs {
            let ends = [it.0.min(it.1), it.0.max(it.1)];
            if let Some(k) = pairs.iter().position(|pair| *pair == ends) {
                pairs.swap_remove(k);
            }
        }
        self.remove_listed(network, |a, b| a == i || b == i);
        pairs.sort_unstable();
        pairs.dedup();
        self.description.torn.extend(pairs);
        Ok(())
    }

    /// Adds rows of particles to the state, and numbers all others anew.
    fn insert(&mut self, at: usize, (positions, velocities): (Vec<Triple>, Vec<Triple>)) {
        self.particles = Splice::new(at, 0, positions.len());
        renumber_particles(&mut self.description, self.particles);
        if let Some(state) = &mut self.description.state {
            let moves = velocities.iter().any(|v| *v != [0.0; 3]);
            if state.velocities.is_empty() && moves {
                state.velocities = vec![[0.0; 3]; state.positions.len()];
            }
            self.particles.of(&mut state.positions, positions);
            self.particles.of(&mut state.velocities, velocities);
        }
    }

    /// Removes particles from the state and from all that is joined to them, and numbers the others
    /// anew.
    fn remove(&mut self, at: usize, removed: usize) {
        self.particles = Splice::new(at, removed, 0);
        renumber_particles(&mut self.description, self.particles);
        if let Some(state) = &mut self.description.state {
            for rows in [&mut state.positions, &mut state.velocities] {
                self.particles.of(rows, []);
            }
        }
    }

    /// Removes body k from joints, pins and the state, and numbers the others anew.
    fn forget_body(&mut self, k: usize) {
        self.bodies = Splice::new(k, 1, 0);
        renumber_bodies(&mut self.description, self.bodies);
        if let Some(state) = &mut self.description.state {
            self.bodies.of(&mut state.orientations, []);
            self.bodies.of(&mut state.angular_momenta, []);
        }
    }
}

impl Particles {
    /// Removes a particle, by its number in this body, with its springs and pins.
    fn remove(&mut self, i: usize) {
        let one = Splice::new(i, 1, 0);
        one.of(&mut self.positions, []);
        one.of(&mut self.velocities, []);
        one.of(&mut self.masses, []);
        keep(&mut self.springs, |it| {
            Some((one.number(it.0)?, one.number(it.1)?, it.2, it.3, it.4))
        });
        keep_pins(&mut self.pin, one);
    }
}

/// Numbers the particles of pins anew, and forgets the pins of removed ones.
fn keep_pins(pins: &mut Vec<Pin>, particles: Splice) {
    for pin in pins.iter_mut() {
        keep(&mut pin.particles, |i| particles.number(*i));
    }
    pins.retain(|pin| !pin.particles.is_empty());
}

/// Numbers all particles anew that the scene names, and forgets what names a removed one.
fn renumber_particles(description: &mut Description, particles: Splice) {
    let number = |i: usize| particles.number(i);
    let pair = |[i, j]: [usize; 2]| Some([number(i)?, number(j)?]);
    keep(&mut description.springs, |it| {
        let [i, j] = pair([it.0, it.1])?;
        Some((i, j, it.2, it.3, it.4))
    });
    keep(&mut description.torn, |it| pair(*it));
    keep(&mut description.constraint, |it| {
        let mut it = it.clone();
        for ends in [&mut it.rod, &mut it.rope].into_iter().flatten() {
            *ends = pair(*ends)?;
        }
        if let Some(i) = &mut it.particle {
            *i = number(*i)?;
        }
        Some(it)
    });
    keep_pins(&mut description.pin, particles);
    description.trail = description.trail.and_then(number);
}

/// Numbers all rigid bodies anew that joints and pins name, and forgets the joints and the pins of
/// a removed one.
fn renumber_bodies(description: &mut Description, bodies: Splice) {
    let number = |k: usize| bodies.number(k);
    keep(&mut description.joint, |it| {
        let mut it = it.clone();
        if let Some(k) = &mut it.body {
            *k = number(*k)?;
        }
        if let Some([k, l]) = &mut it.bodies {
            (*k, *l) = (number(*k)?, number(*l)?);
        }
        Some(it)
    });
    let fit = |pins: &mut Vec<Pin>| {
        pins.retain(|pin| pin.body.is_none_or(|k| number(k).is_some()));
        for pin in pins {
            pin.body = pin.body.and_then(number);
        }
    };
    fit(&mut description.pin);
    let pinned = description.bodies_mut().filter_map(|body| body.pin);
    pinned.for_each(fit);
}

/// Places of a list from which an edit removed items, and to which it added others.
///
/// ```
/// let gap = a3_scenes::Splice { at: 3, removed: 1, added: 0 };
/// assert_eq!([2, 3, 4].map(|i| gap.number(i)), [Some(2), None, Some(3)]);
/// assert_eq!(gap.back().number(3), Some(4));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Splice {
    /// Number of the first of these items.
    pub at: usize,
    /// Number of items that were removed.
    pub removed: usize,
    /// Number of items that were added.
    pub added: usize,
}

impl Splice {
    /// Returns the number of item i since the edit; `None` if it was removed.
    #[must_use]
    pub fn number(&self, i: usize) -> Option<usize> {
        match i.checked_sub(self.at) {
            None => Some(i),
            Some(after) if after < self.removed => None,
            Some(after) => Some(self.at + after - self.removed + self.added),
        }
    }

    /// Returns the splice that undoes this one.
    #[must_use]
    pub fn back(self) -> Self {
        Self { removed: self.added, added: self.removed, ..self }
    }

    /// Creates the places from which items were removed, and to which others were added.
    pub(crate) fn new(at: usize, removed: usize, added: usize) -> Self {
        Self { at, removed, added }
    }

    /// Edits a list, with `new` items at their places. One that is empty, as if it were not given,
    /// stays so.
    pub(crate) fn of<T>(self, list: &mut Vec<T>, new: impl IntoIterator<Item = T>) {
        if !list.is_empty() {
            list.splice(self.at..self.at + self.removed, new);
        }
    }
}

/// Replaces each item of a list by another one, or removes it.
fn keep<T>(list: &mut Vec<T>, change: impl FnMut(&T) -> Option<T>) {
    *list = list.iter().filter_map(change).collect();
}
