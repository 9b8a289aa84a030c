//! The lines on which the samples of a text file stand.

/// Line numbers of rows, as runs of rows on consecutive lines: a few bytes for a table without comments, however long.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LineNumbers {
    /// First row of a run, and its line.
    runs: Vec<(usize, usize)>,
    rows: usize,
}

impl LineNumbers {
    /// Adds a row.
    #[inline]
    pub fn push(&mut self, line: usize) {
        let follows = self.runs.last().is_some_and(|(row, first)| first + (self.rows - row) == line);
        if !follows {
            self.runs.push((self.rows, line));
        }
        self.rows += 1;
    }

    /// Adds the rows of a part whose lines are counted from `line`.
    pub fn append(&mut self, part: &Self, line: usize) {
        for (k, (row, first)) in part.runs.iter().enumerate() {
            let end = part.runs.get(k + 1).map_or(part.rows, |next| next.0);
            self.push(line + first);
            self.rows += end - row - 1;
        }
    }

    /// Number of rows.
    #[expect(clippy::len_without_is_empty, reason = "nobody asks")]
    pub fn len(&self) -> usize {
        self.rows
    }

    /// The line of a row; 0 past the end.
    pub fn of_row(&self, row: usize) -> usize {
        let run = self.runs.partition_point(|(first, _)| *first <= row);
        self.runs.get(run.wrapping_sub(1)).filter(|_| row < self.rows).map_or(0, |(first, line)| line + (row - first))
    }
}
