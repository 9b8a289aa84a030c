//! Texts of loggers: values above the names, a clock or labels in the rows, times in pairs, other spellings of units.

use crumple_ingest::{IngestError, IngestSettings, Ingested};
use crumple_signal::{Axis, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};

use crate::{given, notes, read_as};

/// Peak of the pulse of these texts, g, its length and the lead before it, samples of 0.2 ms.
const PEAK_G: f64 = 24.0;
const LENGTH: usize = 500;
const LEAD: usize = 100;

/// A half sine, g, of which a change of velocity of 2/π times peak and length is known.
fn sample(k: usize) -> f64 {
    let place = k as f64 - LEAD as f64;
    if (0.0..LENGTH as f64).contains(&place) {
        -PEAK_G * (std::f64::consts::PI * place / LENGTH as f64).sin()
    } else {
        0.0
    }
}

fn rows(count: usize, row: impl Fn(usize) -> String) -> String {
    (0..count).map(|k| row(k) + "\n").collect()
}

fn read(text: &str, flags: &str) -> Result<Ingested, IngestError> {
    read_as("log.csv", text, &given(&format!("--mass 1200kg --impact-speed 50km/h {flags}")))
}

/// The pulse is the half sine: to the printed digits.
fn assert_is_the_pulse(read: Result<Ingested, IngestError>, what: &str) -> Ingested {
    let read = read.unwrap_or_else(|error| panic!("{what}: {error}"));
    let pulse = read.pulse().unwrap_or_else(|| panic!("{what}: no pulse"));
    let largest = pulse.samples.samples().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    assert!((largest / (PEAK_G * G) - 1.0).abs() < 1e-3, "{what}: peak {largest} m/s^2");
    // The pulse is 100 ms long at half its height for two thirds of it.
    let above = pulse.samples.samples().iter().filter(|x| x.abs() > 0.5 * largest).count();
    let length_s = above as f64 * pulse.samples.dt_s();
    assert!((length_s - 0.2 / 3.0).abs() < 1e-3, "{what}: {length_s} s above half of the peak");
    read
}

#[test]
fn units_and_codes_stand_above_the_names_one_value_a_column() {
    let preamble = "Headers,,,\nISO Channel Code,11CHST0003H3DSXC,10VEHCCG0000ACYP,10VEHCCG0000ACXP\n\
        Sample Rate (Hz),5000,5000,5000\nEngineering Unit,mm ,g ,g \nTime,Chan 0:S0,Chan 1:S1,Chan 2:S2\n";
    let table = rows(900, |k| format!("{:.4},{:.3},0.0,{:.5}", k as f64 * 2e-4 - 0.02, 0.01 * k as f64, sample(k)));
    let text = format!("{preamble}{table}");
    let vehicle = assert_is_the_pulse(read(&text, ""), "preamble");
    assert_eq!(vehicle.test.pulse.as_deref(), Some("10VEHCCG0000ACXP"));
    // The unit that the file states for a deflection is not replaced.
    let refused = read(&text, "--unit g --channel Chan_0_S0").unwrap_err().to_string();
    assert!(refused.contains("displacement"), "{refused}");
}

#[test]
fn a_clock_before_an_arrow_and_labels_before_numbers_are_read() {
    let clock = |k: usize| format!("10:02:{:02}.{:04}", k / 5000, (k % 5000) * 2);
    let arrow = rows(900, |k| format!("{} -> {:.5},0.01,1.00", clock(k), sample(k)));
    assert_is_the_pulse(read(&arrow, "--unit g --channel 1 --time-zero 20ms"), "clock");
    let labelled = |k: usize| format!("t:{:.4} X: {:.5} Y: 0.01 Z: 1.00", k as f64 * 2e-4, sample(k));
    let text = format!("=~=~= log =~=~=\n{}IMPACT!\n{}", rows(300, labelled), rows(600, |k| labelled(k + 300)));
    let read = assert_is_the_pulse(read(&text, "--unit g --channel X --time-unit s --time-zero 20ms"), "labels");
    assert!(
        notes(&read).contains("1 lines that are no such row are left out, the first is line 302"),
        "{}",
        notes(&read)
    );
}

#[test]
fn the_lines_of_a_daqmx_text_and_the_scales_of_a_gyroflow_log_are_applied() {
    let table = rows(900, |k| format!("{:.5}\t0.01", sample(k)));
    let text = format!(
        "channel names: \t\nSled\tSled Y\nstart times: \t\n03/14/2024 10:02:03\t03/14/2024 10:02:03\n\
        dt: \t\n0.000200\t0.000200\ndata: \t\n{table}"
    );
    assert_is_the_pulse(read(&text, "--unit g --channel Sled --time-zero 20ms"), "DAQmx");
    let counts = rows(900, |k| format!("{k},1,2,3,{:.0},0,128", sample(k) / 0.0078125));
    let text = format!(
        "GYROFLOW IMU LOG\nversion,1.3\ntscale,0.0002\ngscale,0.0012\nascale,0.0078125\nt,gx,gy,gz,ax,ay,az\n\
        {counts}"
    );
    assert_is_the_pulse(read(&text, "--channel ax --time-zero 20ms"), "gcsv");
}

#[test]
fn series_of_influxdb_are_columns_where_their_times_are_the_same() {
    let head = "#group,false,false,true,false,false,true\n\
        #datatype,string,long,dateTime:RFC3339,dateTime:RFC3339,double,string\n\
        #default,_result,,,,,\n,result,table,_start,_time,_value,_field\n";
    let series = |table: usize, field: &str, from_us: usize| {
        rows(900, |k| {
            let us = 3_000_000 + from_us + 200 * k;
            let time = format!("2024-03-14T10:02:{:02}.{:06}Z", us / 1_000_000, us % 1_000_000);
            let value = if field == "accel_x" { sample(k) } else { 0.01 };
            format!(",,{table},2024-03-14T10:00:00Z,{time},{value:.5},{field}")
        })
    };
    let flags = "--unit g --time-zero 20ms";
    assert_is_the_pulse(read(&format!("{head}{}", series(0, "accel_x", 0)), flags), "one series");
    let two = format!("{head}{}{}", series(0, "accel_x", 0), series(1, "accel_y", 0));
    let both = assert_is_the_pulse(read(&two, &format!("{flags} --channel accel_x")), "two series");
    assert_eq!(both.waves.len(), 2);
    let apart = format!("{head}{}{}", series(0, "accel_x", 0), series(1, "accel_y", 70));
    let refused = read(&apart, flags).unwrap_err().to_string();
    assert!(refused.contains("2 series (_field)") && refused.contains("accel_y"), "{refused}");
    assert_is_the_pulse(read(&apart, &format!("{flags} --channel accel_x")), "the one that is asked for");
}

#[test]
fn channels_have_the_times_before_them() {
    // The second waveform starts 20 ms later, by the clock.
    let stamp = |k: usize, ms: usize| {
        let us = 1000 * ms + 200 * k;
        format!("03/14/2024 10:02:{:02}.{:06}", 3 + us / 1_000_000, us % 1_000_000)
    };
    let table = rows(900, |k| format!("{}\t0.0\t{}\t{:.5}", stamp(k, 0), stamp(k, 20), sample(k)));
    let text = format!("time[0]\tY[0]\ttime[1]\tY[1]\n{table}");
    for channel in ["4", "Y[1]"] {
        let read = read(&text, &format!("--unit g --channel {channel} --time-zero 40ms"));
        let read = assert_is_the_pulse(read, "waveforms");
        assert!((read.pulse().unwrap().samples.t0_s() + 0.02).abs() < 1e-9, "{channel}");
    }
    // Two curves of other steps and lengths.
    let curve = |k: usize| if k < 900 { format!("{:.2},{:.5}", 0.2 * k as f64, sample(k)) } else { ",".to_owned() };
    let text = format!("Model,,Test,\nX,Y,X,Y\n{}", rows(1200, |k| format!("{:.2},0.0,{}", 0.1 * k as f64, curve(k))));
    assert_is_the_pulse(read(&text, "--time-unit ms --unit g --channel 4 --time-zero 20ms"), "curves");
}

#[test]
fn y_beside_x_is_the_ordinate_and_beside_other_axes_one_of_them() {
    let axis_of = |names: &str, row: &dyn Fn(usize) -> String, channel: &str| {
        let text = format!("{names}\n{}", rows(900, row));
        let read = read(&text, &format!("--time-unit ms --unit g --time-zero 20ms {channel}")).unwrap();
        let pulse = read.test.pulse.clone();
        read.test.channels.iter().find(|channel| Some(&channel.id) == pulse.as_ref()).unwrap().axis
    };
    let plot = |k: usize| format!("{:.2},{:.5}", 0.2 * k as f64, sample(k));
    assert_eq!(axis_of("X,Y", &plot, ""), None);
    let head = |k: usize| format!("{:.2},0.01,{:.5},0.02", 0.2 * k as f64, sample(k));
    assert_eq!(axis_of("t,x,y,z", &head, "--channel y"), Some(Axis::Y));
}

#[test]
fn stamps_that_stand_still_give_way_to_the_interval_that_is_stated() {
    let text = format!("time,accel_g\n{}", rows(900, |k| format!("02:{:02}.0,{:.5}", 3 + k / 500, sample(k))));
    let read = assert_is_the_pulse(read(&text, "--sample-time 200us --time-zero 20ms"), "Excel");
    assert!(notes(&read).contains("do not increase"), "{}", notes(&read));
    let good = format!("time_s,accel_g\n{}", rows(900, |k| format!("{:.4},{:.5}", k as f64 * 2e-4, sample(k))));
    assert!(self::read(&good, "--sample-time 200us").is_err());
}

#[test]
fn accelerations_of_a_recorder_are_read_as_a_change_of_velocity() {
    let half_sine = |k: usize| if k <= 10 { -24.5 * (std::f64::consts::PI * k as f64 / 10.0).sin() } else { 0.0 };
    let text = format!(
        "Time (ms),\"Acceleration, Longitudinal (g)\"\n{}",
        rows(26, |k| format!("{},{:.1}", 10 * k, half_sine(k)))
    );
    let refused = read_as("edr.csv", text.as_str(), &IngestSettings::default()).unwrap_err();
    assert!(refused.hint().contains("--profile edr"), "{}", refused.hint());
    let read = read_as("edr.csv", text.as_str(), &given("--profile edr")).unwrap();
    let wave = &read.waves[0];
    assert_eq!(wave.quantity, QuantityKind::VelocityChange);
    // 2/π of peak and length; the trapezoidal rule over ten steps misses a half sine by π²/1200.
    let last = wave.samples.samples().last().copied().unwrap();
    let exact = -24.5 * G * 0.1 * 2.0 / std::f64::consts::PI;
    assert!((last / exact - 1.0).abs() < 0.01, "{last} {exact}");
}

#[test]
fn rows_of_more_fields_than_names_are_named() {
    let names = "\"time\",\"INTERNAL ENERGY\",\"1 sill DX\"";
    let text =
        format!("{names}\n{}", rows(900, |k| format!("{:.4},1e3,0.0,{:.5},0.0", k as f64 * 2e-4, sample(k) * 9806.65)));
    let refused = read(&text, "--unit mm/s^2 --time-zero 20ms").unwrap_err().to_string();
    assert!(refused.contains("5 fields in a row, 3 names"), "{refused}");
    assert_is_the_pulse(read(&text, "--unit mm/s^2 --time-zero 20ms --channel 4"), "by its number");
}

#[test]
fn units_are_known_as_people_write_them() {
    for (unit, of_g) in [
        ("G's", 1.0),
        ("G-FORCE", 1.0),
        ("g_n", 1.0),
        ("milli-g", 1e3),
        ("milli g", 1e3),
        ("kgn", 1e-3),
        ("mGal", 980_665.0),
        ("in/sec^2", G / 0.0254),
        ("ft/s/s", G / 0.3048),
        ("ft/sec^2", G / 0.3048),
        ("m*s^-2", G),
        ("m s⁻²", G),
    ] {
        let text = format!(
            "Time (s);Accel ({unit})\n{}",
            rows(900, |k| format!("{:.4};{:.6}", k as f64 * 2e-4 - 0.02, sample(k) * of_g))
        );
        assert_is_the_pulse(read(&text, ""), unit);
    }
    let text =
        format!("Time (s);Accel (milli-gee)\n{}", rows(900, |k| format!("{:.4};{:.6}", k as f64 * 2e-4, sample(k))));
    let refused = read(&text, "").unwrap_err();
    let refused = format!("{refused} {}", refused.hint());
    assert!(refused.contains("\"milli-gee\"") && !refused.contains("--unit g or --unit m/s^2"), "{refused}");
}

#[test]
fn a_velocity_without_a_name_takes_its_unit() {
    let speed = |k: usize| {
        let place = (k as f64 - LEAD as f64).clamp(0.0, LENGTH as f64) / LENGTH as f64;
        13.9 - 15.3 * 0.5 * (1.0 - (std::f64::consts::PI * place).cos())
    };
    let text = rows(900, |k| format!("{:.4},{:.6}", k as f64 * 2e-4 - 0.02, speed(k)));
    let read = read(&text, "--unit m/s").unwrap();
    assert_eq!(read.pulse().unwrap().quantity, QuantityKind::Velocity);
}
