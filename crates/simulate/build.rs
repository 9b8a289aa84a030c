//! The digest of the sources, for the provenance of what this program writes.

fn main() -> std::io::Result<()> {
    crumple_source_digest::state()
}
