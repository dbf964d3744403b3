//! Imports between the modules of a crate, read from their text, and circles of them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A module, as its path from the root of the crate.
type Name = Vec<String>;

/// The path of an import, and the name that it gives the item.
type Import = (Vec<String>, String);

/// The modules of a crate with their texts, and their imports.
pub struct Crate(BTreeMap<Name, String>, BTreeMap<Name, Vec<Import>>);

impl Crate {
    pub fn read(source: &Path, files: &[PathBuf]) -> Self {
        let modules = files.iter().map(|path| {
            let relative = path.strip_prefix(source).unwrap().with_extension("");
            let mut name: Name =
                relative.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
            let last = name.last().map(String::as_str);
            if last == Some("mod") || (name.len() == 1 && matches!(last, Some("lib" | "main"))) {
                name.pop();
            }
            (name, code(&fs::read_to_string(path).unwrap()))
        });
        Self::of(modules.collect())
    }

    fn of(modules: BTreeMap<Name, String>) -> Self {
        let imports = modules.iter();
        let imports = imports.map(|(name, text)| (name.clone(), paths(text, &["use"])));
        let imports = imports.collect();
        Self(modules, imports)
    }

    /// Returns the module that defines the item of a path, as seen from another module.
    fn resolve(&self, from: &Name, path: &[String], depth: usize) -> Option<Name> {
        let mut at = from.clone();
        let mut rest = path;
        while let Some((first, more)) = rest.split_first() {
            match first.as_str() {
                "crate" => at.clear(),
                "super" => {
                    at.pop()?;
                }
                "self" => {}
                name => {
                    at.push(name.to_owned());
                    if !self.0.contains_key(&at) {
                        at.pop();
                        break;
                    }
                }
            }
            rest = more;
        }
        let Some(item) = rest.first().filter(|_| depth < 8) else {
            return Some(at);
        };
        for (path, name) in &self.1[&at] {
            let child = path.first().filter(|first| {
                let mut child = at.clone();
                child.push((*first).clone());
                self.0.contains_key(&child) || *first == "self"
            });
            if child.is_none() || path.len() < 2 {
                continue;
            }
            let target = self.resolve(&at, path, depth + 1);
            let through_glob =
                name == "*" && target.as_ref().is_some_and(|target| defines(&self.0[target], item));
            if name == item || through_glob {
                return target;
            }
        }
        Some(at)
    }

    /// Returns pairs of modules, of which the first uses an item of the second.
    fn edges(&self) -> BTreeSet<(Name, Name)> {
        let mut edges = BTreeSet::new();
        for (from, text) in &self.0 {
            for (path, _) in paths(text, &["crate", "super"]) {
                if let Some(to) = self.resolve(from, &path, 0) {
                    edges.insert((from.clone(), to));
                }
            }
        }
        edges
    }

    /// Returns the modules that use an item that their parent defines: a circle, because a parent
    /// uses the modules inside it. Tests may.
    pub fn upwards(&self) -> Vec<String> {
        let is_test = |name: &Name| name.iter().any(|part| part == "tests" || part == "testing");
        let edges = self.edges().into_iter();
        let upwards = edges.filter(|(from, to)| {
            !to.is_empty() && from.len() > to.len() && from.starts_with(to) && !is_test(from)
        });
        upwards.map(|(from, to)| format!("{} uses {}", from.join("::"), to.join("::"))).collect()
    }

    /// Returns the types with inherent methods in more than two files, with the number of files.
    pub fn spread(&self) -> Vec<String> {
        let mut files: BTreeMap<(&str, &str), BTreeSet<&Name>> = BTreeMap::new();
        for (name, text) in &self.0 {
            for line in text.lines().filter(|line| line.starts_with("impl")) {
                let line = line.strip_prefix("impl").unwrap_or_default();
                // Generic parameters come before the name of the type.
                let rest = match line.strip_prefix('<') {
                    Some(generic) => generic.split_once("> ").map_or("", |(_, rest)| rest),
                    None => line.trim_start(),
                };
                let ends = |c: char| !c.is_alphanumeric() && c != '_';
                let of = rest.split(ends).next().unwrap_or_default();
                if !of.is_empty() && !line.contains(" for ") {
                    let folder = name.first().map_or("", String::as_str);
                    files.entry((folder, of)).or_default().insert(name);
                }
            }
        }
        let wide = files.into_iter().filter(|(_, files)| files.len() > 2);
        wide.map(|((folder, of), files)| format!("{folder}: {of} in {} files", files.len()))
            .collect()
    }

    /// Returns the circles among sibling modules, each with its uses.
    pub fn circles(&self) -> Vec<String> {
        let mut graphs: BTreeMap<Name, BTreeMap<String, BTreeMap<String, String>>> =
            BTreeMap::new();
        for (from, to) in self.edges() {
            let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
            // A parent uses the modules inside it; `upwards` finds uses in the other direction.
            if common == from.len() || common == to.len() {
                continue;
            }
            let graph = graphs.entry(from[..common].to_vec()).or_default();
            let uses = format!("{} uses {}", from.join("::"), to.join("::"));
            let edges = graph.entry(from[common].clone()).or_default();
            edges.entry(to[common].clone()).or_insert(uses);
        }
        graphs.values().flat_map(circles_of).collect()
    }
}

/// Returns a shortest circle through each module that is in one, each circle once.
fn circles_of(graph: &BTreeMap<String, BTreeMap<String, String>>) -> Vec<String> {
    let mut found = vec![];
    let mut seen = BTreeSet::new();
    for start in graph.keys() {
        // The shortest way back, by breadth-first search.
        let mut ways = vec![vec![start]];
        let mut reached = BTreeSet::new();
        let mut k = 0;
        while k < ways.len() {
            let way = ways[k].clone();
            k += 1;
            for next in graph.get(way[way.len() - 1]).into_iter().flat_map(BTreeMap::keys) {
                if next == start {
                    let members: BTreeSet<_> = way.iter().copied().collect();
                    if seen.insert(members) {
                        let ends = way.iter().skip(1).copied().chain([start]);
                        let uses: Vec<_> = way
                            .iter()
                            .copied()
                            .zip(ends)
                            .map(|(a, b)| graph[a][b].as_str())
                            .collect();
                        found.push(uses.join("; "));
                    }
                    ways.clear();
                    break;
                }
                if reached.insert(next) {
                    let mut longer = way.clone();
                    longer.push(next);
                    ways.push(longer);
                }
            }
        }
    }
    found
}

/// Returns the text without comments, strings, and the tests at its end.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

fn defines(text: &str, item: &str) -> bool {
    let kinds = ["fn", "struct", "enum", "trait", "type", "const", "static"];
    kinds.iter().any(|kind| {
        let named = format!("{kind} {item}");
        text.match_indices(&named).any(|(at, _)| {
            !text[at + named.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_')
        })
    })
}

/// Returns every path that begins with one of these words (or follows it, if it is `use`), with the
/// name that it imports.
fn paths(text: &str, words: &[&str]) -> Vec<(Vec<String>, String)> {
    let mut tokens: Vec<String> = vec![];
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        if c.is_alphanumeric() || c == '_' {
            let mut word = c.to_string();
            while let Some(c) = characters.next_if(|c| c.is_alphanumeric() || *c == '_') {
                word.push(c);
            }
            tokens.push(word);
        } else if c == ':' && characters.next_if_eq(&':').is_some() {
            tokens.push("::".into());
        } else if !c.is_whitespace() {
            tokens.push(c.to_string());
        }
    }
    let mut found = vec![];
    for (k, token) in tokens.iter().enumerate() {
        if !words.contains(&token.as_str()) {
            continue;
        }
        let follows = k > 0 && tokens[k - 1] == "::";
        if token == "use" {
            tree(&tokens, k + 1, &mut vec![], &mut found);
        } else if !follows && tokens.get(k + 1).is_some_and(|next| next == "::") {
            tree(&tokens, k, &mut vec![], &mut found);
        }
    }
    found
}

/// Reads a path that may branch in braces. Returns its end.
fn tree(
    tokens: &[String],
    mut k: usize,
    before: &mut Vec<String>,
    found: &mut Vec<(Vec<String>, String)>,
) -> usize {
    let length = before.len();
    loop {
        match tokens.get(k).map(String::as_str) {
            Some("{") => {
                k += 1;
                while tokens.get(k).is_some_and(|token| token != "}") {
                    k = tree(tokens, k, before, found);
                    if tokens.get(k).is_some_and(|token| token == ",") {
                        k += 1;
                    }
                }
                k += 1;
                break;
            }
            Some(word)
                if word == "*" || word.starts_with(|c: char| c.is_alphabetic() || c == '_') =>
            {
                before.push(word.to_owned());
                k += 1;
                if tokens.get(k).is_some_and(|token| token == "::")
                    && tokens.get(k + 1).is_some_and(|token| token != "<")
                {
                    k += 1;
                    continue;
                }
                let mut name = word.to_owned();
                if tokens.get(k).is_some_and(|token| token == "as") {
                    name.clone_from(&tokens[k + 1]);
                    k += 2;
                }
                found.push((before.clone(), name));
                break;
            }
            _ => {
                k += 1;
                break;
            }
        }
    }
    before.truncate(length);
    k
}

#[test]
fn circles_are_found() {
    let module = |name: &str, text: &str| {
        let name: Name =
            name.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect();
        (name, code(text))
    };
    let of = |modules: &[(&str, &str)]| {
        Crate::of(modules.iter().map(|(name, text)| module(name, text)).collect()).circles()
    };
    let root = ("", "mod a; mod b; mod c; pub use b::{Far, Near as Close};");
    assert!(of(&[root, ("a", "use crate::{b::Near, c};"), ("b", ""), ("c", "")]).is_empty());
    let three = of(&[
        root,
        ("a", "use crate::Close;"),
        ("b", "fn f() { crate::c::g(); }"),
        ("c", "use super::a::{self, x};"),
    ]);
    assert_eq!(three, ["a uses b; b uses c; c uses a"]);
    let inside = of(&[
        ("", ""),
        ("a", "mod b; mod c;"),
        ("a::b", "use super::c::x;"),
        ("a::c", "use super::b;"),
    ]);
    assert_eq!(inside, ["a::b uses a::c; a::c uses a::b"]);
    assert!(
        of(&[
            root,
            ("a", "// use crate::b;"),
            ("b", "use crate::a::y;\n#[cfg(test)]\nmod tests { use crate::b; }")
        ])
        .is_empty()
    );
}
