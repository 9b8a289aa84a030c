//! What stages remark: the record that is written, and how those of earlier versions and other programs are read.

use std::cmp::Reverse;

use crumple_artifact::records::{ConcernV1, ConcernsV2, DiagnosisV1, NotesV1, RemarkV1, RemarksV1, SeverityV1};
use crumple_artifact::{Artifact, ReadError};
use crumple_signal::{About, Note, Notes, Weight, remarks};

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
        for note in notes.iter().map(|text| RemarkV1::new(&stage, &Note::parse(text))) {
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
