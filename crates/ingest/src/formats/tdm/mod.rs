//! TDM, the older files of DIAdem: an XML header `.tdm` and a binary file `.tdx` beside it.

mod header;

use crumple_signal::Notes;

use crate::formats::reader::{Bundle, Reader, stem};
use crate::formats::tdms::metadata::Type;
use crate::formats::tdms::samples::{Strided, numbers, times};
use crate::formats::text::lines::{decode, without_mark};
use crate::formats::waveform::channel::{Instant, Waveform};
use crate::formats::waveform::conversion;
use crate::formats::waveform::date::instant;
use crate::formats::{diadem, iso13499};
use crate::recording::content::Recording;
use crate::recording::read_channel::ReadChannel;
use crate::{IngestError, IngestSettings, Place};
use header::{Block, Form, Numbers, Sequence, TdmChannel, TdmHeader};

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
        &["--unit", "--time-unit", "--sample-time", "--vehicle-number", "--resample"]
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
        samples = samples.saturating_add(channel.samples.as_ref().map_or(0, |sequence| sequence.most(tdx)));
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
    waveform.origin = instant(attribute("wf_start_time"));
    waveform.values = channel.samples.clone().and_then(|sequence| {
        let (samples, first_stamp) = values(&sequence, tdx_name, tdx, big_endian)?;
        waveform.set_stamps(first_stamp);
        Ok(samples)
    });
    waveform
}

impl Sequence {
    /// Samples that it makes at most.
    fn most(&self, tdx: &[u8]) -> u64 {
        match (self.form, &self.numbers) {
            (Form::ImplicitLinear { count }, _) => count,
            (_, Numbers::Block(block)) => block.length.min(tdx.len() as u64),
            (_, Numbers::Here(numbers)) => numbers.len() as u64,
        }
    }
}

/// The samples; of times those since the first one, and that one.
fn values(
    sequence: &Sequence,
    tdx_name: &str,
    tdx: &[u8],
    big_endian: bool,
) -> Result<(Vec<f64>, Option<Instant>), String> {
    let (mut numbers, first_stamp) = match &sequence.numbers {
        Numbers::Block(block) => of_block(block, tdx_name, tdx, big_endian)?,
        Numbers::Here(numbers) => (numbers.clone(), None),
    };
    match sequence.form {
        Form::Explicit => {}
        Form::RawLinear { offset, slope } => numbers.iter_mut().for_each(|x| *x = offset + slope * *x),
        Form::ImplicitLinear { count } => {
            let [start, step] = numbers.as_slice() else {
                return Err(format!("{} numbers in place of its start and its step", numbers.len()));
            };
            numbers = (0..count).map(|k| start + step * k as f64).collect();
        }
    }
    Ok((numbers, first_stamp))
}

/// The numbers of a block; of times those since the first one, and that one.
fn of_block(
    block: &Block,
    tdx_name: &str,
    tdx: &[u8],
    big_endian: bool,
) -> Result<(Vec<f64>, Option<Instant>), String> {
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
    let (mut values, mut first_stamp) = (Vec::new(), None);
    let raw = Strided { raw, stride: size, count };
    if block.kind == Type::Time {
        times(raw, big_endian, &mut first_stamp, &mut values);
    } else {
        numbers(raw, block.kind, big_endian, &mut values);
    }
    Ok((values, first_stamp))
}
