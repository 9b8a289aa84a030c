//! TDM, the older files of DIAdem: an XML header `.tdm` and a binary file `.tdx` beside it.

use std::collections::{BTreeMap, HashMap};

use crumple_signal::{About, Notes, Weight, remarks};
use roxmltree::{Document, Node, ParsingOptions};

use crate::formats::reader::{Bundle, Reader, stem};
use crate::formats::tdms::metadata::{Strided, Type, numbers, times};
use crate::formats::tdms::segments::{MANY_SAMPLES, SAMPLE_LIMIT};
use crate::formats::text::lines::{decode, without_mark};
use crate::formats::waveform::channel::Waveform;
use crate::formats::waveform::conversion;
use crate::recording::content::Recording;
use crate::recording::details::{Details, Stated};
use crate::time::{Instant, instant};
use crate::{IngestError, IngestSettings, Result, check_size, refuse, refuse_size};

/// Largest header, bytes.
const HEADER_LIMIT: u64 = 128 << 20;

pub const TDM: Reader = Reader { companion, ..Reader::of_one_file("tdm", recognises, conversion::FLAGS, read) };

fn recognises(head: &[u8]) -> bool {
    let head = without_mark(head);
    let is_xml = head.trim_ascii_start().starts_with(b"<");
    is_xml && head.windows(7).any(|window| window == b"usi:tdm")
}

fn companion(main: &str, name: &str) -> bool {
    let is_tdx = name.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("tdx"));
    is_tdx && stem(name).to_lowercase() == stem(main).to_lowercase()
}

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let file = bundle.main.name.as_str();
    let length = bundle.main.bytes.len() as u64;
    check_size(file, length, HEADER_LIMIT, "a TDM header of # MiB", "headers up to # MiB")?;
    let header = parse(&decode(&without_mark(&bundle.main.bytes))).map_err(|found| {
        IngestError::content(
            file,
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
            return refuse_size(file, MANY_SAMPLES.0, MANY_SAMPLES.1);
        }
        waveforms.push(waveform(channel, tdx_name, tdx, header.big_endian));
    }
    let details = details(&header.root);
    conversion::recording(file, waveforms, details, settings, notes)
}

/// The binary file: that of the header's name in any case, else the one that is named like the header.
fn binary<'a>(bundle: &'a Bundle, header: &TdmHeader, notes: &mut Notes) -> Result<(&'a str, &'a [u8])> {
    let wanted = header.url.rsplit(['/', '\\']).next().unwrap_or(&header.url);
    let named = bundle.companions.iter().find(|(name, _)| name.to_lowercase() == wanted.to_lowercase());
    if let Some((name, bytes)) = named {
        return Ok((name, bytes));
    }
    if let Some((name, bytes)) = bundle.companions.iter().next() {
        let (file, stated) = (bundle.main.name.clone(), wanted.to_owned());
        notes.push(OtherFileOfSamples { file, stated, taken: name.clone() });
        return Ok((name, bytes));
    }
    refuse(
        &bundle.main.name,
        format!("a TDM header without its samples: {wanted} is not beside it"),
        format!("the .tdx file of the same name as the .TDM file ({}.tdx)", stem(&bundle.main.name)),
        format!(
            "copy {wanted} into the same folder, with the name of the .TDM file, or export the data as TDMS or CSV"
        ),
    )
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

// The XML of a TDM file: blocks of the binary file, groups, channels, and how they refer to each other.

/// Most elements and texts in a header; a channel takes about a hundred.
const NODE_LIMIT: u32 = 5_000_000;

/// Longest tag, bytes: names of attributes are compared each with each, DIAdem writes three of them.
const LONGEST_TAG: usize = 8 << 10;

/// The numbers of a sequence and what samples are made of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    pub numbers: Numbers,
    pub form: Form,
}

/// Where the numbers of a sequence stand.
#[derive(Debug, Clone, PartialEq)]
pub enum Numbers {
    /// In the binary file.
    Block(Block),
    /// In the header.
    Here(Vec<f64>),
}

/// What samples are made of the numbers of a sequence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// They are the samples.
    Explicit,
    /// `offset + slope·number`.
    RawLinear { offset: f64, slope: f64 },
    /// The numbers are start and step of so many samples.
    ImplicitLinear { count: u64 },
}

/// Where the samples of a sequence lie in the binary file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    /// Offset of the first, bytes.
    pub offset: u64,
    pub length: u64,
    pub kind: Type,
}

#[derive(Debug, Clone)]
pub struct TdmChannel {
    pub group: String,
    pub name: String,
    /// `unit_string`, `description`, and the instance attributes.
    pub attributes: BTreeMap<String, String>,
    /// Its samples, or why they are not to be had.
    pub samples: Result<Sequence, String>,
}

#[derive(Debug, Clone)]
pub struct TdmHeader {
    /// Name of the binary file as the header has it.
    pub url: String,
    /// The binary file has the high byte first.
    pub big_endian: bool,
    /// Name, title and attributes of the file.
    pub root: BTreeMap<String, String>,
    pub channels: Vec<TdmChannel>,
}

/// Bytes of the longest stretch between a `<` and the `>` after it.
fn longest_tag(text: &str) -> Option<usize> {
    text.split('<').skip(1).map(|after| after.find('>').unwrap_or(after.len())).max()
}

type NodeIndex<'a, 'i> = HashMap<&'a str, Node<'a, 'i>>;

/// Reads the header; an error says what was found.
pub fn parse(text: &str) -> Result<TdmHeader, String> {
    if let Some(length) = longest_tag(text).filter(|length| *length > LONGEST_TAG) {
        return Err(format!("a tag of {length} bytes"));
    }
    let options = ParsingOptions { allow_dtd: false, nodes_limit: NODE_LIMIT, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| error.to_string())?;
    let named = |name: &'static str| document.descendants().filter(move |node| node.has_tag_name(name));
    let mut files = named("file");
    let file = files.next().ok_or("no file of samples is named")?;
    if files.next().is_some() {
        return Err("several files of samples are named, one is read".to_owned());
    }
    let url = file.attribute("url").ok_or("the file of samples has no url")?.to_owned();
    let big_endian = match file.attribute("byteOrder") {
        Some("littleEndian") | None => false,
        Some("bigEndian") => true,
        Some(other) => return Err(format!("byte order {other:?}, littleEndian and bigEndian are known")),
    };
    // Later elements do not replace earlier ones of the same id.
    let mut by_id = NodeIndex::new();
    for node in document.descendants() {
        if let Some(id) = node.attribute("id") {
            by_id.entry(id).or_insert(node);
        }
    }
    let root = named("tdm_root").next().map(attributes).unwrap_or_default();
    let mut group_of: HashMap<&str, String> = HashMap::new();
    for group in named("tdm_channelgroup") {
        for id in child_text(group, "channels").map(references).unwrap_or_default() {
            group_of.insert(id, child_text(group, "name").unwrap_or_default().to_owned());
        }
    }
    let channels = named("tdm_channel")
        .map(|channel| {
            let id = channel.attribute("id").unwrap_or_default();
            let group = group_of.get(id).cloned().or_else(|| group_by_reference(channel, &by_id)).unwrap_or_default();
            let name = child_text(channel, "name").unwrap_or_default().to_owned();
            TdmChannel { group, name, attributes: attributes(channel), samples: sequence(channel, &by_id) }
        })
        .collect();
    Ok(TdmHeader { url, big_endian, root, channels })
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn child_text<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    child(node, name)?.text().map(str::trim).filter(|text| !text.is_empty())
}

/// `#xpointer(id("usi1") id("usi2"))`: the ids.
fn references(text: &str) -> Vec<&str> {
    text.split("id(\"").skip(1).filter_map(|part| part.split('"').next()).collect()
}

fn referred<'a, 'i>(node: Node<'a, 'i>, name: &str, by_id: &NodeIndex<'a, 'i>) -> Option<Node<'a, 'i>> {
    by_id.get(references(child_text(node, name)?).first()?).copied()
}

fn group_by_reference(channel: Node, by_id: &NodeIndex) -> Option<String> {
    let id = *references(child_text(channel, "group")?).first()?;
    child_text(*by_id.get(id)?, "name").map(str::to_owned)
}

/// The plain children and the instance attributes, by name.
fn attributes(node: Node) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    for child in node.children().filter(Node::is_element) {
        let name = child.tag_name().name();
        if name != "instance_attributes" {
            if let Some(text) = child.text().map(str::trim).filter(|text| !text.is_empty() && !text.starts_with('#')) {
                all.insert(name.to_owned(), text.to_owned());
            }
            continue;
        }
        for attribute in child.children().filter(Node::is_element) {
            // A text stands one level deeper, in <s>.
            let text = attribute.descendants().filter_map(|part| part.text()).map(str::trim).find(|t| !t.is_empty());
            if let (Some(name), Some(text)) = (attribute.attribute("name"), text) {
                all.insert(name.to_owned(), text.to_owned());
            }
        }
    }
    all
}

/// From a channel by its local column to the sequence of its samples.
fn sequence<'a, 'i>(channel: Node<'a, 'i>, by_id: &NodeIndex<'a, 'i>) -> Result<Sequence, String> {
    let column = referred(channel, "local_columns", by_id).ok_or("no local column belongs to it")?;
    let parameters = numbers_in(child_text(column, "generation_parameters").unwrap_or_default());
    let form = match (child_text(column, "sequence_representation"), parameters.as_slice()) {
        (Some("explicit") | None, _) => Form::Explicit,
        (Some("raw_linear"), [offset, slope]) => Form::RawLinear { offset: *offset, slope: *slope },
        (Some("implicit_linear"), _) => {
            let rows = referred(column, "submatrix", by_id).and_then(|matrix| child_text(matrix, "number_of_rows"));
            let count = rows.and_then(|rows| rows.parse().ok()).ok_or("its number of rows is not stated")?;
            Form::ImplicitLinear { count }
        }
        (Some(other), _) => {
            return Err(format!(
                "its samples are represented as {other}, only explicit, raw_linear with its two parameters and \
                 implicit_linear are read"
            ));
        }
    };
    if matches!(form, Form::ImplicitLinear { .. }) && parameters.len() == 2 {
        return Ok(Sequence { numbers: Numbers::Here(parameters), form });
    }
    let sequence = referred(column, "values", by_id).ok_or("its local column has no values")?;
    let values = child(sequence, "values").ok_or("its sequence has no values")?;
    let numbers = match values.attribute("external") {
        Some(id) => Numbers::Block(block(id, by_id)?),
        None => {
            let texts = values.children().filter(Node::is_element).map(|value| value.text().unwrap_or_default().trim());
            let numbers: Option<Vec<f64>> = texts.map(|text| text.parse().ok()).collect();
            let numbers = numbers.filter(|numbers| !numbers.is_empty());
            Numbers::Here(numbers.ok_or("its samples stand in the header and are no numbers")?)
        }
    };
    Ok(Sequence { numbers, form })
}

/// Numbers with blanks between; none if one is no number.
fn numbers_in(text: &str) -> Vec<f64> {
    text.split_whitespace().map(str::parse).collect::<Result<_, _>>().unwrap_or_default()
}

fn block(id: &str, by_id: &NodeIndex) -> Result<Block, String> {
    let block = by_id.get(id).ok_or_else(|| format!("its block {id} is not listed"))?;
    if !block.has_tag_name("block") {
        return Err(format!("its block is a {}, only plain blocks are read", block.tag_name().name()));
    }
    let number = |name: &str| {
        let text = block.attribute(name).unwrap_or_default();
        text.trim().parse::<u64>().map_err(|_| format!("{name} of its block is {text:?}, no count"))
    };
    let kind = match block.attribute("valueType").unwrap_or_default() {
        "eFloat64Usi" => Type::Double,
        "eFloat32Usi" => Type::Single,
        "eInt8Usi" => Type::Int(1),
        "eInt16Usi" => Type::Int(2),
        "eInt32Usi" => Type::Int(4),
        "eInt64Usi" => Type::Int(8),
        "eUInt8Usi" => Type::Unsigned(1),
        "eUInt16Usi" => Type::Unsigned(2),
        "eUInt32Usi" => Type::Unsigned(4),
        "eUInt64Usi" => Type::Unsigned(8),
        "eTimeUsi" => Type::Time,
        other => return Err(format!("its samples are of type {other}, only real numbers and times are read")),
    };
    Ok(Block { offset: number("byteOffset")?, length: number("length")?, kind })
}

/// Properties that are told as facts, without signs and capitals.
const FACTS: &str = "testid testdate description impactvelocity impactspeed testspeed testmass vehiclemass \
    occupantposition dummytype laboratory author";

/// Title, vehicle and facts by the names of properties, case aside. Speeds and masses in properties carry no unit and
/// are told as facts only.
pub fn details(properties: &BTreeMap<String, String>) -> Details {
    let find = |names: &[&str]| {
        names.iter().find_map(|wanted| {
            properties
                .iter()
                .find(|(name, value)| name.eq_ignore_ascii_case(wanted) && !value.trim().is_empty())
                .map(|(name, value)| Stated { value: value.trim().to_owned(), from: format!("property {name}") })
        })
    };
    let mut facts = Vec::new();
    for (name, value) in properties {
        let squeezed: String = name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).take(40).collect();
        let is_fact = FACTS.split(' ').any(|fact| fact == squeezed);
        if is_fact && !value.trim().is_empty() {
            facts.push(format!("{name}: {}", value.trim()));
        }
    }
    Details {
        title: find(&["title", "Test_Title", "TestTitle"]),
        vehicle: find(&["Vehicle_Name", "VehicleName", "Vehicle"]),
        facts,
        ..Details::default()
    }
}

remarks! {
    /// Remarks of TDM files.
    pub REMARKS;

    /// The header names another file of samples than the one beside it.
    CR059 OtherFileOfSamples { file: String, stated: String, taken: String }
    bears on (About::Record, Weight::Slight)
    decided "The file that the header names is not there; the .tdx file named like the header is taken."
    means "If both were not written together, the channels are of another test."
    remedy "check that both files are of one test, or export the data again as TDMS"
    says format!("{file} names {stated} as its file of samples, {taken} is taken: renamed, perhaps");
}
