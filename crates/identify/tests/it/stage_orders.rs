//! The program: orders that the record chooses, and reasons that are told once.

use std::path::{Path, PathBuf};

use crumple_artifact::Artifact;
use crumple_artifact::records::{IdentificationV1, NotesV1};
use crumple_numerics::lti::{StateSpace, simulate};
use crumple_signal::{Channel, QuantityKind};
use crumple_testkit::white_noise;

use crate::program::{identify, made, written};

/// A system of three states in white noise, its output with noise of this share of it.
fn three_states(folder: &Path, share: f64) -> PathBuf {
    let a = nalgebra::dmatrix![0.9, 0.3, 0.0; -0.3, 0.9, 0.1; 0.0, 0.0, 0.5];
    let b = nalgebra::dmatrix![1.0; 0.5; 0.8];
    let truth = StateSpace::new(a, b, nalgebra::dmatrix![1.0, 0.0, 0.9], nalgebra::dmatrix![0.2], Some(0.01)).unwrap();
    let u: Vec<f64> = (0..800).map(|k| white_noise(1, k)).collect();
    let mut y = simulate(&truth, std::slice::from_ref(&u), &[0.0; 3]).unwrap().swap_remove(0);
    let size = (y.iter().map(|y| y * y).sum::<f64>() / y.len() as f64).sqrt();
    y.iter_mut().enumerate().for_each(|(k, y)| *y += share * size * white_noise(2, k));
    let channels = ["u", "y"].map(|id| Channel::new(id, QuantityKind::Voltage)).to_vec();
    let waves = [("u", QuantityKind::Voltage, u), ("y", QuantityKind::Voltage, y)];
    written(&made(channels, 0.0, 0.01, &waves), folder, "ingest")
}

#[test]
fn subspace_methods_choose_the_order_of_a_known_system() {
    for share in [0.0, 0.02, 0.1] {
        let folder = tempfile::tempdir().unwrap();
        let input = three_states(folder.path(), share);
        let output = folder.path().join("4.mcap");
        let run =
            identify(&input, &output, &["--methods=n4sid,moesp,cva", "--orders=auto,3", "--inputs=u", "--outputs=y"]);
        assert_eq!(run.code, Some(0), "{}", run.said);
        let result = Artifact::open(&output).unwrap();
        for method in ["n4sid", "moesp", "cva"] {
            let chosen: Option<IdentificationV1> = result.record(&format!("/identification/{method}-3")).unwrap();
            assert!(chosen.is_some_and(|estimated| estimated.order == 3), "{share} {method}: {}", run.said);
            // Asked for twice, by its number and by itself: written once.
            let names = result.records().iter().filter(|r| r.topic.starts_with(&format!("/identification/{method}")));
            assert_eq!(names.count(), 1, "{share}: {}", run.said);
        }
        let notes: NotesV1 = result.record("/notes").unwrap().unwrap();
        let text = "cva: order 3 of 1 to 20 has the smallest BIC";
        assert!(notes.notes.iter().any(|note| note.contains(text)), "{:?}", notes.notes);
    }
}

#[test]
fn a_short_record_chooses_among_the_orders_it_has_room_for() {
    let folder = tempfile::tempdir().unwrap();
    let input = three_states(folder.path(), 0.02);
    let output = folder.path().join("4.mcap");
    let flags = ["--methods=n4sid", "--orders=auto", "--inputs=u", "--outputs=y", "--samples=80"];
    let run = identify(&input, &output, &flags);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let notes: NotesV1 = Artifact::open(&output).unwrap().record("/notes").unwrap().unwrap();
    // 80 samples hold 13 block rows of past and future: 25 + 52 columns.
    assert!(notes.notes.iter().any(|note| note.contains("of 1 to 11 has")), "{:?}", notes.notes);
}

#[test]
fn a_thinned_record_chooses_among_the_orders_it_has_room_for() {
    let folder = tempfile::tempdir().unwrap();
    let input = three_states(folder.path(), 0.02);
    let output = folder.path().join("4.mcap");
    let flags = ["--methods=n4sid", "--orders=auto", "--inputs=u", "--outputs=y", "--samples=346", "--thin=4"];
    let run = identify(&input, &output, &flags);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let notes: NotesV1 = result.record("/notes").unwrap().unwrap();
    // Every fourth of 346 samples are 87, of which three at each end go: 13 block rows of past and future need 77.
    let text = notes.notes.iter().find(|note| note.contains("of 1 to 11 has")).unwrap_or_else(|| {
        panic!("{:?}", notes.notes);
    });
    let order = text.split(' ').nth(2).unwrap();
    let whole: IdentificationV1 = result.record(&format!("/identification/n4sid-{order}")).unwrap().unwrap();
    // The criterion is not that of the model written, which its record tells.
    assert!(whole.notes.iter().any(|note| note.contains("one horizon of 13 block rows")), "{:?}", whole.notes);
}

#[test]
fn why_a_method_gives_nothing_is_told_once() {
    let folder = tempfile::tempdir().unwrap();
    let golden = crumple_testkit::workspace().join("fixtures/double/golden");
    let displacement = golden.join("3-integrate.mcap");
    let output = folder.path().join("4.mcap");
    let flags = [displacement.to_str().unwrap(), "--methods=okid,tfest", "--lags=2000"];
    let run = identify(&golden.join("2-filter.mcap"), &output, &flags);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let notes: NotesV1 = Artifact::open(&output).unwrap().record("/notes").unwrap().unwrap();
    let told = notes.notes.iter().filter(|note| note.contains("okid needs"));
    assert_eq!(told.count(), 1, "{:?}", notes.notes);
}

#[test]
fn a_model_that_follows_next_to_nothing_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let input = three_states(folder.path(), 0.0);
    let output = folder.path().join("4.mcap");
    // White noise for a free decay.
    let flags = ["--methods=era,n4sid", "--orders=2", "--channel=u", "--inputs=none", "--outputs=u"];
    let run = identify(&input, &output, &flags);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    for id in ["era-2", "n4sid-2"] {
        let whole: IdentificationV1 = result.record(&format!("/identification/{id}")).unwrap().unwrap();
        assert!(whole.fit_percent.unwrap() < 20.0, "{id} {:?}", whole.fit_percent);
        assert!(whole.notes.iter().any(|note| note.contains("below 29.3 %")), "{id} {:?}", whole.notes);
    }
}
