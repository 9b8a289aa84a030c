//! Which channel was taken and which others there are.

use crate::drawing::escape::html;
use crate::drawing::numbers::ABSENT;
use crate::findings::Run;
use crate::phrases::PHRASES;
use crate::phrases::words;
use crate::phrases::words::fill;
use crumple_signal::{Channel, ChannelStatus};

use crate::frame::{Column, table};

/// With more channels than this the list is folded: a full-scale test has hundreds.
const OPEN_LIST: usize = 12;

pub(super) fn write(out: &mut String, run: &Run) {
    let channels = &run.test.channels;
    if channels.is_empty() {
        return;
    }
    let taken = run.channel_id();
    let texts = &PHRASES.page;
    out.push_str(&format!("<section>\n<h2>{}</h2>\n", texts.channels));
    match (taken, run.channel()) {
        (Some(id), Some(channel)) => {
            let place = if channel.location.is_empty() { String::new() } else { format!(" ({})", channel.location) };
            let template = if channels.len() == 1 { texts.taken_of_one } else { texts.taken_of_several };
            let filled = [
                ("id", html(id)),
                ("place", html(&place)),
                ("count", channels.len().to_string()),
                ("states", html(&states(channels))),
            ];
            out.push_str(&format!("<p>{}</p>\n", fill(template, &filled)));
        }
        // Nobody asks for a crash pulse where there is no crash.
        _ if run.is_generic() => {}
        _ => out.push_str(&format!("<p>{}</p>\n", texts.no_pulse)),
    }
    let folded = channels.len() > OPEN_LIST;
    if folded {
        let all = fill(texts.all_channels, &[("count", channels.len().to_string())]);
        out.push_str(&format!("<details><summary>{all}</summary>\n"));
    }
    let columns = [texts.id, texts.location, texts.axis_head, texts.quantity, "CFC", texts.status, texts.remark]
        .map(Column::text);
    out.push_str(&table("", &columns));
    let is_without_data = |channel: &&Channel| channel.status != ChannelStatus::Valid;
    for channel in channels {
        let on_paper = !(folded && is_without_data(&channel));
        row(out, channel, taken == Some(channel.id.as_str()), on_paper);
    }
    out.push_str("</tbody>\n</table></div>\n");
    if folded {
        let left_out = channels.iter().filter(is_without_data).count();
        if left_out > 0 {
            let note = fill(texts.not_on_paper, &[("count", left_out.to_string())]);
            out.push_str(&format!("<p class=\"on-paper\">{note}</p>\n"));
        }
        out.push_str("</details>\n");
    }
    out.push_str("</section>\n");
}

/// `: 630 valid, 4 not installed`; empty where all are valid.
fn states(channels: &[Channel]) -> String {
    let mut counts = std::collections::BTreeMap::new();
    for channel in channels {
        *counts.entry(channel.status).or_insert(0_usize) += 1;
    }
    if counts.len() == 1 && counts.contains_key(&ChannelStatus::Valid) {
        return String::new();
    }
    let part = |(status, count): (&ChannelStatus, &usize)| format!("{count} {}", status.name());
    let parts: Vec<String> = counts.iter().map(part).collect();
    format!(": {}", parts.join(", "))
}

fn row(out: &mut String, channel: &Channel, taken: bool, on_paper: bool) {
    let texts = &PHRASES.page;
    let class = match taken {
        true => " class=\"best\"",
        false if !on_paper => " class=\"no-paper\"",
        false => "",
    };
    let or_dash = |text: Option<String>| text.map_or_else(|| ABSENT.to_owned(), |text| html(&text));
    let mut remark = channel.comment.clone().unwrap_or_default();
    if channel.redundant {
        let redundant = texts.redundant;
        remark = if remark.is_empty() { redundant.to_owned() } else { format!("{redundant}; {remark}") };
    }
    out.push_str(&format!(
        "<tr{class}><td><code>{}</code>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}\n",
        html(&channel.id),
        if taken { format!(" <strong>{}</strong>", texts.taken) } else { String::new() },
        html(&channel.location),
        or_dash(channel.axis.map(|axis| axis.to_string())),
        html(&words::metric(channel.quantity.name())),
        or_dash(channel.cfc.map(|cfc| cfc.to_string())),
        html(channel.status.name()),
        html(&remark)
    ));
}
