//! The help of the whole program: its commands in groups, each in a line.

use clap::Command;
use crumple_stage::{columns, labelled, wrapped};

/// Commands that a person looks for together.
pub struct Group {
    title: &'static str,
    /// Their names, in the order of the help.
    pub commands: &'static [&'static str],
    /// Whether `-h` has their names alone.
    is_for_few: bool,
}

/// Every command is in one of them.
pub const GROUPS: [Group; 5] = [
    Group {
        title: "Every day",
        commands: &["demo", "run", "predict", "notes", "explain", "curve", "damage", "plan"],
        is_for_few: false,
    },
    Group {
        title: "Several tests",
        commands: &["compare", "together", "fleet", "watch", "study", "index"],
        is_for_few: false,
    },
    Group {
        title: "Review, and other programs",
        commands: &["diff", "accept", "check", "passport", "export", "view"],
        is_for_few: false,
    },
    Group {
        title: "Stages, which a run calls one after another (predict comes before report)",
        commands: &["ingest", "filter", "integrate", "identify", "parameter-solve", "simulate", "report"],
        is_for_few: true,
    },
    Group {
        title: "Artifacts (the *.mcap files of a run), and stages of your own",
        commands: &["show", "artifact", "new-stage"],
        is_for_few: true,
    },
];

/// Columns of the longest name and two blanks on both sides.
const LABEL: usize = 19;

/// What a command is about, up to the first details.
pub fn in_a_line(command: &Command) -> String {
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    let end = [". ", " (", ": ", "; ", ", "].iter().filter_map(|mark| about.find(mark)).min().unwrap_or(about.len());
    about[..end].trim_end_matches('.').to_owned()
}

/// The commands in their groups, as a template of clap's help; `is_short` names those for few in a line and has no
/// options.
pub fn template(commands: &[Command], is_short: bool) -> String {
    let mut text = String::from("{about-with-newline}\n{usage-heading} {usage}\n");
    for Group { title, commands: names, is_for_few } in &GROUPS {
        let known = names.iter().filter_map(|name| commands.iter().find(|command| command.get_name() == *name));
        let lines: Vec<String> = if is_short && *is_for_few {
            let names: Vec<&str> = known.map(Command::get_name).collect();
            let lines = wrapped(&names.join(", "), columns().saturating_sub(2));
            lines.iter().map(|line| format!("  {line}")).collect()
        } else {
            known.flat_map(|c| labelled(&format!("  {}", c.get_name()), LABEL, &in_a_line(c), columns())).collect()
        };
        if !lines.is_empty() {
            text += &format!("\n{title}:\n{}\n", lines.join("\n"));
        }
    }
    if is_short { text.trim_end().to_owned() + "{after-help}" } else { text + "\nOptions:\n{options}{after-help}" }
}
