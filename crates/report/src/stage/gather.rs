//! Gathers a run from artifacts: by topic, not by position.

use crate::findings::StatedInFile;
use std::collections::BTreeMap;

use crate::{
    CandidateResult, Element, JointTests, MeasuredWaves, Model, ModelOutput, Run, SensorMotion, StageRecord,
    compare_ids,
};
use crumple_artifact::Artifact;
use crumple_artifact::records::{
    CandidateV1, ChannelFilterV1, DiagnosisV1, EvidenceV1, IdentificationV1, ImpactsV1, MetricsV2, ModesV2,
    PredictionV1, QualityV1, RemarkV1, ResponseV1, SimulationV1, StabilizationV1, StateSpaceV1, TestV1, TestsV2,
    TransferFunctionV1,
};
use crumple_signal::{Channel, QuantityKind, Sampled, TestDescription};
use crumple_stage::joints::{Contradiction, contradictions};
use crumple_stage::{Inputs, Pipeline, Refused, is_no_result, program, remarks_of};

/// Everything the artifacts say that a report shows. What none of them holds is named in [`Run::missing`]; what the
/// pipeline asks for and nobody made is a remark.
///
/// Refuses artifacts whose records do not decode, and inputs that hold nothing a report could show.
pub fn gather(inputs: &Inputs, pipeline: Option<&Pipeline>) -> anyhow::Result<Run> {
    let mut run = Run::default();
    match inputs.record_if::<TestV1>("/test")? {
        Some(_) => run.test = inputs.test()?,
        None => run.missing.push("the test description (ingest writes it)".to_owned()),
    }
    run.joint = inputs.record_if::<TestsV2>("/tests")?.map(JointTests::new);
    run.events = inputs.record_if("/events")?;
    run.impacts = match &run.events {
        Some(events) => events.impacts.clone(),
        None => inputs.record_if::<ImpactsV1>("/impacts")?.map(|record| record.impacts).unwrap_or_default(),
    };
    run.metrics = inputs.record_if::<MetricsV2>("/metrics")?.map(|record| record.metrics).unwrap_or_default();
    if let Some(id) = run.channel_id().map(str::to_owned) {
        run.filter = inputs.record_if::<ChannelFilterV1>(&format!("/filter/{id}"))?;
        run.measured = measured(inputs, &id);
        run.other_sensors = other_sensors(inputs, &run.test, &id);
    }
    let changes = run.test.channels.iter().filter(|channel| channel.quantity == QuantityKind::VelocityChange);
    let change = |c: &Channel| Some((c.id.clone(), inputs.wave_if(&c.id)?.sampled.clone()));
    run.recorded_changes = changes.filter_map(change).collect();
    run.models = models(inputs)?;
    run.selections = inputs.records("/selection/")?.into_iter().map(|(_, record)| record).collect();
    let stabilizations = inputs.records::<StabilizationV1>("/stabilisation/")?;
    run.stabilizations = stabilizations.into_iter().map(|(_, record)| record).collect();
    run.matchings = inputs.records("/matching/")?;
    run.recommendation = inputs.record_if("/recommendation")?;
    run.predictions = predictions(inputs)?;
    let simulations: BTreeMap<String, SimulationV1> = inputs.records("/simulation/")?.into_iter().collect();
    let stage_ran = inputs.artifacts().iter().any(|artifact| artifact.stage() == Some("simulate"));
    run.responses = (stage_ran || !simulations.is_empty()).then_some(simulations.len());
    run.candidates = candidates(inputs, &simulations)?;
    run.provenance = inputs.artifacts().iter().map(stage_record).collect();
    if let Some(pipeline) = pipeline {
        run.provenance.iter_mut().for_each(|record| record.name_program(pipeline));
    }
    collect_remarks(inputs, &mut run)?;
    let found = contradictions(inputs.artifacts(), pipeline);
    let program_of = |stage: &str| run.provenance.iter().find(|made| made.stage == stage)?.program.as_ref();
    let remark = |found: &Contradiction| found.remark(program_of(found.stage).map(|program| &*program.command));
    run.allowed = pipeline.iter().flat_map(|pipeline| pipeline.allowed()).collect();
    run.contradictions = found.iter().map(remark).collect();
    let qualities = inputs.records::<QualityV1>("/quality/")?;
    run.clipped = qualities.into_iter().filter(|(_, q)| q.may_be_clipped()).map(|(id, _)| id).collect();
    let without_parameters = simulations.keys().filter(|id| run.candidate(id).is_none()).count();
    name_what_is_missing(&mut run, without_parameters);

    let nothing = run.measured.raw.is_none()
        && run.measured.filtered.is_none()
        && run.measured.displacement.is_none()
        && run.events.is_none()
        && run.test.channels.is_empty()
        && run.joint.is_none()
        && run.models.is_empty()
        && run.candidates.is_empty();
    if nothing {
        return Err(Refused::new("the inputs hold no test, wave, event, model or candidate")
            .expected("artifacts of the pipeline's stages")
            .hint(format!("look into them with {}", program("artifact show")))
            .into());
    }
    Ok(run)
}

/// Predictions by their number.
fn predictions(inputs: &Inputs) -> anyhow::Result<Vec<PredictionV1>> {
    let mut numbered = inputs.records::<PredictionV1>("/prediction/")?;
    numbered.sort_by_key(|(n, _)| (n.parse::<u64>().unwrap_or(u64::MAX), n.clone()));
    Ok(numbered.into_iter().map(|(_, prediction)| prediction).collect())
}

/// The pulse channel's waves. Which acceleration is raw and which filtered follows from the stage that wrote it; where
/// an artifact does not name a known stage, the later of two is the filtered one, and a lone one with a filter record.
fn measured(inputs: &Inputs, id: &str) -> MeasuredWaves {
    let filter_topic = format!("/filter/{id}");
    let (mut raw, mut filtered) = (None, None);
    for artifact in inputs.artifacts() {
        let Some(wave) = artifact.waves().get(id) else { continue };
        let known = match artifact.stage() {
            Some("ingest") => Some(false),
            Some("filter") => Some(true),
            _ => None,
        };
        let is_filtered = known
            .unwrap_or_else(|| raw.is_some() || artifact.records().iter().any(|record| record.topic == filter_topic));
        *(if is_filtered { &mut filtered } else { &mut raw }) = Some(wave.sampled.clone());
    }
    let of_motion = |what: &str| inputs.wave_if(&format!("{id}/{what}")).map(|wave| wave.sampled.clone());
    MeasuredWaves {
        raw,
        filtered,
        velocity: of_motion("velocity"),
        displacement: of_motion("displacement"),
        force: of_motion("force"),
        barrier_force: inputs.wave_if("barrier/force").map(|wave| wave.sampled.clone()),
    }
}

/// Channels of the test beside the pulse that were integrated.
fn other_sensors(inputs: &Inputs, test: &TestDescription, pulse: &str) -> Vec<SensorMotion> {
    let wave = |id: String| inputs.wave_if(&id).map(|wave| wave.sampled.clone());
    let others = test.channels.iter().filter(|channel| channel.id != pulse);
    others
        .filter_map(|channel| {
            Some(SensorMotion {
                channel: channel.id.clone(),
                velocity: wave(format!("{}/velocity", channel.id)),
                displacement: wave(format!("{}/displacement", channel.id))?,
            })
        })
        .collect()
}

fn models(inputs: &Inputs) -> anyhow::Result<Vec<Model>> {
    let mut models: BTreeMap<String, Model> = BTreeMap::new();
    let mut with_model = |id: &str, put: &mut dyn FnMut(&mut Model)| {
        let model = models.entry(id.to_owned()).or_insert_with(|| Model { id: id.to_owned(), ..Model::default() });
        put(model);
    };
    for (id, identification) in inputs.records::<IdentificationV1>("/identification/")? {
        with_model(&id, &mut |model| model.identification = Some(identification.clone()));
    }
    for (id, modes) in inputs.records::<ModesV2>("/modes/")? {
        with_model(&id, &mut |model| {
            model.modes.clone_from(&modes.modes);
            model.other_poles.clone_from(&modes.other_poles);
        });
    }
    for (id, response) in inputs.records::<ResponseV1>("/response/")? {
        with_model(&id, &mut |model| model.response = Some(response.clone()));
    }
    // One model has several forms: `<id>/discrete`, `<id>/predictor`; of several paths `<id>/2-1/transfer-function`.
    let split = |topic: &str| {
        topic.split_once('/').map_or((topic.to_owned(), String::new()), |(id, form)| (id.to_owned(), form.to_owned()))
    };
    for (topic, tf) in inputs.records::<TransferFunctionV1>("/model/")? {
        let (id, form) = split(&topic);
        let is_whole = !form.contains('/');
        with_model(&id, &mut |model| {
            model.transfer_function = is_whole.then(|| tf.clone());
            model.paths.push(tf.clone());
        });
    }
    for (topic, state_space) in inputs.records::<StateSpaceV1>("/model/")? {
        let (id, form) = split(&topic);
        with_model(&id, &mut |model| {
            if form == "discrete" || (form == "continuous" && model.state_space.is_none()) {
                model.state_space = Some(state_space.clone());
            }
        });
    }
    let wave = |id: &str| inputs.wave_if(id).map(|wave| wave.sampled.clone());
    // Of several outputs that which is worst on unseen samples counts.
    for (topic, evidence) in inputs.records::<EvidenceV1>("/evidence/")? {
        let (id, number) = split(&topic);
        let Some(model) = models.get_mut(&id) else { continue };
        let place = number.parse::<usize>().map_or(0, |number| number.saturating_sub(1));
        let identification = model.identification.as_ref();
        let fits = identification.map(|i| &i.output_fits_percent[..]).unwrap_or_default();
        let channel = evidence.output.clone();
        let simulated = wave(&format!("{id}/simulated")).or_else(|| wave(&format!("{id}/simulated/{channel}")));
        model.outputs.push(ModelOutput {
            fit_percent: fits.get(place).copied().unwrap_or_else(|| identification.and_then(|i| i.fit_percent)),
            quantity: inputs.wave_if(&channel).map(|wave| wave.quantity),
            measured: wave(&channel),
            simulated,
            unseen_from_s: evidence.validation_from_s,
            evidence: Some(evidence.clone()),
            channel,
        });
        let unseen = |evidence: &EvidenceV1| {
            let fit_percent = evidence.validation_restarted_fit_percent.or(evidence.validation_fit_percent);
            (evidence.holds_on_unseen != Some(false), fit_percent.unwrap_or(f64::INFINITY))
        };
        if model.evidence.as_ref().is_none_or(|known| unseen(&evidence) < unseen(known)) {
            model.evidence = Some(evidence);
        }
    }
    for model in models.values_mut() {
        let drives = model.identification.iter().flat_map(|i| &i.inputs);
        model.inputs = drives.filter_map(|id| Some((id.clone(), wave(id)?))).collect();
    }
    Ok(models.into_values().collect())
}

fn candidates(inputs: &Inputs, simulations: &BTreeMap<String, SimulationV1>) -> anyhow::Result<Vec<CandidateResult>> {
    let wave = |id: &str, what: &str| -> Option<Sampled> {
        inputs.wave_if(&format!("{id}/{what}")).map(|wave| wave.sampled.clone())
    };
    let mut candidates: Vec<CandidateResult> = inputs
        .records::<CandidateV1>("/parameters/")?
        .into_iter()
        .map(|(id, record)| CandidateResult {
            simulation: simulations.get(&id).cloned(),
            displacement: wave(&id, "displacement"),
            velocity: wave(&id, "velocity"),
            acceleration: wave(&id, "acceleration"),
            elements: elements(inputs, &id),
            masses: (1..)
                .map_while(|i| Some((wave(&id, &format!("m{i}/displacement"))?, wave(&id, &format!("m{i}/velocity")))))
                .collect(),
            id,
            record,
        })
        .collect();
    candidates.sort_by(|a, b| compare_ids(&a.id, &b.id));
    Ok(candidates)
}

/// Forces below `<id>/force/` with the deflection that belongs to each.
fn elements(inputs: &Inputs, id: &str) -> Vec<Element> {
    let prefix = format!("{id}/force/");
    let samples = |what: String| inputs.wave_if(&format!("{id}/{what}")).map(|wave| wave.sampled.samples());
    // Of mass i from 1; the last mass is the compartment, which has no number.
    let of_mass = |i: usize| samples(format!("m{i}/displacement")).or_else(|| samples("displacement".to_owned()));
    let mut elements: Vec<Element> = inputs
        .waves()
        .filter_map(|(wave_id, wave)| {
            let name = wave_id.strip_prefix(&prefix)?;
            let place = name.trim_start_matches(|c: char| c.is_ascii_alphabetic()).parse().unwrap_or(1);
            let behind = of_mass(place)?;
            let deflection = match place.checked_sub(1).filter(|front| *front > 0).map(of_mass) {
                Some(front) => behind.iter().zip(front?).map(|(x, y)| x - y).collect(),
                None => behind.to_vec(),
            };
            (deflection.len() == wave.sampled.len()).then(|| Element {
                name: name.to_owned(),
                force: wave.sampled.clone(),
                deflection,
            })
        })
        .collect();
    let order = |e: &Element| (e.name.trim_start_matches(['k', 'c']).to_owned(), e.name.starts_with('c'));
    elements.sort_by_key(order);
    elements
}

/// What an artifact says of how it was made.
pub fn stage_record(artifact: &Artifact) -> StageRecord {
    let provenance = artifact.provenance();
    // One that was packed of edited files states no stage, and stands in its place.
    let name = artifact.path().file_stem().and_then(|name| name.to_str()?.split_once('-')).map(|(_, stage)| stage);
    StageRecord {
        stage: artifact.stage().or(name).unwrap_or("not stated").to_owned(),
        version: provenance
            .map(|p| [p.stage_version.as_str(), p.made_by.as_str()].join(" ").trim_end().to_owned())
            .unwrap_or_default(),
        digest: artifact.digest().to_owned(),
        settings: provenance.map(|p| p.config_json.clone()).unwrap_or_default(),
        inputs: provenance
            .map(|p| p.inputs.iter().map(|input| (input.kind.clone(), input.digest.clone())).collect())
            .unwrap_or_default(),
        program: None,
    }
}

/// Remarks in stage order, each once: a stage that has nothing to work on hands on what an earlier one said. What the
/// reader of the file remarked counts as ingest's, and is known without its artifact, since the test travels along.
fn collect_remarks(inputs: &Inputs, run: &mut Run) -> anyhow::Result<()> {
    let mut all: Vec<RemarkV1> = Vec::new();
    let is_known = |all: &[RemarkV1], remark: &RemarkV1| {
        let is_same = |known: &RemarkV1| match remark.code.as_str() {
            // A program of before states no code.
            "" => known.text == remark.text,
            code => (&*known.code, &known.about, &known.values) == (code, &remark.about, &remark.values),
        };
        all.iter().any(|known| known.stage == remark.stage && is_same(known))
    };
    for artifact in inputs.artifacts() {
        let is_of_before = artifact.records().iter().all(|record| record.topic != "/remarks");
        for remark in remarks_of(artifact).map_err(Refused::from)? {
            // A program of before writes its diagnosis again.
            let is_again = is_of_before && is_no_result(&remark) && all.iter().any(is_no_result);
            if !is_known(&all, &remark) && !is_again {
                all.push(remark);
            }
        }
        if let Some(diagnosis) = artifact.record::<DiagnosisV1>("/diagnosis").map_err(Refused::from)?
            && diagnosis.has_result
        {
            run.without.get_or_insert(diagnosis.reason);
        }
    }
    let of_file =
        run.test.notes.iter().map(|text| RemarkV1::new("ingest", &StatedInFile { fact: text.clone() }.into()));
    let of_file: Vec<RemarkV1> = of_file.filter(|remark| !is_known(&all, remark)).collect();
    let after_ingest = all.iter().take_while(|remark| remark.stage == "ingest").count();
    all.splice(after_ingest..after_ingest, of_file);
    run.remarks = all;
    Ok(())
}

fn name_what_is_missing(run: &mut Run, without_parameters: usize) {
    let mut missing = std::mem::take(&mut run.missing);
    if run.is_generic() {
        missing.push(
            "motion, events and physical parameters: no channel is named as a pulse (--channel names one)".to_owned(),
        );
        run.missing = missing;
        return;
    }
    // Waves and events of several tests are in the reports of each.
    if run.joint.is_some() {
        run.missing = missing;
        return;
    }
    let mut add = |absent: bool, what: &str| {
        if absent {
            missing.push(what.to_owned());
        }
    };
    add(run.channel_id().is_none(), "the crash pulse: the test names none of its channels (--channel does)");
    add(run.measured.raw.is_none(), "acceleration as read (ingest writes it)");
    add(run.measured.filtered.is_none(), "filtered acceleration (filter writes it)");
    add(
        run.events.is_none() && run.metrics.is_empty(),
        "crash events, velocity, displacement and metrics (integrate writes them)",
    );
    let no_motion = match run.test.impact_speed_m_per_s {
        None => "vehicle motion: the record has no impact speed (add --impact-speed)",
        Some(_) => "vehicle motion: see the notes of integrate",
    };
    let has_motion = run.measured.displacement.is_some();
    add(run.events.is_none() && !run.metrics.is_empty() && !has_motion, no_motion);
    add(run.events.is_some() && !has_motion, "velocity and displacement (integrate writes them)");
    // A stage that ran has found none, and says why.
    let none_of = |what: &str, stage: &str| {
        let ran = run.provenance.iter().any(|record| record.stage == stage);
        let reason = run.without.as_deref().or_else(|| {
            let diagnosed = run.remarks.iter().find(|remark| is_no_result(remark));
            diagnosed.map(|remark| remark.text.as_str())
        });
        match reason.filter(|_| ran) {
            Some(reason) => format!("{what}: none found, {reason}"),
            None => format!("{what} ({stage} writes them)"),
        }
    };
    add(run.models.is_empty(), &none_of("identified models", "identify"));
    add(run.candidates.is_empty(), &none_of("physical parameters", "parameter-solve"));
    add(
        run.responses.is_none() && !run.candidates.is_empty(),
        "ranking: the candidates were not simulated (by the stage simulate)",
    );
    if without_parameters > 0 {
        missing
            .push(format!("the parameters of {without_parameters} simulated candidates (parameter-solve writes them)"));
    }
    run.missing = missing;
}
