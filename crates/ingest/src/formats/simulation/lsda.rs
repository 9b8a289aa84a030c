//! LSDA, the container of a binout: values behind each other, and chained tables of symbols that say what they are.
//!
//! After the header stand records: length, command, content. A table gives for every variable its path, type, count and
//! the place of its values; a table is written after each state. Only tables are trusted; a chain that breaks because
//! the file is cut leaves what was written before. Source: the format note of the LSTC I/O library.

use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, Read, SeekFrom};

use crate::formats::reader::{LargeFile, ReadSeek};

/// Commands of records.
const CD: u64 = 2;
const VARIABLE: u64 = 4;
const TABLE: u64 = 5;
const END_OF_TABLE: u64 = 6;
const FIRST_TABLE: u64 = 7;
/// The last type of numbers: double precision.
const LAST_NUMBER: u64 = 10;
/// Longest path: relative ones would grow without end.
const LONGEST_PATH: usize = 255;
/// Longest symbol: a name of 255 bytes with its fields, and room.
const LONGEST_SYMBOL: usize = 1 << 16;
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

    fn number(self, field: &[u8]) -> u64 {
        let add = |value: u64, byte: &u8| (value << 8) | u64::from(*byte);
        if self.is_little { field.iter().rev().fold(0, add) } else { field.iter().fold(0, add) }
    }

    /// The value of a field of a type.
    fn value(self, kind: u64, field: &[u8]) -> f64 {
        let bits = self.number(field);
        match kind {
            9 => f64::from(f32::from_bits(bits as u32)),
            10 => f64::from_bits(bits),
            5..=8 => bits as f64,
            // The sign of a short field is moved to the front and back.
            #[expect(clippy::cast_possible_wrap, reason = "two's complement")]
            _ => {
                let empty = 64 - 8 * field.len();
                ((bits << empty) as i64 >> empty) as f64
            }
        }
    }

    fn whole(self, file: &Source<'_>, at: usize, size: usize) -> Option<u64> {
        Some(self.number(&file.get(at, size)?))
    }

    /// Length, command and place of the content of the record at a place.
    fn record(self, file: &Source<'_>, at: usize) -> Option<(usize, u64, usize)> {
        let head = file.get(at, self.length + self.command)?;
        let (length, command) = head.split_at(self.length);
        let length = usize::try_from(self.number(length)).ok()?;
        (length >= head.len()).then(|| (length, self.number(command), at + head.len()))
    }
}

/// Bytes that are read at once from a file on the disk.
const WINDOW: usize = 1 << 13;

/// The bytes of a file: in memory, or read from where they stand.
pub struct Source<'a> {
    memory: &'a [u8],
    disk: Option<RefCell<Disk>>,
    /// Bytes of the file.
    length: usize,
}

/// A file on the disk, and what was read of it last.
struct Disk {
    file: io::Result<Box<dyn ReadSeek>>,
    at: usize,
    window: Vec<u8>,
}

impl<'a> Source<'a> {
    /// Bytes in memory.
    pub fn of(memory: &'a [u8]) -> Self {
        Self { memory, disk: None, length: memory.len() }
    }

    /// A file on the disk. What cannot be read is an error of [`finished`](Self::finished).
    pub fn on_disk(file: &LargeFile) -> Self {
        let disk = Disk { file: file.open(), at: 0, window: Vec::new() };
        let length = usize::try_from(file.length).unwrap_or(usize::MAX);
        Self { memory: &[], disk: Some(RefCell::new(disk)), length }
    }

    /// So many bytes from a place on; `None` beyond the end.
    fn get(&self, at: usize, size: usize) -> Option<Cow<'_, [u8]>> {
        let end = at.checked_add(size).filter(|end| *end <= self.length)?;
        let Some(disk) = &self.disk else { return self.memory.get(at..end).map(Cow::Borrowed) };
        let mut disk = disk.borrow_mut();
        if at < disk.at || end > disk.at + disk.window.len() {
            disk.fill(at, size.max(WINDOW).min(self.length - at));
        }
        let from = at - disk.at;
        disk.window.get(from..from + size).map(|bytes| Cow::Owned(bytes.to_vec()))
    }

    /// Errors: of the disk, or the file changed while it was read.
    fn finished(&self) -> io::Result<()> {
        let Some(disk) = &self.disk else { return Ok(()) };
        let mut disk = disk.borrow_mut();
        disk.fill(self.length, 1);
        match &disk.file {
            Ok(_) => Ok(()),
            Err(error) => Err(io::Error::new(error.kind(), error.to_string())),
        }
    }
}

impl Disk {
    fn fill(&mut self, at: usize, size: usize) {
        self.at = at;
        self.window.clear();
        let Ok(file) = &mut self.file else { return };
        let read = file.seek(SeekFrom::Start(at as u64));
        let read = read.and_then(|_| file.take(size as u64).read_to_end(&mut self.window));
        if let Err(error) = read {
            self.file = Err(error);
        }
    }
}

/// Whether a file that starts so is of this kind.
pub fn recognises(head: &[u8]) -> bool {
    let first = |form: Form| form.record(&Source::of(head), form.header);
    Form::of(head).is_some_and(|form| matches!(first(form), Some((_, FIRST_TABLE, _))))
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
    files: Vec<(Source<'a>, Form)>,
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
    pub fn add(&mut self, file: Source<'a>) -> Result<bool, String> {
        let form = file.get(0, file.length.min(8)).and_then(|head| Form::of(&head));
        let form = form.ok_or("its header is not that of a binout")?;
        let (length, command, content) = form.record(&file, form.header).ok_or("the file ends in its header")?;
        let first = form.whole(&file, content, form.offset).filter(|_| command == FIRST_TABLE);
        let first = first.ok_or("no table of symbols is named behind the header")?;
        self.bytes = self.bytes.saturating_add(file.length);
        let is_whole = self.tables(form, &file, first, form.header.saturating_add(length));
        self.files.push((file, form));
        is_whole
    }

    /// Follows the tables from the first one on, which stands behind a place.
    fn tables(&mut self, form: Form, file: &Source<'_>, first: u64, mut behind: usize) -> Result<bool, String> {
        let (mut at, mut tables) = (first, 0_usize);
        while at != 0 {
            let start = usize::try_from(at).unwrap_or(usize::MAX);
            if start < behind {
                return Err(format!(
                    "the table of symbols at byte {start} is named behind byte {behind}: tables circle"
                ));
            }
            match self.table(form, file, start)? {
                Some((next, end)) => (at, behind, tables) = (next, end, tables + 1),
                None if tables == 0 => return Err("it ends before its first table of symbols".to_owned()),
                None => {
                    // What follows the last table holds no other one, or its place is stated wrongly.
                    while let Some((length, command, content)) = form.record(file, behind) {
                        if command == TABLE && start >= file.length {
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
    fn table(&mut self, form: Form, file: &Source<'_>, start: usize) -> Result<Option<(u64, usize)>, String> {
        let Some((_, command, mut at)) = form.record(file, start) else { return Ok(None) };
        if command != TABLE {
            return Err(format!("at byte {start} stands no table of symbols, which is named there"));
        }
        let mut path = String::new();
        let mut found = Vec::new();
        loop {
            let Some((length, command, content)) = form.record(file, at) else { return Ok(None) };
            let Some(end) = at.checked_add(length).filter(|end| *end <= file.length) else { return Ok(None) };
            // A body that is not read, of whatever length, stays where it is.
            let body = if matches!(command, CD | VARIABLE) { end - content } else { 0 };
            if body > LONGEST_SYMBOL {
                return Err(format!("a symbol of {body} bytes at byte {at}"));
            }
            let Some(body) = file.get(content, body) else { return Ok(None) };
            match command {
                CD => path = joined(&path, &String::from_utf8_lossy(&body))?,
                VARIABLE => {
                    let fields = form.kind + form.offset + form.length;
                    let name = body.len().checked_sub(fields).ok_or("a symbol without a name")?;
                    let variable = self.variable(form, file, (content + name, name))?;
                    found.push((path.clone(), String::from_utf8_lossy(&body[..name]).into_owned(), variable));
                }
                END_OF_TABLE => {
                    let Some(next) = form.whole(file, content, form.offset) else { return Ok(None) };
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
    fn variable(&mut self, form: Form, file: &Source<'_>, (at, name): (usize, usize)) -> Result<Variable, String> {
        let field = |at: usize, size: usize| form.whole(file, at, size).ok_or("a symbol is cut");
        let kind = field(at, form.kind)?;
        let record = field(at + form.kind, form.offset)?;
        let count = field(at + form.kind + form.offset, form.length)?;
        let size = size_of(kind).ok_or_else(|| format!("values of the unknown type {kind}"))?;
        let whole = |value: u64| usize::try_from(value).ok();
        let values = whole(record).and_then(|at| {
            let data = at.checked_add(form.length + form.command + form.kind + 1 + name)?;
            let end = data.checked_add(whole(count)?.checked_mul(size)?)?;
            (end <= file.length).then_some(data)
        });
        let at = values.ok_or_else(|| format!("{count} values are named at byte {record}, beyond the end"))?;
        let count = whole(count).unwrap_or(0);
        self.claimed = self.claimed.saturating_add(count * size);
        if self.claimed / MOST_CLAIMED > self.bytes {
            return Err("its symbols name more values than it can hold".to_owned());
        }
        Ok(Variable { file: self.files.len(), kind, at, count })
    }

    /// Errors: of the disk, or a file that changed while it was read.
    pub fn finished(&self) -> io::Result<()> {
        self.files.iter().try_for_each(|(file, _)| file.finished())
    }

    /// Bytes of all files.
    pub fn bytes(&self) -> usize {
        self.bytes
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

    fn variable_of(&self, folder: &str, name: &str) -> Option<(Variable, &(Source<'a>, Form))> {
        let variable = *self.folders.get(folder)?.get(name)?;
        Some((variable, self.files.get(variable.file)?))
    }

    fn bytes_of(&self, folder: &str, name: &str) -> Option<Cow<'_, [u8]>> {
        let (variable, (file, _)) = self.variable_of(folder, name)?;
        file.get(variable.at, variable.count * size_of(variable.kind)?)
    }

    /// Numbers of a variable; `None` where there is none, or it is a link.
    pub fn numbers(&self, folder: &str, name: &str) -> Option<Vec<f64>> {
        let (variable, (_, form)) =
            self.variable_of(folder, name).filter(|(variable, _)| variable.kind <= LAST_NUMBER)?;
        let bytes = self.bytes_of(folder, name)?;
        Some(bytes.chunks_exact(size_of(variable.kind)?).map(|field| form.value(variable.kind, field)).collect())
    }

    /// The numbers at some places of a variable that has so many or more; else `None`.
    pub fn numbers_at(&self, folder: &str, name: &str, places: &[usize], least: usize) -> Option<Vec<f64>> {
        let (variable, (file, form)) = self.variable_of(folder, name)?;
        let size = size_of(variable.kind).filter(|_| variable.kind <= LAST_NUMBER && variable.count >= least)?;
        let value = |k: &usize| Some(form.value(variable.kind, &file.get(variable.at + k * size, size)?));
        places.iter().map(value).collect()
    }

    /// Text of a variable without blanks and zeros at its end.
    pub fn text(&self, folder: &str, name: &str) -> Option<String> {
        self.bytes_of(folder, name).map(|bytes| clean(&bytes))
    }

    /// Texts of equal length: so many.
    pub fn texts(&self, folder: &str, name: &str, count: usize) -> Vec<String> {
        let Some(bytes) = self.bytes_of(folder, name) else { return Vec::new() };
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
