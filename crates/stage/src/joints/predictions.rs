//! Rows of the joint of predict: what is asked, the interval, the test's own impact, and numbers that belong together.

use crumple_artifact::Artifact;
use crumple_artifact::records::{CandidateV1, PredictionV1, RecommendationV1, TestV1};
use crumple_signal::value::{Mass, Speed};
use crumple_signal::{About, Kind, Weight};

use crate::command_line::pipeline_file::Pipeline;
use crate::joints::candidates::{ADEQUATE, tested_crush_m, total_mass};
use crate::joints::{BESIDE, Finding, Invariant, RunParts, is_outside, record, records};

/// Rows of the stage.
pub(crate) static ROWS: [Invariant; 6] = [
    Invariant {
        kind: Kind {
            code: "CR701",
            weight: Weight::Decisive,
            explanation: [
                "A prediction lies outside of its own interval.",
                BESIDE,
                "The interval or the value is that of something else.",
                "write the interval of the value that is written",
            ],
        },
        ends_the_run: true,
        find: prediction_outside,
    },
    Invariant {
        kind: Kind {
            code: "CR702",
            weight: Weight::Decisive,
            explanation: [
                "Impact speed and mass of a prediction are no speed and no mass.",
                "Both are to be above zero.",
                "There is no such collision.",
                "write m/s and kg, both positive, in the program of the stage predict",
            ],
        },
        ends_the_run: true,
        find: no_collision,
    },
    Invariant {
        kind: Kind {
            code: "CR703",
            weight: Weight::Decisive,
            explanation: [
                "The prediction for the test's own speed and mass is not its crush.",
                "Predictions of an adequate candidate within 0.5 % of speed and mass of the test are compared with the \
                 dynamic crush of /events; 7 % is left, twice what an adequate candidate may miss.",
                "What it says of other speeds is wrong by at least as much.",
                "predict the crush of the candidate at the speed that is written, in m",
            ],
        },
        ends_the_run: true,
        find: own_test_is_predicted_otherwise,
    },
    Invariant {
        kind: Kind {
            code: "CR704",
            weight: Weight::Decisive,
            explanation: [
                "Numbers of one prediction contradict each other, or two predictions.",
                "Against the wall delta-v is the impact speed times one and the restitution, the energy at impact \
                 half the mass times the speed squared, and the crush at most speed times its time; 1 % is left of \
                 each, what programs round by. A candidate of one mass is crushed no less at a higher speed; 1 % is \
                 left.",
                "One of the numbers is of another collision, and which cannot be told.",
                "write the numbers of one collision in the program of the stage predict",
            ],
        },
        ends_the_run: true,
        find: contradicts_itself,
    },
    Invariant {
        kind: Kind {
            code: "CR705",
            weight: Weight::Decisive,
            explanation: [
                "A prediction goes beyond the test and says that it does not extrapolate.",
                "Energy and crush of predictions against the wall are compared with those of the test: 15 % more \
                 energy and 7 % more crush, twice what an adequate candidate may miss, are beyond it. Not asked of a \
                 fit to several tests.",
                "No part of the record shows what the structure does there: the number is less sure than it says.",
                "set extrapolates where the structure is crushed further than in the test",
            ],
        },
        ends_the_run: false,
        find: hides_that_it_extrapolates,
    },
    Invariant {
        kind: Kind {
            code: "CR706",
            weight: Weight::Decisive,
            explanation: [
                "Predictions that were asked for are missing, or others stand in their place.",
                "Speeds and masses of the table [predict] of the pipeline are looked for among the predictions of the \
                 recommended candidate; 0.5 % is left. Without a mass it is that of the test. Not asked where \
                 7-predict states options of its own.",
                "The number that somebody looks for is not there, or that beside it is of another impact.",
                "predict every speed of the pipeline: the program of the stage predict is given its file by --pipeline",
            ],
        },
        ends_the_run: false,
        find: was_not_asked_for,
    },
];

/// Share by which speed and mass of a prediction may differ from those of the test, to be its own.
const SAME: f64 = 5e-3;

fn own_test_is_predicted_otherwise(parts: &RunParts<'_>) -> Vec<Finding> {
    let (Some(solved), Some(predicted)) = (parts.of("parameter-solve"), parts.of("predict")) else {
        return Vec::new();
    };
    let (Some(tested_m), Some(test), Some(choice)) = (
        tested_crush_m(parts),
        record::<TestV1>(solved, "/test"),
        record::<RecommendationV1>(solved, "/recommendation"),
    ) else {
        return Vec::new();
    };
    let Some((mass_kg, speed)) = test.mass_kg.zip(test.impact_speed_m_per_s) else { return Vec::new() };
    let is_adequate = |id: &str| choice.candidates.iter().any(|rated| rated.id == id && rated.adequate);
    // Masses that were given to parameter-solve are those of another test.
    let is_of_the_test = |id: &str| {
        let candidate = record::<CandidateV1>(solved, &format!("/parameters/{id}"));
        candidate.and_then(|candidate| total_mass(&candidate)).is_some_and(|total| is_near(total, mass_kg))
    };
    let of_the_test = records::<PredictionV1>(predicted, "/prediction/").find_map(|(number, prediction)| {
        let is_own = prediction.partner.is_none()
            && is_near(prediction.impact_speed_m_per_s, speed)
            && is_near(prediction.mass_kg, mass_kg)
            && is_adequate(&prediction.candidate)
            && is_of_the_test(&prediction.candidate);
        let crush_m = prediction.dynamic_crush_m.filter(|_| is_own)?;
        ((crush_m - tested_m).abs() > 2.0 * ADEQUATE * tested_m).then(|| (number.to_owned(), crush_m))
    });
    let Some((number, crush_m)) = of_the_test else { return Vec::new() };
    let text = format!(
        "prediction {number} is of the speed and the mass of the test, {:.0} mm, and the crush of the test {:.0} mm",
        crush_m * 1e3,
        tested_m * 1e3
    );
    let values = vec![("predicted_m", crush_m), ("tested_m", tested_m)];
    vec![Finding { stage: "predict", about: About::Predictions, values, text }]
}

fn prediction_outside(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(artifact) = parts.of("predict") else { return Vec::new() };
    for (number, prediction) in records::<PredictionV1>(artifact, "/prediction/") {
        let fields = serde_json::to_value(&prediction).unwrap_or_default();
        let value = |name: &str| fields.pointer(&format!("/{}", name.replace('.', "/")))?.as_f64();
        let stated =
            prediction.intervals.iter().filter_map(|i| Some((i.name.as_str(), value(&i.name)?, i.low, i.high)));
        let Some((name, value, low, high)) = stated.into_iter().find(|(_, v, low, high)| is_outside(*v, *low, *high))
        else {
            continue;
        };
        let text = format!("{name} of prediction {number} is {value:.4}, its interval {low:.4} to {high:.4}");
        let values = vec![("value", value), ("low", low), ("high", high)];
        return vec![Finding { stage: "predict", about: About::Predictions, values, text }];
    }
    Vec::new()
}

fn no_collision(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(artifact) = parts.of("predict") else { return Vec::new() };
    let found = records::<PredictionV1>(artifact, "/prediction/")
        .map(|(_, prediction)| (prediction.impact_speed_m_per_s, prediction.mass_kg))
        .find(|(speed, mass)| !(*speed > 0.0 && *mass > 0.0));
    let Some((speed, mass)) = found else { return Vec::new() };
    let text = format!("a prediction is of {mass:.1} kg at {speed:.2} m/s");
    let values = vec![("mass_kg", mass), ("speed_m_per_s", speed)];
    vec![Finding { stage: "predict", about: About::Predictions, values, text }]
}

/// Share that numbers of one prediction may be apart, which programs round by.
const ROUNDED: f64 = 0.01;

fn contradicts_itself(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(artifact) = parts.of("predict") else { return Vec::new() };
    let predictions: Vec<(&str, PredictionV1)> = records(artifact, "/prediction/").collect();
    let against_the_wall = predictions.iter().filter(|(_, prediction)| prediction.partner.is_none());
    let alone = against_the_wall.filter_map(|(number, prediction)| {
        let ((what, unit), says, of) = within_one(prediction)?;
        let text =
            format!("the {what} of prediction {number} is {says:.4} {unit}, its other numbers give {of:.4} {unit}");
        Some(Finding { stage: "predict", about: About::Predictions, values: vec![("says", says), ("of", of)], text })
    });
    alone.chain(falls_with_speed(&predictions)).take(1).collect()
}

/// What a prediction says, and what follows from its other numbers.
fn within_one(prediction: &PredictionV1) -> Option<((&'static str, &'static str), f64, f64)> {
    let (speed, mass_kg) = (prediction.impact_speed_m_per_s, prediction.mass_kg);
    let change = prediction.delta_v_m_per_s.zip(prediction.coefficient_of_restitution);
    let change = change.map(|(change, restitution)| (("delta-v", "m/s"), change, speed * (1.0 + restitution)));
    let energy = prediction.energy.as_ref().map(|energy| energy.kinetic_at_impact_j);
    let energy = energy.map(|joule| (("kinetic energy at impact", "J"), joule, 0.5 * mass_kg * speed * speed));
    let crush = prediction.dynamic_crush_m.zip(prediction.time_of_dynamic_crush_s);
    // No structure is crushed by more than the way of the vehicle.
    let crush = crush.map(|(crush_m, time_s)| (("dynamic crush", "m"), crush_m, crush_m.min(speed * time_s)));
    let differs = |(_, says, of): &((&str, &str), f64, f64)| (says - of).abs() > ROUNDED * says.abs().max(of.abs());
    [change, energy, crush].into_iter().flatten().find(differs)
}

/// A candidate that is crushed less by more speed.
fn falls_with_speed(predictions: &[(&str, PredictionV1)]) -> Option<Finding> {
    let pairs = predictions.iter().flat_map(|a| predictions.iter().map(move |b| (&a.1, &b.1)));
    let (slow_m, fast_m, slow, fast) = pairs.into_iter().find_map(|(slow, fast)| {
        let is_pair = slow.candidate == fast.candidate
            && slow.partner.is_none()
            && fast.partner.is_none()
            && is_near(slow.mass_kg, fast.mass_kg)
            && slow.impact_speed_m_per_s < fast.impact_speed_m_per_s;
        let (slow_m, fast_m) = slow.dynamic_crush_m.zip(fast.dynamic_crush_m).filter(|_| is_pair)?;
        (fast_m < (1.0 - ROUNDED) * slow_m).then_some((slow_m, fast_m, slow, fast))
    })?;
    let text = format!(
        "{} is crushed by {:.0} mm at {:.2} m/s and by {:.0} mm at {:.2} m/s",
        slow.candidate,
        slow_m * 1e3,
        slow.impact_speed_m_per_s,
        fast_m * 1e3,
        fast.impact_speed_m_per_s
    );
    let values = vec![("slow_m", slow_m), ("fast_m", fast_m)];
    Some(Finding { stage: "predict", about: About::Predictions, values, text })
}

/// Energy of a prediction over that of the test beyond which it says more than the test shows.
const BEYOND: f64 = 1.15;

fn hides_that_it_extrapolates(parts: &RunParts<'_>) -> Vec<Finding> {
    let (Some(solved), Some(predicted)) = (parts.of("parameter-solve"), parts.of("predict")) else {
        return Vec::new();
    };
    let is_of_several = solved.records().iter().any(|raw| raw.topic == "/tests");
    let Some((tested_m, test)) = tested_crush_m(parts).zip(record::<TestV1>(solved, "/test")) else {
        return Vec::new();
    };
    let Some((mass_kg, speed)) = test.mass_kg.zip(test.impact_speed_m_per_s).filter(|_| !is_of_several) else {
        return Vec::new();
    };
    let energy = |mass_kg: f64, speed: f64| 0.5 * mass_kg * speed * speed;
    let hidden = records::<PredictionV1>(predicted, "/prediction/").find_map(|(number, prediction)| {
        let is_beyond = energy(prediction.mass_kg, prediction.impact_speed_m_per_s) > BEYOND * energy(mass_kg, speed);
        let crush_m = prediction.dynamic_crush_m.filter(|_| is_beyond && prediction.partner.is_none())?;
        let is_hidden = !prediction.extrapolates && crush_m > (1.0 + 2.0 * ADEQUATE) * tested_m;
        is_hidden.then(|| (number.to_owned(), crush_m))
    });
    let Some((number, crush_m)) = hidden else { return Vec::new() };
    let text = format!(
        "prediction {number} is of {:.0} mm and says that it does not extrapolate, the test ends at {:.0} mm",
        crush_m * 1e3,
        tested_m * 1e3
    );
    let values = vec![("predicted_m", crush_m), ("tested_m", tested_m)];
    vec![Finding { stage: "predict", about: About::Predictions, values, text }]
}

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * b.abs()
}

/// What somebody asked to be predicted.
struct Asked {
    speeds_m_per_s: Vec<f64>,
    masses_kg: Vec<f64>,
}

impl Asked {
    /// What the pipeline lists; `None` where it lists no speeds against the wall, or the artifact states options of its
    /// own.
    fn of(artifact: &Artifact, pipeline: Option<&Pipeline>) -> Option<Self> {
        // A program of the project says itself what it leaves out, and is called with other options too.
        let options = artifact.provenance().and_then(|made| serde_json::from_str(&made.config_json).ok());
        if options.is_some_and(|options: serde_json::Value| options.get("speeds_m_per_s").is_some()) {
            return None;
        }
        let table = pipeline?.table("predict")?;
        let texts = |key: &str| {
            let list = table.get(key).and_then(toml::Value::as_array);
            list.into_iter().flatten().filter_map(toml::Value::as_str).collect::<Vec<_>>()
        };
        // Ranges, closing speeds and partners are read by the stage alone.
        let others = ["speed", "closing_speed", "closing-speed", "partner", "candidate"];
        let is_plain = !others.iter().any(|key| table.contains_key(*key));
        let speeds: Result<Vec<Speed>, _> = texts("speeds").into_iter().map(str::parse).collect();
        let masses: Result<Vec<Mass>, _> = texts("mass").into_iter().map(str::parse).collect();
        let speeds = speeds.ok().filter(|speeds| is_plain && !speeds.is_empty())?;
        Some(Self {
            speeds_m_per_s: speeds.iter().map(|speed| speed.si()).collect(),
            masses_kg: masses.ok()?.iter().map(|mass| mass.si()).collect(),
        })
    }
}

fn was_not_asked_for(parts: &RunParts<'_>) -> Vec<Finding> {
    let (Some(solved), Some(predicted)) = (parts.of("parameter-solve"), parts.of("predict")) else {
        return Vec::new();
    };
    let choice = record::<RecommendationV1>(solved, "/recommendation");
    let (Some(id), Some(asked)) = (choice.and_then(|choice| choice.recommended), Asked::of(predicted, parts.pipeline))
    else {
        return Vec::new();
    };
    let mut masses_kg = asked.masses_kg;
    if masses_kg.is_empty() {
        masses_kg.extend(record::<TestV1>(solved, "/test").and_then(|test| test.mass_kg));
    }
    let made: Vec<(f64, f64)> = records::<PredictionV1>(predicted, "/prediction/")
        .filter(|(_, prediction)| prediction.candidate == id && prediction.partner.is_none())
        .map(|(_, prediction)| (prediction.impact_speed_m_per_s, prediction.mass_kg))
        .collect();
    let impacts = asked.speeds_m_per_s.iter().flat_map(|speed| masses_kg.iter().map(|mass_kg| (*speed, *mass_kg)));
    let is_made = |(speed, mass_kg): &(f64, f64)| made.iter().any(|m| is_near(m.0, *speed) && is_near(m.1, *mass_kg));
    let missing: Vec<(f64, f64)> = impacts.filter(|impact| !is_made(impact)).collect();
    let Some((speed, mass_kg)) = missing.first().copied() else { return Vec::new() };
    let others = match missing.len() - 1 {
        0 => String::new(),
        more => format!(", nor of {more} more that were asked for"),
    };
    let text = format!("there is no prediction of {mass_kg:.0} kg at {:.1} km/h{others}", speed * 3.6);
    let values = vec![("mass_kg", mass_kg), ("speed_m_per_s", speed), ("missing", missing.len() as f64)];
    vec![Finding { stage: "predict", about: About::Predictions, values, text }]
}
