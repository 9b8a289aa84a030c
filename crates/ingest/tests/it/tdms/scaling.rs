//! DAQmx raw data and linear scales.

use crumple_ingest::IngestSettings;

use crate::tdms::writer::{
    INTERLEAVED, NEW_LIST, RAW, Value, Writer, has_note, read, read_with, samples, segment, waveform,
};

pub fn daqmx(out: &mut Writer, path: &str, rows: u64, offset: u32, width: u32, properties: &[(&str, Value)]) {
    // i16 at `offset` in the only buffer, scale id 0.
    out.text(path).u32(0x1269).u32(u32::MAX).u32(1).u64(rows);
    out.u32(1).u32(3).u32(0).u32(offset).u32(0).u32(0).u32(1).u32(width).properties(properties);
}

pub fn scaled(kind: &'static str) -> Vec<(&'static str, Value)> {
    let mut properties = waveform();
    properties.extend([
        ("unit_string", Value::Text("m/s^2")),
        ("NI_Scaling_Status", Value::Text("unscaled")),
        ("NI_Number_Of_Scales", Value::Unsigned(2)),
        ("NI_Scale[1]_Scale_Type", Value::Text(kind)),
        ("NI_Scale[1]_Linear_Slope", Value::Double(0.5)),
        ("NI_Scale[1]_Linear_Y_Intercept", Value::Double(3.0)),
        ("NI_Scale[1]_Linear_Input_Source", Value::Unsigned(0)),
    ]);
    properties
}

#[test]
fn daqmx_rows_are_scaled_and_other_scales_named() {
    let mut metadata = Writer::new(false);
    daqmx(&mut metadata, "/'g'/'a'", 30, 0, 6, &scaled("Linear"));
    daqmx(&mut metadata, "/'g'/'b'", 30, 4, 6, &scaled("Thermocouple"));
    let raw: Vec<u8> = (0..60_i16).flat_map(|k| [k, 999, -k]).flat_map(i16::to_le_bytes).collect();
    // Without the bit for DAQmx: it is missing in some files.
    let file = segment(NEW_LIST | RAW | INTERLEAVED, 2, &metadata, &raw);
    let recording = read(file.clone()).unwrap();
    assert_eq!(recording.channels.len(), 1);
    let expected: Vec<f64> = (0..60).map(|k| 0.5 * f64::from(k) + 3.0).collect();
    assert_eq!(samples(&recording.channels[0]), expected);
    has_note(&recording, "left out: t.tdms, column g.b: its scale 1 is of kind Thermocouple, only Linear is applied");
    let settings = IngestSettings { channel: Some("b".to_owned()), ..IngestSettings::default() };
    assert!(read_with(file, &settings).unwrap_err().to_string().contains("Thermocouple"));
}

#[test]
fn plain_data_are_scaled_only_where_they_are_unscaled() {
    for (status, factor, offset) in [("unscaled", 0.5, 3.0), ("scaled", 1.0, 0.0)] {
        let mut properties = scaled("Linear");
        properties.retain(|(name, _)| *name != "NI_Scaling_Status");
        properties.push(("NI_Scaling_Status", Value::Text(status)));
        let mut metadata = Writer::new(false);
        metadata.object("/'g'/'a'", Some((10, 60)), &properties);
        let mut raw = Writer::new(false);
        raw.doubles((0..60).map(f64::from));
        let recording = read(segment(NEW_LIST | RAW, 1, &metadata, &raw.bytes)).unwrap();
        assert_eq!(samples(&recording.channels[0])[10], 10.0 * factor + offset);
    }
}
