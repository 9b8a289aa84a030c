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
