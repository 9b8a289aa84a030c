//! Records of identify: models, modes, how they were chosen and what supports them.

mod arx_scan;
mod evidence;
mod identification;
mod model;
mod response;
mod selection;
mod shapes;
mod stabilization;

pub use arx_scan::{ArxScanModelV1, ArxScanV1};
pub use evidence::{EvidenceV1, SpreadV1};
pub use identification::IdentificationV1;
pub use model::{
    ExponentialSumV1, ExponentialTermV1, ModeV1, ModesV1, ModesV2, OtherPoleKindV1, OtherPoleV1, StateSpaceV1,
    TransferFunctionV1,
};
pub use response::ResponseV1;
pub use selection::{SelectionModelV1, SelectionV1};
pub use shapes::{ShapeV1, ShapesV1};
pub use stabilization::{StabilizationClusterV1, StabilizationPoleV1, StabilizationV1};
