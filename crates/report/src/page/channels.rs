//! Which channel was taken and which others there are.

use crate::drawing::escape::html;
use crate::drawing::numbers::ABSENT;
use crate::findings::Run;
use crate::words;
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
    out.push_str("<section id=\"channels\">\n<h2>Channels</h2>\n");
    match (taken, run.channel()) {
        (Some(id), Some(channel)) => {
            let place = if channel.location.is_empty() { String::new() } else { format!(" ({})", channel.location) };
            let count =
                if channels.len() == 1 { "1 channel".to_owned() } else { format!("{} channels", channels.len()) };
            out.push_str(&format!(
                "<p>Taken as the crash pulse: <strong>{}</strong>{}. The test lists {count} in all{}.</p>\n",
                html(id),
                html(&place),
                html(&states(channels))
            ));
        }
        // Nobody asks for a crash pulse where there is no crash.
        _ if run.is_generic() => {}
        _ => out.push_str("<p>The test does not say which of its channels is the crash pulse.</p>\n"),
    }
    let folded = channels.len() > OPEN_LIST;
    if folded {
        out.push_str(&format!("<details><summary>Show all {} channels</summary>\n", channels.len()));
    }
    let columns = ["Id", "Location", "Axis", "Quantity", "CFC", "Status", "Remark"].map(Column::text);
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
            out.push_str(&format!(
                "<p class=\"on-paper\">Left out on paper, for want of valid data: {left_out}.</p>\n"
            ));
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
    let class = match taken {
        true => " class=\"best\"",
        false if !on_paper => " class=\"no-paper\"",
        false => "",
    };
    let or_dash = |text: Option<String>| text.map_or_else(|| ABSENT.to_owned(), |text| html(&text));
    let mut remark = channel.comment.clone().unwrap_or_default();
    if channel.redundant {
        remark = if remark.is_empty() { "redundant".to_owned() } else { format!("redundant; {remark}") };
    }
    out.push_str(&format!(
        "<tr{class}><td><code>{}</code>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}\n",
        html(&channel.id),
        if taken { " <strong>taken</strong>" } else { "" },
        html(&channel.location),
        or_dash(channel.axis.map(|axis| axis.to_string())),
        html(&words::metric(channel.quantity.name())),
        or_dash(channel.cfc.map(|cfc| cfc.to_string())),
        html(channel.status.name()),
        html(&remark)
    ));
}
