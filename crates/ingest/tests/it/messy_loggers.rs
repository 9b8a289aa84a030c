//! More tables as data loggers, telephones, spreadsheets and scripts write them: each is read right, or refused with
//! advice that was followed.
//!
//! All hold the pulse of [`crate::messy_tables`].

use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;

use crate::messy_tables::{
    FACTS, ROWS, Refused, Table, accel_g, are_read_right, comma, headed, is_refused, plain, read, rows, since_1970_ns,
    time_s,
};
use crate::notes;

/// `10:02:03.0002`: a clock that began at so many 0.1 ms of the day.
fn clock(k: usize, start: usize, mark: char) -> String {
    let all = start + 2 * k;
    let (hours, minutes, seconds) = (all / 36_000_000 % 24, all / 600_000 % 60, all / 10_000 % 60);
    format!("{hours:02}:{minutes:02}:{seconds:02}{mark}{:04}", all % 10_000)
}

/// Days of a spreadsheet from the 14th of March 2024, 10:02:03 on.
fn serial_day(t: f64) -> f64 {
    45_365.0 + (36_123.0 + t + 0.05) / 86_400.0
}

/// Times that count from the first row.
fn tables_of_clocks() -> Vec<Table> {
    // Ten hours, two minutes and three seconds; one in the afternoon.
    let (at, pm) = (|k| clock(k, 361_230_000, '.'), |k| clock(k, 37_230_000, '.'));
    let german = |k, a| comma(format!("14,03,2024 {};{a:.4}", clock(k, 361_230_000, ','))).replacen(',', ".", 2);
    let tables = [
        ("ISO 8601", headed("timestamp,accel_g", |k, _, a| format!("2024-03-14 {}+00:00,{a:.4}", at(k)))),
        ("a T and a Z", headed("UTC,accel_g", |k, _, a| format!("2024-03-14T{}Z,{a:.4}", at(k)))),
        ("a T and a Z below time", headed("time,accel_g", |k, _, a| format!("2024-03-14T{}Z,{a:.4}", at(k)))),
        ("the American way", headed("Date/Time,accel_g", |k, _, a| format!("3/14/2024 {} PM,{a:.4}", at(k)))),
        ("afternoon in America", headed("Date,accel_g", |k, _, a| format!("3/14/2024 {} PM,{a:.4}", &pm(k)[1..]))),
        ("a date of Germany", headed("Zeit;a [g]", |k, _, a| german(k, a))),
        ("a clock", headed("Clock,accel_g", |k, _, a| format!("{},{a:.4}", at(k)))),
        ("a clock and its form", headed("Time (HH:MM:SS.ssss),accel_g", |k, _, a| format!("{},{a:.4}", at(k)))),
        (
            "thousandths behind a colon",
            headed("t;a [g]", |k, _, a| comma(format!("{};{a:.4}", clock(k, 517_270_000, ':')))),
        ),
        ("Excel's minutes", headed("t,accel_g", |k, _, a| format!("{},{a:.4}", &at(k)[3..]))),
        ("over midnight", headed("time,accel_g", |k, _, a| format!("{},{a:.4}", clock(k, 863_999_500, '.')))),
        ("days", headed("Time,accel_g", |_, t, a| format!("{:.11},{a:.4}", serial_day(t)))),
        ("nanoseconds since 1970", headed("time_ns,accel_g", |_, t, a| format!("{},{a:.4}", since_1970_ns(t)))),
        ("the same as a stamp", headed("timestamp_ns,accel_g", |_, t, a| format!("{},{a:.4}", since_1970_ns(t)))),
        (
            "microseconds since 1970",
            headed("timestamp [us],accel_g", |_, t, a| format!("{},{a:.4}", since_1970_ns(t) / 1000)),
        ),
        (
            "seconds beside them",
            headed("time,seconds_elapsed,accel_g", |_, t, a| format!("{},{:.4},{a:.4}", since_1970_ns(t), t + 0.05)),
        ),
    ];
    tables.into_iter().map(|(name, text)| (name, text, "", 0.0)).collect()
}

fn tables_of_scripts() -> Vec<Table> {
    let slow = |k: usize| if k.is_multiple_of(10) { "50.1" } else { "" };
    let late = |k: usize| if k > 300 { "21.5" } else { "" };
    let facts = "Operator: N. N.\nInstrument: Logger 4, range 200\nTrigger level: 3\n\n";
    let tables = [
        ("microseconds", headed("time [µs],accel_g", |_, t, a| format!("{:.0},{a:.4}", 1e6 * t))),
        ("minutes", headed("time [min],accel [g]", |_, t, a| format!("{:.15},{a:.4}", t / 60.0))),
        ("a mark below the names", format!("time_s,accel_g\n[DATA]\n{}", plain())),
        ("a line of dashes", format!("time_s    accel_g\n-------   -------\n{}", plain().replace(',', "   "))),
        ("dashes below names and units", format!("time accel\ns g\n---- -----\n{}", plain().replace(',', " "))),
        ("the end of a header", format!("t (s)\ta (g)\n***End_of_Header***\n{}", plain().replace(',', "\t"))),
        ("lines of facts above the names", format!("{facts}time_s,accel_g\n{}", plain())),
        ("remarks of a script", format!("// run 7\n; second line\ntime_s,accel_g\n{}", plain())),
        ("a slower channel", headed("time_s,accel_g,speed", |k, t, a| format!("{t:.4},{a:.4},{}", slow(k)))),
        ("a faster time", headed("time_s,accel_g,b", |_, t, a| format!("{t:.4},{a:.4},1\n{:.4},,2", t + 1e-4))),
        ("a channel that begins late", headed("time_s,accel_g,temp_C", |k, t, a| format!("{t:.4},{a:.4},{}", late(k)))),
        (
            "one before the pulse that begins late",
            headed("time_s,b_g,accel_g", |k, t, a| format!("{t:.4},{},{a:.4}", late(k))),
        ),
        ("a column of words", format!("time_s,accel_g,place\n{}", plain().replace('\n', ",B-pillar\n"))),
        ("a state", format!("time_s,accel_g,state\n{}", plain().replace('\n', ",OK\n"))),
        (
            "units of a simulation",
            headed("time [ms],ax [mm/ms^2]", |_, t, a| format!("{:.1},{:.8}", 1e3 * t, a * G / 1e3)),
        ),
        ("commas inside names", format!("Time, relative [s];Accel, x [g]\n{}", plain().replace(',', ";"))),
        ("names of Japan", format!("時間[s],加速度[g]\n{}", plain())),
        (
            "tabs at the end of rows",
            format!("time_s\taccel_g\t\t\n{}", plain().replace(',', "\t").replace('\n', "\t\t\n")),
        ),
    ];
    tables.into_iter().map(|(name, text)| (name, text, "", -0.05)).collect()
}

/// Tables of which a column is named.
fn tables_of_many_columns() -> Vec<Table> {
    let late = |k: usize| if k > 300 { "-0.5" } else { "" };
    let at = |k| clock(k, 361_230_000, '.');
    let nine = "t_s,ax,ay,az,gx,gy,gz,qw,valid";
    vec![
        (
            "a telephone: nanoseconds and seconds elapsed",
            headed("time,seconds_elapsed,z,y,x", |_, t, a| {
                format!("{},{:.4},0.1,0.2,{a:.4}", since_1970_ns(t), t + 0.05)
            }),
            "--channel x --unit g",
            0.0,
        ),
        (
            "a scan count, a clock and an alarm",
            headed("Scan,Time,101 <sill> (g),Alarm 101", |k, _, a| format!("{},{},{a:.4},0", k + 1, at(k))),
            "--channel 101 <sill> (g)",
            0.0,
        ),
        (
            "another acceleration that begins late",
            headed("time_s,accel_g,b_g,", |k, t, a| format!("{t:.4},{a:.4},{},", late(k))),
            "--channel accel_g",
            -0.05,
        ),
        (
            "a constant column",
            format!("time_s,accel_g,range_g\n{}", plain().replace('\n', ",200\n")),
            "--channel accel_g",
            -0.05,
        ),
        (
            "an inertial unit with nine columns",
            headed(nine, |k, t, a| format!("{t:.4},{a:.4},0.01,1.0,{},0.2,0.3,1,1", k % 5)),
            "--channel ax --unit g",
            -0.05,
        ),
        ("names without meaning", format!("Var1,Var2\n{}", plain()), "--channel Var2 --unit g --time-unit s", -0.05),
    ]
}

#[test]
fn these_are_read_right_too() {
    are_read_right([tables_of_clocks(), tables_of_scripts(), tables_of_many_columns()].concat());
}

fn refused() -> Vec<Refused> {
    let good = format!("{FACTS}time_s,accel_g\n{}", plain());
    let line = |k: usize| format!("{:.4},{:.4}\n", time_s(k), accel_g(k));
    let with = |text: &str| good.replacen(&line(600), text, 1);
    let twice = format!("{FACTS}left sill\ntime_s,accel_g\n{0}right sill\ntime_s,accel_g\n{0}", plain());
    let jitter = |k: usize| if k % 3 == 1 { 7e-5 } else { 0.0 };
    let phone = headed("time_s,accel_g", |k, t, a| format!("{:.6},{a:.4}", t + jitter(k)));
    let (phone, trigger) = (format!("{FACTS}{phone}"), format!("trigger\n{}", line(600)));
    let refused = |name, text, said, advice| Refused {
        name,
        text,
        said,
        advice,
        followed: (good.clone(), ""),
        t0_s: Some(-0.05),
    };
    vec![
        refused("letters in a time", with("0.O700,-15.0000\n"), "line 604", "write the number that belongs there"),
        refused("noise on the line", with("\u{fffd}%&x?!@,,1\n"), "line 604", "mend the line"),
        refused("a mark of a trigger", with(&trigger), "line 604", "mend the line"),
        refused("a row that stands twice", with(&line(600).repeat(2)), "line 605", "remove"),
        refused("bars between columns", good.replace(',', "|"), "no rows of numbers", "export the record as CSV"),
        Refused {
            followed: (twice.clone(), "--skip-to right sill"),
            ..refused("two curves", twice, "second table or curve", "--skip-to \"right sill\"")
        },
        Refused {
            followed: (phone.clone(), "--resample 5kHz"),
            t0_s: None,
            ..refused("uneven steps of a telephone", phone, "line", "--resample")
        },
    ]
}

#[test]
fn these_are_refused_with_advice_that_works() {
    for case in refused() {
        let name = case.name;
        let (said, ingested) = is_refused(case);
        assert_eq!(said.contains("second table"), name == "two curves", "{name}: {said}");
        assert_eq!(ingested.waves.len(), 1, "{name}");
    }
}

#[test]
fn a_channel_that_begins_late_is_read_where_it_is_asked_for() {
    let text = rows(|k, t, a| format!("{t:.4},0.5,{}", if k > 200 { format!("{a:.4}") } else { String::new() }));
    let text = format!("{FACTS}time_s,b_g,accel_g\n{text}");
    let ingested = read(text.clone(), "--channel accel_g").unwrap();
    let pulse = &ingested.pulse().unwrap().samples;
    assert!(pulse.len() == ROWS - 201 && (pulse.t0_s() - time_s(201)).abs() < 1e-12, "{pulse:?}");
    // Nobody asked: the one with a number in every row is the pulse.
    let ingested = read(text, "").unwrap();
    assert!(notes(&ingested).contains("columns with gaps are left out: accel_g"), "{}", notes(&ingested));
    assert_eq!(ingested.pulse().unwrap().samples.len(), ROWS);
}
