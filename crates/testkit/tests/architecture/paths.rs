//! Paths that the code of a package names, tests left out, each with the module that names it.

use std::collections::{BTreeMap, BTreeSet};

use syn::visit::{self, Visit};

use crate::Package;

/// A path named in a `use`, in code or in a macro.
pub struct Use {
    /// The file below `src` that the module tree begins in: `lib.rs`, `main.rs`, `bin/NAME.rs`.
    pub root: String,
    /// Names of the modules from the root down to the one that names it.
    pub module: Vec<String>,
    /// Its names; the last is `*` if all are meant.
    pub path: Vec<String>,
    /// By a `use` that is `pub`, however far it reaches.
    pub is_handed_on: bool,
    /// File and line.
    pub place: String,
}

struct Reader<'a> {
    package: &'a Package,
    root: String,
    file: String,
    module: Vec<String>,
    uses: Vec<Use>,
}

/// All paths, from the roots of library and programs through the files they mount.
pub fn uses(package: &Package) -> Vec<Use> {
    let mut uses = Vec::new();
    for path in package.files.keys() {
        let Some(root) = path.strip_prefix("src/") else { continue };
        if ["lib.rs", "main.rs"].contains(&root) || root.starts_with("bin/") {
            let mut reader =
                Reader { package, root: root.to_owned(), file: path.clone(), module: Vec::new(), uses: Vec::new() };
            reader.visit_file(&package.files[path].syntax);
            uses.append(&mut reader.uses);
        }
    }
    uses
}

impl Reader<'_> {
    fn add(&mut self, path: Vec<String>, is_handed_on: bool, at: proc_macro2::Span) {
        let place = format!("crates/{}/{}:{}", self.package.name, self.file, at.start().line);
        let (root, module) = (self.root.clone(), self.module.clone());
        self.uses.push(Use { root, module, path, is_handed_on, place });
    }
}

/// The single paths of `a::{b, c as d, e::*}`.
fn single_paths(tree: &syn::UseTree, mut path: Vec<String>, paths: &mut Vec<Vec<String>>) {
    match tree {
        syn::UseTree::Path(tree) => {
            path.push(tree.ident.to_string());
            return single_paths(&tree.tree, path, paths);
        }
        syn::UseTree::Group(group) => {
            return group.items.iter().for_each(|tree| single_paths(tree, path.clone(), paths));
        }
        syn::UseTree::Name(syn::UseName { ident, .. }) | syn::UseTree::Rename(syn::UseRename { ident, .. }) => {
            path.extend((ident != "self").then(|| ident.to_string()));
        }
        syn::UseTree::Glob(_) => path.push("*".to_owned()),
    }
    paths.push(path);
}

impl<'a> Visit<'a> for Reader<'a> {
    fn visit_item(&mut self, item: &'a syn::Item) {
        let attributes = match item {
            syn::Item::Mod(item) => &item.attrs[..],
            syn::Item::Fn(item) => &item.attrs,
            syn::Item::Use(item) => &item.attrs,
            syn::Item::Impl(item) => &item.attrs,
            _ => &[],
        };
        if !attributes.iter().any(is_for_tests) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, item: &'a syn::ItemMod) {
        self.module.push(item.ident.to_string());
        if let Some((_, items)) = &item.content {
            items.iter().for_each(|item| self.visit_item(item));
        } else {
            let bin = if self.root.starts_with("bin/") { "bin/" } else { "" };
            let stem = format!("src/{bin}{}", self.module.join("/"));
            let paths = [format!("{stem}.rs"), format!("{stem}/mod.rs")];
            if let Some((path, source)) = paths.into_iter().find_map(|path| self.package.files.get_key_value(&path)) {
                let above = std::mem::replace(&mut self.file, path.clone());
                self.visit_file(&source.syntax);
                self.file = above;
            }
        }
        self.module.pop();
    }

    fn visit_item_use(&mut self, item: &'a syn::ItemUse) {
        let mut paths = Vec::new();
        single_paths(&item.tree, Vec::new(), &mut paths);
        let is_handed_on = !matches!(item.vis, syn::Visibility::Inherited);
        paths.into_iter().for_each(|path| self.add(path, is_handed_on, item.use_token.span));
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        let names = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        self.add(names, false, path.segments[0].ident.span());
        visit::visit_path(self, path);
    }

    /// The tokens of a macro are not parsed: their words with `::` count.
    fn visit_macro(&mut self, call: &'a syn::Macro) {
        let text = call.tokens.to_string().replace(" :: ", "::");
        for word in
            text.split(|c: char| !c.is_alphanumeric() && c != '_' && c != ':').filter(|word| word.contains("::"))
        {
            let names = word.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect();
            self.add(names, false, call.bang_token.span);
        }
    }

    /// `pub(crate)` and `pub(in path)` use nothing.
    fn visit_visibility(&mut self, _: &'a syn::Visibility) {}
}

/// `#[cfg(test)]`.
fn is_for_tests(attribute: &syn::Attribute) -> bool {
    let list = attribute.meta.require_list();
    list.is_ok_and(|list| list.path.is_ident("cfg") && list.tokens.to_string() == "test")
}

/// Who uses whom, and where.
type Arrows = BTreeMap<(String, String), String>;

pub fn broken(package: &Package) -> Vec<String> {
    let uses = uses(package);
    let roots: BTreeSet<&str> = uses.iter().map(|named| named.root.as_str()).collect();
    let of_root = |root| arrows(root, uses.iter().filter(|named| named.root == *root).collect());
    roots.into_iter().filter_map(|root| message(&of_root(root))).collect()
}

/// The arrows between the modules of one library or program, the root among them under the name of its file.
fn arrows(root: &str, uses: Vec<&Use>) -> Arrows {
    let modules: BTreeSet<&str> = uses.iter().filter_map(|named| named.module.first()).map(String::as_str).collect();
    // What the root hands on belongs to the module that it is from.
    let mut handed_on = BTreeMap::new();
    for named in uses.iter().filter(|named| named.module.is_empty() && named.is_handed_on) {
        let module = below_root(named).filter(|module| modules.contains(module));
        handed_on.extend(named.path.last().map(String::as_str).zip(module));
    }
    let mut arrows = Arrows::new();
    for named in uses.iter().filter(|named| !named.module.is_empty() || !named.is_handed_on) {
        let from = named.module.first().map_or(root, String::as_str);
        let Some(name) = below_root(named) else { continue };
        let to = modules.get(name).copied().or_else(|| handed_on.get(name).copied()).unwrap_or(root);
        // The errors of a crate belong to all of its modules.
        if from != to && ![from, to].contains(&"error") {
            let place = format!("{} {from} uses {}", named.place, named.path.join("::"));
            arrows.entry((from.to_owned(), to.to_owned())).or_insert(place);
        }
    }
    arrows
}

/// The first name of a path below the root of its library or program; none if it leads elsewhere.
fn below_root(named: &Use) -> Option<&str> {
    let (mut depth, mut rest) = match named.path.first()?.as_str() {
        "crate" => (0, &named.path[1..]),
        "self" => (named.module.len(), &named.path[1..]),
        "super" => (named.module.len(), &named.path[..]),
        _ if named.module.is_empty() => (0, &named.path[..]),
        _ => return None,
    };
    while rest.first().is_some_and(|name| name == "super") {
        (depth, rest) = (depth.checked_sub(1)?, &rest[1..]);
    }
    named.module[..depth].iter().chain(rest).next().map(String::as_str)
}

/// One circle, if there is any.
fn message(arrows: &Arrows) -> Option<String> {
    let mut left: Vec<&(String, String)> = arrows.keys().collect();
    let mut before = usize::MAX;
    // Without the modules that use none, until each that is left uses another one.
    while left.len() < before {
        before = left.len();
        let users: BTreeSet<&String> = left.iter().map(|(from, _)| from).collect();
        left.retain(|(_, to)| users.contains(to));
    }
    let mut way = vec![*left.first()?];
    loop {
        let (_, last) = way[way.len() - 1];
        if let Some(start) = way.iter().position(|(from, _)| from == last) {
            let steps: Vec<&str> = way[start..].iter().map(|arrow| arrows[*arrow].as_str()).collect();
            return Some(format!("circle of modules: {}; move what both need below them", steps.join(", ")));
        }
        way.extend(left.iter().find(|(from, _)| from == last));
    }
}
