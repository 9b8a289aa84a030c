//! Thirty more tables as data loggers, telephones, spreadsheets and scripts write them: each is read right, or refused
//! with advice that was followed.
//!
//! All hold the pulse of [`crate::messy_tables`].

use crumple_ingest::{IngestSettings, Ingested};

use crate::messy_tables::{FACTS, ROWS, accel_g, check_pulse, comma, none, plain, read, rows, time_s};

/// Whole 0.1 ms since the first row.
fn ticks(k: usize) -> usize {
    2 * k
}

/// `03.0002`: seconds of a clock that began at `start` s.
fn clock(k: usize, start: usize, mark: char) -> String {
    let all = 10_000 * start + ticks(k);
    let (hours, minutes, seconds) = (all / 36_000_000 % 24, all / 600_000 % 60, all / 10_000 % 60);
    format!("{hours:02}:{minutes:02}:{seconds:02}{mark}{:04}", all % 10_000)
}

fn channel(name: &str) -> IngestSettings {
    IngestSettings { channel: Some(name.to_owned()), ..none() }
}

fn unit(name: &str, symbol: &str) -> IngestSettings {
    IngestSettings { unit: Some(symbol.to_owned()), ..channel(name) }
}

/// Name, text, flags, time of the first row in s.
type Table = (&'static str, String, IngestSettings, f64);

fn tables_of_clocks() -> Vec<Table> {
    let stamped = |head: &str, line: &dyn Fn(usize, f64) -> String| head.to_owned() + &rows(|k, _, a| line(k, a));
    vec![
        (
            "ISO 8601",
            stamped("time,accel_g\n", &|k, a| format!("2024-03-14T{}Z,{a:.4}", clock(k, 36_123, '.'))),
            none(),
            0.0,
        ),
        (
            "a date of America, afternoon",
            stamped("Date,accel_g\n", &|k, a| format!("3/14/2024 {} PM,{a:.4}", &clock(k, 3_723, '.')[1..])),
            none(),
            0.0,
        ),
        (
            "a date of Germany",
            stamped("Zeit;a [g]\n", &|k, a| {
                comma(format!("14,03,2024 {};{a:.4}", clock(k, 36_123, ','))).replacen(',', ".", 2)
            }),
            none(),
            0.0,
        ),
        (
            "a clock",
            stamped("Time (HH:MM:SS.ssss),accel_g\n", &|k, a| format!("{},{a:.4}", clock(k, 36_123, '.'))),
            none(),
            0.0,
        ),
        (
            "a clock over midnight",
            stamped("time,accel_g\n", &|k, a| format!("{},{a:.4}", clock(k, 86_399, '.'))),
            none(),
            0.0,
        ),
        (
            "nanoseconds since 1970",
            stamped("timestamp_ns,accel_g\n", &|k, a| {
                format!("{},{a:.4}", 1_718_030_737_072_695_300 + 200_000 * k as u64)
            }),
            none(),
            0.0,
        ),
        (
            "microseconds since 1970",
            stamped("timestamp [us],accel_g\n", &|k, a| format!("{},{a:.4}", 1_718_030_737_072_695 + 200 * k as u64)),
            none(),
            0.0,
        ),
        (
            "a telephone: nanoseconds and seconds elapsed",
            stamped("time,seconds_elapsed,z,y,x\n", &|k, a| {
                format!(
                    "{},{:.4},0.1,0.2,{a:.4}",
                    1_718_030_737_072_695_300 + 200_000 * k as u64,
                    1e-4 * ticks(k) as f64
                )
            }),
            unit("x", "g"),
            0.0,
        ),
        (
            "microseconds",
            format!("time [µs],accel_g\n{}", rows(|_, t, a| format!("{:.0},{a:.4}", 1e6 * t))),
            none(),
            -0.05,
        ),
    ]
}

/// Names of the columns of a plain table.
const HEADER: &str = "time_s,accel_g";

fn tables_of_scripts() -> Vec<Table> {
    let stamped = |head: &str, line: &dyn Fn(usize, f64) -> String| head.to_owned() + &rows(|k, _, a| line(k, a));
    vec![
        ("a line [DATA]", format!("{HEADER}\n[DATA]\n{}", plain()), none(), -0.05),
        (
            "a line of dashes",
            format!("time_s    accel_g\n-------   -------\n{}", plain().replace(',', "   ")),
            none(),
            -0.05,
        ),
        (
            "lines of facts above the names",
            format!("Operator: N. N.\nInstrument: Logger 4, range 200\nTrigger level: 3\n\n{HEADER}\n{}", plain()),
            none(),
            -0.05,
        ),
        ("remarks of a script", format!("// run 7\n; second line\n{HEADER}\n{}", plain()), none(), -0.05),
        (
            "a slower channel",
            format!(
                "{HEADER},temp_C\n{}",
                rows(|k, t, a| format!("{t:.4},{a:.4},{}", if k % 10 == 0 { "21.5" } else { "" }))
            ),
            none(),
            -0.05,
        ),
        (
            "a channel that begins late",
            format!(
                "{HEADER},temp_C\n{}",
                rows(|k, t, a| format!("{t:.4},{a:.4},{}", if k > 300 { "21.5" } else { "" }))
            ),
            none(),
            -0.05,
        ),
        (
            "another acceleration that begins late",
            format!(
                "{HEADER},b_g,\n{}",
                rows(|k, t, a| format!("{t:.4},{a:.4},{},", if k > 300 { "-0.5" } else { "" }))
            ),
            channel("accel_g"),
            -0.05,
        ),
        (
            "a constant column",
            format!("{HEADER},range_g\n{}", rows(|_, t, a| format!("{t:.4},{a:.4},200"))),
            channel("accel_g"),
            -0.05,
        ),
        (
            "a column of words",
            format!("{HEADER},state\n{}", rows(|_, t, a| format!("{t:.4},{a:.4},OK"))),
            none(),
            -0.05,
        ),
        (
            "units of a simulation",
            format!("time [ms],ax [mm/ms^2]\n{}", rows(|_, t, a| format!("{:.1},{:.8}", 1e3 * t, a * 9.806_65e-3))),
            none(),
            -0.05,
        ),
        (
            "commas inside names",
            format!("Time, relative [s];Accel, x [g]\n{}", plain().replace(',', ";")),
            none(),
            -0.05,
        ),
        ("names of Japan", format!("時間[s],加速度[g]\n{}", plain()), none(), -0.05),
        (
            "a scan count, a clock and an alarm",
            stamped("Scan,Time,101 <sill> (g),Alarm 101\n", &|k, a| {
                format!("{},{},{a:.4},0", k + 1, clock(k, 36_123, '.'))
            }),
            channel("101 <sill> (g)"),
            0.0,
        ),
        (
            "an inertial unit with nine columns",
            format!(
                "t_s,ax,ay,az,gx,gy,gz,qw,valid\n{}",
                rows(|k, t, a| format!("{t:.4},{a:.4},0.01,1.0,{},0.2,0.3,1,1", k % 5))
            ),
            unit("ax", "g"),
            -0.05,
        ),
        (
            "names without meaning",
            format!("Var1,Var2\n{}", plain()),
            IngestSettings { time_unit: Some("s".into()), ..unit("Var2", "g") },
            -0.05,
        ),
        (
            "tabs at the end of rows",
            format!("time_s\taccel_g\t\t\n{}", plain().replace(',', "\t").replace('\n', "\t\t\n")),
            none(),
            -0.05,
        ),
    ]
}

fn tables() -> Vec<Table> {
    [tables_of_clocks(), tables_of_scripts()].concat()
}

#[test]
fn these_are_read_right_too() {
    let wrong: Vec<String> = tables()
        .into_iter()
        .filter_map(|(name, text, flags, t0_s)| match read(format!("{FACTS}{text}"), &flags) {
            Ok(ingested) => {
                std::panic::catch_unwind(|| check_pulse(name, &ingested, t0_s)).err().map(|_| format!("{name}: wrong"))
            }
            Err(error) => Some(format!("{name}: {error} (hint: {})", error.hint())),
        })
        .collect();
    assert_eq!(wrong, [""; 0]);
}

/// A table that is refused: name, text, what is said of it, words of the advice, and who followed it.
type Refused = (&'static str, String, &'static str, &'static str, (String, IngestSettings));

fn refused() -> Vec<Refused> {
    let header = "time_s,accel_g";
    let good = format!("{header}\n{}", plain());
    let line = |k: usize| format!("{:.4},{:.4}\n", time_s(k), accel_g(k));
    let with = |text: &str| good.replacen(&line(600), text, 1);
    let repaired = || (good.clone(), none());
    let twice = format!("left sill\n{good}right sill\n{good}");
    let skip = IngestSettings { skip_to: Some("right sill".to_owned()), ..none() };
    let jitter = |k: usize| if k % 3 == 1 { 7e-5 } else { 0.0 };
    let phone = format!("{header}\n{}", rows(|k, t, a| format!("{:.6},{a:.4}", t + jitter(k))));
    let bars = format!("{header}\n{}", plain()).replace(',', "|");
    vec![
        ("letters in a time", with("0.O700,-15.0000\n"), "line 604", "write the number that belongs there", repaired()),
        ("noise on the line", with("\u{fffd}%&x?!@,,1\n"), "line 604", "mend the line", repaired()),
        ("a mark of a trigger", with(&format!("trigger\n{}", line(600))), "line 604", "mend the line", repaired()),
        ("two curves", twice.clone(), "second table or curve", "--skip-to \"right sill\"", (twice, skip)),
        ("a row that stands twice", with(&line(600).repeat(2)), "line 605", "remove", repaired()),
        ("bars between columns", bars, "no rows of numbers", "export the record as CSV", repaired()),
        (
            "uneven steps of a telephone",
            phone.clone(),
            "line",
            "--resample",
            (phone, IngestSettings { resample: Some("5kHz".parse().unwrap()), ..none() }),
        ),
    ]
}

#[test]
fn these_are_refused_with_advice_that_works() {
    assert!(tables().len() + refused().len() >= 30);
    for (name, text, said, advice, (followed, flags)) in refused() {
        let error = read(format!("{FACTS}{text}"), &none()).expect_err(name);
        let whole = format!("{error} {} {}", error.expected().unwrap_or_default(), error.hint());
        assert!(whole.contains(said) && whole.contains(advice), "{name}: {whole}");
        let is_of_two = name == "two curves";
        assert_eq!(whole.contains("second table"), is_of_two, "{name}: {whole}");
        let ingested: Ingested =
            read(format!("{FACTS}{followed}"), &flags).unwrap_or_else(|error| panic!("{name}: {error}"));
        if flags.resample.is_none() {
            check_pulse(name, &ingested, -0.05);
        }
        assert_eq!(ingested.waves.len(), 1, "{name}");
    }
}

#[test]
fn a_channel_that_begins_late_is_read_where_it_is_asked_for() {
    let text = rows(|k, t, a| format!("{t:.4},0.5,{}", if k > 200 { format!("{a:.4}") } else { String::new() }));
    let ingested = read(format!("{FACTS}time_s,b_g,accel_g\n{text}"), &channel("accel_g")).unwrap();
    let pulse = &ingested.pulse().unwrap().samples;
    assert!(pulse.len() == ROWS - 201 && (pulse.t0_s() - time_s(201)).abs() < 1e-12, "{pulse:?}");
    // Nobody asked: the one with a number in every row is the pulse.
    let ingested = read(format!("{FACTS}time_s,b_g,accel_g\n{text}"), &none()).unwrap();
    let texts = ingested.notes.to_texts().join("\n");
    assert!(texts.contains("columns with gaps are left out: accel_g"), "{texts}");
    assert_eq!(ingested.pulse().unwrap().samples.len(), ROWS);
}
