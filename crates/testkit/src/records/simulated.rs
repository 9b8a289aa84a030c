//! Files of a crash simulation of known motion: a mass that meets a spring at a wall, exact at every state.
//!
//! 1,000 kg at 15 m/s touch the wall after 5 ms; from then on x = v/w sin(w t), w = pi / 100 ms, until the mass leaves
//! it at 105 ms. States every millisecond to 120 ms. Files are in mm, ms, kg.

use std::f64::consts::PI;

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

/// A binout in the making: values, and the symbols of the next table.
struct Lsda {
    out: Vec<u8>,
    is_little: bool,
    symbols: Vec<u8>,
    /// Where the place of the next table is to be written.
    link: usize,
}

impl Lsda {
    fn new(is_little: bool) -> Self {
        let mut file =
            Self { out: vec![8, 8, 8, 1, 1, u8::from(is_little), 0, 0], is_little, symbols: Vec::new(), link: 17 };
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
        let at = self.out.len() as u64;
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

    fn table(&mut self) {
        let (at, symbols) = (self.out.len(), std::mem::take(&mut self.symbols));
        let place = self.whole(at as u64);
        self.out[self.link..self.link + 8].copy_from_slice(&place);
        self.out.extend(self.whole((9 + symbols.len() + 17) as u64));
        self.out.push(5);
        self.out.extend(symbols);
        self.out.extend(self.record(6, &[0; 8]));
        self.link = self.out.len() - 8;
    }
}

/// A binout: nodes 7 (the car) and 9 (an engine that goes ahead with 1.1 times the motion), wall 1, glstat.
pub fn binout(is_little: bool) -> Vec<u8> {
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
    for (k, (t, [d, v, a, force])) in states().enumerate() {
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
        file.floats("kinetic_energy", &[0.5 * MASS_KG * v * v]);
        file.floats("global_x_velocity", &[v]);
        file.table();
    }
    file.out
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
