//! The curves of test and simulations over each other, and the ratio of force by segment.

use super::segments::{REPEAT_SCATTER, Segment};
use super::validation::{Side, Validation};
use crate::drawing::numbers::{G_PER_M_PER_S2, KILO, KM_PER_H_PER_M_PER_S, MILLI};
use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, Width, over_time};
use crate::figures::crash::curves::view_ms;
use crate::figures::time_view::{ACCELERATION, FORCE, Titled, VELOCITY, over_time_axis};
use crumple_signal::Sampled;

/// Velocity, acceleration and wall force over time, wall force over crush, energies, ratio by segment.
pub fn figures(tests: &[Side<'_>], simulations: &[Side<'_>], validations: &[Validation]) -> Vec<Figure> {
    let mut curves = Figure::new("validation", "Test and simulation");
    let of_test = |k: usize| Look::line(Colour::Test, [Dash::Solid, Dash::Dashed][k.min(1)]).width(Width::Thick);
    let looks = (0..tests.len()).map(of_test).chain((0..simulations.len()).map(Look::of_series));
    let sides = tests.iter().chain(simulations).zip(looks);
    let sides: Vec<(&Side<'_>, usize)> =
        sides.map(|(side, look)| (side, curves.entry(side.run.name.clone(), look, true))).collect();
    type Wave = for<'a> fn(&'a Side<'_>) -> Option<&'a Sampled>;
    let waves: [(Titled, f64, Wave); 3] = [
        (VELOCITY, KM_PER_H_PER_M_PER_S, |side| side.run.run.measured.velocity.as_ref()),
        (ACCELERATION, G_PER_M_PER_S2, |side| side.run.run.acceleration()),
        (("wall force", "kN"), KILO, |side| side.run.run.measured.barrier_force.as_ref()),
    ];
    let view = view_ms(&tests[0].run.run);
    for (title, factor, wave) in waves {
        let mut panel = over_time_axis(view, Axis::of(title));
        for (side, entry) in &sides {
            wave(side).into_iter().for_each(|wave| panel.line(*entry, over_time(wave, factor)));
        }
        curves.panels.push(panel);
    }
    let mut over_crush = Panel::new(Axis::of(("crush", "mm")), Axis::of(FORCE));
    // A force of the wall beside a mass times a deceleration would look like a difference.
    let by_wall = sides.iter().all(|(side, _)| side.run.run.measured.barrier_force.is_some());
    for (side, entry) in &sides {
        over_crush.line(*entry, force_over_crush(side, by_wall).unwrap_or_default());
    }
    curves.panels.push(over_crush);
    curves.caption = "Time from contact. Force over crush: that of the wall where all runs have one, else mass \
                      times deceleration; up to the end of crush."
        .to_owned();
    let mut energies = Figure::new("energies", "Energies of the simulation");
    for side in simulations {
        let mut panel = over_time_axis(view, Axis::of((side.run.name.as_str(), "kJ")));
        for (k, (name, wave)) in side.model.0.iter().filter(|(name, _)| name.ends_with("_energy")).enumerate() {
            if wave.samples().iter().any(|x| *x != 0.0) {
                let kind = name.trim_end_matches("_energy").replace('_', " ");
                let title =
                    if simulations.len() > 1 { format!("{}, {kind}", side.run.name) } else { format!("{kind} energy") };
                let entry = energies.entry(title, Look::of_series(k), true);
                panel.line(entry, over_time(wave, KILO));
            }
        }
        energies.panels.push(panel);
    }
    let all = [curves, energies, ratio(validations)];
    all.into_iter().map(Figure::tidy).filter(|figure| !figure.panels.is_empty()).collect()
}

fn force_over_crush(side: &Side<'_>, by_wall: bool) -> Option<Vec<[f64; 2]>> {
    let run = &side.run.run;
    let x = run.measured.displacement.as_ref()?;
    let end_s = run.time_of_crush_s()?;
    let mass_kg = run.test.mass_kg;
    let force = |t: f64| match run.measured.barrier_force.as_ref().filter(|_| by_wall) {
        Some(force) => force.at(t),
        None => Some(-mass_kg? * run.acceleration()?.at(t)?),
    };
    let inside = x.times_s().zip(x.samples()).filter(|(t, _)| (0.0..=end_s).contains(t));
    Some(inside.filter_map(|(t, x)| Some([MILLI * x, KILO * force(t)?])).collect())
}

/// The ratio of mean force by segment with its interval.
fn ratio(validations: &[Validation]) -> Figure {
    let mut figure = Figure::new("ratio", "Force of the simulation over that of the test, by segment");
    let mut panel = Panel::new(Axis::of(("crush", "mm")), Axis::new("ratio"));
    let mut series = 0;
    for one in validations {
        let all: [(&str, &[Segment]); 2] = [("wall force", &one.wall), ("deceleration", &one.deceleration)];
        for (what, segments) in all.into_iter().filter(|(_, segments)| !segments.is_empty()) {
            let entry = figure.entry(format!("{}, {what}", one.name), Look::of_series(series), true);
            series += 1;
            let known: Vec<(&Segment, [f64; 3])> =
                segments.iter().filter_map(|one| Some((one, [one.ratio?, one.low?, one.high?]))).collect();
            let ends = |segment: &Segment| [MILLI * segment.from_m, MILLI * segment.to_m];
            panel.line(entry, known.iter().flat_map(|(s, [ratio, ..])| ends(s).map(|x| [x, *ratio])).collect());
            let band: Vec<[f64; 3]> =
                known.iter().flat_map(|(s, [_, low, high])| ends(s).map(|x| [x, *low, *high])).collect();
            panel.band(entry, &band);
        }
    }
    let end = validations.iter().flat_map(|one| &one.deceleration).map(|s| MILLI * s.to_m).fold(0.0, f64::max);
    if end > 0.0 {
        let entry = figure.entry("two equal tests", Look::line(Colour::Muted, Dash::Dotted), true);
        for limit in [1.0 - REPEAT_SCATTER, 1.0 + REPEAT_SCATTER] {
            panel.line(entry, vec![[0.0, limit], [end, limit]]);
        }
    }
    figure.panels.push(panel);
    figure.caption = "Bands: 90 % intervals by the error of the test's sensor. Two tests of equal cars are taken to \
                      differ by up to 5 %."
        .to_owned();
    figure
}
