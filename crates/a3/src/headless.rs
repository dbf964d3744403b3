//! The window's job where there is no display: ten simulated seconds, a line a second, a picture at the end.

use a3_core::Simulation;
use a3_render::{Gpu, Offscreen};

use crate::show::Show;
use crate::{Failure, output, progress, render};

const SECONDS: u32 = 10;
const SIZE: (u32, u32) = (1280, 720);

/// `why` there is no window, and what is done instead.
pub fn run(why: &str, mut simulation: Simulation, mut show: Show) -> Result<(), Failure> {
    eprintln!("{why}: simulating {SECONDS} seconds without a window.");
    output::say("  time [s]   energy [J]   lowest [m]   stretch\n")?;
    output::say(&line(&simulation))?;
    for second in 1..=SECONDS {
        progress::advance(&mut simulation, f64::from(second), |simulation| {
            show.follow(simulation);
        })
        .map_err(Failure::run)?;
        output::say(&line(&simulation))?;
    }
    match pollster::block_on(Gpu::headless()) {
        Ok(gpu) => {
            let offscreen = Offscreen::new(&gpu, SIZE).map_err(Failure::run)?;
            let pixels = render::draw(&gpu, &offscreen, &simulation, &mut show, SIZE)?;
            let name = output::free_picture_name(simulation.scene().name)?;
            output::write(name.as_ref(), &output::png(&pixels, SIZE)?)?;
            output::say(&format!("picture: {name}\n"))?;
        }
        Err(why) => eprintln!("no picture: {why}"),
    }
    Ok(())
}

fn line(simulation: &Simulation) -> String {
    let number = |value: Option<f64>, digits: usize| {
        value.map_or("-".into(), |value| format!("{value:.digits$}"))
    };
    format!(
        "  {:>8.2}   {:>10}   {:>10.4}   {:>7}\n",
        simulation.time(),
        number(simulation.energy().map(|energy| energy.total()), 4),
        simulation.lowest(),
        number(simulation.largest_stretch(), 3),
    )
}
