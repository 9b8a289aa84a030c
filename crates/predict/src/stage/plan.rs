//! `crumple plan`: which second test would make a prediction of a run surer.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use crumple_signal::Spread;
use crumple_signal::value::Mass;
use crumple_stage::records::{CandidateV1, RecommendationV1};
use crumple_stage::{ExitStatus, Refused, Usage, load_artifacts, to_stdout};

use crate::plan::{SecondTest, expected_widths};
use crate::stage::inputs::{candidates, named, tested};
use crate::stage::options::speeds;
use crate::{Candidate, Inputs, Scenario};

/// Which second test would make a predicted crush surer, and by how much.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-plan",
    version,
    after_help = "Values typed by a person carry their unit: 64km/h, 1500kg.\n\
                  Exit codes: 0 done, 1 unforeseen failure, 2 usage, 3 input refused, 4 no acceptable result."
)]
pub struct PlanOptions {
    /// Folder of the run of the first test
    #[arg(value_name = "RUN")]
    run: PathBuf,
    /// What is wanted: "crush at 64km/h"
    #[arg(long, value_name = "WHAT")]
    want: String,
    /// Speeds of a second test, e.g. 40km/h,64km/h or 30..70/10 km/h [default: 0.6 to 1.4 times that of the first]
    #[arg(long, value_name = "SPEED", value_delimiter = ',')]
    speed: Vec<String>,
    /// Masses of a second test [default: that of the first]
    #[arg(long, value_name = "MASS", value_delimiter = ',')]
    mass: Vec<Mass>,
    /// Candidate that predicts [default: the recommended one]
    #[arg(long, value_name = "ID")]
    candidate: Option<String>,
}

/// Second tests where nobody names one: speeds over that of the first.
const SPEEDS: [f64; 5] = [0.6, 0.8, 1.0, 1.2, 1.4];

/// Prints the second tests, the one that helps most first. Errors: a run without candidates, what is wanted is no
/// crush at a speed.
pub fn plan(options: PlanOptions) -> anyhow::Result<ExitStatus> {
    let wanted_m_per_s = wanted(&options.want)?;
    let loaded = load_artifacts(&files(&options.run)?)?;
    let input = &loaded.input;
    let records: Vec<(String, CandidateV1)> = input.records("/parameters/")?;
    let choice: Option<RecommendationV1> = input.record_if("/recommendation")?;
    let all: Vec<Candidate> = candidates(&records, choice.as_ref());
    let asked: Vec<String> = options.candidate.iter().cloned().collect();
    if asked.is_empty() && choice.as_ref().is_some_and(|choice| choice.recommended.is_none()) {
        return Err(Refused::new("the run recommends no model").hint("--candidate ID names one").into());
    }
    let place = named(&all, &records, choice.as_ref(), &asked)?.first().map(|named| named.place);
    let place = place.ok_or_else(|| Refused::new("the run recommends no model").hint("--candidate ID names one"))?;
    let test =
        tested(input)?.ok_or_else(|| Refused::new("the run has no impact speed").hint("--impact-speed 56km/h"))?;
    let read = |text: &String| Ok::<_, Usage>(speeds(text)?.0);
    let mut asked_m_per_s: Vec<f64> =
        options.speed.iter().map(read).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    if asked_m_per_s.is_empty() {
        // Whole km/h, as tests are made.
        asked_m_per_s.extend(SPEEDS.map(|factor| (factor * test.speed_m_per_s * 3.6).round() / 3.6));
        asked_m_per_s.push(wanted_m_per_s);
        asked_m_per_s.sort_by(f64::total_cmp);
        asked_m_per_s.dedup_by(|a, b| (*a - *b).abs() < 0.5 / 3.6);
    }
    let masses: Vec<Option<f64>> =
        if options.mass.is_empty() { vec![None] } else { options.mass.iter().map(|mass| Some(mass.si())).collect() };
    let count = all[place].model.as_ref().map_or(1, |model| model.masses_kg().len());
    let sensors: &[bool] = if count > 1 { &[false, true] } else { &[false] };
    let mut second = Vec::new();
    for speed_m_per_s in asked_m_per_s {
        for mass_kg in &masses {
            second.extend(sensors.iter().map(|sees| SecondTest {
                speed_m_per_s,
                mass_kg: *mass_kg,
                sees_every_mass: *sees,
            }));
        }
    }
    let inputs = Inputs { speed_m_per_s: Spread::USUAL_SPEED.deviation(), ..Inputs::default() };
    let impact = Scenario { speed_m_per_s: wanted_m_per_s, partner_speed_m_per_s: 0.0, mass_kg: None };
    let (now_m, widths) = expected_widths(&all, place, &test, inputs, impact, &second)
        .map_err(|error| Refused::new(format!("{}: {error}", all[place].id)))?;
    let mut rows: Vec<(SecondTest, f64)> =
        second.into_iter().zip(widths).filter_map(|(test, width)| Some((test, width?))).collect();
    rows.sort_by(|a, b| a.1.total_cmp(&b.1));
    to_stdout(text(&all[place].id, (wanted_m_per_s, test.range_m_per_s.1), now_m, &rows).as_bytes())?;
    Ok(ExitStatus::Done)
}

/// The speed at which the crush is wanted, m/s.
fn wanted(text: &str) -> Result<f64, Usage> {
    let wrong =
        || Usage::new(format!("--want {text:?}: expected a crush at a speed")).hint("--want \"crush at 64km/h\"");
    let speed = text.trim().strip_prefix("crush at ").ok_or_else(wrong)?;
    match speeds(speed)?.0[..] {
        [speed] => Ok(speed),
        _ => Err(wrong()),
    }
}

/// The artifacts of a run that a prediction reads.
fn files(run: &Path) -> Result<Vec<PathBuf>, Usage> {
    let file = |name: &str| {
        let path = run.join(name);
        let problem = || Usage::new(format!("{} holds no {name}", run.display()));
        if path.is_file() { Ok(path) } else { Err(problem().hint("name the folder of a run: runs/NAME")) }
    };
    Ok(vec![file("3-integrate.mcap")?, file("5-parameter-solve.mcap")?])
}

fn text(id: &str, (wanted_m_per_s, tested_m_per_s): (f64, f64), now_m: f64, rows: &[(SecondTest, f64)]) -> String {
    let mut text = format!(
        "The 90 % interval of the crush at {:.0} km/h is {:.0} mm wide ({id}).\n\
         Expected after a second test:\n",
        3.6 * wanted_m_per_s,
        1e3 * now_m
    );
    for (test, width_m) in rows {
        let mass = test.mass_kg.map_or(String::new(), |kg| format!(", {kg:.0} kg"));
        let sensors = if test.sees_every_mass { ", a sensor on each mass" } else { "" };
        let _infallible = writeln!(
            text,
            "  {:>3.0} km/h{mass}{sensors}: {:.0} mm ({:+.0} %)",
            3.6 * test.speed_m_per_s,
            1e3 * width_m,
            100.0 * (width_m / now_m - 1.0)
        );
    }
    if wanted_m_per_s > tested_m_per_s * (1.0 + 1e-9) {
        let _infallible =
            writeln!(text, "The model extrapolates: no test was faster than {:.0} km/h.", 3.6 * tested_m_per_s);
    }
    text.push_str("All widths hold if this model is right; nobody has compared them with tests that were made.\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_widths_are_printed_as_they_are_and_what_is_beyond_the_tests_is_said() {
        let test = SecondTest { speed_m_per_s: 50.0 / 3.6, mass_kg: Some(1500.0), sees_every_mass: true };
        let said = |wanted_km_per_h: f64| text("kelvin/1", (wanted_km_per_h / 3.6, 56.0 / 3.6), 0.08, &[(test, 0.06)]);
        let within = said(56.0);
        assert!(within.starts_with("The 90 % interval of the crush at 56 km/h is 80 mm wide (kelvin/1)."), "{within}");
        assert!(within.contains("50 km/h, 1500 kg, a sensor on each mass: 60 mm (-25 %)"), "{within}");
        assert!(!within.contains("extrapolates"), "{within}");
        assert!(said(57.0).contains("The model extrapolates: no test was faster than 56 km/h."));
    }
}
