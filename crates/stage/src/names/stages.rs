//! The names of the stages and which of them writes what, for messages and for a stable order. Nothing here knows what
//! a stage does.

/// Stages in the order of the pipeline.
pub(crate) const STAGES: [&str; 8] =
    ["ingest", "filter", "integrate", "identify", "parameter-solve", "simulate", "predict", "report"];

/// Position of a stage in the pipeline; programs from elsewhere come last.
pub(crate) fn stage_order(stage: Option<&str>) -> usize {
    stage.and_then(|name| STAGES.iter().position(|s| *s == name)).unwrap_or(STAGES.len())
}

/// The binary that writes a topic, e.g. `/events` -> `crumple-integrate`.
pub(crate) fn writer_of(topic: &str) -> &'static str {
    const WRITERS: [(&str, &str); 23] = [
        ("/tests", "crumple-parameter-solve"),
        ("/test", "crumple-ingest"),
        ("/quality/", "crumple-ingest"),
        ("/filter/", "crumple-filter"),
        ("/events", "crumple-integrate"),
        ("/metrics", "crumple-integrate"),
        ("/model/", "crumple-identify"),
        ("/modes/", "crumple-identify"),
        ("/identification/", "crumple-identify"),
        ("/evidence/", "crumple-identify"),
        ("/shapes/", "crumple-identify"),
        ("/stabilisation/", "crumple-identify"),
        ("/response/", "crumple-identify"),
        ("/selection/", "crumple-identify"),
        ("/matching/", "crumple-parameter-solve"),
        ("/parameters/", "crumple-parameter-solve"),
        ("/recommendation", "crumple-parameter-solve"),
        ("/simulation/", "crumple-simulate"),
        ("/prediction/", "crumple-predict"),
        ("/wave/", "crumple-filter or crumple-ingest"),
        ("/notes", "any stage"),
        ("/concerns", "any stage"),
        ("/diagnosis", "any stage"),
    ];
    if topic.starts_with("/wave/") && ["/velocity", "/displacement", "/force"].iter().any(|s| topic.ends_with(s)) {
        return "crumple-integrate";
    }
    WRITERS.iter().find(|(prefix, _)| topic.starts_with(prefix)).map_or("another stage", |(_, writer)| writer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_are_in_the_order_of_the_pipeline_and_others_behind_them() {
        let orders: Vec<usize> = STAGES.iter().map(|stage| stage_order(Some(stage))).collect();
        assert!(orders.windows(2).all(|pair| pair[0] < pair[1]), "{orders:?}");
        assert!(stage_order(Some("mine")) > orders[0] && stage_order(None) > orders[0]);
    }

    #[test]
    fn a_topic_is_written_by_its_stage() {
        for (topic, writer) in [
            ("/test", "crumple-ingest"),
            ("/filter/93", "crumple-filter"),
            ("/events", "crumple-integrate"),
            ("/parameters/kelvin/direct-fit/1", "crumple-parameter-solve"),
            ("/wave/93", "crumple-filter or crumple-ingest"),
            ("/wave/93/velocity", "crumple-integrate"),
            ("/mine/velocity", "another stage"),
        ] {
            assert_eq!(writer_of(topic), writer, "{topic}");
        }
    }
}
