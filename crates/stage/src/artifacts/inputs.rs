//! The artifacts a stage was given. It looks for topics, not for positions.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crumple_artifact::records::{ChannelFilterV1, DiagnosisV1, EventsV1, RemarkV1, TestV1};
use crumple_artifact::{Artifact, InputDigest, ReadError, Record, Wave, same_type};
use crumple_signal::{
    Acceleration, BeforeEvent, IntegrationRule, Measurement, QuantityKind, Sampled, TestDescription, TwoPassFilter,
    coarse_step,
};

use crate::artifacts::remarks::{is_no_result, remarks_of};
use crate::error::{MissingTopic, RefuseExt, Refused, Usage};
use crate::joints::refuse_contradictions;
use crate::names::{artifact_of, stage_order, writer_of};
use crate::terminal::Progress;

/// What a stage works on, and the digests that go into its provenance.
#[derive(Debug)]
pub struct Loaded<I> {
    /// The input.
    pub input: I,
    /// Kind and digest of every part of it.
    pub digests: Vec<InputDigest>,
    /// Earlier stages among the inputs that had no acceptable result.
    pub(crate) diagnosed: Diagnosed,
}

/// What earlier stages without an acceptable result leave behind.
#[derive(Debug, Default)]
pub(crate) struct Diagnosed {
    /// Who and why.
    pub(crate) diagnoses: Vec<DiagnosisV1>,
    /// The same as remarks, with what to do.
    pub(crate) without_result: Vec<RemarkV1>,
    /// The test description travels on all the same.
    pub(crate) test: Option<Box<TestV1>>,
}

impl Diagnosed {
    /// The reason why a topic is missing, if the stage that writes it has said that it has no acceptable result.
    pub(crate) fn reason_for(&self, missing: &MissingTopic) -> Option<String> {
        self.diagnoses
            .iter()
            .find(|diagnosis| missing.writers() == [diagnosis.stage.as_str()])
            .map(|diagnosis| format!("nothing to work on, since {} says: {}", diagnosis.stage, diagnosis.reason))
    }
}

impl<I> Loaded<I> {
    /// An input that no stage stands behind, such as a file as users have it.
    pub fn new(input: I, digests: Vec<InputDigest>) -> Self {
        Self { input, digests, diagnosed: Diagnosed::default() }
    }

    /// With something beside what the artifacts hold.
    pub fn map<J>(self, beside: impl FnOnce(I) -> J) -> Loaded<J> {
        Loaded { input: beside(self.input), digests: self.digests, diagnosed: self.diagnosed }
    }
}

/// Artifacts of earlier stages, in the order of the pipeline whatever the order they were given in.
///
/// Where two hold the same topic, the later stage's is taken.
#[derive(Debug)]
pub struct Inputs {
    artifacts: Vec<Artifact>,
}

/// Reads an artifact, its progress shown.
pub(crate) fn open(path: &Path) -> Result<Artifact, ReadError> {
    let mut progress = Progress::of_reading(path);
    Artifact::open_reporting(path, &mut |bytes| progress.advance(bytes))
}

/// Reads and checks artifacts. Refuses any that is damaged, foreign or from a later version.
pub fn load_artifacts(paths: &[PathBuf]) -> anyhow::Result<Loaded<Inputs>> {
    let mut artifacts = paths.iter().map(|path| open(path)).collect::<Result<Vec<_>, _>>().map_err(Refused::from)?;
    artifacts.sort_by(|a, b| (stage_order(a.stage()), a.digest()).cmp(&(stage_order(b.stage()), b.digest())));
    let digests = artifacts
        .iter()
        .map(|a| InputDigest { kind: a.stage().unwrap_or("artifact").to_owned(), digest: a.digest().to_owned() })
        .collect();
    let diagnoses = artifacts.iter().filter_map(|a| a.record::<DiagnosisV1>("/diagnosis").ok().flatten()).collect();
    let without_result =
        artifacts.iter().flat_map(|a| remarks_of(a).unwrap_or_default()).filter(is_no_result).collect();
    refuse_a_mixture(&artifacts, |artifact| artifact.path().display().to_string())?;
    refuse_contradictions(&artifacts)?;
    let inputs = Inputs { artifacts };
    let test = inputs.record_if::<TestV1>("/test")?.map(Box::new);
    Ok(Loaded { input: inputs, digests, diagnosed: Diagnosed { diagnoses, without_result, test } })
}

/// The test description of an artifact, if it has one. Refuses one that makes no sense.
fn test_in(artifact: &Artifact) -> anyhow::Result<Option<TestV1>> {
    let test = artifact.record::<TestV1>("/test").map_err(Refused::from)?;
    if let Some(test) = &test {
        let refused = |error| {
            let found = format!("{}: topic /test: {error}", artifact.path().display());
            Refused::new(found).hint("see docs/format.md, type Test")
        };
        TestDescription::try_from(test.clone()).map_err(refused)?;
    }
    Ok(test)
}

/// The first field in which two descriptions of a test differ, with both values. Filter may add channels and choose the
/// pulse; from integrate on pulse and speed are those that it was told.
fn difference((earlier, a): (&Artifact, &TestV1), (later, b): (&Artifact, &TestV1)) -> Option<String> {
    let fields = |test: &TestV1| {
        let TestV1 { title, vehicle, barrier, mass_kg, impact_speed_m_per_s, source, .. } = test;
        serde_json::json!({
            "mass_kg": mass_kg, "impact_speed_m_per_s": impact_speed_m_per_s, "vehicle": vehicle, "title": title,
            "barrier": barrier, "source": source,
        })
    };
    let integrated = stage_order(Some("integrate"));
    let is_told = stage_order(earlier.stage()) < integrated && integrated <= stage_order(later.stage());
    let (a, b) = (fields(a), fields(b));
    let differs = |(name, value): &(&String, &serde_json::Value)| {
        b.get(name.as_str()) != Some(*value) && !(is_told && *name == "impact_speed_m_per_s")
    };
    let (name, of_a) = a.as_object()?.iter().find(differs)?;
    Some(format!("{name} is {of_a} and {}", b.get(name)?))
}

/// Whether an artifact states that it was made from a result of that stage which is not this one.
fn was_made_from_another(artifact: &Artifact, earlier: &Artifact) -> bool {
    let inputs = artifact.provenance().map_or(&[][..], |provenance| &provenance.inputs);
    let mut of_stage = inputs.iter().filter(|input| Some(input.kind.as_str()) == earlier.stage()).peekable();
    of_stage.peek().is_some() && of_stage.all(|input| !input.digest.is_empty() && input.digest != earlier.digest())
}

/// Errors: two results of one stage, results of two tests, or results that were not made from each other.
/// `name` says which artifact is meant.
pub fn refuse_a_mixture(artifacts: &[Artifact], name: impl Fn(&Artifact) -> String) -> anyhow::Result<()> {
    let tests = artifacts.iter().map(test_in).collect::<anyhow::Result<Vec<_>>>()?;
    let source = |test: &TestV1| Some(test.source.digest.clone()).filter(|digest| !digest.is_empty());
    for (k, a) in artifacts.iter().enumerate() {
        for (b, of_b) in artifacts.iter().zip(&tests).skip(k + 1) {
            if let (Some(stage), Some(other)) = (a.stage(), b.stage())
                && stage == other
            {
                return Err(Refused::new(format!("{} and {} are both of the stage {stage}", name(a), name(b)))
                    .expected("one artifact of each stage")
                    .hint("leave one of them out")
                    .into());
            }
            let mixed = |found: String, expected: &str| {
                Err(Refused::new(found).expected(expected).hint("give artifacts of one run folder").into())
            };
            if let (Some(of_a), Some(of_b)) = (&tests[k], of_b)
                && let (Some(record_of_a), Some(record_of_b)) = (source(of_a), source(of_b))
            {
                if record_of_a != record_of_b {
                    let found = format!("{} and {} are of different records", name(a), name(b));
                    return mixed(found, "artifacts that go back to one record");
                }
                if let Some(difference) = difference((a, of_a), (b, of_b)) {
                    let found = format!("{} and {} describe different tests: {difference}", name(a), name(b));
                    return mixed(found, "artifacts of one run, whose test is one");
                }
            }
            if was_made_from_another(b, a) {
                let stage = a.stage().map_or_else(String::new, artifact_of);
                let found = format!("{} was made from another {stage} than {}", name(b), name(a));
                return mixed(found, "artifacts that were made from each other");
            }
        }
    }
    Ok(())
}

impl Inputs {
    /// The artifacts in the order of the pipeline.
    pub fn artifacts(&self) -> &[Artifact] {
        &self.artifacts
    }

    /// The record under a topic. Refuses when it is missing, and says which stage writes it.
    pub fn record<R: Record>(&self, topic: &str) -> anyhow::Result<R> {
        self.record_if(topic)?.ok_or_else(|| self.missing(topic))
    }

    /// The record under a topic, if it is there.
    pub fn record_if<R: Record>(&self, topic: &str) -> anyhow::Result<Option<R>> {
        for artifact in self.artifacts.iter().rev() {
            if let Some(record) = artifact.record(topic).map_err(Refused::from)? {
                return Ok(Some(record));
            }
        }
        Ok(None)
    }

    /// All records of a type under a topic prefix, as `(rest of the topic, record)`, sorted by topic.
    pub fn records<R: Record>(&self, prefix: &str) -> anyhow::Result<Vec<(String, R)>> {
        let mut by_topic = BTreeMap::new();
        for artifact in &self.artifacts {
            for raw in artifact.records() {
                if let Some(rest) = raw.topic.strip_prefix(prefix)
                    && same_type(&raw.schema, R::SCHEMA)
                {
                    by_topic.insert(rest.to_owned(), artifact.decode(raw).map_err(Refused::from)?);
                }
            }
        }
        Ok(by_topic.into_iter().collect())
    }

    /// The waveform of a channel. Refuses when it is missing.
    pub fn wave(&self, id: &str) -> anyhow::Result<&Wave> {
        self.wave_if(id).ok_or_else(|| self.missing(&format!("/wave/{id}")))
    }

    /// The waveform of a channel, if it is there.
    pub fn wave_if(&self, id: &str) -> Option<&Wave> {
        self.artifacts.iter().rev().find_map(|a| a.waves().get(id))
    }

    /// All waveforms as `(id, waveform)`, sorted by id.
    pub fn waves(&self) -> impl Iterator<Item = (&str, &Wave)> {
        let mut by_id = BTreeMap::new();
        for artifact in &self.artifacts {
            by_id.extend(artifact.waves().iter().map(|(id, wave)| (id.as_str(), wave)));
        }
        by_id.into_iter()
    }

    /// The error for a topic that is needed and not there.
    pub fn missing(&self, topic: &str) -> anyhow::Error {
        let given: Vec<String> = self
            .artifacts
            .iter()
            .map(|a| format!("{} ({})", a.path().display(), a.stage().unwrap_or("no stage stated")))
            .collect();
        MissingTopic::new(topic, given.join(", "), writer_of(topic)).into()
    }
}

/// What a stage that can join tests was given.
#[derive(Debug)]
pub enum Tests {
    /// Artifacts of one test.
    One(Inputs),
    /// Two or more tests in the order of their names on the command line, each with its own artifacts.
    Several(Vec<(String, Inputs)>),
}

/// Name and path of an input `NAME:PATH`; `None` for a plain path. A path that exists is a path, whatever is in it.
fn named(input: &Path) -> Option<(&str, &Path)> {
    if input.exists() {
        return None;
    }
    let (name, path) = input.to_str()?.split_once(':')?;
    (!name.is_empty() && !name.contains('/') && !path.is_empty()).then(|| (name, Path::new(path)))
}

/// The path of an input, without the name of its test.
pub(crate) fn path_of(input: &Path) -> &Path {
    named(input).map_or(input, |(_, path)| path)
}

/// Reads artifacts of one test, or of several where each path has the name of its test in front: `NAME:PATH`.
///
/// Provenance then has the kinds `NAME:STAGE`. Errors: as for [`load_artifacts`], test by test; some paths with a name
/// and some without; one name alone; one record under two names.
pub fn load_tests(paths: &[PathBuf]) -> anyhow::Result<Loaded<Tests>> {
    let pairs: Vec<(&str, &Path)> = paths.iter().filter_map(|path| named(path)).collect();
    if pairs.is_empty() {
        return Ok(load_artifacts(paths)?.map(Tests::One));
    }
    let hint = "a:runs/a/default/3-integrate.mcap b:runs/b/default/3-integrate.mcap";
    if let Some(plain) = paths.iter().find(|path| named(path).is_none()) {
        let problem = format!("{} has no name of a test in front, other inputs have one", plain.display());
        return Err(Usage::new(problem).hint(hint).into());
    }
    let mut names: Vec<&str> = Vec::new();
    let mut by_name: BTreeMap<&str, Vec<PathBuf>> = BTreeMap::new();
    for (name, path) in pairs {
        if !names.contains(&name) {
            names.push(name);
        }
        by_name.entry(name).or_default().push(path.to_owned());
    }
    if let [only] = names[..] {
        let problem = format!("{only} is the only test; one model for several tests needs two or more");
        return Err(Usage::new(problem).hint(format!("leave {only}: out for the artifacts of one test")).into());
    }
    let (mut tests, mut digests) = (Vec::new(), Vec::new());
    let mut diagnosed = Diagnosed::default();
    for name in names {
        let loaded = load_artifacts(&by_name[name])?;
        let kind = |input: InputDigest| InputDigest { kind: format!("{name}:{}", input.kind), ..input };
        digests.extend(loaded.digests.into_iter().map(kind));
        for mut diagnosis in loaded.diagnosed.diagnoses {
            diagnosis.reason = format!("{name}: {}", diagnosis.reason);
            diagnosed.diagnoses.push(diagnosis);
        }
        diagnosed.test = diagnosed.test.or(loaded.diagnosed.test);
        tests.push((name.to_owned(), loaded.input));
    }
    refuse_one_record_twice(&tests)?;
    Ok(Loaded { input: Tests::Several(tests), digests, diagnosed })
}

fn refuse_one_record_twice(tests: &[(String, Inputs)]) -> anyhow::Result<()> {
    let mut seen: BTreeMap<String, &str> = BTreeMap::new();
    for (name, inputs) in tests {
        let Some(test) = inputs.record_if::<TestV1>("/test")? else { continue };
        let digest = test.source.digest;
        if let Some(other) = seen.get(&digest).filter(|_| !digest.is_empty()) {
            return Err(Refused::new(format!("{other} and {name} are one record"))
                .expected("several tests")
                .hint("name each test once")
                .into());
        }
        seen.insert(digest, name);
    }
    Ok(())
}

/// The coefficients of a channel class filter and the samples mirrored before it; `None` of any other.
fn class_filter(record: &ChannelFilterV1) -> Option<TwoPassFilter> {
    let is_class = record.mode.starts_with("iso6487") || record.mode.starts_with("sae");
    let coefficients: [f64; 5] = record.coefficients.clone().try_into().ok()?;
    (is_class && record.cfc.is_some())
        .then_some(TwoPassFilter { coefficients, samples_added: record.samples_added as usize })
}

/// Whether both have one interval, and samples at the same instants where they overlap.
fn is_on_grid_of(wave: &Sampled, motion: &Sampled) -> bool {
    let apart = (motion.t0_s() - wave.t0_s()) / wave.dt_s();
    (wave.dt_s() - motion.dt_s()).abs() <= 1e-9 * wave.dt_s() && (apart - apart.round()).abs() <= 1e-3
}

impl Inputs {
    /// The steps from the acceleration of this channel to its motion. Time zero, start and rule are those of the
    /// events: all channels are integrated alike.
    ///
    /// Known are CFC filters with their coefficients, no filter, the trapezoidal rule and forward Euler, at the rate of
    /// the record; else the measurement is exact. Errors: a record that cannot be read.
    pub fn recording_steps(&self, events: &EventsV1, channel: &str, motion: &Sampled) -> anyhow::Result<Measurement> {
        let record: Option<ChannelFilterV1> = self.record_if(&format!("/filter/{channel}"))?;
        let acceleration = self
            .wave_if(channel)
            .map(Wave::signal::<Acceleration>)
            .transpose()
            .refuse()?
            .filter(|wave| is_on_grid_of(wave, motion));
        let (dt_s, t0_s, samples) = match &acceleration {
            Some(wave) => (wave.dt_s(), wave.t0_s(), wave.len()),
            None => (motion.dt_s(), motion.t0_s(), motion.len()),
        };
        let filter = record.as_ref().and_then(class_filter);
        let untouched = record.as_ref().is_some_and(|r| r.coefficients.is_empty() && r.width_s.is_none());
        let test: Option<TestV1> = self.record_if("/test")?;
        let recorded = test.iter().flat_map(|test| &test.channels).find(|recorded| recorded.id == channel);
        let unfiltered = untouched && recorded.and_then(|recorded| recorded.cfc).is_none();
        let as_sampled = record.as_ref().is_some_and(|r| r.resampled_to_hz.is_none());
        let rule = match events.rule.as_deref() {
            None | Some("trapezoid") => Some(IntegrationRule::Trapezoid),
            Some("forward-euler") => Some(IntegrationRule::ForwardEuler),
            Some(_) => None,
        };
        let known = acceleration.is_some() && as_sampled && (filter.is_some() || unfiltered);
        // Behind a filter no sample shows the step of its sensor any more.
        let step = acceleration.as_ref().filter(|_| unfiltered).and_then(|wave| coarse_step(wave.samples()));
        let before_event = acceleration.as_ref().and_then(|wave| BeforeEvent::of(wave, filter.as_ref(), step));
        let measurement = Measurement {
            dt_s,
            first_s: t0_s,
            samples,
            filter,
            from_contact: events.start.as_deref() != Some("record-start"),
            rule,
            before_event,
        };
        Ok(if known && rule.is_some() { measurement } else { measurement.exact() })
    }
}

impl Inputs {
    /// The sum of the load cells that integrate wrote, N, positive in compression, with the filter of its cells; `None`
    /// without one.
    ///
    /// The measurement is known where all cells with data went through one filter at their own rate, else exact.
    /// Errors: a record that cannot be read.
    pub fn wall_force(&self) -> anyhow::Result<Option<(Sampled, Measurement)>> {
        let Some(wave) = self.wave_if("barrier/force") else { return Ok(None) };
        let force = wave.sampled.clone();
        let test = self.test()?;
        let is_cell = |location: &str| location.trim().to_lowercase().starts_with("barrier");
        let cells = test.channels.iter().filter(|c| c.quantity == QuantityKind::Force && is_cell(&c.location));
        let mut filters: Vec<TwoPassFilter> = Vec::new();
        let mut known = true;
        for cell in cells {
            let Some(record) = self.record_if::<ChannelFilterV1>(&format!("/filter/{}", cell.id))? else { continue };
            match class_filter(&record).filter(|_| record.resampled_to_hz.is_none()) {
                Some(filter) => filters.push(filter),
                None => known = false,
            }
        }
        filters.dedup();
        known &= filters.len() == 1;
        let measurement = Measurement {
            dt_s: force.dt_s(),
            first_s: force.t0_s(),
            samples: force.len(),
            filter: filters.pop(),
            from_contact: false,
            rule: Some(IntegrationRule::Trapezoid),
            // What is not known of a sum of load cells are their gains more than their noise.
            before_event: None,
        };
        Ok(Some((force, if known { measurement } else { measurement.exact() })))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_artifact::records::MetricsV2;
    use crumple_artifact::{ArtifactBuilder, Compression, Provenance, put_json};

    /// An artifact of a stage about the record with this digest.
    fn written(folder: &Path, name: &str, stage: &str, record: &str) -> PathBuf {
        made_from(folder, name, (stage, record, 900.0), Vec::new())
    }

    /// The same of a mass, kg, with what it says it was made from.
    fn made_from(
        folder: &Path,
        name: &str,
        (stage, record, mass_kg): (&str, &str, f64),
        inputs: Vec<InputDigest>,
    ) -> PathBuf {
        let source = serde_json::json!({"format": "csv", "name": "crash.csv", "digest": record});
        let test = serde_json::json!({"title": "", "mass_kg": mass_kg, "source": source, "channels": []});
        let mut builder = ArtifactBuilder::new();
        put_json(&mut builder, "/test", TestV1::SCHEMA, test).unwrap();
        let path = folder.join(name);
        let provenance = Provenance::new(stage, "0.1.0", "{}".into(), inputs);
        builder.write(&path, &provenance, Compression::None).unwrap();
        path
    }

    #[test]
    fn a_stage_without_a_result_is_the_reason_for_what_is_missing() {
        let diagnosis = DiagnosisV1 { stage: "identify".to_owned(), reason: "no poles".to_owned(), has_result: false };
        let diagnosed = Diagnosed { diagnoses: vec![diagnosis], ..Diagnosed::default() };
        let missing = |writers| MissingTopic::new("/model", String::new(), writers);
        let reason = diagnosed.reason_for(&missing(&["identify"])).unwrap();
        assert_eq!(reason, "nothing to work on, since identify says: no poles");
        assert_eq!(diagnosed.reason_for(&missing(&["filter"])), None);
    }

    #[test]
    fn two_artifacts_of_one_stage_and_artifacts_of_two_records_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name, stage, record| written(folder.path(), name, stage, record);
        let filter = write("2.mcap", "filter", "blake3:aa");
        let integrate = write("3.mcap", "integrate", "blake3:aa");
        let of_another_record = write("3b.mcap", "integrate", "blake3:bb");
        let unnamed = write("x.mcap", "", "");
        let problem = |paths: &[&PathBuf]| {
            let paths: Vec<PathBuf> = paths.iter().map(|path| (*path).clone()).collect();
            let refused = load_artifacts(&paths).err().map(|error| error.to_string());
            refused.map(|text| text.replace(&format!("{}/", folder.path().display()), ""))
        };
        assert_eq!(problem(&[&integrate, &filter]), None);
        assert_eq!(problem(&[&filter, &unnamed]), None, "who does not name stage or record is believed");
        assert_eq!(problem(&[&filter, &of_another_record]).unwrap(), "2.mcap and 3b.mcap are of different records");
        assert_eq!(
            problem(&[&of_another_record, &integrate]).unwrap().split(" are ").nth(1),
            Some("both of the stage integrate")
        );
    }

    #[test]
    fn artifacts_that_were_not_made_from_each_other_or_are_of_two_masses_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let solve = written(folder.path(), "5.mcap", "parameter-solve", "blake3:aa");
        let digest = open(&solve).unwrap().digest().to_owned();
        let simulated = |name: &str, mass_kg: f64, digest: &str| {
            let input = InputDigest { kind: "parameter-solve".to_owned(), digest: digest.to_owned() };
            made_from(folder.path(), name, ("simulate", "blake3:aa", mass_kg), vec![input])
        };
        let problem = |other: PathBuf| {
            let refused = load_artifacts(&[solve.clone(), other]).err().map(|error| error.to_string());
            refused.map(|text| text.replace(&format!("{}/", folder.path().display()), ""))
        };
        assert_eq!(problem(simulated("6.mcap", 900.0, &digest)), None);
        let other = problem(simulated("6b.mcap", 900.0, "blake3:ff")).unwrap();
        assert_eq!(other, "6b.mcap was made from another 5-parameter-solve than 5.mcap");
        let other = problem(simulated("6c.mcap", 9.2e18, &digest)).unwrap();
        assert_eq!(other, "5.mcap and 6c.mcap describe different tests: mass_kg is 900.0 and 9.2e+18");
    }

    #[test]
    fn events_and_metrics_have_one_dynamic_crush() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("3.mcap");
        let problem = |of_metrics: f64| {
            let mut builder = ArtifactBuilder::new();
            let events = EventsV1 { channel: "93".to_owned(), dynamic_crush_m: Some(0.7), ..EventsV1::default() };
            builder.put("/events", &events).unwrap();
            let metric = serde_json::json!({"name": "dynamic_crush", "value": of_metrics, "unit": "m", "channel": "93",
                "definition": ""});
            put_json(&mut builder, "/metrics", MetricsV2::SCHEMA, serde_json::json!({"metrics": [metric]})).unwrap();
            let provenance = Provenance::new("integrate", "0.1.0", "{}".into(), Vec::new());
            builder.write(&path, &provenance, Compression::None).unwrap();
            load_artifacts(std::slice::from_ref(&path)).err().map(|error| error.to_string())
        };
        assert_eq!(problem(0.7001), None, "four digits");
        assert_eq!(problem(0.700_6), None, "within a thousandth");
        let two = problem(1.7).unwrap();
        assert!(two.ends_with("dynamic_crush is 1.7000 m in /metrics, 0.7000 m in /events [CR307]"), "{two}");
    }

    #[test]
    fn a_name_stands_before_the_path_of_its_test() {
        assert_eq!(named(Path::new("a:x/3.mcap")), Some(("a", Path::new("x/3.mcap"))));
        assert_eq!(path_of(Path::new("a:x/3.mcap")), Path::new("x/3.mcap"));
        for plain in ["x/3.mcap", "x/y:3.mcap", ":3.mcap", "a:"] {
            assert_eq!(named(Path::new(plain)), None, "{plain}");
        }
        let folder = tempfile::tempdir().unwrap();
        let odd = folder.path().join("a:b");
        std::fs::write(&odd, "").unwrap();
        assert_eq!(named(&odd), None);
    }

    #[test]
    fn one_name_alone_and_a_missing_name_are_refused() {
        let refused = |paths: &[&str]| load_tests(&paths.iter().map(PathBuf::from).collect::<Vec<_>>()).unwrap_err();
        let alone = refused(&["a:2.mcap", "a:3.mcap"]).to_string();
        assert!(alone.starts_with("a is the only test"), "{alone}");
        let mixed = refused(&["a:2.mcap", "3.mcap"]).to_string();
        assert!(mixed.starts_with("3.mcap has no name of a test in front"), "{mixed}");
    }
}
