//! Reads the raw channels, filters them, writes them with the record of how.

mod align;
mod derived;
mod options;
mod record;
mod remarks;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Mutex;

use crumple_filter::{
    Applied, Cfc, Class, FilterError, Filtered, Pass, SelectionError, Settings, class_of_body, filter_reporting,
    id_meant, ids_meant, is_barrier_force, occupants_left, resample, select,
};
use crumple_signal::{Channel, ChannelStatus, Note, QuantityKind, Severity, TestDescription, part_of};
use crumple_stage::records::TestV1;
use crumple_stage::{Inputs, Loaded, Outcome, Output, RefuseExt, Refused, Stage, Wave};
use rayon::prelude::*;

use crate::stage::align::align;
use crate::stage::derived::derived;
use crate::stage::options::{Align, Options, StageSettings};
use crate::stage::record::{Extra, pulse_line, record};
use crate::stage::remarks::{Remarks, first_of};

/// The stage.
pub struct Filter;

impl Stage for Filter {
    const NAME: &'static str = "filter";
    const ABOUT: &'static str = "Removes the zero level of the acceleration channels \
         and filters them to a channel frequency class (ISO 6487, SAE J211-1).";
    type Options = Options;
    type Settings = StageSettings;
    type Input = Inputs;

    fn typed(options: &mut Options, is_flag: &dyn Fn(&str) -> bool) {
        options.note_typed(is_flag);
    }

    fn resolve(options: Options) -> anyhow::Result<StageSettings> {
        Ok(options.try_into()?)
    }

    fn load(paths: &[PathBuf], _: &StageSettings) -> anyhow::Result<Loaded<Inputs>> {
        crumple_stage::load_artifacts(paths)
    }

    fn run(settings: &StageSettings, input: &Inputs, out: &mut Output) -> anyhow::Result<Outcome> {
        let mut test = input.test()?;
        let mut pulse = test.pulse_channel().ok().map(|channel| channel.id.clone());
        const HINT: &str = "crumple-artifact show lists the channels of an artifact";
        let mut pass = ids_meant(&test, &settings.pass).refuse_with_hint(HINT)?;
        let mut remarks = Remarks::default();
        // A list of channels means those alone.
        let by_default = settings.channels.is_empty();
        let mut with_derived = test.clone();
        let derived =
            if by_default { derived(&settings.filter, input, &mut with_derived, &mut remarks)? } else { None };
        if by_default {
            // What a recorder kept says its largest change by itself.
            let change = |channel: &&Channel| {
                channel.quantity == QuantityKind::VelocityChange
                    && input.wave_if(&channel.id).is_some()
                    && !pass.contains(&channel.id)
            };
            let changes: Vec<String> = test.channels.iter().filter(change).map(|channel| channel.id.clone()).collect();
            pass.extend(changes);
        }
        let jobs = jobs(settings, &pass, input, &test, derived.is_some(), &mut remarks)?;
        let mut done = Vec::new();
        for (job, result) in jobs.iter().zip(filter_all(&jobs, out)) {
            match result {
                Ok(filtered) => {
                    for note in filtered.notes.iter() {
                        remarks.add(&job.id, note.clone());
                    }
                    done.push(Done {
                        id: job.id.clone(),
                        quantity: job.wave.quantity,
                        filtered,
                        extra: Extra::default(),
                        for_criteria: job.for_criteria,
                    });
                }
                // A channel nobody asked for does not stop the others.
                Err(error) if settings.channels.is_empty() && pulse.as_ref() != Some(&job.id) => {
                    remarks.add(&job.id, Note { severity: Severity::Warning, text: format!("left out: {error}") });
                }
                Err(error) => {
                    return Err(Refused::new(format!("channel {}: {error}", job.id)).hint(hint(&error)).into());
                }
            }
        }
        drop(jobs);
        done.extend(derived);
        test = with_derived;
        pulse = test.pulse.clone().or(pulse);
        if let Some(asked) = &settings.align {
            let to = id_meant(&test, &asked.to).refuse_with_hint(HINT)?;
            align(&mut done, &Align { to, ..*asked }, &mut remarks)?;
        }
        if let Some(to) = settings.resample {
            for done in &mut done {
                let from_hz = done.filtered.samples.rate_hz();
                done.filtered.samples = resample(&done.filtered.samples, to)
                    .refuse_with_hint("--resample takes a rate such as 10kHz; leave it out to keep the record's own")?;
                done.extra.resampled_to_hz = Some(to.rate_hz);
                let how = to.interpolation.name();
                remarks.info(&done.id, format!("resampled from {from_hz:.0} Hz to {:.0} Hz ({how})", to.rate_hz));
            }
        }

        let ids: Vec<String> = done.iter().map(|done| done.id.clone()).collect();
        for Done { id, quantity, filtered, extra, .. } in done {
            let channel = test.channels.iter_mut().find(|channel| channel.id == id);
            let cfc = channel.and_then(|channel| {
                match filtered.applied.as_ref() {
                    Some(Applied::Class { cfc, .. }) => channel.cfc = Some(cfc.number()),
                    // A channel without its low frequencies is of no class; one smoothed further keeps its own.
                    Some(Applied::Butterworth { design, .. }) if !matches!(design.asked.pass, Pass::Low(_)) => {
                        channel.cfc = None;
                    }
                    _ => {}
                }
                channel.cfc
            });
            if pulse.as_ref() == Some(&id) {
                out.summary(pulse_line(&id, cfc, &filtered));
            }
            out.put(&format!("/filter/{id}"), &record(&filtered, &extra))?;
            out.wave(&id, quantity, filtered.samples)?;
        }
        for id in pass.iter().filter(|id| !ids.contains(id)) {
            let wave = input.wave(id)?;
            out.wave(id, wave.quantity, wave.sampled.clone())?;
            remarks.info(id, "handed on as it is");
        }
        if ids.len() > 1 {
            out.summary(format!("{} channels: {}", ids.len(), first_of(&ids)));
        }
        out.notes().extend(remarks.into_notes());
        out.put("/test", &TestV1::from(&test))?;
        Ok(Outcome::Done)
    }
}

/// The one thing to do about a channel that cannot be filtered.
fn hint(error: &FilterError) -> &'static str {
    match error {
        FilterError::Order { .. } => "--order 4 is usual",
        FilterError::Cutoff { .. } => "--cutoff takes the -3 dB frequency with its unit, e.g. --cutoff 100Hz",
        FilterError::Band { .. } => "--cutoff is the lower end of a band, --cutoff-high the upper one",
        FilterError::Width { .. } => "--moving-average takes a time such as 3ms",
        FilterError::Window { .. } => "--zero-level-from comes before --zero-level-to",
        _ => "--cfc none leaves the signal as it is, --channels names the channels to filter",
    }
}

/// A channel on its way in.
struct Job<'a> {
    id: String,
    wave: &'a Wave,
    cfc: Option<u16>,
    settings: Settings,
    for_criteria: bool,
}

/// A channel on its way out.
pub struct Done {
    pub id: String,
    pub quantity: QuantityKind,
    pub filtered: Filtered,
    pub extra: Extra,
    /// Here for the criteria of an occupant, not to be held against the vehicle.
    pub for_criteria: bool,
}

fn jobs<'a>(
    settings: &StageSettings,
    pass: &[String],
    input: &'a Inputs,
    test: &TestDescription,
    may_be_none: bool,
    remarks: &mut Remarks,
) -> anyhow::Result<Vec<Job<'a>>> {
    let selected = match select(test, &settings.channels) {
        Err(SelectionError::None) if may_be_none => Vec::new(),
        Err(SelectionError::None) if test.pulse.is_none() && no_acceleration(test) => {
            return Err(no_crash(test));
        }
        selected => selected.refuse_with_hint("name the channels to filter with --channels")?,
    };
    if settings.channels.is_empty() {
        say_what_is_left(settings, pass, test, &selected, remarks);
    }
    let pulse = test.pulse_channel().ok();
    let mut jobs = Vec::new();
    for channel in selected.into_iter().filter(|channel| !pass.contains(&channel.id)) {
        let mut of_channel = settings.filter;
        // SAE J211-1 Table 1: barrier force is CFC 60, whatever the structure is filtered to.
        if is_barrier_force(channel) && settings.channels.is_empty() && of_channel.class != Class::None {
            of_channel.class = Class::Cfc(Cfc::Cfc60);
        }
        // Nor is a dummy filtered like the structure: head 1000, chest 180.
        let for_criteria = for_criteria(settings, channel, pulse);
        if let Some(class) = class_of_body(channel)
            && let Class::Cfc(asked) = of_channel.class
            && (asked != class || of_channel.instead.is_some())
            && (of_channel.instead.is_none() || for_criteria)
        {
            if settings.class_for_all && !for_criteria {
                remarks.warning(
                    &channel.id,
                    format!("of a dummy, filtered to cfc {asked} as asked for: its criteria ask for cfc {class} (SAE J211-1)"),
                );
            } else {
                of_channel.class = Class::Cfc(class);
                of_channel.instead = None;
                if channel.cfc.is_none() {
                    remarks.info(
                        &channel.id,
                        format!(
                            "of a dummy, filtered to cfc {class} (SAE J211-1); another class by --cfc beside --channels"
                        ),
                    );
                }
            }
        }
        jobs.push(Job {
            id: channel.id.clone(),
            wave: input.wave(&channel.id)?,
            cfc: channel.cfc,
            settings: of_channel,
            for_criteria,
        });
    }
    Ok(jobs)
}

fn no_acceleration(test: &TestDescription) -> bool {
    !test.channels.iter().any(|channel| channel.quantity == QuantityKind::Acceleration && channel.status.has_data())
}

/// A record of inputs and outputs: identified as it is.
fn no_crash(test: &TestDescription) -> anyhow::Error {
    let ids: Vec<String> = test.channels.iter().map(|channel| channel.id.clone()).collect();
    let (first, last) = (ids.first().map_or("COLUMN", String::as_str), ids.last().map_or("COLUMN", String::as_str));
    Refused::new(format!("the record is no crash: no pulse is named and no channel is an acceleration ({})", first_of(&ids)))
        .expected("accelerations to filter, or channels named with --channels")
        .hint(format!(
            "inputs and outputs are identified from the artifact of crumple-ingest as they are: crumple-identify 1-ingest.mcap --methods n4sid --inputs {first} --outputs {last} -o 4-identify.mcap"
        ))
        .into()
}

/// Whether a head or chest is taken by itself: nobody named it, and the pulse is of the vehicle or of another part. It has its own class whatever
/// is done to the structure.
fn for_criteria(settings: &StageSettings, channel: &Channel, pulse: Option<&Channel>) -> bool {
    let with_the_pulse = |pulse: &Channel| {
        pulse.id == channel.id
            || (part_of(pulse).is_some() && !pulse.location.is_empty() && pulse.location == channel.location)
    };
    settings.channels.is_empty() && part_of(channel).is_some() && !pulse.is_some_and(with_the_pulse)
}

/// Names the sensors of occupants that are not taken, by place, with the one thing to do.
fn say_what_is_left(
    settings: &StageSettings,
    pass: &[String],
    test: &TestDescription,
    taken: &[&Channel],
    remarks: &mut Remarks,
) {
    let mut left = occupants_left(test, taken);
    left.retain(|channel| !pass.contains(&channel.id));
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    for channel in &left {
        let failed = if channel.status == ChannelStatus::Failed { ", failed" } else { "" };
        *places.entry(format!("{}{failed}", channel.location)).or_default() += 1;
    }
    let Some(example) = left.iter().find(|channel| channel.quantity == QuantityKind::Acceleration).or(left.first())
    else {
        return;
    };
    let pulse = test.pulse_channel().map_or_else(|_| String::new(), |channel| format!("{},", channel.id));
    let places: Vec<String> = places.into_iter().map(|(place, n)| format!("{place} ({n})")).collect();
    let class = settings.filter.class;
    remarks.of_test(format!(
        "{} channels of occupants are not filtered, no criterion is made of them: {}; crumple-filter --channels '{pulse}{}' takes one beside the pulse, to cfc {class}",
        left.len(),
        first_of(&places),
        example.id
    ));
}

/// All channels at once; the results are in the order of the jobs, whatever the number of threads.
fn filter_all(jobs: &[Job<'_>], out: &Output) -> Vec<Result<Filtered, FilterError>> {
    let work = jobs.iter().map(|job| 2 * job.wave.sampled.len() as u64).sum();
    let progress = Mutex::new(out.progress("filtering", work));
    let report = |amount| {
        if let Ok(mut progress) = progress.lock() {
            progress.advance(amount);
        }
    };
    let run = |job: &Job<'_>| filter_reporting(&job.wave.sampled, job.cfc, &job.settings, &report);
    match jobs {
        // Threads cost more than they give for one channel.
        [one] => vec![run(one)],
        several => several.par_iter().map(run).collect(),
    }
}
