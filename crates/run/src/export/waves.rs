//! The waveforms of a run as other programs call them, and as tables: a column a waveform, a table a sampling rate.

use std::collections::BTreeMap;

use crumple_artifact::Artifact;
use crumple_signal::{QuantityKind, Sampled};
use crumple_stage::chain;

use crate::table::{Cell, Kind, Table};

/// What moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Source {
    /// The test.
    Test,
    /// A candidate, or an identified model.
    Model,
    /// An impact that was not made.
    Prediction,
}

/// A waveform of a run.
#[derive(Debug, Clone)]
pub(crate) struct RunWave<'a> {
    /// What moves.
    pub(crate) source: Source,
    /// `accel_g`, `accel_g/unfiltered`, `kelvin/direct-fit/1`, `.../m2`, `prediction/3`.
    pub(crate) body: String,
    /// Quantity and SI unit: `displacement_m`, `force_k1_n`.
    pub(crate) field: String,
    /// What is measured.
    pub(crate) quantity: QuantityKind,
    /// Grid and samples.
    pub(crate) sampled: &'a Sampled,
}

/// Nanoseconds of a time, rounded.
pub(crate) fn to_ns(t_s: f64) -> i64 {
    (t_s * 1e9).round() as i64
}

impl RunWave<'_> {
    /// Time of a sample on the record's own axis, ns: of the first sample that time and the whole intervals to it.
    pub(crate) fn time_ns(&self, index: usize) -> i64 {
        to_ns(self.sampled.t0_s()) + to_ns(index as f64 * self.sampled.dt_s())
    }

    /// Its column in a table.
    fn column(&self) -> String {
        format!("{}/{}", self.body, self.field)
    }
}

/// A quantity with its unit as it stands in names: `acceleration_m_per_s2`.
pub(crate) fn with_unit(name: &str, unit: &str) -> String {
    match unit {
        "" | "1" => name.to_owned(),
        _ => {
            let unit = unit.replace('/', "_per_").replace('^', "").replace(['*', '·'], "_").to_lowercase();
            format!("{name}_{unit}")
        }
    }
}

/// The waveforms of artifacts of a run, in their order.
pub(crate) fn waves_of(artifacts: &[Artifact]) -> Vec<RunWave<'_>> {
    let mut waves = Vec::new();
    for artifact in artifacts {
        let file = artifact.path().file_name().unwrap_or_default().to_string_lossy();
        let stage =
            chain().find(|stage| stage.outputs.iter().any(|name| **name == *file)).map_or("", |stage| stage.name);
        let source = match stage {
            "identify" | "simulate" => Source::Model,
            "predict" => Source::Prediction,
            _ => Source::Test,
        };
        for (id, wave) in artifact.waves() {
            let (name, unit) = (wave.quantity.name(), wave.quantity.si_unit());
            let (before, last) = id.rsplit_once('/').unwrap_or(("", id));
            let (body, field) = match (last.strip_suffix(name), before.rsplit_once('/')) {
                (Some(""), _) if !before.is_empty() => (before.to_owned(), with_unit(name, unit)),
                // `partner-displacement` of a prediction.
                (Some(of), _) if of.ends_with('-') && !before.is_empty() => {
                    (format!("{before}/{}", &of[..of.len() - 1]), with_unit(name, unit))
                }
                // `force/k1` of a candidate.
                (_, Some((body, quantity))) if quantity == name => {
                    (body.to_owned(), with_unit(&format!("{name}_{last}"), unit))
                }
                _ => (id.clone(), with_unit(name, unit)),
            };
            let body = if stage == "ingest" { format!("{body}/unfiltered") } else { body };
            waves.push(RunWave { source, body, field, quantity: wave.quantity, sampled: &wave.sampled });
        }
    }
    waves
}

/// A sampling rate as it is called: `20kHz`.
fn rate(sampled: &Sampled) -> String {
    let rate = (sampled.rate_hz() * 1e3).round() / 1e3;
    if rate < 1e3 { format!("{rate}Hz") } else { format!("{}kHz", rate / 1e3) }
}

/// When a waveform begins, as the name of a table has it: `20ms`, `minus-50ms`.
fn begin(from_ns: i64) -> String {
    let sign = if from_ns < 0 { "minus-" } else { "" };
    format!("{sign}{}ms", 1e-6 * from_ns.unsigned_abs() as f64)
}

/// Rows by which Polars and others tell the type of a column.
const ROWS_OF_A_TYPE: f64 = 100.0;

/// The waveforms as tables: those of the test at the rate of its first motion are called `waves`, those of models and
/// predictions `simulated`, of other rates `waves-20kHz`, those that begin 100 rows later and more `waves-from-0ms`. A
/// row is an instant of any waveform; one that has no sample there has an empty cell.
///
/// `decimate`: of so many rows those stay in which a waveform is lowest or highest among them, whole.
pub(crate) fn wave_tables(waves: &[RunWave<'_>], decimate: Option<usize>) -> Vec<Table> {
    let is_of_motion = |wave: &&RunWave<'_>| wave.source == Source::Test && wave.quantity == QuantityKind::Displacement;
    let first = waves.iter().find(is_of_motion).or(waves.first()).map(|wave| rate(wave.sampled));
    let mut rates: BTreeMap<(bool, bool, String), Vec<&RunWave<'_>>> = BTreeMap::new();
    for wave in waves {
        let own = rate(wave.sampled);
        rates.entry((wave.source != Source::Test, Some(&own) != first.as_ref(), own)).or_default().push(wave);
    }
    let mut groups: Vec<(String, Vec<&RunWave<'_>>)> = Vec::new();
    for ((is_of_model, is_other, rate), waves) in rates {
        let name = if is_of_model { "simulated" } else { "waves" };
        let name = if is_other { format!("{name}-{rate}") } else { name.to_owned() };
        // What begins late would have blanks in the rows by which readers tell the type of a column.
        let begin_ns = waves.iter().map(|wave| wave.time_ns(0)).min().unwrap_or(0);
        let room_ns = waves.iter().map(|wave| to_ns(ROWS_OF_A_TYPE * wave.sampled.dt_s())).min().unwrap_or(0);
        let mut late: BTreeMap<i64, Vec<&RunWave<'_>>> = BTreeMap::new();
        for wave in waves {
            let own_ns = wave.time_ns(0);
            late.entry(if own_ns - begin_ns < room_ns { begin_ns } else { own_ns }).or_default().push(wave);
        }
        let named = |(from_ns, waves)| {
            (if from_ns == begin_ns { name.clone() } else { format!("{name}-from-{}", begin(from_ns)) }, waves)
        };
        groups.extend(late.into_iter().map(named));
    }
    let table = |(name, waves): &(String, Vec<&RunWave<'_>>)| {
        let name = name.clone();
        let table = table_of(name, waves);
        decimate.map_or_else(|| table.clone(), |every| decimated(&table, every))
    };
    groups.iter().map(table).collect()
}

fn table_of(name: String, waves: &[&RunWave<'_>]) -> Table {
    let mut instants: BTreeMap<i64, usize> = BTreeMap::new();
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for (number, wave) in waves.iter().enumerate() {
        for (k, value) in wave.sampled.samples().iter().enumerate() {
            let row = *instants.entry(wave.time_ns(k)).or_insert_with(|| {
                let mut row = vec![Cell::Empty; waves.len() + 1];
                row[0] = Cell::Number(wave.sampled.time_s(k));
                rows.push(row);
                rows.len() - 1
            });
            rows[row][number + 1] = Cell::Number(*value);
        }
    }
    let rows = instants.into_values().map(|row| std::mem::take(&mut rows[row])).collect();
    let columns = std::iter::once("time_s".to_owned()).chain(waves.iter().map(|wave| wave.column()));
    let mut table = Table::new(name, columns.map(|name| (name, Kind::Number)).collect(), rows);
    table.units = std::iter::once(("time_s".to_owned(), "s"))
        .chain(waves.iter().map(|wave| (wave.column(), wave.quantity.si_unit())))
        .collect();
    table
}

/// Of every so many rows those in which a column is lowest or highest.
fn decimated(table: &Table, every: usize) -> Table {
    let mut rows = Vec::new();
    for chunk in table.rows.chunks(every) {
        let mut is_kept = vec![false; chunk.len()];
        for column in 1..table.columns.len() {
            let values = || {
                chunk.iter().enumerate().filter_map(|(k, row)| match row[column] {
                    Cell::Number(value) => Some((k, value)),
                    _ => None,
                })
            };
            // The first of equals, at both ends.
            let lowest = values().min_by(|a, b| a.1.total_cmp(&b.1));
            let highest = values().min_by(|a, b| b.1.total_cmp(&a.1));
            lowest.into_iter().chain(highest).for_each(|(k, _)| is_kept[k] = true);
        }
        rows.extend(chunk.iter().zip(is_kept).filter(|(_, kept)| *kept).map(|(row, _)| row.clone()));
    }
    Table { rows, ..table.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave<'a>(body: &str, sampled: &'a Sampled) -> RunWave<'a> {
        let (field, quantity) = ("displacement_m".to_owned(), QuantityKind::Displacement);
        RunWave { source: Source::Test, body: body.to_owned(), field, quantity, sampled }
    }

    #[test]
    fn a_row_is_an_instant_and_what_has_no_sample_there_is_empty() {
        let early = Sampled::new(-0.002, 1e-3, vec![1.0, 2.0, 3.0, 4.0]).unwrap();
        let late = Sampled::new(0.0, 1e-3, vec![5.0, 6.0, 7.0]).unwrap();
        let fast = Sampled::new(0.0, 5e-5, vec![8.0, 9.0]).unwrap();
        let model = RunWave { source: Source::Model, ..wave("d", &late) };
        let tables = wave_tables(&[wave("a", &early), wave("b", &late), wave("c", &fast), model], None);
        assert_eq!(tables.iter().map(|table| &*table.name).collect::<Vec<_>>(), ["waves", "waves-20kHz", "simulated"]);
        // It begins where its waveforms do: a reader that looks at the first rows sees numbers.
        assert_eq!(tables[2].rows[0], [Cell::Number(0.0), Cell::Number(5.0)]);
        let numbers = |row: &Vec<Cell>| -> Vec<Option<f64>> {
            row.iter().map(|cell| if let Cell::Number(x) = cell { Some(*x) } else { None }).collect()
        };
        let rows: Vec<_> = tables[0].rows.iter().map(numbers).collect();
        assert_eq!(rows[0][1..], [Some(1.0), None]);
        assert_eq!(rows[2], [Some(0.0), Some(3.0), Some(5.0)]);
        assert_eq!((rows.len(), &rows[4][1..]), (5, &[None, Some(7.0)][..]));
        assert_eq!(tables[0].columns[1].0, "a/displacement_m");
    }

    #[test]
    fn what_begins_late_is_a_table_of_its_own() {
        let early = Sampled::new(-0.05, 1e-4, vec![1.0; 1000]).unwrap();
        let late = Sampled::new(0.0, 1e-4, vec![5.0; 500]).unwrap();
        let tables = wave_tables(&[wave("a", &early), wave("b", &late)], None);
        assert_eq!(tables.iter().map(|table| &*table.name).collect::<Vec<_>>(), ["waves", "waves-from-0ms"]);
        assert_eq!(tables[1].rows[0], [Cell::Number(0.0), Cell::Number(5.0)]);
        let earlier = Sampled::new(-0.2, 1e-4, vec![1.0; 3000]).unwrap();
        let tables = wave_tables(&[wave("a", &earlier), wave("b", &early)], None);
        assert_eq!(&*tables[1].name, "waves-from-minus-50ms");
    }

    #[test]
    fn peaks_stay_where_rows_are_left_out() {
        let samples: Vec<f64> =
            (0..1000).map(|k| f64::from(k * 37 % 101) + if k == 513 { 500.0 } else { 0.0 }).collect();
        let sampled = Sampled::new(0.0, 1e-4, samples).unwrap();
        let whole = &wave_tables(&[wave("a", &sampled)], None)[0];
        let table = &wave_tables(&[wave("a", &sampled)], Some(50))[0];
        assert!(table.rows.len() <= 40 && table.rows.contains(&whole.rows[513]));
        assert!(table.rows.iter().all(|row| whole.rows.contains(row)), "nothing is interpolated");
    }

    #[test]
    fn units_stand_in_names() {
        for (unit, name) in [("m/s^2", "a_m_per_s2"), ("N*m", "a_n_m"), ("1", "a"), ("N·s/m", "a_n_s_per_m")] {
            assert_eq!(with_unit("a", unit), name);
        }
    }
}
