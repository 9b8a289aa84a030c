//! One model for several tests: their records, the joint candidates, the choice among them.

use crumple_lumped_fit::{Comparison, FitQuantity, JointTest, RateFactorSource, Sensor, fit_together};
use crumple_signal::{About, Axis, Measurement, Sampled, TestDescription, Weight, remarks};
use crumple_stage::records::{EventsV1, JointTestV1, SourceV1, TestV1, TestsV2};
use crumple_stage::{Inputs, Outcome, Output, RefuseExt, Usage, option};

use crate::stage::assess::{assess_each, assess_fit};
use crate::stage::comparison::measured_test;
use crate::stage::inputs::{Record, motion, not_slowed, pulse_displacement, see, sensors_of, test_data};
use crate::stage::recommendation::recommend;
use crate::stage::records::write_candidates;
use crate::stage::settings::StageSettings;

/// What the artifacts say of one of the tests.
struct OneTest<'a> {
    name: &'a str,
    input: &'a Inputs,
    described: TestDescription,
    events: EventsV1,
    record: Record,
    /// Acceleration of the pulse, where it is at hand.
    acceleration: Option<(Sampled, Measurement)>,
}

/// Fits, assesses, chooses and writes: `/test` of the joint model, `/tests`, `/parameters/...`, `/recommendation`.
pub fn from_several(settings: &StageSettings, tests: &[(String, Inputs)], out: &mut Output) -> anyhow::Result<Outcome> {
    refuse_what_is_of_one_test(settings)?;
    let tests =
        tests.iter().map(|(name, input)| read(settings, name, input, out)).collect::<anyhow::Result<Vec<_>>>()?;
    let sensors: Vec<Vec<Sensor<'_>>> = tests.iter().map(|test| sensors_of(&test.record)).collect();
    let names: Vec<String> = tests.iter().map(|test| format!("{}:{}", test.name, test.events.channel)).collect();
    let joint: Vec<JointTest<'_>> = tests
        .iter()
        .zip(&sensors)
        .zip(&names)
        .map(|((test, sensors), name)| JointTest {
            name,
            data: test_data(&test.record, &test.events, sensors),
            acceleration: test.acceleration.as_ref().map(|(wave, measurement)| (wave, *measurement)),
        })
        .collect();
    let reference = &tests[JointTest::deepest(&joint)];
    let record_of_tests = tests_record(&tests);
    out.put("/test", &joint_test(&tests, reference))?;
    out.put("/tests", &record_of_tests)?;
    if let Some(reason) = tests.iter().find_map(without_crush) {
        return Ok(Outcome::NoAcceptableResult(reason));
    }
    warn_of_the_rate(&record_of_tests, out);
    let fitted = fit_together(&joint, &settings.solve, out.notes());
    let mut candidates = fitted.refuse_with_hint(see(&["models", "fit-from", "fit-to"]))?;
    let asked = &settings.assessment;
    assess_each(&mut candidates, asked, out, |candidate| assess_fit(candidate, asked, None));
    let compared = tests
        .iter()
        .map(|test| {
            let Record { displacement, mass_kg, impact_speed_m_per_s, .. } = &test.record;
            let impact = (*mass_kg, *impact_speed_m_per_s);
            let record = (&test.events, displacement.as_ref());
            let measured = measured_test(settings, test.input, record, impact, out.notes())?;
            Ok(measured.map(|measured| (measured, *mass_kg)))
        })
        .collect::<anyhow::Result<Option<Vec<_>>>>()?;
    let comparison = compared.and_then(Comparison::of_several);
    let assessed = write_candidates(&candidates, &names.join(" and "), comparison.as_ref(), out)?;
    if assessed.is_empty() {
        let reason = "no model could be fitted to all tests; the notes say why";
        return Ok(Outcome::NoAcceptableResult(reason.to_owned()));
    }
    let because = "no acceleration and displacement of every pulse up to dynamic crush";
    recommend(settings, &comparison.ok_or_else(|| because.to_owned()), &assessed, out)?;
    Ok(Outcome::Done)
}

/// A mass and an end of the window are of one test; several have their own.
fn refuse_what_is_of_one_test(settings: &StageSettings) -> anyhow::Result<()> {
    if settings.mass_kg.is_some() {
        return Err(Usage::new("a mass is of one test, and several have masses of their own")
            .hint(format!("{}, or '# mass: 873 kg' in the header of each record", option("ingest", "mass", "873kg")))
            .into());
    }
    Ok(())
}

fn read<'a>(
    settings: &StageSettings,
    name: &'a str,
    input: &'a Inputs,
    out: &mut Output,
) -> anyhow::Result<OneTest<'a>> {
    let of_test = |error: anyhow::Error| error.context(format!("test {name}"));
    let events: EventsV1 = input.record("/events").map_err(of_test)?;
    let described = input.test().map_err(of_test)?;
    let displacement = pulse_displacement(input, &events).map_err(of_test)?;
    let record = Record::read(settings, input, &described, (&events, displacement), out).map_err(of_test)?;
    let acceleration = motion(input, &events.channel, FitQuantity::Acceleration, record.mass_kg).ok();
    let acceleration = acceleration
        .map(|wave| input.recording_steps(&events, &events.channel, &wave).map(|steps| (wave, steps)))
        .transpose()
        .map_err(of_test)?;
    Ok(OneTest { name, input, described, events, record, acceleration })
}

/// Why a test cannot take part; `None`: it can.
fn without_crush(test: &OneTest<'_>) -> Option<String> {
    let OneTest { name, described, events, record, .. } = test;
    let axis = described.channel(&events.channel).and_then(|channel| channel.axis);
    if let Some(axis) = axis.filter(|axis| *axis != Axis::X) {
        let channel = &events.channel;
        return Some(format!("{name}: channel {channel} is along {axis}, and the models are of a crush along x"));
    }
    if let Some((reason, _)) = not_slowed(record.displacement.as_ref(), events) {
        return Some(format!("{name}: {reason}"));
    }
    let stops = events.time_of_dynamic_crush_s.is_some() && events.dynamic_crush_m.is_some_and(|crush| crush > 0.0);
    (!stops).then(|| {
        format!(
            "{name}: the vehicle does not stop within its record, so the test has no dynamic crush to fit. Leave it \
             out, or give a record that lasts until the vehicle stops"
        )
    })
}

/// What the joint model is of: mass and speed of the test with the deepest crush.
fn joint_test(tests: &[OneTest<'_>], reference: &OneTest<'_>) -> TestV1 {
    let titles: Vec<&str> = tests.iter().map(|test| test.described.title.as_str()).collect();
    let names: Vec<&str> = tests.iter().map(|test| test.name).collect();
    TestV1 {
        title: titles.join(" + "),
        mass_kg: Some(reference.record.mass_kg),
        impact_speed_m_per_s: Some(reference.record.impact_speed_m_per_s),
        source: SourceV1 { format: "several tests".to_owned(), name: names.join(" + "), digest: String::new() },
        channels: Vec::new(),
        pulse: None,
        notes: vec![format!("mass and impact speed are those of {}, the deepest crush", reference.name)],
        contact: None,
        ..TestV1::from(&reference.described)
    }
}

fn tests_record(tests: &[OneTest<'_>]) -> TestsV2 {
    let speeds: Vec<f64> = tests.iter().map(|test| test.record.impact_speed_m_per_s).collect();
    let rate_factor = match RateFactorSource::of(&speeds) {
        RateFactorSource::Fitted => "fitted",
        RateFactorSource::Prior { .. } => "prior",
    };
    let of_test = |test: &OneTest<'_>| JointTestV1 {
        name: test.name.to_owned(),
        title: test.described.title.clone(),
        digest: test.described.source.digest.clone(),
        channel: test.events.channel.clone(),
        mass_kg: test.record.mass_kg,
        impact_speed_m_per_s: test.record.impact_speed_m_per_s,
        dynamic_crush_m: test.events.dynamic_crush_m,
        time_of_dynamic_crush_s: test.events.time_of_dynamic_crush_s,
        coefficient_of_restitution: test.events.coefficient_of_restitution,
    };
    TestsV2 {
        tests: tests.iter().map(of_test).collect(),
        rate_factor: rate_factor.to_owned(),
        crush_deviation: crush_deviation(tests),
    }
}

/// That of the mean of all tests, whose inputs err by themselves.
fn crush_deviation(tests: &[OneTest<'_>]) -> Option<f64> {
    let variances = tests.iter().map(|test| {
        let deviation = test.events.crush_deviation_m()?;
        Some((deviation / test.events.dynamic_crush_m.filter(|crush| *crush > 0.0)?).powi(2))
    });
    let sum: f64 = variances.sum::<Option<f64>>()?;
    Some(sum.sqrt() / tests.len() as f64)
}

fn warn_of_the_rate(tests: &TestsV2, out: &mut Output) {
    if tests.rate_factor == "prior" {
        let speeds: Vec<String> =
            tests.tests.iter().map(|test| format!("{:.1} km/h", 3.6 * test.impact_speed_m_per_s)).collect();
        out.notes().push(NearlyOneSpeed { speeds });
    }
}

remarks! {
    /// Remarks of several tests.
    pub REMARKS;

    /// The tests are too close in speed to show how forces grow with speed.
    CR564 NearlyOneSpeed { speeds: Vec<String> }
    bears on (About::Model(String::new()), Weight::Slight)
    decided "The fastest test is less than 1.1 times as fast as the slowest. At equal crush the forces of such tests \
             differ by about as much as an error of the zero level makes."
    means "The rate factor of the force-deflection curve is a prior: predictions at much higher speeds rest on it."
    remedy "add a test whose speed differs by a tenth or more"
    says format!(
        "the tests are at nearly one speed ({}), which does not tell the rate effect: it stays the prior of a single \
         test; speeds a tenth apart tell it",
        speeds.join(", ")
    );
}
