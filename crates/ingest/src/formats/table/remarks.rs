//! What is remarked about tables: gaps, times, names, texts of loggers, tables of event data recorders.

use crumple_signal::{About, Weight, remarks};

use crate::formats::table::event_data_recorder::not_complete;

remarks! {
    /// Remarks of tables.
    pub REMARKS;

    /// Rows have no number in columns that are needed, and are left out.
    CR043 RowsWithGaps { rows: usize, of: usize, columns: String }
    bears on (About::Record, Weight::Slight)
    decided "A column that is needed and lacks a number in a tenth of the rows and more is a slower channel. Fewer \
             gaps, and gaps in times, are refused."
    means "Only rows with a number in all of these columns are samples: faster channels lose what is between them."
    remedy "nothing; export each rate into a file of its own to keep all samples"
    says format!("{rows} of {of} rows have no number in {columns}, and are left out");

    /// Columns with gaps are left out.
    CR044 ColumnsWithGaps { columns: String }
    bears on (About::Record, Weight::Slight)
    decided "A row of the column has no number, and the column is not needed: it is neither the time nor the column \
             asked for, nor needed as the pulse."
    means "They are no channels. All others are as in the file."
    remedy "name the column by --channel where it is the pulse"
    says format!("columns with gaps are left out: {columns}; --channel takes the one it names");

    /// A table of a report of an event data recorder cannot be read.
    CR045 TableNotRead { table: String, reason: String }
    bears on (About::Record, Weight::Slight)
    decided "Another table of the report holds the change of velocity, or channels are only listed; the sentence says \
             what is wrong with this one."
    means "Its columns are no channels: an axis or a second event may be missing."
    remedy "mend what the sentence names, or name the table by --skip-to"
    says format!("{table} is not read: {reason}");

    /// The recorder says that its file is not complete.
    CR046 FileNotComplete { line: usize, words: String }
    bears on (About::Motion, Weight::Decisive)
    decided "The report says no to \"complete file recorded\"."
    means "What was not recorded is missing: the change of velocity may end before the crash does."
    remedy "use the change of velocity as a lower bound, or another record of the crash"
    says format!("{}: the event may be cut off", not_complete(*line, words));

    /// The record is a table of an event data recorder, which is coarse.
    CR047 OfARecorder {}
    bears on (About::Motion, Weight::Marked)
    decided "The record is read with --profile edr (49 CFR 563). As a rule a recorder keeps a value every 10 ms, in \
             whole km/h or mph."
    means "Delta-v holds to the last printed digit. The peak and the force between two values are not known, and the \
           crush is rough."
    remedy "quote delta-v; take peak, force and stiffness from an accelerometer"
    says "event data recorder table: the velocity change is cumulative and coarse (as a rule 10 ms, whole km/h or \
          mph), and how the recorder filtered it is not stated: peak acceleration and force cannot be taken from it, \
          crush roughly";

    /// Cells hold two numbers, and the name of their column not two units.
    CR048 TwoNumbers { column: String }
    bears on (About::Record, Weight::Slight)
    decided "Cells such as -2 [-3] say one thing in two units, which the name of the column states: MPH [km/h]."
    means "The first number is used, in the unit of the name. The second is not compared with it."
    remedy "check the unit of the column in the report"
    says format!("two numbers in the cells of column {column}, but not two units in its name: the first is used");

    /// The two numbers of a cell, in two units, do not agree.
    CR049 TwoUnitsDiffer {
        cells: usize, column: String, first: String, second: String, cell: String, line: usize, used: String
    }
    bears on (About::Record, Weight::Slight)
    decided "Both are compared in SI; half the last printed digit of each is left. The unit that is printed more \
             finely is used."
    means "A number was changed or misread, or a unit is another one: these values may be wrong."
    remedy "compare the cells with the original report"
    says format!(
        "{cells} cells of column {column} say two different things in {first} and {second}, the worst {cell:?} in line \
         {line}: {used} is used"
    );

    /// The times of a column do not increase, so that the stated interval counts.
    CR050 TimesStandStill { column: String }
    bears on (About::Record, Weight::Slight)
    decided "--sample-time is given, and the column is named as time; two times and more repeat the one before or run \
             back."
    means "The rows are one interval apart. If rows are missing, later times are too early."
    remedy "check the interval against the recorder, or export times with more decimals"
    says format!("the times of column {column} do not increase from row to row: --sample-time counts");

    /// A column counts the rows or repeats the times, and is no channel.
    CR051 NoChannel { number: usize, column: String, times_of: Option<String> }
    bears on (About::Record, Weight::None)
    decided "A counter is named as one or has no name, and grows by one. A further column of times keeps the steps of \
             the first one to half a step."
    means "It is left out. All other columns are as in the file."
    remedy "nothing"
    says match times_of {
        Some(first) => format!("column {number} ({column}) repeats the times of column {first}: left out"),
        None => format!("column {number} ({column}) counts the rows: left out"),
    };

    /// The header has another number of names than the rows have columns.
    CR052 NamesAndColumns { file: String, names: usize, columns: usize }
    bears on (About::Record, Weight::Slight)
    decided "The names of the last line of text above the rows are counted, and the fields of the rows."
    means "The names may stand above other columns than their own: a channel, a unit or the time may be taken for \
           another."
    remedy "give every column a name, and check the channel of the pulse"
    says match names > columns {
        true => format!("{names} names in the header of {file}, but {columns} columns: the first names are used"),
        false => format!(
            "{columns} fields in the rows of {file}, but {names} names in its header: which of them stands above which \
             is not known"
        ),
    };

    /// The unit kg of an acceleration is read as thousand g.
    CR053 KiloG { factor_m_per_s2: f64 }
    bears on (About::Record, Weight::None)
    decided "A column that is named as an acceleration cannot be in kilograms."
    means "Its values are multiplied by 9806.65 m/s^2, 1000 times standard gravity."
    remedy "state another unit by --unit where that is wrong"
    says format!("unit kg in a column of acceleration is read as kilo-g, {factor_m_per_s2} m/s^2");

    /// Lines before the first row or after the last are left out.
    CR054 LinesAtEnds { file: String, count: usize, line: usize, words: Option<String> }
    bears on (About::Record, Weight::Slight)
    decided "A row without values, or with its time alone, is no sample where no other row lies beyond it; nor is text \
             below the rows."
    means "No sample is lost, unless the text begins another table."
    remedy "open the file at that line, and check that the record ends there"
    says match words {
        None => format!("{count} rows without values at the ends of {file} are left out, the first is line {line}"),
        Some(words) => {
            format!("{count} lines of text below the rows of {file} are not used, from line {line}: {words:?}")
        }
    };

    /// A recorder kept accelerations; they are integrated to a change of velocity.
    CR055 Integrated { column: String }
    bears on (About::Record, Weight::None)
    decided "--profile edr reads changes of velocity. A recorder may keep accelerations (49 CFR 563, table II), and no \
             column holds a change of velocity."
    means "The change of velocity starts at zero with the record, and has any offset of the sensor in it."
    remedy "nothing; leave --profile edr out to read the acceleration as a pulse"
    says format!("column {column} is integrated to a change of velocity");

    /// Columns have the same title.
    CR056 SameTitles { count: usize, title: String, columns: Vec<String> }
    bears on (About::Record, Weight::Slight)
    decided "Titles are compared letter by letter. Each column has an id of its own, which the sentence names."
    means "Which sensor a column is of cannot be told by its title."
    remedy "name the column that is meant by --channel with its id or its number, or rename the columns"
    says format!("{count} columns have the title {title:?}: {}", columns.join(", "));

    /// The text of a logger is read as a table.
    CR057 TextOfLogger {
        form: &'static str, interval_s: Option<f64>, series: Option<usize>, names: Option<String>
    }
    bears on (About::Record, Weight::None)
    decided "The first line says it (InfluxDB, LabVIEW, Gyroflow), or eight of ten of the first 60 lines have the \
             form: a clock before ->, a label before every number."
    means "Numbers are those of the text; names, times and scales stand where the sentence says."
    remedy "nothing"
    says match *form {
        "serial monitor" => "the clock in front of each row, before \"->\", is the time".to_owned(),
        "labels" => "the words before the numbers of each row are the names of its columns".to_owned(),
        "LabVIEW" => {
            format!("the sampling interval is that of the line dt, {} s", interval_s.unwrap_or_default())
        }
        "Gyroflow" => "Gyroflow IMU log: its scales (tscale, ascale, gscale) are applied".to_owned(),
        form => {
            let (series, names) = (series.unwrap_or_default(), names.as_deref().unwrap_or_default());
            format!("annotated CSV of {form}: {series} series: {names}")
        }
    };

    /// Lines of a logger that are no row are left out.
    CR058 LinesOfNoRow { lines: usize, line: usize, words: String }
    bears on (About::Record, Weight::Slight)
    decided "A row has the labels of the first one, each before a number."
    means "If such a line was a row, its sample is lost, and without a time in each row all later times are too early."
    remedy "remove lines that are no rows, or mend them"
    says format!(
        "the words before the numbers of each row are the names of its columns; {lines} lines that are no such row are \
         left out, the first is line {line}: {words:?}"
    );
}
