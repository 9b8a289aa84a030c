//! `report.html`: one file that a browser shows without a network.

use std::io::{self, Write};
use std::path::Path;

use crate::findings::{Kind, MeasuredWaves, Ranking, ResultStatus, Run, Summary, summary};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use crumple_artifact::{OutputKind, write_atomically};
use flate2::Compression;
use flate2::write::GzEncoder;

use super::{
    candidates, channels, conclusion as top, energy, figures, header, how_well, key_numbers, model_picture, models,
    numbers, predictions, ratings, remarks, what_if,
};
use crate::drawing::Figure;
use crate::figures::all::{crash_figures, identification_figures};
use crate::figures::crash::{curves, recorded};
use crate::frame::{FIGURES, framed_with};
use crate::frame::{PageFiles, Script, script_file};

/// Cursor, zoom and downloads.
const SCRIPT: Script = Script { name: "figures", text: FIGURES };

/// Style of reports beside that of all pages.
fn style() -> String {
    [model_picture::STYLE, candidates::STYLE, what_if::STYLE].concat()
}

/// Writes what the pages of [`Page::of`] with a folder have in common into a folder, each file in one piece, where it
/// is not there yet. A name has a digest of the content: a file of this name is this file.
pub fn write_shared_files(folder: &Path) -> io::Result<()> {
    let style = style();
    let style = PageFiles { style: &style, folder: None }.style_file();
    for file in [style, script_file(SCRIPT), script_file(what_if::SCRIPT)] {
        let path = folder.join(file.name);
        if !path.exists() {
            write_atomically(&path, OutputKind::PageFile, |out| out.write_all(file.content.as_bytes()))?;
        }
    }
    Ok(())
}

/// A report, ready to be written.
#[derive(Debug)]
pub struct Page(String);

impl Page {
    /// Lays the report out, everything in one file. The same run gives the same bytes.
    pub fn new(run: &Run, ranking: &Ranking) -> Self {
        Self::of(run, ranking, &summary(run, ranking), None)
    }

    /// The same of a run that is summed up; with `folder` style and scripts are in a folder, at this address as the
    /// page sees it, that has the files of [`write_shared_files`].
    pub fn of(run: &Run, ranking: &Ranking, summary: &Summary, folder: Option<&str>) -> Self {
        let style = style();
        let files = PageFiles { style: &style, folder };
        let Summary { verdict: said, concerns, key_numbers, .. } = summary;
        let whole = run;
        let bare = (said.kind == Kind::Recorder && said.standing != ResultStatus::Model).then(|| measured_alone(run));
        let run = bare.as_ref().unwrap_or(run);
        let (crash, identification) = match bare {
            Some(_) => (Vec::new(), Vec::new()),
            None => (crash_figures(run, ranking), identification_figures(run)),
        };
        let mut body = String::with_capacity(1 << 20);
        header::write(&mut body, whole, said);
        body.push_str("<main>\n");
        if run.joint.is_none() {
            key_numbers::write(&mut body, run, key_numbers);
        }
        let first = match bare {
            Some(_) => recorded::figure(run),
            None => curves::first(run, ranking).filter(|_| run.joint.is_none()),
        };
        let first: Vec<Figure> = first.into_iter().collect();
        body.push_str("<div class=\"first\">\n<div>\n");
        figures::write(&mut body, &first, "h2");
        body.push_str("<div class=\"answer\">\n");
        predictions::write_first(&mut body, run, ranking, said.status);
        top::write_before_use(&mut body, run, ranking, concerns);
        body.push_str("</div>\n</div>\n");
        model_picture::write(&mut body, run, ranking, said.status);
        body.push_str("</div>\n");
        if run.joint.is_none() {
            key_numbers::write_caption(&mut body, key_numbers);
        }
        predictions::write_left_out(&mut body, run);
        figures::write(&mut body, &crash, "h2");
        if run.is_generic() {
            models::write(&mut body, run, concerns, &identification);
        }
        what_if::write(&mut body, run, ranking, &files);
        candidates::write(&mut body, run, ranking, said.status);
        how_well::write(&mut body, run, ranking);
        predictions::write(&mut body, run, said.status);
        ratings::write(&mut body, run, ranking);
        energy::write(&mut body, run, ranking);
        if !run.is_generic() {
            models::write(&mut body, run, concerns, &identification);
        }
        // Of several tests each has its own report with them.
        if run.joint.is_none() {
            numbers::write(&mut body, whole);
            channels::write(&mut body, run);
        }
        remarks::write_missing(&mut body, whole);
        remarks::write_notes(&mut body, whole, ranking, concerns);
        remarks::write_limits(&mut body, whole, ranking);
        remarks::write_provenance(&mut body, whole);
        // The summary of several tests is another one: it lies beside the page.
        if let (None, Ok(packed)) = (&run.joint, packed(summary)) {
            body.push_str(&format!("<script type=\"text/plain\" id=\"summary-data\">{packed}</script>\n"));
        }
        body.push_str("</main>\n");
        let toggles = figures::toggle_rules(first.iter().chain(&crash).chain(&identification));
        let title = header::title(run);
        Self(framed_with(&files, &title, &toggles, &body, SCRIPT))
    }

    /// Writes it.
    pub fn write_to(&self, mut writer: impl Write) -> io::Result<()> {
        writer.write_all(self.0.as_bytes())
    }
}

/// A run without what was fitted to the derivative of a recorder's table, whose steps are too long for a model.
fn measured_alone(run: &Run) -> Run {
    let measured = MeasuredWaves { displacement: run.measured.displacement.clone(), ..MeasuredWaves::default() };
    Run {
        measured,
        models: Vec::new(),
        selections: Vec::new(),
        stabilizations: Vec::new(),
        candidates: Vec::new(),
        recommendation: None,
        predictions: Vec::new(),
        ..run.clone()
    }
}

/// The summary for its download, gzip in base 64: a sixth of its length.
fn packed(summary: &Summary) -> io::Result<String> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(summary.to_json()?.as_bytes())?;
    Ok(STANDARD.encode(encoder.finish()?))
}
