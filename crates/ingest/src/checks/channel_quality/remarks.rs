//! What is remarked of the quality of channels.

use crumple_signal::{About, Weight, remarks};

remarks! {
    /// Remarks of the quality of channels.
    pub REMARKS;

    /// The record is too short before the event for a zero level.
    CR145 ZeroLevelUnknown {}
    bears on (About::Pulse, Weight::Marked)
    decided "The zero level is the mean from -50 ms to -10 ms. Less than 10 ms of it are in the record."
    means "An offset of the sensor stays in the pulse: 0.1 g is 0.1 m/s and 5 mm after 0.1 s. Noise is not known \
           either."
    remedy "export the record from 50 ms before contact on"
    says "zero level and noise of the pulse are unknown: it has less than 10 ms of data between -50 ms and -10 ms";

    /// The pulse begins with samples that are exactly zero.
    CR146 PulseMuted { samples: usize }
    bears on (About::Pulse, Weight::None)
    decided "A sensor has noise: more than ten samples of exactly 0 at the beginning of a record were not measured."
    means "The zero level is the mean of the other samples before the event."
    remedy "nothing"
    says format!(
        "the first {samples} samples of the pulse are exactly 0: the recorder was muted, and the zero level is that of \
         the other samples"
    );

    /// The sampling rate of the pulse is too low for the lowest class of filters.
    CR147 PulseSlow { rate_hz: f64, needed_hz: f64 }
    bears on (About::Pulse, Weight::Decisive)
    decided "SAE J211-1 asks for ten times the class: 600 samples a second for CFC 60."
    means "Peaks between the samples are lost, and no class of filters fits. Delta-v may still hold."
    remedy "export the record at its full rate, or check the unit of time: --time-unit"
    says format!(
        "the pulse has {rate_hz:.1} samples a second; CFC 60 needs at least {needed_hz}. A crash pulse is not resolved"
    );

    /// The pulse may be clipped: its sensor or recorder ran into its range.
    CR148 PulseClipped { samples: u64, low: f64, high: f64, unit: &'static str }
    bears on (About::Pulse, Weight::Marked)
    decided "3 or more equal samples in a row at the smallest or largest value, a tenth of the range or more from the \
             zero level, are left by a jump of more than six steps of the sensor."
    means "The peak is missing: it is a lower bound, and delta-v is too small. Crush is wrong by what is missing."
    remedy "take another channel of the compartment: --channel"
    says format!(
        "the pulse may be clipped: {samples} equal samples in a row at an extreme ({low:.3} to {high:.3} {unit})"
    );

    /// The pulse is noisy before the event.
    CR149 PulseNoisy { deviation_g: f64 }
    bears on (About::Pulse, Weight::Marked)
    decided "The standard deviation from -50 ms to -10 ms is above 1 g."
    means "The sensor may have failed, or contact is earlier than time zero. The zero level is uncertain, and with it \
           crush."
    remedy "look at the plot before contact; take another channel by --channel, or correct --time-zero"
    says format!(
        "the pulse is noisy before the event: standard deviation {deviation_g:.2} g, at most 1 g is usual: the sensor \
         may have failed"
    );

    /// The pulse may have dropouts: it stands still while the signal is active.
    CR150 PulseLost { samples: u64, from_s: f64 }
    bears on (About::Pulse, Weight::Marked)
    decided "5 or more equal samples in a row, over 0.5 ms or more in the first 150 ms, are left by a jump of more \
             than six steps of the sensor, and are no extreme of the record."
    means "What happened in this time is not in the record: delta-v and crush are wrong by it."
    remedy "take another channel of the compartment: --channel"
    says format!(
        "the pulse may have dropouts: {samples} equal samples in a row from {:.2} ms on, while the signal is active",
        1e3 * from_s
    );

    /// The pulse does not come back to its zero level.
    CR151 Drifted { level_g: f64 }
    bears on (About::Pulse, Weight::Slight)
    decided "The record reaches 100 ms or more, and the mean of its last 20 ms, without the zero level, is above 0.5 g."
    means "The sensor drifted, or a force still acts: rebound and restitution are uncertain, crush less so."
    remedy "compare with another channel of the compartment, or record longer"
    says format!(
        "the mean of the pulse over its last 20 ms is {level_g:.2} g: the sensor drifted, or a force still acts on the \
         vehicle"
    );

    /// The time stamps of the pulse do not lie on a uniform grid.
    CR152 CoarseTimes { off_intervals: f64 }
    bears on (About::Time, Weight::None)
    decided "The largest distance of a time stamp from the grid is above 1 % of a sampling interval."
    means "Samples are taken as evenly spaced. Printed times with few digits look like this."
    remedy "nothing"
    says format!("time stamps of the pulse lie up to {off_intervals:.3} sampling intervals off the uniform grid");

    /// The vehicle falls or brakes before contact.
    CR153 MovesBefore { by: &'static str, off_g: f64 }
    bears on (About::Pulse, Weight::Slight)
    decided "The level before contact differs from a steady level at rest: by 1 g against the pulse for a fall, by \
             0.05 g to 1.2 g for braking."
    means "Zero is the level at rest, not the mean before contact. The impact speed is the speed at contact."
    remedy "nothing; check that the impact speed is stated for contact, not for the time before braking"
    says match *by {
        "falls" => format!("free fall before contact: its level is {off_g:+.2} g off the level at rest"),
        _ => format!(
            "it brakes before contact: the level there is {off_g:+.2} g off the level at the start of the record. The \
             impact speed is that at contact"
        ),
    };

    /// The level before contact may be an offset or a free fall.
    CR154 FallOrOffset { level_g: f64 }
    bears on (About::Pulse, Weight::Marked)
    decided "The mean before contact is 1 g, within 0.05 g, and no part of the record shows the sensor at rest at \
             another level."
    means "The filter removes it as an offset. If the vehicle falls, this is wrong: 1 g is 49 mm of crush after 0.1 s."
    remedy "add --set filter.zero-level=none if the vehicle falls"
    says format!(
        "the level before contact is {level_g:+.2} g: an offset, or a free fall. A fall is no offset to remove: if it \
         is one, add --set filter.zero-level=none"
    );

    /// The pulse has an offset before contact.
    CR155 LevelOff { level_g: f64 }
    bears on (About::Pulse, Weight::None)
    decided "The mean from -50 ms to -10 ms is above 0.5 g, and neither a fall nor braking."
    means "The filter removes it."
    remedy "nothing; filter.zero-level = \"none\" keeps it"
    says format!("the level before contact is {level_g:+.2} g: an offset that the filter removes");

    /// The pulse is too strong or too weak for a crash.
    CR156 ImplausibleLevel { largest_g: Option<f64> }
    bears on (About::Pulse, Weight::Decisive)
    decided "The mean of 4.4 ms is held for 3 ms: never above 0.5 g, or above 1000 g. The latter changes the velocity \
             by 106 km/h over 44 mm, which no structure of a vehicle does."
    means "The channel is not the pulse, or its unit is wrong: nothing made from it is right."
    remedy "check channel and unit: --channel, --unit"
    says match largest_g {
        Some(largest_g) => format!(
            "the pulse stays above 1000 g for 3 ms (largest {largest_g:.0} g), no vehicle does: check its channel and \
             unit"
        ),
        None => "the pulse never exceeds 0.5 g for 3 ms: check its channel and unit".to_owned(),
    };

    /// Channels beside the pulse begin with samples that are exactly zero.
    CR157 OthersMuted { channels: String }
    bears on (About::Record, Weight::None)
    decided "A sensor has noise: more than ten samples of exactly 0 at the beginning of a record were not measured."
    means "Their zero level is the mean of the other samples before the event."
    remedy "nothing"
    says format!("a muted start (exact zeros), not counted in the zero level, in {channels}");

    /// Channels beside the pulse are sampled too slowly for the lowest class of filters.
    CR158 OthersSlow { channels: String }
    bears on (About::Record, Weight::None)
    decided "SAE J211-1 asks for ten times the class: 600 samples a second for CFC 60."
    means "These channels cannot be filtered to CFC 60. The pulse is as it was."
    remedy "nothing, or export them at their full rate"
    says format!("less than 600 samples a second, too few for CFC 60, in {channels}");

    /// Channels beside the pulse may be clipped, noisy, interrupted or drifting.
    CR159 OthersFaulty { what: &'static str, channels: String }
    bears on (About::Record, Weight::None)
    decided "As for the pulse: 3 equal samples at an extreme; 5 equal samples over 0.5 ms inside the pulse; a standard \
             deviation before the event above 1 g; a mean of the last 20 ms above 0.5 g, 100 ms or more after contact."
    means "Peaks, velocities or criteria of these channels may be wrong. The pulse and its results are not touched."
    remedy "look at these channels before you use them"
    says format!("{what} in {channels}");

    /// Channels have another sampling rate than the pulse.
    CR160 OtherRate { rate_hz: f64, pulse_hz: f64, channels: String }
    bears on (About::Record, Weight::None)
    decided "The sampling intervals differ by more than 1e-9."
    means "These channels cannot be compared with the pulse sample by sample, and cannot drive one model with it."
    remedy "bring them to one rate: --set filter.resample=10kHz"
    says format!(
        "another sampling rate than the pulse ({rate_hz} Hz against {pulse_hz} Hz; resample of the filter brings them \
         together) in {channels}"
    );

    /// Only the first pairs of sensors at one place are compared.
    CR161 PairsLeft { pairs: usize }
    bears on (About::Record, Weight::None)
    decided "20 pairs are compared."
    means "The others may disagree without a remark."
    remedy "nothing"
    says format!("{pairs} further pairs of sensors at one place are not compared");

    /// Two sensors of one place cannot be compared.
    CR162 PairNotCompared { one: String, other: String, what: &'static str }
    bears on (About::Record, Weight::None)
    decided "Their sampling intervals differ, their samples lie at other times, or neither has samples after contact."
    means "Nothing says whether they agree."
    remedy "nothing"
    says format!(
        "channels {one} and {other} ({what}) are not compared: their time grids differ, or there is nothing after \
         contact"
    );

    /// Two sensors of one place agree, as far as they can be compared.
    CR163 PairDiffers {
        one: String, other: String, what: &'static str, by_g: f64, by_m_per_s: f64, by_share: Option<f64>,
        crush_m: Option<f64>, other_crush_m: Option<f64>
    }
    bears on (About::Record, Weight::None)
    decided "Accelerations (mean of 4.4 ms) and velocities are compared up to 150 ms, dynamic crush where the impact \
             speed is known: it differs by 5 % at most, or is not known."
    means "The differences are what two sensors of one place show. One reading of crush is no better than that."
    remedy "nothing"
    says {
        let crush = crush_m.zip(*other_crush_m).map(|(one, other)| [one, other]);
        pair([one, other], what, [*by_g, *by_m_per_s], by_share.zip(crush))
    };

    /// Two sensors of one place disagree in crush.
    CR164 PairDisagrees {
        one: String, other: String, what: &'static str, by_g: f64, by_m_per_s: f64, by_share: f64, crush_m: f64,
        other_crush_m: f64
    }
    bears on (About::Pulse, Weight::Marked)
    decided "Their dynamic crush, from unfiltered samples without zero level, differs by more than 5 % of the larger \
             one."
    means "One of both may be wrong, and crush is uncertain by as much."
    remedy "compare both plots, and name the right one by --channel"
    says {
        let text = pair([one, other], what, [*by_g, *by_m_per_s], Some((*by_share, [*crush_m, *other_crush_m])));
        format!("{text}: one of them may be wrong")
    };
}

/// How far two sensors differ, in acceleration (g), velocity (m/s), and in crush (share, m) where it is known.
fn pair(
    [one, other]: [&String; 2],
    what: &str,
    [by_g, by_m_per_s]: [f64; 2],
    crush: Option<(f64, [f64; 2])>,
) -> String {
    let crush = crush.map_or_else(String::new, |(share, [one, other])| {
        format!(", by {:.1} % of dynamic crush ({:.0} and {:.0} mm)", 100.0 * share, 1e3 * one, 1e3 * other)
    });
    format!(
        "channels {one} and {other} ({what}) differ by at most {by_g:.2} g (4.4 ms mean) and {by_m_per_s:.2} m/s up to \
         150 ms{crush}"
    )
}
