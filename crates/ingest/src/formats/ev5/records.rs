//! Records of an EV5 file with the fields that are used; positions as in the guide, from 1.

use crate::formats::ev5::fields::Fields;
use crumple_signal::ChannelStatus;

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
