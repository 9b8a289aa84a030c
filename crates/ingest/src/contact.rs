//! First contact: where it is on the file's time axis, what says so, how uncertain it is. After it every time is in
//! seconds from contact.

use crumple_metrics::{Beginning, CutRise, Onset, contact_edge, edr_start, onset, threshold_crossing};
use crumple_signal::value::Time;
use crumple_signal::{
    About, Acceleration, Cfc, Class, Contact, Distribution, FilterSettings, Notes, SIMULATED,
    STANDARD_GRAVITY_M_PER_S2, Sampled, Signal, Spread, Uncertain, Weight, ZeroLevel, filter, remarks,
};

use crate::recording::content::Recording;
use crate::recording::details::Stated;
use crate::recording::stated_contact::{ContactRule, TimeZero};
use crate::{IngestError, IngestSettings, Result, refuse, time};

/// How much later than contact the compartment of a car begins to slow down at most, s: the four floor sensors of NHTSA
/// 10146 begin 2.6 to 2.9 ms after its contact switch, the time to crush the 45 mm in front of its bumper beam; half as
/// much again for other fronts.
const SOFT_FRONT_S: f64 = 0.004;
/// A pulse that begins up to so long after the file's t = 0 does not speak against it, s: a soft front, and the error
/// of the onset of a soft rise.
const LATE_S: f64 = 0.005;
/// One that begins earlier than this before it does, s: a filter without phase that the recorder applied moves the foot
/// of a jump by so much (CFC 180: 0.9 ms from 2 % of a jump to its middle).
const EARLY_S: f64 = 0.001;
/// The same in deviations of the onset: 0.1 % of contacts at t = 0.
const EARLY_DEVIATIONS: f64 = 3.0;
/// Deviations of a normal error that a 90 % interval reaches to, rounded as in the results that are accepted.
const NINETY_PERCENT: f64 = 1.645;
/// An interval that is to hold a second contact reaches this much further: its end lies inside, not on it.
const HOLDS: f64 = 1.1;
/// A pulse that begins so long after a time that somebody stated is asked about, s: 0.28 m at 50 km/h.
const LATE_FOR_A_STATEMENT_S: f64 = 0.02;

/// Settles contact: shifts every channel so that t = 0 is contact, and says what settled it. `None` where nothing does:
/// a record without a pulse whose t = 0 nobody states.
///
/// In this order: the time that a flag, the sidecar or the header states; the rule of a flag; the format, where it
/// defines t = 0 as contact; else `auto`: the [onset] of the pulse, unless the file has a t = 0 that agrees with it.
pub fn settle(
    file: &str,
    recording: &mut Recording,
    (pulse, is_of_occupant, reader_format): (Option<usize>, bool, &str),
    settings: &IngestSettings,
    notes: &mut Notes,
) -> Result<Option<Contact>> {
    let wave = pulse.and_then(|k| recording.channels[k].wave.clone());
    let begins = wave.as_ref().map(onset);
    let stated = recording.details.time_zero_s.as_ref();
    // A simulation starts before contact at any time. It has no error of a trigger: contact lies between two states.
    let is_simulated = SIMULATED.contains(&reader_format);
    let sampling = wave.as_ref().filter(|_| is_simulated && stated.is_some());
    let sampling = sampling.map(|wave| Spread { size: wave.dt_s() / 2.0, distribution: Distribution::Uniform });
    let stated_spread = sampling.or(settings.time_zero_uncertainty.map(spread));
    let contact = |rule: String, source_time_s: f64| Contact {
        rule,
        source_time_s,
        uncertainty_s: stated_spread,
        earlier_by_s: 0.0,
    };
    let auto = settings.time_zero == Some(TimeZero::Auto)
        || settings.time_zero_rule == Some(ContactRule::Auto)
        || (is_simulated && stated.is_none() && settings.time_zero_rule.is_none());
    let found = match (&settings.time_zero_rule, stated) {
        (_, Some(Stated { value, from })) if !auto => {
            notes.push(StatedZero { time_zero_s: *value, from: from.clone() });
            Some(contact(format!("stated by {from}"), *value))
        }
        (Some(rule), _) if !auto => Some(by_rule(file, rule, recording, wave.as_ref(), stated_spread, notes)?),
        _ if recording.contact_at_zero && !auto => Some(contact(format!("the format {reader_format}"), 0.0)),
        _ => wave.as_ref().zip(begins).and_then(|(wave, begins)| {
            let has_zero = wave.t0_s() <= wave.dt_s() && wave.end_s() > 0.0 && !auto;
            // An occupant begins to slow down when the belt holds, not at contact.
            let begins = if is_of_occupant && has_zero { Beginning::Quiet } else { begins };
            automatic(wave, begins, has_zero, stated_spread, notes)
        }),
    };
    let found = found.map(|contact| match begins {
        Some(Beginning::Inside(cut)) => {
            // Its zero level is unknown for the same reason: that comes after it.
            let missing_s = cut_lead_s(cut);
            notes.push(CutBeginning { level_m_per_s2: cut.first_m_per_s2.abs(), missing_s });
            Contact { earlier_by_s: missing_s, ..contact }
        }
        _ => contact,
    });
    let at_s = found.as_ref().map_or(0.0, |contact| contact.source_time_s);
    if let Some(wave) = &wave {
        require_contact(file, wave, at_s, begins)?;
        if let (Some(contact), Some(Beginning::Rises(onset)), false) = (&found, begins, is_of_occupant) {
            question(contact, (wave, onset), recording.contact_at_zero, notes);
        }
    }
    if at_s != 0.0 {
        for read in &mut recording.channels {
            if let Some(wave) = &read.wave {
                let shifted = time::shift(wave, at_s).map_err(|error| {
                    IngestError::content(file, error, "finite numbers", "correct the record, or --time-zero")
                })?;
                read.wave = Some(shifted);
            }
        }
    }
    Ok(found)
}

/// The cut beginning of a pulse may be longer than its rise says, by this factor: the foot of a pulse is flatter than
/// what follows (a haversine cut at 10 % of its peak: twice; a half sine: once).
const CUT: f64 = 1.5;
/// ... and lasts no longer than this, s: half of a pulse of 60 ms.
const LONGEST_CUT_S: f64 = 0.03;

/// How much earlier contact may have been; a pulse that does not rise any more says nothing of its beginning.
fn cut_lead_s(cut: CutRise) -> f64 {
    if cut.lead_s > 0.0 { (CUT * cut.lead_s).min(LONGEST_CUT_S) } else { LONGEST_CUT_S }
}

/// Standard deviation of a spread, s.
fn deviation_of(stated: Option<Spread>) -> f64 {
    stated.map_or(0.0, Spread::deviation)
}

fn spread(stated: Uncertain<Time>) -> Spread {
    Spread { size: stated.size.si(), distribution: stated.distribution }
}

/// Contact where nothing states it: the file's t = 0 where the pulse begins there, else where it begins.
fn automatic(
    wave: &Sampled,
    begins: Beginning,
    has_zero: bool,
    stated: Option<Spread>,
    notes: &mut Notes,
) -> Option<Contact> {
    let of_file = |notes: &mut Notes| {
        notes.push(ZeroOfFile { samples_before: wave.index_at_or_after(0.0) });
        Some(Contact { rule: "file".to_owned(), source_time_s: 0.0, uncertainty_s: stated, earlier_by_s: 0.0 })
    };
    let Onset { time_s, deviation_s } = match begins {
        Beginning::Rises(onset) => onset,
        // The first sample is as near to contact as the record comes.
        Beginning::Inside(_) if has_zero && wave.t0_s().abs() <= wave.dt_s() => return of_file(notes),
        Beginning::Inside(_) => {
            let (rule, source_time_s) = ("auto".to_owned(), wave.t0_s());
            return Some(Contact { rule, source_time_s, uncertainty_s: stated, earlier_by_s: 0.0 });
        }
        Beginning::Quiet => return if has_zero { of_file(notes) } else { None },
    };
    let slack_s = EARLY_DEVIATIONS * deviation_s;
    let early_s = EARLY_S.max(slack_s);
    let fits = (-early_s..=LATE_S.max(slack_s)).contains(&time_s) || (time_s < 0.0 && !acts_before(wave, 0.0, time_s));
    if has_zero && fits {
        let contact = of_file(notes)?;
        let known_s = slack_s.max(2.0 * deviation_of(stated));
        if time_s <= known_s {
            return Some(contact);
        }
        // A soft front, or a t = 0 that is not contact: nothing tells, and the intervals hold both.
        notes.push(LateBeginning { begins_s: time_s });
        let size = (HOLDS * time_s / NINETY_PERCENT).hypot(deviation_of(stated));
        let uncertainty_s = Some(Spread { size, distribution: Distribution::Normal });
        return Some(Contact { uncertainty_s, ..contact });
    }
    // The error of the onset and that of the clock are independent.
    let deviation_s = deviation_s.hypot(deviation_of(stated));
    // To the microsecond, as the flag states it.
    let source_time_s = (time_s * 1e6).round() / 1e6;
    let interval_s = NINETY_PERCENT * deviation_s;
    notes.push(FoundContact { contact_s: source_time_s, interval_s, earlier_s: SOFT_FRONT_S });
    Some(Contact {
        rule: "auto".to_owned(),
        source_time_s,
        uncertainty_s: Some(Spread { size: deviation_s, distribution: Distribution::Normal }),
        earlier_by_s: SOFT_FRONT_S,
    })
}

/// Deceleration before contact that is one, m/s²: twice the usual error of a zero level, 0.05 g.
const ACTS_M_PER_S2: f64 = 0.1 * STANDARD_GRAVITY_M_PER_S2;

/// Whether a force acts before an instant that the pulse is said to begin at: the mean of a millisecond before it is
/// off the level before the onset by more than zero level and noise (four deviations) explain. The onset of a soft
/// rise, extrapolated, may lie before it all the same.
fn acts_before(wave: &Sampled, at_s: f64, onset_s: f64) -> bool {
    let index = |t: f64| wave.index_at_or_after(t);
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len().max(1) as f64;
    let before = &wave.samples()[..index(onset_s.min(at_s))];
    let calm = &before[before.len().saturating_sub(index(wave.t0_s() + 0.05))..];
    if calm.len() < 3 {
        return true;
    }
    let level = mean(calm);
    let noise = (mean(&calm.iter().map(|x| (x - level).powi(2)).collect::<Vec<_>>())).sqrt();
    let together = ((1e-3 / wave.dt_s()).round() as usize).max(1);
    let between = &wave.samples()[before.len()..index(at_s)];
    // Whole stretches up to the instant: a pulse that is over by then has acted, too.
    let most = ACTS_M_PER_S2 + 4.0 * noise / (together as f64).sqrt();
    between.rchunks(together).any(|part| (mean(part) - level).abs() > most)
}

/// Contact by a rule that was asked for. What it leaves uncertain is in the contact.
fn by_rule(
    file: &str,
    rule: &ContactRule,
    recording: &Recording,
    pulse: Option<&Sampled>,
    stated: Option<Spread>,
    notes: &mut Notes,
) -> Result<Contact> {
    let smooth = || -> Option<Signal<Acceleration>> {
        let pulse = pulse?;
        let class = if pulse.rate_hz() >= Cfc::Cfc60.lowest_rate_hz() { Class::Cfc(Cfc::Cfc60) } else { Class::None };
        let settings = FilterSettings { class, zero_level: ZeroLevel::None, ..FilterSettings::default() };
        let level = level_at_start(pulse);
        let filtered = filter(pulse, None, &settings).ok()?.samples;
        Sampled::new(filtered.t0_s(), filtered.dt_s(), filtered.samples().iter().map(|a| a - level).collect())
            .ok()
            .map(Signal::from)
    };
    let (estimate, nothing) = match rule {
        ContactRule::Auto | ContactRule::File => {
            return Ok(Contact {
                rule: rule.to_string(),
                source_time_s: 0.0,
                uncertainty_s: stated,
                earlier_by_s: 0.0,
            });
        }
        ContactRule::Threshold => {
            (smooth().and_then(|a| threshold_crossing(&a)), "the pulse never stays at 0.5 g for 3 ms".to_owned())
        }
        ContactRule::Edr => (
            smooth().and_then(|a| edr_start(&a)),
            "the velocity of the pulse never changes by 0.8 km/h in 20 ms".to_owned(),
        ),
        ContactRule::Switch(id) => {
            let switch = recording.channels.iter().find(|read| read.channel.id == *id);
            let wave = switch.and_then(|read| read.wave.as_ref());
            (wave.and_then(contact_edge), format!("channel {id} is not in the record, or never changes"))
        }
    };
    let Some(estimate) = estimate else {
        return refuse(
            file,
            format!("time zero rule {rule}: {nothing}"),
            "a first contact",
            "state it, such as --time-zero 0s, or leave the rule out",
        );
    };
    notes.push(ContactByRule {
        rule: rule.to_string(),
        contact_s: estimate.time_s,
        earlier_s: estimate.earlier_by_s,
        later_s: estimate.later_by_s,
    });
    // The rule's own range and what is stated are independent.
    let half_width = estimate.earlier_by_s.max(estimate.later_by_s);
    let deviation_s = (half_width / 3.0_f64.sqrt()).hypot(deviation_of(stated));
    Ok(Contact {
        rule: rule.to_string(),
        source_time_s: estimate.time_s,
        uncertainty_s: Some(Spread { size: deviation_s, distribution: Distribution::Normal }),
        earlier_by_s: 0.0,
    })
}

/// Mean of the first 50 ms, or of the first tenth of a shorter record.
fn level_at_start(pulse: &Sampled) -> f64 {
    let samples = ((0.05 / pulse.dt_s()) as usize).min(pulse.len() / 10).max(1).min(pulse.len());
    pulse.samples()[..samples].iter().sum::<f64>() / samples.max(1) as f64
}

/// Refuses a contact outside the pulse, with bounds and proposal on the file's axis.
fn require_contact(file: &str, pulse: &Sampled, at_s: f64, begins: Option<Beginning>) -> Result<()> {
    let (start, end) = (pulse.t0_s(), pulse.end_s());
    if start - at_s <= pulse.dt_s() && end > at_s {
        return Ok(());
    }
    let proposal = match begins {
        Some(Beginning::Rises(onset)) => {
            format!("the pulse begins at {:.4} s: --time-zero {:.4}s, or --time-zero auto", onset.time_s, onset.time_s)
        }
        Some(Beginning::Quiet) => format!(
            "no impact is found in it: export the record whole; if it has one, state first contact with --time-zero, \
             between {start:.4} s and {end:.4} s of the file"
        ),
        _ => format!("state first contact with --time-zero, between {start:.4} s and {end:.4} s of the file"),
    };
    refuse(
        file,
        format!("the record runs from {start:.4} s to {end:.4} s and does not contain contact, {at_s} s"),
        "first contact in the record, on the file's time axis",
        proposal,
    )
}

/// Asks about a contact at which the pulse does not begin.
fn question(contact: &Contact, (wave, onset): (&Sampled, Onset), is_of_format: bool, notes: &mut Notes) {
    let (at_s, begins_s) = (contact.source_time_s, onset.time_s);
    let late_s = begins_s - at_s;
    let is_early = late_s < -EARLY_S.max(EARLY_DEVIATIONS * onset.deviation_s) && acts_before(wave, at_s, begins_s);
    let is_late = late_s > LATE_FOR_A_STATEMENT_S && !is_of_format;
    if !is_early && !is_late {
        return;
    }
    let side = if is_early { "before" } else { "after" };
    notes.push_first(BeginsElsewhere { off_s: late_s.abs(), side, rule: contact.rule.clone(), begins_s });
}

remarks! {
    /// Remarks of contact.
    pub REMARKS;

    /// Contact is stated.
    CR132 StatedZero { time_zero_s: f64, from: String }
    bears on (About::Time, Weight::None)
    decided "--time-zero, the sidecar or the header states it, on the time axis of the file."
    means "All times count from this instant, and the velocity there is the impact speed."
    remedy "nothing; --time-zero auto takes the beginning of the pulse instead"
    says format!("time zero is {time_zero_s} s of the file's axis, stated by {from}");

    /// The record begins inside the pulse.
    CR133 CutBeginning { level_m_per_s2: f64, missing_s: f64 }
    bears on (About::Pulse, Weight::Marked)
    decided "The first sample is more than 1.5 g away from rest; sound records reach 1.1 g. The missing time follows \
             from the rise of the first samples and is 30 ms at most."
    means "The loss of speed before the first sample is missing: crush and delta-v are lower bounds."
    remedy "export the record from before contact on"
    says format!(
        "the record begins inside the pulse, at {:.1} g: crush and delta-v are lower bounds, up to {:.0} ms are \
         missing. Give the record from before contact",
        level_m_per_s2 / STANDARD_GRAVITY_M_PER_S2,
        1e3 * missing_s
    );

    /// Contact is t = 0 of the file.
    CR134 ZeroOfFile { samples_before: usize }
    bears on (About::Time, Weight::None)
    decided "The pulse begins there: at most 1 ms before t = 0 and 5 ms after it, or as far as its beginning is \
             uncertain. A record in which no pulse shows keeps its t = 0, as does one that begins inside the pulse."
    means "Times stay as they are in the file."
    remedy "nothing; --time-zero states another contact"
    says match samples_before {
        0 => "the record starts at t = 0, taken as time zero; --time-zero states another".to_owned(),
        before => format!("time zero is t = 0 of the file, {before} samples after its start"),
    };

    /// The pulse begins a little after t = 0 of the file.
    CR135 LateBeginning { begins_s: f64 }
    bears on (About::Time, Weight::None)
    decided "It begins up to 5 ms after t = 0, and later than the error of its beginning explains. A soft front does \
             that, or a t = 0 that is not contact."
    means "The intervals of crush and times hold both contacts."
    remedy "state contact by --time-zero if you know it: the intervals become narrower"
    says format!(
        "the pulse begins {:.1} ms after time zero: contact may be as late, and the intervals hold it",
        1e3 * begins_s
    );

    /// Nothing states contact; it is taken where the pulse begins.
    CR136 FoundContact { contact_s: f64, interval_s: f64, earlier_s: f64 }
    bears on (About::Time, Weight::Slight)
    decided "The rise of the pulse is traced back to the level before it. +- is its 90 % interval. The compartment of \
             a car begins to slow down up to 4 ms after contact: four floor sensors of NHTSA 10146 need 2.6 to 2.9 ms."
    means "Times and crush count from there. The interval of crush holds an earlier contact."
    remedy "state contact by --time-zero, or name a contact switch: --time-zero-rule contact:CHANNEL"
    says format!(
        "contact is taken at {:.1} ms of the file, where the pulse begins (+-{:.1} ms): nothing in the file states it. \
         A soft front may have touched up to {:.0} ms earlier. --time-zero {:.3}ms states it",
        1e3 * contact_s,
        1e3 * interval_s,
        1e3 * earlier_s,
        1e3 * contact_s
    );

    /// Contact was found by the rule that was asked for.
    CR137 ContactByRule { rule: String, contact_s: f64, earlier_s: f64, later_s: f64 }
    bears on (About::Time, Weight::None)
    decided "--time-zero-rule: threshold is 0.5 g held for 3 ms, edr a change of velocity of 0.8 km/h in 20 ms (49 CFR \
             563.5), contact the edge of a switch."
    means "Intervals of times and crush hold the range in which the rule may be wrong."
    remedy "nothing; leave the rule out to take the beginning of the pulse"
    says format!(
        "time zero by rule {rule} at {:.3} ms of the file; contact may be {:.2} ms earlier or {:.2} ms later",
        1e3 * contact_s,
        1e3 * earlier_s,
        1e3 * later_s
    );

    /// The pulse does not begin at the contact that was stated or found.
    CR138 BeginsElsewhere { off_s: f64, side: &'static str, rule: String, begins_s: f64 }
    bears on (About::Time, Weight::Decisive)
    decided "It begins more than 20 ms after contact, or more than 1 ms and three deviations before it with a force \
             that acts until then. A format that defines t = 0 as contact may be late."
    means "Contact seems to be wrong: the vehicle would move at its impact speed for too long or too short, and crush \
           is wrong by that way."
    remedy "check time zero; --time-zero auto takes the beginning of the pulse"
    says format!(
        "the pulse begins {:.1} ms {side} contact ({rule}): --time-zero {:.3}ms takes its beginning for contact",
        1e3 * off_s,
        1e3 * begins_s
    );
}
