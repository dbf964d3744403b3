//! What is computed: the formulas of the running methods and of the scene's forces.

use a3_core::{Network, Simulation};
use egui::text::{LayoutJob, TextFormat};
use egui::{FontId, Label, Rect, ScrollArea, Ui, UiBuilder};

use super::super::style::{FAINT, TEXT};
use crate::session::Session;

/// Height of a line (points).
const LINE: f32 = 18.0;
/// Least height of a chart beside formulas (points). In less room, they are there alone.
const MIN_CHART: f32 = 150.0;
/// Largest share of the room that formulas take beside a chart.
const SHARE: f32 = 0.45;

/// The step of each method, a line for each: its name, and the step from y at the time t over h.
const METHODS: &str = "\
    euler: y₁ = y + h f(t, y)
    trapezoid: k₁ = f(t, y), k₂ = f(t + h, y + h k₁), y₁ = y + h/2 (k₁ + k₂)
    midpoint: y₁ = y + h f(t + h/2, y + h/2 f(t, y))
    rk4: k₁ = f(t, y), k₂ = f(t + h/2, y + h/2 k₁), k₃ = f(t + h/2, y + h/2 k₂), k₄ = f(t + h, y \
        + h k₃), y₁ = y + h/6 (k₁ + 2 k₂ + 2 k₃ + k₄)
    symplectic: v₁ = v + h F(t, x, v) / m, x₁ = x + h v₁
    verlet: Half a drift, a kick v + h F / m, half a drift. A drift is the motion under gravity \
        and drag alone, x + h v without them. Forces that depend on v take three kicks of h/3.
    pefrl: Five drifts by ξ, χ, 1 - 2 (χ + ξ), χ, ξ of h, and between them kicks v + h F / m by \
        1/2 - λ, λ, λ, 1/2 - λ of h, with ξ = 0.1786, χ = -0.0663, λ = -0.2123.
    dopri5: k₁ = f(t, y), each next k = f(t + c h, y + h Σ a k) of those before, up to k₇; y₁ = y \
        + h Σ b k. h keeps the error, estimated by another h Σ d k, within the tolerance.
    dop853: k₁ = f(t, y), each next k = f(t + c h, y + h Σ a k) of those before, up to k₁₂; y₁ = \
        y + h Σ b k. h keeps the error, estimated by two other sums, within the tolerance.
    implicit: y₁ = y + h f(t + h, y₁), by Newton's method: for forces, by one iteration; \
        with rigid bodies, by more
    rkf45: k₁ = f(t, y), each next k = f(t + c h, y + h Σ a k) of those before, up to k₆; y₁ = y \
        + h Σ b k. h keeps the error, estimated by another h Σ d k, within the tolerance.
    tr-bdf2: Y = y + g h (f(t, y) + f(t + 2 g h, Y)), y₁ = y + h (w f(t, y) + w f(t + 2 g h, Y) + \
        g f(t + h, y₁)), with g = 1 - 1/√2, w = √2/4, solved by Newton's method
    implicit-midpoint: Y = y + h/2 f(t + h/2, Y), solved by Newton's method; y₁ = 2 Y - y
    verner65: k₁ = f(t, y), each next k = f(t + c h, y + h Σ a k) of those before, up to k₉; y₁ = \
        y + h Σ b k. h keeps the error, estimated by another h Σ d k, within the tolerance.
    srkn11: Twelve kicks v + b h F / m, and between them eleven drifts by a of h: each the motion \
        under gravity and drag alone, x + a h v without them.
    dprkn86: X = x + c h v + h² Σ a F(X) / m of the stages before, nine of them; x₁ = x + h v + \
        h² Σ b F(X) / m, v₁ = v + h Σ d F(X) / m. h keeps the estimated error within the \
        tolerance.
    dprkn1210: X = x + c h v + h² Σ a F(X) / m of the stages before, seventeen of them; x₁ = x + \
        h v + h² Σ b F(X) / m, v₁ = v + h Σ d F(X) / m. h keeps the estimated error within the \
        tolerance.
    bdf: y₁ = Σ a y + b h f(t + h, y₁) over the last 1 to 5 states y, solved by Newton's method. \
        h and their number keep the estimated error within the tolerance.
    xpbd: x₁ = x + h v*, with v* = (m v + h F) / (m + h c) of all but the springs. Then each \
        spring in turn moves its ends along it by w ∆λ, where (without damping) ∆λ = (r - L - α \
        λ) / (w + w' + α), w = 1/(m + h c), α = 1/(k h²). v₁ = (x₁ - x) / h
    xpbd10: x₁ = x + h v*, with v* = (m v + h F) / (m + h c) of all but the springs. Then ten \
        times each spring in turn moves its ends along it by w ∆λ, where (without damping) ∆λ = \
        (r - L - α λ) / (w + w' + α), w = 1/(m + h c), α = 1/(k h²). v₁ = (x₁ - x) / h
    vbd: x₁ = x + h v*, with v* = (m v + h F) / (m + h c) of all but the springs. Then ten times \
        each particle in turn takes a step of Newton's method to the least (without damping) (m + \
        h c) |x₁ - x - h v*|² / (2 h²) + U(x₁). v₁ = (x₁ - x) / h
    implicit-damping: Half a drift, then at fixed positions A k₁ = F(x, v), A k₂ = F(x, v + h k₁) \
        - 2 m k₁, v + h (3/2 k₁ + 1/2 k₂), then half a drift, with A = m - g h ∂F/∂v, g = 1 - \
        1/√2
    radau: Y = y + h Σ a f(t + c h, Y) for three Y at once, with c = (4 - √6)/10, (4 + √6)/10 and \
        1, solved by Newton's method; y₁ = Y₃. h keeps the estimated error within the tolerance.
";

/// The forces of a network, a line for each.
const FORCES: &str = "\
    springs: k (L - r) along each, of the length L and the rest length r
    springs that only pull: k (L - r) along each, 0 where L < r
    buckling: arcs of the curvature κ push by k κ² / (sin q / q - cos q), q = κ r/2
    solid: -∂U/∂x of the elastic energy U of each tetrahedron
    gas pressure: p ∂V/∂x of the volume V inside
    fluid: -m² Σ (p/ρ² + p'/ρ'² - k (v - v')·d / (r² + s²)) ∂W/∂x over the neighbours, d = x - \
        x', r = |d|, ρ = m Σ W; k is proportional to the viscosity
    spring damping: c L' along each spring
    viscosity: against the rate of the strain of each tetrahedron
    gravity: m g
    drag: -c v
    wind: of the air on each triangle, or on each particle
    contact: k d ((d - g) / d)³ where a gap g is below the thickness d, times a factor of g' for \
        damping or restitution
    attraction: -m (w² (x - p) + 2 w (v - p')) to the hand at p
    own force: one's own function
    constraints: those that keep all C(x) = 0: λ ∂C/∂x
    motors: torques on rigid bodies
";

/// Its parts that are no forces, but act after each step.
const AFTER: &str = "\
    sphere: reaction and friction, as impulses
    box: reaction and friction, as impulses
    capsule: reaction and friction, as impulses
    floor: reaction and friction, as impulses
    tearing: a spring breaks at its largest L / r
    strain limit: springs are shortened to it
";

/// Returns the names and the formulas of a table.
fn rows(table: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    let lines = table.lines();
    lines.filter_map(|line| line.trim().split_once(": "))
}

/// Returns the formula by a name in a table.
fn formula(table: &'static str, name: &str) -> Option<&'static str> {
    rows(table).find(|row| row.0 == name).map(|row| row.1)
}

/// Returns what is computed in some runs of one scene: names and formulas.
fn lines<'a>(runs: impl Iterator<Item = &'a Simulation>) -> Vec<(String, &'static str)> {
    let mut lines: Vec<(String, _)> = vec![];
    let mut network: Option<&Network> = None;
    for run in runs {
        let name = run.method().name;
        let own = formula(METHODS, name).unwrap_or("a method of one's own");
        if !lines.iter().any(|line| line.0 == name) {
            lines.push((name.into(), own));
        }
        network = run.model().network();
    }
    let Some(network) = network else {
        lines.push(("y' = f(t, y)".into(), "the scene's own function"));
        return lines;
    };
    let whole = "y = [x | v], x' = v, m v' = F(t, x, v), the sum of these forces:";
    lines.push(("y' = f(t, y)".into(), whole));
    let all = network.forces_in_use().into_iter();
    let (after, forces): (Vec<_>, Vec<_>) = all.partition(|name| formula(AFTER, name).is_some());
    let all = [FORCES, AFTER];
    let own = |name: &'static str| {
        let mut found = all.into_iter().filter_map(|table| formula(table, name));
        (name.into(), found.next().unwrap_or_default())
    };
    lines.extend(forces.into_iter().map(own));
    if !after.is_empty() {
        lines.push(("then".into(), "after each step:"));
    }
    lines.extend(after.into_iter().map(own));
    lines
}

/// Writes what is computed at the top of a room. Returns where the room goes on (points): at its
/// bottom if there is none for a chart.
pub fn show(ui: &mut Ui, room: Rect, session: &Session) -> f32 {
    let format = |ink| TextFormat {
        line_height: Some(LINE),
        ..TextFormat::simple(FontId::proportional(13.0), ink)
    };
    let mut job = LayoutJob::default();
    let runs = session.runs.panes.iter().map(|pane| &pane.simulation);
    for (k, (name, formula)) in lines(runs).into_iter().enumerate() {
        let start = if k == 0 { "" } else { "\n" };
        job.append(&format!("{start}{name}   "), 0.0, format(FAINT));
        job.append(formula, 0.0, format(TEXT));
    }
    job.wrap.max_width = room.width() - 12.0;
    let galley = ui.painter().layout_job(job);
    let height = galley.size().y.min(SHARE * room.height());
    let is_alone = room.height() - height < MIN_CHART;
    let bottom = if is_alone { room.bottom() } else { room.top() + height };
    let place = room.with_max_y(bottom);
    ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        ScrollArea::vertical()
            .id_salt("formulas")
            .auto_shrink([false, false])
            .show(ui, |ui| ui.add(Label::new(galley).selectable(false)));
    });
    bottom + if is_alone { 0.0 } else { 8.0 }
}

#[cfg(test)]
mod tests {
    use a3_core::integrators;
    use egui::{FontId, RawInput};

    use super::*;
    use crate::hud::style::context;
    use crate::session::session;

    #[test]
    fn every_method_and_every_force_of_the_scenes_has_its_formula() {
        for method in integrators::METHODS {
            assert!(formula(METHODS, method.name).is_some(), "{}", method.name);
        }
        let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes");
        let files = std::fs::read_dir(docs).unwrap().map(|it| it.unwrap().path());
        let files = files.filter(|path| path.extension().is_some_and(|it| it == "toml"));
        let files = files.map(|path| path.to_str().unwrap().to_owned());
        let built_in = a3_scenes::SCENES.iter().map(|entry| entry.name.to_owned());
        // Three that none of these scenes has.
        let folder = tempfile::tempdir().unwrap();
        let (mesh, own) = (folder.path().join("a.obj"), folder.path().join("a.toml"));
        let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
        let sides = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
        std::fs::write(&mesh, [corners, sides].concat()).unwrap();
        let text = "[[mesh]]\nfile = \"a.obj\"\ndensity = 1\nstiffness = [60, 10]\npressure = 50\n\
            tension_only = true\nstrain_limit = 1.1\n";
        std::fs::write(&own, text).unwrap();
        let own = own.to_str().unwrap().to_owned();
        let mut seen = vec![];
        for scene in built_in.chain(files).chain([own]) {
            let session = session(&["--scene", &scene]);
            let lines = lines([session.runs.first()].into_iter());
            assert!(lines.iter().all(|line| !line.1.is_empty()), "{lines:?}");
            seen.extend(lines.into_iter().map(|line| line.0));
        }
        // Hands pull only in a window, and only a program adds forces of its own.
        let others = ["attraction", "own force"];
        let rows = [FORCES, AFTER].into_iter().flat_map(rows).map(|row| row.0);
        let rows = rows.filter(|name| !others.contains(name));
        let unseen: Vec<_> = rows.filter(|name| !seen.iter().any(|it| it == name)).collect();
        assert!(unseen.is_empty(), "{unseen:?}");
    }

    /// What acts after a step is no part of the sum of forces.
    #[test]
    fn forces_come_before_what_acts_after_a_step() {
        let session = session(&["--scene", "cloth"]);
        let lines = lines([session.runs.first()].into_iter());
        let at = |name: &str| lines.iter().position(|line| line.0 == name);
        let (forces, then) = (at("y' = f(t, y)").unwrap(), at("then").unwrap());
        assert_eq!(lines[then].1, "after each step:");
        let is_after = |line: &(String, _)| formula(AFTER, &line.0).is_some();
        assert!(!lines[forces..then].iter().any(is_after), "{lines:?}");
        assert!(then + 1 < lines.len() && lines[then + 1..].iter().all(is_after));
    }

    #[test]
    fn the_font_has_every_letter_of_the_formulas() {
        let ctx = context();
        let mut output = ctx.run_ui(RawInput::default(), |_| {});
        output.textures_delta.set.clear();
        output.textures_delta.free.clear();
        let font = FontId::proportional(12.5);
        let all = [METHODS, FORCES, AFTER].map(str::chars).into_iter().flatten();
        let lost: Vec<_> = all
            .filter(|c| *c != '\n' && !ctx.fonts_mut(|fonts| fonts.has_glyph(&font, *c)))
            .collect();
        assert!(lost.is_empty(), "{lost:?}");
    }
}
