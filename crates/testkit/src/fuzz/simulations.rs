//! Simulations with changed bytes. A change in a value moves that value, and nothing else: where most values of a
//! channel are other ones than those of the sound file and the reader remarks nothing more, it has read wrongly.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use crumple_artifact::Artifact;
use crumple_artifact::records::{RemarksV1, TestV1};
use crumple_signal::Sampled;

use crate::fuzz::campaign::{Campaign, Ending, Tally, ending_of, is_sound};
use crate::fuzz::tampering::{Dice, mutate};
use crate::places::shared;
use crate::simulated;

/// Parts of a channel that may differ: a part that is left out or written twice moves what follows in a text.
const MOVED: f64 = 0.2;
/// Values of one file and of the changed one are the same within this part of the largest.
const SAME: f64 = 1e-9;

/// A sound file with the flags that it is read with, and what is read of it.
struct Sound {
    name: String,
    bytes: Vec<u8>,
    flags: String,
    read: Read,
}

/// What is read of a file: channels that are not computed, and codes of remarks.
#[derive(Default)]
struct Read {
    waves: BTreeMap<String, Sampled>,
    /// Contact in the time of the file, s.
    contact_s: f64,
    codes: BTreeSet<String>,
}

impl Read {
    fn of(out: &Path) -> Option<Self> {
        let artifact = Artifact::open(out).ok()?;
        let remarks = artifact.record::<RemarksV1>("/remarks").ok().flatten();
        let codes = remarks.map(|list| list.remarks.into_iter().map(|remark| remark.code).collect());
        let is_read = |id: &&String| !id.contains("acceleration") && !id.contains("force");
        let waves = artifact.waves().iter().filter(|(id, _)| is_read(id));
        let waves = waves.map(|(id, wave)| (id.clone(), wave.sampled.clone())).collect();
        let contact = artifact.record::<TestV1>("/test").ok().flatten().and_then(|test| test.contact);
        let contact_s = contact.map_or(0.0, |contact| contact.source_time_s);
        Some(Self { waves, contact_s, codes: codes.unwrap_or_default() })
    }

    /// The first channel of which most values are others than in the sound file.
    fn moved<'a>(&'a self, sound: &Self) -> Option<&'a str> {
        if !self.codes.is_subset(&sound.codes) {
            return None;
        }
        let is_moved = |(id, wave): &(&'a String, &Sampled)| {
            let Some(of_sound) = sound.waves.get(*id) else { return false };
            let most = of_sound.samples().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let differs = |(k, x): (usize, &f64)| {
                let at = of_sound.at(wave.time_s(k) + self.contact_s - sound.contact_s);
                at.is_some_and(|y| (x - y).abs() > SAME.max(1e-3 * wave.dt_s()) * most)
            };
            let count = wave.samples().iter().enumerate().filter(|pair| differs(*pair)).count();
            most > 0.0 && count as f64 > MOVED * wave.len() as f64
        };
        self.waves.iter().find(is_moved).map(|(id, _)| id.as_str())
    }
}

/// Runs the campaign on simulations alone.
///
/// # Errors
/// Of the disk, in words.
pub fn run_simulations(campaign: &Campaign, tell: &mut dyn FnMut(String)) -> Result<Tally, String> {
    fs::create_dir_all(&campaign.folder).map_err(|error| format!("{}: {error}", campaign.folder.display()))?;
    let sound: Vec<Sound> = sound_files(campaign)?;
    let mut tally = Tally::default();
    for number in campaign.first..campaign.first + campaign.files {
        let mut dice = Dice::new(number);
        let file = dice.one_of(&sound);
        let mut bytes = file.bytes.clone();
        mutate(&mut bytes, &mut dice);
        let flags = if dice.below(8) == 0 { " --list" } else { file.flags.as_str() };
        let (mut ending, mut said, read) = read(campaign, &file.name, &bytes, flags)?;
        if let Some(moved) = read.as_ref().and_then(|read| read.moved(&file.read)) {
            (ending, said) = (Ending::WrongResult, format!("channel {moved} is another one"));
        }
        tally.add(ending);
        if !ending.is_allowed() {
            let kept = campaign.folder.join(format!("{number}-{}", file.name));
            fs::write(&kept, &bytes).map_err(|error| format!("{}: {error}", kept.display()))?;
            let first = said.lines().next().unwrap_or_default();
            tell(format!("{ending}: crumple-ingest{flags} ({first}): {}", kept.display()));
        }
    }
    Ok(tally)
}

/// How the reader ends on these bytes, what it says and what it has read.
fn read(campaign: &Campaign, name: &str, bytes: &[u8], flags: &str) -> Result<(Ending, String, Option<Read>), String> {
    // A folder of its own: what lies beside a file may belong to it.
    let folder = campaign.folder.join("one");
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let (file, out) = (folder.join(name), campaign.folder.join("out.mcap"));
    fs::write(&file, bytes).map_err(|error| format!("{}: {error}", file.display()))?;
    let _ = fs::remove_file(&out);
    let mut words = vec![file.to_str().unwrap_or_default(), "-q", "-o", out.to_str().unwrap_or_default()];
    words.extend(flags.split_whitespace());
    let (mut ending, said) = ending_of(&campaign.bin.join("crumple-ingest"), &words, &campaign.folder);
    if ending == Ending::Code(0) && !is_sound(&out) {
        ending = Ending::WrongResult;
    }
    let read = if ending == Ending::Code(0) { Read::of(&out) } else { None };
    let _ = fs::remove_file(&file);
    Ok((ending, said, read))
}

/// The files of the testkit, and of the reference where they are here.
fn sound_files(campaign: &Campaign) -> Result<Vec<Sound>, String> {
    let own = " --units mm-ms-kg --node 7";
    let made = [
        ("binout", simulated::binout(true), own),
        ("binout0000", simulated::binout(false), own),
        ("T01", simulated::t01(), " --node 7"),
        ("nodout", simulated::nodout().into_bytes(), own),
        ("rwforc", simulated::rwforc().into_bytes(), " --units mm-ms-kg --allow-missing"),
    ];
    let mut files: Vec<(String, Vec<u8>, String)> =
        made.into_iter().map(|(name, bytes, flags)| (name.to_owned(), bytes, flags.to_owned())).collect();
    const SETS: [(&str, &str); 3] = [
        ("s1-same-car", "mm-ms-kg"),
        ("s2-middle-of-the-front-too-stiff", "mm-s-t"),
        ("s3-openradioss-engine-mount-too-soft", "mm-ms-kg"),
    ];
    for (set, units) in SETS {
        let Some(folder) = shared(&format!("reference/simulation/{set}")) else { continue };
        let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok).map(|entry| entry.path());
        let mut paths: Vec<_> = entries.collect();
        paths.sort();
        for path in paths {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let flags = match name.as_str() {
                "truth.json" | "test.csv" | "test-wall-and-engine.csv" => continue,
                "curves.cur" => format!(" --units {units}"),
                "glstat" | "rwforc" | "rcforc" | "binout0001" => format!(" --units {units} --allow-missing"),
                _ => format!(" --units {units} --node 1000001"),
            };
            files.push((name, fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?, flags));
        }
    }
    let mut sound = Vec::new();
    for (name, bytes, flags) in files {
        let (.., found) = read(campaign, &name, &bytes, &flags)?;
        sound.push(Sound { read: found.unwrap_or_default(), name, bytes, flags });
    }
    Ok(sound)
}
