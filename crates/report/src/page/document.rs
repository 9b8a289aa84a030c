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
    candidates, channels, conclusion as top,
    contents::{Part, Sections},
    energy, figures, header, how_well, key_numbers, model_picture, models, numbers, predictions, ratings, remarks,
    what_if,
};
use crate::drawing::Figure;
use crate::figures::all::{crash_figures, identification_figures};
use crate::figures::crash::{curves, recorded};
use crate::frame::{FIGURES, framed_with};
use crate::frame::{PageFiles, Script, script_file};

/// Cursor, zoom and downloads.
const SCRIPT: Script = Script { name: "figures", text: FIGURES };

/// Figures that stand among the details.
const OF_DETAILS: [&str; 4] = ["residual", "sensors", "elements", "mass-split"];

/// The one heading that everything beyond the answer stands under; `</details>` ends it.
const DETAILS: &str = "<details id=\"details\">\n<summary><h2>Details</h2> <span>residuals, ratings, predictions, \
                       numbers, channels, remarks, provenance</span></summary>\n";

/// What stands on paper in place of the details.
const ON_PAPER: &str = "<p class=\"on-paper\">Residuals, ratings, predictions, numbers, channels, remarks and \
                        provenance are on the page itself, under Details, and in summary.json.</p>\n";

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
        let summary = summary(run, ranking);
        Self::of(run, ranking, (&summary, &summary.to_json().unwrap_or_default()), None)
    }

    /// The same of a run that is summed up, with the summary to download as JSON; with `folder` style and scripts are
    /// in a folder, at this address as the page sees it, that has the files of [`write_shared_files`].
    pub fn of(run: &Run, ranking: &Ranking, (summary, json): (&Summary, &str), folder: Option<&str>) -> Self {
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
        let (folded, open): (Vec<Figure>, Vec<Figure>) =
            crash.into_iter().partition(|figure| OF_DETAILS.contains(&figure.id));
        let first = match bare {
            Some(_) => recorded::figure(run),
            None => curves::first(run, ranking).filter(|_| run.joint.is_none()),
        };
        let first: Vec<Figure> = first.into_iter().collect();
        let mut sections = Sections::default();
        let is_generic = run.is_generic();
        let out = &mut sections.html;
        if run.joint.is_none() {
            key_numbers::write(out, run, said, key_numbers);
        }
        out.push_str("<div class=\"first\">\n<div>\n");
        figures::write(out, &first, "h2");
        out.push_str("<div class=\"answer\">\n");
        predictions::write_first(out, run, ranking, said.status);
        top::write_before_use(out, run, ranking, concerns);
        out.push_str("</div>\n</div>\n");
        model_picture::write(out, run, ranking, said.status);
        out.push_str("</div>\n");
        if run.joint.is_none() {
            key_numbers::write_caption(out, key_numbers);
        }
        let id_of = |figures: &[Figure]| figures.first().map_or("", |figure| figure.id);
        let models =
            || Part::new("identification", "Identification", |out| models::write(out, run, concerns, &identification));
        let mut parts = vec![
            Part::new("tests", "The tests", |out| predictions::write_left_out(out, run)),
            Part::new(id_of(&open), "Curves", |out| figures::write(out, &open, "h2")),
        ];
        parts.extend(is_generic.then(models));
        parts.push(Part::new("what-if", "What if", |out| what_if::write(out, run, ranking, &files)));
        parts.push(Part::new("candidates", "Which model to use", |out| {
            candidates::write(out, run, ranking, said.status);
        }));
        sections.extend(parts);
        sections.html.push_str(DETAILS);
        let mut parts = vec![
            Part::new(id_of(&folded), "More curves", |out| figures::write(out, &folded, "h2")),
            Part::new("how-well", "How well", |out| how_well::write(out, run, ranking)),
            Part::new("predictions", "Predictions", |out| predictions::write(out, run, said.status)),
            Part::new("ratings", "Ratings", |out| ratings::write(out, run, ranking)),
            Part::new("energy", "Energy", |out| energy::write(out, run, ranking)),
        ];
        parts.extend((!is_generic).then(models));
        // Of several tests each has its own report with them.
        if run.joint.is_none() {
            parts.push(Part::new("metrics", "Events and metrics", |out| numbers::write(out, whole)));
            parts.push(Part::new("channels", "Channels", |out| channels::write(out, run)));
        }
        sections.extend(parts);
        remarks::write_missing(&mut sections.html, whole);
        sections.extend(vec![
            Part::new("notes", "Warnings and notes", |out| remarks::write_notes(out, whole, ranking, concerns)),
            Part::new("limits", "What it cannot say", |out| remarks::write_limits(out, whole, ranking)),
            Part::new("provenance", "Provenance", |out| remarks::write_provenance(out, whole)),
        ]);
        sections.html.push_str("</details>\n");
        // The summary of several tests is another one: it lies beside the page.
        if let (None, Ok(packed)) = (&run.joint, packed(json)) {
            sections.html.push_str(&format!("<script type=\"text/plain\" id=\"summary-data\">{packed}</script>\n"));
        }
        let mut body = String::with_capacity(sections.html.len() + 10_000);
        header::write(&mut body, whole, said);
        body.push_str(&format!("{}<main>\n{}{ON_PAPER}</main>\n", sections.contents(), sections.html));
        let toggles = figures::toggle_rules(first.iter().chain(&open).chain(&folded).chain(&identification));
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
fn packed(json: &str) -> io::Result<String> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(json.as_bytes())?;
    Ok(STANDARD.encode(encoder.finish()?))
}
