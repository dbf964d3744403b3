//! The run as it is now, as a scene file.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use a3_core::scenes::{Camera, Description, State};

use super::Session;
use crate::{Failure, output};

/// The most particles whose states fit into a file that can be read again.
const MOST: usize = 100_000;

impl Session {
    /// Writes the run of pane `at` as it is now under the first free name, beside the file that it is from if there is one.
    /// Where.
    pub fn write_scene(&self, at: usize) -> Result<String, String> {
        let run = &self.panes[at.min(self.panes.len() - 1)].simulation;
        let particles = run.particles();
        if particles > MOST {
            return Err(format!(
                "a scene file has at most {MOST} particles, and here are {particles}"
            ));
        }
        let folder = self.shown.0.path.as_deref().and_then(Path::parent);
        let name = &run.scene().name;
        let write = || -> Result<PathBuf, Failure> {
            let text = self.scene_text(at).map_err(Failure::run)?;
            let path = output::free_name(folder.unwrap_or("".as_ref()), name, "toml")?;
            output::write(&path, text.as_bytes())?;
            Ok(path)
        };
        match write() {
            Ok(path) => Ok(path.display().to_string()),
            Err(Failure::Run(why) | Failure::Usage(why) | Failure::Interrupted(why)) => Err(why),
        }
    }

    /// The run of pane `at` as it is now.
    fn scene_text(&self, at: usize) -> Result<String, a3_core::Error> {
        let run = &self.panes[at.min(self.panes.len() - 1)].simulation;
        let mut description = self.description(at);
        let state = description.state.take();
        let mut text = format!(
            "# The scene {} as it was at t = {} s, written by a3 {}. Its clock begins at 0 again.\n\n{}",
            run.scene().name.replace(char::is_control, " "),
            run.time(),
            env!("CARGO_PKG_VERSION"),
            description.to_toml()?,
        );
        let State {
            positions,
            velocities,
        } = state.unwrap_or(State {
            positions: vec![],
            velocities: vec![],
        });
        text += "\n[state]\n";
        for (key, rows) in [("positions", positions), ("velocities", velocities)] {
            // Writing to a string does not fail. As many digits as it takes.
            let _ = writeln!(text, "{key} = [");
            for row in rows {
                let _ = writeln!(text, "  {row:?},");
            }
            text += "]\n";
        }
        Ok(text)
    }

    fn description(&self, at: usize) -> Description {
        let run = &self.panes[at.min(self.panes.len() - 1)].simulation;
        let (source, grid) = &self.shown;
        let mut description = Description::clone(&source.description);
        if let (Some(grid), Some(cloth)) = (grid, description.cloth.first_mut()) {
            cloth.grid = [grid.rows(), grid.cols()];
        }
        description.scale_springs(self.tuning.stiffness, self.tuning.damping);
        description.scale_wind(self.tuning.gusts);
        description.begin_with(run.model(), run.time(), run.state());
        // What only the hand holds is let go of.
        if let Some(held) = run.grabbed() {
            let own = run.scene().model.network();
            let pinned = run.pinned() && own.is_some_and(|own| own.is_pinned(held));
            for pin in &mut description.pin {
                if pin.particles.contains(&held) {
                    pin.shift = pin.shift.take().filter(|_| pin.particles.len() > 1);
                    pin.particles.retain(|i| pinned || *i != held);
                }
            }
            description.pin.retain(|pin| !pin.particles.is_empty());
        }
        description.solver = Some(run.method().name.into());
        description.step = Some(run.setting());
        let triple = |p: nalgebra::Point3<f32>| [p.x, p.y, p.z].map(f64::from);
        description.camera = Some(Camera {
            eye: triple(self.camera.eye()),
            target: triple(self.camera.target()),
        });
        description
    }
}
