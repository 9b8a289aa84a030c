//! Which channel was taken and which others there are.

use crumple_drawing::escape::html;
use crumple_drawing::numbers::ABSENT;
use crumple_signal::Channel;

use crate::Run;

/// With more channels than this the list is folded: a full-scale test has hundreds.
const OPEN_LIST: usize = 12;

pub(super) fn write(out: &mut String, run: &Run) {
    let channels = &run.test.channels;
    if channels.is_empty() {
        return;
    }
    let taken = run.channel_id();
    out.push_str("<section>\n<h2>Channels</h2>\n");
    match (taken, run.channel()) {
        (Some(id), Some(channel)) => {
            let place = if channel.location.is_empty() { String::new() } else { format!(" ({})", channel.location) };
            out.push_str(&format!(
                "<p>Taken as the crash pulse: <strong>{}</strong>{}. The test lists {} channel{} in all{}.</p>\n",
                html(id),
                html(&place),
                channels.len(),
                if channels.len() == 1 { "" } else { "s" },
                html(&states(channels))
            ));
        }
        _ => out.push_str("<p>The test does not say which of its channels is the crash pulse.</p>\n"),
    }
    let folded = channels.len() > OPEN_LIST;
    if folded {
        out.push_str(&format!("<details><summary>Show all {} channels</summary>\n", channels.len()));
    }
    out.push_str(
        "<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">Id</th><th scope=\"col\">Location</th><th \
         scope=\"col\">Axis</th>\
         <th scope=\"col\">Quantity</th><th scope=\"col\">CFC</th><th scope=\"col\">Status</th><th \
         scope=\"col\">Remark</th></tr></thead>\n<tbody>\n",
    );
    for channel in channels {
        row(out, channel, taken == Some(channel.id.as_str()));
    }
    out.push_str("</tbody>\n</table></div>\n");
    if folded {
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
    if counts.len() == 1 && counts.contains_key(&crumple_signal::ChannelStatus::Valid) {
        return String::new();
    }
    let parts: Vec<String> = counts.iter().map(|(status, count)| format!("{count} {status}")).collect();
    format!(": {}", parts.join(", "))
}

fn row(out: &mut String, channel: &Channel, taken: bool) {
    let or_dash = |text: Option<String>| text.map_or_else(|| ABSENT.to_owned(), |text| html(&text));
    let mut remark = channel.comment.clone().unwrap_or_default();
    if channel.redundant {
        remark = if remark.is_empty() { "redundant".to_owned() } else { format!("redundant; {remark}") };
    }
    out.push_str(&format!(
        "<tr{}><td><code>{}</code>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
        if taken { " class=\"best\"" } else { "" },
        html(&channel.id),
        if taken { " <strong>taken</strong>" } else { "" },
        html(&channel.location),
        or_dash(channel.axis.map(|axis| axis.to_string())),
        html(&channel.quantity.name().replace('_', " ")),
        or_dash(channel.cfc.map(|cfc| cfc.to_string())),
        html(channel.status.name()),
        html(&remark)
    ));
}
