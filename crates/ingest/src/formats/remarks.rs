//! What several readers remark: what is left out, units, codes, times.

use crumple_signal::{About, Weight, remarks};

remarks! {
    /// Remarks that several readers make.
    pub REMARKS;

    /// Parts of the file are not read.
    CR001 PartsNotRead { parts: &'static str, names: String }
    bears on (About::Record, Weight::None)
    decided "A channel is numbers over time. Texts, nested data and empty channels are none. A universal file is read \
             from its data sets 58, a report of an event data recorder from the tables of its pulse."
    means "These parts are no channels. All others are as in the file."
    remedy "nothing; export what is wanted as a channel of numbers, or name a table of a report by --skip-to"
    says match *parts {
        "universal data sets" => format!("data sets of other kinds than 58 are not read: {names}"),
        "variables" => format!("variables that are no numbers are not read: {names}"),
        "tables" => format!("other tables of the report, not read: {names}"),
        "channels" => format!("no samples in {names}: left out"),
        parts => format!("{parts} that are not read: {names}"),
    };

    /// Columns of a table hold words, or words among their numbers.
    CR002 ColumnsOfWords { columns: String, table: Option<String>, with_words: usize }
    bears on (About::Record, Weight::None)
    decided "A cell is a word where it is no number, no time and not blank. In a report of an event data recorder one \
             word leaves out a column that is not named as the pulse."
    means "They are no channels. All others are as in the file."
    remedy "nothing; replace the words by blanks to have the numbers of such a column"
    says match table {
        None => format!("columns of words are left out: {columns}"),
        Some(table) if *with_words > 0 => {
            format!("columns with words among their numbers in the table {table:?} are not read: {columns}")
        }
        Some(table) => format!("columns of words in the table {table:?} are not read: {columns}"),
    };

    /// Columns or numbers begin later than the first rows.
    CR003 LateColumns { names: Option<String> }
    bears on (About::Record, Weight::Slight)
    decided "The first rows say which columns a table has. A column that they leave blank is none."
    means "What is filled in later is no channel. Where it is the pulse, the record lacks it."
    remedy "cut the rows before such a column begins, or fill its first row"
    says match names {
        Some(names) => format!("numbers that begin behind the first line are left out: {names}"),
        None => "columns that are blank in the first rows and filled later are left out".to_owned(),
    };

    /// Lines that are no part of the record are not used.
    CR004 LinesNotUsed { count: usize, file: Option<String>, line: Option<usize> }
    bears on (About::Record, Weight::None)
    decided "Text above the names of a table and objects of JSON without the numbers of the first one are no samples. \
             Of the lines of an ISO-MME test file 100 are kept."
    means "No sample is lost. Facts of the test that stand in these lines are not in the results."
    remedy "nothing; state mass or impact speed by flags where these lines hold them"
    says match (file, line) {
        (Some(file), Some(line)) => {
            format!("{count} lines of text above the header of {file} are not used, the first is line {line}")
        }
        (Some(file), None) => format!("{count} further lines of {file} are left out"),
        (None, _) => format!("{count} lines without the numbers of the first are left out"),
    };

    /// A line of a header or of a list of channels cannot be read.
    CR005 LineNotRead { file: String, line: usize, lines: usize, reason: Option<String> }
    bears on (About::Record, Weight::Slight)
    decided "A header of ISO-MME holds keywords with a colon, then numbers. A line of an EV5 list has a curve number \
             of its own; at most five lines of a list are named."
    means "What the line says is not known: a channel, or a fact about one, may be missing."
    remedy "open the file at that line and correct it, or export or download it again"
    says match reason {
        Some(reason) => format!("{file}, line {line}, is left out: {reason}"),
        None => format!("{file}, line {line}: neither a keyword nor a number, left out ({lines} such lines)"),
    };

    /// The file ends before it should: the recording was aborted, or the copy is cut short.
    CR006 CutShort {
        file: Option<String>, left_bytes: Option<usize>, segment_at_byte: Option<usize>, stated_bytes: Option<u64>,
        data_at_byte: Option<usize>
    }
    bears on (About::Record, Weight::Slight)
    decided "The lengths that a TDMS file states are compared with its bytes; an EV5 file ends with ----- END -----. \
             At most twelve such places are named."
    means "What is there is read. The end of the crash, or whole channels, may be missing."
    remedy "copy, download or export the file again; if the recording was aborted, check that it covers the crash"
    says match (file, left_bytes, segment_at_byte) {
        (Some(file), ..) => format!(
            "{file} does not end with ----- END -----: it may be cut short, and channels be missing; download it again"
        ),
        (_, Some(left), _) => format!("the file ends with {left} bytes that are no whole segment"),
        (_, _, Some(at)) => {
            let what = if stated_bytes.is_some() { "is longer than the file" } else { "has no length" };
            format!("the segment at byte {at} {what}: the recording was aborted, it is read as far as it goes")
        }
        _ => {
            let start = data_at_byte.unwrap_or_default();
            format!("the raw data from byte {start} on end in the middle of a chunk")
        }
    };

    /// A channel cannot be read and is left out.
    CR007 ChannelLeftOut {
        channel: Option<String>, file: Option<String>, more: Option<usize>, reason: Option<String>
    }
    bears on (About::Record, Weight::Slight)
    decided "Its samples, its times or its file are not what the format asks for: the sentence has the reason. Of a \
             file of waveforms twelve channels are named."
    means "It has no samples in the results. All other channels are as in the file."
    remedy "mend what the sentence names, or export the channel again"
    says {
        let reason = reason.as_deref().unwrap_or_default();
        match (more, channel, file) {
            (Some(more), ..) => format!("{more} more channels are left out"),
            (_, Some(channel), _) => format!("channel {channel} is left out: {reason}"),
            (_, _, Some(_)) => format!("a channel is left out: {reason}"),
            _ => format!("left out: {reason}"),
        }
    };

    /// Channels are listed, and have no samples here.
    CR008 ChannelsAbsent {
        count: usize, listed: Option<usize>, list: Option<String>, channels: Option<String>
    }
    bears on (About::Record, Weight::None)
    decided "The list of channels is compared with the files beside it. DASTAT NO of an EV5 list says that a channel \
             was not installed."
    means "They are listed without samples."
    remedy "nothing; where files are missing, give the whole folder of the test or its archive"
    says {
        let channels = channels.as_deref().unwrap_or_default();
        match (listed, list) {
            (None, _) => format!("{count} listed channels were not installed: {channels}"),
            (Some(listed), Some(list)) => {
                format!("{count} of {listed} channels listed in {list} have no file here")
            }
            (Some(listed), None) => {
                format!("{count} of {listed} listed channels have no signal file here: {channels}")
            }
        }
    };

    /// A header states another number of samples than the file has.
    CR009 SampleCount {
        file: Option<String>, segment: Option<usize>, channels: Option<usize>, stated: f64, found: usize, used: usize
    }
    bears on (About::Record, Weight::Slight)
    decided "The number of the header is compared with the samples that follow it. Where an ISO-MME file has more, \
             those beyond the number are left off; else all are used."
    means "The file may be cut short or hold the header of another one. The end of the record may be wrong."
    remedy "export the channel again, or compare its length with that of the others"
    says match (segment, file.as_deref().unwrap_or_default()) {
        (Some(segment), _) => {
            let channels = channels.unwrap_or_default();
            format!(
                "segment {segment}: {stated} samples are announced, {found} are there, in {channels} channels: those \
                 are used"
            )
        }
        (None, file) if used < found => {
            format!("{file}: the header states {stated} samples, the file has {found}: the first {used} are used")
        }
        (None, file) => format!("{file}: the header states {stated} samples, the file has {found}: those are used"),
    };

    /// Samples are missing at the ends of a channel, and are left off.
    CR010 MissingAtEnds { file: Option<String>, channels: Option<String>, before: usize, after: usize }
    bears on (About::Record, Weight::Slight)
    decided "NaN at the end of a waveform and NOVALUE at both ends of an ISO-MME channel are no samples. Inside they \
             are refused."
    means "The channel begins later or ends earlier than others. Nothing is filled in, and no time is moved."
    remedy "nothing where the crash lies within the rest; else export the channel again"
    says match (file, channels) {
        (Some(file), _) => {
            format!("{file}: NOVALUE at {before} samples before and {after} after the data: left off")
        }
        (None, channels) => {
            let channels = channels.as_deref().unwrap_or_default();
            format!("{after} missing samples (NaN) were cut off at the end of {channels}")
        }
    };

    /// The unit of channels is not stated, or not known.
    CR011 UnitUnknown { unit: Option<String>, channels: String }
    bears on (About::Record, Weight::None)
    decided "A unit stands in the name, in the header or in a field of the channel. Units are not guessed."
    means "The numbers are kept as read, and the channel has the quantity other: nothing is computed from it."
    remedy "nothing; --unit states the unit of an acceleration, --scale turns volts or counts into a quantity"
    says match unit {
        Some(unit) => format!("unit {unit:?} is not known: channels {channels} are kept as read, quantity other"),
        None => format!("no unit is known for {channels}: kept as read, quantity other"),
    };

    /// A channel of messages or of an ISO-MME test has no unit that is known.
    CR012 UnitNotStated { file: Option<String>, unit: Option<String>, quantity: Option<String> }
    bears on (About::Record, Weight::Slight)
    decided "Fields of messages state no unit. An ISO-MME channel has a line Unit. Units are not guessed."
    means "The numbers are kept as read, and the channel has the quantity other: nothing is computed from it."
    remedy "state the unit by --unit g or --unit m/s^2"
    says match file {
        None => {
            "no unit is known for the fields: kept as read, quantity other; --unit m/s^2 or --unit g states it".into()
        }
        Some(file) => {
            let of_unit = |unit: &String| format!("unit {unit:?} is not known");
            let reason = unit.as_ref().map_or_else(|| "no unit is stated".to_owned(), of_unit);
            let may_be_the_pulse = quantity.as_deref() == Some("acceleration");
            let hint = if may_be_the_pulse { "; --unit g or --unit m/s^2 states it" } else { "" };
            format!("{file}: {reason}: kept as read, quantity other{hint}")
        }
    };

    /// The unit that the file states was replaced by that of a flag or the sidecar.
    CR013 UnitReplaced { channel: Option<String>, column: Option<String>, stated_m_per_s2: f64, used_m_per_s2: f64 }
    bears on (About::Pulse, Weight::Marked)
    decided "--unit or the sidecar states another unit of acceleration than the file, and means this channel: the one \
             of --channel, or the only acceleration."
    means "Every value of the pulse is in the unit of the flag. If the file was right, all results are wrong by the \
           ratio of both."
    remedy "leave --unit out, unless the file is known to be wrong"
    says match (channel, column.as_deref().unwrap_or_default()) {
        (Some(channel), _) => format!(
            "the unit of channel {channel} is {stated_m_per_s2} m/s^2 by the file, {used_m_per_s2} m/s^2 by the flag \
             or sidecar: that is used"
        ),
        (None, column) => format!(
            "the header of column {column} says its unit is {stated_m_per_s2} m/s^2, the flag or sidecar says \
             {used_m_per_s2} m/s^2: that is used"
        ),
    };

    /// The code of a channel names another quantity than its unit.
    CR014 CodeAgainstUnit { place: String, of_code: String, of_unit: String }
    bears on (About::Record, Weight::Slight)
    decided "The dimension in the code (ISO/TS 13499) is compared with the quantity of the unit; the unit is taken."
    means "If the code is right, the channel is another quantity than it is read as."
    remedy "check code and unit of the channel in the file"
    says format!("{place}: the code says {of_code}, the unit is one of {of_unit}: the unit is taken");

    /// Channels or columns hold the times of others.
    CR015 TimeChannels { names: String, pairs: Option<usize> }
    bears on (About::Record, Weight::None)
    decided "A channel of times has a unit of time, or a name of time and no unit, and its values increase. A column \
             of times belongs to the columns behind it where a table has several that differ."
    means "They are no channels of the record; the others are over them."
    remedy "nothing"
    says match pairs {
        Some(pairs) => format!("{pairs} columns of times, each of the channels behind it: {names}"),
        None => format!("{names} is the time axis of the other channels"),
    };

    /// The times of the file are those of a clock; the first one is t = 0.
    CR016 TimesFromFirst { column: Option<String>, since_start_s: Option<f64>, first_s: Option<String> }
    bears on (About::Record, Weight::None)
    decided "The times are stamps, those of a clock or a calendar, or count from the start of the program that wrote \
             them: its clock and X0 agree within 1 ms."
    means "Only the zero of the time axis is moved. Contact is looked for on the new axis."
    remedy "nothing; --time-zero states first contact, counted from the first time"
    says match (column, since_start_s) {
        (Some(column), _) => format!(
            "the times of column {column} count from the first one; --time-zero states first contact on that axis"
        ),
        (None, Some(since)) => format!(
            "X0 = {since} s is the time since the program began, by the clock: the samples start at t = 0, and \
             --time-zero counts from there"
        ),
        (None, None) => {
            let first_s = first_s.as_deref().unwrap_or_default();
            format!("t = 0 is the first message, at {first_s} s of its clock; --time-zero states first contact")
        }
    };

    /// Samples were brought to a uniform rate.
    CR017 Resampled { topic: Option<String>, times: Option<String>, count: Option<usize>, words: String }
    bears on (About::Record, Weight::Slight)
    decided "--resample asks for it. Samples are interpolated linearly between the times of the file."
    means "Nothing new is known between the samples, and narrow peaks become a little lower. The sentence has the \
           jitter of the times, as a part of their median step."
    remedy "nothing; a record at a uniform rate does without"
    says {
        let count = count.unwrap_or_default();
        match (topic, times) {
            (Some(topic), _) => format!("topic {topic}: {count} messages are resampled {words}"),
            (None, Some(times)) => format!("channels timed by {times} are resampled {words}"),
            (None, None) => format!("{count} rows are resampled {words}"),
        }
    };
}

impl CutShort {
    /// It is not said where.
    pub const SOMEWHERE: Self =
        Self { file: None, left_bytes: None, segment_at_byte: None, stated_bytes: None, data_at_byte: None };
}
