//! Every definition this crate computes, as one table.

/// How well a definition is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Checked against a closed form or a second implementation.
    Checked,
    /// After a secondary description of the named standard.
    Secondary,
    /// Well known, no text of the source seen: to be confirmed before a claim of conformity.
    FromMemory,
    /// Doubtful or open to interpretation: an option, named in the result.
    Uncertain,
}

impl Mark {
    /// The letter in `docs/metrics.md`.
    pub const fn letter(self) -> &'static str {
        match self {
            Self::Checked => "C",
            Self::Secondary => "S",
            Self::FromMemory => "M",
            Self::Uncertain => "U",
        }
    }
}

/// What a number is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Definition {
    /// Key, e.g. `hic15-fmvss208`.
    pub id: &'static str,
    /// Name of the number, e.g. `hic15`.
    pub name: &'static str,
    /// SI unit, `1` for a ratio.
    pub unit: &'static str,
    /// How well the definition is known.
    pub mark: Mark,
    /// What is computed.
    pub text: &'static str,
    /// After whom.
    pub source: &'static str,
}

macro_rules! catalogue {
    ($($constant:ident = $id:literal $name:literal $unit:literal $mark:ident $text:literal $source:literal;)*) => {
        $(
            #[doc = concat!("`", $id, "`: ", $text, ". ", $source)]
            pub const $constant: Definition = Definition {
                id: $id, name: $name, unit: $unit, mark: Mark::$mark, text: $text, source: $source,
            };
        )*
        /// All of them, in the order of `docs/metrics.md`.
        pub const CATALOGUE: &[Definition] = &[$($constant),*];
    };
}

catalogue! {
    PEAK = "peak-sample" "peak_acceleration" "m/s^2" Checked
        "largest |a| of a sample from the start of the integration" "definition";
    TIME_OF_PEAK = "peak-sample-time" "time_of_peak_acceleration" "s" Checked
        "time of the sample with the largest |a|" "definition";
    DYNAMIC_CRUSH = "dynamic-crush" "dynamic_crush" "m" Checked
        "C = x(t_m), displacement at the first zero of velocity" "definition";
    TIME_OF_CRUSH = "dynamic-crush-time" "time_of_dynamic_crush" "s" Checked
        "t_m, first zero of velocity, linearly interpolated; a part of OLC++, see olc" "definition";
    CENTROID = "centroid-crush" "centroid_time" "s" Checked
        "t_c = C/v0, equal to the centroid of the pulse over 0..t_m (Huang, Vehicle Crash Mechanics, 2002)" "Huang, \
         Vehicle Crash Mechanics (2002)";
    CENTROID_MOMENT = "centroid-moment" "centroid_time_by_moment" "s" Checked
        "integral of t*a over integral of a up to t_m, by trapezoid; equals C/v0 but for the error of sampling and \
         rule" "Huang, Vehicle Crash Mechanics (2002)";
    CENTROID_RATIO = "centroid-ratio" "centroid_time_ratio" "1" Checked
        "t_c/t_m: 0.5 symmetric, 2/pi an undamped spring, lower front-loaded (Huang, 2002)" "Huang, Vehicle Crash \
         Mechanics (2002)";
    DELTA_V = "delta-v" "delta_v" "m/s" Checked
        "v0 - v_s, impact speed minus the lowest velocity from t_m to the end of the contact" "definition";
    STROKE = "stroke" "stroke" "m" Checked
        "displacement from time zero to the end of the force, of what starts from rest and of a sled" "definition";
    RISE_TIME = "rise-time" "rise_time" "s" Checked
        "from 10 % to 90 % of the peak, last and first crossing before it, linearly interpolated" "definition";
    PULSE_AS_HALF_SINE = "simple-pulse-half-sine" "simple_pulse_half_sine" "1" Checked
        "RMS of the pulse less the half sine of its duration and change of velocity, over the largest |a| in it"
        "Varat and Husher, ESV 18-501 (2003)";
    PULSE_AS_HAVERSINE = "simple-pulse-haversine" "simple_pulse_haversine" "1" Checked
        "RMS of the pulse less the haversine of its duration and change of velocity, over the largest |a| in it"
        "Varat and Husher, ESV 18-501 (2003)";
    PULSE_AS_TRIANGLE = "simple-pulse-triangle" "simple_pulse_triangle" "1" Checked
        "RMS of the pulse less the closest triangle of its duration and change of velocity, over the largest |a| in \
         it" "Varat and Husher, ESV 18-501 (2003)";
    PULSE_AS_TESW = "simple-pulse-tesw" "simple_pulse_tesw" "1" Checked
        "RMS of the pulse less its tipped equivalent square wave, the line that keeps duration, change of velocity and \
         displacement, over the largest |a| in it" "Huang, Vehicle Crash Mechanics (2002)";
    PULSE_AS_TRAPEZOID = "simple-pulse-trapezoid" "simple_pulse_trapezoid" "1" Checked
        "RMS of the pulse less the closest trapezoid of its duration and change of velocity, over the largest |a| in \
         it" "Huang, Vehicle Crash Mechanics (2002)";
    SLED_PULSE_MET = "sled-pulse-met" "sled_pulse_met" "1" Checked
        "1 where corridor, velocity, stroke and peak are as the named sled pulse demands, 0 where one is not"
        "standard as named";
    CORRIDOR_EXCESS = "sled-corridor-excess" "corridor_excess" "m/s^2" Checked
        "how far the pulse is outside of the corridor of the named sled pulse at most, 0 inside; straight lines \
         between its corners" "standard as named";
    OUTSIDE_CORRIDOR = "sled-corridor-first" "time_outside_corridor" "s" Checked
        "first sample outside of the corridor of the named sled pulse" "standard as named";
    MAXIMUM_DELTA_V = "edr-maximum-delta-v" "maximum_delta_v" "m/s" FromMemory
        "sample of largest magnitude of the recorded change of velocity, from time zero to 300 ms, with its sign" "49 \
         CFR 563.5";
    TIME_OF_MAXIMUM_DELTA_V = "edr-maximum-delta-v-time" "time_of_maximum_delta_v" "s" FromMemory
        "time of the sample of maximum_delta_v, the first of equals" "49 CFR 563.5";
    MAXIMUM_LATERAL_DELTA_V = "edr-maximum-delta-v-lateral" "maximum_lateral_delta_v" "m/s" FromMemory
        "as maximum_delta_v, along y" "49 CFR 563.5";
    TOTAL_DELTA_V = "delta-v-total" "total_delta_v" "m/s" FromMemory
        "largest sqrt(x^2 + y^2) of the changes of velocity along x and y at one time, from time zero to separation, \
         300 ms at most and as a recorder keeps them" "49 CFR 563.5";
    LATERAL_OF_TOTAL = "delta-v-total-lateral" "total_delta_v_lateral" "m/s" Checked
        "change of velocity along y at total_delta_v, positive to the right (SAE J211): the force came from the left"
        "definition";
    DIRECTION_OF_FORCE = "principal-direction-of-force" "principal_direction_of_force" "deg" Checked
        "angle at which the force came, from straight ahead (180: from behind), by the changes of velocity along x and \
         y at total_delta_v; its side by the sign of total_delta_v_lateral, negative from the right" "SAE J224";
    RECORDED_EES = "edr-ees" "recorded_ees" "m/s" Checked
        "sqrt(v0^2 - v^2), v what is left along x and gained along y at maximum_delta_v; without v0 the middle of what \
         restitutions from 0 to the largest believed make of the change" "definition";
    ABSORBED_SHARE = "edr-absorbed-share" "absorbed_energy_share" "1" Checked
        "recorded_ees^2/v0^2, share of the kinetic energy that went into deformation" "definition";
    RECORDED_CRUSH = "edr-crush" "recorded_crush" "m" Checked
        "integral of v0 plus the recorded change up to the first zero of the velocity, by trapezoid" "definition";
    RESTITUTION = "restitution-barrier" "coefficient_of_restitution" "1" Checked
        "e = -v_s/v0 against a rigid barrier" "definition";
    RESTITUTION_TWO = "restitution-two-bodies" "coefficient_of_restitution" "1" Checked
        "e = (v2' - v1')/(v1 - v2) of two bodies" "definition";
    RELATIVE_CRUSH = "two-vehicles-relative-crush" "relative_crush" "m" Checked
        "how much closer the sensors of two vehicles have come at their common velocity, integral of v1 - v2 along the \
         axis of the first" "definition";
    TIME_OF_COMMON_VELOCITY = "two-vehicles-common-velocity-time" "time_of_common_velocity" "s" Checked
        "first zero of the relative velocity of two vehicles, linearly interpolated" "definition";
    COMMON_VELOCITY = "two-vehicles-common-velocity" "common_velocity" "m/s" Checked
        "velocity of the first vehicle at the first zero of the relative velocity" "definition";
    COMMON_VELOCITY_BY_MOMENTUM = "two-vehicles-common-velocity-momentum" "common_velocity_by_momentum" "m/s" Checked
        "(m1 v1 + m2 v2)/(m1 + m2) of the speeds before contact, along the axis of the first" "definition";
    MOMENTUM_GAP = "two-vehicles-momentum-gap" "momentum_gap" "1" Checked
        "(m1 dv1 + m2 dv2)/(m1 |dv1|) up to the common velocity: 0 if no other force acts" "definition";
    REBOUND_DISPLACEMENT = "rebound-displacement" "rebound_displacement" "m" Checked
        "d_e = C - x(t_s), displacement recovered until the lowest velocity" "definition";
    ESW = "square-wave-displacement" "equivalent_square_wave" "m/s^2" Checked
        "ESW = v0^2/(2C), constant deceleration with the same crush (Huang, 2002)" "Huang, Vehicle Crash Mechanics \
         (2002)";
    ASW = "square-wave-time" "average_square_wave" "m/s^2" Checked
        "ASW = v0/t_m, constant deceleration that stops in the same time (Huang, 2002)" "Huang, Vehicle Crash \
         Mechanics (2002)";
    X_MEAN = "x-mean" "mean_deceleration" "m/s^2" Checked
        "x-mean over 0..t_m, (v(0) - v(t_m))/t_m from the integrated velocity" "definition";
    SM25 = "sliding-mean-25ms" "sm25" "m/s^2" Checked
        "largest |V(t + 25 ms) - V(t)|/25 ms from time zero on, V = integral of a, t on the grid; a part of OLC++, see \
         olc" "Euro NCAP pulse assessment";
    SLIDING_MEAN = "sliding-mean" "sliding_mean" "m/s^2" Checked
        "largest |V(t + w) - V(t)|/w over the stated window length w, V = integral of a, t on the grid" "definition";
    OLC = "olc-tb027" "olc" "m/s^2" Checked
        "occupant load criterion: constant deceleration over 235 mm of restraint after 65 mm of free flight, ending at \
         the vehicle's speed; OLC++ combines olc, sm25 and time_of_dynamic_crush by weights that are not known: the \
         three are given, no composite" "Euro NCAP TB 027";
    VPI = "vpi-iso12353-3" "vpi" "m/s^2" Checked
        "vehicle pulse index: largest belt force of 1 kg on 2500 N/m after 30 mm of slack" "ISO/TR 12353-3";
    SEPARATION = "separation-drift" "acceleration_after_separation" "m/s^2" Checked
        "|mean a| over the last 20 ms of the record: below 0.5 g once the vehicle is free" "plausibility";
    AVERAGE_STIFFNESS = "stiffness-average" "average_stiffness" "N/m" Checked
        "k = m*v0^2/C^2, linear spring of equal energy" "Huang, Vehicle Crash Mechanics (2002)";
    IMPACT_ENERGY = "energy-impact" "impact_energy" "J" Checked
        "m*v0^2/2" "definition";
    ABSORBED_ENERGY = "energy-absorbed" "energy_absorbed" "J" Checked
        "m*(v0^2 - v_s^2)/2, impact energy less the energy of the rebound" "definition";
    RETURNED_ENERGY = "energy-returned" "energy_returned" "J" Checked
        "m*v_s^2/2, energy of the rebound" "definition";
    LOSS_RATIO = "energy-loss-ratio" "energy_loss_ratio" "1" Checked
        "1 - e^2, absorbed over impact energy" "definition";
    CLOSURE = "energy-closure" "energy_closure" "1" Checked
        "work of the barrier force up to C over the impact energy, minus 1; 0 but for rounding with the \
         trapezoid" "energy balance";
    EES = "ees" "energy_equivalent_speed" "m/s" Checked
        "sqrt(2*E_abs/m), speed whose kinetic energy is the absorbed energy" "definition";
    CRASH3_A = "crash3-a" "crush_stiffness_a" "N/m" Checked
        "A = m*b0*b1/L, force a width at which crush begins, from V = b0 + b1*C_res" "Campbell (1974); CRASH3";
    CRASH3_B = "crash3-b" "crush_stiffness_b" "N/m^2" Checked
        "B = m*b1^2/L, stiffness a width" "Campbell (1974); CRASH3";
    CRASH3_G = "crash3-g" "crush_stiffness_g" "N" Checked
        "G = A^2/(2B), energy a width absorbed without crush" "Campbell (1974); CRASH3";
    CRUSH_ENERGY = "crash3-energy" "crush_energy" "J" Checked
        "crush energy of a damage profile from stations of equal spacing, times 1 + tan^2 of the angle of force"
        "Campbell; CRASH3";
    KW400 = "kw400" "kw400" "N/m" Secondary
        "2*W/(0.4^2 - 0.025^2), W the work of the wall's force over the compartment's displacement from 25 to 400 mm: \
         gives back the stiffness of a linear spring; bounds and divisor after secondary descriptions" "NHTSA";
    AHOF400 = "ahof400" "average_height_of_force" "m" Secondary
        "height at which the wall's force acts, over the compartment's displacement from 25 to 400 mm weighted with \
         the force: integral of sum F_i*h_i over that of sum F_i, h_i the heights of the cells above ground" "NHTSA";
    WALL_INITIAL_STIFFNESS = "wall-initial-stiffness" "initial_wall_stiffness" "N/m" Secondary
        "slope of the line with the least squares over the displacement through the wall's force from 25 to 200 mm"
        "NHTSA";
    RIDE_DOWN = "ridedown-efficiency" "ride_down_efficiency" "1" Checked
        "2/v0^2 times the work of the occupant's deceleration over the vehicle's travel" "Huang, Vehicle Crash \
         Mechanics (2002)";
    RESTRAINT = "ridedown-restraint" "restraint_energy_ratio" "1" Checked
        "2/v0^2 times the work of the occupant's deceleration over its travel in the vehicle" "Huang, Vehicle Crash \
         Mechanics (2002)";
    OCCUPANT_TRAVEL = "ridedown-travel" "occupant_travel" "m" Checked
        "largest travel of the occupant in the vehicle" "definition";
    ASI_1998 = "asi-en1317-1998" "asi" "1" Checked
        "acceleration severity index from forward 50 ms means, limits 12, 9, 10 g" "EN 1317-1:1998";
    ASI_2010 = "asi-en1317-2010" "asi" "1" Uncertain
        "acceleration severity index from a phaseless four-pole Butterworth low-pass, 13 Hz design frequency of each \
         pass, limits 12, 9, 10 g" "EN 1317-1:2010";
    ASI_2010_TWO_PASS = "asi-en1317-2010-two-pass" "asi" "1" Uncertain
        "acceleration severity index from a phaseless four-pole Butterworth low-pass, -3 dB at 13 Hz after both \
         passes, limits 12, 9, 10 g" "EN 1317-1:2010";
    THIV = "thiv-en1317" "thiv" "m/s" FromMemory
        "theoretical head impact velocity: speed of a free head against the cabin at 0.6 m ahead or 0.3 m aside" "EN \
         1317-1";
    PHD = "phd-en1317" "phd" "m/s^2" FromMemory
        "post-impact head deceleration: largest resultant of 10 ms means after the flight of the head" "EN 1317-1";
    OIV_X = "oiv-x-mash" "oiv_x" "m/s" FromMemory
        "occupant impact velocity along x: cabin against a free occupant after 0.6 m ahead or 0.3 m aside, no \
         yaw" "MASH flail space";
    OIV_Y = "oiv-y-mash" "oiv_y" "m/s" FromMemory
        "occupant impact velocity along y, as along x" "MASH flail space";
    ORA_X = "ora-x-mash" "ora_x" "m/s^2" FromMemory
        "occupant ridedown acceleration along x: 10 ms mean of largest magnitude after the impact of the \
         occupant" "MASH flail space";
    ORA_Y = "ora-y-mash" "ora_y" "m/s^2" FromMemory
        "occupant ridedown acceleration along y, as along x" "MASH flail space";
    HIC15 = "hic15-fmvss208" "hic15" "1" Checked
        "head injury criterion, windows up to 15 ms inclusive: largest (t2 - t1)*(mean a in g)^2.5 over all sample \
         pairs" "FMVSS 208; Chou & Nyquist (1974)";
    HIC36 = "hic36-fmvss208" "hic36" "1" Checked
        "head injury criterion, windows up to 36 ms inclusive" "FMVSS 208; UN R94";
    HIC = "hic-window" "hic" "1" Checked
        "head injury criterion with the stated longest window" "as HIC15 and HIC36";
    HICD = "hicd-fmvss201" "hic_d" "1" Checked
        "HIC(d) = 0.75446*HIC36 + 166.4 of a free-motion headform" "FMVSS 201";
    BRIC = "bric-2013" "bric" "1" FromMemory
        "brain injury criterion: root of the sum of squares of the head's largest angular velocities about x, y and z \
         over 66.25, 56.45 and 42.87 rad/s, behind CFC 60" "Takhounts et al. (2013)";
    NIJ = "nij-fmvss208" "nij" "1" FromMemory
        "largest Fz/Fzc + My/Myc of the upper neck at one time, My at the occipital condyles (17.78 mm of shear taken \
         off), behind CFC 600; 6806 and 6160 N, 310 and 135 N m of a 50 % male, 4287 and 3880 N, 155 and 67 N m of a \
         5 % female in position" "FMVSS 208 S6.6";
    CLIP_CONTIGUOUS = "clip3-saej1727" "clip_3ms_contiguous" "m/s^2" Checked
        "highest level that one peak exceeds for 3 ms without a break" "SAE J1727";
    CLIP_CUMULATIVE = "clip3-cumulative" "clip_3ms_cumulative" "m/s^2" FromMemory
        "highest level that is exceeded for 3 ms in total" "FMVSS 208; UN R94; Euro NCAP";
    ISO_CORRIDOR = "iso18571-corridor" "iso18571_corridor" "1" Checked
        "corridor score Z, 5 % and 50 % of the largest |T|, quadratic between" "ISO/TS 18571:2014";
    ISO_PHASE = "iso18571-phase" "iso18571_phase" "1" Checked
        "phase score E_P from the shift of largest correlation, up to 20 %" "ISO/TS 18571:2014";
    ISO_MAGNITUDE = "iso18571-magnitude" "iso18571_magnitude" "1" Checked
        "magnitude score E_M after shift and dynamic time warping" "ISO/TS 18571:2014";
    ISO_SLOPE = "iso18571-slope" "iso18571_slope" "1" Checked
        "slope score E_S of the shifted signals, 9-point mean of the derivative" "ISO/TS 18571:2014";
    ISO = "iso18571" "iso18571" "1" Checked
        "R = 0.4 Z + 0.2 E_P + 0.2 E_M + 0.2 E_S" "ISO/TS 18571:2014";
    CORA_CORRIDOR = "cora-corridor" "cora_corridor" "1" FromMemory
        "corridor score, as in ISO 18571" "CORA";
    CORA_CROSS = "cora-cross" "cora_cross_correlation" "1" FromMemory
        "0.5 progression + 0.25 size + 0.25 phase at the shift of largest cross-correlation" "CORA";
    CORA = "cora" "cora" "1" FromMemory
        "0.5 corridor + 0.5 cross-correlation over the stated interval" "CORA";
    CORA_CORRIDOR_AUTOMATIC = "cora-corridor-automatic" "cora_corridor" "1" Uncertain
        "corridor score over the automatic interval: from 3 % of the largest |T| to the last 7.5 %, 1 % longer on \
         either side" "CORA";
    CORA_CROSS_AUTOMATIC = "cora-cross-automatic" "cora_cross_correlation" "1" Uncertain
        "cross-correlation score over the automatic interval" "CORA";
    CORA_AUTOMATIC = "cora-automatic" "cora" "1" Uncertain
        "0.5 corridor + 0.5 cross-correlation over the automatic interval" "CORA";
    SPRAGUE_GEERS_M = "sprague-geers-m" "sprague_geers_magnitude" "1" Checked
        "M = sqrt(I_cc/I_mm) - 1" "Sprague & Geers (2003)";
    SPRAGUE_GEERS_P = "sprague-geers-p" "sprague_geers_phase" "1" Checked
        "P = acos(I_mc/sqrt(I_mm I_cc))/pi; loses half the digits near 0" "Sprague & Geers (2003)";
    SPRAGUE_GEERS_C = "sprague-geers-c" "sprague_geers_comprehensive" "1" Checked
        "sqrt(M^2 + P^2)" "Sprague & Geers (2003)";
    ANOVA_MEAN = "anova-mean" "residual_mean" "1" FromMemory
        "mean of (m - c)/max|m|; 0.05 is accepted for roadside hardware" "NCHRP W179";
    ANOVA_STD = "anova-std" "residual_standard_deviation" "1" FromMemory
        "standard deviation of (m - c)/max|m|, divisor N - 1; 0.35 is accepted for roadside hardware" "NCHRP W179";
    RMSE = "rmse" "rmse" "as the signals" Checked
        "root of the mean square of m - c" "definition";
    FIT = "fit-percent" "fit_percent" "%" Checked
        "100 (1 - ||y - yh||/||y - mean y||); negative when worse than the mean" "MATLAB compare";
    NRMSE = "nrmse" "nrmse" "1" Checked
        "||y - yh||/||y - mean y|| = 1 - fit/100" "MATLAB goodnessOfFit";
    R2 = "r2" "r2" "1" Checked
        "1 - NRMSE^2" "definition";
    VAF = "vaf-percent" "vaf_percent" "%" FromMemory
        "100 (1 - var(y - yh)/var(y)): blind to a constant offset" "subspace identification practice";
    THEIL_U1 = "theil-u1" "theil_u1" "1" Checked
        "||m - c||/(||m|| + ||c||), 0 to 1" "Theil (1958)";
    THEIL_U2 = "theil-u2" "theil_u2" "1" FromMemory
        "||m - c||/||m||" "Theil (1966)";
    DRIFT = "drift-correction" "drift_correction" "m/s^2" Checked
        "acceleration subtracted so that the stated velocity is met" "definition";
    BARRIER_PEAK = "barrier-peak" "barrier_peak_force" "N" Checked
        "sample of the sum of the load cells along x with the largest magnitude, positive in compression" "definition";
    BARRIER_IMPULSE = "barrier-impulse" "barrier_impulse" "N*s" Checked
        "integral of the sum of the load cells from time zero to the end of the record, by trapezoid" "definition";
    BARRIER_DELTA_V = "barrier-delta-v" "barrier_delta_v" "m/s" Checked
        "barrier_impulse over the mass" "definition";
    BARRIER_DELTA_V_AS_READ = "barrier-delta-v-as-read" "barrier_delta_v_as_read" "m/s" Checked
        "impulse over the mass of all load cells with data, those not marked valid among them, with the zero levels \
         that were removed before filtering put back" "definition";
    MOMENTUM_RATIO = "momentum-ratio" "momentum_ratio" "1" Checked
        "impulse of the barrier up to separation over the mass and the change of velocity of the pulse; 1 if both are \
         right" "definition";
    TIME_ZERO_THRESHOLD = "time-zero-threshold" "time_zero" "s" Checked
        "first crossing of the threshold that holds, interpolated" "threshold rule";
    TIME_ZERO_EDR = "time-zero-edr" "time_zero" "s" FromMemory
        "first sample of the first 20 ms over which |change of velocity| exceeds 0.8 km/h" "49 CFR 563.5";
}

/// The definition with this key.
pub fn definition(id: &str) -> Option<&'static Definition> {
    CATALOGUE.iter().find(|definition| definition.id == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_unique() {
        for (k, definition) in CATALOGUE.iter().enumerate() {
            assert!(CATALOGUE[..k].iter().all(|other| other.id != definition.id), "{}", definition.id);
        }
        assert_eq!(definition("hic15-fmvss208"), Some(&HIC15));
        assert_eq!(definition("hic"), None);
    }
}
