//! Examples of every command, as one types them. `crumple demo` and the examples of `run` make the files that they
//! name; `tests` is a folder of the reader's own.

/// What an example is for, and the words behind `crumple`.
pub type Example = (&'static str, &'static str);

/// Three examples a command.
const EXAMPLES: &[(&str, [Example; 3])] = &[
    (
        "demo",
        [
            ("a sample record of a car, and its run", "demo"),
            ("the same, and its report in a browser", "demo --open"),
            ("without a summary", "demo --quiet"),
        ],
    ),
    (
        "run",
        [
            ("the record that crumple demo wrote", "run crumple-demo.csv"),
            ("another filter class, in another folder", "run crumple-demo.csv --set filter.cfc=180 -o runs/cfc180"),
            ("another mass and speed", "run crumple-demo.csv --mass 1600kg --impact-speed 57km/h -o runs/heavy"),
        ],
    ),
    (
        "predict",
        [
            ("other speeds, into the run and its report", "predict runs/crumple-demo/default --speed 40km/h,64km/h"),
            ("another mass", "predict runs/crumple-demo/default --mass 1300kg"),
            ("against another car", "predict runs/crumple-demo/default --partner runs/heavy --speed 50km/h"),
        ],
    ),
    (
        "notes",
        [
            ("of a run", "notes runs/crumple-demo/default"),
            ("of one stage", "notes runs/crumple-demo/default/5-parameter-solve.mcap"),
            ("of two", "notes runs/crumple-demo/default/1-ingest.mcap runs/crumple-demo/default/2-filter.mcap"),
        ],
    ),
    (
        "explain",
        [
            ("a code", "explain CR323"),
            ("what a run says with a code", "explain runs/crumple-demo/default CR328"),
            ("every code of a run", "explain runs/crumple-demo/default"),
        ],
    ),
    (
        "curve",
        [
            ("the curve of the recommended model", "curve runs/crumple-demo/default"),
            ("up to a deflection", "curve runs/crumple-demo/default --to 900mm"),
            ("for PC-Crash", "curve runs/crumple-demo/default --format pc-crash"),
        ],
    ),
    (
        "plan",
        [
            ("which second test helps most", "plan runs/crumple-demo/default --want \"crush at 64km/h\""),
            ("of these speeds", "plan runs/crumple-demo/default --want \"crush at 64km/h\" --speed 40km/h,64km/h"),
            ("with another mass", "plan runs/crumple-demo/default --want \"crush at 64km/h\" --mass 1500kg"),
        ],
    ),
    (
        "damage",
        [
            ("stiffness of a front by one barrier test", "damage --test 1400kg,56km/h,48cm,150cm"),
            (
                "a speed from damage",
                "damage --test 1400kg,56km/h,48cm,150cm --profile 20,30,35,35,28,15cm --width 150cm --mass 1400kg",
            ),
            (
                "with the stiffness from tables",
                "damage --stiffness 55kN/m,400kN/m^2 --profile 10,25,38,31,12cm --width 150cm --mass 1400kg",
            ),
        ],
    ),
    (
        "compare",
        [
            (
                "two runs on one page, and for a merge request",
                "compare runs/crumple-demo/default runs/cfc180 --markdown review.md",
            ),
            ("a simulation, here another run, and its test", "compare runs/crumple-demo/default runs/heavy --validate"),
            (
                "the same with limits, for CI",
                "compare runs/crumple-demo/default runs/cfc180 --validate --require 'crush<=20mm'",
            ),
        ],
    ),
    (
        "together",
        [
            ("two records", "together tests/a.csv tests/b.csv --name both"),
            ("two runs that were made", "together runs/a/default runs/b/default --name both"),
            ("and another speed", "together tests/a.csv tests/b.csv --name both --speed 64km/h"),
        ],
    ),
    (
        "fleet",
        [
            ("two classes", "fleet crumple-demo.csv --set filter.cfc=60,180 --name classes"),
            ("two pipelines", "fleet crumple-demo.csv --pipelines default,unfiltered --name pipelines"),
            ("all records of a folder, four at a time", "fleet tests --jobs 4"),
        ],
    ),
    (
        "watch",
        [
            ("every record that arrives", "watch tests"),
            ("a look every ten seconds, without a summary", "watch tests --every 10s --quiet"),
            ("with what no record states", "watch tests -- --mass 1400kg --impact-speed 56km/h"),
        ],
    ),
    (
        "study",
        [
            ("all records of a folder", "study tests"),
            ("with classes of vehicles", "study tests --classes classes.csv"),
            ("of runs that were made", "study tests --tables-only"),
        ],
    ),
    (
        "index",
        [
            ("two runs", "index runs/crumple-demo/default runs/cfc180"),
            ("all runs of a folder", "index runs"),
            ("a page of another name", "index runs -o all.html"),
        ],
    ),
    (
        "diff",
        [
            ("two runs", "diff runs/crumple-demo/default runs/cfc180"),
            ("which change did what", "diff runs/crumple-demo/default runs/cfc180 --why"),
            ("what was accepted, and now", "diff expected runs --markdown review.md"),
        ],
    ),
    (
        "accept",
        [
            ("a run", "accept runs/crumple-demo/default"),
            ("all runs of a folder", "accept runs"),
            ("into a folder of another name", "accept runs/crumple-demo/default --into reference"),
        ],
    ),
    (
        "check",
        [
            ("a run", "check runs/crumple-demo/default"),
            ("one artifact", "check runs/crumple-demo/default/1-ingest.mcap"),
            ("run a passport again", "check --passport passport.zip --record crumple-demo.csv"),
        ],
    ),
    (
        "passport",
        [
            ("a run", "passport runs/cfc180"),
            ("with its record", "passport runs/cfc180 --with-record -o demo.zip"),
            ("for publication", "passport runs/cfc180 --license https://spdx.org/licenses/CC-BY-4.0 -o open.zip"),
        ],
    ),
    (
        "export",
        [
            ("a workbook", "export runs/crumple-demo/default --to xlsx"),
            ("a file a table", "export runs/crumple-demo/default --to csv -o tables"),
            ("for a decimal comma", "export runs/crumple-demo/default --to csv --semicolon -o tables-comma"),
        ],
    ),
    (
        "view",
        [
            ("a recording and layouts", "view runs/crumple-demo/default"),
            ("every sample", "view runs/crumple-demo/default --all -o all.mcap"),
            ("the recommended model alone", "view runs/crumple-demo/default --models recommended -o one.mcap"),
        ],
    ),
    (
        "ingest",
        [
            ("a record", "ingest crumple-demo.csv -o 1-ingest.mcap"),
            ("its channels as a table", "ingest --list crumple-demo.csv"),
            ("another mass and speed", "ingest crumple-demo.csv --mass 1600kg --impact-speed 57km/h -o heavy.mcap"),
        ],
    ),
    (
        "filter",
        [
            ("to CFC 60", "filter runs/crumple-demo/default/1-ingest.mcap -o 2-filter.mcap"),
            ("to CFC 180", "filter runs/crumple-demo/default/1-ingest.mcap --cfc 180 -o cfc180.mcap"),
            (
                "by a Butterworth filter",
                "filter runs/crumple-demo/default/1-ingest.mcap --order 4 --cutoff 100Hz -o low.mcap",
            ),
        ],
    ),
    (
        "integrate",
        [
            ("a filtered record", "integrate runs/crumple-demo/default/2-filter.mcap -o 3-integrate.mcap"),
            (
                "another impact speed",
                "integrate runs/crumple-demo/default/2-filter.mcap --impact-speed 57km/h -o faster.mcap",
            ),
            (
                "with the velocity after separation",
                "integrate runs/crumple-demo/default/2-filter.mcap --end-velocity=-2.4m/s -o end.mcap",
            ),
        ],
    ),
    (
        "identify",
        [
            (
                "by the usual methods",
                "identify runs/cfc180/2-filter.mcap runs/cfc180/3-integrate.mcap -o 4-identify.mcap",
            ),
            (
                "by ERA of order 4",
                "identify runs/cfc180/2-filter.mcap runs/cfc180/3-integrate.mcap --methods era --orders 4 -o era.mcap",
            ),
            (
                "by ARX",
                "identify runs/cfc180/2-filter.mcap runs/cfc180/3-integrate.mcap --methods arx --orders 2 -o arx.mcap",
            ),
        ],
    ),
    (
        "parameter-solve",
        [
            (
                "the usual models",
                "parameter-solve runs/crumple-demo/default/3-integrate.mcap -o 5-parameter-solve.mcap",
            ),
            (
                "one spring and damper",
                "parameter-solve runs/crumple-demo/default/3-integrate.mcap --models kelvin -o kelvin.mcap",
            ),
            (
                "a force-deflection curve",
                "parameter-solve runs/crumple-demo/default/3-integrate.mcap --models force-deflection -o curve.mcap",
            ),
        ],
    ),
    (
        "simulate",
        [
            (
                "the candidates of a run",
                "simulate runs/cfc180/3-integrate.mcap runs/cfc180/5-parameter-solve.mcap -o 6-simulate.mcap",
            ),
            (
                "up to a time",
                "simulate runs/cfc180/3-integrate.mcap runs/cfc180/5-parameter-solve.mcap --to 60ms -o early.mcap",
            ),
            (
                "where the car never leaves the wall",
                "simulate runs/cfc180/3-integrate.mcap runs/cfc180/5-parameter-solve.mcap --stay-attached \
                 -o stays.mcap",
            ),
        ],
    ),
    (
        "report",
        [
            ("the report of a run again", "report runs/crumple-demo/default"),
            ("with its figures as files", "report runs/crumple-demo/default --svg figures"),
            ("for a merge request", "report runs/crumple-demo/default --markdown review.md"),
        ],
    ),
    (
        "show",
        [
            ("an artifact", "show runs/crumple-demo/default/3-integrate.mcap"),
            ("a topic", "show runs/crumple-demo/default/5-parameter-solve.mcap --topic '/parameters/*'"),
            ("one JSON object a line", "show runs/crumple-demo/default/3-integrate.mcap --json"),
        ],
    ),
    (
        "artifact",
        [
            ("what an artifact holds", "artifact show runs/crumple-demo/default/3-integrate.mcap"),
            ("as plain files", "artifact unpack runs/crumple-demo/default/2-filter.mcap plain"),
            ("of plain files", "artifact pack plain packed.mcap"),
        ],
    ),
    (
        "artifact unpack",
        [
            ("as plain files", "artifact unpack runs/crumple-demo/default/3-integrate.mcap integrated"),
            ("for a spreadsheet", "artifact unpack runs/crumple-demo/default/3-integrate.mcap texts --text"),
            ("again", "artifact unpack runs/crumple-demo/default/3-integrate.mcap integrated --force"),
        ],
    ),
    (
        "artifact pack",
        [
            ("plain files", "artifact pack integrated again.mcap"),
            ("a smaller file", "artifact pack integrated small.mcap --zstd"),
            ("without a summary", "artifact pack texts texts.mcap --quiet"),
        ],
    ),
    (
        "new-stage",
        [
            ("a filter in Python", "new-stage filter --language python"),
            ("in another folder", "new-stage identify --language julia -o my-era"),
            ("for Octave", "new-stage predict --language octave"),
        ],
    ),
];

/// Those of a command: `run`, `artifact unpack`.
pub fn of(command: &str) -> Option<&'static [Example; 3]> {
    EXAMPLES.iter().find(|(known, _)| *known == command).map(|(_, examples)| examples)
}

/// As they stand behind the help.
pub fn as_help(examples: &[Example]) -> String {
    let shown = examples.iter().map(|(purpose, words)| format!("  # {purpose}\n  crumple {words}\n"));
    format!(
        "\nExamples (crumple demo and those of crumple run make the files, tests is a folder of yours):\n{}",
        shown.collect::<String>()
    )
}

/// As they stand in the man page.
pub fn as_man_page(examples: &[Example]) -> String {
    let plain = |text: &str| text.replace('\\', "\\e").replace('-', "\\-");
    let shown = examples.iter().map(|(purpose, words)| {
        format!(".PP\n{}:\n.PP\n.nf\n.RS\ncrumple {}\n.RE\n.fi\n", plain(purpose), plain(words))
    });
    format!(".SH EXAMPLES\n{}", shown.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_are_of_the_command_that_they_stand_for_and_differ() {
        for (command, examples) in EXAMPLES {
            let words: Vec<&str> = examples.iter().map(|(_, words)| *words).collect();
            assert!(words.iter().all(|words| format!("{words} ").starts_with(&format!("{command} "))), "{words:?}");
            assert!(words[0] != words[1] && words[1] != words[2] && words[0] != words[2], "{words:?}");
        }
    }
}
