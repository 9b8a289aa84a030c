//! What an output is: nothing of another kind is ever replaced by it.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

/// Bytes at the start and at the end of a file that are looked at.
const LOOKED_AT: u64 = 1 << 16;

/// Kinds of files that the programs write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputKind {
    /// An artifact: an MCAP file with record types of this project.
    Artifact,
    /// A page of the report.
    Report,
    /// JSON with a schema of this project: a summary, a comparison, accepted results.
    Summary,
    /// A figure of a report as a file of its own: SVG or PNG.
    Figure,
    /// What a report says first, or a comparison, as Markdown.
    Markdown,
    /// A comparison as tests of JUnit.
    Junit,
    /// A file for viewers with a message a sample, or a layout for it.
    View,
    /// A table for other programs, which a person asked to replace: any regular file.
    Export,
    /// A table of a fleet: Parquet, or CSV that begins with the record and its digest.
    Table,
    /// Lines of JSON, as of an artifact that was unpacked.
    Lines,
    /// Style or script that pages share: begins with a comment that names its program.
    PageFile,
    /// Bare numbers, as of a waveform that was unpacked; such files are known by the name `*.f64` alone.
    Numbers,
}

impl OutputKind {
    /// Why an output of this kind must not replace what is at the path; `None` where nothing is there, an empty file,
    /// or a file of this kind.
    pub fn problem_at(self, path: &Path) -> io::Result<Option<&'static str>> {
        let metadata = match fs::metadata(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            other => other?,
        };
        if !metadata.is_file() {
            return Ok(Some("exists and is no regular file"));
        }
        if metadata.len() == 0 {
            return Ok(None);
        }
        let (start, end) = ends_of(path, metadata.len())?;
        let has = |word: &[u8]| [&start, &end].iter().any(|part| part.windows(word.len()).any(|bytes| bytes == word));
        let names_a_type = || has(b"crumple.");
        let (is_it, problem) = match self {
            Self::Artifact => {
                (start.starts_with(b"\x89MCAP") && names_a_type(), "exists and is no artifact of this project")
            }
            Self::Report => {
                (start.starts_with(b"<!DOCTYPE html>") && has(b"content=\"crumple-"), "exists and is no report")
            }
            Self::Summary => (starts_as_json(&start) && names_a_type(), "exists and is no JSON of this project"),
            Self::Figure => (start.starts_with(b"<svg") || start.starts_with(b"\x89PNG"), "exists and is no figure"),
            Self::Markdown => (
                start.starts_with(b"<!-- crumple-") || start.starts_with(b"<!-- crumple: "),
                "exists and is no Markdown of this project",
            ),
            Self::Junit => (has(b"<testsuites name=\"crumple "), "exists and holds no tests of this project"),
            Self::View => (has(b"crumple.view"), "exists and is no file that crumple view wrote"),
            Self::Export => (true, ""),
            Self::PageFile => (start.starts_with(b"/* crumple-"), "exists and is no style or script of reports"),
            Self::Table => (
                start.starts_with(b"PAR1") || start.starts_with(b"record,record_digest,"),
                "exists and is no table of a fleet",
            ),
            Self::Lines => (starts_as_json(&start), "exists and holds no lines of JSON"),
            Self::Numbers => (path.extension().is_some_and(|e| e == "f64"), "exists and is no file of numbers (*.f64)"),
        };
        Ok((!is_it).then_some(problem))
    }
}

fn starts_as_json(start: &[u8]) -> bool {
    start.iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{')
}

/// The first and the last bytes of a file.
fn ends_of(path: &Path, length: u64) -> io::Result<(Vec<u8>, Vec<u8>)> {
    let mut file = File::open(path)?;
    let (mut start, mut end) = (Vec::new(), Vec::new());
    (&mut file).take(LOOKED_AT).read_to_end(&mut start)?;
    file.seek(SeekFrom::Start(length.saturating_sub(LOOKED_AT)))?;
    file.take(LOOKED_AT).read_to_end(&mut end)?;
    Ok((start, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_is_known_by_its_content() {
        use OutputKind::{Artifact, Lines, Numbers, Report, Summary};
        let folder = tempfile::tempdir().unwrap();
        let is_it = |content: &[u8], kind: OutputKind, name: &str| {
            let path = folder.path().join(name);
            fs::write(&path, content).unwrap();
            kind.problem_at(&path).unwrap().is_none()
        };
        let artifact = [b"\x89MCAP0\r\n".as_slice(), &[0; 200_000], b"crumple.Test.v1", &[0; 1000]].concat();
        assert!(is_it(&artifact, Artifact, "a.mcap") && is_it(b"", Artifact, "a.mcap"));
        // a recording of somebody else's sensors is a record, not an artifact
        assert!(!is_it(b"\x89MCAP0\r\n sensor_msgs/Imu", Artifact, "a.mcap"));
        assert!(!is_it(b"time,crumple.", Artifact, "a.mcap"));
        assert!(is_it(b"<!DOCTYPE html>\n<meta content=\"crumple-report 0.1.0\">", Report, "r"));
        assert!(!is_it(b"<!DOCTYPE html>\n<title>mine</title>", Report, "r") && !is_it(b"t;a\n", Report, "r.html"));
        assert!(is_it(b"<svg xmlns=\"", OutputKind::Figure, "f.svg") && !is_it(b"t,a\n", OutputKind::Figure, "f.svg"));
        assert!(
            is_it(b"record,record_digest,", OutputKind::Table, "t.csv") && !is_it(b"t,a\n", OutputKind::Table, "t.csv")
        );
        let is_of_pages = |text: &[u8]| is_it(text, OutputKind::PageFile, "p.css");
        assert!(is_of_pages(b"/* crumple-report 0.1.0 */\na{}") && !is_of_pages(b"a { color: red }\n"));
        assert!(is_it(b"<!-- crumple-report 0.1.0 -->", OutputKind::Markdown, "r.md"));
        assert!(is_it(b"<!-- crumple: rigid -->", OutputKind::Markdown, "r.md"));
        assert!(!is_it(b"# Read me\n", OutputKind::Markdown, "r.md"));
        let is_of_tests = |text: &[u8]| is_it(text, OutputKind::Junit, "t.xml");
        assert!(is_of_tests(b"<?xml?>\n<testsuites name=\"crumple diff\">") && !is_of_tests(b"<testsuites>"));
        assert!(is_it(b"{\n \"schema\": \"crumple.summary.v1\"}", Summary, "s.json"));
        assert!(!is_it(b"{\"name\": \"package\"}", Summary, "s.json"));
        assert!(is_it(b" {}\n", Lines, "l") && !is_it(b"a,b\n", Lines, "l"));
        assert!(is_it(&[1; 8], Numbers, "1.f64") && !is_it(&[1; 8], Numbers, "1.csv"));
        assert!(Artifact.problem_at(&folder.path().join("none")).unwrap().is_none());
        assert!(Artifact.problem_at(folder.path()).unwrap().is_some());
    }
}
