//! LSDA, the container of a binout: values behind each other, and chained tables of symbols that say what they are.
//!
//! After the header stand records: length, command, content. A table gives for every variable its path, type, count and
//! the place of its values; a table is written after each state. Only tables are trusted; a chain that breaks because
//! the file is cut leaves what was written before. Source: the format note of the LSTC I/O library.

use std::collections::BTreeMap;

/// Commands of records.
const CD: u64 = 2;
const VARIABLE: u64 = 4;
const TABLE: u64 = 5;
const END_OF_TABLE: u64 = 6;
const FIRST_TABLE: u64 = 7;
/// Longest path: relative ones would grow without end.
const LONGEST_PATH: usize = 255;
/// Bytes of all variables over those of the files: a restart names some again.
const MOST_CLAIMED: usize = 4;

/// Sizes of fields, and the order of bytes.
#[derive(Debug, Clone, Copy)]
struct Form {
    header: usize,
    length: usize,
    offset: usize,
    command: usize,
    kind: usize,
    is_little: bool,
}

impl Form {
    fn of(bytes: &[u8]) -> Option<Self> {
        let size = |k: usize| bytes.get(k).map(|b| usize::from(*b)).filter(|size| matches!(size, 1 | 2 | 4 | 8));
        let header = usize::from(*bytes.first()?);
        let form = Self {
            header,
            length: size(1)?,
            offset: size(2)?,
            command: size(3)?,
            kind: size(4)?,
            is_little: *bytes.get(5)? == 1,
        };
        (header >= 8 && bytes[5] <= 1 && *bytes.get(6)? == 0).then_some(form)
    }

    fn whole(self, bytes: &[u8], at: usize, size: usize) -> Option<u64> {
        let field = bytes.get(at..at.checked_add(size)?)?;
        let add = |value: u64, byte: &u8| (value << 8) | u64::from(*byte);
        Some(if self.is_little { field.iter().rev().fold(0, add) } else { field.iter().fold(0, add) })
    }

    /// Length, command and place of the content of the record at a place.
    fn record(self, bytes: &[u8], at: usize) -> Option<(usize, u64, usize)> {
        let length = usize::try_from(self.whole(bytes, at, self.length)?).ok()?;
        let command = self.whole(bytes, at.checked_add(self.length)?, self.command)?;
        let content = at + self.length + self.command;
        (length >= self.length + self.command).then_some((length, command, content))
    }
}

/// Whether a file that starts so is of this kind.
pub fn recognises(head: &[u8]) -> bool {
    Form::of(head).is_some_and(|form| matches!(form.record(head, form.header), Some((_, FIRST_TABLE, _))))
}

/// Values of a variable.
#[derive(Debug, Clone, Copy)]
struct Variable {
    file: usize,
    kind: u64,
    at: usize,
    count: usize,
}

/// The folders of one result, of all its files.
pub struct Tree<'a> {
    files: Vec<(&'a [u8], Form)>,
    /// Bytes of the files, and of all variables: many may name the same values.
    bytes: usize,
    claimed: usize,
    folders: BTreeMap<String, BTreeMap<String, Variable>>,
}

impl<'a> Tree<'a> {
    /// No folders yet.
    pub fn new() -> Self {
        Self { files: Vec::new(), bytes: 0, claimed: 0, folders: BTreeMap::new() }
    }

    /// Adds the folders of a file; what it has again replaces what was there. Returns whether it is whole.
    ///
    /// # Errors
    /// What contradicts itself: offsets beyond the end, tables that point back, paths without end.
    pub fn add(&mut self, bytes: &'a [u8]) -> Result<bool, String> {
        let form = Form::of(bytes).ok_or("its header is not that of a binout")?;
        let (length, command, content) = form.record(bytes, form.header).ok_or("the file ends in its header")?;
        let first = form.whole(bytes, content, form.offset).filter(|_| command == FIRST_TABLE);
        let first = first.ok_or("no table of symbols is named behind the header")?;
        self.files.push((bytes, form));
        self.bytes += bytes.len();
        let (mut at, mut behind, mut tables) = (first, form.header.saturating_add(length), 0_usize);
        while at != 0 {
            let start = usize::try_from(at).unwrap_or(usize::MAX);
            if start < behind {
                return Err(format!(
                    "the table of symbols at byte {start} is named behind byte {behind}: tables circle"
                ));
            }
            match self.table(form, bytes, start)? {
                Some((next, end)) => (at, behind, tables) = (next, end, tables + 1),
                None if tables == 0 => return Err("it ends before its first table of symbols".to_owned()),
                None => {
                    // What follows the last table holds no other one, or its place is stated wrongly.
                    while let Some((length, command, content)) = form.record(bytes, behind) {
                        if command == TABLE && start >= bytes.len() {
                            return Err(format!("a table of symbols is named at byte {start}, beyond the end"));
                        }
                        behind = if command == TABLE { content } else { behind.saturating_add(length) };
                    }
                    return Ok(false);
                }
            }
        }
        Ok(tables > 0)
    }

    /// Reads a table; the place of the next one and where this one ends, or `None` where the file ends before.
    fn table(&mut self, form: Form, bytes: &[u8], start: usize) -> Result<Option<(u64, usize)>, String> {
        let Some((_, command, mut at)) = form.record(bytes, start) else { return Ok(None) };
        if command != TABLE {
            return Err(format!("at byte {start} stands no table of symbols, which is named there"));
        }
        let mut path = String::new();
        let mut found = Vec::new();
        loop {
            let Some((length, command, content)) = form.record(bytes, at) else { return Ok(None) };
            let Some(body) = at.checked_add(length).and_then(|end| bytes.get(content..end)) else { return Ok(None) };
            match command {
                CD => path = joined(&path, &String::from_utf8_lossy(body))?,
                VARIABLE => {
                    let fields = form.kind + form.offset + form.length;
                    let name = body.len().checked_sub(fields).ok_or("a symbol without a name")?;
                    let variable = self.variable(form, bytes, (content + name, name))?;
                    found.push((path.clone(), String::from_utf8_lossy(&body[..name]).into_owned(), variable));
                }
                END_OF_TABLE => {
                    let Some(next) = form.whole(bytes, content, form.offset) else { return Ok(None) };
                    for (path, name, variable) in found {
                        self.folders.entry(path).or_default().insert(name, variable);
                    }
                    return Ok(Some((next, at + length)));
                }
                _ => {}
            }
            at += length;
        }
    }

    /// A variable whose type stands at `at`, with a name of so many bytes.
    fn variable(&mut self, form: Form, bytes: &[u8], (at, name): (usize, usize)) -> Result<Variable, String> {
        let field = |at: usize, size: usize| form.whole(bytes, at, size).ok_or("a symbol is cut");
        let kind = field(at, form.kind)?;
        let record = field(at + form.kind, form.offset)?;
        let count = field(at + form.kind + form.offset, form.length)?;
        let size = size_of(kind).ok_or_else(|| format!("values of the unknown type {kind}"))?;
        let whole = |value: u64| usize::try_from(value).ok();
        let values = whole(record).and_then(|at| {
            let data = at.checked_add(form.length + form.command + form.kind + 1 + name)?;
            let end = data.checked_add(whole(count)?.checked_mul(size)?)?;
            (end <= bytes.len()).then_some(data)
        });
        let at = values.ok_or_else(|| format!("{count} values are named at byte {record}, beyond the end"))?;
        let count = whole(count).unwrap_or(0);
        self.claimed = self.claimed.saturating_add(count * size);
        if self.claimed / MOST_CLAIMED > self.bytes {
            return Err("its symbols name more values than it can hold".to_owned());
        }
        Ok(Variable { file: self.files.len() - 1, kind, at, count })
    }

    /// Paths of all folders with variables.
    pub fn folders(&self) -> impl Iterator<Item = &str> {
        self.folders.keys().map(String::as_str)
    }

    /// The states of a folder, `d000001` and on, in order.
    pub fn states(&self, folder: &str) -> Vec<&str> {
        let start = format!("{folder}/d");
        let number = |path: &str| path.strip_prefix(&start).and_then(|digits| digits.parse::<u64>().ok());
        let of_folder = self.folders.range(start.clone()..).take_while(|(path, _)| path.starts_with(&start));
        let mut states: Vec<(u64, &str)> =
            of_folder.filter_map(|(path, _)| Some((number(path)?, path.as_str()))).collect();
        states.sort_unstable();
        states.into_iter().map(|(_, path)| path).collect()
    }

    /// Names of the variables of a folder.
    pub fn names(&self, folder: &str) -> impl Iterator<Item = &str> {
        self.folders.get(folder).into_iter().flat_map(|variables| variables.keys().map(String::as_str))
    }

    fn get(&self, folder: &str, name: &str) -> Option<(Variable, &'a [u8], Form)> {
        let variable = *self.folders.get(folder)?.get(name)?;
        let (bytes, form) = self.files[variable.file];
        Some((variable, &bytes[variable.at..variable.at + variable.count * size_of(variable.kind)?], form))
    }

    /// Numbers of a variable; `None` where there is none, or it is a link.
    pub fn numbers(&self, folder: &str, name: &str) -> Option<Vec<f64>> {
        let (variable, bytes, form) = self.get(folder, name)?;
        let size = size_of(variable.kind)?;
        let number = |field: &[u8]| -> f64 {
            let bits = form.whole(field, 0, size).unwrap_or(0);
            match variable.kind {
                9 => f64::from(f32::from_bits(bits as u32)),
                10 => f64::from_bits(bits),
                5..=8 => bits as f64,
                // The sign of a short field is moved to the front and back.
                #[expect(clippy::cast_possible_wrap, reason = "two's complement")]
                _ => ((bits << (64 - 8 * size)) as i64 >> (64 - 8 * size)) as f64,
            }
        };
        (variable.kind <= 10).then(|| bytes.chunks_exact(size).map(number).collect())
    }

    /// Text of a variable without blanks and zeros at its end.
    pub fn text(&self, folder: &str, name: &str) -> Option<String> {
        let (_, bytes, _) = self.get(folder, name)?;
        Some(clean(bytes))
    }

    /// Texts of equal length: so many.
    pub fn texts(&self, folder: &str, name: &str, count: usize) -> Vec<String> {
        let Some((_, bytes, _)) = self.get(folder, name) else { return Vec::new() };
        let length = bytes.len().checked_div(count).unwrap_or(0);
        if length == 0 { Vec::new() } else { bytes.chunks_exact(length).map(clean).collect() }
    }
}

fn clean(bytes: &[u8]) -> String {
    let text = crate::formats::text::lines::decode(bytes);
    text.split(|c: char| c.is_control() || c.is_whitespace())
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

const fn size_of(kind: u64) -> Option<usize> {
    Some(match kind {
        1 | 5 | 11 => 1,
        2 | 6 => 2,
        3 | 7 | 9 => 4,
        4 | 8 | 10 => 8,
        _ => return None,
    })
}

/// A path, absolute or relative to another.
fn joined(present: &str, path: &str) -> Result<String, String> {
    let mut parts: Vec<&str> = if path.starts_with('/') { Vec::new() } else { present.split('/').collect() };
    for part in path.split('/') {
        match part {
            ".." => drop(parts.pop()),
            "." | "" => {}
            part => parts.push(part),
        }
    }
    parts.retain(|part| !part.is_empty());
    let joined = parts.iter().map(|part| format!("/{part}")).collect::<String>();
    if joined.len() > LONGEST_PATH { Err(format!("a path of {} bytes", joined.len())) } else { Ok(joined) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_absolute_or_relative() {
        assert_eq!(joined("/rwforc/forces/d000001", "../../transducer/d000001").unwrap(), "/rwforc/transducer/d000001");
        assert_eq!(joined("/glstat/d000001", "../metadata").unwrap(), "/glstat/metadata");
        assert_eq!(joined("/a", "/").unwrap(), "");
        assert!(joined("/a", &"b/".repeat(200)).is_err());
    }
}
