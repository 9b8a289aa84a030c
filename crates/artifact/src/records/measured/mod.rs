//! Records of ingest, filter and integrate: the test, its vehicles and damage, waveforms, filters, quality, events,
//! metrics.

mod channel_filter;
mod damage;
mod events;
mod metrics;
mod quality;
mod test;
mod vehicles;
mod wave;

pub use channel_filter::{ChannelFilterV1, CorridorPointV1};
pub use damage::DamageV1;
pub use events::{EventIntervalV1, EventsV1, MissingIntervalV1};
pub use metrics::{MetricV1, MetricsV1, MetricsV2};
pub use quality::QualityV1;
pub use test::{ChannelV1, SourceV1, TestV1};
pub use vehicles::{VehicleV1, VehiclesV1};
pub use wave::WaveBlockV1;
