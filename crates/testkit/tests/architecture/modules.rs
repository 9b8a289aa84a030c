//! The modules of a package, and which file defines what a path names: through `use`, `super`, `self` and re-exports.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::{Package, Source, Token, is_word};

/// One file names something that another one defines.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Arrow {
    /// Index of the source that uses it.
    pub from: usize,
    /// Index of the source that defines it.
    pub to: usize,
    /// Line from 1 where it is named.
    pub line: usize,
    /// The last word of its path.
    pub name: String,
}

/// A name brought in by `use`.
#[derive(Debug)]
struct Import {
    name: String,
    path: Vec<String>,
    /// With any `pub`, however far it reaches.
    is_handed_on: bool,
    /// With a `pub` that reaches everywhere.
    is_public: bool,
    line: usize,
}

#[derive(Debug, Default)]
struct Module {
    source: usize,
    parent: Option<usize>,
    root: usize,
    children: BTreeMap<String, usize>,
    /// Children with a `pub` that reaches everywhere.
    public_children: BTreeSet<String>,
    defined: BTreeSet<String>,
    imports: Vec<Import>,
    /// Paths of `use path::*`.
    globs: Vec<Vec<String>>,
    /// Imports inside of functions, which bring no name into the module.
    inner: Vec<Import>,
    /// Paths of two words and more outside of `use`, with their lines.
    paths: Vec<(Vec<String>, usize)>,
    /// Every word outside of `use`.
    words: BTreeSet<String>,
}

/// All modules of a package: its library's and its programs'.
pub struct Modules<'a> {
    sources: &'a [Source],
    modules: Vec<Module>,
    library: Option<usize>,
    library_name: String,
}

/// What a path leads to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Target {
    Module(usize),
    Item(usize),
}

impl<'a> Modules<'a> {
    /// Reads the modules from `lib.rs`, `main.rs` and the programs in `bin`.
    pub fn new(package: &'a Package) -> Self {
        let library_name = format!("crumple_{}", package.name.replace('-', "_"));
        let mut all = Self { sources: &package.sources, modules: Vec::new(), library: None, library_name };
        let source_folder = format!("crates/{}/src", package.name);
        for (index, source) in package.sources.iter().enumerate() {
            let is_program =
                source.path == format!("{source_folder}/main.rs") || source.folder() == format!("{source_folder}/bin");
            let is_library = source.path == format!("{source_folder}/lib.rs");
            if is_program || is_library {
                let root = all.modules.len();
                all.mount(index, None, root);
                if is_library {
                    all.library = Some(root);
                }
            }
        }
        all
    }

    fn mount(&mut self, source: usize, parent: Option<usize>, root: usize) -> usize {
        let id = self.modules.len();
        let (module, children) = read(&self.sources[source], source, parent, root);
        self.modules.push(module);
        let home = self.sources[source].module_folder();
        for name in children {
            let paths = [format!("{home}/{name}.rs"), format!("{home}/{name}/mod.rs")];
            if let Some(child) = self.sources.iter().position(|source| paths.contains(&source.path)) {
                let child = self.mount(child, Some(id), root);
                self.modules[id].children.insert(name, child);
            }
        }
        id
    }

    /// Every arrow between two files, once a pair and name.
    pub fn arrows(&self) -> Vec<Arrow> {
        let mut arrows = BTreeSet::new();
        for (id, module) in self.modules.iter().enumerate() {
            let mut add = |path: &[String], line: usize| {
                if let Some(Target::Item(to)) = self.resolve(id, path, false, 0)
                    && to != module.source
                {
                    let name = path.last().cloned().unwrap_or_default();
                    arrows.insert(Arrow { from: module.source, to, line: line + 1, name });
                }
            };
            for import in module.imports.iter().chain(&module.inner) {
                // A re-export is an arrow where the file uses the name too.
                if !import.is_handed_on || module.words.contains(&import.name) {
                    add(&import.path, import.line);
                }
            }
            for (path, line) in &module.paths {
                add(path, *line);
            }
            for glob in &module.globs {
                if let Some(Target::Module(of)) = self.resolve(id, glob, true, 0) {
                    for word in module.words.iter().filter(|word| self.lookup(of, word, false, 0).is_some()) {
                        add(&[&glob[..], std::slice::from_ref(word)].concat(), 0);
                    }
                }
            }
        }
        let mut arrows: Vec<Arrow> = arrows.into_iter().collect();
        arrows.dedup_by(|a, b| (a.from, a.to, &a.name) == (b.from, b.to, &b.name));
        arrows
    }

    /// What the library hands out: files and names of items in them, found from `lib.rs` through `pub use` and
    /// `pub mod`.
    pub fn exported(&self) -> BTreeSet<(usize, String)> {
        let mut exported = BTreeSet::new();
        let (mut seen, mut queue) = (BTreeSet::new(), Vec::from_iter(self.library));
        while let Some(id) = queue.pop() {
            if !seen.insert(id) {
                continue;
            }
            let module = &self.modules[id];
            exported.extend(module.defined.iter().map(|name| (module.source, name.clone())));
            queue.extend(module.public_children.iter().filter_map(|name| module.children.get(name)));
            for import in module.imports.iter().filter(|import| import.is_public) {
                match self.resolve(id, &import.path, false, 0) {
                    Some(Target::Item(source)) => {
                        exported.extend(import.path.last().map(|name| (source, name.clone())));
                    }
                    Some(Target::Module(of)) => queue.push(of),
                    None => {}
                }
            }
        }
        exported
    }

    /// Where a path leads, seen from a module; `as_module`: a module is meant where a module and an item share the
    /// name.
    fn resolve(&self, from: usize, path: &[String], as_module: bool, depth: usize) -> Option<Target> {
        if depth > 20 {
            return None;
        }
        let (first, mut rest) = path.split_first()?;
        let mut current = match first.as_str() {
            "crate" => Target::Module(self.modules[from].root),
            "self" => Target::Module(from),
            "super" => Target::Module(self.modules[from].parent?),
            name if name == self.library_name => Target::Module(self.library?),
            name => self.lookup(from, name, as_module || !rest.is_empty(), depth + 1)?,
        };
        while let (Target::Module(id), Some((next, after))) = (current, rest.split_first()) {
            current = match next.as_str() {
                "super" => Target::Module(self.modules[id].parent?),
                "self" => Target::Module(id),
                name => self
                    .lookup(id, name, as_module || !after.is_empty(), depth + 1)
                    // Made by a macro, most likely.
                    .unwrap_or(Target::Item(self.modules[id].source)),
            };
            rest = after;
        }
        Some(current)
    }

    fn lookup(&self, id: usize, name: &str, as_module: bool, depth: usize) -> Option<Target> {
        let module = &self.modules[id];
        let child = module.children.get(name).map(|child| Target::Module(*child));
        if as_module && child.is_some() {
            return child;
        }
        if module.defined.contains(name) {
            return Some(Target::Item(module.source));
        }
        let own = |path: &[String]| path != [name.to_owned()] && path != ["self".to_owned(), name.to_owned()];
        let imported = module.imports.iter().filter(|import| import.name == name && own(&import.path));
        let mut imported = imported.filter_map(|import| self.resolve(id, &import.path, as_module, depth + 1));
        imported.next().or(child).or_else(|| {
            module.globs.iter().find_map(|glob| match self.resolve(id, glob, true, depth + 1)? {
                Target::Module(of) if of != id && depth < 20 => self.lookup(of, name, as_module, depth + 1),
                _ => None,
            })
        })
    }
}

/// The line from 1 of the first path, imported or written out, that begins with these words.
pub fn line_of_path(source: &Source, words: &[&str]) -> Option<usize> {
    let (module, _) = read(source, 0, None, 0);
    let imports = module.imports.iter().chain(&module.inner).map(|import| (&import.path, import.line));
    let globs = module.globs.iter().map(|path| (path, 0));
    let mut paths = imports.chain(module.paths.iter().map(|(path, line)| (path, *line))).chain(globs);
    let (_, line) = paths.find(|(path, _)| path.len() >= words.len() && path.iter().zip(words).all(|(a, b)| a == b))?;
    Some(line + 1)
}

/// Reads one file: what it defines, imports and names, and the modules it mounts.
fn read(source: &Source, index: usize, parent: Option<usize>, root: usize) -> (Module, Vec<String>) {
    let mut module = Module { source: index, parent, root, ..Module::default() };
    let mut children = Vec::new();
    let tokens = source.tokens();
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    // Braces of modules written out do not count: their items are taken for the file's.
    let (mut depth, mut inline) = (0_usize, Vec::new());
    let (mut at, mut is_handed_on, mut is_public) = (0, false, false);
    while at < tokens.len() {
        match text(at) {
            "{" | "(" | "[" => depth += 1,
            "}" if depth == 0 && inline.pop().is_some() => {}
            "}" | ")" | "]" => depth = depth.saturating_sub(1),
            "pub" => {
                (is_handed_on, is_public) = (true, text(at + 1) != "(");
                if text(at + 1) == "(" {
                    at += 1;
                    while at < tokens.len() && text(at) != ")" {
                        at += 1;
                    }
                }
                at += 1;
                continue;
            }
            "use" if text(at + 1) != "<" => {
                let end = (at..tokens.len()).find(|end| text(*end) == ";").unwrap_or(tokens.len());
                let mut imports = Vec::new();
                read_tree(&tokens[at + 1..end], &[], &mut imports, &mut module.globs);
                for (name, path, line) in imports {
                    let import = Import { name, path, is_handed_on, is_public, line };
                    if depth == 0 { module.imports.push(import) } else { module.inner.push(import) }
                }
                at = end;
            }
            "mod" if depth == 0 && text(at + 2) == ";" => {
                children.push(text(at + 1).to_owned());
                if is_public {
                    module.public_children.insert(text(at + 1).to_owned());
                }
                at += 2;
            }
            "mod" if depth == 0 && text(at + 2) == "{" => {
                inline.push(());
                module.defined.insert(text(at + 1).to_owned());
                at += 2;
            }
            "macro_rules" => {
                module.defined.insert(text(at + 2).to_owned());
            }
            "struct" | "enum" | "union" | "trait" | "type" | "const" | "static" | "fn" if depth == 0 => {
                module.defined.insert(text(at + 1).to_owned());
            }
            word if word.starts_with(is_word) => {
                module.words.insert(word.to_owned());
                let start = at;
                let mut path = vec![word.to_owned()];
                while text(at + 1) == "::" && text(at + 2).starts_with(is_word) {
                    path.push(text(at + 2).to_owned());
                    at += 2;
                }
                if path.len() > 1 && (start == 0 || text(start - 1) != "::") {
                    module.words.extend(path.iter().cloned());
                    module.paths.push((path, tokens[start].line));
                }
            }
            _ => {}
        }
        (is_handed_on, is_public) = (false, false);
        at += 1;
    }
    (module, children)
}

/// One imported name, its path and line.
type Imported = (String, Vec<String>, usize);

/// `a::{b, c as d, e::*}` by single paths.
fn read_tree(tokens: &[Token], before: &[String], imports: &mut Vec<Imported>, globs: &mut Vec<Vec<String>>) {
    let mut path = before.to_vec();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        match token.text.as_str() {
            "::" => {}
            "*" => globs.push(path.clone()),
            "{" => {
                let (mut depth, mut start) = (0, at + 1);
                for (end, inner) in tokens.iter().enumerate().skip(at + 1) {
                    match inner.text.as_str() {
                        "{" => depth += 1,
                        "}" if depth > 0 => depth -= 1,
                        "}" | "," if depth == 0 => {
                            read_tree(&tokens[start..end], &path, imports, globs);
                            start = end + 1;
                            if inner.text == "}" {
                                break;
                            }
                        }
                        _ => {}
                    }
                }
                return;
            }
            "as" => {
                let name = tokens.get(at + 1).map_or("_", |token| token.text.as_str());
                imports.push((name.to_owned(), path, token.line));
                return;
            }
            "self" if at == 0 && !before.is_empty() => {}
            word => path.push(word.to_owned()),
        }
        at += 1;
    }
    let is_glob = tokens.last().is_some_and(|token| token.text == "*");
    if let (Some(token), Some(name), false) = (tokens.first(), path.last().cloned(), is_glob) {
        imports.push((name, path, token.line));
    }
}
