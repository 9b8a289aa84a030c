//! Files of a crash simulation of known motion: a mass that meets a spring at a wall, exact at every state.
//!
//! 1,000 kg at 15 m/s touch the wall after 5 ms; from then on x = v/w sin(w t), w = pi / 100 ms, until the mass leaves
//! it at 105 ms. States every millisecond to 120 ms. Files are in mm, ms, kg.

use std::f64::consts::PI;
use std::io::{self, Write};

use crumple_lumped::{CrushedStructure, Model};

const MASS_KG: f64 = 1000.0;
const SPEED_M_PER_S: f64 = 15.0;
const CONTACT_MS: f64 = 5.0;
const SPRING_MS: f64 = 100.0;
/// States of every file.
pub const STATES: usize = 121;

/// Displacement mm, velocity mm/ms, acceleration mm/ms², force kN at a time in ms.
pub fn motion(t_ms: f64) -> [f64; 4] {
    let (w, t) = (PI / SPRING_MS, t_ms - CONTACT_MS);
    if t < 0.0 {
        return [SPEED_M_PER_S * t_ms, SPEED_M_PER_S, 0.0, 0.0];
    }
    let gap = SPEED_M_PER_S * CONTACT_MS;
    if t > SPRING_MS {
        return [gap - SPEED_M_PER_S * (t - SPRING_MS), -SPEED_M_PER_S, 0.0, 0.0];
    }
    let a = -SPEED_M_PER_S * w * (w * t).sin();
    [gap + SPEED_M_PER_S / w * (w * t).sin(), SPEED_M_PER_S * (w * t).cos(), a, -MASS_KG * a]
}

fn states() -> impl Iterator<Item = (f64, [f64; 4])> {
    (0..STATES).map(|k| (k as f64, motion(k as f64)))
}

/// A binout in the making, or a piece of one: values, and the symbols of the next table.
struct Lsda {
    /// Place of the first byte in the file.
    start: usize,
    out: Vec<u8>,
    is_little: bool,
    symbols: Vec<u8>,
    /// Where the place of the next table is to be written.
    link: usize,
}

impl Lsda {
    fn new(is_little: bool) -> Self {
        let mut file = Self {
            start: 0,
            out: vec![8, 8, 8, 1, 1, u8::from(is_little), 0, 0],
            is_little,
            symbols: Vec::new(),
            link: 17,
        };
        file.out.extend(file.whole(17));
        file.out.push(7);
        file.out.extend(file.whole(0));
        file
    }

    fn whole(&self, number: u64) -> [u8; 8] {
        if self.is_little { number.to_le_bytes() } else { number.to_be_bytes() }
    }

    fn record(&self, command: u8, content: &[u8]) -> Vec<u8> {
        [&self.whole(9 + content.len() as u64)[..], &[command], content].concat()
    }

    fn folder(&mut self, path: &str) {
        let record = self.record(2, path.as_bytes());
        self.out.extend(&record);
        self.symbols.extend(record);
    }

    fn values(&mut self, name: &str, kind: u8, bytes: &[u8], count: usize) {
        let at = (self.start + self.out.len()) as u64;
        let data = [&[kind, name.len() as u8], name.as_bytes(), bytes].concat();
        self.out.extend(self.record(3, &data));
        let symbol = [name.as_bytes(), &[kind], &self.whole(at), &self.whole(count as u64)].concat();
        self.symbols.extend(self.record(4, &symbol));
    }

    fn text(&mut self, name: &str, text: &str) {
        self.values(name, 1, text.as_bytes(), text.len());
    }

    fn floats(&mut self, name: &str, values: &[f64]) {
        let bytes: Vec<u8> = values.iter().flat_map(|x| self.whole(x.to_bits())).collect();
        self.values(name, 10, &bytes, values.len());
    }

    fn ids(&mut self, name: &str, values: &[u64]) {
        let bytes: Vec<u8> = values.iter().flat_map(|x| self.whole(*x)).collect();
        self.values(name, 4, &bytes, values.len());
    }

    /// States where the next table stands.
    fn link_to(&mut self, at: usize) {
        let place = self.whole(at as u64);
        if let Some(link) = self.out.get_mut(self.link..self.link + 8) {
            link.copy_from_slice(&place);
        }
    }

    fn table(&mut self) {
        let (at, symbols) = (self.start + self.out.len(), std::mem::take(&mut self.symbols));
        self.link_to(at);
        self.out.extend(self.whole((9 + symbols.len() + 17) as u64));
        self.out.push(5);
        self.out.extend(symbols);
        self.out.extend(self.record(6, &[0; 8]));
        self.link = self.out.len() - 8;
    }
}

/// A binout: nodes 7 (the car) and 9 (an engine that goes ahead with 1.1 times the motion), wall 1, glstat.
pub fn binout(is_little: bool) -> Vec<u8> {
    binout_of(MASS_KG, states(), is_little)
}

fn binout_of(mass_kg: f64, states: impl Iterator<Item = (f64, [f64; 4])>, is_little: bool) -> Vec<u8> {
    let mut file = Lsda::new(is_little);
    file.folder("/nodout/metadata");
    file.text("title", &format!("{:80}", "known motion"));
    file.text("version", "smp d R12   ");
    file.ids("ids", &[7, 9]);
    // In another order than the ids.
    file.ids("legend_ids", &[9, 7]);
    file.text("legend", &format!("{:80}{:80}", "ENGINE TOP", "REAR SILL"));
    file.folder("/rwforc/forces/metadata");
    file.ids("ids", &[1]);
    file.table();
    for (k, (t, [d, v, a, force])) in states.enumerate() {
        file.folder(&format!("/nodout/d{:06}", k + 1));
        file.floats("time", &[t]);
        for (name, x) in [("x_displacement", d), ("x_velocity", v), ("x_acceleration", a)] {
            file.floats(name, &[x, 1.1 * x]);
        }
        file.folder(&format!("../../rwforc/forces/d{:06}", k + 1));
        file.floats("time", &[t]);
        file.floats("x_force", &[-force]);
        file.folder(&format!("/glstat/d{:06}", k + 1));
        file.floats("time", &[t]);
        file.floats("kinetic_energy", &[0.5 * mass_kg * v * v]);
        file.floats("global_x_velocity", &[v]);
        file.table();
    }
    file.out
}

/// A test and a simulation of another car, by the exact motion of its force-deflection curve, and what is true of both.
pub struct FaultySimulation {
    /// Time, deceleration of the car and force of the wall, mass and speed stated.
    pub test: String,
    /// In mm, ms, kg; the wall is met after 3 ms.
    pub binout: Vec<u8>,
    /// Dynamic crush of test and simulation, m.
    pub crush_m: [f64; 2],
}

/// 1,240 kg at 14 m/s. The force of the simulation is 25 % too low from 300 mm of crush on.
///
/// # Errors
/// None: the curves are sound.
pub fn faulty_simulation() -> Result<FaultySimulation, crumple_lumped::LumpedError> {
    const CAR_KG: f64 = 1240.0;
    const CAR_M_PER_S: f64 = 14.0;
    const GAP_MS: f64 = 3.0;
    let motion = |low: f64, dt_s: f64, count: usize| {
        let knots =
            [(0.05, 9e4), (0.15, 1.4e5), (0.28, 1.9e5), (0.32, 1.95e5 * low), (0.5, 2.6e5 * low), (0.9, 4e5 * low)];
        let structure = CrushedStructure::new(CAR_KG, &knots, 2e7, 0.0)?;
        Model::ForceDeflection(structure).respond(CAR_M_PER_S, dt_s, count)
    };
    let crush_m =
        |response: &crumple_lumped::Response| response.compartment().displacement_m.iter().copied().fold(0.0, f64::max);
    let (of_test, simulated) = (motion(1.0, 1e-4, 1400)?, motion(0.75, 2e-4, 700)?);
    let mut test = format!("# mass: {CAR_KG} kg\n# impact speed: {CAR_M_PER_S} m/s\n# time zero: 0 s\n");
    test.push_str("time_s,accel (m/s^2),wall force (kN)\n");
    let felt = of_test.compartment().acceleration_m_per_s2.iter().enumerate().map(|(k, a)| (k as f64, *a));
    for (k, a) in (-300..0).map(|k| (f64::from(k), 0.0)).chain(felt) {
        test.push_str(&format!("{:.4},{a},{}\n", 1e-4 * k, -1e-3 * CAR_KG * a));
    }
    let car = simulated.compartment();
    let before = (0..15).map(|k| 0.2 * f64::from(k)).map(|t| (t, [CAR_M_PER_S * t, CAR_M_PER_S, 0.0, 0.0]));
    let after = (0..car.velocity_m_per_s.len()).map(|k| {
        let a = 1e-3 * car.acceleration_m_per_s2[k];
        let way = 1e3 * car.displacement_m[k] + CAR_M_PER_S * GAP_MS;
        (GAP_MS + 0.2 * k as f64, [way, car.velocity_m_per_s[k], a, -CAR_KG * a])
    });
    let binout = binout_of(CAR_KG, before.chain(after), true);
    Ok(FaultySimulation { test, binout, crush_m: [crush_m(&of_test), crush_m(&simulated)] })
}

/// A binout of so many nodes, of which the first three have titles, and so many states up to 150 ms; piece by piece,
/// since it may be longer than the memory. Node `k` moves 1 + k / 1e6 times as far.
///
/// # Errors
/// Of what is written to.
pub fn write_large_binout(out: &mut impl Write, nodes: u64, states: usize) -> io::Result<()> {
    let mut head = Lsda::new(true);
    head.folder("/nodout/metadata");
    head.text("title", &format!("{:80}", "known motion of many nodes"));
    head.text("version", "smp d R12   ");
    head.ids("ids", &(1..=nodes).collect::<Vec<_>>());
    head.ids("legend_ids", &[1, 2, 3]);
    head.text("legend", &format!("{:80}{:80}{:80}", "REAR SILL LEFT", "REAR SILL RIGHT", "ENGINE TOP"));
    head.table();
    let mut before = head;
    for k in 0..states {
        let t = 150.0 * k as f64 / (states - 1) as f64;
        let [d, v, a, _] = motion(t);
        let start = before.start + before.out.len();
        let mut state = Lsda { start, out: Vec::new(), is_little: true, symbols: Vec::new(), link: usize::MAX - 8 };
        state.folder(&format!("/nodout/d{:06}", k + 1));
        state.floats("time", &[t]);
        for (what, x) in [("displacement", d), ("velocity", v), ("acceleration", a), ("coordinate", d)] {
            for (axis, share) in [("x", 1.0), ("y", 0.01), ("z", -0.01)] {
                let values: Vec<f64> = (0..nodes).map(|node| share * x * (1.0 + 1e-6 * node as f64)).collect();
                state.floats(&format!("{axis}_{what}"), &values);
            }
        }
        let table = start + state.out.len();
        state.table();
        before.link_to(table);
        out.write_all(&before.out)?;
        before = state;
    }
    out.write_all(&before.out)
}

/// The text nodout of the node 7.
pub fn nodout() -> String {
    let mut text = " known motion\n                         ls-dyna smp.1       date 1/1/2026\n\n\n".to_owned();
    for (t, [d, v, a, _]) in states() {
        text.push_str(&format!(
            "\n n o d a l   p r i n t   o u t   f o r   t i m e  s t e p  1  ( at time {} )\n\n",
            fortran(t, 7)
        ));
        text.push_str(" nodal point  x-disp     y-disp\n        7");
        for (k, x) in [d, 0.0, 0.0, v, 0.0, 0.0, a, 0.0, 0.0, d, 0.0, 0.0].into_iter().enumerate() {
            text.push_str(&format!("{:>1$}", fortran(x, 4), if k == 0 { 13 } else { 12 }));
        }
        text.push('\n');
    }
    text
}

/// The text rwforc of the wall.
pub fn rwforc() -> String {
    let rows = states().map(|(t, [.., force])| {
        let force = format!("{:>15}", fortran(-force, 6));
        format!(
            " {}       1{:>15}{force}{:>15}{:>15}\n",
            fortran(t, 5),
            fortran(0.0, 6),
            fortran(0.0, 6),
            fortran(0.0, 6)
        )
    });
    let head = " known motion\n                         ls-dyna smp.1       date 1/1/2026\n\n\n";
    format!(
        "{head}    time       wall#   normal-force    x-force        y-force        z-force\n{}",
        rows.collect::<String>()
    )
}

/// A number as Fortran prints it: `-1.2345E+02`.
fn fortran(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    format!("{mantissa}E{}{:02}", if exponent < 0 { '-' } else { '+' }, exponent.abs())
}

/// A T01 of code 4021 with its units, its titles apart: node 7, and wall 1 with the impulse of the force.
pub fn t01() -> Vec<u8> {
    fn record(out: &mut Vec<u8>, content: &[u8]) {
        let length = (content.len() as u32).to_be_bytes();
        out.extend([&length[..], content, &length].concat());
    }
    let whole = |numbers: &[i32]| numbers.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<u8>>();
    let floats = |numbers: &[f64]| numbers.iter().flat_map(|x| (*x as f32).to_be_bytes()).collect::<Vec<u8>>();
    let titled = |front: &[i32], title: &str| [whole(front), format!("{title:100}").into_bytes()].concat();
    let mut out = Vec::new();
    record(&mut out, &[whole(&[4021]), format!("{:80}", "known motion").into_bytes()].concat());
    record(&mut out, format!("{:80}", "1 Jan 2026 RADIOSS").as_bytes());
    record(&mut out, &whole(&[2]));
    record(&mut out, &whole(&[100]));
    record(&mut out, &floats(&[1.0, 1e-3, 1e-3]));
    record(&mut out, &whole(&[0, 0, 0, 0, 2, 7]));
    record(&mut out, &whole(&[1, 2, 3, 4, 5, 6, 7]));
    record(&mut out, &titled(&[1, 0, 1, 1, 9], "nodes"));
    record(&mut out, &titled(&[7], "REAR SILL"));
    record(&mut out, &whole(&[1, 2, 3, 4, 5, 6, 7, 8, 9]));
    record(&mut out, &titled(&[2, 102, 1, 1, 6], "walls"));
    record(&mut out, &titled(&[1], "rigid wall"));
    record(&mut out, &whole(&[1, 2, 3, 4, 5, 6]));
    for (t, [d, v, a, _]) in states() {
        let energy = 0.5 * MASS_KG * v * v;
        record(&mut out, &floats(&[t]));
        record(&mut out, &floats(&[0.0, energy, MASS_KG * v, 0.0, 0.0, MASS_KG, 1e-3]));
        record(&mut out, &floats(&[d, 0.0, 0.0, v, 0.0, 0.0, a, 0.0, 0.0]));
        record(&mut out, &floats(&[MASS_KG * (SPEED_M_PER_S - v), 0.0, 0.0, 0.0, 0.0, 0.0]));
    }
    out
}
