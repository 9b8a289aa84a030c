//! The uncertain inputs of the options, and what the intervals made of them rest on.

use crumple_integrate::{Spread, Uncertainty, UsedStart};
use crumple_signal::value::{Level, Share, Speed, Time};
use crumple_signal::{Distribution, STANDARD_GRAVITY_M_PER_S2, Uncertain};
use crumple_stage::Usage;

use crate::stage::options::flags::Options;

fn spread<V>(stated: Uncertain<V>, si: impl Fn(V) -> f64) -> Spread {
    Spread { size: si(stated.size), distribution: stated.distribution }
}

/// Repetitions where none are stated: the ends of an interval are then uncertain by a ninth of a standard deviation.
const REPLICATES: u32 = 400;
/// Fewer have no 5 % quantile.
const FEWEST_REPLICATES: u32 = 20;
/// More do not make an interval better that rests on stated uncertainties.
const MOST_REPLICATES: u32 = 100_000;

/// `None` where nothing is uncertain or no repetitions are wanted.
pub fn uncertainty(options: &Options) -> Result<Option<Uncertainty>, Usage> {
    let replicates = options.uncertainty_replicates.unwrap_or(REPLICATES);
    if replicates != 0 && !(FEWEST_REPLICATES..=MOST_REPLICATES).contains(&replicates) {
        return Err(Usage::new(format!(
            "{replicates} replicates, expected 0 or a number from {FEWEST_REPLICATES} to {MOST_REPLICATES}"
        )));
    }
    let stated = Uncertainty {
        impact_speed_m_per_s: options.speed_uncertainty.map(|u| spread(u, Speed::si)),
        zero_level_m_per_s2: options.zero_level_uncertainty.map(|u| spread(u, Level::si)),
        gain: options.gain_uncertainty.map(|u| spread(u, Share::si)),
        time_zero_s: options.time_zero_uncertainty.map(|u| spread(u, Time::si)),
        replicates: replicates as usize,
        seed: options.uncertainty_seed.unwrap_or(1),
    };
    let inputs = [stated.impact_speed_m_per_s, stated.zero_level_m_per_s2, stated.gain, stated.time_zero_s];
    Ok((replicates > 0 && inputs.into_iter().any(|input| input.is_some())).then_some(stated))
}

/// What the intervals rest on, in words.
pub fn uncertainty_note(uncertainty: &Uncertainty, start: UsedStart) -> String {
    let Uncertainty { impact_speed_m_per_s, zero_level_m_per_s2, gain, time_zero_s, replicates, seed } = uncertainty;
    let inputs = [
        ("impact speed", impact_speed_m_per_s, 3.6, "km/h"),
        ("zero level", zero_level_m_per_s2, 1.0 / STANDARD_GRAVITY_M_PER_S2, "g"),
        ("gain", gain, 1e2, "%"),
        ("time zero", time_zero_s, 1e3, "ms"),
    ];
    let stated = inputs.into_iter().filter_map(|(name, spread, factor, unit)| {
        let Spread { size, distribution } = (*spread)?;
        // Rounded to what was typed: 0.1 km/h is not 0.09999999999999999.
        let size = (1e9 * size * factor).round() / 1e9;
        Some(match distribution {
            Distribution::Normal => format!("{name} {size} {unit} (standard deviation, normal)"),
            Distribution::Uniform => format!("{name} +-{size} {unit} (uniform)"),
        })
    });
    let moved = match (time_zero_s, start) {
        (None, _) => "",
        (Some(_), UsedStart::RecordStart) => {
            "; an error of time zero moves the crush by v0 times it and every time by it, not the velocity, which is \
             integrated from the start of the record"
        }
        (Some(_), UsedStart::TimeZero) => {
            "; an error of time zero cuts the record there: it moves the crush by v0 times it, and the velocity by \
             what the pulse does in it"
        }
    };
    let stated: Vec<String> = stated.collect();
    format!("intervals are 5-95 % of {replicates} replicates (seed {seed}) with {}{moved}", stated.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_uncertain_or_no_repetitions_is_none() {
        assert_eq!(uncertainty(&Options::default()).unwrap(), None);
        let speed = "0.1 m/s".parse().ok();
        let stated =
            |uncertainty_replicates| Options { speed_uncertainty: speed, uncertainty_replicates, ..Options::default() };
        assert_eq!(uncertainty(&stated(None)).unwrap().map(|u| (u.replicates, u.seed)), Some((400, 1)));
        assert_eq!(uncertainty(&stated(Some(0))).unwrap(), None);
        assert!(uncertainty(&stated(Some(3))).is_err());
    }
}
