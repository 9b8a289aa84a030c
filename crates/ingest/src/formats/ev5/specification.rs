//! The EV5 specification file: its sections, the records of them, and what they say of the test.

use std::collections::BTreeSet;

use crumple_artifact::records::DamageV1;
use crumple_signal::{ANOTHER_VEHICLE, ChannelStatus};

use crate::formats::text::lines::decode;
use crate::recording::details::{Details, Stated};
use crate::{IngestError, Place};

/// What is read of an EV5 file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Specification {
    /// The test.
    pub test: Test,
    /// Its vehicles, one or two.
    pub vehicles: Vec<Vehicle>,
    /// The barrier, if there is one.
    pub barrier: Option<Barrier>,
    /// All listed curves, in the order of the file.
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
pub fn parse(file: &str, bytes: &[u8]) -> Result<Specification, IngestError> {
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
        let fields = Fields::split(line);
        match current {
            "TEST" => specification.test = Test::new(&fields),
            "VEHICLE" => {
                let next = specification.vehicles.len() + 1;
                specification.vehicles.push(Vehicle::new(&fields, next));
            }
            "BARRIER" => specification.barrier = Some(Barrier::new(&fields)),
            "INSTRUMENTATION" => match Curve::new(&fields) {
                Ok(curve) if !numbers.insert(curve.number) => {
                    specification.unread_lines.push((line_number, format!("curve {} is listed again", curve.number)));
                }
                Ok(curve) => specification.curves.push(curve),
                Err(reason) => specification.unread_lines.push((line_number, reason)),
            },
            _ => {}
        }
    }
    for key in ["TEST", "VEHICLE", "INSTRUMENTATION"] {
        if !seen.contains(&key) {
            return Err(IngestError::content(
                Place::file(file),
                format!("no section ----- {key} -----"),
                "an EV5 file with the sections TEST, VEHICLE and INSTRUMENTATION",
                "the file may be cut short: download it again",
            ));
        }
    }
    if specification.curves.is_empty() {
        let (line, reason) =
            specification.unread_lines.first().cloned().unwrap_or((0, "the section is empty".to_owned()));
        let place = if line > 0 { Place::line(file, line) } else { Place::file(file) };
        return Err(IngestError::content(
            place,
            format!("no curve in the section INSTRUMENTATION: {reason}"),
            "a line of 20 fields for each curve, split by |",
            "the file may be damaged: download it again",
        ));
    }
    Ok(specification)
}

/// Fields of one record, counted from 1 as in the guide; blanks and missing fields are `None`.
pub struct Fields<'a>(Vec<&'a str>);

impl<'a> Fields<'a> {
    /// The fields of a line, split at `|`.
    pub fn split(line: &'a str) -> Self {
        Self(line.split('|').collect())
    }

    /// Field `position`, from 1, if it holds something.
    pub fn text(&self, position: usize) -> Option<&'a str> {
        self.0.get(position.checked_sub(1)?).map(|f| f.trim()).filter(|f| !f.is_empty())
    }

    /// The same as owned words.
    pub fn words(&self, position: usize) -> Option<String> {
        self.text(position).map(str::to_owned)
    }

    /// A finite number.
    pub fn number(&self, position: usize) -> Option<f64> {
        self.text(position)?.parse().ok().filter(|x: &f64| x.is_finite())
    }

    /// A length, mass or speed: zero means not recorded.
    pub fn positive(&self, position: usize) -> Option<f64> {
        self.number(position).filter(|x| *x > 0.0)
    }

    /// A whole number.
    pub fn integer(&self, position: usize) -> Option<i64> {
        self.text(position)?.parse().ok()
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
    /// 2 TITLE.
    pub title: Option<String>,
    /// 4 TSTDAT, as written: `03/OCT/2017`.
    pub date: Option<String>,
    /// 5 TSTPRF.
    pub laboratory: Option<String>,
    /// 7 TSTREF.
    pub reference: Option<String>,
    /// 9 TSTCFN: VTB vehicle to barrier, VTV vehicle to vehicle, ITV impactor to vehicle.
    pub configuration: Option<String>,
    /// 15 CLSSPD, km/h.
    pub closing_speed_km_per_h: Option<f64>,
    /// 16 IMPANG, degrees.
    pub impact_angle_deg: Option<f64>,
    /// 17 OFFSET, mm.
    pub offset_mm: Option<f64>,
    /// 20 TSTCOM.
    pub comment: Option<String>,
}

impl Test {
    pub fn new(fields: &Fields) -> Self {
        Self {
            title: fields.words(2),
            date: fields.words(4),
            laboratory: fields.words(5),
            reference: fields.words(7),
            configuration: fields.words(9),
            closing_speed_km_per_h: fields.positive(15),
            impact_angle_deg: fields.number(16),
            offset_mm: fields.number(17),
            comment: fields.words(20).filter(|c| !says_nothing(c)),
        }
    }
}

/// VEHICLE.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Vehicle {
    /// 1 VEHNO.
    pub number: u32,
    /// 2 MAKE and 3 MODEL, codes.
    pub make_and_model: [Option<String>; 2],
    /// 4 YEAR.
    pub year: Option<String>,
    /// 11 VEHTWT, kg.
    pub test_mass_kg: Option<f64>,
    /// 15 VEHWID, mm.
    pub width_mm: Option<f64>,
    /// 42 VEHSPD, km/h; 0 may be a vehicle that stands, or not recorded.
    pub speed_km_per_h: Option<f64>,
    /// 48-53 DPD1-DPD6, crush profile, mm; may be negative.
    pub crush_profile_mm: Vec<f64>,
    /// 54 VDI, collision deformation classification.
    pub damage_classification: Option<String>,
    /// 43 CRBANG, angle of the vehicle's axis to its path, degrees.
    pub crab_angle_deg: Option<f64>,
    /// 44 PDOF, principal direction of force, degrees.
    pub principal_direction_deg: Option<f64>,
    /// 56 DAMDST, distance of the damage's middle from that of the vehicle, mm.
    pub damage_offset_mm: Option<f64>,
    /// 55 LENCNT, length of the contact damage, mm.
    pub damage_width_mm: Option<f64>,
    /// 57 CRHDST, largest static crush, mm.
    pub static_crush_mm: Option<f64>,
    /// 81 VEHCOM.
    pub comment: Option<String>,
}

impl Vehicle {
    pub fn new(fields: &Fields, next: usize) -> Self {
        Self {
            number: fields.integer(1).and_then(|n| u32::try_from(n).ok()).unwrap_or(next as u32),
            make_and_model: [fields.words(2), fields.words(3)],
            year: fields.words(4),
            test_mass_kg: fields.positive(11),
            width_mm: fields.positive(15),
            speed_km_per_h: fields.number(42).filter(|v| *v >= 0.0),
            crush_profile_mm: (48..=53).filter_map(|k| fields.number(k)).collect(),
            damage_classification: fields.words(54),
            crab_angle_deg: fields.number(43).filter(|a| *a != 0.0),
            principal_direction_deg: fields.number(44).filter(|a| *a != 0.0),
            damage_offset_mm: fields.number(56).filter(|x| *x != 0.0),
            damage_width_mm: fields.positive(55),
            static_crush_mm: fields.positive(57),
            // A lone 0 is "nothing recorded" here, too.
            comment: fields.words(81).filter(|c| c != "0" && !says_nothing(c)),
        }
    }
}

/// BARRIER.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Barrier {
    /// 1 BARRIG: R rigid, D deformable.
    pub rigidity: Option<String>,
    /// 2 BARSHP: LCB load-cell barrier, FLB flat, POL pole.
    pub shape: Option<String>,
    /// 3 BARANG, degrees.
    pub angle_deg: Option<f64>,
    /// 4 BARDIA, mm.
    pub diameter_mm: Option<f64>,
    /// 5 BARCOM.
    pub comment: Option<String>,
}

impl Barrier {
    pub fn new(fields: &Fields) -> Self {
        Self {
            rigidity: fields.words(1),
            shape: fields.words(2),
            angle_deg: fields.positive(3),
            diameter_mm: fields.positive(4),
            comment: fields.words(5).filter(|c| !says_nothing(c)),
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
        if let Some(angle) = self.angle_deg {
            words.push_str(&format!(", {angle} deg"));
        }
        if let Some(diameter) = self.diameter_mm {
            words.push_str(&format!(", diameter {diameter} mm"));
        }
        if let Some(comment) = &self.comment {
            words.push_str(&format!(" ({})", comment.to_lowercase()));
        }
        (words != "barrier").then_some(words)
    }
}

/// INSTRUMENTATION: one curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// 1 VEHNO; 0: on the barrier.
    pub vehicle: u32,
    /// 2 CURNO, the extension of the signal file.
    pub number: u32,
    /// 3 SENTYP: AC, LC, DS, AV...
    pub sensor: String,
    /// 4 SENLOC: 01 driver..., NA structure.
    pub location: String,
    /// 5 SENATT: FLLR, ENGN, LC0116...
    pub attachment: String,
    /// 6 AXIS: XG, XL...
    pub axis: String,
    /// 7 XUNITS.
    pub x_unit: String,
    /// 8 YUNITS.
    pub y_unit: String,
    /// 9 PREFIL, -3 dB frequency of the recorder's filter, Hz.
    pub prefilter_hz: Option<f64>,
    /// 10 INSMAN, manufacturer of the sensor.
    pub manufacturer: Option<String>,
    /// 12 INSRAT, range of the sensor in the unit of the curve.
    pub range: Option<f64>,
    /// 14 INIVEL, km/h along the sensor axis at time zero.
    pub initial_velocity_km_per_h: Option<f64>,
    /// 15 NFP, index of the first sample, 0 being time zero.
    pub first: Option<i64>,
    /// 16 NLP, index of the last sample.
    pub last: Option<i64>,
    /// 17 DELT, whole microseconds by the guide.
    pub interval_us: Option<f64>,
    /// 18 DASTAT.
    pub status: String,
    /// 19 CHSTAT: P primary, R redundant.
    pub channel_status: String,
    /// 20 INSCOM.
    pub comment: Option<String>,
}

impl Curve {
    pub fn new(fields: &Fields) -> Result<Self, String> {
        let text = |k| fields.text(k).unwrap_or_default().to_ascii_uppercase();
        let number = fields
            .integer(2)
            .and_then(|n| u32::try_from(n).ok())
            .ok_or_else(|| format!("curve number {:?} is no whole number", fields.text(2).unwrap_or_default()))?;
        Ok(Self {
            vehicle: fields.integer(1).and_then(|n| u32::try_from(n).ok()).unwrap_or(1),
            number,
            sensor: text(3),
            location: text(4),
            attachment: text(5),
            axis: text(6),
            x_unit: text(7),
            y_unit: fields.text(8).unwrap_or_default().to_owned(),
            prefilter_hz: fields.positive(9),
            manufacturer: fields.words(10),
            range: fields.positive(12),
            initial_velocity_km_per_h: fields.number(14),
            first: fields.integer(15),
            last: fields.integer(16),
            interval_us: fields.positive(17),
            status: text(18),
            channel_status: text(19),
            comment: fields.words(20).filter(|c| !says_nothing(c)),
        })
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

/// Stations of a crush profile.
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
        time_zero_s: None,
        damage: damage(vehicle),
        vehicles: Vec::new(),
        closing_speed_m_per_s: test.closing_speed_km_per_h.map(|v| v / 3.6),
        speed_not_taken: None,
        no_pulse: false,
        facts: facts(test, vehicle),
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
