//! The origin of a scene: its source and the options that change it.

use std::collections::HashSet;

use a3_core::{Grid, Network, Scene, StepLimits};
use a3_scenes::{Description, Edit, Part, PartChange, Setup, Splice, parts, without};

use a3_files::failure::InputError;
use a3_files::scene_file::Source;

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
        Self {
            source,
            grid: None,
            limits: StepLimits::default(),
            edited: false,
            crossed: false,
        }
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
            let ends = springs
                .flat_map(Network::all_springs)
                .map(|it| [it.i, it.j]);
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
