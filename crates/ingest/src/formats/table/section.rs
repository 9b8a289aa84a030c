//! One table of several in a text: from the line after a title to the end of its rows.

use crate::formats::table::rows::layout::Delimiter;
use crate::formats::text::lines::line_at;
use crate::formats::text::numbers::{field, unquoted};
use crate::{IngestError, Place};

/// Lines looked through for the title.
const LINE_LIMIT: usize = 9_000;

/// The text from the line after the first one that holds `title` (any case) up to the first blank line or line without
/// a leading number after its rows. Everything before becomes empty lines, so that line numbers stay.
pub fn cut(text: &[u8], title: &str, file: &str) -> Result<Vec<u8>, IngestError> {
    let wanted = title.trim().to_lowercase();
    let (mut offset, mut number) = (0, 1);
    let mut cut = Vec::new();
    let (mut inside, mut rows) = (false, false);
    while offset < text.len() {
        let (line, next) = line_at(text, offset, number, file)?;
        if inside {
            let is_row = starts_with_a_number(line.bytes);
            if rows && !is_row {
                break;
            }
            rows |= is_row;
            cut.extend_from_slice(&text[offset..next]);
        } else {
            cut.push(b'\n');
            inside = crate::formats::text::lines::decode(line.bytes).to_lowercase().contains(&wanted);
            if !inside && number > LINE_LIMIT {
                break;
            }
        }
        (offset, number) = (next, number + 1);
    }
    if rows {
        return Ok(cut);
    }
    let found = if inside {
        format!("no rows of numbers after the line with {title:?}")
    } else {
        format!("no line holds {title:?}")
    };
    Err(IngestError::content(Place::file(file), found, "the title of a table in this file", "correct --skip-to"))
}

fn starts_with_a_number(line: &[u8]) -> bool {
    let numeric = |bytes: &[u8]| field(bytes, b'.').is_some() || field(bytes, b',').is_some();
    [Delimiter::Byte(b'\t'), Delimiter::Byte(b';'), Delimiter::Byte(b','), Delimiter::Blanks].into_iter().any(|way| {
        let fields = way.split(line);
        fields.len() >= 2 && numeric(unquoted(fields[0]))
    })
}

#[cfg(test)]
mod tests {

    #[test]
    fn the_section_is_cut_out_and_lines_keep_their_numbers() {
        let text = b"Report\nPre-Crash\nt,v\n-5,60\n-4,60\n\nLongitudinal Crash Pulse (event 1)\nTime (msec),Delta-V \
            (km/h)\n0,0\n10,-1\n\nLateral\n0,0\n";
        let cut = super::cut(text, "longitudinal crash pulse", "a.csv").unwrap();
        assert_eq!(cut, b"\n\n\n\n\n\n\nTime (msec),Delta-V (km/h)\n0,0\n10,-1\n");
        let error = super::cut(text, "Rollover", "a.csv").unwrap_err();
        assert_eq!(error.to_string(), "a.csv: no line holds \"Rollover\"");
    }
}
