//! NI scaling: raw values of a card to values with a unit.
//!
//! A channel lists scales by number; each takes its input from another one or from the raw values, and the last gives
//! the result. Linear scales are applied; a channel with another kind is refused by its name.

use crate::formats::tdms::metadata::{Properties, Property};

/// `y = slope·x + intercept`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    /// Slope.
    pub slope: f64,
    /// Intercept.
    pub intercept: f64,
}

/// The scales to apply, in order; none if the values are final. `layers`: properties of the channel, its group, the
/// file.
pub fn chain(layers: &[&Properties], is_daqmx: bool) -> Result<Vec<Linear>, String> {
    let find = |name: &str| layers.iter().find_map(|layer| layer.get(name));
    let number = |name: &str| match find(name) {
        Some(Property::Number(x)) => Some(*x),
        _ => None,
    };
    let count = number("NI_Number_Of_Scales").filter(|n| *n >= 1.0);
    let unscaled = match find("NI_Scaling_Status") {
        Some(Property::Text(status)) => status == "unscaled",
        _ => is_daqmx,
    };
    let Some(count) = count.filter(|_| unscaled) else { return Ok(Vec::new()) };
    let mut scales = Vec::new();
    let mut scale = count - 1.0;
    // A scale without a kind, and the number 2^32 - 1, are the raw values.
    while let Some(Property::Text(kind)) = find(&format!("NI_Scale[{scale}]_Scale_Type")) {
        if kind != "Linear" {
            return Err(format!("its scale {scale} is of kind {kind}, only Linear is applied"));
        }
        let part = |part: &str| {
            let name = format!("NI_Scale[{scale}]_Linear_{part}");
            number(&name).filter(|x| x.is_finite()).ok_or_else(|| format!("its property {name} is not a number"))
        };
        scales.push(Linear { slope: part("Slope")?, intercept: part("Y_Intercept")? });
        if scales.len() > 64 {
            return Err("its scales refer to each other in a circle".to_owned());
        }
        scale = number(&format!("NI_Scale[{scale}]_Linear_Input_Source")).unwrap_or(f64::from(u32::MAX));
    }
    scales.reverse();
    Ok(scales)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn properties(list: &[(&str, Property)]) -> Properties {
        list.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
    }

    fn text(text: &str) -> Property {
        Property::Text(text.to_owned())
    }

    #[test]
    fn scales_are_followed_to_the_raw_values() {
        use Property::Number;
        let mut all = properties(&[
            ("NI_Number_Of_Scales", Number(3.0)),
            ("NI_Scaling_Status", text("unscaled")),
            ("NI_Scale[1]_Scale_Type", text("Linear")),
            ("NI_Scale[1]_Linear_Slope", Number(2.0)),
            ("NI_Scale[1]_Linear_Y_Intercept", Number(1.0)),
            ("NI_Scale[1]_Linear_Input_Source", Number(0.0)),
            ("NI_Scale[2]_Scale_Type", text("Linear")),
            ("NI_Scale[2]_Linear_Slope", Number(10.0)),
            ("NI_Scale[2]_Linear_Y_Intercept", Number(0.0)),
            ("NI_Scale[2]_Linear_Input_Source", Number(1.0)),
        ]);
        let linear = |slope, intercept| Linear { slope, intercept };
        let both = vec![linear(2.0, 1.0), linear(10.0, 0.0)];
        assert_eq!(chain(&[&all], false), Ok(both.clone()));
        assert_eq!(chain(&[&Properties::new(), &all], true), Ok(both));
        all.insert("NI_Scale[1]_Linear_Input_Source".to_owned(), Number(2.0));
        assert!(chain(&[&all], false).unwrap_err().contains("circle"));
        all.insert("NI_Scale[1]_Scale_Type".to_owned(), text("Thermocouple"));
        assert!(chain(&[&all], false).unwrap_err().contains("kind Thermocouple"));
        all.insert("NI_Scaling_Status".to_owned(), text("scaled"));
        assert_eq!(chain(&[&all], false), Ok(vec![]));
    }
}
