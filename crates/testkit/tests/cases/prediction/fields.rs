//! Fields of an input that remember whether they were read: one that nobody knows is not ignored.

use std::cell::RefCell;
use std::collections::BTreeSet;

use serde_json::{Map, Value};

/// An object of a case file.
pub struct Fields<'a> {
    fields: &'a Map<String, Value>,
    path: String,
    read: RefCell<BTreeSet<String>>,
}

impl<'a> Fields<'a> {
    pub fn of(value: &'a Value, path: &str) -> Result<Self, String> {
        let fields = value.as_object().ok_or_else(|| format!("{path} is no object"))?;
        Ok(Self { fields, path: path.to_owned(), read: RefCell::default() })
    }

    /// A field, if it is there and not null.
    pub fn get(&self, name: &str) -> Option<&'a Value> {
        self.read.borrow_mut().insert(name.to_owned());
        self.fields.get(name).filter(|value| !value.is_null())
    }

    fn wanted<T>(&self, name: &str, as_type: impl Fn(&'a Value) -> Option<T>) -> Result<T, String> {
        self.get(name).and_then(as_type).ok_or_else(|| format!("{}.{name} is missing or of another type", self.path))
    }

    pub fn number(&self, name: &str) -> Result<f64, String> {
        self.wanted(name, Value::as_f64)
    }

    pub fn text(&self, name: &str) -> Result<&'a str, String> {
        self.wanted(name, Value::as_str)
    }

    pub fn list(&self, name: &str) -> Result<&'a [Value], String> {
        self.wanted(name, |value| value.as_array().map(Vec::as_slice))
    }

    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, String> {
        self.wanted(name, |value| value.as_array()?.iter().map(Value::as_f64).collect())
    }

    pub fn object(&self, name: &str) -> Result<Fields<'a>, String> {
        Fields::of(self.wanted(name, Some)?, &format!("{}.{name}", self.path))
    }

    /// The objects of a list.
    pub fn objects(&self, name: &str) -> Result<Vec<Fields<'a>>, String> {
        let of = |(i, value)| Fields::of(value, &format!("{}.{name}[{i}]", self.path));
        self.list(name)?.iter().enumerate().map(of).collect()
    }

    /// Names of its fields.
    pub fn names(&self) -> impl Iterator<Item = &'a str> {
        self.fields.keys().map(String::as_str)
    }

    /// A number, or what holds without it.
    pub fn number_or(&self, name: &str, default: f64) -> Result<f64, String> {
        if self.get(name).is_some() { self.number(name) } else { Ok(default) }
    }

    /// Refuses fields that were not asked for.
    pub fn all_read(&self) -> Result<(), String> {
        let read = self.read.borrow();
        match self.fields.keys().find(|name| !read.contains(*name)) {
            Some(name) => Err(format!("the input {}.{name} is not known", self.path)),
            None => Ok(()),
        }
    }
}
