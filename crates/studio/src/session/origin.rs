//! The origin of a scene: its source and the options that change it. And the passage of a run to
//! the same scene after an edit: which particles stay.

use std::collections::HashSet;

use a3_core::{Checkpoint, Constraint, Grid, Network, Pin, Scene, Simulation, StepLimits};
use a3_files::failure::InputError;
use a3_files::scene_file::Source;
use a3_scenes::{Description, Edit, Part, PartChange, Setup, Splice, parts, without};

/// A scene's name or file, and the options that change it.
#[derive(Clone)]
pub struct Origin {
    /// The name or file.
    pub source: Source,
    /// Grid of the cloth, `None` for the scene's own.
    pub grid: Option<Grid>,
    /// Limits of adaptive steps, where they differ from the scene's own.
    pub limits: StepLimits,
    /// Whether the scene was edited in the window.
    pub edited: bool,
    /// Whether its surfaces begin crossed, so that they do not touch at the start.
    pub crossed: bool,
}

impl Origin {
    /// Finds a scene by its name or its file, unchanged.
    pub fn find(typed: &str) -> Result<Self, InputError> {
        Ok(Self::of(Source::find(typed)?.in_window()))
    }

    /// Creates the origin of an unchanged scene.
    pub fn of(source: Source) -> Self {
        Self { source, grid: None, limits: StepLimits::default(), edited: false, crossed: false }
    }

    /// Builds the scene to begin with it. Its surfaces do not touch if they begin crossed. Fails if
    /// its description is invalid.
    pub fn begin(&mut self) -> Result<Setup, InputError> {
        let setup = self.build()?;
        if !(self.source.description.self_collision && begins_crossed(&setup.scene)) {
            return Ok(setup);
        }
        self.crossed = true;
        self.source = self.source.without_touch();
        self.build()
    }

    /// Edits the scene, whose network is `network`. Returns the edited scene, and how its particles
    /// and its rigid bodies are numbered. Fails if the scene does not allow that.
    pub fn edit(&self, edit: &Edit, network: &Network) -> Result<(Self, [Splice; 2]), String> {
        let mut edited = edit.apply(&self.with_grid(), network)?;
        if matches!(edit, Edit::AddBody(_)) && network.bodies().is_empty() {
            // The first rigid body lets all surfaces touch: those that begin crossed come apart.
            let mut touching = self.with_grid();
            touching.self_collision = true;
            let setup = self.source.described(touching).build(None);
            edited.description.untangle |= setup.is_ok_and(|setup| begins_crossed(&setup.scene));
        }
        let origin = Self {
            source: self.source.described(edited.description),
            grid: None,
            limits: self.limits,
            edited: true,
            crossed: false,
        };
        Ok((origin, [edited.particles, edited.bodies]))
    }

    /// Builds the scene. Fails if its description is invalid.
    pub fn build(&self) -> Result<Setup, InputError> {
        let mut setup = self.source.build(self.grid)?;
        setup.scene.limits = self.limits.or(setup.scene.limits);
        Ok(setup)
    }

    /// Lists the parts of the scene, built as `scene`, that can be left out: also wind and
    /// self-collision that are off at first.
    pub fn parts(&self, scene: &Scene) -> Vec<Part> {
        let mut all = parts(&self.described());
        all.retain(|part| part.change != PartChange::SelfCollision || scene.touch.is_some());
        all
    }

    /// Builds the scene without some of its [`parts`](Self::parts). Fails if there is no such
    /// scene.
    pub fn build_without(&self, parts: &[&Part]) -> Result<Setup, InputError> {
        if parts.is_empty() {
            return self.build();
        }
        let reduced = |description: Description| Self {
            source: self.source.described(description),
            grid: None,
            ..self.clone()
        };
        let mut description = self.described_without(parts);
        if !description.torn.is_empty() {
            // Springs that are left out cannot be torn.
            let torn = std::mem::take(&mut description.torn);
            let whole = reduced(description.clone()).build()?.scene;
            let springs = whole.model.network().into_iter();
            let ends = springs.flat_map(Network::all_springs).map(|it| [it.i, it.j]);
            let there: HashSet<_> = ends.flat_map(|[i, j]| [[i, j], [j, i]]).collect();
            description.torn = torn;
            description.torn.retain(|ends| there.contains(ends));
        }
        reduced(description).build()
    }

    /// Describes the scene with its grid, without some of its [`parts`](Self::parts).
    pub fn described_without(&self, parts: &[&Part]) -> Description {
        let own = &*self.source.description;
        let mut reduced = without(&self.described(), parts.iter().copied());
        // Runs turn these on and off.
        if let (Some(wind), Some(own)) = (&mut reduced.wind, &own.wind) {
            wind.on = own.on;
        }
        reduced.self_collision = own.self_collision;
        reduced
    }

    /// Describes the scene with its grid, with wind if it has any, and with self-collision.
    fn described(&self) -> Description {
        let mut description = self.with_grid();
        if let Some(wind) = &mut description.wind {
            wind.on = true;
        }
        description.self_collision = true;
        description
    }

    /// Describes the scene with its grid.
    fn with_grid(&self) -> Description {
        let mut description = Description::clone(&self.source.description);
        if let (Some(grid), Some(cloth)) = (self.grid, description.cloth.first_mut()) {
            cloth.grid = [grid.rows(), grid.cols()];
        }
        description
    }
}

/// Returns whether surfaces of a scene cross at the start, or too many are at one place.
pub fn begins_crossed(scene: &Scene) -> bool {
    scene.model.network().is_some_and(|network| {
        let (x, _) = network.halves(&scene.state);
        network.check_apart(0.0, x).is_err()
    })
}

/// Numbers that the state has for each particle: its position (m) and its velocity (m/s).
const PARTICLE: usize = 6;
/// Numbers that the state has for each rigid body: its quaternion and its angular momentum.
const BODY: usize = 7;

/// Passage of runs to an edited scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Passage {
    /// How particles are numbered there.
    pub particles: Splice,
    /// How rigid bodies are numbered there.
    pub bodies: Splice,
    /// Whether surfaces touch there; `None` if they do as before.
    pub touching: Option<bool>,
}

impl Passage {
    /// Returns whether a state of `dim` numbers passes to one of the scene.
    pub fn fits(&self, dim: usize, scene: &Scene) -> bool {
        let change = |it: Splice, each: usize| [it.added * each, it.removed * each];
        let [more, fewer] = change(self.particles, PARTICLE);
        let [more_turned, fewer_turned] = change(self.bodies, BODY);
        dim + more + more_turned == scene.state.len() + fewer + fewer_turned
    }

    /// Passes a moment of a run to `next`, which is at the start of the edited scene.
    pub fn take(&self, moment: &mut Checkpoint, run: &Simulation, next: &Simulation) {
        let (Some(old), Some(new)) = (run.model().network(), next.model().network()) else {
            return;
        };
        let number = |i: usize| self.particles.number(i);
        let pair = |[i, j]: [usize; 2]| Some([number(i)?, number(j)?]);
        // What the old scene itself had torn is not torn for good: the new scene says what is.
        let scene = run.scene().model.network();
        let own = scene.map_or(&[][..], Network::torn);
        moment.torn.retain(|ends| own.binary_search(ends).is_err());
        moment.torn = moment.torn.iter().filter_map(|ends| pair(*ends)).collect();
        moment.torn.extend_from_slice(new.torn());
        moment.torn.sort_unstable();
        moment.torn.dedup();
        if let Some(touching) = self.touching {
            moment.touching = touching;
        }
        if (self.particles, self.bodies) != (Splice::default(), Splice::default()) {
            moment.run.y = self.state(&moment.run.y, run.particles(), next);
        }
        let renumbered = |pin: &Pin| {
            let particle = number(pin.particle)?;
            Some(Pin { particle, ..*pin })
        };
        moment.pins = moment.pins.iter().filter_map(renumbered).collect();
        let renumbered = |i: &u32| Some(number(*i as usize)? as u32);
        moment.drained = moment.drained.iter().filter_map(renumbered).collect();
        let back = self.particles.back();
        let added = new.all_pins().filter(|pin| back.number(pin.particle).is_none());
        moment.pins.extend(added);
        // Ropes, and ends of joints.
        let kind = |it: &Constraint| match it {
            Constraint::Rope { .. } => Some(None),
            Constraint::Stop(stop) => Some(Some(stop.is_upper)),
            _ => None,
        };
        let before = |k: &usize| {
            let constraint = old.constraints().get(*k)?;
            let (first, second) = constraint.ends();
            let second = match second {
                Some(j) => Some(number(j)?),
                None => None,
            };
            Some((kind(constraint)?, (number(first)?, second)))
        };
        let taut: Vec<_> = moment.taut.iter().filter_map(before).collect();
        let is_taut =
            |it: &Constraint| kind(it).is_some_and(|kind| taut.contains(&(kind, it.ends())));
        let all = new.constraints().iter().enumerate();
        moment.taut = all.filter(|(_, it)| is_taut(it)).map(|(k, _)| k).collect();
    }

    /// Returns the state in the edited scene from that of n particles before it.
    fn state(&self, y: &[f64], n: usize, next: &Simulation) -> Vec<f64> {
        let (m, mut state) = (next.particles(), next.state().to_vec());
        let before = |j: usize| self.particles.back().number(j);
        for (j, i) in (0..m).filter_map(|j| Some((j, before(j)?))) {
            for axis in 0..PARTICLE {
                state[axis * m + j] = y[axis * n + i];
            }
        }
        let (old, new) = (&y[PARTICLE * n..], &mut state[PARTICLE * m..]);
        for (l, own) in new.chunks_exact_mut(BODY).enumerate() {
            if let Some(k) = self.bodies.back().number(l) {
                own.copy_from_slice(&old[BODY * k..BODY * (k + 1)]);
            }
        }
        state
    }
}
