//! Names of files and folders of an ISO-MME test.

/// `test.001`, `test.1234`: three or four digits.
pub fn is_channel_name(name: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(_, e)| matches!(e.len(), 3 | 4) && e.bytes().all(|b| b.is_ascii_digit()))
}

/// The test file and the channel list.
pub fn is_text_part(name: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(_, e)| e.eq_ignore_ascii_case("mme") || e.eq_ignore_ascii_case("chn"))
}

/// The folder of channel files in an ISO-MME test, in any case.
pub fn is_channel_folder(name: &str) -> bool {
    name.eq_ignore_ascii_case("channel") || name.eq_ignore_ascii_case("channels")
}
