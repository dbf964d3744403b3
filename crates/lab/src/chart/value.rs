//! A chart as a value: the runs of methods on a scene, their table, their picture and their data,
//! up to the time to which the motion of the scene can be predicted.

use a3_core::accuracy::{Frames, Horizon, Metric, Scope, horizon};
use a3_core::{Control, Method, Scene};
use a3_files::bounds::FACTORS;
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_files::report::Report;
use a3_files::rows;
use a3_plot::{Figure, WorkPrecision};

use super::asked::{Label, check_methods, check_metric, check_scene, check_until};
use super::measure::{Chart, Measured, Study, stiffened};
use super::record::{Data, Each, Record};
use super::{picture, table};

/// Options of a [chart](chart()).
#[derive(Clone, Debug, PartialEq)]
pub struct ChartOptions {
    /// End of the runs (s), from 0.01 to 1000, or from 1e-15 to 1e15 on a system of one's own; by
    /// default as long as errors mean something on the scene.
    pub until: Option<f64>,
    /// Error that counts; by default that of the positions or, without particles, of the state.
    pub error: Option<Metric>,
    /// The only particle whose position and phase count, or the only number of a system without
    /// particles; by default all.
    pub particle: Option<usize>,
    /// Whether the error at the end counts, instead of the largest one.
    pub at_end: bool,
    /// Whether computing times are measured and drawn, instead of evaluations.
    pub timed: bool,
    /// Whether adaptive methods are also run at neighbouring tolerances, which shows how much their
    /// errors vary.
    pub spread: bool,
    /// Factors of the stiffness of all springs, from 1e-6 to 1e6, with a panel for each; 1 for the
    /// scene itself, and for scenes without springs.
    pub stiffness: Vec<f64>,
}

impl Default for ChartOptions {
    fn default() -> Self {
        Self {
            until: None,
            error: None,
            particle: None,
            at_end: false,
            timed: false,
            spread: false,
            stiffness: vec![1.0],
        }
    }
}

/// Measures a chart of these methods on a scene, as `a3 chart` does; of all methods of the table
/// that support the scene, if there are none.
///
/// Runs are measured one at a time, so that their computing times are comparable. If the monitor
/// stops them, the chart has those that were measured until then.
///
/// # Errors
/// A method does not support the scene, two have the same name, an option is out of range or makes
/// no sense on the scene, nothing moves, the reference blows up, a callback fails, or the monitor
/// stopped before the first run ended.
pub fn chart(
    scene: &Scene,
    methods: &[&'static Method],
    options: &ChartOptions,
    monitor: &dyn Monitor,
) -> Result<Chart, Failure> {
    check_scene(scene)?;
    let methods = check_methods(scene, methods)?;
    let data = Data::open(None)?;
    let mut chart = Chart::begin(scene, &Label::of(scene), methods, options, data, monitor)?;
    chart.measure(monitor)?;
    chart.finish()?;
    Ok(chart)
}

impl Chart {
    /// Checks the options, and finds the end of the runs, which are added to these data. With a
    /// study for each stiffness, all end at the shortest of their horizons.
    pub fn begin(
        scene: &Scene,
        label: &Label,
        methods: Vec<&'static Method>,
        options: &ChartOptions,
        data: Data,
        monitor: &dyn Monitor,
    ) -> Result<Self, Failure> {
        let metric = options.error.unwrap_or(Metric::of_motion(&scene.model));
        check_metric(metric, scene)?;
        let scope = Scope { particle: options.particle, at_end: options.at_end };
        let scope = scope.checked(&scene.model).map_err(Failure::usage)?;
        let mut until = check_until(scene, options.until)?;
        let mut scenes = vec![];
        for &factor in &options.stiffness {
            FACTORS.check(factor)?;
            monitor.stage("looking ahead");
            let scene = stiffened(scene, factor)?;
            let Some(found) = look_ahead(&scene, options.until, factor, monitor)? else {
                continue;
            };
            check_motion(&scene, &found)?;
            until = Some(until.map_or(found.until, |until: f64| until.min(found.until)));
            scenes.push((factor, scene, found.motion));
        }
        let until = until.filter(|_| !scenes.is_empty()).ok_or_else(Failure::stopped)?;
        let measured = Measured { timed: options.timed, spread: options.spread };
        let studies = scenes.into_iter().map(|(factor, scene, motion)| {
            let of = (metric, scope, motion);
            Study::new(scene, label, factor, until, &methods, of, measured)
        });
        Ok(Self {
            studies: studies.collect(),
            data,
            methods,
            metric,
            timed: options.timed,
            title: label.title.clone(),
            complete: false,
        })
    }

    /// Measures the runs that the data lack.
    pub fn measure(&mut self, monitor: &dyn Monitor) -> Result<(), Failure> {
        let mut expected = 0.0;
        for study in &self.studies {
            expected += study.expected()?;
        }
        monitor.expect(expected);
        self.complete = true;
        for study in &mut self.studies {
            if Failure::unless_stopped(study.run(&mut self.data, monitor))?.is_none() {
                self.complete = false;
                break;
            }
        }
        monitor.clear();
        Ok(())
    }

    /// Writes the measured runs to the files of the data.
    pub fn save(&mut self) -> Result<(), Failure> {
        self.data.runs.save()?;
        self.data.each.take().map_or(Ok(()), Each::finish)
    }

    /// Returns the times at which errors are taken.
    pub fn frames(&self) -> Frames {
        self.studies[0].frames
    }

    /// Leaves out the studies without any run.
    ///
    /// # Errors
    /// None is left.
    pub fn finish(&mut self) -> Result<(), Failure> {
        let data = &self.data;
        let costly = self.studies.iter().flat_map(|study| &study.too_costly);
        let costly: Vec<_> = costly.map(|method| method.name).collect();
        self.studies.retain(|study| study.records(data).next().is_some());
        match (self.studies.is_empty(), &costly[..]) {
            (false, _) => Ok(()),
            (true, []) => Err(Failure::stopped()),
            (true, costly) => Err(Failure::run(format!(
                "runs take too many evaluations ({}): name a solver for stiff systems, such as radau or bdf, or \
                 end the runs earlier",
                costly.join(", ")
            ))),
        }
    }

    /// Returns the runs: by stiffness, and in the order in which they were measured.
    pub fn runs(&self) -> impl Iterator<Item = &Record> {
        self.studies
            .iter()
            .flat_map(|study| study.records(&self.data).chain(study.beside(&self.data)))
    }

    /// Returns the methods, in the order of the table and of the legend.
    #[must_use]
    pub fn methods(&self) -> &[&'static Method] {
        &self.methods
    }

    /// Returns the error that counts.
    #[must_use]
    pub fn metric(&self) -> Metric {
        self.metric
    }

    /// Returns the end of the runs (s).
    #[must_use]
    pub fn until(&self) -> f64 {
        self.studies[0].frames.until
    }

    /// Returns the methods whose ladder of steps or tolerances ended, or did not begin, because
    /// a run takes too many evaluations: on systems of one's own alone.
    #[must_use]
    pub fn too_costly(&self) -> &[&'static Method] {
        &self.studies[0].too_costly
    }

    /// Returns whether all runs were measured; false if the monitor stopped them.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.complete
    }

    /// Returns the tables as text: the cost of each method for each error, and the cheapest method.
    #[must_use]
    pub fn table(&self) -> String {
        let reports = self.reports();
        reports.iter().map(Report::text).collect()
    }

    /// Returns the work-precision diagram, which may be changed before it is drawn.
    #[must_use]
    pub fn picture(&self) -> WorkPrecision {
        picture::chart(self)
    }

    /// Returns the diagram with the curves that the command draws by default: those of methods that
    /// are cheapest for some error, and of a few others.
    pub fn best_picture(&self) -> WorkPrecision {
        let mut diagram = self.picture();
        picture::keep_best(&mut diagram, &self.methods, &self.studies[0].scene);
        diagram
    }

    /// Returns the table of the first study with advice, and the diagram that the command draws by
    /// default.
    pub fn best(&self) -> (Report, WorkPrecision) {
        let mut report = self.reports().swap_remove(0);
        report.foot += &self.advice();
        (report, self.best_picture())
    }

    /// Returns the method and the step or tolerance of each run in the first panel of a diagram of
    /// this chart, by curve.
    pub fn runs_in(&self, diagram: &WorkPrecision) -> Vec<Vec<(&'static Method, Control)>> {
        let records: Vec<_> = self.studies[0].records(&self.data).collect();
        let curves = diagram.problems[0].curves.iter();
        let runs_of = |method: &&'static Method| {
            let drawn = picture::drawn(&records, method, self.metric).into_iter();
            drawn.map(|r| (*method, method.control(r.setting))).collect()
        };
        curves
            .map(|curve| {
                let method = self.methods.iter().find(|m| m.title == curve.name);
                method.map(runs_of).unwrap_or_default()
            })
            .collect()
    }

    /// Advises an earlier end where the reference becomes much worse from some time on.
    pub fn advice(&self) -> String {
        let known = self.studies.iter().filter_map(table::advice);
        match self.metric {
            Metric::Position => known.collect(),
            _ => String::new(),
        }
    }

    /// Draws the diagram on a sheet of this width and height (px, 96 to the inch), for SVG, PDF or
    /// PNG.
    ///
    /// # Errors
    /// It does not fit on the sheet, or no run can be drawn.
    pub fn figure(&self, width: u32, height: u32) -> Result<Figure, Failure> {
        let figure = self.picture().draw(f64::from(width), f64::from(height));
        figure.map_err(Failure::usage)
    }

    /// Returns the runs as CSV, as `a3 chart --data` writes them.
    ///
    /// # Errors
    /// Never for runs that were measured.
    pub fn csv(&self) -> Result<String, Failure> {
        self.text(false)
    }

    /// Returns the runs as a JSON array of objects, as `a3 chart --data` writes them.
    ///
    /// # Errors
    /// Never for runs that were measured.
    pub fn json(&self) -> Result<String, Failure> {
        self.text(true)
    }

    fn text(&self, json: bool) -> Result<String, Failure> {
        let runs: Vec<_> = self.runs().cloned().collect();
        rows::write(&runs, json).map_err(Failure::run)
    }
}

/// Growth of a small difference from which on it is told.
const MIN_GROWTH: f64 = 2.0;

/// Finds the time up to which the motion of a scene can be predicted. `until` of the result is the
/// end of the runs: `asked` (s), or else that time. Notes the end and its reason if it was not
/// asked for, and warns of one that is too late. `None` if the monitor stopped it.
pub fn look_ahead(
    scene: &Scene,
    asked: Option<f64>,
    stiffness: f64,
    monitor: &dyn Monitor,
) -> Result<Option<Horizon>, Failure> {
    let longest = asked.unwrap_or(f64::INFINITY);
    let Some(found) = horizon(scene, longest, &|| monitor.go_on()).map_err(Failure::run)? else {
        return Ok(None);
    };
    let Horizon { until, lyapunov, growth, buckles, .. } = found;
    let of = if stiffness == 1.0 {
        scene.name.clone()
    } else {
        format!("{} at {stiffness} times its stiffness", scene.name)
    };
    let network = scene.model.network();
    let is_sheet = network.is_some_and(|network| !network.triangles().is_empty());
    let why = if buckles && is_sheet {
        format!(
            "compressed springs buckle out of the plane of the motion, and errors grow e-fold every {lyapunov:.2} s"
        )
    } else if buckles {
        format!("the motion leaves its plane, and errors grow e-fold every {lyapunov:.2} s")
    } else if lyapunov.is_finite() {
        format!("errors grow by themselves e-fold every {lyapunov:.2} s (Lyapunov time)")
    } else if growth > MIN_GROWTH {
        format!("small differences grow {growth:.0}-fold by themselves in {until} s")
    } else {
        "small differences hardly grow by themselves".to_owned()
    };
    match asked {
        Some(asked) if asked > until * (1.0 + 1e-9) && lyapunov.is_finite() => {
            let what = if network.is_some() { "an error in position" } else { "an error" };
            monitor.warn(&format!(
                "warning: {of}: {why}: past {until} s {what} says little: compare the energy, or \
                 leave out --until"
            ));
        }
        Some(_) => {}
        None => monitor.note(&format!("{of}: {why}; runs of {until} s"))?,
    }
    Ok(Some(Horizon { until: asked.unwrap_or(until), ..found }))
}

/// Checks that something moves in the scene.
pub fn check_motion(scene: &Scene, horizon: &Horizon) -> Result<(), Failure> {
    if horizon.motion > 0.0 {
        return Ok(());
    }
    let system = scene.model.system();
    let mut rates = vec![0.0; system.dim()];
    system.eval_f(0.0, &scene.state, &mut rates);
    if let Some(k) = rates.iter().position(|rate| !rate.is_finite()) {
        return Err(Failure::usage(format!(
            "the rate of change of number {k} of {} is not finite at its start",
            scene.name
        )));
    }
    Err(Failure::usage(format!(
        "nothing moves in {} within {} s, so there are no errors to measure: give something a velocity or a force, or \
         ask for a longer --until",
        scene.name, horizon.until
    )))
}
