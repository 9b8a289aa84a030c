//! Paths that the code of a package names, tests left out, each with the module that names it.

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
