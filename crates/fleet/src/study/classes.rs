//! Classes of vehicles, from a file.

use std::collections::BTreeMap;
use std::path::Path;

use crumple_stage::Refused;

/// The class of each vehicle that the file names.
pub(crate) fn read_classes(path: &Path) -> Result<BTreeMap<String, String>, Refused> {
    let refused = |found: String| {
        Refused::new(format!("{}: {found}", path.display()))
            .expected("a CSV file with the columns vehicle and class")
            .hint("name vehicles as `vehicle` in tests.csv of the fleet does")
    };
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path).map_err(|error| refused(error.to_string()))?;
    let heads = reader.headers().map_err(|error| refused(error.to_string()))?.clone();
    let column = |name: &str| {
        heads
            .iter()
            .position(|head| head.eq_ignore_ascii_case(name))
            .ok_or_else(|| refused(format!("no column {name}")))
    };
    let (vehicle, class) = (column("vehicle")?, column("class")?);
    let mut classes = BTreeMap::new();
    for row in reader.records() {
        let row = row.map_err(|error| refused(error.to_string()))?;
        if let (Some(vehicle), Some(class)) = (row.get(vehicle), row.get(class)) {
            classes.insert(vehicle.to_owned(), class.to_owned());
        }
    }
    Ok(classes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("classes.csv");
        std::fs::write(&path, "class, vehicle\nSUV, 2018 A\n").unwrap();
        assert_eq!(read_classes(&path).unwrap()["2018 A"], "SUV");
        std::fs::write(&path, "kind,vehicle\nSUV,2018 A\n").unwrap();
        assert!(read_classes(&path).unwrap_err().to_string().ends_with("no column class"));
    }
}
