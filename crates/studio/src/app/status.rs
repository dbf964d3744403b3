//! Status lines for tests: the state of the window, as text on stderr.

use a3_files::terminal;
use a3_media::show::{Arrows, Quantity};
use a3_render::Tile;
use egui::CursorIcon;
use web_time::{Duration, Instant};

use super::screen::Screen;
use crate::session::{Pane, RunAction, Session};

/// A writer of status lines.
#[derive(Default)]
pub struct Status {
    /// Number of frames drawn.
    pub frames: u64,
    /// The last line, without the values that change in every frame.
    state: String,
    /// Time of the last line.
    said: Option<Instant>,
}

impl Status {
    /// Writes a line, once there are graphics. While the runs advance, an unchanged state is
    /// written at most every 200 ms.
    pub fn say(&mut self, session: &Session, screen: &Screen, cursor: CursorIcon) {
        let Some(graphics) = &screen.graphics else {
            return;
        };
        let run = session.runs.first();
        let readings = &session.readings;
        let panes = &session.runs.panes;
        let grabbed = number(run.grabbed());
        // Position of the grabbed particle in the window (px).
        let place = |pane: &Pane, tile: Tile| {
            let p = pane.simulation.position(pane.simulation.grabbed()?);
            let point = p.map(|x| x as f32).into();
            let ([x, y], _) = session.view.camera.project(point, tile.aspect())?;
            let (x, y) = (x * tile.width as f32, y * tile.height as f32);
            Some(format!("{:.0},{:.0}", tile.x as f32 + x, tile.y as f32 + y))
        };
        let hands = panes.iter().zip(graphics.tiles(session));
        let hands = hands.map(|(pane, tile)| place(pane, tile).unwrap_or("-".into()));
        let hands: Vec<_> = hands.collect();
        let each = |value: &dyn Fn(&Pane) -> String| {
            let values: Vec<_> = panes.iter().map(value).collect();
            values.join(",")
        };
        let state = format!(
            "scene={} solver={} step={} style={:?} wind={} swing={} paused={} help={} asks={} hint={} panel={} measure={} known={} lesson={} plots={} list={} film={} cursor={cursor:?} followed={} parallel={} scale={} dark={} tools={} particles={} blown={} grabbed={grabbed} \
             colour={} arrows={} slowness={} scrubbed={} pins={} springs_of={} size={}x{} visible={} devices={}",
            run.scene().name,
            run.method().name,
            run.control().value(),
            panes[0].show.style,
            run.windy(),
            run.swinging(),
            readings.paused,
            readings.help,
            readings.asks_to_quit,
            !session.pulled,
            session.panel.has(RunAction::Panel),
            session.panel.has(RunAction::Measure),
            session.measuring.known().is_some(),
            lesson(session),
            plots(session),
            session.list.is_some(),
            readings.film.is_some(),
            number(session.view.followed()),
            session.view.camera.is_parallel(),
            graphics.scale(),
            panes[0].show.dark,
            session.panel.editor.open,
            run.particles(),
            run.blow_up().is_some(),
            panes[0].show.colouring.quantity.map_or("-", Quantity::name),
            panes[0].show.field.arrows.map_or("-", Arrows::name),
            readings.slowness,
            readings.rewound(),
            run.model().network().map_or(0, |n| n.pins().count()),
            number(panes[0].show.springs_of),
            graphics.size().0,
            graphics.size().1,
            screen.visible,
            screen.devices,
        );
        let now = Instant::now();
        let quiet =
            self.said.is_some_and(|said| now.duration_since(said) < Duration::from_millis(200));
        // While the runs stand still, no other line would follow.
        let quiet = quiet && session.animated();
        if quiet && state == self.state {
            return;
        }
        terminal::warn(&format!(
            "status {state} time={:.4} steps={} frames={} hand={} rate={:.1} factor={:.2} \
             simulating={:.2} drawing={:.2} adapter={} panes={} hands={} solvers={} step_sizes={} times={} lost={} \
             errors={}",
            run.time(),
            run.steps(),
            self.frames,
            hands[0],
            readings.rates.rate,
            readings.rates.factor,
            readings.rates.simulating,
            readings.rates.drawing,
            graphics.gpu.name(),
            panes.len(),
            hands.join(";"),
            each(&|pane| pane.simulation.method().name.into()),
            each(&|pane| pane.simulation.control().value().to_string()),
            each(&|pane| format!("{:.4}", pane.simulation.time())),
            each(&|pane| (!pane.alive()).to_string()),
            each(&|pane| pane.error.map_or("-".into(), |error| format!("{error:.3e}"))),
        ));
        self.state = state;
        self.said = Some(now);
    }
}

/// Returns a number, or `-`.
fn number(number: Option<usize>) -> String {
    number.map_or("-".into(), |i| i.to_string())
}

/// Returns the lesson and the step that are shown, as in `1.2`, and `list` for the list of lessons.
fn lesson(session: &Session) -> String {
    let lessons = &session.panel.lessons;
    match lessons.step {
        _ if !session.panel.has(RunAction::Lessons) => "-".into(),
        None => "list".into(),
        Some(step) => format!("{}.{}", lessons.chosen + 1, step + 1),
    }
}

/// Returns the number of things that are plotted, if the plots are open.
fn plots(session: &Session) -> String {
    let is_open = session.panel.has(RunAction::Plots);
    number(is_open.then(|| session.runs.panes[0].traces.len()))
}
