//! Digests of content.

/// `blake3:<64 hex digits>` of some bytes.
pub fn blake3_text(bytes: &[u8]) -> String {
    format!("blake3:{}", blake3::hash(bytes).to_hex())
}

/// Digest of an artifact's messages in file order: topic, schema name, encoding, log time, payload.
///
/// It does not see compression, chunking, metadata or summary, so the same data from another version of a stage keep
/// their digest. Each part is preceded by its length, so that no two different sequences feed the same bytes.
#[derive(Debug, Clone, Default)]
pub struct ContentDigest {
    hasher: blake3::Hasher,
    messages: u64,
}

impl ContentDigest {
    /// Takes the next message.
    pub fn update(&mut self, topic: &str, schema: &str, encoding: &str, log_time: u64, payload: &[u8]) {
        for part in [topic.as_bytes(), schema.as_bytes(), encoding.as_bytes()] {
            self.hasher.update(&(part.len() as u64).to_le_bytes());
            self.hasher.update(part);
        }
        self.hasher.update(&log_time.to_le_bytes());
        self.hasher.update(&(payload.len() as u64).to_le_bytes());
        self.hasher.update(payload);
        self.messages += 1;
    }

    /// Number of messages taken.
    pub fn messages(&self) -> u64 {
        self.messages
    }

    /// `blake3:<64 hex digits>`.
    pub fn text(&self) -> String {
        format!("blake3:{}", self.hasher.finalize().to_hex())
    }
}
