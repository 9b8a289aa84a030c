//! The result of a comparison: reports of runs, files and topics, and their differences.

use serde::Serialize;
use serde_json::Value;

// What a comparison found.

/// One of the two results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The first.
    A,
    /// The second.
    B,
}

/// One step of the way from a record to a value in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// A field of a map.
    Field(String),
    /// An element of a list by its `id` or `name`.
    Element(String),
    /// An element of a list by its index.
    Index(usize),
}

/// One value that differs.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Difference {
    /// Where in the topic, e.g. `[peak_acceleration].value` or `sample 812`; empty: the record as a whole.
    pub place: String,
    /// The same in steps; empty where the place is none inside a record.
    #[serde(skip)]
    pub steps: Vec<Step>,
    /// Whether it is the length of the list there.
    #[serde(skip)]
    pub is_length: bool,
    /// The first side's value; left out where it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub a: Option<Value>,
    /// The second side's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub b: Option<Value>,
    /// `|a - b|`, for numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub abs: Option<f64>,
    /// `|a - b|` over the scale of the comparison, for numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rel: Option<f64>,
    /// Index of the sample, in waveforms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample: Option<u64>,
    /// Its time in `a`, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
    /// The side that determines the parameter, where the other leaves it open: a difference whatever the values.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub determined: Option<Side>,
}

/// Why values are not compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// They belong to a parameter that both sides leave open.
    OpenParameter,
    /// They follow from such a parameter, which has another value.
    FollowsOpenParameter,
    /// How a solver came to its result.
    SolverSteps,
    /// What the file was called that a record came in.
    SourceName,
    /// Which program from elsewhere stood for a stage: a cause, where two runs are compared.
    ProgramName,
    /// Samples on grids that differ.
    OtherGrid,
    /// A rule of the user says so.
    Ignored,
}

/// Values that are not compared for one reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct NotCompared {
    /// How many.
    pub count: u64,
    /// Why.
    pub reason: Reason,
}

/// Adds to the count of a reason; the list stays in the order of reasons.
fn add(list: &mut Vec<NotCompared>, more: NotCompared) {
    match list.binary_search_by_key(&more.reason, |known| known.reason) {
        Ok(k) => list[k].count += more.count,
        Err(_) if more.count == 0 => {}
        Err(k) => list.insert(k, more),
    }
}

/// One topic of two artifacts, or a whole JSON file.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TopicReport {
    /// The topic.
    pub topic: String,
    /// Whether all values are the same within tolerance.
    pub same: bool,
    /// Values compared: numbers, texts, samples.
    pub values: u64,
    /// How many of them differ by more than the tolerance.
    pub different: u64,
    /// Largest `|a - b|` of a waveform's samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_abs: Option<f64>,
    /// Largest relative difference of all numbers, tolerated ones included; zero for those within the absolute part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_rel: Option<f64>,
    /// Every differing value of a record; of a waveform the first differing sample and the worst.
    pub differences: Vec<Difference>,
    /// What differs and is no result: told for information.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub aside: Vec<Difference>,
    /// Values that are not compared, by reason.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_compared: Vec<NotCompared>,
}

impl TopicReport {
    pub(crate) fn new(topic: &str) -> Self {
        Self { topic: topic.to_owned(), same: true, ..Self::default() }
    }

    pub(crate) fn differs(&mut self, difference: Difference) {
        self.same = false;
        self.different += 1;
        self.differences.push(difference);
    }

    /// Counts values that are not compared.
    pub(crate) fn leaves_out(&mut self, reason: Reason, count: u64) {
        add(&mut self.not_compared, NotCompared { count, reason });
    }

    /// Whether anything of it is compared.
    pub(crate) fn is_compared(&self) -> bool {
        self.values > 0 || !self.same || self.not_compared.is_empty()
    }

    /// Takes part in the largest relative difference.
    pub(crate) fn saw_rel(&mut self, rel: Option<f64>) {
        self.max_rel = self.max_rel.into_iter().chain(rel).reduce(f64::max);
    }

    /// A topic that only one side has.
    pub(crate) fn only_in(topic: &str, side: Side, what: &str) -> Self {
        let mut report = Self::new(topic);
        let what = Some(Value::from(what));
        report.differs(match side {
            Side::A => Difference { a: what, ..Difference::default() },
            Side::B => Difference { b: what, ..Difference::default() },
        });
        report
    }
}

/// One file of each side.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FileReport {
    /// Name of the file in its run folder.
    pub name: String,
    /// Whether nothing differs that counts.
    pub same: bool,
    /// The side that has the file, where the other has not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub only_in: Option<Side>,
    /// Content digests of artifacts, first and second side.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digests: Option<[String; 2]>,
    /// The topics compared, by name; with equal digests none need be.
    pub topics: Vec<TopicReport>,
    /// Stage version, configuration and inputs that differ.
    pub provenance: Vec<Difference>,
}

impl FileReport {
    /// A file that only one side has.
    pub fn missing(name: &str, only_in: Side) -> Self {
        Self { name: name.to_owned(), only_in: Some(only_in), ..Self::default() }
    }

    /// A JSON file that both sides have.
    pub fn json(name: &str, topic: TopicReport) -> Self {
        Self { name: name.to_owned(), same: topic.same, topics: vec![topic], ..Self::default() }
    }
}

/// The whole comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// What the first side is called.
    pub a: String,
    /// What the second side is called.
    pub b: String,
    /// Whether nothing differs that counts.
    pub same: bool,
    /// Whether provenance counts.
    pub provenance_counts: bool,
    /// The files, by name.
    pub files: Vec<FileReport>,
}

impl Comparison {
    /// Puts the files' reports together.
    pub fn new(a: String, b: String, provenance_counts: bool, files: Vec<FileReport>) -> Self {
        Self { a, b, same: files.iter().all(|file| file.same), provenance_counts, files }
    }

    /// Values of all files that are not compared, by reason.
    pub fn not_compared(&self) -> Vec<NotCompared> {
        let mut list = Vec::new();
        let topics = self.files.iter().flat_map(|file| &file.topics);
        topics.flat_map(|topic| &topic.not_compared).for_each(|more| add(&mut list, *more));
        list
    }
}
