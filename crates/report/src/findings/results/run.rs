//! What a report is made from, wherever it was read.

use std::collections::{BTreeMap, BTreeSet};

use crumple_artifact::records::{
    CandidateV1, Certainty, ChannelFilterV1, Doubt, EventsV1, EvidenceV1, IdentificationV1, ImpactV1, MatchingV1,
    MetricV1, ModeV1, OtherPoleKindV1, OtherPoleV1, PredictionV1, RatedCandidateV1, RecommendationV1, RemarkV1,
    ResponseV1, SelectionV1, SimulationV1, StabilizationV1, StateSpaceV1, TransferFunctionV1,
};
use crumple_lumped::{ParameterKind, parameter_kind};
use crumple_signal::{Axis, Channel, Sampled, TestDescription};
use crumple_stage::Pipeline;
use crumple_stage::is_no_result;
use serde::{Deserialize, Serialize};

use crate::drawing::numbers::NBSP;
use crate::findings::names::{name_among, the_model};
use crate::findings::results::joint::JointTests;
use crate::findings::results::model_output::ModelOutput;
use crate::findings::text::short;

/// Everything that is known about a run. Parts whose stage has not run are empty.
#[derive(Debug, Clone, Default)]
pub struct Run {
    /// Name of the pipeline, e.g. `default` or `papers/civic`, if it has one.
    pub pipeline: Option<String>,
    /// The test.
    pub test: TestDescription,
    /// The tests, where the models are of several.
    pub joint: Option<JointTests>,
    /// The waves of the channel the crash was read from.
    pub measured: MeasuredWaves,
    /// Other sensors whose motion is at hand, in the order of their ids.
    pub other_sensors: Vec<SensorMotion>,
    /// The changes of velocity that a recorder kept, by channel.
    pub recorded_changes: Vec<(String, Sampled)>,
    /// How that channel was filtered.
    pub filter: Option<ChannelFilterV1>,
    /// The events of the crash.
    pub events: Option<EventsV1>,
    /// Every impact of the pulse, in the order of time.
    pub impacts: Vec<ImpactV1>,
    /// Crash metrics, in the order of the artifact.
    pub metrics: Vec<MetricV1>,
    /// Identified models by id.
    pub models: Vec<Model>,
    /// Comparisons of the models of one output.
    pub selections: Vec<SelectionV1>,
    /// Stabilisation diagrams, by method.
    pub stabilizations: Vec<StabilizationV1>,
    /// What coefficient matching found, by the id of the identified model.
    pub matchings: Vec<(String, MatchingV1)>,
    /// Which candidate to use, and why; `None`: an artifact of before, or of another program.
    pub recommendation: Option<RecommendationV1>,
    /// Impacts that were predicted, in their order.
    pub predictions: Vec<PredictionV1>,
    /// Candidates in id order: by model, method and the number at the end.
    pub candidates: Vec<CandidateResult>,
    /// Number of responses in the simulate stage's artifact; `None`: there is no such artifact.
    pub responses: Option<usize>,
    /// What the stages remarked, in stage order, of each the strongest first; each remark once.
    pub remarks: Vec<RemarkV1>,
    /// Channels that may be clipped, as ingest found.
    pub clipped: Vec<String>,
    /// What the results contradict each other in.
    pub contradictions: Vec<RemarkV1>,
    /// Codes of the remarks that the pipeline allows.
    pub allowed: BTreeSet<String>,
    /// Where the artifacts came from, in stage order.
    pub provenance: Vec<StageRecord>,
    /// Why a stage has a result but not what later ones work on: nothing was to be simulated.
    pub without: Option<String>,
    /// What is not in the report, and which stage would supply it.
    pub missing: Vec<String>,
}

/// What samples are taken for where nobody knows the input, and the name of the diagram of their modes.
const AMBIENT: &str = "ambient";

/// Share by which speeds and masses differ that are one, as a person types them.
const ROUNDED: f64 = 0.005;

/// The waves of the pulse channel, SI, on the record's time axis.
#[derive(Debug, Clone, Default)]
pub struct MeasuredWaves {
    /// Acceleration as read.
    pub raw: Option<Sampled>,
    /// Acceleration as filtered.
    pub filtered: Option<Sampled>,
    /// Velocity.
    pub velocity: Option<Sampled>,
    /// Displacement: the crush.
    pub displacement: Option<Sampled>,
    /// Force on the barrier, positive in compression: the test mass times the deceleration.
    pub force: Option<Sampled>,
    /// Force on the barrier as its load cells measured it, positive in compression.
    pub barrier_force: Option<Sampled>,
}

/// The motion that another sensor on the vehicle saw.
#[derive(Debug, Clone)]
pub struct SensorMotion {
    /// Its channel.
    pub channel: String,
    /// Velocity, where there is one.
    pub velocity: Option<Sampled>,
    /// Displacement.
    pub displacement: Sampled,
}

/// One identified model.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// Id, e.g. `era-4`.
    pub id: String,
    /// How it was identified.
    pub identification: Option<IdentificationV1>,
    /// Its continuous transfer function.
    pub transfer_function: Option<TransferFunctionV1>,
    /// All its transfer functions, by output and input.
    pub paths: Vec<TransferFunctionV1>,
    /// Its state space: the sampled one where there is one.
    pub state_space: Option<StateSpaceV1>,
    /// Its outputs, in their order.
    pub outputs: Vec<ModelOutput>,
    /// What drives it: name and samples.
    pub inputs: Vec<(String, Sampled)>,
    /// Its modes.
    pub modes: Vec<ModeV1>,
    /// Its poles that are no modes.
    pub other_poles: Vec<OtherPoleV1>,
    /// Its responses in frequency and time.
    pub response: Option<ResponseV1>,
    /// What speaks for it, with the deviations of its modes where the method gives them.
    pub evidence: Option<EvidenceV1>,
}

/// Where a pole lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoleStability {
    /// Its motion dies down.
    Stable,
    /// On the limit: its motion neither dies down nor grows within the record.
    Marginal,
    /// Its motion grows.
    Unstable,
}

/// Growth or decay of a pole over the whole record below which it is rounding, as identify counts it.
const MARGINAL: f64 = 1e-6;

impl Run {
    /// The modes of a record that nobody knows the input of, where its models are of such a record.
    pub fn ambient(&self) -> Option<&StabilizationV1> {
        let is_ambient = |model: &Model| model.identification.as_ref().is_some_and(|i| i.treated_as == AMBIENT);
        let diagram = self.stabilizations.iter().find(|diagram| diagram.method == AMBIENT);
        diagram.filter(|_| self.models.iter().all(is_ambient))
    }

    /// Places of the identified models in the order that they are named and shown in: those that hold on unseen samples
    /// first, then by their fit, of unseen samples where some were kept. Where none were, the ones that the comparison
    /// of the models recommends stand first among those that hold.
    pub fn model_order(&self) -> Vec<usize> {
        let has_unseen = self.models.iter().any(|model| model.unseen_fit_percent().is_some());
        let is_chosen = |model: &Model| !has_unseen && model.holds() && self.is_recommended(&model.id);
        let fit = |model: &Model| model.unseen_fit_percent().or(model.fit_percent()).unwrap_or(f64::NEG_INFINITY);
        let mut order: Vec<usize> = (0..self.models.len()).collect();
        order.sort_by(|a, b| {
            let (a, b) = (&self.models[*a], &self.models[*b]);
            (b.holds(), is_chosen(b)).cmp(&(a.holds(), is_chosen(a))).then(fit(b).total_cmp(&fit(a)))
        });
        order
    }

    /// Whether the comparison of the models of an output recommends the identified model of this id.
    pub fn is_recommended(&self, id: &str) -> bool {
        self.selections.iter().any(|selection| selection.recommended.as_deref() == Some(id))
    }
}

impl Model {
    /// All its poles, the modes first: real part (1/s), imaginary part (rad/s), and where each lies.
    pub fn poles(&self) -> impl Iterator<Item = ([f64; 2], PoleStability)> {
        let modes = self.modes.iter().map(|mode| ([mode.re_per_s, mode.im_rad_per_s], false));
        let others = self
            .other_poles
            .iter()
            .map(|pole| ([pole.re_per_s, pole.im_rad_per_s], pole.kind == OtherPoleKindV1::Integrator));
        let limit_per_s =
            self.identification.as_ref().map_or(0.0, |i| MARGINAL / (i.to_s - i.from_s).max(f64::MIN_POSITIVE));
        modes.chain(others).map(move |(pole, is_integrator)| {
            let stability = match pole[0] {
                _ if is_integrator => PoleStability::Marginal,
                re if re > limit_per_s => PoleStability::Unstable,
                re if re < -limit_per_s => PoleStability::Stable,
                _ => PoleStability::Marginal,
            };
            (pole, stability)
        })
    }

    /// Its fit of samples that it has not seen, percent, where such were kept: with the start fitted, where the method
    /// can.
    pub fn unseen_fit_percent(&self) -> Option<f64> {
        let evidence = self.evidence.as_ref()?;
        evidence.validation_restarted_fit_percent.or(evidence.validation_fit_percent)
    }

    /// Whether its transfer functions are what was fitted.
    pub fn is_transfer_function(&self) -> bool {
        !self.paths.is_empty() && self.state_space.as_ref().is_none_or(|model| model.sample_time_s == 0.0)
    }

    /// Fit of the samples it was identified from, percent.
    pub fn fit_percent(&self) -> Option<f64> {
        self.identification.as_ref()?.fit_percent
    }

    /// Whether it follows its own samples better than their mean does, and unseen ones as [`EvidenceV1`] asks.
    pub fn holds(&self) -> bool {
        let unseen = self.evidence.as_ref().and_then(|evidence| evidence.holds_on_unseen);
        self.fit_percent().is_some_and(|fit| fit > 0.0) && unseen != Some(false)
    }
}

/// One set of physical parameters and what it answers with.
#[derive(Debug, Clone, Default)]
pub struct CandidateResult {
    /// `<model>/<method>/<index>`.
    pub id: String,
    /// The parameters.
    pub record: CandidateV1,
    /// The comparison with the test; `None`: it was not simulated.
    pub simulation: Option<SimulationV1>,
    /// Displacement of the compartment.
    pub displacement: Option<Sampled>,
    /// Velocity of the compartment.
    pub velocity: Option<Sampled>,
    /// Acceleration of the compartment.
    pub acceleration: Option<Sampled>,
    /// Its springs and dampers at work, from the barrier on.
    pub elements: Vec<Element>,
    /// Displacement and velocity of its masses but the compartment, from the barrier on.
    pub masses: Vec<(Sampled, Option<Sampled>)>,
}

impl CandidateResult {
    /// Whether it is a chain that a person stated.
    pub fn is_chain(&self) -> bool {
        self.record.model == "chain"
    }

    /// Its model within a sentence, without knots and method: `the elastoplastic spring`.
    pub fn in_a_sentence(&self) -> String {
        the_model(&self.record.model, &self.record.parameters)
    }

    /// Displacement fit of its simulation, percent, as the record was measured; of the motion itself where that was not
    /// computed.
    pub fn fit_percent(&self) -> Option<f64> {
        let simulation = self.simulation.as_ref()?;
        simulation.fit_as_measured_percent.or(simulation.fit_percent)
    }

    /// Channels it was fitted to beside the pulse, with the mass that each sits on, from 1 at the barrier.
    pub fn other_channels(&self) -> impl Iterator<Item = (&str, u32)> {
        let fit = self.record.fit.as_ref();
        let sensors = fit.map(|fit| fit.sensors.as_slice()).unwrap_or_default();
        let pulse = fit.map(|fit| fit.channel.as_str());
        sensors.iter().filter(move |s| Some(s.channel.as_str()) != pulse).map(|s| (s.channel.as_str(), s.mass))
    }

    /// Why the value of a parameter is in doubt, in words.
    pub fn doubt(&self, name: &str) -> Option<&'static str> {
        self.record.doubt(name).map(doubt_in_words)
    }

    /// What its intervals hold; nothing without any.
    pub fn about_intervals(&self) -> String {
        let Some(known) = self.record.uncertainty.as_ref().filter(|known| !known.interval_low.is_empty()) else {
            return String::new();
        };
        // Intervals are those of the best fit, made longer where a value lies outside of them.
        let is_end = |(name, value): (&String, &f64)| {
            let ends = [&known.interval_low, &known.interval_high];
            *value != 0.0 && ends.iter().any(|ends| ends.get(name) == Some(&Some(*value)))
        };
        let widened = if self.record.parameters.iter().any(is_end) { ", stretched to hold the value" } else { "" };
        format!("; 95{NBSP}% intervals, mass and sensor gain taken as exact{widened}")
    }

    /// Whether it is a chain of two whose masses were looked for by a sensor on the last one alone: their division
    /// follows from a formula and, with any noise, not from the record.
    pub fn divides_by_formula(&self) -> bool {
        let fit = self.record.fit.as_ref();
        let sees_the_front = fit.is_some_and(|fit| fit.sensors.iter().any(|sensor| sensor.mass == 1));
        let two = self.record.parameters.contains_key("m2_kg") && !self.record.parameters.contains_key("m3_kg");
        let mut asked = self.record.asked();
        self.is_chain()
            && two
            && !sees_the_front
            && asked.any(|name| parameter_kind(&self.record.model, name) == Some(ParameterKind::Mass))
    }

    /// How many of its numbers the record determines: what conclusion, picture, tables, console and summary count.
    pub fn certainties(&self) -> IdentifiabilityCounts {
        let names = |certainty| self.record.parameters_of(certainty).into_iter().map(str::to_owned).collect();
        let [mut open, order_of_magnitude]: [Vec<String>; 2] =
            [Certainty::Open, Certainty::OrderOfMagnitude].map(names);
        if self.divides_by_formula() {
            open.push("the division of the mass".to_owned());
        }
        let parameters = self.record.asked().count();
        let determined = parameters.saturating_sub(open.len() + order_of_magnitude.len());
        IdentifiabilityCounts { parameters, determined, order_of_magnitude, open }
    }
}

/// Why the value of a parameter is in doubt, in words.
pub fn doubt_in_words(doubt: Doubt) -> &'static str {
    match doubt {
        Doubt::OnBound => "on a bound",
        Doubt::NotDetermined => "not determined",
    }
}

/// How sure a record is of the numbers of a candidate that were asked of it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct IdentifiabilityCounts {
    /// How many were asked of it.
    pub parameters: usize,
    /// How many of them it determines.
    pub determined: usize,
    /// Names of those known to an order of magnitude only.
    pub order_of_magnitude: Vec<String>,
    /// What may be anything: names, and the division of the mass in words.
    pub open: Vec<String>,
}

impl IdentifiabilityCounts {
    /// `3 of 4`.
    pub fn counts(&self) -> String {
        format!("{} of {}", self.determined, self.parameters)
    }

    /// How sure a candidate is, in the words of every place that says it: `3 of 4 numbers determined, 1 to an order of
    /// magnitude`. `None`: nothing was asked of the record.
    pub fn words(&self) -> Option<String> {
        let others = not_determined(self.order_of_magnitude.len(), self.open.len());
        (self.parameters > 0).then(|| format!("{} parameters determined{others}", self.counts()))
    }
}

/// `, 1 with a wide interval, 2 open`: what stands behind how many parameters are determined.
pub(crate) fn not_determined(wide: usize, open: usize) -> String {
    let counted = |count: usize, what: &str| if count > 0 { format!(", {count} {what}") } else { String::new() };
    counted(wide, "with a wide interval") + &counted(open, "open")
}

/// A spring or damper at work.
#[derive(Debug, Clone)]
pub struct Element {
    /// `k`, `c`, `k2`, ...
    pub name: String,
    /// Its force, N, positive in compression.
    pub force: Sampled,
    /// How far the masses at its ends have come together, m.
    pub deflection: Vec<f64>,
}

/// One artifact's origin.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct StageRecord {
    /// The stage that wrote it.
    pub stage: String,
    /// The stage's version.
    pub version: String,
    /// Digest of the artifact's content.
    pub digest: String,
    /// Its settings as canonical JSON.
    pub settings: String,
    /// Kind and digest of each of its inputs.
    pub inputs: Vec<(String, String)>,
    /// The program from elsewhere that stood for the stage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub program: Option<StageProgram>,
}

/// A program from elsewhere that stands for a stage.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct StageProgram {
    /// The stage.
    pub stage: String,
    /// Its command as it was typed.
    pub command: String,
    /// The files that the command names, with their digests: the program, a script.
    pub files: BTreeMap<String, String>,
}

impl StageRecord {
    /// Names the program that wrote it, where a run notes one from elsewhere.
    pub fn name_program(&mut self, pipeline: &Pipeline) {
        let stage = self.stage.clone();
        let files = pipeline.files(&stage);
        self.program =
            pipeline.typed("program", &stage).map(|typed| StageProgram { stage, command: typed.to_owned(), files });
    }

    /// The version of the stage, or the program that stood for it with its files: `python3 my.py (my.py 1a2b3c4d)`.
    pub fn made_by(&self) -> String {
        let Some(program) = &self.program else { return self.version.clone() };
        let files: Vec<String> =
            program.files.iter().map(|(name, digest)| format!("{name} {}", short(digest))).collect();
        if files.is_empty() { program.command.clone() } else { format!("{} ({})", program.command, files.join(", ")) }
    }
}

impl Run {
    /// Id of the channel the crash was read from: what the events name, else the test's pulse.
    pub fn channel_id(&self) -> Option<&str> {
        match &self.events {
            Some(events) => Some(&events.channel),
            None => self.test.pulse_channel().ok().map(|channel| channel.id.as_str()),
        }
    }

    /// That channel's description.
    pub fn channel(&self) -> Option<&Channel> {
        self.test.channel(self.channel_id()?)
    }

    /// The acceleration the analysis worked on: filtered where there is such a wave, else as read.
    pub fn acceleration(&self) -> Option<&Sampled> {
        self.measured.filtered.as_ref().or(self.measured.raw.as_ref())
    }

    /// Time of dynamic crush, s, if the record shows it.
    pub fn time_of_crush_s(&self) -> Option<f64> {
        self.events.as_ref()?.time_of_dynamic_crush_s
    }

    /// Dynamic crush of the test, of several the deepest, m: a prediction of more extrapolates.
    pub fn tested_crush_m(&self) -> Option<f64> {
        let of_joint = self.joint.iter().flat_map(|joint| &joint.tests).filter_map(|of| of.test.dynamic_crush_m);
        self.events.as_ref().and_then(|events| events.dynamic_crush_m).into_iter().chain(of_joint).reduce(f64::max)
    }

    /// The tested crush, m, where a prediction of this kind goes beyond the test. Against a partner, whose model may be
    /// the one that does, only where the vehicle is crushed further.
    pub fn exceeded_tested_crush_m(&self, is_meant: impl Fn(&PredictionV1) -> bool) -> Option<f64> {
        let tested_m = self.tested_crush_m()?;
        let further = |p: &PredictionV1| p.dynamic_crush_m.is_none_or(|crush_m| crush_m > tested_m);
        let is_beyond = |p: &PredictionV1| p.extrapolates && (p.partner.is_none() || further(p));
        // Who asked for a speed is told of that.
        let is_asked = self.predictions.iter().any(|p| p.asked);
        let is_meant = |p: &PredictionV1| is_meant(p) && (p.asked || !is_asked);
        self.predictions.iter().any(|p| is_meant(p) && is_beyond(p)).then_some(tested_m)
    }

    /// The axis of the pulse, where it is another than that of the models, x.
    pub fn other_axis(&self) -> Option<Axis> {
        self.channel()?.axis.filter(|axis| *axis != Axis::X)
    }

    /// Whether the record ends before the rebound does: restitution and change of velocity are lower bounds.
    pub fn is_rebound_cut(&self) -> bool {
        self.events.as_ref().is_some_and(|events| events.still_separating)
    }

    /// Whether the velocity still changes where the record ends: its change is a lower bound.
    pub fn is_change_cut(&self) -> bool {
        self.is_rebound_cut() || self.metric("delta_v").is_some_and(|metric| metric.is_lower_bound)
    }

    /// The metric of this name; one of the pulse channel goes before one of another channel.
    pub fn metric(&self, name: &str) -> Option<&MetricV1> {
        let of_name = || self.metrics.iter().filter(|metric| metric.name == name);
        of_name().find(|metric| Some(metric.channel.as_str()) == self.channel_id()).or_else(|| of_name().next())
    }

    /// Metrics of channels that the pulse has none of: criteria of occupants, the barrier, the tables of a recorder.
    pub fn metrics_of_others(&self) -> impl Iterator<Item = &MetricV1> {
        let pulse = self.channel_id();
        self.metrics.iter().filter(move |metric| {
            let of_pulse = |other: &MetricV1| Some(other.channel.as_str()) == pulse;
            pulse.is_some()
                && !metric.channel.is_empty()
                && !of_pulse(metric)
                && !self.metrics.iter().any(|other| of_pulse(other) && other.name == metric.name)
        })
    }

    /// Whether the models are of inputs and outputs and nothing speaks of a crash.
    pub fn is_generic(&self) -> bool {
        self.channel_id().is_none() && self.candidates.is_empty() && !self.models.is_empty()
    }

    /// Whether a prediction is of the mass of the test; where none is stated it is of no other.
    pub fn is_of_own_mass(&self, prediction: &PredictionV1) -> bool {
        self.test.mass_kg.is_none_or(|own_kg| (prediction.mass_kg - own_kg).abs() <= ROUNDED * own_kg)
    }

    /// Whether a prediction is of the impact that the test was.
    pub fn is_as_tested(&self, prediction: &PredictionV1) -> bool {
        let speed = prediction.impact_speed_m_per_s;
        let is_own_speed = self.test.impact_speed_m_per_s.is_some_and(|own| (speed - own).abs() <= ROUNDED * own);
        is_own_speed && self.is_of_own_mass(prediction) && prediction.partner.is_none()
    }

    /// The candidate of this id.
    pub fn candidate(&self, id: &str) -> Option<&CandidateResult> {
        self.candidates.iter().find(|candidate| candidate.id == id)
    }

    /// What a candidate is, in words that no other candidate of the run has: `Kelvin model (fitted)`. At the start of a
    /// sentence or of a cell see [`capitalised`](crate::findings::capitalised).
    pub fn name_of(&self, id: &str) -> String {
        name_among(id, self.candidates.iter().map(|candidate| (&*candidate.id, &candidate.record.parameters)))
    }

    /// What the choice says of a candidate, where it was among them.
    pub fn rated(&self, id: &str) -> Option<&RatedCandidateV1> {
        self.recommendation.as_ref()?.candidates.iter().find(|rated| rated.id == id)
    }

    /// Whether a stage has said that it has no acceptable result and no reason why that is one.
    pub fn without_result(&self) -> bool {
        self.without.is_none() && self.remarks.iter().any(is_no_result)
    }

    /// What is good to know of it.
    pub fn infos(&self) -> impl Iterator<Item = &RemarkV1> {
        self.remarks.iter().filter(|remark| !remark.is_warning())
    }

    /// Whether candidates were to be simulated and not one of them came through.
    pub fn no_candidate_simulated(&self) -> bool {
        self.responses == Some(0)
    }
}
