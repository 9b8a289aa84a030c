//! `ro-crate-metadata.json`: the passport as a Workflow Run RO-Crate, written and read.

use std::collections::BTreeMap;
use std::path::Path;

use crumple_stage::{Pipeline, Refused, chain, sidecar_of};
use serde_json::{Map, Value, json};

use super::contents::{Contents, Item, Role, damaged};

/// Name of the file.
pub(crate) const METADATA: &str = "ro-crate-metadata.json";

/// What the file is written in: RO-Crate 1.1, and the terms of Workflow Run RO-Crate.
const CONTEXT: [&str; 2] = ["https://w3id.org/ro/crate/1.1/context", "https://w3id.org/ro/terms/workflow-run/context"];
const RO_CRATE: &str = "https://w3id.org/ro/crate/1.1";
/// Profiles that the crate follows: address, name, version.
const PROFILES: [(&str, &str, &str); 3] = [
    ("https://w3id.org/ro/wfrun/process/0.5", "Process Run Crate", "0.5"),
    ("https://w3id.org/ro/wfrun/workflow/0.5", "Workflow Run Crate", "0.5"),
    (WORKFLOW_RO_CRATE, "Workflow RO-Crate", "1.0"),
];
const WORKFLOW_RO_CRATE: &str = "https://w3id.org/workflowhub/workflow-ro-crate/1.0";
const COMPUTATIONAL_WORKFLOW: &str = "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE";
const BLAKE3: &str = "https://github.com/BLAKE3-team/BLAKE3";
const HOME: &str = env!("CARGO_PKG_REPOSITORY");
/// The entities of the run and of the language of its pipeline.
const RUN: &str = "#run";
const LANGUAGE: &str = "#crumple-pipeline";

/// What a digest is of.
const OF_BYTES: &str = "BLAKE3 of the bytes";
const OF_CONTENT: &str = "BLAKE3 of the content";
const OF_SOURCES: &str = "BLAKE3 of the sources that it was built of";

/// What a passport says beside the files.
#[derive(Debug, Clone)]
pub(crate) struct About {
    /// `2026-11-30`.
    pub date: String,
    /// An address, or words.
    pub license: Option<String>,
    /// Name of the pipeline.
    pub pipeline: String,
    /// The programs of the stages.
    pub programs: Vec<Software>,
}

/// The program of a stage.
#[derive(Debug, Clone)]
pub(crate) struct Software {
    pub stage: &'static str,
    /// The command of one from elsewhere.
    pub command: Option<String>,
    pub version: String,
    /// What each digest is of, and the digest.
    pub digests: Vec<(String, String)>,
}

impl Software {
    /// One of the project, with the digest of its sources where it says that.
    pub(crate) fn own(stage: &'static str, version: &str, build: &str) -> Self {
        let digests = Some((OF_SOURCES.to_owned(), build.to_owned())).filter(|_| !build.is_empty());
        Self { stage, command: None, version: version.to_owned(), digests: digests.into_iter().collect() }
    }
}

// Writing.

/// Entities on their way into the graph.
#[derive(Default)]
struct Graph(Vec<Value>);

impl Graph {
    fn add(&mut self, id: &str, entity: Value) -> Value {
        let mut entity = entity;
        entity["@id"] = id.into();
        if let Value::Object(fields) = &mut entity {
            // Nothing is said of what is unknown; one value stands alone, as RO-Crate 1.1 recommends.
            fields.retain(|_, value| !value.is_null() && value.as_array().is_none_or(|values| !values.is_empty()));
            let single = fields.values_mut().filter(|value| value.as_array().is_some_and(|values| values.len() == 1));
            single.for_each(|value| *value = value[0].take());
        }
        self.0.push(entity);
        json!({ "@id": id })
    }

    /// Digests as entities of their own.
    fn digests<'a>(&mut self, of: &str, digests: impl IntoIterator<Item = (&'a str, &'a str)>) -> Vec<Value> {
        let numbered = digests.into_iter().enumerate();
        let entity =
            |what, digest| json!({ "@type": "PropertyValue", "name": what, "propertyID": BLAKE3, "value": digest });
        numbered
            .map(|(k, (what, digest))| self.add(&format!("#digest-{}-of-{}", k + 1, encoded(of)), entity(what, digest)))
            .collect()
    }

    fn item(&mut self, item: &Item, more: Value) -> Value {
        let digests = [(OF_BYTES, &item.bytes), (OF_CONTENT, &item.content)];
        let digests = digests.into_iter().filter_map(|(what, digest)| Some((what, digest.as_deref()?)));
        let digests = self.digests(&item.place(), digests);
        let place = encoded(&item.place());
        let (id, kind) = if item.is_inside { (place, "File") } else { (format!("#{place}"), "CreativeWork") };
        let mut entity = json!({
            "@type": kind,
            "name": item.name,
            "contentSize": item.size.map(|size| size.to_string()),
            "encodingFormat": format_of(&item.name),
            "identifier": digests,
        });
        if let (Value::Object(entity), Value::Object(more)) = (&mut entity, more) {
            entity.extend(more);
        }
        self.add(&id, entity)
    }
}

/// The text of the file. The same contents give the same bytes.
pub(crate) fn metadata(contents: &Contents, about: &About) -> String {
    let mut graph = Graph::default();
    let (record, pipeline) = (&contents.record.name, &about.pipeline);
    graph.add(
        METADATA,
        json!({
            "@type": "CreativeWork",
            "about": { "@id": "./" },
            "conformsTo": [{ "@id": RO_CRATE }, { "@id": WORKFLOW_RO_CRATE }],
        }),
    );
    for (id, name, version) in PROFILES {
        graph.add(id, json!({ "@type": "CreativeWork", "name": name, "version": version }));
    }
    graph.add(COMPUTATIONAL_WORKFLOW, json!({ "@type": "CreativeWork", "name": "ComputationalWorkflow" }));
    let license = match &about.license {
        Some(url) if url.starts_with("http://") || url.starts_with("https://") => {
            graph.add(url, json!({ "@type": "CreativeWork", "name": url, "description": "License of the crate." }))
        }
        Some(words) => json!(words),
        None => json!("No license is stated: ask who made this crate before you use it."),
    };
    graph.add(LANGUAGE, json!({
        "@type": "ComputerLanguage", "name": "Crumple pipeline", "url": { "@id": HOME }, "version": contents.version,
    }));
    let programs: Vec<Value> = about.programs.iter().map(|program| software(&mut graph, program)).collect();
    graph.item(
        &contents.pipeline,
        json!({
            "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow"],
            "name": format!("Crumple pipeline {pipeline}"),
            "alternateName": contents.pipeline.name,
            "conformsTo": { "@id": COMPUTATIONAL_WORKFLOW },
            "hasPart": programs,
            "programmingLanguage": { "@id": LANGUAGE },
            "url": { "@id": HOME },
            "version": contents.version,
        }),
    );
    let mut inputs = vec![graph.item(&contents.record, json!({ "description": "The record." }))];
    let beside = json!({ "description": "Options beside the record." });
    inputs.extend(contents.sidecar.iter().map(|sidecar| graph.item(sidecar, beside.clone())));
    let results: Vec<Value> = contents.results.iter().map(|result| graph.item(result, json!({}))).collect();
    graph.add(
        RUN,
        json!({
            "@type": "CreateAction",
            "actionStatus": "http://schema.org/CompletedActionStatus",
            "description": format!("Crumple {} ran the pipeline {pipeline} on {record}.", contents.version),
            "instrument": { "@id": contents.pipeline.place() },
            "name": format!("Run of {record}"),
            "object": inputs,
            "result": results,
        }),
    );
    let parts = contents.items().filter(|item| item.is_inside);
    let parts: Vec<Value> = parts.map(|item| json!({ "@id": encoded(&item.place()) })).collect();
    graph.add(
        "./",
        json!({
            "@type": "Dataset",
            "conformsTo": PROFILES.map(|(id, ..)| json!({ "@id": id })),
            "datePublished": about.date,
            "description": "What a run of Crumple was made from and what it made, with digests. \
                            `crumple check --passport` runs it again and compares.",
            "hasPart": parts,
            "license": license,
            "mainEntity": { "@id": contents.pipeline.place() },
            "mentions": [{ "@id": RUN }],
            "name": format!("Crumple run of {record}, pipeline {pipeline}"),
        }),
    );
    let crate_ = json!({ "@context": CONTEXT, "@graph": graph.0 });
    format!("{crate_:#}\n")
}

fn software(graph: &mut Graph, program: &Software) -> Value {
    let id = format!("#program-{}", program.stage);
    let digests = program.digests.iter().map(|(what, digest)| (what.as_str(), digest.as_str()));
    let digests = graph.digests(&id, digests);
    let own = program.command.is_none();
    let name = program.command.clone().unwrap_or_else(|| format!("crumple {}", program.stage));
    let role = if own { "The stage" } else { "A program from elsewhere for the stage" };
    graph.add(
        &id,
        json!({
            "@type": "SoftwareApplication",
            "name": name,
            "description": format!("{role} {}.", program.stage),
            "identifier": digests,
            "softwareVersion": Some(&program.version).filter(|version| !version.is_empty()),
            "url": own.then(|| json!({ "@id": HOME })),
        }),
    )
}

/// A path as a relative URI.
fn encoded(path: &str) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte);
    let text = |byte: u8| if is_plain(byte) { (byte as char).to_string() } else { format!("%{byte:02X}") };
    path.bytes().map(text).collect()
}

fn format_of(name: &str) -> Option<&'static str> {
    Some(match Path::new(name).extension()?.to_str()? {
        "toml" => "application/toml",
        "json" => "application/json",
        "html" => "text/html",
        "csv" => "text/csv",
        "zip" => "application/zip",
        "mcap" => "application/octet-stream",
        _ => return None,
    })
}

// Reading.

/// Reads what a crate says of its files. `file` names the crate in errors.
///
/// Errors: no JSON, no crate of this program, names that no run has.
pub(crate) fn read(file: &Path, text: &str) -> Result<Contents, Refused> {
    let lacks = |what: &str| damaged(file, format!("{METADATA} {what}"));
    let json: Value = serde_json::from_str(text).map_err(|error| lacks(&format!("is no JSON: {error}")))?;
    let graph = json["@graph"].as_array().ok_or_else(|| lacks("has no @graph"))?;
    let by_id: BTreeMap<&str, &Value> =
        graph.iter().filter_map(|entity| Some((entity["@id"].as_str()?, entity))).collect();
    let entity = |id: &str| by_id.get(id).copied().ok_or_else(|| lacks(&format!("does not describe {id}")));
    let run = entity(RUN)?;
    let items = |key: &str, role: Role| -> Result<Vec<Item>, Refused> {
        ids(&run[key])
            .map(|id| item(&by_id, entity(id)?, role).ok_or_else(|| lacks(&format!("has no name for {id}"))))
            .collect()
    };
    let [inputs, results] = [items("object", Role::Input)?, items("result", Role::Own)?];
    let workflow = entity(Pipeline::OF_A_RUN)?;
    let mut pipeline = item(&by_id, workflow, Role::Own).ok_or_else(|| lacks("does not name the pipeline"))?;
    Pipeline::OF_A_RUN.clone_into(&mut pipeline.name);
    let names: Vec<&str> = inputs.iter().map(|input| input.name.as_str()).collect();
    let is_sidecar = |name: &str| names.iter().any(|other| sidecar_of(other) == Path::new(name));
    let (sidecars, mut records): (Vec<Item>, Vec<Item>) =
        inputs.iter().cloned().partition(|input| is_sidecar(&input.name));
    let (Some(record), None, 0..=1) = (records.pop(), records.pop(), sidecars.len()) else {
        return Err(lacks(&format!("names {} inputs, a run has a record and at most a file beside it", names.len())));
    };
    let outputs: Vec<&str> = chain().flat_map(|stage| stage.outputs).collect();
    if let Some(other) = results.iter().find(|result| !outputs.contains(&result.name.as_str())) {
        return Err(lacks(&format!("names {:?}, which no run makes", other.name)));
    }
    let mut seen = std::collections::BTreeSet::new();
    if let Some(twice) = results.iter().find(|result| !seen.insert(&result.name)) {
        return Err(lacks(&format!("names {:?} twice", twice.name)));
    }
    let version = workflow["version"].as_str().unwrap_or_default().to_owned();
    Ok(Contents { version, pipeline, record, sidecar: sidecars.into_iter().next(), results })
}

/// The entities that a property names, one or several.
fn ids(value: &Value) -> impl Iterator<Item = &str> {
    let several = value.as_array().map_or(std::slice::from_ref(value), Vec::as_slice);
    several.iter().filter_map(|one| one["@id"].as_str())
}

fn item(by_id: &BTreeMap<&str, &Value>, entity: &Value, role: Role) -> Option<Item> {
    let digest = |what: &str| {
        let all = ids(&entity["identifier"]).filter_map(|id| by_id.get(id).copied()).filter_map(Value::as_object);
        let text = |fields: &Map<String, Value>, key: &str| fields.get(key)?.as_str().map(str::to_owned);
        all.filter(|fields| text(fields, "name").as_deref() == Some(what)).find_map(|fields| text(fields, "value"))
    };
    let kind = &entity["@type"];
    let is_file = |kind: &Value| kind == "File";
    Some(Item {
        name: entity["name"].as_str()?.to_owned(),
        role,
        size: entity["contentSize"].as_str().and_then(|size| size.parse().ok()),
        bytes: digest(OF_BYTES),
        content: digest(OF_CONTENT),
        is_inside: is_file(kind) || kind.as_array().is_some_and(|kinds| kinds.iter().any(is_file)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contents() -> Contents {
        let item = |name: &str, role: Role, is_inside: bool| Item {
            name: name.to_owned(),
            role,
            size: Some(12),
            bytes: Some("blake3:aa".to_owned()),
            content: name.ends_with(".mcap").then(|| "blake3:bb".to_owned()),
            is_inside,
        };
        Contents {
            version: "0.2.0".to_owned(),
            pipeline: item(Pipeline::OF_A_RUN, Role::Own, true),
            record: item("crash (1).csv", Role::Input, false),
            sidecar: Some(item("crash (1).csv.toml", Role::Input, true)),
            results: vec![item("1-ingest.mcap", Role::Own, false), item("summary.json", Role::Own, true)],
        }
    }

    fn text() -> String {
        let about = About {
            date: "2026-11-30".to_owned(),
            license: None,
            pipeline: "default".to_owned(),
            programs: vec![Software::own("filter", "0.2.0", "blake3:cc")],
        };
        metadata(&contents(), &about)
    }

    #[test]
    fn what_is_written_is_read_back() {
        assert_eq!(read(Path::new("x.zip"), &text()).unwrap(), contents());
        assert!(text().contains("\"record/crash%20%281%29.csv.toml\""), "{}", text());
    }

    #[test]
    fn what_no_run_has_is_refused() {
        let refused =
            |from: &str, to: &str| read(Path::new("x.zip"), &text().replace(from, to)).unwrap_err().to_string();
        assert!(
            refused("\"name\": \"summary.json\"", "\"name\": \"../x\"").contains("names \"../x\", which no run makes")
        );
        assert!(refused("\"@id\": \"#run\"", "\"@id\": \"#r\"").contains("does not describe #run"));
        assert!(refused("@graph", "graph").contains("has no @graph"));
        assert!(read(Path::new("x"), "{").unwrap_err().to_string().contains("is no JSON"));
    }
}
