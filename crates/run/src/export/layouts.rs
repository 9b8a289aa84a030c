//! Layouts for viewers: pulse, velocity, displacement, force over displacement, events.

use crumple_signal::QuantityKind;
use serde_json::{Value, json};

/// What Rerun needs: a blueprint is written with its own package.
pub(crate) const RERUN: &str = include_str!("in_rerun.py");

/// Colours of curves, in turns.
const COLOURS: [&str; 4] = ["#1f77b4", "#7f7f7f", "#d62728", "#2ca02c"];

/// Topics and fields that are shown.
#[derive(Debug, Default)]
pub(crate) struct Shown {
    /// Quantity, topic, field.
    curves: Vec<(QuantityKind, String, String)>,
}

impl Shown {
    /// Adds a curve; `whole`: of the body, not of one of its elements.
    pub(crate) fn add(&mut self, quantity: QuantityKind, topic: &str, field: &str, whole: bool) {
        if whole {
            self.curves.push((quantity, topic.to_owned(), field.to_owned()));
        }
    }

    fn of(&self, quantity: QuantityKind) -> Vec<(&str, &str)> {
        let curves = self.curves.iter().filter(|curve| curve.0 == quantity);
        curves.map(|(_, topic, field)| (topic.as_str(), field.as_str())).collect()
    }

    /// Panels of curves over time.
    fn over_time(&self) -> Vec<(&'static str, Vec<(&str, &str)>)> {
        let panels = [
            ("Acceleration", QuantityKind::Acceleration),
            ("Velocity", QuantityKind::Velocity),
            ("Displacement", QuantityKind::Displacement),
        ];
        panels
            .map(|(title, quantity)| (title, self.of(quantity)))
            .into_iter()
            .filter(|(_, of)| !of.is_empty())
            .collect()
    }

    /// Bodies with force and displacement on one grid: topic, displacement, force.
    fn over_displacement(&self) -> Vec<(&str, &str, &str)> {
        let forces = self.of(QuantityKind::Force);
        let displacements = self.of(QuantityKind::Displacement);
        let pair = |(topic, force)| {
            let (_, displacement) = displacements.iter().find(|(other, _)| *other == topic)?;
            Some((topic, *displacement, force))
        };
        forces.into_iter().filter_map(pair).collect()
    }
}

/// The layout of Foxglove and Lichtblick.
pub(crate) fn foxglove(shown: &Shown) -> String {
    let mut panels = serde_json::Map::new();
    let path = |topic: &str, field: &str| {
        let value = format!("{topic}.{field}");
        json!({"value": value, "enabled": true, "timestampMethod": "receiveTime"})
    };
    let plot = |title: &str, paths: Vec<Value>, x: Value| {
        let mut config = json!({"title": title, "paths": paths, "showLegend": true, "isSynced": true,
            "xAxisVal": "timestamp", "showXAxisLabels": true, "showYAxisLabels": true});
        if !x.is_null() {
            config["xAxisVal"] = "custom".into();
            config["xAxisPath"] = x;
        }
        config
    };
    for (title, curves) in shown.over_time() {
        let paths = curves.iter().map(|(topic, field)| path(topic, field)).collect();
        panels.insert(format!("Plot!{}", title.to_lowercase()), plot(title, paths, Value::Null));
    }
    for (number, (topic, displacement, force)) in shown.over_displacement().into_iter().enumerate() {
        let config = plot("Force over displacement", vec![path(topic, force)], path(topic, displacement));
        panels.insert(format!("Plot!force{number}"), config);
    }
    panels.insert("Table!events".to_owned(), json!({"topicPath": "/event"}));
    let ids: Vec<&String> = panels.keys().collect();
    let layout = split(&ids, true);
    let made_by = json!({"made_by": "crumple.view"});
    let layout = json!({"configById": panels, "globalVariables": made_by, "userNodes": {},
        "playbackConfig": {"speed": 0.1}, "layout": layout});
    format!("{layout:#}\n")
}

/// Panels beside and below each other, halves of halves.
fn split(ids: &[&String], across: bool) -> Value {
    match ids {
        [] => Value::Null,
        [one] => json!(one),
        _ => {
            let (first, second) = ids.split_at(ids.len().div_ceil(2));
            let direction = if across { "row" } else { "column" };
            json!({"direction": direction, "first": split(first, !across), "second": split(second, !across)})
        }
    }
}

/// The layout of PlotJuggler.
pub(crate) fn plotjuggler(shown: &Shown) -> String {
    let curve =
        |k: usize, attributes: String| format!("<curve color=\"{}\" {attributes}/>", COLOURS[k % COLOURS.len()]);
    let mut plots = Vec::new();
    for (title, curves) in shown.over_time() {
        let curves = curves.iter().enumerate().map(|(k, (topic, field))| curve(k, format!("name=\"{topic}/{field}\"")));
        plots.push(area(title, "TimeSeries", &curves.collect::<String>()));
    }
    let pairs = shown.over_displacement().into_iter().enumerate().map(|(k, (topic, displacement, force))| {
        let [x, y] = [displacement, force].map(|field| format!("{topic}/{field}"));
        curve(k, format!("name=\"{topic} force over displacement\" curve_x=\"{x}\" curve_y=\"{y}\""))
    });
    let pairs: String = pairs.collect();
    if !pairs.is_empty() {
        plots.push(area("Force over displacement", "XYPlot", &pairs));
    }
    let count = plots.len();
    let sizes = vec![(1.0 / count.max(1) as f64).to_string(); count].join(";");
    format!(
        "<?xml version='1.0' encoding='UTF-8'?>\n<!-- crumple.view -->\n<root>\n<tabbed_widget parent=\"main_window\" \
         name=\"Main Window\">\n<Tab containers=\"1\" tab_name=\"run\">\n<Container>\n<DockSplitter orientation=\"-\" \
         count=\"{count}\" sizes=\"{sizes}\">\n{}</DockSplitter>\n</Container>\n</Tab>\n<currentTabIndex \
         index=\"0\"/>\n</tabbed_widget>\n<use_relative_time_offset enabled=\"1\"/>\n</root>\n",
        plots.concat()
    )
}

fn area(title: &str, mode: &str, curves: &str) -> String {
    format!("<DockArea name=\"{title}\"><plot mode=\"{mode}\" style=\"Lines\">{curves}</plot></DockArea>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layout_names_what_is_in_the_file() {
        let mut shown = Shown::default();
        for (quantity, field) in [(QuantityKind::Displacement, "displacement_m"), (QuantityKind::Force, "force_n")] {
            shown.add(quantity, "/test/a", field, true);
        }
        shown.add(QuantityKind::Force, "/test/a", "force_k1_n", false);
        let layout: Value = serde_json::from_str(&foxglove(&shown)).unwrap();
        let xy = &layout["configById"]["Plot!force0"];
        assert_eq!(
            (&xy["xAxisPath"]["value"], &xy["paths"][0]["value"]),
            (&json!("/test/a.displacement_m"), &json!("/test/a.force_n"))
        );
        let text = plotjuggler(&shown);
        assert!(text.contains("curve_x=\"/test/a/displacement_m\" curve_y=\"/test/a/force_n\""), "{text}");
        assert!(!text.contains("k1"), "{text}");
    }
}
