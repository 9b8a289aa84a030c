//! An NHTSA test of two cars with known parameters: EV5 file and signal files, as the database hands them over.

use std::fmt::Write as _;

use crumple_signal::STANDARD_GRAVITY_M_PER_S2;

/// Two cars, two masses with a spring between them that lets go when it is as long as before.
#[derive(Debug, Clone, Copy)]
pub struct TwoVehicles {
    /// Test masses, kg.
    pub masses_kg: [f64; 2],
    /// Speeds before contact along each one's own forward axis, km/h.
    pub speeds_km_per_h: [f64; 2],
    /// The second heads the same way as the first, else towards it.
    pub same_heading: bool,
}

/// Natural frequency of the two on their spring, rad/s.
const OMEGA_RAD_PER_S: f64 = 20.0;
/// Samples before contact, and in all, 0.1 ms apart.
const SAMPLES: [i64; 2] = [500, 2500];

impl TwoVehicles {
    /// One standing car, hit head-on by a lighter one at 50 km/h.
    pub const STANDING: Self = Self { masses_kg: [1200.0, 1600.0], speeds_km_per_h: [50.0, 0.0], same_heading: false };

    fn sign(&self) -> f64 {
        if self.same_heading { 1.0 } else { -1.0 }
    }

    /// Closing speed, m/s.
    pub fn closing_speed_m_per_s(&self) -> f64 {
        (self.speeds_km_per_h[0] - self.sign() * self.speeds_km_per_h[1]) / 3.6
    }

    /// Velocity of both when they move alike, along the axis of the first, m/s.
    pub fn common_velocity_m_per_s(&self) -> f64 {
        let [m1, m2] = self.masses_kg;
        let [v1, v2] = self.speeds_km_per_h.map(|v| v / 3.6);
        (m1 * v1 + m2 * self.sign() * v2) / (m1 + m2)
    }

    /// How much closer they have come then, m, and when that is, s.
    pub fn relative_crush(&self) -> (f64, f64) {
        (self.closing_speed_m_per_s() / OMEGA_RAD_PER_S, std::f64::consts::PI / (2.0 * OMEGA_RAD_PER_S))
    }

    /// Acceleration of vehicle `k` along its own forward axis, m/s².
    pub fn acceleration_m_per_s2(&self, k: usize, time_s: f64) -> f64 {
        let [m1, m2] = self.masses_kg;
        let phase = OMEGA_RAD_PER_S * time_s;
        if !(0.0..=std::f64::consts::PI).contains(&phase) {
            return 0.0;
        }
        let force = m1 * m2 / (m1 + m2) * self.closing_speed_m_per_s() * OMEGA_RAD_PER_S * phase.sin();
        if k == 0 { -force / m1 } else { self.sign() * force / m2 }
    }

    /// The files of the test by name: `v90001.EV5` and its signal files. Curves 1 and 2 are left and right of the first
    /// car, 3 is its engine; 4 and 5 are the second car, 6 its missing sill sensor, 7 a driver of the second.
    pub fn files(&self) -> Vec<(String, String)> {
        let curves = [
            (1, "FLLR", "NA", "LEFT REAR SEAT CROSSMEMBER X"),
            (1, "FLRR", "NA", "NO COMMENTS"),
            (1, "ENGN", "NA", "TOP OF ENGINE X"),
            (2, "FLLR", "NA", "NO COMMENTS"),
            (2, "VECG", "NA", ""),
            (2, "DSLF", "NA", "No comments"),
            (2, "CHST", "01", "DRIVER CHEST X"),
        ];
        let mut files = vec![("v90001.EV5".to_owned(), self.specification(&curves))];
        for (k, (vehicle, attachment, ..)) in curves.iter().enumerate() {
            if *attachment != "DSLF" {
                files.push((format!("v90001.{:03}", k + 1), self.signal(*vehicle - 1)));
            }
        }
        files
    }

    fn specification(&self, curves: &[(usize, &str, &str, &str)]) -> String {
        let record = |count: usize, fields: &[(usize, String)]| {
            let mut cells = vec![String::new(); count];
            for (position, text) in fields {
                cells[position - 1].clone_from(text);
            }
            cells.join("|") + "\n"
        };
        let text = |text: &str| text.to_owned();
        let closing = format!("{:.2}", 3.6 * self.closing_speed_m_per_s());
        let title = text("2016 FIRST CAR SEDAN INTO 2014 SECOND CAR HATCHBACK");
        let test = [(1, text("V5")), (2, title), (9, text("VTV")), (15, closing), (20, text("NO COMMENTS"))];
        let mut ev5 = format!("# made record\n----- EV5 -----\n----- TEST -----\n{}", record(20, &test));
        ev5 += "----- VEHICLE -----\n";
        for (k, year) in ["2016", "2014"].into_iter().enumerate() {
            let mut fields = vec![
                (1, (k + 1).to_string()),
                (2, text("16")),
                (3, text("03")),
                (4, text(year)),
                (11, self.masses_kg[k].to_string()),
                (42, self.speeds_km_per_h[k].to_string()),
                (54, text("12FDEW2")),
                (81, text("NO COMMENTS")),
            ];
            fields.extend((0..6).map(|station| (48 + station, (100 * (k + 1) + 10 * station).to_string())));
            ev5 += &record(81, &fields);
        }
        ev5 += "----- INSTRUMENTATION -----\n";
        for (k, (vehicle, attachment, location, comment)) in curves.iter().enumerate() {
            let speed = self.speeds_km_per_h[vehicle - 1];
            let fields = [
                (1, vehicle.to_string()),
                (2, format!("{:03}", k + 1)),
                (3, text("AC")),
                (4, text(location)),
                (5, text(attachment)),
                (6, text("XG")),
                (7, text("SEC")),
                (8, text("G'S")),
                (9, text("3000")),
                (14, speed.to_string()),
                (15, (-SAMPLES[0]).to_string()),
                (16, (SAMPLES[1] - SAMPLES[0] - 1).to_string()),
                (17, text("100")),
                (18, text("AM")),
                (19, text("P")),
                (20, text(comment)),
            ];
            ev5 += &record(20, &fields);
        }
        ev5 + "----- END -----\n"
    }

    fn signal(&self, vehicle: usize) -> String {
        let mut rows = String::new();
        for k in 0..SAMPLES[1] {
            let time_s = (k - SAMPLES[0]) as f64 * 1e-4;
            let g = self.acceleration_m_per_s2(vehicle, time_s) / STANDARD_GRAVITY_M_PER_S2;
            let _ = writeln!(rows, "{time_s:.6}\t{g:.6}");
        }
        rows
    }
}
