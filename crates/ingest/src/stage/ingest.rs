//! The stage: files in, `/test`, `/wave/<id>` and `/quality/<id>` out.

use std::path::PathBuf;

use crumple_artifact::InputDigest;
use crumple_artifact::records::{DamageV1, QualityV1, TestV1, VehicleV1, VehiclesV1};
use crumple_stage::{Loaded, Outcome, Output, Stage, Usage};

use crumple_ingest::{Bundle, Damage, IngestSettings, Ingested, Quality, RecordDigests, TestVehicle, ingest};

use crate::stage::process::{refused, show_progress};

/// The stage `ingest`.
pub struct Ingest;

impl Stage for Ingest {
    const NAME: &'static str = "ingest";
    const BUILD: &'static str = env!("CRUMPLE_BUILD");
    const ABOUT: &'static str = "Reads a crash record as you have it (a table such as CSV, an NHTSA EV5 or ISO-MME \
        test, its folder, or a zip of one) and writes it in SI units: \
        every channel, the test's mass and impact speed, the crash pulse. Asks for what the record does not say; \
        corrects nothing. \
        crumple-ingest --list INPUT prints the table of channels and writes nothing.";

    type Options = IngestSettings;
    type Settings = IngestSettings;
    type Input = Bundle;

    fn other_flags() -> Vec<clap::Arg> {
        let list = clap::Arg::new("list").long("list").action(clap::ArgAction::SetTrue).help_heading(None);
        vec![list.help("Print the table of channels and write nothing: crumple-ingest --list INPUT")]
    }

    fn resolve(options: IngestSettings) -> anyhow::Result<IngestSettings> {
        Ok(options)
    }

    fn load(paths: &[PathBuf], _: &IngestSettings) -> anyhow::Result<Loaded<Bundle>> {
        let [path] = paths else {
            return Err(Usage::new(format!("{} inputs, one record is read at a time", paths.len()))
                .hint("give one file, or the folder of one test")
                .into());
        };
        let bundle = Bundle::open_with_progress(path, show_progress).map_err(refused)?;
        let digests = input_digests(bundle.digests());
        Ok(Loaded::new(bundle, digests))
    }

    fn digests(paths: &[PathBuf]) -> Option<Vec<InputDigest>> {
        let [path] = paths else { return None };
        Bundle::digests_at(path).map(input_digests)
    }

    fn run(settings: &IngestSettings, bundle: &Bundle, out: &mut Output) -> anyhow::Result<Outcome> {
        let ingested = ingest(bundle, settings).map_err(refused)?;
        for line in summary(&ingested) {
            out.summary(line);
        }
        out.put("/test", &TestV1::from(&ingested.test))?;
        if let Some(damage) = &ingested.damage {
            out.put("/damage", &damage_record(damage))?;
        }
        if !ingested.vehicles.is_empty() {
            let vehicles = ingested.vehicles.iter().map(vehicle_record).collect();
            let closing_speed_m_per_s = ingested.closing_speed_m_per_s;
            out.put("/vehicles", &VehiclesV1 { vehicles, closing_speed_m_per_s })?;
        }
        for wave in ingested.waves {
            out.put(&format!("/quality/{}", wave.id), &quality_record(&wave.quality))?;
            out.wave(&wave.id, wave.quantity, wave.samples)?;
        }
        out.notes().extend(ingested.notes);
        Ok(Outcome::Done)
    }
}

fn input_digests(record: RecordDigests) -> Vec<InputDigest> {
    let sidecar = record.sidecar.map(|digest| InputDigest { kind: "sidecar".to_owned(), digest });
    let kind = format!("{} {}", record.format, record.name);
    std::iter::once(InputDigest { kind, digest: record.record }).chain(sidecar).collect()
}

fn damage_record(damage: &Damage) -> DamageV1 {
    DamageV1 {
        residual_crush_m: damage.residual_crush_m.clone(),
        damage_width_m: damage.damage_width_m,
        vehicle_width_m: damage.vehicle_width_m,
        classification: damage.classification.clone(),
        from: damage.from.clone(),
    }
}

fn vehicle_record(vehicle: &TestVehicle) -> VehicleV1 {
    VehicleV1 {
        number: vehicle.number,
        description: vehicle.description.clone(),
        mass_kg: vehicle.mass_kg,
        impact_speed_m_per_s: vehicle.impact_speed_m_per_s,
        pulse: vehicle.pulse.clone(),
        channels: vehicle.channels.clone(),
    }
}

fn quality_record(quality: &Quality) -> QualityV1 {
    let pre = quality.pre_event;
    QualityV1 {
        zero_level: pre.map(|p| p.zero_level),
        noise_floor: pre.map(|p| p.noise_floor),
        pre_event_from_s: pre.map(|p| p.from_s),
        pre_event_to_s: pre.map(|p| p.to_s),
        sample_rate_hz: quality.sample_rate_hz,
        time_jitter: quality.time_jitter,
        minimum: quality.minimum,
        maximum: quality.maximum,
        clipped_run: quality.clipped_run as u64,
        constant_run: Some(quality.constant_run as u64),
        constant_run_from_s: quality.constant_run_from_s,
        end_level: quality.end_level,
        rest_level: quality.fall.map(|fall| fall.rest_level),
    }
}

fn summary(ingested: &Ingested) -> Vec<String> {
    let test = &ingested.test;
    let known = |value: Option<f64>, unit: &str| {
        value.map_or_else(|| "unknown".to_owned(), |x| format!("{} {unit}", (x * 1e4).round() / 1e4))
    };
    let mut lines = vec![format!(
        "{} ({}): {}; {} of {} channels with data; mass {}, impact speed {}",
        test.source.name,
        test.source.format,
        test.title,
        ingested.waves.len(),
        test.channels.len(),
        known(test.mass_kg, "kg"),
        known(test.impact_speed_m_per_s, "m/s"),
    )];
    if let Some(pulse) = ingested.pulse() {
        let location = test.channel(&pulse.id).map(|c| c.location.as_str()).filter(|l| !l.is_empty());
        lines.push(format!(
            "pulse: channel {}{}, {} samples at {} Hz from {:.4} s to {:.4} s",
            pulse.id,
            location.map_or_else(String::new, |l| format!(" ({l})")),
            pulse.samples.len(),
            (pulse.samples.rate_hz() * 1e3).round() / 1e3,
            pulse.samples.t0_s(),
            pulse.samples.end_s(),
        ));
    }
    lines
}
