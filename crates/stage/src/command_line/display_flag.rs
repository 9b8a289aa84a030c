//! The units of what is shown: a flag of every program that shows numbers, and a key of pipelines, `report.display`.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use crumple_signal::Display;
use crumple_signal::display::DISPLAYS;

use crate::command_line::pipeline_file::Pipeline;
use crate::error::Usage;

/// Stage and key of a pipeline.
const KEY: (&str, &str) = ("report", "display");

/// The flag.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct DisplayFlag {
    /// Units that are shown: si (km/h, mm, kg, kN) or us (mph, in, lb, kip) [default: report.display of the pipeline,
    /// else si].
    #[arg(long, value_name = "UNITS", value_parser = parser())]
    display: Option<Display>,
}

fn parser() -> impl TypedValueParser<Value = Display> {
    PossibleValuesParser::new(DISPLAYS.map(|(name, _)| name)).try_map(|text| text.parse::<Display>())
}

impl DisplayFlag {
    /// What is asked for: by the flag, else by the pipeline, else metric. Errors: a pipeline that names other units.
    pub fn or_of(self, pipeline: Option<&Pipeline>) -> Result<Display, Usage> {
        match self.display {
            Some(display) => Ok(display),
            None => pipeline.map_or(Ok(Display::Si), display_of),
        }
    }

    /// Asks the same of a pipeline that a run is given; nothing where the flag is not there.
    pub fn as_set(self) -> Option<String> {
        let (stage, key) = KEY;
        self.name().map(|name| format!("{stage}.{key}={name}"))
    }

    /// Asks the same of another program.
    pub fn words(self) -> Vec<String> {
        self.name().map_or_else(Vec::new, |name| vec!["--display".to_owned(), name.to_owned()])
    }

    fn name(self) -> Option<&'static str> {
        let display = self.display?;
        DISPLAYS.iter().find(|(_, known)| *known == display).map(|(name, _)| *name)
    }
}

fn display_of(pipeline: &Pipeline) -> Result<Display, Usage> {
    let (stage, key) = KEY;
    let Some(value) = pipeline.table(stage).and_then(|table| table.get(key)) else { return Ok(Display::Si) };
    let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    text.parse().map_err(|error| Usage::new(format!("{}: {error}", pipeline.place(stage, key))))
}
