//! The page as a whole.

use crate::drawing::escape::{address, html};
use crate::drawing::{Drawing, Entry, Figure, swatch};
use crate::phrases::PHRASES;
use crate::phrases::words::fill;

use super::failures::failures;
use super::indexed_run::IndexedRun;
use super::table::table;
use crate::frame::framed::framed;

const STYLE: &str = include_str!("style.css");
const SORT: &str = include_str!("sort.js");

/// Many runs on one page.
#[derive(Debug)]
pub struct RunIndex<'a> {
    /// What the page is called; empty: an index of runs.
    pub title: &'a str,
    /// Files beside the page with all that is in it: what each is called, and its path.
    pub tables: &'a [(&'a str, &'a str)],
    /// The runs, in the order of the table.
    pub runs: &'a [IndexedRun<'a>],
    /// Figures of all runs.
    pub figures: Vec<FiguresOfRuns>,
}

/// Figures of all runs with what to take from them.
#[derive(Debug)]
pub struct FiguresOfRuns {
    /// Heading.
    pub heading: &'static str,
    /// What they show, plain text.
    pub text: &'static str,
    /// The figures; the panels of each stand side by side.
    pub figures: Vec<Figure>,
}

impl RunIndex<'_> {
    /// The page. The same runs give the same bytes.
    pub fn to_html(&self) -> String {
        let texts = &PHRASES.runs;
        let title = if self.title.is_empty() { texts.index_title } else { self.title };
        let mut body = format!(
            "<header>\n<p class=\"brand\">{}</p>\n<h1>{}</h1>\n<p>{}.{}</p>\n</header>\n<main>\n{}",
            texts.index_brand,
            html(title),
            self.counted(),
            self.files(),
            failures(self.runs)
        );
        self.figures.iter().for_each(|figures| write_figures(&mut body, figures));
        body.push_str(&format!(
            "<section id=\"runs\">\n<h2>{}</h2>\n<p class=\"caption\">{}<span class=\"script\">{}</span></p>\n{}\
             </section>\n</main>\n",
            texts.runs,
            texts.index_caption,
            texts.sorts,
            table(self.runs)
        ));
        framed(title, STYLE, &body, SORT)
    }

    /// How many runs there are, and how many of them ended how.
    pub fn counted(&self) -> String {
        let count = |is: &dyn Fn(&IndexedRun<'_>) -> bool| self.runs.iter().filter(|run| is(run)).count();
        let failed = count(&|run| !run.is_done());
        let recommended = count(&|run| run.is_done() && run.summary.is_some_and(|s| s.usable_model().is_some()));
        let texts = &PHRASES.runs;
        let runs = match self.runs.len() {
            1 => texts.one_run.to_owned(),
            n => fill(texts.several_runs, &[("count", n.to_string())]),
        };
        let mut words = fill(texts.with_model, &[("runs", runs), ("count", recommended.to_string())]);
        if failed > 0 {
            words.push_str(&fill(texts.without_result, &[("count", failed.to_string())]));
        }
        words
    }

    fn files(&self) -> String {
        let link = |(name, path): &(&str, &str)| format!("<a href=\"{}\">{}</a>", address(path), html(name));
        let links: Vec<String> = self.tables.iter().map(link).collect();
        if links.is_empty() {
            return String::new();
        }
        fill(PHRASES.runs.tables, &[("links", links.join(", "))])
    }
}

/// Figures without boxes and cursor: of all runs at once there is nothing to hide.
fn write_figures(out: &mut String, of_runs: &FiguresOfRuns) {
    let figures: Vec<&Figure> = of_runs.figures.iter().filter(|figure| !figure.panels.is_empty()).collect();
    let Some(first) = figures.first() else { return };
    let (heading, text) = (html(of_runs.heading), html(of_runs.text));
    out.push_str(&format!("<section>\n<h2>{heading}</h2>\n<p class=\"caption\">{text}</p>\n{}", legend(first)));
    for figure in figures {
        let id = figure.id;
        out.push_str(&format!(
            "<section class=\"small\" id=\"{id}\" aria-labelledby=\"{id}-title\">\n<h3 id=\"{id}-title\">{}</h3>\n\
             <div class=\"panels\">\n",
            html(&figure.title)
        ));
        for (place, panel) in figure.panels.iter().enumerate() {
            out.push_str(&Drawing::new(figure, panel).svg(&format!("{id}-{place}"), false));
        }
        out.push_str("</div>\n</section>\n");
    }
    out.push_str("</section>\n");
}

/// The legend that the figures of a section share; of one name there is nothing to tell apart.
fn legend(figure: &Figure) -> String {
    if figure.legend.len() < 2 {
        return String::new();
    }
    let item = |entry: &Entry| {
        let name = html(&entry.name);
        format!("<li><svg viewBox=\"0 0 28 12\" aria-hidden=\"true\">{}</svg> {name}</li>\n", swatch(entry))
    };
    let items: String = figure.legend.iter().map(item).collect();
    format!("<ul class=\"legend\">\n{items}</ul>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_script_cannot_end_its_element() {
        assert!(!SORT.contains("</script") && !SORT.contains("<!--") && SORT.len() < 2_000);
    }
}
