//! Fixed names in an artifact, and the names of schemas with their versions.

/// Names the container's writer in the MCAP header; fixed, so that it never changes the bytes.
pub(crate) const LIBRARY: &str = "crumple artifact/1";

/// Topic prefix of waveforms.
pub const WAVE_PREFIX: &str = "/wave/";

/// Name of the metadata record that ends the data.
pub(crate) const CONTENT: &str = "content";

/// Whether two schema names are of one type, whatever their versions.
pub fn same_type(a: &str, b: &str) -> bool {
    split_version(a).0 == split_version(b).0
}

/// Whether a schema is a later version of a known one.
pub(crate) fn is_later_version(found: &str, known: &str) -> bool {
    let ((found_name, found_version), (known_name, known_version)) = (split_version(found), split_version(known));
    found_name == known_name && found_version > known_version
}

/// `crumple.Events.v1` -> `("crumple.Events", 1)`.
fn split_version(schema: &str) -> (&str, u32) {
    match schema.rsplit_once(".v") {
        Some((name, version)) => (name, version.parse().unwrap_or(0)),
        None => (schema, 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_higher_version_of_the_same_type_is_later() {
        for (found, is_later) in [
            ("crumple.Events.v2", false),
            ("crumple.Events.v3", true),
            ("crumple.Events.v10", true),
            ("crumple.Events.v1", false),
            ("crumple.Metrics.v3", false),
            ("crumple.Events", false),
        ] {
            assert_eq!(is_later_version(found, "crumple.Events.v2"), is_later, "{found}");
        }
        assert!(same_type("crumple.Events.v1", "crumple.Events.v2"));
        assert!(!same_type("crumple.Events.v1", "crumple.Metrics.v1"));
    }
}
