//! The channel frequency classes of SAE J211-1 and ISO 6487: which there are, the difference equation of each after
//! either standard, and its response against the limits (figure 1 of both).

use std::f64::consts::{PI, SQRT_2};
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// A channel frequency class of SAE J211-1 and ISO 6487. The number is F_H in Hz: flat up to there.
///
/// Both passes of the class filter have -3 dB at F_H/0.6 and fall by 24 dB an octave beyond. The class depends on the
/// use of a channel (SAE J211-1 Table 1): structure for plots, barrier and belt forces CFC 60; structure to be
/// integrated and the chest CFC 180; components CFC 600; the head CFC 1000. A lower class cannot be undone.
///
/// Classes are ordered by frequency, so `a <= b` says that a channel of class `a` needs no filter to be of class `b`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Cfc {
    /// Vehicle structure, for plots and comparison; -3 dB at 100 Hz.
    Cfc60,
    /// Vehicle structure for integration, chest; -3 dB at 300 Hz.
    Cfc180,
    /// Components; -3 dB at 1000 Hz.
    Cfc600,
    /// Head; -3 dB at 1667 Hz.
    Cfc1000,
}

impl Cfc {
    /// All classes, lowest first.
    pub const ALL: [Self; 4] = [Self::Cfc60, Self::Cfc180, Self::Cfc600, Self::Cfc1000];

    /// 60, 180, 600 or 1000.
    pub const fn number(self) -> u16 {
        match self {
            Self::Cfc60 => 60,
            Self::Cfc180 => 180,
            Self::Cfc600 => 600,
            Self::Cfc1000 => 1000,
        }
    }

    /// F_H, Hz: the class as a frequency.
    pub fn frequency_hz(self) -> f64 {
        f64::from(self.number())
    }

    /// The lowest sampling rate for which the filter is meant, Hz: ten times the class (SAE J211-1), which is six times
    /// the -3 dB frequency. CFC 60 needs 600 Hz, CFC 1000 needs 10 kHz.
    pub fn lowest_rate_hz(self) -> f64 {
        10.0 * self.frequency_hz()
    }
}

impl fmt::Display for Cfc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.number().fmt(f)
    }
}

/// The class a channel is brought to, or `none`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Class {
    /// Filter to this class.
    Cfc(Cfc),
    /// Do not filter.
    None,
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cfc(cfc) => cfc.fmt(f),
            Self::None => f.write_str("none"),
        }
    }
}

impl FromStr for Class {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        Cfc::ALL
            .into_iter()
            .map(Self::Cfc)
            .chain([Self::None])
            .find(|class| class.to_string() == text)
            .ok_or_else(|| format!("unknown channel frequency class {text:?}, expected 60, 180, 600, 1000 or none"))
    }
}

/// A number for a class, the text `none` otherwise: as a pipeline table says it.
impl Serialize for Class {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Cfc(cfc) => serializer.serialize_u16(cfc.number()),
            Self::None => serializer.serialize_str("none"),
        }
    }
}

impl<'de> Deserialize<'de> for Class {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ClassVisitor;

        impl de::Visitor<'_> for ClassVisitor {
            type Value = Class;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("60, 180, 600, 1000 or \"none\"")
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<Class, E> {
                text.parse().map_err(E::custom)
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<Class, E> {
                self.visit_str(&number.to_string())
            }

            fn visit_u64<E: de::Error>(self, number: u64) -> Result<Class, E> {
                self.visit_str(&number.to_string())
            }
        }

        deserializer.deserialize_any(ClassVisitor)
    }
}

/// Which standard's filter: the frequency factor and what happens at the ends. Part of the result, so it is always
/// printed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum CfcMode {
    /// ISO 6487 Annex A: factor 1.25/0.6, both ends extended by point reflection over at least 10 ms.
    #[default]
    Iso6487,
    /// SAE J211-1 Appendix C: factor 2.0775, the same extension.
    SaeReflect,
    /// SAE J211-1 without any extension, from rest: for comparison with old results on records that start and end at
    /// zero.
    SaeZeroState,
}

impl CfcMode {
    /// The name used in artifacts and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Iso6487 => "iso6487",
            Self::SaeReflect => "sae_reflect",
            Self::SaeZeroState => "sae_zero_state",
        }
    }

    /// Design frequency over class, κ.
    ///
    /// SAE J211-1: 2.0775, which puts -3.01 dB of both passes at CFC/0.6. ISO 6487: 1.25/0.6, -2.98 dB there.
    /// The difference changes the peak of a crash pulse by less than 0.04 %.
    pub const fn frequency_factor(self) -> f64 {
        match self {
            Self::Iso6487 => 1.25 / 0.6,
            Self::SaeReflect | Self::SaeZeroState => 2.0775,
        }
    }

    /// Whether the ends are extended.
    pub const fn extends(self) -> bool {
        !matches!(self, Self::SaeZeroState)
    }
}

/// One pass of a two-pole Butterworth low-pass:
/// `y[i] = a0·x[i] + a1·x[i-1] + a2·x[i-2] + b1·y[i-1] + b2·y[i-2]` (mind the plus signs of b1 and b2).
///
/// SAE J211-1 Appendix C, ISO 6487 Annex A. Run forward and backward it has four poles and no phase.
///
/// The five numbers sum to 1 (gain 1 at 0 Hz, so the area of a pulse and its change of velocity stay). CFC 60 at 10 kHz
/// after ISO 6487: a0 = 0.00146032, b1 = 1.889033, b2 = -0.894874.
///
/// A mistake often made is to design one pass with its -3 dB point at CFC/0.6: both passes then have -6 dB there. The
/// factor κ in the design frequency is what corrects for the second pass, `κ = (√2 - 1)^(-1/4)/0.6` ≈ 2.0775.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// Factor of `x[i]`.
    pub a0: f64,
    /// Factor of `x[i-1]`.
    pub a1: f64,
    /// Factor of `x[i-2]`.
    pub a2: f64,
    /// Factor of `y[i-1]`.
    pub b1: f64,
    /// Factor of `y[i-2]`.
    pub b2: f64,
    /// Prewarped design frequency wa = tan(π·CFC·κ·T).
    warped: f64,
    mode: CfcMode,
    dt_s: f64,
}

impl Coefficients {
    /// The filter of a class for one sampling interval, by the bilinear transform: `wd = 2π·CFC·κ`, `wa =
    /// tan(wd·T/2)`, `D = 1 + √2·wa + wa²`, `a0 = wa²/D`, `b1 = -2(wa² - 1)/D`, `b2 = (-1 + √2·wa - wa²)/D`.
    ///
    /// The warp of the bilinear transform is exact at -6 dB (CFC·κ); at ten samples per CFC period the -3 dB point has
    /// moved from 1.667·CFC to 1.751·CFC. Below a rate of 4.2 CFC there is no such filter; see
    /// [`Cfc::lowest_rate_hz`] for the limit that the standards set.
    pub fn new(cfc: Cfc, mode: CfcMode, dt_s: f64) -> Self {
        Self::of_rad_per_s(2.0 * PI * cfc.frequency_hz() * mode.frequency_factor(), mode, dt_s)
    }

    /// The same with a design frequency that is of no class: each pass leaves 1/√2 there.
    pub fn designed(design_hz: f64, mode: CfcMode, dt_s: f64) -> Self {
        Self::of_rad_per_s(2.0 * PI * design_hz, mode, dt_s)
    }

    fn of_rad_per_s(design_rad_per_s: f64, mode: CfcMode, dt_s: f64) -> Self {
        let wa = (design_rad_per_s * dt_s / 2.0).tan();
        let d = 1.0 + SQRT_2 * wa + wa * wa;
        let a0 = wa * wa / d;
        Self {
            a0,
            a1: 2.0 * a0,
            a2: a0,
            b1: -2.0 * (wa * wa - 1.0) / d,
            b2: (-1.0 + SQRT_2 * wa - wa * wa) / d,
            warped: wa,
            mode,
            dt_s,
        }
    }

    /// The standard they were made after.
    pub fn mode(&self) -> CfcMode {
        self.mode
    }

    /// The sampling interval they were made for, s.
    pub fn dt_s(&self) -> f64 {
        self.dt_s
    }

    /// a0, a1, a2, b1, b2, the order in which artifacts and the recursion hold them.
    pub fn to_array(self) -> [f64; 5] {
        [self.a0, self.a1, self.a2, self.b1, self.b2]
    }

    /// Amplitude gain of both passes at a frequency up to half the sampling rate: `1/(1 + (tan(π·f·T)/wa)⁴)`.
    ///
    /// It is the square of the gain of one pass, 1 at 0 Hz, 1/2 at the design frequency CFC·κ and 0 at half the
    /// sampling rate. It holds inside a record; the first and last milliseconds depend on the ends.
    pub fn two_pass_gain(&self, frequency_hz: f64) -> f64 {
        let ratio = (PI * frequency_hz * self.dt_s).tan() / self.warped;
        1.0 / (1.0 + ratio.powi(4))
    }

    /// [`two_pass_gain`](Self::two_pass_gain) in dB, `20·log10(gain)`: -0.45 dB at CFC and -3.01 dB at CFC/0.6 (SAE,
    /// fast sampling).
    pub fn two_pass_gain_db(&self, frequency_hz: f64) -> f64 {
        20.0 * self.two_pass_gain(frequency_hz).log10()
    }

    /// Frequency at which both passes together leave 1/√2 of the amplitude (-3.01 dB), Hz:
    /// `atan(wa·(√2 - 1)^(1/4))/(π·T)`, the inverse of the closed form of the gain.
    pub fn half_power_frequency_hz(&self) -> f64 {
        (self.warped * (SQRT_2 - 1.0).powf(0.25)).atan() / (PI * self.dt_s)
    }
}

/// F_L, Hz: from here on the response is looked at.
const F_L_HZ: f64 = 0.1;
/// Frequencies looked at, in units of F_N; those below half the sampling rate.
const OF_F_N: [f64; 13] = [0.075, 0.15, 0.3, 0.45, 0.6, 0.75, 1.0, 1.25, 1.5, 2.0, 3.0, 5.0, 10.0];

/// The gain of a filter at one frequency, and the limits of its class there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorridorPoint {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Gain of both passes at the sampling rate of the record, dB.
    pub gain_db: f64,
    /// Upper limit, dB.
    pub upper_db: f64,
    /// Lower limit, dB; `None` above F_N.
    pub lower_db: Option<f64>,
}

impl CorridorPoint {
    /// Whether the gain lies between the limits.
    pub fn is_inside(&self) -> bool {
        self.gain_db <= self.upper_db && self.lower_db.is_none_or(|lower| self.gain_db >= lower)
    }
}

/// Upper and lower limit of the response of a class at a frequency, dB (SAE J211-1 Figure 1, ISO 6487 Figure 1).
///
/// With F_H the class and F_N = F_H/0.6 (1650 Hz at CFC 1000): +0.5 dB up to F_N; -0.5 dB up to F_H/2, -1 dB at F_H,
/// -4 dB at F_N, straight lines over the logarithm of frequency between them. Above F_N the upper limit falls by 9 dB
/// an octave to a floor of -30 dB (CFC 60, 180) or -40 dB (CFC 600, 1000), and there is no lower limit. Where the
/// sloping line begins is not confirmed; a slope of 24 dB an octave from F_N, as other descriptions have it, is
/// passed by no filter of four poles, the one of the standards included.
pub fn limits_db(cfc: Cfc, frequency_hz: f64) -> (f64, Option<f64>) {
    let (f_h, f_n) = (cfc.frequency_hz(), corner_hz(cfc));
    if frequency_hz > f_n * (1.0 + 1e-12) {
        let floor_db = if cfc <= Cfc::Cfc180 { -30.0 } else { -40.0 };
        return ((0.5 - 9.0 * (frequency_hz / f_n).log2()).max(floor_db), None);
    }
    let between = |(f0, db0): (f64, f64), (f1, db1): (f64, f64)| {
        db0 + (db1 - db0) * (frequency_hz / f0).log2() / (f1 / f0).log2()
    };
    let lower = if frequency_hz <= f_h / 2.0 {
        -0.5
    } else if frequency_hz <= f_h {
        between((f_h / 2.0, -0.5), (f_h, -1.0))
    } else {
        between((f_h, -1.0), (f_n, -4.0))
    };
    (0.5, Some(lower))
}

/// F_N, Hz: CFC/0.6 (100, 300, 1000 Hz), and 1650 Hz at CFC 1000.
fn corner_hz(cfc: Cfc) -> f64 {
    if cfc == Cfc::Cfc1000 { 1650.0 } else { cfc.frequency_hz() / 0.6 }
}

/// Compares the filter that is used, at the sampling rate it is used at, with the limits of a class.
///
/// Points in ascending frequency: 0.1 Hz (F_L), then 0.075 to 10 times F_N, as far as they lie below half the sampling
/// rate; up to 14 of them. Gains are the closed form, not measured on a signal. The filters of both standards are
/// inside from 10 samples per period of the class on; a filter designed for one pass, or of another class, is not.
pub fn corridor(cfc: Cfc, coefficients: &Coefficients) -> Vec<CorridorPoint> {
    let highest_hz = 0.5 / coefficients.dt_s();
    std::iter::once(F_L_HZ)
        .chain(OF_F_N.map(|ratio| ratio * corner_hz(cfc)))
        .filter(|f| *f < highest_hz)
        .map(|frequency_hz| {
            let (upper_db, lower_db) = limits_db(cfc, frequency_hz);
            CorridorPoint { frequency_hz, gain_db: coefficients.two_pass_gain_db(frequency_hz), upper_db, lower_db }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_is_read_back_from_text_and_from_a_table() {
        for class in Cfc::ALL.map(Class::Cfc).into_iter().chain([Class::None]) {
            assert_eq!(class.to_string().parse(), Ok(class));
            assert_eq!(serde_json::from_str::<Class>(&serde_json::to_string(&class).unwrap()).unwrap(), class);
        }
    }

    #[test]
    fn a_class_that_does_not_exist_is_answered_with_those_that_do() {
        let error = serde_json::from_str::<Class>("61").unwrap_err().to_string();
        assert!(
            error.contains("unknown channel frequency class \"61\", expected 60, 180, 600, 1000 or none"),
            "{error}"
        );
    }

    #[test]
    fn the_name_is_the_one_in_a_pipeline_table() {
        for mode in [CfcMode::Iso6487, CfcMode::SaeReflect, CfcMode::SaeZeroState] {
            assert_eq!(serde_json::to_value(mode).unwrap(), mode.name());
        }
    }

    #[test]
    fn a_constant_passes_unchanged() {
        for cfc in Cfc::ALL {
            for mode in [CfcMode::Iso6487, CfcMode::SaeReflect] {
                for rate_hz in [10_000.0, 20_000.0, 100_000.0] {
                    let sum: f64 = Coefficients::new(cfc, mode, 1.0 / rate_hz).to_array().iter().sum();
                    // Five numbers of order one, rounded: a few 1e-16; 1e-12 would be visible as a drifting velocity.
                    assert!((sum - 1.0).abs() < 1e-12, "cfc {cfc} at {rate_hz} Hz: {sum}");
                }
            }
        }
    }

    #[test]
    fn half_power_moves_up_at_low_rates() {
        let at =
            |rate_hz: f64| Coefficients::new(Cfc::Cfc60, CfcMode::SaeReflect, 1.0 / rate_hz).half_power_frequency_hz();
        // The factors at 10, 20 and many samples per CFC period, known to three digits.
        assert!((at(600.0) / 60.0 - 1.751).abs() < 5e-4);
        assert!((at(1200.0) / 60.0 - 1.688).abs() < 5e-4);
        assert!((at(1e6) - 100.0).abs() < 1e-3);
    }

    #[test]
    fn the_filters_of_both_standards_keep_their_corridor_from_the_lowest_rate_on() {
        for cfc in Cfc::ALL {
            for mode in [CfcMode::Iso6487, CfcMode::SaeReflect] {
                for factor in [10.0, 20.0, 1000.0] {
                    let rate_hz = factor * cfc.frequency_hz();
                    for point in corridor(cfc, &Coefficients::new(cfc, mode, 1.0 / rate_hz)) {
                        assert!(point.is_inside(), "{cfc} {mode:?} {rate_hz} Hz: {point:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_filter_of_another_class_is_outside() {
        // Two common mistakes: the class as the -3 dB point of one pass (-6 dB at F_H), and a class too high.
        let lower = Coefficients::new(Cfc::Cfc60, CfcMode::Iso6487, 1e-5);
        assert!(corridor(Cfc::Cfc180, &lower).iter().any(|point| !point.is_inside()));
        let higher = Coefficients::new(Cfc::Cfc180, CfcMode::Iso6487, 1e-5);
        assert!(corridor(Cfc::Cfc60, &higher).iter().any(|point| !point.is_inside()));
    }

    #[test]
    fn the_limits_meet_at_the_corners() {
        assert_eq!(limits_db(Cfc::Cfc60, 30.0), (0.5, Some(-0.5)));
        assert_eq!(limits_db(Cfc::Cfc60, 60.0), (0.5, Some(-1.0)));
        assert_eq!(limits_db(Cfc::Cfc60, 100.0), (0.5, Some(-4.0)));
        assert_eq!(limits_db(Cfc::Cfc60, 200.0), (-8.5, None));
        assert_eq!((limits_db(Cfc::Cfc60, 5e3).0, limits_db(Cfc::Cfc600, 5e4).0), (-30.0, -40.0));
    }
}
