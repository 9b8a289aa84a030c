//! How well a place on the vehicle serves as the crash pulse, by the channel code.
//!
//! The places of an NHTSA test, which have names of their own, are ranked in `formats/ev5/sensor.rs`.

use crumple_signal::Axis;
use crumple_signal::iso13499::IsoCode;

use crate::recording::read_channel::Fitness;

/// The rank of an accelerometer along x on vehicle `vehicle` (or on the sled), at a place that moves with the passenger
/// compartment; `None` elsewhere, the engine, bumper, subframe and side members first of all. Of two channels of one
/// place the one that is less filtered ranks first.
pub fn fitness(code: &IsoCode, vehicle: u32) -> Option<Fitness> {
    let is_of_vehicle = code.object() == 'S' || code.object() == '?' || code.object().to_digit(10) == Some(vehicle);
    if !is_of_vehicle || code.dimension() != "AC" || code.axis() != Some(Axis::X) {
        return None;
    }
    let fine = code.fine_locations();
    let rear = fine.contains(&"RE");
    let (place, why) = match code.main_location() {
        "SECM" | "CRME" | "SEAT" | "FORA" => (0, "rear-seat crossmember or rear floor"),
        // NHTSA names a sill by its door.
        "SILB" | "SILL" | "DOOR" if rear => (1, "rear sill"),
        "SILB" | "SILL" => (2, "sill"),
        "BPIL" => (3, "B-pillar"),
        "VEHC" => (4, "vehicle centre of gravity"),
        "TUNN" => (5, "tunnel"),
        "SLED" => (6, "sled"),
        _ => return None,
    };
    let filtered = u8::from(code.filter_class().cfc().is_some_and(|class| class < 1000));
    Some(Fitness { redundant: code.redundant(), place: 2 * place + filtered, why })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_compartment_ranks_and_the_engine_does_not() {
        let place = |text: &str| fitness(&IsoCode::parse(text).unwrap().0, 1).map(|f| f.place);
        assert_eq!(place("10FORALERE00AC1P"), Some(0));
        assert_eq!(place("10SEATLERE00ACXD"), Some(1));
        assert_eq!(place("10DOORLERE00AC1P"), Some(2));
        assert_eq!(place("10VEHCCG0000AC1P"), Some(8));
        assert_eq!(place("10VEHC0000__ACXD"), Some(9));
        assert_eq!(place("10DOORLEFR00AC1P"), None);
        assert_eq!(place("10ENGN000000AC1P"), None);
        assert_eq!(place("20FORALERE00AC1P"), None);
        assert_eq!(place("10FORALERE00ACYP"), None);
        assert_eq!(place("11HEADCG00H3ACXA"), None);
    }
}
