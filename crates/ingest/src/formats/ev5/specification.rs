//! The EV5 specification file: its sections, the records of them, and what they say of the test.

use std::collections::BTreeSet;

use crumple_artifact::records::DamageV1;
use crumple_signal::{ANOTHER_VEHICLE, ChannelStatus};

use crate::formats::text::lines::decode;
use crate::recording::details::{Details, Stated};
use crate::{Place, Result, refuse};

/// What is read of an EV5 file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Specification {
    pub test: Test,
    /// One or two.
    pub vehicles: Vec<Vehicle>,
    pub barrier: Option<Barrier>,
    /// All that are listed, in the order of the file.
    pub curves: Vec<Curve>,
    /// Lines of the instrumentation section that cannot be read, with the reason.
    pub unread_lines: Vec<(usize, String)>,
    /// Whether the text ends as it should, with `----- END -----`.
    pub is_complete: bool,
}

/// Whether a line opens a section, and which: `----- TEST -----`, `-----TEST-----`.
fn section(line: &str) -> Option<&str> {
    let line = line.trim();
    (line.starts_with("-----") && line.ends_with("-----"))
        .then(|| line.trim_matches('-').trim())
        .filter(|key| !key.is_empty() && key.len() < 40)
}

/// Whether the text starts like an EV5 file, comments aside.
pub fn recognises(head: &[u8]) -> bool {
    decode(head)
        .trim_start_matches('\u{feff}')
        .lines()
        .map(str::trim)
        .find(|line| !line.is_empty() && !line.starts_with('#'))
        .is_some_and(|line| section(line) == Some("EV5"))
}

/// Reads the text. Tolerant of missing fields, blanks and unknown sections; the sections TEST, VEHICLE and
/// INSTRUMENTATION must be there.
pub fn parse(file: &str, bytes: &[u8]) -> Result<Specification> {
    let text = decode(bytes);
    let mut specification = Specification::default();
    let mut current = "";
    let mut seen = Vec::new();
    let mut numbers = BTreeSet::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line_number = index + 1;
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        if let Some(key) = section(line) {
            current = key;
            seen.push(key);
            if key == "END" {
                specification.is_complete = true;
                break;
            }
            continue;
        }
        let record = Fields(line.split('|').collect());
        match current {
            "TEST" => specification.test = Test::new(&record),
            "VEHICLE" => {
                let next = specification.vehicles.len() as u32 + 1;
                specification.vehicles.push(Vehicle::new(&record, record.parsed(1, "VEHNO").unwrap_or(next)));
            }
            "BARRIER" => specification.barrier = Some(Barrier::new(&record)),
            "INSTRUMENTATION" => match record.parsed(2, "CURNO") {
                None => {
                    let found = record.words(2, "CURNO").unwrap_or_default();
                    let reason = format!("curve number {found:?} is no whole number");
                    specification.unread_lines.push((line_number, reason));
                }
                Some(number) if !numbers.insert(number) => {
                    specification.unread_lines.push((line_number, format!("curve {number} is listed again")));
                }
                Some(number) => {
                    let vehicle = record.parsed(1, "VEHNO").unwrap_or(1);
                    specification.curves.push(Curve::new(&record, vehicle, number));
                }
            },
            _ => {}
        }
    }
    for key in ["TEST", "VEHICLE", "INSTRUMENTATION"] {
        if !seen.contains(&key) {
            let expected = "an EV5 file with the sections TEST, VEHICLE and INSTRUMENTATION";
            let hint = "the file may be cut short: download it again";
            return refuse(file, format!("no section ----- {key} -----"), expected, hint);
        }
    }
    if specification.curves.is_empty() {
        let (line, reason) =
            specification.unread_lines.first().cloned().unwrap_or((0, "the section is empty".to_owned()));
        let place = if line > 0 { Place::line(file, line) } else { Place::file(file) };
        let found = format!("no curve in the section INSTRUMENTATION: {reason}");
        let hint = "the file may be damaged: download it again";
        return refuse(place, found, "a line of 20 fields for each curve, split by |", hint);
    }
    Ok(specification)
}

/// A record of the guide. A field has a position, from 1, and a name: EV5 files go by the one, others by the other.
pub trait Record {
    /// A field that holds something.
    fn words(&self, position: usize, name: &str) -> Option<String>;

    /// A finite number.
    fn number(&self, position: usize, name: &str) -> Option<f64>;

    /// A code, in capitals; empty where there is none.
    fn code(&self, position: usize, name: &str) -> String;

    /// A comment that says something.
    fn comment(&self, position: usize, name: &str) -> Option<String>;

    /// A length, mass or speed: zero means not recorded.
    fn positive(&self, position: usize, name: &str) -> Option<f64> {
        self.number(position, name).filter(|x| *x > 0.0)
    }

    /// A field that is a number of some kind.
    fn parsed<T: std::str::FromStr>(&self, position: usize, name: &str) -> Option<T> {
        self.words(position, name)?.parse().ok()
    }
}

/// The fields of a line, split at `|`.
struct Fields<'a>(Vec<&'a str>);

impl Record for Fields<'_> {
    fn words(&self, position: usize, _: &str) -> Option<String> {
        self.0.get(position - 1).map(|f| f.trim().to_owned()).filter(|f| !f.is_empty())
    }

    fn number(&self, position: usize, name: &str) -> Option<f64> {
        self.parsed(position, name).filter(|x: &f64| x.is_finite())
    }

    fn code(&self, position: usize, name: &str) -> String {
        self.words(position, name).unwrap_or_default().to_ascii_uppercase()
    }

    fn comment(&self, position: usize, name: &str) -> Option<String> {
        self.words(position, name).filter(|c| !says_nothing(c))
    }
}

/// Whether a comment is none: `NO COMMENTS`, `NONE`, `N/A`.
pub fn says_nothing(comment: &str) -> bool {
    let words: String = comment.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_uppercase();
    matches!(
        words.as_str(),
        "" | "NOCOMMENT" | "NOCOMMENTS" | "NONE" | "NA" | "NOTAPPLICABLE" | "UNKNOWN" | "NOREMARKS"
    )
}

/// TEST.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Test {
    pub title: Option<String>,
    /// As written: `03/OCT/2017`.
    pub date: Option<String>,
    pub laboratory: Option<String>,
    pub reference: Option<String>,
    /// VTB vehicle to barrier, VTV vehicle to vehicle, ITV impactor to vehicle.
    pub configuration: Option<String>,
    pub closing_speed_km_per_h: Option<f64>,
    pub impact_angle_deg: Option<f64>,
    pub offset_mm: Option<f64>,
    pub comment: Option<String>,
}

impl Test {
    pub fn new(record: &impl Record) -> Self {
        Self {
            title: record.words(2, "TITLE"),
            date: record.words(4, "TSTDAT"),
            laboratory: record.words(5, "TSTPRF"),
            reference: record.words(7, "TSTREF"),
            configuration: record.words(9, "TSTCFN"),
            closing_speed_km_per_h: record.positive(15, "CLSSPD"),
            impact_angle_deg: record.number(16, "IMPANG"),
            offset_mm: record.number(17, "OFFSET"),
            comment: record.comment(20, "TSTCOM"),
        }
    }
}

/// VEHICLE.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Vehicle {
    pub number: u32,
    pub year: Option<String>,
    pub test_mass_kg: Option<f64>,
    pub width_mm: Option<f64>,
    /// 0 may be a vehicle that stands, or not recorded.
    pub speed_km_per_h: Option<f64>,
    /// Six stations across the front; may be negative.
    pub crush_profile_mm: Vec<f64>,
    pub damage_classification: Option<String>,
    /// Angle of the vehicle's axis to its path.
    pub crab_angle_deg: Option<f64>,
    pub principal_direction_deg: Option<f64>,
    /// Distance of the damage's middle from that of the vehicle.
    pub damage_offset_mm: Option<f64>,
    /// Length of the contact damage.
    pub damage_width_mm: Option<f64>,
    pub static_crush_mm: Option<f64>,
    pub comment: Option<String>,
}

impl Vehicle {
    pub fn new(record: &impl Record, number: u32) -> Self {
        let not_zero = |position, name| record.number(position, name).filter(|x| *x != 0.0);
        Self {
            number,
            year: record.words(4, "YEAR"),
            test_mass_kg: record.positive(11, "VEHTWT"),
            width_mm: record.positive(15, "VEHWID"),
            speed_km_per_h: record.number(42, "VEHSPD").filter(|v| *v >= 0.0),
            crush_profile_mm: (1..=6).filter_map(|k| record.number(47 + k, &format!("DPD{k}"))).collect(),
            damage_classification: record.words(54, "VDI"),
            crab_angle_deg: not_zero(43, "CRBANG"),
            principal_direction_deg: not_zero(44, "PDOF"),
            damage_offset_mm: not_zero(56, "DAMDST"),
            damage_width_mm: record.positive(55, "LENCNT"),
            static_crush_mm: record.positive(57, "CRHDST"),
            // A lone 0 is "nothing recorded" here, too.
            comment: record.words(81, "VEHCOM").filter(|c| c != "0" && !says_nothing(c)),
        }
    }
}

/// BARRIER.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Barrier {
    /// R rigid, D deformable.
    rigidity: Option<String>,
    /// LCB load-cell barrier, FLB flat, POL pole.
    shape: Option<String>,
    angle_deg: Option<f64>,
    diameter_mm: Option<f64>,
    comment: Option<String>,
}

impl Barrier {
    pub fn new(record: &impl Record) -> Self {
        Self {
            rigidity: record.words(1, "BARRIG"),
            shape: record.words(2, "BARSHP"),
            angle_deg: record.positive(3, "BARANG"),
            diameter_mm: record.positive(4, "BARDIA"),
            comment: record.comment(5, "BARCOM"),
        }
    }

    /// In words: `rigid load cell barrier (advanced research load cell barrier)`.
    pub fn words(&self) -> Option<String> {
        let rigidity = match self.rigidity.as_deref() {
            Some("R") => "rigid ",
            Some("D") => "deformable ",
            _ => "",
        };
        let shape = match self.shape.as_deref() {
            Some("LCB") => "load cell barrier".to_owned(),
            Some("FLB") => "flat barrier".to_owned(),
            Some("POL") => "pole".to_owned(),
            Some("ANG") => "angled barrier".to_owned(),
            Some(code) if !matches!(code, "OTH" | "UNK" | "NA") => format!("barrier {code}"),
            _ => "barrier".to_owned(),
        };
        let mut words = format!("{rigidity}{shape}");
        words.extend(self.angle_deg.map(|angle| format!(", {angle} deg")));
        words.extend(self.diameter_mm.map(|diameter| format!(", diameter {diameter} mm")));
        words.extend(self.comment.as_ref().map(|comment| format!(" ({})", comment.to_lowercase())));
        (words != "barrier").then_some(words)
    }
}

/// INSTRUMENTATION: one curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// 0: on the barrier.
    pub vehicle: u32,
    /// The extension of the signal file.
    pub number: u32,
    /// AC, LC, DS, AV...
    pub sensor: String,
    /// 01 driver..., NA structure.
    pub location: String,
    /// FLLR, ENGN, LC0116...
    pub attachment: String,
    /// XG, XL...
    pub axis: String,
    pub x_unit: String,
    pub y_unit: String,
    /// -3 dB frequency of the recorder's filter.
    pub prefilter_hz: Option<f64>,
    pub manufacturer: Option<String>,
    /// Of the sensor, in the unit of the curve.
    pub range: Option<f64>,
    /// Along the sensor axis at time zero.
    pub initial_velocity_km_per_h: Option<f64>,
    /// Index of the first sample, 0 being time zero.
    pub first: Option<i64>,
    pub last: Option<i64>,
    /// Whole microseconds by the guide.
    pub interval_us: Option<f64>,
    pub status: String,
    /// P primary, R redundant.
    pub channel_status: String,
    pub comment: Option<String>,
}

impl Curve {
    pub fn new(record: &impl Record, vehicle: u32, number: u32) -> Self {
        Self {
            vehicle,
            number,
            sensor: record.code(3, "SENTYP"),
            location: record.code(4, "SENLOC"),
            attachment: record.code(5, "SENATT"),
            axis: record.code(6, "AXIS"),
            x_unit: record.code(7, "XUNITS"),
            y_unit: record.words(8, "YUNITS").unwrap_or_default(),
            prefilter_hz: record.positive(9, "PREFIL"),
            manufacturer: record.words(10, "INSMAN"),
            range: record.positive(12, "INSRAT"),
            initial_velocity_km_per_h: record.number(14, "INIVEL"),
            first: record.parsed(15, "NFP"),
            last: record.parsed(16, "NLP"),
            interval_us: record.positive(17, "DELT"),
            status: record.code(18, "DASTAT"),
            channel_status: record.code(19, "CHSTAT"),
            comment: record.comment(20, "INSCOM"),
        }
    }

    /// DASTAT in the vocabulary of channels.
    pub fn channel_status(&self) -> ChannelStatus {
        match self.status.as_str() {
            "CM" => ChannelStatus::Computed,
            "CF" | "CQ" | "QD" => ChannelStatus::Questionable,
            "MN" => ChannelStatus::Failed,
            "NO" => ChannelStatus::NotInstalled,
            _ => ChannelStatus::Valid,
        }
    }
}

const STATIONS: usize = 6;

/// Facts of the test from its records.
pub fn details(test: &Test, barrier: Option<&Barrier>, vehicle: &Vehicle, vehicles: &[Vehicle]) -> Details {
    let stated = |value: String, from: &str| Stated { value, from: from.to_owned() };
    let speed = speed_km_per_h(test, vehicle, vehicles);
    Details {
        title: test.title.clone().map(|t| stated(t, "TITLE")),
        vehicle: vehicle_words(test, vehicle).map(|v| stated(v, "TITLE")),
        barrier: match test.configuration.as_deref() {
            Some("VTV") => Some(stated(ANOTHER_VEHICLE.to_owned(), "TSTCFN")),
            _ => barrier.and_then(Barrier::words).map(|b| stated(b, "BARRIER")),
        },
        mass_kg: vehicle.test_mass_kg.map(|value| Stated { value, from: "VEHTWT".to_owned() }),
        impact_speed_m_per_s: speed.map(|(v, from)| Stated { value: v / 3.6, from: from.to_owned() }),
        damage: damage(vehicle),
        closing_speed_m_per_s: test.closing_speed_km_per_h.map(|v| v / 3.6),
        facts: facts(test, vehicle),
        ..Details::default()
    }
}

/// The speed of a vehicle, km/h, and the field that states it. 0 is a speed where another vehicle moves, or where the
/// closing speed is that of something that hits this one; else it means not recorded.
pub fn speed_km_per_h(test: &Test, vehicle: &Vehicle, vehicles: &[Vehicle]) -> Option<(f64, &'static str)> {
    let is_barrier = test.configuration.as_deref() == Some("VTB");
    let another_moves = vehicles.iter().any(|other| other.number != vehicle.number && other.speed_km_per_h > Some(0.0));
    let may_stand = another_moves || (test.closing_speed_km_per_h.is_some() && !is_barrier);
    let own = vehicle.speed_km_per_h.filter(|v| *v > 0.0 || may_stand).map(|v| (v, "VEHSPD"));
    // The closing speed is the vehicle's own only if the other object stands still.
    own.or_else(|| test.closing_speed_km_per_h.filter(|_| is_barrier).map(|v| (v, "CLSSPD")))
}

/// `2018 TOYOTA CAMRY LE 4-DOOR SEDAN`: the title from the model year on, its part after `INTO` for the second vehicle.
/// Make and model are codes whose tables are not public: they stay out.
pub fn vehicle_words(test: &Test, vehicle: &Vehicle) -> Option<String> {
    let year = vehicle.year.as_deref()?;
    let from_title = test.title.as_deref().and_then(|title| {
        let part = title.split(" INTO ").nth(usize::try_from(vehicle.number).ok()?.checked_sub(1)?)?;
        let words = part[part.find(year)?..].trim();
        (words.len() > year.len()).then(|| words.to_owned())
    });
    from_title.or_else(|| Some(format!("of model year {year}")))
}

/// The crush profile DPD1 to DPD6; all zero is nothing recorded.
fn damage(vehicle: &Vehicle) -> Option<DamageV1> {
    let stations = &vehicle.crush_profile_mm;
    let is_recorded = stations.len() == STATIONS && stations.iter().any(|crush| *crush != 0.0);
    is_recorded.then(|| DamageV1 {
        residual_crush_m: stations.iter().map(|mm| mm / 1e3).collect(),
        damage_width_m: vehicle.damage_width_mm.map(|mm| mm / 1e3),
        vehicle_width_m: vehicle.width_mm.map(|mm| mm / 1e3),
        classification: vehicle.damage_classification.clone(),
        from: "DPD1-DPD6, LENCNT, VEHWID, VDI".to_owned(),
    })
}

fn facts(test: &Test, vehicle: &Vehicle) -> Vec<String> {
    let mut facts = Vec::new();
    if let Some(crush) = vehicle.static_crush_mm {
        let profile: Vec<String> = vehicle.crush_profile_mm.iter().map(f64::to_string).collect();
        let profile = if vehicle.crush_profile_mm.iter().any(|x| *x != 0.0) {
            format!("; profile across the front {} mm", profile.join(", "))
        } else {
            String::new()
        };
        facts.push(format!("largest static crush {crush} mm (measured after the test){profile}"));
    }
    if let Some(laboratory) = &test.laboratory {
        let date = test.date.as_deref().map_or_else(String::new, |d| format!(", {d}"));
        let reference = test.reference.as_deref().map_or_else(String::new, |r| format!(", reference {r}"));
        facts.push(format!("tested by {laboratory}{date}{reference}"));
    }
    if let Some(configuration) = &test.configuration {
        let words = match configuration.as_str() {
            "VTB" => "vehicle to barrier",
            "VTV" => "vehicle to vehicle",
            "ITV" => "impactor to vehicle",
            other => other,
        };
        let angle = test.impact_angle_deg.map_or_else(String::new, |a| format!(", impact angle {a} deg"));
        let offset = test.offset_mm.filter(|o| *o != 0.0).map_or_else(String::new, |o| format!(", offset {o} mm"));
        facts.push(format!("configuration: {words}{angle}{offset}"));
    }
    let angles =
        [("crab angle", vehicle.crab_angle_deg), ("principal direction of force", vehicle.principal_direction_deg)];
    for (what, angle) in angles.into_iter().filter_map(|(what, angle)| Some((what, angle?))) {
        facts.push(format!("{what} {angle} deg"));
    }
    if let Some(offset) = vehicle.damage_offset_mm {
        facts.push(format!("middle of the damage {offset} mm from that of the vehicle"));
    }
    facts.extend(vehicle.comment.iter().chain(&test.comment).cloned());
    facts
}
