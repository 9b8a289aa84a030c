//! What can be read: one reader a format, the registry that recognises them, what several formats share. Sees bytes and
//! settings only.

pub mod diadem;
pub mod ev5;
pub mod iso13499;
pub mod iso_mme;
pub mod lvm;
pub mod mcap;
pub mod messages;
pub mod not_read;
pub mod protobuf;
pub mod reader;
pub mod registry;
pub mod ros_bag;
pub mod table;
pub mod tdm;
pub mod tdms;
pub mod text;
pub mod waveform;
