//! What the report remarks itself: what follows from typed fields of the results, whatever the stages remarked.

use crumple_artifact::records::Certainty;
use crumple_signal::{About, Note, Weight, remarks};

use crate::drawing::numbers::MILLI;
use crate::findings::conclusions::key_numbers::{KeyNumber, key_numbers};
use crate::findings::conclusions::kind::Kind;
use crate::findings::conclusions::several_tests::missed;
use crate::findings::text::symbols;
use crate::findings::{Ranking, Run};
use crate::words;

remarks! {
    /// Remarks of the report.
    pub REMARKS;

    /// Two vehicles collided, so that the displacement over ground is not the crush of either.
    CR801 CollisionOfTwo {}
    bears on (About::Motion, Weight::Decisive)
    decided "The test says that another vehicle was struck."
    means "Delta-v and the pulse hold. Crush, stiffness and predictions take the other vehicle for a rigid wall."
    remedy "use delta-v and the pulse; crumple damage gives the energy of each vehicle from its damage"
    says "a collision of two vehicles: the displacement over ground is not the crush of either, and the models take \
          the other vehicle for a rigid wall";

    /// Channels that criteria of an occupant are made from may be clipped.
    CR802 OccupantClipped { channels: Vec<String> }
    bears on (About::Occupants, Weight::Decisive)
    decided "Ingest found samples that repeat the largest value of the channel; see /quality of the channel."
    means "HIC and the 3 ms clip are lower bounds: the peak that the sensor could not measure is missing."
    remedy "use a channel of the same place with a larger range"
    says format!("{} may be clipped: HIC and 3 ms clip would then be larger than shown", channels.join(", "));

    /// Sensors of the compartment give another crush than the interval of the pulse holds.
    CR803 SensorsDiffer { sensors: usize, low_m: f64, high_m: f64 }
    bears on (About::Motion, Weight::Marked)
    decided "The crush of every sensor of the place is compared with the 90 % interval of the pulse."
    means "The structure moves at the sensors differently, or a sensor is wrong: one reading is no better than the \
           range."
    remedy "quote the range of the sensors"
    says {
        let [low, high] = [low_m, high_m].map(|m| words::quantity(MILLI * m, 0, "mm"));
        format!("{sensors} sensors of the compartment give a crush of {low} to {high}: quote the range")
    };

    /// A model for several tests misses the crush of one of them when it is predicted from the others.
    CR804 TestsDisagree { tests: String }
    bears on (About::Predictions, Weight::Decisive)
    decided "Each test is predicted from the others; its measured crush lies outside of the 90 % interval and is more \
             than 3 % off."
    means "The tests may not be of one structure. Predictions of the joint model may be off by as much."
    remedy "leave out the test that differs, or quote predictions with that error"
    says format!(
        "predicted from the others, the crush of {tests} is outside of its 90 % interval: these tests may not be of \
         one structure; predictions of the joint model may be off by as much"
    );

    /// A mirrored (dual) model gives the same record as the recommended one.
    CR805 HasDual { id: String, model: String }
    bears on (About::Model(id.clone()), Weight::Marked)
    decided "Two masses on two springs have two sets of parameters that give the same acceleration of one sensor \
             (docs/methods): the candidate states its dual."
    means "The motion and the crush are the same; masses, springs and dampers of both differ."
    remedy "record a second sensor, on the front or the engine"
    says format!(
        "a mirrored (dual) model fits as well as {model}: a second sensor, on the front or the engine, decides between \
         them"
    );

    /// Parameters of the recommended model are not identifiable from the record.
    CR806 NotIdentifiable { id: String, model: String, names: String }
    bears on (About::Model(id.clone()), Weight::Decisive)
    decided "The value is at a limit of the search that is not zero, both ends of its 95 % interval are unknown, or \
             its standard deviation is as large as the value."
    means "Any value within the interval follows the record as well. Quote no value for it."
    remedy "use the crush of the model, not these parameters; a second test at another speed narrows them"
    says format!("{model}: not identifiable from this record: {names}");

    /// Parameters of the recommended model have wide intervals.
    CR807 WideIntervals { id: String, model: String, names: String }
    bears on (About::Model(id.clone()), Weight::Marked)
    decided "One end of the 95 % interval is unknown, or the upper end is over ten times the lower one. A parameter at \
             zero counts by how large it could be (docs/report.md)."
    means "The value is a guide only. The motion of the model holds."
    remedy "quote the interval instead of the value"
    says format!("{model}: wide intervals of {names}");

    /// Predictions of the recommended model go beyond the crush of the test.
    CR808 BeyondTheTest { crush_m: f64 }
    bears on (About::Predictions, Weight::Slight)
    decided "The predicted crush is compared with that of the test."
    means "The structure behind the tested crush was not loaded: its force is assumed, and the interval says how \
           widely."
    remedy "use predictions up to the crush of the test, or add a faster test with crumple together"
    says format!(
        "predictions beyond {}, the crush of the test, extrapolate",
        words::quantity(MILLI * crush_m, 0, "mm")
    );

    /// The file states a fact of the test.
    CR809 StatedInFile { fact: String }
    bears on (About::Record, Weight::None)
    decided "The reader of the file keeps what it states beside channels, mass and speed."
    means "Nothing is computed from it."
    remedy "nothing"
    says fact.clone();
}

/// What follows from typed fields of the results.
pub fn own_remarks(run: &Run, ranking: &Ranking, kind: Kind) -> Vec<Note> {
    let mut found: Vec<Note> = Vec::new();
    if kind == Kind::TwoVehicles {
        found.push(CollisionOfTwo {}.into());
    }
    let numbers = key_numbers(run);
    let bound = numbers.iter().find(|number| number.is_lower_bound);
    let is_of = |id: &&String| bound.is_some_and(|bound| bound.channels.contains(id));
    let channels: Vec<String> = run.clipped.iter().filter(is_of).cloned().collect();
    if kind == Kind::Occupant && !channels.is_empty() {
        found.push(OccupantClipped { channels }.into());
    }
    let crush = numbers.into_iter().find(|number| number.name == "dynamic_crush");
    if let Some(spread) = crush.filter(KeyNumber::interval_misses_a_sensor).and_then(|crush| crush.spread) {
        found.push(SensorsDiffer { sensors: spread.sensors(), low_m: spread.low, high_m: spread.high }.into());
    }
    if let Some(tests) = run.joint.as_ref().and_then(missed) {
        found.push(TestsDisagree { tests }.into());
    }
    if let Some(best) = ranking.best.as_deref().and_then(|id| run.candidate(id)) {
        let (id, model) = (&best.id, run.name_of(&best.id));
        let named = |names: &[&str]| (!names.is_empty()).then(|| symbols(&best.record, names));
        // In the order in which the verdict distrusts them.
        if best.record.equivalent_to.is_some() {
            found.push(HasDual { id: id.clone(), model: model.clone() }.into());
        }
        if let Some(names) = named(&best.record.undetermined()) {
            found.push(NotIdentifiable { id: id.clone(), model: model.clone(), names }.into());
        }
        if let Some(names) = named(&best.record.parameters_of(Certainty::OrderOfMagnitude)) {
            found.push(WideIntervals { id: id.clone(), model, names }.into());
        }
    }
    if let Some(crush_m) = run.exceeded_tested_crush_m(|p| p.recommended) {
        found.push(BeyondTheTest { crush_m }.into());
    }
    found
}
