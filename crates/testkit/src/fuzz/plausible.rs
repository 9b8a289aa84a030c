//! Records as people might bring them, through the whole chain: fixtures in other units, at other speeds, ended early,
//! and artifacts of other fixtures among their own.

use std::fs;
use std::path::{Path, PathBuf};

use crate::fuzz::campaign::{Campaign, Ending, ending_of, is_sound};
use crate::fuzz::tampering::Dice;
use crate::places::workspace;

/// Stages with the numbers of the artifacts that each reads; 0 is the record.
const CHAIN: [(&str, &[usize]); 8] = [
    ("crumple-ingest", &[0]),
    ("crumple-filter", &[1]),
    ("crumple-integrate", &[2]),
    ("crumple-identify", &[2, 3]),
    ("crumple-parameter-solve", &[2, 3, 4]),
    ("crumple-simulate", &[2, 3, 5]),
    ("crumple-predict", &[3, 5]),
    ("crumple-report", &[1, 2, 3, 4, 5, 6, 7]),
];

const FIXTURES: [&str; 4] = ["double", "elastoplastic", "kelvin", "noisy"];

const UNITS: [&str; 10] = ["g", "m/s^2", "kilo-g", "mm/ms^2", "mm/s^2", "mg", "cm/s^2", "ft/s^2", "in/s^2", "km/h/s"];

/// A record of the campaign in words, and its text.
fn record(dice: &mut Dice) -> Result<(String, String), String> {
    let fixture = dice.one_of(&FIXTURES);
    let path = workspace().join("fixtures").join(fixture).join("crash.csv");
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let rows = text.lines().filter_map(|line| {
        let (time, value) = line.split_once(',')?;
        Some((time, value.parse::<f64>().ok()?))
    });
    let power = |dice: &mut Dice, most: usize| 10.0_f64.powf(dice.below(2 * most + 1) as f64 - most as f64);
    let (factor, speed_km_h, unit) = (power(dice, 4), 35.0 * power(dice, 3), dice.one_of(&UNITS));
    let sign = if dice.below(8) == 0 { -1.0 } else { 1.0 };
    // To rest, or until so many samples after contact; every sample, or one of several.
    let samples = if dice.below(2) == 0 { usize::MAX } else { 1 + dice.below(50) };
    let every = *dice.one_of(&[1, 1, 10, 25]);
    let mass = 873.0 * power(dice, 2);
    let mut made = format!("# mass: {mass} kg\n# impact speed: {speed_km_h} km/h\ntime_s,accel_{unit}\n");
    let contact = rows.clone().position(|(time, _)| time.parse::<f64>().is_ok_and(|t| t >= 0.0)).unwrap_or_default();
    let first = contact % every;
    for (time, value) in rows.skip(first).step_by(every).take((contact / every).saturating_add(samples)) {
        made += &format!("{time},{}\n", sign * factor * value);
    }
    Ok((format!("{fixture}, {unit} times {factor}, {speed_km_h} km/h, {samples} samples of every {every}"), made))
}

/// Runs the chain on record `number`: how it ended, what was said, and what the record is. An artifact of another
/// fixture stands in for one of its own now and then, which must be seen.
pub(super) fn run_chain(campaign: &Campaign, number: u64) -> Result<(Ending, String, String), String> {
    let mut dice = Dice::new(number | 1 << 40);
    let (what, text) = record(&mut dice)?;
    let folder = campaign.folder.join(format!("{number}-plausible"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let names: Vec<PathBuf> = (0..=8).map(|k| folder.join(format!("{k}.mcap"))).collect();
    let csv = folder.join("record.csv");
    fs::write(&csv, text).map_err(|error| format!("{}: {error}", csv.display()))?;
    let swapped = if dice.below(4) == 0 { 1 + dice.below(5) } else { 0 };
    let strange = stranger(&mut dice, swapped);
    let mut last = (Ending::Code(0), String::new());
    for (k, (program, inputs)) in CHAIN.iter().enumerate() {
        let is_swapped = strange.is_some() && inputs.contains(&swapped) && inputs.len() > 1;
        let path = |input: &usize| match input {
            0 => csv.clone(),
            k if *k == swapped && is_swapped => strange.clone().unwrap_or_default(),
            k => names[*k].clone(),
        };
        let output = if k + 1 == CHAIN.len() { folder.join("report.html") } else { names[k + 1].clone() };
        let words: Vec<String> = inputs.iter().map(path).chain(["-o".into(), output.clone()]).map(in_words).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let (mut ending, said) = ending_of(&campaign.bin.join(program), &words, &folder);
        // Two runs in one page, or a result that check refuses.
        let is_wrong = is_swapped || (k + 1 < CHAIN.len() && !is_sound(&output));
        if ending == Ending::Code(0) && is_wrong {
            ending = Ending::WrongResult;
        }
        let goes_on = matches!(ending, Ending::Code(0 | 4));
        last = (ending, format!("{program}: {said}"));
        if !goes_on {
            break;
        }
    }
    if last.0.is_allowed() {
        let _ = fs::remove_dir_all(&folder);
    }
    Ok((last.0, last.1, what))
}

/// An artifact of another fixture.
fn stranger(dice: &mut Dice, number: usize) -> Option<PathBuf> {
    let of = |fixture: &str| -> Option<PathBuf> {
        let folder = workspace().join("fixtures").join(fixture).join("golden");
        let mut files = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path());
        let begins_so = |path: &PathBuf| {
            path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(&format!("{number}-")))
        };
        files.find(begins_so)
    };
    let fixture: &&str = dice.one_of(&FIXTURES);
    of(fixture).filter(|_| number > 0)
}

fn in_words(path: impl AsRef<Path>) -> String {
    path.as_ref().display().to_string()
}
