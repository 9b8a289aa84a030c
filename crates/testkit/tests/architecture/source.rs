//! Source files as the rules read them: text, code without comments and strings, tokens, what is test.

use std::fs;
use std::path::Path;

/// A file of Rust.
pub struct Source {
    /// Path relative to the workspace, with `/`.
    pub path: String,
    /// As it stands in the file.
    pub text: String,
    /// The same length with comments, strings and test code blanked.
    pub code: String,
    /// The same with strings left in.
    pub with_strings: String,
    /// By line: whether it belongs to test code.
    pub is_test: Vec<bool>,
    /// Modules that are mounted for tests only.
    pub test_modules: Vec<String>,
}

/// A package below `crates/`.
pub struct Package {
    /// Name of its folder.
    pub name: String,
    /// `Cargo.toml`.
    pub manifest: toml::Table,
    /// Files below `src`.
    pub sources: Vec<Source>,
    /// Files below `tests`, `benches` and `examples`.
    pub others: Vec<Source>,
}

/// A word or sign of code, and its line from 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    pub text: String,
    pub line: usize,
}

/// Every package of the workspace, by name.
pub fn packages(root: &Path) -> Vec<Package> {
    let mut packages: Vec<Package> = folders(&root.join("crates"))
        .into_iter()
        .filter_map(|folder| {
            let manifest = fs::read_to_string(folder.join("Cargo.toml")).ok()?;
            let manifest = manifest.parse().unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
            let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let sources = sources(root, &folder.join("src"));
            let others = ["tests", "benches", "examples"].map(|kind| sources_below(root, &folder.join(kind)));
            Some(Package { name, manifest, sources, others: others.into_iter().flatten().collect() })
        })
        .collect();
    packages.sort_by(|a, b| a.name.cmp(&b.name));
    packages
}

fn folders(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| path.is_dir()).collect()
}

/// Sources of a package; files that are mounted for tests only count as test code.
fn sources(root: &Path, folder: &Path) -> Vec<Source> {
    let mut sources = sources_below(root, folder);
    let mut test_files = Vec::new();
    for source in &sources {
        let home = source.module_folder();
        for name in &source.test_modules {
            test_files.push(format!("{home}/{name}.rs"));
            test_files.push(format!("{home}/{name}/"));
        }
    }
    sources.retain(|source| !test_files.iter().any(|test| source.path.starts_with(test.as_str())));
    sources
}

fn sources_below(root: &Path, folder: &Path) -> Vec<Source> {
    let mut found = Vec::new();
    let Ok(entries) = fs::read_dir(folder) else { return found };
    let mut paths: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            found.extend(sources_below(root, &path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let path = path.strip_prefix(root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            found.push(Source::new(path, text));
        }
    }
    found
}

impl Source {
    fn new(path: String, text: String) -> Self {
        let mut code: Vec<char> = blank(&text, false).chars().collect();
        let mut with_strings: Vec<char> = blank(&text, true).chars().collect();
        let mut is_test = vec![false; text.lines().count().max(1)];
        let mut test_modules = Vec::new();
        let marker: Vec<char> = "#[cfg(test)]".chars().collect();
        let mut at = 0;
        while let Some(start) = find(&code, &marker, at) {
            let item = after_attributes(&code, start);
            let end = end_of_item(&code, item);
            let words: String = code[item..end].iter().collect();
            let words: Vec<&str> = words.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
            if let Some(place) = words.iter().position(|word| *word == "mod")
                && code.get(end - 1) == Some(&';')
            {
                test_modules.extend(words.get(place + 1).map(|name| (*name).to_owned()));
            }
            let line = |place: usize| code[..place].iter().filter(|c| **c == '\n').count();
            let (first, last) = (line(start), line(end.saturating_sub(1)));
            for flag in is_test.iter_mut().take(last + 1).skip(first) {
                *flag = true;
            }
            for place in start..end {
                for text in [&mut code, &mut with_strings] {
                    if text[place] != '\n' {
                        text[place] = ' ';
                    }
                }
            }
            at = end;
        }
        let (code, with_strings) = (code.into_iter().collect(), with_strings.into_iter().collect());
        Self { path, text, code, with_strings, is_test, test_modules }
    }

    /// Lines that are not test code.
    pub fn lines(&self) -> usize {
        self.is_test.iter().filter(|test| !**test).count()
    }

    /// The name without `.rs`.
    pub fn stem(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or_default().trim_end_matches(".rs")
    }

    /// The folder it lies in.
    pub fn folder(&self) -> &str {
        self.path.rsplit_once('/').map_or("", |(folder, _)| folder)
    }

    /// The folder its modules lie in.
    pub fn module_folder(&self) -> String {
        let is_root = ["mod", "lib", "main"].contains(&self.stem()) || self.folder().ends_with("src/bin");
        if is_root { self.folder().to_owned() } else { format!("{}/{}", self.folder(), self.stem()) }
    }

    /// Words and signs of the code; `::` is one.
    pub fn tokens(&self) -> Vec<Token> {
        let mut tokens = Vec::new();
        for (line, text) in self.code.lines().enumerate() {
            let chars: Vec<char> = text.chars().collect();
            let mut at = 0;
            while at < chars.len() {
                let start = at;
                if is_word(chars[at]) {
                    while at < chars.len() && is_word(chars[at]) {
                        at += 1;
                    }
                } else if chars[at..].starts_with(&[':', ':']) {
                    at += 2;
                } else {
                    at += 1;
                    if chars[start].is_whitespace() {
                        continue;
                    }
                }
                tokens.push(Token { text: chars[start..at].iter().collect(), line });
            }
        }
        tokens
    }
}

pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn find(text: &[char], words: &[char], from: usize) -> Option<usize> {
    (from..text.len()).find(|at| text[*at..].starts_with(words))
}

/// The place behind attributes and blanks.
fn after_attributes(code: &[char], mut at: usize) -> usize {
    loop {
        while code.get(at).is_some_and(|c| c.is_whitespace()) {
            at += 1;
        }
        if code.get(at) != Some(&'#') {
            return at;
        }
        at = closing(code, at + 1, '[', ']');
    }
}

/// The place behind the item that starts here.
fn end_of_item(code: &[char], start: usize) -> usize {
    let mut at = start;
    while at < code.len() {
        match code[at] {
            ';' => return at + 1,
            '{' => return closing(code, at, '{', '}'),
            '(' => at = closing(code, at, '(', ')'),
            _ => at += 1,
        }
    }
    code.len()
}

/// The place behind the bracket that closes the first one opened from here on.
fn closing(code: &[char], from: usize, open: char, close: char) -> usize {
    let mut depth = 0_usize;
    for (at, c) in code.iter().enumerate().skip(from) {
        if *c == open {
            depth += 1;
        } else if *c == close {
            depth = depth.saturating_sub(1);
            if depth == 0 {
                return at + 1;
            }
        }
    }
    code.len()
}

/// The text with comments blanked, and strings and characters unless they are kept.
fn blank(text: &str, keep_strings: bool) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut blanked = chars.clone();
    let mut clear = |from: usize, to: usize| {
        for c in &mut blanked[from..to] {
            if *c != '\n' {
                *c = ' ';
            }
        }
    };
    let mut at = 0;
    while at < chars.len() {
        let rest = &chars[at..];
        let starts_word = at == 0 || !is_word(chars[at - 1]);
        if rest.starts_with(&['/', '/']) {
            let end = at + rest.iter().position(|c| *c == '\n').unwrap_or(rest.len());
            clear(at, end);
            at = end;
        } else if rest.starts_with(&['/', '*']) {
            let end = end_of_comment(&chars, at);
            clear(at, end);
            at = end;
        } else if let Some(end) = end_of_string(&chars, at, starts_word) {
            if !keep_strings {
                clear(at, end);
            }
            at = end;
        } else {
            at += 1;
        }
    }
    blanked.into_iter().collect()
}

/// Block comments nest.
fn end_of_comment(chars: &[char], from: usize) -> usize {
    let (mut at, mut depth) = (from, 0);
    while at < chars.len() {
        if chars[at..].starts_with(&['/', '*']) {
            (depth, at) = (depth + 1, at + 2);
        } else if chars[at..].starts_with(&['*', '/']) {
            (depth, at) = (depth - 1, at + 2);
            if depth == 0 {
                return at;
            }
        } else {
            at += 1;
        }
    }
    chars.len()
}

/// The place behind the string or character that starts here, if one does.
fn end_of_string(chars: &[char], at: usize, starts_word: bool) -> Option<usize> {
    if chars[at] == '\'' {
        // A lifetime has no quote behind its first letter.
        let escaped = chars.get(at + 1) == Some(&'\\');
        let is_character = escaped || chars.get(at + 2) == Some(&'\'');
        return is_character.then(|| quoted(chars, at, '\''));
    }
    if chars[at] == '"' {
        return Some(quoted(chars, at, '"'));
    }
    if !starts_word {
        return None;
    }
    let raw = match &chars[at..] {
        ['r', '"' | '#', ..] => at + 1,
        ['b', 'r', '"' | '#', ..] => at + 2,
        _ => return None,
    };
    let hashes = chars[raw..].iter().take_while(|c| **c == '#').count();
    if chars.get(raw + hashes) != Some(&'"') {
        return None;
    }
    let mut end = vec!['"'];
    end.resize(hashes + 1, '#');
    Some(find(chars, &end, raw + hashes + 1).map_or(chars.len(), |close| close + end.len()))
}

fn quoted(chars: &[char], from: usize, quote: char) -> usize {
    let mut at = from + 1;
    while at < chars.len() {
        match chars[at] {
            '\\' => at += 2,
            c if c == quote => return at + 1,
            _ => at += 1,
        }
    }
    chars.len()
}

#[test]
fn comments_strings_and_tests_are_no_code() {
    let text = "//! crate::a\nfn f<'a>() { /* x /* y */ */ g(\"crate::b\", r#\"\"c\"#, '\"', '\\'') }\n\
                #[cfg(test)]\nmod tests {\n    fn t() { }\n}\n#[cfg(test)]\nmod more;\n";
    let source = Source::new("crates/x/src/lib.rs".to_owned(), text.to_owned());
    let words: Vec<String> = source.tokens().into_iter().map(|token| token.text).collect();
    let expected = "fn f < ' a > ( ) { g ( , , , ) }";
    assert_eq!(words.join(" "), expected);
    assert_eq!((source.lines(), &source.test_modules[..]), (2, &["more".to_owned()][..]));
    assert!(source.with_strings.contains("crate::b") && !source.with_strings.contains("crate::a"));
}
