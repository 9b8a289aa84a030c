//! Fields of a record of an EV5 file.

/// Fields of one record, counted from 1 as in the guide; blanks and missing fields are `None`.
pub struct Fields<'a>(Vec<&'a str>);

impl<'a> Fields<'a> {
    /// The fields of a line, split at `|`.
    pub fn split(line: &'a str) -> Self {
        Self(line.split('|').collect())
    }

    /// Field `position`, from 1, if it holds something.
    pub fn text(&self, position: usize) -> Option<&'a str> {
        self.0.get(position.checked_sub(1)?).map(|f| f.trim()).filter(|f| !f.is_empty())
    }

    /// The same as owned words.
    pub fn words(&self, position: usize) -> Option<String> {
        self.text(position).map(str::to_owned)
    }

    /// A finite number.
    pub fn number(&self, position: usize) -> Option<f64> {
        self.text(position)?.parse().ok().filter(|x: &f64| x.is_finite())
    }

    /// A length, mass or speed: zero means not recorded.
    pub fn positive(&self, position: usize) -> Option<f64> {
        self.number(position).filter(|x| *x > 0.0)
    }

    /// A whole number.
    pub fn integer(&self, position: usize) -> Option<i64> {
        self.text(position)?.parse().ok()
    }
}
