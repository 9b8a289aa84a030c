//! The word tables of ISO/TS 13499, as far as vehicle tests use them.

pub(super) fn position_words(position: char) -> Option<&'static str> {
    Some(match position {
        '1' => "front left",
        '2' => "front middle",
        '3' => "front right",
        '4' => "second row left",
        '5' => "second row middle",
        '6' => "second row right",
        '7' => "third row left",
        '8' => "third row middle",
        '9' => "third row right",
        'A'..='Z' => "another seat",
        _ => return None,
    })
}

pub(super) fn is_dummy_location(main: &str) -> bool {
    matches!(
        main,
        "HEAD"
            | "NECK"
            | "CHST"
            | "THSP"
            | "LUSP"
            | "ABDO"
            | "PELV"
            | "FEMR"
            | "KNEE"
            | "TIBI"
            | "FOOT"
            | "SHLD"
            | "SPIN"
    )
}

pub(super) fn main_location_words(main: &str) -> Option<&'static str> {
    Some(match main {
        "VEHC" => "vehicle",
        "SEAT" => "seat",
        "SECM" => "seat cross member",
        "CRME" => "crossmember",
        "SILB" => "sill beam",
        "SILL" => "sill",
        "BPIL" => "B-pillar",
        "FORA" => "floor over the rear axle",
        "TUNN" => "tunnel",
        "ENGN" => "engine",
        "MSME" => "main side member",
        "BUMP" => "bumper",
        "SUBF" => "subframe",
        "DOOR" => "door",
        "SLED" => "sled",
        "MBAR" => "mobile barrier",
        "FBAR" => "fixed barrier",
        "LOMA" => "load cell matrix",
        "POLE" => "pole",
        "TIRS" => "time reference",
        "ZERO" => "time zero",
        "ABSE" => "airbag sensor",
        "TRNK" => "trunk",
        "HEAD" => "head",
        "NECK" => "neck",
        "CHST" => "chest",
        "THSP" => "thoracic spine",
        "LUSP" => "lumbar spine",
        "SPIN" => "spine",
        "ABDO" => "abdomen",
        "PELV" => "pelvis",
        "FEMR" => "femur",
        "KNEE" => "knee",
        "TIBI" => "tibia",
        "FOOT" => "foot",
        "SHLD" => "shoulder",
        _ => return None,
    })
}

pub(super) fn fine_location_words(fine: &str) -> Option<&'static str> {
    Some(match fine {
        "LE" => "left",
        "RI" => "right",
        "MI" => "middle",
        "FR" => "front",
        "RE" => "rear",
        "UP" => "upper",
        "LO" => "lower",
        "CG" => "centre of gravity",
        "TP" => "top",
        "BO" => "bottom",
        "RD" => "redundant",
        "H3" => "Hybrid III 50 %",
        "HF" => "Hybrid III 5 %",
        "HM" => "Hybrid III 95 %",
        "E2" => "ES-2",
        "ER" => "ES-2re",
        "S2" => "SID-IIs",
        "TH" | "T3" => "THOR",
        "Q3" => "Q3",
        "P3" => "P3",
        _ => return None,
    })
}
