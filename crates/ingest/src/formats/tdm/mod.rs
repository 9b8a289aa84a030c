//! TDM, the older files of DIAdem: an XML header `.tdm` and a binary file `.tdx` beside it.
//! May use text, waveform, diadem, iso13499, the number types of tdms and what formats may use.

mod header;

use crumple_signal::Notes;

use crate::formats::reader::{Bundle, Reader, stem};
use crate::formats::tdms::samples::{Strided, numbers};
use crate::formats::text::lines::{decode, without_mark};
use crate::formats::waveform::channel::Waveform;
use crate::formats::waveform::conversion;
use crate::formats::{diadem, iso13499};
use crate::recording::content::Recording;
use crate::recording::read_channel::ReadChannel;
use crate::{IngestError, IngestSettings, Place};
use header::{Block, TdmChannel, TdmHeader};

/// Largest header, bytes.
const HEADER_LIMIT: usize = 128 << 20;
/// Most samples in a file, all channels together: 2 GiB in memory.
const SAMPLE_LIMIT: u64 = 1 << 28;

/// Reader of TDM files.
pub struct Tdm;

impl Reader for Tdm {
    fn format(&self) -> &'static str {
        "tdm"
    }

    fn recognises(&self, head: &[u8]) -> bool {
        let head = without_mark(head);
        let is_xml = head.trim_ascii_start().starts_with(b"<");
        is_xml && head.windows(7).any(|window| window == b"usi:tdm")
    }

    fn companion(&self, main: &str, name: &str) -> bool {
        let is_tdx = name.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("tdx"));
        is_tdx && stem(name).to_lowercase() == stem(main).to_lowercase()
    }

    fn relevant_flags(&self) -> &'static [&'static str] {
        &["--unit", "--time-unit", "--vehicle-number", "--resample"]
    }

    fn read(&self, bundle: &Bundle, settings: &IngestSettings) -> Result<Recording, IngestError> {
        read(bundle, settings)
    }
}

/// Reads the header and its channels.
fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording, IngestError> {
    let file = bundle.main.name.as_str();
    if bundle.main.bytes.len() > HEADER_LIMIT {
        return Err(IngestError::TooLarge {
            place: Place::file(file),
            found: format!("a TDM header of {} MiB", bundle.main.bytes.len() >> 20),
            limit: format!("headers up to {} MiB", HEADER_LIMIT >> 20),
        });
    }
    let header = header::parse(&decode(&without_mark(&bundle.main.bytes))).map_err(|found| {
        IngestError::content(
            Place::file(file),
            found,
            "a TDM header as DIAdem writes it",
            "export the data from DIAdem as TDMS or CSV",
        )
    })?;
    let mut notes = Notes::new();
    let (tdx_name, tdx) = binary(bundle, &header, &mut notes)?;
    let mut samples = 0_u64;
    let mut waveforms = Vec::with_capacity(header.channels.len());
    for channel in &header.channels {
        if let Ok(block) = &channel.block {
            samples = samples.saturating_add(block.length.min(tdx.len() as u64));
        }
        if samples > SAMPLE_LIMIT {
            return Err(IngestError::TooLarge {
                place: Place::file(file),
                found: format!("more than {} million samples", SAMPLE_LIMIT / 1_000_000),
                limit: format!("at most {SAMPLE_LIMIT} samples in all channels together"),
            });
        }
        waveforms.push(waveform(channel, tdx_name, tdx, header.big_endian));
    }
    let channels = conversion::to_channels(file, waveforms, settings, &mut notes)?;
    let mut channels: Vec<ReadChannel> = channels.into_iter().map(|(_, found)| found).collect();
    let pulse_rule = iso13499::pulse_rule(&mut channels, settings, &mut notes);
    let details = diadem::details(&header.root);
    Ok(Recording { details, channels, pulse_rule, contact_at_zero: false, notes })
}

/// The binary file: that of the header's name in any case, else the one that is named like the header.
fn binary<'a>(bundle: &'a Bundle, header: &TdmHeader, notes: &mut Notes) -> Result<(&'a str, &'a [u8]), IngestError> {
    let wanted = header.url.rsplit(['/', '\\']).next().unwrap_or(&header.url);
    let named = bundle.companions.iter().find(|(name, _)| name.to_lowercase() == wanted.to_lowercase());
    if let Some((name, bytes)) = named {
        return Ok((name, bytes));
    }
    if let Some((name, bytes)) = bundle.companions.iter().next() {
        notes.warning(format!(
            "{} names {wanted} as its file of samples, {name} is taken: renamed, perhaps",
            bundle.main.name
        ));
        return Ok((name, bytes));
    }
    Err(IngestError::content(
        Place::file(&bundle.main.name),
        format!("a TDM header without its samples: {wanted} is not beside it"),
        format!("the .tdx file of the same name as the .TDM file ({}.tdx)", stem(&bundle.main.name)),
        format!(
            "copy {wanted} into the same folder, with the name of the .TDM file, or export the data as TDMS or CSV"
        ),
    ))
}

fn waveform(channel: &TdmChannel, tdx_name: &str, tdx: &[u8], big_endian: bool) -> Waveform {
    let attribute = |name: &str| channel.attributes.get(name).map_or("", |text| text.trim());
    let number = |name: &str| attribute(name).parse::<f64>().ok().filter(|x| x.is_finite());
    let mut waveform = Waveform::new(channel.group.clone(), channel.name.clone());
    attribute("unit_string").clone_into(&mut waveform.unit);
    waveform.comment = Some(attribute("description").to_owned()).filter(|text| !text.is_empty());
    let interval = number("wf_increment").filter(|dt| *dt > 0.0);
    let start = number("wf_start_offset").unwrap_or(0.0);
    waveform.set_steps(interval.map(|dt| (start, dt)), attribute("wf_xname"), attribute("wf_xunit_string"));
    waveform.values = channel.block.clone().and_then(|block| values(&block, tdx_name, tdx, big_endian));
    waveform
}

fn values(block: &Block, tdx_name: &str, tdx: &[u8], big_endian: bool) -> Result<Vec<f64>, String> {
    let size = block.kind.size();
    let range =
        usize::try_from(block.offset).ok().zip(usize::try_from(block.length).ok()).and_then(|(offset, count)| {
            let end = count.checked_mul(size)?.checked_add(offset)?;
            Some((count, tdx.get(offset..end)?))
        });
    let Some((count, raw)) = range else {
        return Err(format!(
            "its block, {} samples of {size} bytes from byte {} on, is not in {tdx_name} of {} bytes",
            block.length,
            block.offset,
            tdx.len()
        ));
    };
    let mut values = Vec::new();
    numbers(Strided { raw, stride: size, count }, block.kind, big_endian, &mut values);
    Ok(values)
}
