//! Rows of the joint of filter: what it made of the record.

use crumple_artifact::records::TestV1;
use crumple_signal::{About, Kind, QuantityKind, Sampled, Weight};

use crate::joints::curves::{Running, Ways, delay_s, end_of, mean_and_deviation, times, value_at, ways};
use crate::joints::{Finding, Invariant, RunParts, pulse_of, record};

/// Rows of the stage.
pub(crate) static ROWS: [Invariant; 10] = [
    Invariant {
        kind: Kind {
            code: "CR201",
            weight: Weight::Decisive,
            explanation: [
                "The filtered pulse begins before the record does and is early, or begins after contact where the \
                 record begins before it.",
                "The first sample of /wave/PULSE is compared with that of 1-ingest, or with contact where that is \
                 later; one sampling interval is left. Samples before the record of a pulse that is not early, as a \
                 filter leaves whose delay was taken off, are no fault (CR203 says how that is decided).",
                "Every time of the run is late or early by as much, and the crush with it: 20 ms at 15 m/s are 0.3 m.",
                "keep t0_ns and dt_s of the wave in the program of the stage filter",
            ],
        },
        ends_the_run: true,
        find: begins_elsewhere,
    },
    Invariant {
        kind: Kind {
            code: "CR202",
            weight: Weight::Marked,
            explanation: [
                "The filtered pulse ends elsewhere than the record does.",
                "The last samples are compared; 5 ms and one sampling interval of the coarser one are left: a filter \
                 whose delay was taken off ends as much earlier, and four poles of 100 Hz, CFC 60 run one way, are \
                 late by 2.61/(2π 100 Hz) = 4.2 ms.",
                "What happens later is not in any result, or what never happened is: another number of samples, or \
                 another sampling interval, was written.",
                "write all samples of the pulse, with their dt_s, in the program of the stage filter",
            ],
        },
        ends_the_run: false,
        find: ends_elsewhere,
    },
    Invariant {
        kind: Kind {
            code: "CR203",
            weight: Weight::Decisive,
            explanation: [
                "The filtered pulse is late or early: its filter has a delay, or its time axis begins elsewhere.",
                "The ways that both add up to 150 ms, each over its change of velocity, are compared: a delay takes \
                 itself off, and a gain nothing. A filter run forward and backward has none (ISO 6487 and SAE J211 \
                 ask for that); more than one sampling interval and 1 ms are named: noise and zero levels of made \
                 records come to 0.4 ms. Not asked where CR204 or CR207 is.",
                "The crush is off by the impact speed times the delay: too large where the pulse is late.",
                "run the filter forward and backward (filtfilt for lfilter), or take its delay off t0_ns",
            ],
        },
        ends_the_run: false,
        find: is_late,
    },
    Invariant {
        kind: Kind {
            code: "CR204",
            weight: Weight::Decisive,
            explanation: [
                "The filtered pulse changes the velocity by less than half of what the record does, by more than \
                 twice as much, or the other way.",
                "Both are integrated over the record; decided as CR207, with a factor of 2 in place of 4 %.",
                "A sign or a unit is another one: every number that is integrated is wrong by it.",
                "write m/s^2 with the sign of the record and all samples in the program of the stage filter",
            ],
        },
        ends_the_run: true,
        find: changes_sign_or_unit,
    },
    Invariant {
        kind: Kind {
            code: "CR205",
            weight: Weight::Marked,
            explanation: [
                "Every channel that the record had is marked as failed after the filter.",
                "The states of the channels in both /test are compared.",
                "A channel that failed is no measurement, yet the numbers of this run are made from it.",
                "pass the status of the channels on in the program of the stage filter",
            ],
        },
        ends_the_run: false,
        find: is_marked_as_failed,
    },
    Invariant {
        kind: Kind {
            code: "CR206",
            weight: Weight::Decisive,
            explanation: [
                "The filter changed the mass or the impact speed of the test.",
                "Both are compared in the /test of 1-ingest and 2-filter.",
                "Energy and stiffness go with them, and nobody stated the new one.",
                "pass /test on unchanged; another mass or speed is given to crumple ingest: --mass, --impact-speed",
            ],
        },
        ends_the_run: true,
        find: changes_the_test,
    },
    Invariant {
        kind: Kind {
            code: "CR207",
            weight: Weight::Decisive,
            explanation: [
                "The filtered pulse changes the velocity by another amount than the record.",
                "Both are integrated over the record. A low-pass filter keeps the area; what a zero level between \
                 none and that of the samples before contact changes, with three deviations of it, is left, and 4 % \
                 of the change: Butterworth filters of 60 to 300 Hz, run both ways from rest, change it by 0.6 to 2.9 \
                 % on the fixtures, moving averages by 0.02 %.",
                "A gain, an offset or cut samples: every number that is integrated is wrong by it.",
                "write all samples without a gain or an offset in the program of the stage filter",
            ],
        },
        ends_the_run: false,
        find: changes_the_velocity,
    },
    Invariant {
        kind: Kind {
            code: "CR208",
            weight: Weight::Decisive,
            explanation: [
                "The filter is so slow that the way of the vehicle is another one.",
                "Both pulses are integrated twice from the impact speed up to the largest displacement, 150 ms at \
                 most, without the zero level that the filter took out; 2 % of that displacement is left, and what \
                 three deviations of the zero level add. A moving average over w moves it by w²/24 times the \
                 deceleration: 1.1 % of 0.7 m at 20 g for 30 ms, 3 % for 50 ms. The classes of SAE J211 stay below \
                 0.1 %. Not asked where CR203, CR204, CR207 or CR226 is.",
                "The crush, its time and every model are those of a longer pulse.",
                "filter less in the program of the stage filter: class CFC 60 for the motion of a vehicle",
            ],
        },
        ends_the_run: false,
        find: moves_the_vehicle,
    },
    Invariant {
        kind: Kind {
            code: "CR209",
            weight: Weight::Decisive,
            explanation: [
                "No acceleration is left after the filter.",
                "1-ingest has the wave of the pulse, and 2-filter no wave of an acceleration under the id of a \
                 channel; one that ended without a result says so itself.",
                "Nothing can be integrated.",
                "write the filtered samples under the id of the pulse in the program of the stage filter",
            ],
        },
        ends_the_run: true,
        find: is_gone,
    },
    Invariant {
        kind: Kind {
            code: "CR226",
            weight: Weight::Decisive,
            explanation: [
                "The class of the filter is too low for the record, or the record begins inside its shock.",
                "What CR203, CR204 and CR207 ask of a program from elsewhere, asked of the filter of Crumple: it takes \
                 as much off a shock that lasts a few of its periods (CFC 60 passes 100 Hz), and what a record lacks \
                 before its shock.",
                "Change of velocity, peak and crush are not those of the record.",
                "filter less, such as --set filter.cfc=1000, or give the record from before the shock",
            ],
        },
        ends_the_run: false,
        find: loses_the_shock,
    },
];

/// The pulse before and after the filter, and the speed of the test.
struct Pulse<'a> {
    recorded: &'a Sampled,
    filtered: &'a Sampled,
    impact_speed_m_per_s: Option<f64>,
}

impl<'a> Pulse<'a> {
    fn of(parts: &RunParts<'a>) -> Option<Self> {
        let (ingested, made) = (parts.of("ingest")?, parts.of("filter")?);
        let test: TestV1 = record(made, "/test").or_else(|| record(ingested, "/test"))?;
        let id = pulse_of(&test)?;
        let curve = |artifact: &'a crumple_artifact::Artifact| {
            Some(&artifact.waves().get(id)?.sampled).filter(|wave| wave.len() > 1)
        };
        let impact_speed_m_per_s = test.impact_speed_m_per_s;
        Some(Self { recorded: curve(ingested)?, filtered: curve(made)?, impact_speed_m_per_s })
    }

    /// The coarser sampling interval, with what times are rounded by.
    fn coarser_s(&self) -> f64 {
        1.001 * self.recorded.dt_s().max(self.filtered.dt_s())
    }

    fn delay_s(&self) -> Option<f64> {
        delay_s(self.recorded, self.filtered)
    }
}

fn finding(about: About, values: Vec<(&'static str, f64)>, text: String) -> Vec<Finding> {
    vec![Finding { stage: "filter", about, values, text }]
}

fn begins_elsewhere(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(pulse) = Pulse::of(parts) else { return Vec::new() };
    let (recorded_s, filtered_s) = (pulse.recorded.t0_s(), pulse.filtered.t0_s());
    let is_moved = || pulse.delay_s().is_none_or(|delay_s| delay_s < -pulse.coarser_s().max(DELAY_S));
    let is_early = filtered_s < recorded_s - pulse.coarser_s() && is_moved();
    let misses_contact = filtered_s > recorded_s.max(0.0) + pulse.coarser_s();
    if !is_early && !misses_contact {
        return Vec::new();
    }
    let text =
        format!("the filtered pulse begins at {:.1} ms, the record at {:.1} ms", filtered_s * 1e3, recorded_s * 1e3);
    finding(About::Time, vec![("filtered_from_s", filtered_s), ("recorded_from_s", recorded_s)], text)
}

/// By how much a pulse may end beside the record, s.
const END_S: f64 = 5e-3;

fn ends_elsewhere(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(pulse) = Pulse::of(parts) else { return Vec::new() };
    let (recorded_s, filtered_s) = (end_of(pulse.recorded), end_of(pulse.filtered));
    if (filtered_s - recorded_s).abs() <= END_S + pulse.coarser_s() {
        return Vec::new();
    }
    let text =
        format!("the filtered pulse ends at {:.1} ms, the record at {:.1} ms", filtered_s * 1e3, recorded_s * 1e3);
    finding(About::Pulse, vec![("filtered_to_s", filtered_s), ("recorded_to_s", recorded_s)], text)
}

/// Least delay that is named beside a sampling interval, s.
const DELAY_S: f64 = 1e-3;

fn is_late(parts: &RunParts<'_>) -> Vec<Finding> {
    if is_built_in(parts) { Vec::new() } else { delayed(parts) }
}

/// Whether the filter of Crumple wrote the filtered pulse, and no other program has put it together since.
fn is_built_in(parts: &RunParts<'_>) -> bool {
    let provenance = parts.of("filter").and_then(crumple_artifact::Artifact::provenance);
    provenance.is_some_and(|written| !written.build.is_empty() && written.made_by.is_empty())
}

fn delayed(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(pulse) = Pulse::of(parts) else { return Vec::new() };
    if Changes::of(parts).is_none_or(|changes| changes.differ()) {
        return Vec::new();
    }
    let Some(delay_s) = pulse.delay_s() else { return Vec::new() };
    if delay_s.abs() <= pulse.coarser_s().max(DELAY_S) {
        return Vec::new();
    }
    let is = if delay_s > 0.0 { "late" } else { "early" };
    let text = format!("the filtered pulse is {:.1} ms {is} against the record", delay_s.abs() * 1e3);
    finding(About::Pulse, vec![("delay_s", delay_s)], text)
}

/// The highest class of SAE J211-1.
const HIGHEST_CLASS: u16 = 1000;

fn loses_the_shock(parts: &RunParts<'_>) -> Vec<Finding> {
    if !is_built_in(parts) {
        return Vec::new();
    }
    let changed = Changes::of(parts).filter(Changes::differ).map_or_else(Vec::new, |changes| changes.finding());
    let found = if changed.is_empty() { delayed(parts) } else { changed };
    let why = "the shock is too short for the class of the filter, or the record begins inside it";
    let with_cause = |mut one: Finding| {
        one.text = format!("{}: {why}; --set filter.cfc={HIGHEST_CLASS} filters least", one.text);
        one.values.push(("highest_class", f64::from(HIGHEST_CLASS)));
        one
    };
    found.into_iter().map(with_cause).collect()
}

/// Share of the largest displacement that a filter may move the vehicle by: what the speed of a test is known to.
const WAY: f64 = 0.02;

fn moves_the_vehicle(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(pulse) = Pulse::of(parts) else { return Vec::new() };
    if Changes::of(parts).is_none_or(|changes| changes.differ()) || !delayed(parts).is_empty() {
        return Vec::new();
    }
    let Some(speed) = pulse.impact_speed_m_per_s.filter(|speed| *speed > 0.0) else { return Vec::new() };
    let Some(Ways { time_s, of_filtered_m, of_recorded_m, largest_m, by_zero_level_m }) =
        ways(pulse.recorded, pulse.filtered, speed)
    else {
        return Vec::new();
    };
    if (of_filtered_m - of_recorded_m).abs() <= WAY * largest_m + by_zero_level_m {
        return Vec::new();
    }
    let text = format!(
        "the filtered pulse moves the vehicle by {:.0} mm in {:.0} ms, the record by {:.0} mm",
        of_filtered_m * 1e3,
        time_s * 1e3,
        of_recorded_m * 1e3
    );
    let values = vec![("filtered_m", of_filtered_m), ("recorded_m", of_recorded_m), ("time_s", time_s)];
    finding(About::Pulse, values, text)
}

fn is_gone(parts: &RunParts<'_>) -> Vec<Finding> {
    let (Some(ingested), Some(made)) = (parts.of("ingest"), parts.of("filter")) else { return Vec::new() };
    let Some(test) = record::<TestV1>(ingested, "/test") else { return Vec::new() };
    // The pulse of a recorder may be its table of velocities.
    let is_acceleration =
        |id: &&str| ingested.waves().get(*id).is_some_and(|wave| wave.quantity == QuantityKind::Acceleration);
    let Some(id) = pulse_of(&test).filter(is_acceleration) else { return Vec::new() };
    // Another channel of the test may be the pulse of the stages behind it.
    let is_listed = |id: &String| test.channels.iter().any(|channel| channel.id == *id);
    let mut accelerations = made.waves().iter().filter(|(_, wave)| wave.quantity == QuantityKind::Acceleration);
    let is_left = accelerations.any(|(id, _)| is_listed(id));
    if is_left || made.records().iter().any(|raw| raw.topic == "/diagnosis") {
        return Vec::new();
    }
    finding(
        About::Pulse,
        Vec::new(),
        format!("channel {id} is the pulse, and no channel has a wave of an acceleration"),
    )
}

/// Share of a change of velocity that the ends of a filter may alter.
const AREA: f64 = 0.04;

/// Factor beyond which a change of velocity is of another sign or unit.
const ANOTHER_UNIT: f64 = 2.0;

/// The changes of velocity of the filtered pulse and of the record, and the range that the latter leaves.
struct Changes {
    filtered: f64,
    recorded: f64,
    range: (f64, f64),
}

impl Changes {
    fn of(parts: &RunParts<'_>) -> Option<Self> {
        let pulse = Pulse::of(parts)?;
        let recorded = pulse.recorded;
        let (from_s, to_s) = (recorded.t0_s().max(pulse.filtered.t0_s()), end_of(recorded).min(end_of(pulse.filtered)));
        let of_record = Running::of(recorded).over(from_s, to_s)?;
        let filtered = Running::of(pulse.filtered).over(from_s, to_s)?;
        let before: Vec<f64> =
            times(recorded, from_s, -recorded.dt_s()).filter_map(|t| value_at(recorded, t)).collect();
        let (zero_level, deviation) = mean_and_deviation(&before);
        let moved = -zero_level * (to_s - from_s);
        let left = 3.0 * deviation * (to_s - from_s) + AREA * of_record.abs().max((of_record + moved).abs());
        let range = (of_record + moved.min(0.0) - left, of_record + moved.max(0.0) + left);
        Some(Self { filtered, recorded: of_record + moved, range })
    }

    /// Whether sign or unit are others.
    fn are_others(&self) -> bool {
        let ratio = self.filtered / self.recorded;
        !(1.0 / ANOTHER_UNIT..=ANOTHER_UNIT).contains(&ratio)
    }

    fn differ(&self) -> bool {
        !(self.range.0..=self.range.1).contains(&self.filtered)
    }

    fn finding(&self) -> Vec<Finding> {
        let (filtered, recorded) = (self.filtered, self.recorded);
        let text =
            format!("the filtered pulse changes the velocity by {filtered:.2} m/s, the record by {recorded:.2} m/s");
        finding(About::Pulse, vec![("filtered_m_per_s", filtered), ("recorded_m_per_s", recorded)], text)
    }
}

fn changes_sign_or_unit(parts: &RunParts<'_>) -> Vec<Finding> {
    let changes = Changes::of(parts).filter(|_| !is_built_in(parts));
    changes.filter(|c| c.differ() && c.are_others()).map_or_else(Vec::new, |c| c.finding())
}

fn changes_the_velocity(parts: &RunParts<'_>) -> Vec<Finding> {
    let changes = Changes::of(parts).filter(|_| !is_built_in(parts));
    changes.filter(|c| c.differ() && !c.are_others()).map_or_else(Vec::new, |c| c.finding())
}

/// The test before and after the filter.
fn tests(parts: &RunParts<'_>) -> Option<(TestV1, TestV1)> {
    Some((record(parts.of("ingest")?, "/test")?, record(parts.of("filter")?, "/test")?))
}

fn changes_the_test(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some((before, after)) = tests(parts) else { return Vec::new() };
    let numbers = [
        ("mass", "kg", before.mass_kg.zip(after.mass_kg)),
        ("impact speed", "m/s", before.impact_speed_m_per_s.zip(after.impact_speed_m_per_s)),
    ];
    let changed = numbers.into_iter().find_map(|(what, unit, pair)| {
        let (before, after) = pair.filter(|(before, after)| (before - after).abs() > 1e-9 * before.abs())?;
        Some((what, unit, before, after))
    });
    let Some((what, unit, before, after)) = changed else { return Vec::new() };
    let text = format!("the {what} is {after:.2} {unit} after the filter, {before:.2} {unit} before");
    finding(About::Record, vec![("after", after), ("before", before)], text)
}

fn is_marked_as_failed(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some((before, after)) = tests(parts) else { return Vec::new() };
    let failed = |test: &TestV1| test.channels.iter().filter(|channel| channel.status == "failed").count();
    let (failed_before, failed_after, all) = (failed(&before), failed(&after), after.channels.len());
    if failed_after < all || failed_before == before.channels.len() || all == 0 {
        return Vec::new();
    }
    let text =
        format!("{failed_after} of {all} channels are marked as failed after the filter, {failed_before} before");
    finding(About::Record, vec![("failed_after", failed_after as f64), ("failed_before", failed_before as f64)], text)
}
