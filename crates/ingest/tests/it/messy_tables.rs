//! Tables as Excel, MATLAB and people write them: each is read right, or refused with advice that works when followed.
//!
//! All hold one pulse: half a sine of -25 g over 90 ms, 5 kHz from -50 ms to 150 ms, as its program would print it.

use crumple_ingest::{Bundle, IngestError, Ingested, list};
use crumple_signal::{Axis, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};

use crate::{given, notes, read_as};

pub const ROWS: usize = 1000;
const DT_S: f64 = 2e-4;
pub const FACTS: &str = "# mass: 1200 kg\n# impact speed: 50 km/h\n";

pub fn time_s(k: usize) -> f64 {
    -0.05 + k as f64 * DT_S
}

pub fn accel_g(k: usize) -> f64 {
    let t = time_s(k);
    if (0.0..0.09).contains(&t) { -25.0 * (std::f64::consts::PI * t / 0.09).sin() } else { 0.0 }
}

/// Rows as `line` writes them from time in s and acceleration in g.
pub fn rows(line: impl Fn(usize, f64, f64) -> String) -> String {
    (0..ROWS).map(|k| line(k, time_s(k), accel_g(k)) + "\n").collect()
}

/// Rows under the names of their columns.
pub fn headed(names: &str, line: impl Fn(usize, f64, f64) -> String) -> String {
    format!("{names}\n{}", rows(line))
}

pub fn plain() -> String {
    rows(|_, t, a| format!("{t:.4},{a:.4}"))
}

pub fn comma(number: String) -> String {
    number.replace('.', ",")
}

/// `-50,000`: whole microseconds with their thousands apart.
fn thousands(t_s: f64) -> String {
    let us = (t_s * 1e6).round() as i64;
    let (sign, us) = (if us < 0 { "-" } else { "" }, us.abs());
    if us < 1000 { format!("{sign}{us}") } else { format!("{sign}{},{:03}", us / 1000, us % 1000) }
}

pub fn read(text: impl Into<Vec<u8>>, flags: &str) -> Result<Ingested, IngestError> {
    read_as("a.csv", text, &given(flags))
}

#[track_caller]
pub fn check_pulse(name: &str, ingested: &Ingested, t0_s: f64) {
    let Some(pulse) = ingested.pulse() else { panic!("{name}: no pulse") };
    let wave = &pulse.samples;
    assert_eq!(wave.len(), ROWS, "{name}");
    assert!((wave.t0_s() - t0_s).abs() < 1e-12 && (wave.dt_s() - DT_S).abs() < 1e-15, "{name}: {wave:?}");
    // Four printed decimals of g at least.
    let worst = (0..ROWS).map(|k| (wave.samples()[k] - G * accel_g(k)).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-4 * G, "{name}: {worst}");
}

/// The flags, and contact at the file's t = 0 where they state none: the axis of the rows is compared.
fn of_file(flags: &str) -> String {
    if flags.contains("--time-zero") { flags.to_owned() } else { format!("{flags} --time-zero-rule file") }
}

/// Name, text below the facts, flags, time of the first row in s.
pub type Table = (&'static str, String, &'static str, f64);

/// Reads tables of the pulse, names aside what each comes to.
pub fn are_read_right(tables: Vec<Table>) -> Vec<(&'static str, Ingested)> {
    let check = |(name, text, flags, t0_s): Table| {
        let ingested = read(format!("{FACTS}{text}"), &of_file(flags));
        let ingested = ingested.unwrap_or_else(|error| panic!("{name}: {error} (hint: {})", error.hint()));
        check_pulse(name, &ingested, t0_s);
        (name, ingested)
    };
    tables.into_iter().map(check).collect()
}

#[test]
fn these_are_read_right() {
    let header = "time_s,accel_g";
    let quoted_us = rows(|_, t, a| format!("\"{}\",\"{a:.4}\"", thousands(t)));
    let german = rows(|_, t, a| comma(format!("{t:.4};{a:.4}")));
    let tables = [
        ("blank used-range columns", format!("{header},,,\n{}", plain().replace('\n', ",,,\n"))),
        ("blank columns and blank last rows", format!("{header},,\n{},,,\n,,,\n", plain().replace('\n', ",,\n"))),
        ("a last row of commas", format!("{header}\n{},\n", plain())),
        ("a used range that starts in column B", headed(",time_s,accel_g", |_, t, a| format!(",{t:.4},{a:.4}"))),
        ("a blank column between", headed("time_s,,accel_g", |_, t, a| format!("{t:.4},,{a:.4}"))),
        ("a remark column without remarks", format!("{header},remark\n{}", plain().replace('\n', ",\n"))),
        ("semicolons below the last row", format!("Zeit [s];a [g]\n{german};\n;\n")),
        ("MATLAB comment header", headed("% t [s]   a [g]", |_, t, a| format!("   {t:.7e}   {a:.7e}"))),
        ("MATLAB header, single blanks", headed("% t [s] a [g]", |_, t, a| format!("{t:.4} {a:.4}"))),
        ("names of several words", headed("Time [s] Vehicle acceleration [g]", |_, t, a| format!("{t:.4}\t{a:.4}"))),
        ("names and units by turns", headed("Time s Accel g", |_, t, a| format!("{t:.4} {a:.4}"))),
        ("quoted thousands of microseconds", format!("\"time (us)\",\"accel (g)\"\n{quoted_us}")),
        ("thousands between tabs", headed("time [us]\taccel [g]", |_, t, a| format!("{}\t{a:.4}", thousands(t)))),
        ("a byte-order mark", format!("\u{feff}{header}\n{}", plain())),
        ("semicolons and decimal commas", format!("Zeit [s];Beschleunigung [g]\n{german}")),
        ("Excel's sep line", format!("sep=;\nt [s];a [g]\n{german}")),
        ("a units row", format!("Time,Accel\ns,g\n{}", plain())),
        ("a units row and a row of remarks", format!("Time,Accel\n(s),(g)\nrecorder,B-pillar\n{}", plain())),
        ("a title, names, units", format!("Test 12;;\nZeit;a;\ns;g;\n{}", german.replace('\n', ";\n"))),
        ("header cells broken into lines", format!("\"Time\n(s)\",\"Accel\n(g)\"\n{}", plain())),
        ("a footer of statistics", format!("{header}\n{}Minimum,-25.0\nEnd of data\n", plain())),
        ("a footer after a blank line", format!("{header}\n{}\n\"Exported by X\",\n", plain())),
        ("NaN rows at both ends", format!("{header}\nNaN,NaN\n{}0.15,NaN\nNaN,NaN\n", plain())),
        ("a count beside the time", headed("Sample,time_s,accel_g", |k, t, a| format!("{k},{t:.4},{a:.4}"))),
        ("a time column given twice", headed("time_s,accel_g,time_s", |_, t, a| format!("{t:.4},{a:.4},{t:.4}"))),
        ("minus signs of a word processor", format!("{header}\n{}", plain().replace('-', "\u{2212}"))),
        ("every number in quotes", headed("\"time_s\",\"accel_g\"", |_, t, a| format!("\"{t:.4}\",\"{a:.4}\""))),
        ("old line ends and blanks around", headed("time_s,accel_g", |_, t, a| format!(" {t:.4} , {a:.4} \r"))),
        ("blank rows between header and numbers", format!("{header}\n,\n,\n{}", plain())),
        ("kilo-g", headed("time_s,accel_kg", |_, t, a| format!("{t:.4},{:.8}", a / 1e3))),
        ("Fortran exponents", headed("time_s,accel_g", |_, t, a| format!("{t:.6e},{a:.6e}").replace('e', "D"))),
    ];
    assert!(tables.len() >= 30);
    for (name, ingested) in are_read_right(tables.map(|(name, text)| (name, text, "", -0.05)).into()) {
        assert_eq!(ingested.waves.len(), 1, "{name}");
    }
}

/// A number of `decimals` digits behind `point`, with `apart` between its thousands.
fn grouped(x: f64, apart: &str, point: &str, decimals: usize) -> String {
    let text = format!("{:.decimals$}", x.abs());
    let (whole, part) = text.split_once('.').unwrap_or((&text, ""));
    let groups: Vec<&str> =
        whole.as_bytes().rchunks(3).rev().map(|group| std::str::from_utf8(group).unwrap()).collect();
    let point = if part.is_empty() { "" } else { point };
    format!("{}{}{point}{part}", if x < 0.0 { "-" } else { "" }, groups.join(apart))
}

/// What other programs export: each as it is, but for the bytes of UTF-16 and Latin-1.
fn exports_of_other_programs() -> Vec<(String, Vec<u8>)> {
    let header = "time_s,accel_g";
    let german = rows(|_, t, a| comma(format!("{t:.4};{a:.4}")));
    let micro = |apart: &'static str, point: &'static str| {
        let line = move |t: f64, a: f64| {
            format!("{};{}", grouped(t * 1e6, apart, point, 1), grouped(a * 1e3, apart, point, 1))
        };
        headed("time [us];accel [mg]", |_, t, a| line(t, a))
    };
    let mut tables = vec![
        ("tabs and decimal commas", format!("Zeit [s]\ta [g]\n{}", german.replace(';', "\t"))),
        ("Zeit in ms", headed("Zeit in ms;a in g", |_, t, a| comma(format!("{:.1};{a:.4}", t * 1e3)))),
        ("errors of Excel at both ends", format!("{header}\n-0.0502,#N/A\n{}0.1500,#DIV/0!\n", plain())),
        ("missing values of C on Windows", format!("{header}\n-0.0502,1.#QNAN\n{}0.1500,-1.#IND\n", plain())),
        ("dashes for no value", format!("{header}\n-0.0502,-\n{}0.1500,-\n", plain())),
        ("thousands of Switzerland", micro("'", ".")),
        ("thousands apart by a hard blank", micro("\u{a0}", ",")),
        ("thousands apart by a narrow blank", micro("\u{202f}", ",")),
        ("thousands apart by a blank", micro(" ", ",")),
        ("thousands apart by points", micro(".", ",")),
        ("thousands apart by commas, semicolons between", micro(",", ".")),
        ("decimal commas with exponents", headed("t [s];a [g]", |_, t, a| comma(format!("{t:.6E};{a:.6E}")))),
        ("pandas with its index", headed(",time_s,accel_g", |k, t, a| format!("{k},{t:.4},{a:.4}"))),
        ("R's write.csv", headed("\"\",time_s,accel_g", |k, t, a| format!("\"{}\",{t:.4},{a:.4}", k + 1))),
        ("numpy's savetxt", headed("# time_s accel_g", |_, t, a| format!("{t:.18e} {a:.18e}"))),
        ("Origin", format!("Time\tAccel\ns\tg\nrun 3\tB-pillar\n{}", plain().replace(',', "\t"))),
        ("a row of formulas", format!("{header}\n{}=MIN(A2:A1001),=MIN(B2:B1001)\n", plain())),
        ("an extreme without a time below", format!("{header}\n{},-25.0000\n", plain())),
        ("milliseconds without a unit", headed("Time,accel_g", |_, t, a| format!("{:.1},{a:.4}", t * 1e3))),
        ("plus signs", headed("time_s,accel_g", |_, t, a| format!("{t:+.4},{a:+.4}"))),
        ("line ends of two systems", format!("{header}\r\n{}", plain().replace("5\n", "5\r\n"))),
        ("blocks of zeros of a logger", format!("{header}\n{}{}", plain(), "\0".repeat(4096))),
        ("an end mark of DOS", format!("{header}\n{}\u{1a}", plain())),
        ("a mark inside the quotes", format!("\"\u{feff}time_s\",\"accel_g\"\n{}", plain())),
        ("empty fields between all", format!("time_s;;accel_g\n{}", plain().replace(',', ";;"))),
        ("the time last", headed("accel_g,time_s", |_, t, a| format!("{a:.4},{t:.4}"))),
        ("columns of equal width", headed("   time_s     accel_g", |_, t, a| format!("{t:9.4}{a:12.4}"))),
        ("form feeds between pages", format!("{header}\n{}", plain().replace("\n0.0", "\n\u{c}0.0"))),
    ];
    let units =
        [("m·s⁻²", G), ("m/s**2", G), ("m/s/s", G), ("cm/s²", 1e2 * G), ("Gal", 1e2 * G), ("in/s^2", G / 0.0254)];
    for (unit, factor) in units {
        let text = rows(|_, t, a| format!("{t:.4};{:.6}", a * factor));
        tables.push((unit, format!("time [s];accel [{unit}]\n{text}")));
    }
    let mut tables: Vec<(String, Vec<u8>)> =
        tables.into_iter().map(|(name, text)| (name.to_owned(), format!("{FACTS}{text}").into_bytes())).collect();
    tables.push(("old line ends alone".to_owned(), format!("{FACTS}{header}\n{}", plain()).replace('\n', "\r").into()));
    let wide = |order: fn(u16) -> [u8; 2]| {
        let text = format!("\u{feff}{FACTS}time [s]\taccel [g]\n{}", plain().replace(',', "\t"));
        text.encode_utf16().flat_map(order).collect()
    };
    tables.push(("Unicode text of Excel".to_owned(), wide(u16::to_le_bytes)));
    tables.push(("the same from the other end".to_owned(), wide(u16::to_be_bytes)));
    let latin = format!("{FACTS}Zeit [s];a [m/s²]\n{}", rows(|_, t, a| comma(format!("{t:.4};{:.5}", a * G))));
    tables.push(("Latin-1".to_owned(), latin.chars().map(|c| c as u8).collect()));
    tables
}

#[test]
fn exports_of_other_programs_are_read_right() {
    let tables = exports_of_other_programs();
    assert!(tables.len() >= 38);
    for (name, text) in tables {
        let ingested = read(text, "").unwrap_or_else(|error| panic!("{name}: {error} (hint: {})", error.hint()));
        check_pulse(&name, &ingested, -0.05);
        assert_eq!(ingested.waves.len(), 1, "{name}");
        let stated = (ingested.test.mass_kg, ingested.test.impact_speed_m_per_s);
        assert_eq!(stated, (Some(1200.0), Some(50.0 / 3.6)), "{name}");
    }
}

/// A table that is refused, words of the refusal and of its advice, and the table and flags of one who followed it,
/// with the time of its first row where it holds the pulse.
pub struct Refused {
    pub name: &'static str,
    pub text: String,
    pub said: &'static str,
    pub advice: &'static str,
    pub followed: (String, &'static str),
    pub t0_s: Option<f64>,
}

/// What the refusal says, and what the advice comes to.
pub fn is_refused(
    Refused { name, text, said, advice, followed: (followed, flags), t0_s }: Refused,
) -> (String, Ingested) {
    let error = read(text, "").err().unwrap_or_else(|| panic!("{name} is read"));
    assert!(error.to_string().contains(said), "{name}: {error}");
    assert!(error.hint().contains(advice), "{name}: {error} (hint: {})", error.hint());
    assert!(error.expected().is_some_and(|expected| !expected.is_empty()), "{name}");
    let ingested =
        read(followed, &of_file(flags)).unwrap_or_else(|error| panic!("{name}, followed: {error} ({})", error.hint()));
    if let Some(t0_s) = t0_s {
        check_pulse(name, &ingested, t0_s);
    }
    (format!("{error} {} {}", error.expected().unwrap_or_default(), error.hint()), ingested)
}

const INTERVAL: &str = "--sample-time 200us";

fn refused() -> Vec<Refused> {
    let header = "time_s,accel_g";
    let same = |text: &str, flags| (text.to_owned(), flags);
    let good = || (format!("{header}\n{}", plain()), "");
    let counted =
        |name: &str, from: usize| format!("{name},accel_g\n{}", rows(|k, _, a| format!("{},{a:.4}", k + from)));
    let mut tables = Vec::new();
    let mut add = |name, text: String, advice, followed, t0_s| {
        tables.push(Refused { name, text, said: "", advice, followed, t0_s: Some(t0_s) });
    };
    for (title, from) in [("Sample", 0), ("Index", 1), ("\"#\"", 1), ("No.", 1), ("lfd. Nr.", 17)] {
        let text = counted(title, from);
        add(title, text.clone(), "--sample-time 100us", same(&text, INTERVAL), 0.0);
    }
    let text = rows(|k, _, a| format!("{k},{a:.4}"));
    let followed = same(&text, "--sample-time 200us --unit g");
    add("a bare count without names", text, "--sample-time 100us", followed, 0.0);
    let text = counted("time", 0);
    add("a count named time", text.clone(), "--sample-time 100us", same(&text, INTERVAL), 0.0);
    let text = headed("accel_g,accel_y_g", |k, _, a| format!("{a:.4},{:.3}", (k % 7) as f64));
    let followed = same(&text, "--sample-time 200us --channel accel_g");
    add("no time column", text, "--sample-time 100us", followed, 0.0);
    let text = headed("accel_g", |_, _, a| format!("{a:.4}"));
    add("one column", text.clone(), "--sample-time", same(&text, INTERVAL), 0.0);
    let text = format!("abscissa,accel_g\n{}", plain());
    let followed = same(&text, "--time-unit s");
    add("a first column that does not say it is the time", text, "--time-unit s", followed, -0.05);
    let text = format!("# mass: 1200 kg\n# mass: 1300 kg\n{header}\n{}", plain());
    let kept = text.replace("# mass: 1300 kg\n", "");
    add("two masses", text.clone(), "remove the line that is wrong", same(&kept, ""), -0.05);
    let followed = same(&text, "--mass 1200kg");
    add("two masses, settled by the flag", text, "--mass says which counts", followed, -0.05);
    let text = format!("# impact speed: 50 km/h\n# impact speed: 60 km/h\n{header}\n{}", plain());
    let kept = text.replace("# impact speed: 60 km/h\n", "");
    add("two speeds", text, "remove the line that is wrong", same(&kept, ""), -0.05);
    let text = format!("time_s,accel_g\ns,m/s^2\n{}", plain());
    let followed = same(&text.replace("m/s^2", "g"), "");
    add("two units of a column", text, "correct line 1 or line 2", followed, -0.05);
    let text = format!("# time unit: ms\n{header}\n{}", plain());
    add("two units of time", text.clone(), "--time-unit says which counts", same(&text, "--time-unit s"), -0.05);
    let text = good().0.replace("\n0.0450,-25.0000\n", "\n0.0450,-250000\n");
    add("a lost decimal point", text, "correct that sample", good(), -0.05);
    let text = good().0.replace("\n0.0450,-25.0000\n", "\n0.0450,-17358168352340407\n");
    add("a lost decimal point of many digits", text, "correct that sample", good(), -0.05);
    let text = format!("{header}\n{}", plain()).replace("\n0.0100,", "\n,\n0.0100,").replace("\n,\n", "\n0.0099,\n");
    add("a gap inside", text.clone(), "export without that column", good(), -0.05);
    let text = headed("time_s,accel_g", |_, t, a| format!("{t:.4},{a:.4} g"));
    add("a unit behind every number", text, "without the unit behind them", good(), -0.05);
    let text =
        headed("time_s,accel_g", |_, t, a| comma(format!("{t:.4},{a:.4}").replacen(',', ";", 1)).replace(';', ","));
    let followed = (headed("t [s];a [g]", |_, t, a| comma(format!("{t:.4};{a:.4}"))), "");
    add("decimal commas between commas", text, "with semicolons or tabs", followed, -0.05);
    let text = headed("time [us],accel [mg]", |_, t, a| format!("\"{}\",{:.0}", thousands(t), a * 1e3));
    let plain_numbers = headed("time [us],accel [mg]", |_, t, a| format!("{:.0},{:.1}", t * 1e6, a * 1e3));
    add("thousands or decimals", text, "without thousands separators", (plain_numbers, ""), -0.05);
    let text = headed("time_s,Time 2 (ms),accel_g", |k, t, a| format!("{t:.4},{:.4},{a:.4}", k as f64));
    add("two time columns", text, "into a file of their own", good(), -0.05);
    let transposed = format!(
        "{}\n{}\n",
        (0..ROWS).map(|k| format!("{:.4}", time_s(k))).collect::<Vec<_>>().join(","),
        (0..ROWS).map(|k| format!("{:.4}", accel_g(k))).collect::<Vec<_>>().join(",")
    );
    add("samples in one row", transposed, "export the transpose", good(), -0.05);
    tables
}

/// What is damaged, in another order, or as another program prints it.
fn refused_exports() -> Vec<Refused> {
    let header = "time_s,accel_g";
    let good = format!("{header}\n{}", plain());
    let lines: Vec<String> = plain().lines().map(|line| format!("{line}\n")).collect();
    let mut tables = Vec::new();
    let mut add = |name, text: String, advice, followed: &str, flags| {
        tables.push(Refused {
            name,
            text,
            said: "",
            advice,
            followed: (followed.to_owned(), flags),
            t0_s: Some(-0.05),
        });
    };
    let with = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        good.replacen(from, to, 1)
    };
    add("a word", with(",-25.0000", ",abc"), "write the number that belongs there", &good, "");
    add("a remark behind a number", with("-25.0000", "-25.0000 # peak"), "write the number that", &good, "");
    add("an error of Excel inside", with("-25.0000", "#DIV/0!"), "fill the gap in the program", &good, "");
    add("a field too many", with("-25.0000", "-25.0000,peak"), "mend the line", &good, "");
    add("a row without its value", with("\n0.0450,-25.0000", "\n0.0450"), "mend the line", &good, "");
    add(
        "a row that is there twice",
        with("\n0.0450,", "\n0.0450,-25.0000\n0.0450,"),
        "remove the row that is",
        &good,
        "",
    );
    let coarse = headed("time_s,accel_g", |_, t, a| format!("{t:.3},{a:.4}"));
    add("times of too few decimals", coarse, "export more of them", &good, "");
    let backwards: String = lines.iter().rev().map(String::as_str).collect();
    add("rows from the end to the start", format!("{header}\n{backwards}"), "sort them by time", &good, "");
    let mut shuffled = lines.clone();
    shuffled.swap(300, 301);
    add("two rows exchanged", format!("{header}\n{}", shuffled.concat()), "sort the rows by time", &good, "");
    add("two recordings", format!("{good}{}", plain()), "split the file there", &good, "");
    let pages: String = lines.chunks(100).map(|page| format!("{header}\n{}", page.concat())).collect();
    add("names on every page", pages, "remove such lines between the rows", &good, "");
    let gap = with("-0.0100,0.0000\n", "");
    add("a row that is missing", gap.clone(), "--resample 5000Hz", &gap, "--resample 5kHz");
    let brackets = |a: f64| if a < 0.0 { format!("({:.4})", -a) } else { format!("{a:.4}") };
    let behind = |a: f64| if a < 0.0 { format!("{:.4}-", -a) } else { format!("{a:.4}") };
    let text = headed("time_s,accel_g", |_, t, a| format!("{t:.4},{}", brackets(a)));
    add("negative numbers in brackets", text, "with their sign in front", &good, "");
    let text = headed("time_s,accel_g", |_, t, a| format!("{t:.4},{}", behind(a)));
    add("signs behind", text, "with their sign in front", &good, "");
    let text = headed("time_s,accel_g", |_, t, a| format!("{t:.4}s,{a:.4}g"));
    add("a unit behind every number of all columns", text, "without the unit behind them", &good, "");
    let numbered = rows(|k, t, a| format!("{} {t:.4} {a:.4}", k + 1));
    let (bare, named) = (format!("time_s accel_g\n{numbered}"), format!("row time_s accel_g\n{numbered}"));
    add("R's write.table", bare.clone(), "put \"row\" in front of the names", &named, "");
    add("R's write.table, written again", bare, "row.names = FALSE", &good.replace(',', " "), "");
    let shown = rows(|_, t, a| format!("   {:.7}   {:.7}", t / 1e3, a / 1e3));
    let text = format!("% t [s]  a [g]\n   1.0e+03 *\n\n{shown}");
    add("MATLAB's display", text, "multiply all columns and remove that line", &good, "");
    let text = format!("Var1,Var2\n{}", plain());
    add("names of MATLAB's tables", text.clone(), "--time-unit s", &text, "--unit g --time-unit s");
    let text = format!("s,g\ntime,accel\n{}", plain());
    add("units above the names", text.clone(), "add --unit g", &text, "--unit g");
    add("lines between the fields", good.replace(',', "|"), "between commas, semicolons, tabs", &good, "");
    let text = format!("# mass: 1,200 kg\n{good}");
    add("thousands of kilograms", text.clone(), "correct the comment line", &text.replace("1,2", "12"), "");
    add(
        "a mass without its unit",
        format!("# mass: 1200\n{good}"),
        "remove it and use the flag",
        &good,
        "--mass 1200kg",
    );
    let text = headed("time_s,accel_g,b_v", |k, t, a| {
        let gap = format!("{t:.4},{a:.4},1");
        if k == 600 { gap.replace(&format!("{a:.4}"), "") } else { gap }
    });
    add("a gap in the column that is needed", text, "export without that column", &good, "");
    let text = format!("{header}\n{}end of the first\nsecond\n{}", plain(), plain());
    add("two curves", text, "--skip-to \"second\" takes the second one", &good, "");
    tables
}

#[test]
fn these_are_refused_with_advice_that_works() {
    refused().into_iter().chain(refused_exports()).for_each(|refused| drop(is_refused(refused)));
}

#[test]
fn a_list_shows_no_rate_that_nobody_stated() {
    for text in ["Sample,accel_g\n", "Index,accel_g\n", "time,accel_g\n"] {
        let text = format!("{text}{}", rows(|k, _, a| format!("{k},{a:.4}")));
        let bundle = || Bundle::from_bytes("a.csv", text.clone().into_bytes()).unwrap();
        let listed = list(&bundle(), &given("")).unwrap();
        assert!(listed.iter().any(|line| line.id == "accel_g" && line.rate_hz.is_none()), "{listed:?}");
        let listed = list(&bundle(), &given(INTERVAL)).unwrap();
        assert_eq!((listed.len(), listed[0].rate_hz), (1, Some(5000.0)));
    }
}

/// Nanoseconds since 1970 of a row.
pub fn since_1970_ns(t: f64) -> i64 {
    1_718_030_736_872_695_300 + ((t + 0.05) * 1e9).round() as i64
}

#[test]
fn a_time_zero_may_be_on_the_calendar() {
    let text = headed("time_ns,accel_g", |_, t, a| format!("{},{a:.4}", since_1970_ns(t)));
    let ingested = read(format!("{FACTS}{text}"), "--time-zero 1718030736.9226953s").unwrap();
    // Seconds since 1970 are kept to 0.24 us.
    assert!((ingested.pulse().unwrap().samples.t0_s() + 0.05).abs() < 5e-7);
}

#[test]
fn advice_leads_from_the_unit_to_the_column_and_to_the_head() {
    let rows = rows(|_, t, a| format!("{t:.4},{a:.4},0,1"));
    let text = format!("time_s,x,y,z\n{rows}");
    let error = read(text.clone(), "").unwrap_err();
    assert!(error.hint().contains("add --unit g"), "{}", error.hint());
    let error = read(text.clone(), "--unit g").unwrap_err();
    assert!(error.hint().starts_with("add --channel x, for example"), "{error}: {}", error.hint());
    check_pulse("x", &read(text, "--unit g --channel x").unwrap(), -0.05);
    let error = read(rows.clone(), "--unit g").unwrap_err();
    assert!(error.hint().contains("--place head"), "{}", error.hint());
    let head = read(rows, "--unit g --place head").unwrap();
    let channels: Vec<_> = head.test.channels.iter().map(|c| (c.location.as_str(), c.axis)).collect();
    let along = |axis| ("head", Some(axis));
    assert_eq!(channels, [along(Axis::X), along(Axis::Y), along(Axis::Z)]);
}

#[test]
fn a_velocity_only_table_is_read_as_one() {
    let v = |t: f64| if t < 0.0 { 50.0 } else { 50.0 - 600.0 * t };
    let text = headed("time_s,velocity_km_per_h", |_, t, _| format!("{t:.4},{:.4}", v(t)));
    let ingested = read(text.clone(), "").unwrap();
    let pulse = ingested.pulse().unwrap();
    assert_eq!((pulse.quantity, pulse.samples.len()), (QuantityKind::Velocity, ROWS));
    assert!((pulse.samples.samples()[0] - 50.0 / 3.6).abs() < 1e-12);
    // The velocity at contact is the impact speed, unless somebody states one.
    assert!((ingested.test.impact_speed_m_per_s.unwrap() - 50.0 / 3.6).abs() < 1e-4);
    let stated = read(format!("{FACTS}{text}").replace("50 km/h", "51 km/h"), "").unwrap();
    assert!((stated.test.impact_speed_m_per_s.unwrap() - 51.0 / 3.6).abs() < 1e-12);
    // Columns of two velocities are asked about only where one is asked for.
    let lost = text.replace("\n0.0450,23.0000\n", "\n0.0450,230000\n");
    assert!(read(lost, "").unwrap_err().to_string().contains("a lost decimal point?"));
}

#[test]
fn a_spike_of_ten_times_its_neighbours_is_named_and_a_mass_is_questioned_first() {
    let spike = plain().replace("\n0.0450,-25.0000\n", "\n0.0450,-250.000\n");
    let ingested = read(format!("{FACTS}time_s,accel_g\n{spike}"), "").unwrap();
    let notes = notes(&ingested);
    assert!(
        notes.contains("sample 476 at 45.000 ms is -250.000 g") && notes.contains("-25.000 g would fit"),
        "{notes}"
    );
    for (mass, meant) in [("1.5 kg", "1500 kg if t is meant"), ("1500000 kg", "1500 kg if kg or g is meant")] {
        let text = format!("{FACTS}time_s,accel_g\n{}", plain()).replace("1200 kg", mass);
        let notes = read(text, "").unwrap().notes.to_texts();
        assert!(notes[0].starts_with("warning: the mass is") && notes[0].contains(meant), "{notes:?}");
    }
}
