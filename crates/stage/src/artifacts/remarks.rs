//! What stages remark: the record that is written, and how those of earlier versions and other programs are read.

use std::cmp::Reverse;

use crumple_artifact::records::{
    ConcernV1, ConcernsV2, DiagnosisV1, IdentificationV1, NotesV1, RemarkV1, RemarksV1, SeverityV1,
};
use crumple_artifact::{Artifact, ReadError};
use crumple_signal::{About, Note, Notes, Severity, Weight, remarks};

remarks! {
    /// What every stage can say.
    pub REMARKS;

    /// The stage has no acceptable result, or none that later stages work on.
    CR900 NoResult { reason: String }
    bears on (About::Record, Weight::Decisive)
    decided "Each stage knows when its result can be accepted; the sentence has its reason."
    means "Later stages have nothing to work on. What was measured before it holds."
    remedy "follow the hint of the sentence, or read what else the stage remarks: crumple notes RUN"
    says reason.clone();

    /// A candidate is left out: a number of it is not one of a vehicle.
    CR901 LeftOut { id: String, field: String, value: String }
    bears on (About::Model(id.clone()), Weight::Slight)
    decided "No record holds a number that is not finite or beyond 1e300 in size: nothing of a vehicle comes near it."
    means "One root of a closed form or of a matching went astray. The other candidates are not touched by it."
    remedy "nothing, unless it was the only candidate: then state other masses or another window"
    says format!("{id} is left out: its {field} is {value}, which is no number of a vehicle");
}

/// Whether a remark is the diagnosis of a stage without a result.
pub fn is_no_result(remark: &RemarkV1) -> bool {
    remark.code == NoResult::KIND.code
}

/// Why a stage has no result, and what to do about it.
pub(crate) fn no_result(stage: &str, reason: &str, remedy: Option<String>) -> RemarkV1 {
    let remark = RemarkV1::new(stage, &NoResult { reason: reason.to_owned() }.into());
    RemarkV1 { about: About::of_stage(stage).to_string(), remedy: remedy.or_else(|| remark.remedy.clone()), ..remark }
}

/// The remarks of a stage, strongest first.
pub(crate) fn in_order(stage: &str, notes: &Notes) -> Vec<RemarkV1> {
    let mut all: Vec<RemarkV1> = notes.iter().map(|note| RemarkV1::new(stage, note)).collect();
    all.sort_by_key(|remark| Reverse(remark.weight));
    all
}

/// The warnings among remarks as `/concerns` has them, which programs of before read.
pub(crate) fn as_concerns(remarks: &[RemarkV1]) -> ConcernsV2 {
    let concern = |remark: &RemarkV1| ConcernV1 {
        stage: remark.stage.clone(),
        severity: if is_no_result(remark) { SeverityV1::NoResult } else { SeverityV1::Warning },
        about: remark.about.clone(),
        weight: remark.weight,
        text: remark.text.clone(),
        remedy: remark.remedy.clone().filter(|_| is_no_result(remark)),
    };
    ConcernsV2 { concerns: remarks.iter().filter(|remark| remark.is_warning()).map(concern).collect() }
}

/// What an artifact remarks, strongest first: its `/remarks`, or what stands in their place where a version of before
/// or another program wrote it. A warning that no `/concerns` weighs has the least weight; the diagnosis of a program
/// that writes no concern is a remark too. Errors: a record does not decode.
pub fn remarks_of(artifact: &Artifact) -> Result<Vec<RemarkV1>, ReadError> {
    let diagnosis = artifact.record::<DiagnosisV1>("/diagnosis")?;
    if let Some(RemarksV1 { mut remarks }) = artifact.record("/remarks")? {
        // A program from elsewhere may write its diagnosis alone.
        if let Some(diagnosis) = diagnosis.filter(|_| !remarks.iter().any(is_no_result)) {
            remarks.insert(0, no_result(&diagnosis.stage, &diagnosis.reason, None));
        }
        return Ok(remarks);
    }
    let concerns = artifact.record::<ConcernsV2>("/concerns")?.map_or(Vec::new(), |record| record.concerns);
    let of_concern = |concern: ConcernV1| {
        let code = if concern.is_no_result() { NoResult::KIND.code } else { "" };
        let ConcernV1 { stage, about, weight, text, remedy, .. } = concern;
        RemarkV1 { code: code.to_owned(), stage, about, weight, text, remedy, ..RemarkV1::default() }
    };
    let mut all: Vec<RemarkV1> = concerns.into_iter().map(of_concern).collect();
    if let Some(NotesV1 { stage, notes }) = artifact.record("/notes")? {
        for note in notes.iter().map(|text| of_text(&stage, text)) {
            if !all.iter().any(|known| known.stage == note.stage && known.text == note.text) {
                all.push(note);
            }
        }
    }
    if let Some(diagnosis) = diagnosis.filter(|_| !all.iter().any(is_no_result)) {
        all.push(no_result(&diagnosis.stage, &diagnosis.reason, None));
    }
    all.sort_by_key(|remark| Reverse(remark.weight));
    Ok(all)
}

/// The stage of identified models.
const IDENTIFY: &str = "identify";

/// Writes what is remarked of an identified model into its record.
pub fn remark_on_model(record: &mut IdentificationV1, notes: &[Note]) {
    record.notes = notes.iter().map(Note::to_string).collect();
    record.remarks = notes.iter().map(|note| RemarkV1::new(IDENTIFY, note)).collect();
}

/// What the record of an identified model remarks, in its order; of an artifact of before its sentences.
pub fn remarks_of_model(record: &IdentificationV1) -> Vec<RemarkV1> {
    if record.remarks.is_empty() {
        return record.notes.iter().map(|text| of_text(IDENTIFY, text)).collect();
    }
    record.remarks.clone()
}

/// A remark of an artifact of before, which has sentences alone: a warning has its mark in front.
fn of_text(stage: &str, text: &str) -> RemarkV1 {
    let warning = text.strip_prefix(Severity::Warning.mark()).map(Note::warning);
    RemarkV1::new(stage, &warning.unwrap_or_else(|| Note::info(text)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_remarks_by_values_and_one_of_before_by_sentences() {
        let said = NoResult { reason: "no pole".to_owned() }.into();
        let mut record: IdentificationV1 = serde_json::from_value(serde_json::json!({
            "method": "era", "order": 2, "channel": "a", "treated_as": "ambient", "from_s": 0, "to_s": 1, "samples": 2,
            "singular_values": [], "notes": ["warning: clipped", "of two sensors"],
        }))
        .unwrap();
        let of_before = remarks_of_model(&record);
        let told = of_before.iter().map(|remark| (remark.code.as_str(), remark.weight, remark.text.as_str()));
        assert_eq!(Vec::from_iter(told), [("", 1, "clipped"), ("", 0, "of two sensors")]);
        remark_on_model(&mut record, &[said]);
        let remarks = remarks_of_model(&record);
        assert_eq!((remarks.len(), remarks[0].code.as_str()), (1, NoResult::KIND.code));
        assert_eq!(record.notes, ["warning: no pole"]);
        assert!(remarks[0].says_the_same(&remarks[0]) && !remarks[0].says_the_same(&of_before[0]));
    }
}
