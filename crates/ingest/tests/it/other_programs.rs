//! Workbooks, MATLAB and universal files, containers of parts of a record: made here as their programs write them.

use std::io::Write;

use crumple_ingest::{IngestError, Ingested};

use crate::{given, notes, open, write, zipped};

const ROWS: usize = 300;

fn time_s(k: usize) -> f64 {
    -0.05 + k as f64 * 5e-4
}

fn accel(k: usize) -> f64 {
    if time_s(k) < 0.0 { 0.0 } else { -(k as f64) }
}

/// Reads bytes from the disk under a name.
fn read_as(name: &str, bytes: impl AsRef<[u8]>, flags: &str) -> Result<Ingested, IngestError> {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[(name, bytes)]);
    open(folder.path().join(name), &given(flags))
}

#[track_caller]
fn check(ingested: &Ingested) {
    let wave = &ingested.pulse().unwrap().samples;
    assert_eq!((wave.len(), wave.t0_s(), wave.dt_s()), (ROWS, -0.05, 5e-4));
    assert!((0..ROWS).all(|k| wave.samples()[k] == accel(k)));
}

/// A workbook of sheets, each of rows of cells: numbers, words, or `=` and what a program stored as the value of a
/// formula.
fn workbook(sheets: &[(&str, Vec<Vec<String>>)]) -> Vec<u8> {
    let cell = |row: usize, k: usize, text: &str| {
        let place = format!("{}{}", char::from(b'A' + k as u8), row + 1);
        if let Some(stored) = text.strip_prefix('=') {
            return format!("<c r=\"{place}\"><f>SUM(A1)</f><v>{stored}</v></c>");
        }
        match text.parse::<f64>() {
            Ok(x) => format!("<c r=\"{place}\"><v>{x}</v></c>"),
            Err(_) => format!("<c r=\"{place}\" t=\"inlineStr\"><is><t>{text}</t></is></c>"),
        }
    };
    let line = |(row, cells): (usize, &Vec<String>)| {
        let cells: String =
            cells.iter().enumerate().filter(|(_, t)| !t.is_empty()).map(|(k, t)| cell(row, k, t)).collect();
        format!("<row r=\"{}\">{cells}</row>", row + 1)
    };
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let of_office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let of_package = "http://schemas.openxmlformats.org/package/2006/relationships";
    let (mut list, mut relations, mut files) = (String::new(), String::new(), Vec::new());
    for (k, (name, rows)) in sheets.iter().enumerate() {
        list += &format!("<sheet name=\"{name}\" sheetId=\"{0}\" r:id=\"rId{0}\"/>", k + 1);
        relations += &format!(
            "<Relationship Id=\"rId{0}\" Type=\"{of_office}/worksheet\" Target=\"worksheets/sheet{0}.xml\"/>",
            k + 1
        );
        let rows: String = rows.iter().enumerate().map(line).collect();
        let text = format!("<worksheet xmlns=\"{main}\"><sheetData>{rows}</sheetData></worksheet>");
        files.push((format!("xl/worksheets/sheet{}.xml", k + 1), text));
    }
    files.push((
        "xl/workbook.xml".to_owned(),
        format!("<workbook xmlns=\"{main}\" xmlns:r=\"{of_office}\"><sheets>{list}</sheets></workbook>"),
    ));
    files.push((
        "xl/_rels/workbook.xml.rels".to_owned(),
        format!("<Relationships xmlns=\"{of_package}\">{relations}</Relationships>"),
    ));
    let root = format!("<Relationship Id=\"rId1\" Type=\"{of_office}/officeDocument\" Target=\"xl/workbook.xml\"/>");
    files.push(("_rels/.rels".to_owned(), format!("<Relationships xmlns=\"{of_package}\">{root}</Relationships>")));
    zipped(&files)
}

fn sheet(above: &[&[&str]], time: impl Fn(usize) -> String) -> Vec<Vec<String>> {
    let words = above.iter().map(|line| line.iter().map(|text| (*text).to_owned()).collect());
    words.chain((0..ROWS).map(|k| vec![time(k), accel(k).to_string()])).collect()
}

#[test]
fn a_sheet_is_a_table_and_several_are_asked_about() {
    let plain = |k: usize| time_s(k).to_string();
    let named = || sheet(&[&["Time (s)", "Accel (m/s^2)"]], plain);
    check(&read_as("a.xlsx", workbook(&[("Sheet1", named())]), "").unwrap());
    let titled = sheet(&[&["Sled 12"], &[], &["Time", "Sill X"], &["s", "m/s^2"]], plain);
    let info = vec![vec!["Speed".to_owned(), "50".to_owned()]];
    check(&read_as("a.xlsx", workbook(&[("Info", info), ("Data", titled)]), "").unwrap());
    let two = workbook(&[("One", named()), ("Two", named())]);
    let error = read_as("a.xlsx", &two, "").unwrap_err();
    assert_eq!(error.hint(), "add --sheet \"One\", for example");
    check(&read_as("a.xlsx", &two, "--sheet two").unwrap());
    // In an archive, too; stamps as words.
    check(&read_as("a.zip", zipped(&[("b/a.xlsx", workbook(&[("One", named())]))]), "").unwrap());
    let stamps = sheet(&[&["Time", "Accel (m/s^2)"]], |k| format!("10:02:03.{:04}", k * 5));
    let ingested = read_as("a.xlsx", workbook(&[("One", stamps)]), "--time-zero-rule file").unwrap();
    let wave = &ingested.pulse().unwrap().samples;
    assert_eq!((wave.t0_s(), wave.dt_s()), (0.0, 5e-4));
}

#[test]
fn columns_of_formulas_without_values_are_named() {
    let with = |stored: &str, unit: &str| {
        let mut rows = sheet(&[&["Time (s)", unit]], |k| time_s(k).to_string());
        rows[0].push("floor right [g]".to_owned());
        rows[1..].iter_mut().for_each(|row| row.push(format!("={stored}")));
        workbook(&[("Sheet1", rows)])
    };
    for stored in ["", "0"] {
        let ingested = read_as("a.xlsx", with(stored, "Accel (m/s^2)"), "").unwrap();
        check(&ingested);
        let text = notes(&ingested);
        assert!(
            text.contains("not read: column \"floor right [g]\": its 300 formulas have no stored values"),
            "{text}"
        );
        let error = read_as("a.xlsx", with(stored, "raw [mV]"), "").unwrap_err();
        assert!(error.to_string().contains("floor right [g]") && error.hint().contains("save it"), "{error}");
    }
    // As a spreadsheet program stores them.
    let mut rows = sheet(&[&["Time (s)", "Accel (m/s^2)"]], |k| time_s(k).to_string());
    rows[1..].iter_mut().for_each(|row| row[1] = format!("={}", row[1]));
    check(&read_as("a.xlsx", workbook(&[("Sheet1", rows)]), "").unwrap());
    let mut rows = vec![vec!["=".to_owned(), "=".to_owned()]; 60];
    rows.insert(0, vec!["time [s]".to_owned()]);
    let error = read_as("a.xlsx", workbook(&[("Sheet1", rows)]), "").unwrap_err();
    assert!(error.to_string().contains("column \"time [s]\": its 60 formulas have no stored values"), "{error}");
}

/// An element of a MATLAB file.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn variable(class: u32, [rows, columns]: [usize; 2], name: &str, content: &[u8]) -> Vec<u8> {
    let sizes = [rows, columns].map(|size| i32::try_from(size).unwrap().to_le_bytes()).concat();
    let flags = [class.to_le_bytes(), [0; 4]].concat();
    element(14, &[element(6, &flags), element(5, &sizes), element(1, name.as_bytes()), content.to_vec()].concat())
}

fn numbers(name: &str, sizes: [usize; 2], numbers: impl Iterator<Item = f64>) -> Vec<u8> {
    variable(6, sizes, name, &element(9, &numbers.flat_map(f64::to_le_bytes).collect::<Vec<u8>>()))
}

fn matlab(variables: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = format!("{:<124}", "MATLAB 5.0 MAT-file").into_bytes();
    bytes.extend([0, 1, b'I', b'M']);
    bytes.extend(variables.concat());
    bytes
}

#[test]
fn variables_matrices_and_structs_of_matlab_are_channels() {
    let t = |name: &str| numbers(name, [ROWS, 1], (0..ROWS).map(time_s));
    let acc = |name: &str| numbers(name, [1, ROWS], (0..ROWS).map(accel));
    let mass = numbers("mass", [1, 1], std::iter::once(1200.0));
    let vectors = matlab(&[t("t"), acc("acc"), mass]);
    let error = read_as("a.mat", &vectors, "").unwrap_err();
    assert!(error.hint().contains("--unit g"), "{}", error.hint());
    check(&read_as("a.mat", &vectors, "--unit m/s^2").unwrap());
    let matrix = numbers("data", [ROWS, 2], (0..ROWS).map(time_s).chain((0..ROWS).map(accel)));
    check(&read_as("a.mat", matlab(&[matrix]), "--unit m/s^2").unwrap());
    let names = [&b"time\0\0\0\0"[..], b"acc\0\0\0\0\0"].concat();
    let fields = [element(5, &8_i32.to_le_bytes()), element(1, &names), t(""), acc("")].concat();
    let record = variable(2, [1, 1], "rec", &fields);
    let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(&record).unwrap();
    let packed = packer.finish().unwrap();
    let packed = [15_u32.to_le_bytes().to_vec(), (packed.len() as u32).to_le_bytes().to_vec(), packed].concat();
    for record in [record, packed] {
        let ingested = read_as("a.mat", matlab(&[record]), "--unit m/s^2").unwrap();
        check(&ingested);
        assert_eq!(ingested.test.pulse.as_deref(), Some("rec.acc"));
    }
    let cut = &vectors[..vectors.len() - 100];
    assert!(read_as("a.mat", cut, "--unit g").unwrap_err().to_string().contains("longer than the file"));
}

#[test]
fn a_code_behind_the_prefix_of_its_writer_is_a_code() {
    for (name, code) in [
        ("x11SILLLE0000ACXP", Some("11SILLLE0000ACXP")),
        ("M_11SILLLE0000ACXP", Some("11SILLLE0000ACXP")),
        ("M_10SILL00FRACXP", None),
    ] {
        let t = numbers("t", [ROWS, 1], (0..ROWS).map(time_s));
        let file = matlab(&[t, numbers(name, [ROWS, 1], (0..ROWS).map(accel))]);
        let ingested = read_as("a.mat", file, &format!("--unit m/s^2 --channel {name}")).unwrap();
        check(&ingested);
        let channel = ingested.test.channel(name).unwrap();
        assert_eq!(channel.code.as_deref(), code, "{name}");
        let location = if code.is_some() { "vehicle, front left, sill, left" } else { "" };
        assert_eq!(channel.location, location, "{name}");
    }
}

#[test]
fn a_data_set_58_is_a_channel() {
    let about = |even: bool| {
        format!(
            "    -1\n    58\n1x\nsled\n30-Apr-20\nNONE\nNONE\n    1         0    0         0 NONE\n\
             {:>10}{ROWS:>10}{:>10} \
             -5.00000E-02  5.00000E-04  0.00000E+00\n{:>10}    0    0    0 {:<20} {:<20}\n{:>10}    0    0    0 {:<20} \
             {:<20}\n         0    0    0    0 NONE\n         0    0    0    0 NONE\n",
            2,
            u8::from(even),
            17,
            "Time",
            "s",
            12,
            "sill acc",
            "m/s^2"
        )
    };
    let lines = |numbers: Vec<f64>| -> String {
        numbers.chunks(6).map(|line| line.iter().map(|x| format!("{x:>13.5E}")).collect::<String>() + "\n").collect()
    };
    let even = lines((0..ROWS).map(accel).collect());
    let pairs = lines((0..ROWS).flat_map(|k| [time_s(k), accel(k)]).collect());
    for text in [about(true) + &even, about(false) + &pairs] {
        let text = text + "    -1\n    -1\n   164\n         1\n    -1\n";
        check(&read_as("a.uff", &text, "").unwrap());
    }
    let short = about(true) + "  0.00000E+00\n    -1\n";
    let error = read_as("a.uff", &short, "").unwrap_err();
    assert!(error.to_string().contains("300 numbers are announced, 1 are there"), "{error}");
    let whole = about(true) + &even + "    -1\n";
    let refused = |rest: &[u8]| read_as("a.uff", [whole.as_bytes(), rest].concat(), "").unwrap_err().to_string();
    // Cut in the second set: behind its first line, in its description, in its numbers.
    for rest in ["    -1\n".to_owned(), about(true), about(true) + &even[..1000], about(true) + &even] {
        let error = refused(rest.as_bytes());
        assert!(error.contains("it is cut short"), "{error}");
    }
    let binary = about(true).replacen("    58\n", "    58b     1     2          11        2400     0     0\n", 1);
    // The end of a binary set stands behind its last byte.
    let error = refused(&[binary.as_bytes(), &[0, 10, 255, 13], b"    -1\n"].concat());
    assert_eq!(error, "a.uff, line 66: a binary data set (UFF 58b), which is not read");
    let others = whole.clone() + "    -1\n    15\n         1\n    -1\n";
    let ingested = read_as("a.uff", others, "").unwrap();
    check(&ingested);
    assert!(notes(&ingested).contains("data sets of other kinds than 58 are not read: 15"));
}

#[test]
fn tables_of_a_telephone_about_itself_are_no_records() {
    let rows: String = (0..ROWS).map(|k| format!("{:.4},{}\n", time_s(k), accel(k))).collect();
    let data = format!("time_s,acc (m/s^2)\n{rows}").into_bytes();
    let device = b"property,value\nmodel,phone\n".to_vec();
    let export = zipped(&[("Raw Data.csv", data), ("meta/device.csv", device.clone()), ("meta/time.csv", device)]);
    check(&read_as("export.zip", &export, "").unwrap());
}

#[test]
fn channels_of_a_test_may_lie_in_an_archive_beside_its_description() {
    let folder = tempfile::tempdir().unwrap();
    let samples: String = (0..ROWS).map(|k| format!("{}\n", accel(k))).collect();
    let channel = format!(
        "Channel code :10VEHCCG0000ACXP\nUnit :m/(s*s)\nSampling interval :5e-4\nTime of first sample :-0.05\n{samples}"
    );
    let description = "Data format edition number :1.6\nTitle :sled\nName of test object 1 :car\n";
    let channels = zipped(&[("Channel/T1.001", channel)]);
    write(folder.path(), &[("T1.mme", description.as_bytes()), ("Channel.zip", &channels)]);
    check(&open(folder.path(), &given("")).unwrap());
}

#[test]
fn a_description_that_states_nothing_is_noted() {
    let samples: String = (0..ROWS).map(|k| format!("{}\n", accel(k))).collect();
    let channel = format!(
        "Channel code :10VEHCCG0000ACXP\nUnit :m/(s*s)\nSampling interval :5e-4\nTime of first sample :-0.05\n{samples}"
    );
    for description in ["", "\r\n \n", "Title :\n", "Title :NOVALUE\nMass test object 1 :\n"] {
        let files = [("T1.mme", description.as_bytes()), ("Channel/T1.001", channel.as_bytes())];
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &files);
        write(folder.path(), &[("T1.zip", zipped(&files))]);
        for path in ["T1.mme", "T1.zip"] {
            let ingested = open(folder.path().join(path), &given("")).unwrap();
            check(&ingested);
            let text = notes(&ingested);
            assert!(text.contains("T1.mme states nothing of the test"), "{text}");
        }
    }
    let error = read_as("T1.mme", "", "").unwrap_err();
    assert!(error.to_string().contains("none of the channel files of T1.mme is here"), "{error}");
}
