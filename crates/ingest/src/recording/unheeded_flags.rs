//! Warnings of flags that have no effect on the format or on this record of it.

use crumple_signal::Notes;

use crate::IngestSettings;

/// Flags about the form of a file that are given. Facts about the test (mass, speed, time zero ...) and the choice of
/// the pulse count for every format.
fn given(settings: &IngestSettings) -> Vec<&'static str> {
    let flags = [
        ("--unit", settings.unit.is_some()),
        ("--time-unit", settings.time_unit.is_some()),
        ("--sample-time", settings.sample_time.is_some()),
        ("--profile", settings.profile.is_some()),
        ("--skip-to", settings.skip_to.is_some()),
        ("--field", settings.field.is_some()),
        ("--resample", settings.resample.is_some()),
        ("--vehicle-number", settings.vehicle_number.is_some()),
    ];
    flags.into_iter().filter(|(_, is_given)| *is_given).map(|(flag, _)| flag).collect()
}

/// Warns of every flag given that is not among the `relevant` ones. `why` says what settles the matter instead.
pub fn warn_except(settings: &IngestSettings, relevant: &[&str], why: &str, notes: &mut Notes) {
    for flag in given(settings).into_iter().filter(|flag| !relevant.contains(flag)) {
        warn(flag, why, notes);
    }
}

/// Warns of a flag that this record does not need.
pub fn warn(flag: &str, why: &str, notes: &mut Notes) {
    notes.warning(format!("{flag} has no effect: {why}"));
}
