//! What can be read: one reader a format, the registry that recognises them, what several formats share. Sees bytes and
//! settings only.

pub mod ev5;
pub mod hdf5;
pub mod iso13499;
pub mod iso_mme;
pub mod json_lines;
pub mod lvm;
pub mod mat;
pub mod mcap;
pub mod messages;
pub mod parquet;
pub mod protobuf;
pub mod reader;
pub mod registry;
pub mod remarks;
pub mod ros_bag;
pub mod simulation;
pub mod table;
pub mod tdm;
pub mod tdms;
pub mod universal;
pub mod workbook;
pub mod text {
    //! Lines, numbers and column names of text files.

    pub mod column_names;
    pub mod lines;
}
pub mod waveform {
    //! Named waveforms of TDMS, TDM and LVM files as channels: identity, unit, time; what these formats share.

    pub mod channel;
    pub mod clock;
    pub mod conversion;
}
