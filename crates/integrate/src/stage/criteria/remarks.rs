//! Remarks of the barrier, of crush stiffness and of recorders.

use crumple_signal::{About, Weight, remarks};

/// How many cells.
fn cells_in_words(count: usize) -> String {
    format!("{count} cell{}", if count == 1 { "" } else { "s" })
}

/// The impulse of the barrier beside the change of velocity of a sensor, m/s, up to a moment.
struct Momentum<'a> {
    up_to: &'a str,
    end_s: f64,
    barrier_m_per_s: f64,
    whole_m_per_s: f64,
    channel: &'a str,
    sensor_m_per_s: f64,
}

impl Momentum<'_> {
    fn words(&self, apart: &str) -> String {
        format!(
            "momentum check up to {} at {:.1} ms: impulse of the barrier over the mass {:.2} km/h ({:.2} km/h over the \
             whole record), channel {} {:.2} km/h, {apart}",
            self.up_to,
            1e3 * self.end_s,
            3.6 * self.barrier_m_per_s,
            3.6 * self.whole_m_per_s,
            self.channel,
            3.6 * self.sensor_m_per_s
        )
    }
}

fn percent_apart(gap: f64) -> String {
    format!("{:+.1} % apart", 1e2 * gap)
}

remarks! {
    /// Remarks of criteria beside the pulse.
    pub REMARKS;

    /// Heights of load cells are stated, and there is no force of a wall.
    CR329 WallHeightsUnused {}
    bears on (About::WallForce, Weight::Slight)
    decided "integrate.wall_heights is given, and no load cell of the barrier has data, or integrate.barrier_cells is \
             none."
    means "There is no average height of force (AHOF). Nothing else uses the heights."
    remedy "leave integrate.wall_heights out, or let the filter take the load cells"
    says "wall-heights is not used: there is no force of a wall";

    /// Load cells that the laboratory did not mark as valid are not in the force on the barrier.
    CR330 CellsNotValid { count: usize, cells: String }
    bears on (About::WallForce, Weight::None)
    decided "The status of each cell in the file; integrate.barrier_cells is valid."
    means "Where such a cell did carry force, the sum is too small; the check of momentum shows it."
    remedy "nothing; integrate.barrier_cells = \"all\" takes them as read"
    says format!(
        "barrier force: {} not marked valid by the laboratory, not in the sum: {cells} (--set \
         integrate.barrier_cells=all takes them as read)",
        cells_in_words(*count)
    );

    /// Load cells with another start, interval or number of samples are not in the force on the barrier.
    CR331 CellsOnAnotherGrid { count: usize, cells: String }
    bears on (About::WallForce, Weight::Marked)
    decided "Start, interval and number of samples must be equal to the first cell's. No cell is interpolated."
    means "The force on the barrier lacks these cells: peak, impulse and stiffness of the wall are too small."
    remedy "bring all load cells to one sampling rate: filter.resample"
    says format!("barrier force: {} on another time grid, not in the sum: {cells}", cells_in_words(*count));

    /// The force on the barrier is the sum of load cells.
    CR332 BarrierSum { cells: usize, sign: i32 }
    bears on (About::WallForce, Weight::None)
    decided "Forces along x are added sample by sample. The sign is the one with a positive impulse: laboratories \
             record compression with either sign."
    means "A cell that reads nothing is missing in the sum, and only the check of momentum shows it."
    remedy "nothing"
    says {
        let turned = if *sign < 0 { ", sign turned so that compression is positive" } else { "" };
        format!("barrier force: sum of {cells} load cells along x{turned}")
    };

    /// The change of velocity that all load cells give as they were read.
    CR333 BarrierAsRead { cells: usize, delta_v_m_per_s: f64 }
    bears on (About::WallForce, Weight::None)
    decided "All cells with data are added, whatever their status, and the zero levels that the filter removed are put \
             back. The impulse is divided by the mass."
    means "It is what other reports of the same test may show. The checked sum is the other one."
    remedy "nothing"
    says format!(
        "barrier as read: all {cells} load cells with data, zero levels not removed, give {:.2} km/h over the mass for \
         the whole record",
        3.6 * delta_v_m_per_s
    );

    /// The impulse of the barrier over the mass is the change of velocity of the sensor.
    CR334 MomentumChecked {
        up_to: String, end_s: f64, barrier_m_per_s: f64, whole_m_per_s: f64, channel: String, sensor_m_per_s: f64,
        gap: f64
    }
    bears on (About::WallForce, Weight::None)
    decided "Both are compared from contact up to separation; 5 % are left. After separation the tyres change the \
             momentum, which no cell feels."
    means "Mass, load cells and accelerometer fit together."
    remedy "nothing"
    says Momentum {
        up_to,
        end_s: *end_s,
        barrier_m_per_s: *barrier_m_per_s,
        whole_m_per_s: *whole_m_per_s,
        channel,
        sensor_m_per_s: *sensor_m_per_s,
    }
    .words(&percent_apart(*gap));

    /// The impulse of the barrier over the mass is not the change of velocity of the sensor, or nothing says so.
    CR335 MomentumApart {
        up_to: String, end_s: f64, barrier_m_per_s: f64, whole_m_per_s: f64, channel: String, sensor_m_per_s: f64,
        gap: Option<f64>, reason: Option<String>
    }
    bears on (About::WallForce, Weight::Slight)
    decided "Both are compared from contact up to separation; more than 5 % apart is named."
    means "The mass, a load cell or the sensor is wrong, or a part of the force does not go through the load cells. \
           Stiffness from the wall is off by as much."
    remedy "check the mass and the load cells that are left out; integrate.barrier_cells = \"all\" adds those"
    says {
        let momentum = Momentum {
            up_to,
            end_s: *end_s,
            barrier_m_per_s: *barrier_m_per_s,
            whole_m_per_s: *whole_m_per_s,
            channel,
            sensor_m_per_s: *sensor_m_per_s,
        };
        let why_none = || format!("no ratio: {}", reason.as_deref().unwrap_or_default());
        momentum.words(&gap.map_or_else(why_none, percent_apart))
    };

    /// Crush stiffness (A, B and G) was asked for, and an input is missing or not positive.
    CR336 StiffnessNotComputed { no_damage_speed_m_per_s: Option<f64> }
    bears on (About::Motion, Weight::Slight)
    decided "It needs the mass, a positive width and residual crush, and an impact speed above the speed of no damage \
             (5 mph, if integrate.no_damage_speed does not state it)."
    means "There is no crush stiffness in /metrics. All other metrics are as they are."
    remedy "state the mass at ingest with --mass, and check integrate.damage_width and integrate.residual_crush"
    says match no_damage_speed_m_per_s {
        None => "crush stiffness: the mass is not known (give it to ingest with --mass)".to_owned(),
        Some(b0) => format!(
            "crush stiffness: width, residual crush and impact speed above {b0} m/s must be positive, none computed"
        ),
    };

    /// The file states the damage of the vehicle, and no crush stiffness follows from it.
    CR337 StiffnessNotFromDamage { reason: String, no_damage_speed_m_per_s: f64 }
    bears on (About::Motion, Weight::None)
    decided "It needs damage of the front (SAE J224), the width of the damage or of the vehicle, mass, impact speed \
             above the speed of no damage, and a positive crush; the sentence says what is missing."
    means "There is no crush stiffness in /metrics. The measured crush is in /damage."
    remedy "nothing, or state what is missing: integrate.damage_width with integrate.residual_crush, --mass at ingest"
    says format!("crush stiffness (CRASH3): not from the damage that the file states: {reason}");

    /// The table of an event data recorder holds several impacts.
    CR338 SeveralImpactsInTable { count: usize, impacts: Vec<String> }
    bears on (About::Motion, Weight::Slight)
    decided "Changes of 8 km/h and more count as impacts (49 CFR 563.5)."
    means "The maximum delta-v is the largest change within 300 ms: it may count several of them."
    remedy "quote the change of each impact, which the sentence and /impacts have"
    says format!(
        "the table holds {count} impacts: {}. The maximum delta-v is the largest change within 300 ms (49 CFR 563)",
        impacts.join("; ")
    );
}
