//! Plain files on disk.

use std::fs;
use std::path::{Component, Path, PathBuf};

use anyhow::Context;
use crumple_artifact::{Artifact, ArtifactBuilder, OutputKind, SCHEMAS, Wave, refuse_named_pipe, write_atomically};
use crumple_artifact_cli::{
    PlainError, PlainProvenance, PlainWave, assemble, f64_bytes, parse_lines, plain_records, plain_waves,
};
use crumple_stage::{Refused, Usage, nearest, refuse_to_overwrite};

const RECORDS: &str = "records.ndjson";
const WAVES: &str = "waves.ndjson";
const PROVENANCE: &str = "provenance.json";

/// Writes an artifact as a folder of plain files.
pub fn write(artifact: &Artifact, folder: &Path, force: bool) -> anyhow::Result<()> {
    let records = plain_records(artifact).map_err(Refused::from)?;
    if !force && fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
        let problem = format!("{} exists and is not empty", folder.display());
        return Err(Usage::new(problem).hint("give a new folder, or --force").into());
    }
    let put = |name: &str, kind: OutputKind, bytes: &[u8]| {
        let path = folder.join(name);
        refuse_to_overwrite(&path, kind, &[artifact.path().to_owned()])?;
        write_atomically(&path, kind, |file| io_write(file, bytes))
            .with_context(|| format!("cannot write {}", path.display()))
    };
    let mut lines = String::new();
    for (line, wave) in plain_waves(artifact).iter().zip(artifact.waves().values()) {
        put(&line.file, OutputKind::Numbers, &f64_bytes(wave))?;
        lines += &serde_json::to_string(line)?;
        lines.push('\n');
    }
    put(WAVES, OutputKind::Lines, lines.as_bytes())?;
    if let Some(provenance) = artifact.provenance() {
        let text = serde_json::to_string_pretty(&PlainProvenance::of_content(provenance, artifact.digest()))?;
        put(PROVENANCE, OutputKind::Lines, format!("{text}\n").as_bytes())?;
    }
    put(RECORDS, OutputKind::Lines, records.as_bytes())
}

fn io_write(file: &mut impl std::io::Write, bytes: &[u8]) -> std::io::Result<()> {
    file.write_all(bytes)
}

/// Reads a folder of plain files, or a single file of records.
pub fn read(source: &Path) -> anyhow::Result<(ArtifactBuilder, PlainProvenance)> {
    let refuse = |error: PlainError| Refused::new(error.to_string()).hint("docs/format.md has the record types");
    if !source.is_dir() {
        let records = parse_lines(&source.display().to_string(), &text_of(source)?).map_err(refuse)?;
        return Ok((assemble(records, Vec::new(), &nearest_schema).map_err(refuse)?, PlainProvenance::default()));
    }
    let lines = |name: &str| -> anyhow::Result<Option<(String, String)>> {
        let path = source.join(name);
        if !path.exists() {
            return Ok(None);
        }
        Ok(Some((path.display().to_string(), text_of(&path)?)))
    };
    let (records, wave_lines) = (lines(RECORDS)?, lines(WAVES)?);
    if records.is_none() && wave_lines.is_none() {
        return Err(Refused::new(format!("{}: neither {RECORDS} nor {WAVES} is in it", source.display()))
            .hint("crumple-artifact unpack FILE DIR shows what a folder looks like")
            .into());
    }
    let records = match records {
        None => Vec::new(),
        Some((name, text)) => parse_lines(&name, &text).map_err(refuse)?,
    };
    let mut waves = Vec::new();
    if let Some((name, text)) = wave_lines {
        for line in parse_lines::<PlainWave>(&name, &text).map_err(refuse)? {
            let wave = wave(source, &line, refuse)?;
            waves.push((line.id, wave));
        }
    }
    let provenance: PlainProvenance = match lines(PROVENANCE)? {
        None => PlainProvenance::default(),
        Some((name, text)) => serde_json::from_str(&text).map_err(|error| Refused::new(format!("{name}: {error}")))?,
    };
    Ok((assemble(records, waves, &nearest_schema).map_err(refuse)?, provenance))
}

fn wave(folder: &Path, line: &PlainWave, refuse: impl Fn(PlainError) -> Refused) -> anyhow::Result<Wave> {
    let inside =
        Path::new(&line.file).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !inside {
        let problem = format!("file {:?} lies outside the folder", line.file);
        return Err(refuse(PlainError::Wave { id: line.id.clone(), problem }).into());
    }
    let path: PathBuf = folder.join(&line.file);
    let bytes = refuse_named_pipe(&path)
        .and_then(|()| fs::read(&path))
        .map_err(|error| Refused::new(format!("cannot read {}: {error}", path.display())))?;
    Ok(line.with_bytes(&bytes).map_err(refuse)?)
}

/// The schema that a mistyped name may mean.
fn nearest_schema(name: &str) -> Option<&'static str> {
    nearest(name, SCHEMAS.iter().copied())
}

fn text_of(path: &Path) -> anyhow::Result<String> {
    fs::read_to_string(path).map_err(|error| Refused::new(format!("cannot read {}: {error}", path.display())).into())
}
