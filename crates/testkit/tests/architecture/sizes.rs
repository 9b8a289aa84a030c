//! Sizes and layers.

use syn::visit::{self, Visit};

use crate::Package;
use crate::paths::uses;

/// Most lines of a file.
pub const FILE_LINES: usize = 600;
/// Most lines of a function.
pub const FUNCTION_LINES: usize = 100;
/// Most characters of a line: rustfmt leaves comments and strings as they are.
pub const WIDTH: usize = 120;

pub fn broken(package: &Package) -> Vec<String> {
    let mut broken = Vec::new();
    for (path, source) in &package.files {
        let place = format!("crates/{}/{path}", package.name);
        let lines = source.text.lines().count();
        if lines > FILE_LINES {
            broken.push(format!("{place}: {lines} lines, {FILE_LINES} at most: split it by subject"));
        }
        if !source.text.starts_with("//!") {
            broken.push(format!("{place}: does not open with //!: say in a line what is in it"));
        }
        for (line, text) in source.text.lines().enumerate().filter(|(_, text)| text.chars().count() > WIDTH) {
            broken.push(format!("{place}:{}: {} characters, {WIDTH} at most", line + 1, text.chars().count()));
        }
        let mut functions = Functions::default();
        functions.visit_file(&source.syntax);
        for (name, line, lines) in functions.0.into_iter().filter(|(_, _, lines)| *lines > FUNCTION_LINES) {
            broken.push(format!(
                "{place}:{line}: function {name} has {lines} lines, {FUNCTION_LINES} at most: give its steps names"
            ));
        }
    }
    broken
}

/// Functions with a body: name, first line, number of lines.
#[derive(Default)]
struct Functions(Vec<(String, usize, usize)>);

impl Functions {
    fn add(&mut self, signature: &syn::Signature, body: &syn::Block) {
        let first = signature.fn_token.span.start().line;
        let last = body.brace_token.span.close().end().line;
        self.0.push((signature.ident.to_string(), first, last + 1 - first));
    }
}

impl<'a> Visit<'a> for Functions {
    fn visit_item_fn(&mut self, function: &'a syn::ItemFn) {
        self.add(&function.sig, &function.block);
        visit::visit_item_fn(self, function);
    }

    fn visit_impl_item_fn(&mut self, function: &'a syn::ImplItemFn) {
        self.add(&function.sig, &function.block);
        visit::visit_impl_item_fn(self, function);
    }

    fn visit_trait_item_fn(&mut self, function: &'a syn::TraitItemFn) {
        function.default.iter().for_each(|body| self.add(&function.sig, body));
        visit::visit_trait_item_fn(self, function);
    }
}

/// Crates by layer, foundations first. A crate uses crates of lower layers; dev-dependencies are free.
const LAYERS: [&str; 10] = [
    "signal numerics memory source-digest",
    "artifact",
    "metrics lumped",
    "sysid lumped-fit",
    "stage",
    "diff",
    "ingest filter integrate identify parameter-solve simulate predict report artifact-cli",
    "run",
    "crumple",
    "testkit",
];

/// Crates that know no files, no command line and no environment.
const NUMERICS: &str = "sysid lumped-fit numerics lumped metrics";
/// Crates and paths that they do without.
const OUTER: [&str; 6] = ["crumple_stage", "crumple_artifact", "anyhow", "clap", "std::fs", "std::env"];

fn layer(name: &str) -> Option<usize> {
    LAYERS.iter().position(|layer| layer.split(' ').any(|crate_name| crate_name == name))
}

/// Crates of the workspace that a package uses outside of its tests.
fn dependencies(package: &Package) -> impl Iterator<Item = &str> {
    let tables = ["dependencies", "build-dependencies"].into_iter().filter_map(|kind| package.manifest.get(kind));
    tables.filter_map(toml::Value::as_table).flatten().filter_map(|(name, _)| name.strip_prefix("crumple-"))
}

pub fn broken_layers(packages: &[Package]) -> Vec<String> {
    let mut broken = Vec::new();
    for package in packages {
        let name = package.name.as_str();
        let Some(own) = layer(name) else {
            broken.push(format!("crate {name} has no layer: add it to LAYERS of {} and to ARCHITECTURE.md", file!()));
            continue;
        };
        for used in dependencies(package).filter(|used| layer(used).is_none_or(|layer| layer >= own)) {
            broken.push(format!("crates/{name}/Cargo.toml: {name} uses {used}, which is in no lower layer"));
        }
        let is_outer = |path: &str| OUTER.iter().any(|outer| format!("{path}::").starts_with(&format!("{outer}::")));
        for named in uses(package).iter().filter(|_| NUMERICS.split(' ').any(|numerics| numerics == name)) {
            let path = named.path.join("::");
            if is_outer(&path) {
                broken.push(format!("{}: {path} in a library of numerics: do it in the stage", named.place));
            }
        }
    }
    broken
}
