//! What a page is shown on.

// What a page is shown on.

/// A screen, or paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Screen {
    /// Width, CSS pixels.
    pub width: u32,
    /// Height, CSS pixels.
    pub height: u32,
    /// A telephone: touch, and a page as wide as the screen.
    pub is_phone: bool,
    /// The reader prefers dark colours.
    pub is_dark: bool,
    /// Scripts run.
    pub has_script: bool,
    /// Laid out by its print rules, as on paper.
    pub is_paper: bool,
}

impl Screen {
    /// A desk's.
    pub const DESK: Self =
        Self { width: 1400, height: 1000, is_phone: false, is_dark: false, has_script: true, is_paper: false };
    /// A telephone's.
    pub const PHONE: Self =
        Self { width: 390, height: 844, is_phone: true, is_dark: false, has_script: true, is_paper: false };
    /// A sheet of A4 within margins of 11 mm, at 96 pixels an inch.
    pub const SHEET: Self = Self { width: 710, height: 1039, is_paper: true, ..Self::DESK };

    /// The same, `width` CSS pixels wide.
    #[must_use]
    pub const fn wide(self, width: u32) -> Self {
        Self { width, ..self }
    }

    /// The same in dark colours.
    #[must_use]
    pub const fn dark(self) -> Self {
        Self { is_dark: true, ..self }
    }

    /// The same without scripts.
    #[must_use]
    pub const fn without_script(self) -> Self {
        Self { has_script: false, ..self }
    }
}
