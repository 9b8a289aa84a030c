//! Times of the day and of a calendar, as recorders and spreadsheets write them.

/// An instant by the clock of a recorder, in two parts: one number of seconds since 1904 resolves half a microsecond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// Whole seconds since the epoch of the file.
    pub seconds: i64,
    /// What is added to them, s.
    pub fraction_s: f64,
}

impl Instant {
    /// Seconds from `earlier` to this instant.
    pub fn since(self, earlier: Self) -> f64 {
        self.seconds.wrapping_sub(earlier.seconds) as f64 + (self.fraction_s - earlier.fraction_s)
    }

    /// The instant `s` seconds later.
    #[must_use]
    pub fn plus(self, s: f64) -> Self {
        Self { fraction_s: self.fraction_s + s, ..self }
    }
}

/// Resolution of stamps, s: the coarsest step, decimal or a power of two, of which all are multiples, down to 0.1 us; 0
/// if they have a finer one. A clock ticks in decimals; stamps that were numbers of seconds since the year 0 are
/// multiples of 2^-17 s.
pub fn resolution_of_stamps(stamps: &[f64]) -> f64 {
    let decimals = (3..=7).map(|digits| 10_f64.powi(-digits));
    let binary = (10..=23).map(|digits| 2_f64.powi(-digits));
    let are_multiples =
        |step: &f64| stamps.iter().all(|t| ((t / step).round() * step - t).abs() <= 1e-12 + 1e-6 * step);
    decimals.chain(binary).filter(are_multiples).fold(0.0, f64::max)
}

/// Dates before this year stand for none: DIAdem writes the year 0 or 1.
const FIRST_YEAR: i64 = 1910;

/// The instant of `2023-05-05T13:40:37.7466657`, with a blank in place of the T, a `Z` or an offset behind it or not;
/// of `5.5.2023 13:40:37` and `5/13/2023 1:40:37 PM` (month first, unless it is above 12); in seconds since the start
/// of the year 1 of the Gregorian calendar. The offset is not looked at: the channels of a file have one. `None`:
/// another text, or a year before 1910.
pub fn instant(text: &str) -> Option<Instant> {
    let (date, time) = text.trim().split_once(['T', ' '])?;
    let mut parts = [0; 3];
    let mut numbers = date.split(['-', '.', '/']).map(|part| part.parse::<i64>().ok());
    for part in &mut parts {
        *part = numbers.next()??;
    }
    let since_2000 = |year: i64| if (0..100).contains(&year) { 2000 + year } else { year };
    let is_year_first = parts[0] > 31;
    let (year, month, day) = match parts {
        [year, month, day] if is_year_first => (year, month, day),
        [month, day, year] if date.contains('/') && month <= 12 => (since_2000(year), month, day),
        [day, month, year] => (since_2000(year), month, day),
    };
    if numbers.next().is_some()
        || !((FIRST_YEAR..10_000).contains(&year) && (1..=12).contains(&month) && (1..=31).contains(&day))
    {
        return None;
    }
    let of_day = time_of_day(time.split(['Z', '+', '-']).next()?)?;
    Some(Instant { seconds: days(year, month, day) * 86_400 + of_day.seconds, ..of_day })
}

/// The instant of `13:40:37.7466657`, `09:54:07,483999`, `09:54:07:483`, `1:40:37.5 PM` or `13:40`, in seconds since
/// the day began; of `40:37.7` since the hour did.
pub fn time_of_day(text: &str) -> Option<Instant> {
    let text = text.trim().to_ascii_uppercase().replace(',', ".");
    let (clock, noon) = match (text.strip_suffix("AM"), text.strip_suffix("PM")) {
        (Some(clock), _) => (clock, Some(0)),
        (_, Some(clock)) => (clock, Some(12)),
        _ => (text.as_str(), None),
    };
    let mut parts: Vec<&str> = clock.trim().split(':').collect();
    // Thousandths behind a colon.
    let fraction = if parts.len() == 4 { parts.pop() } else { None };
    let (whole, of_point) = parts.last()?.split_once('.').map_or((*parts.last()?, None), |(w, f)| (w, Some(f)));
    if parts.len() == 2 && of_point.is_some() {
        parts.insert(0, "0");
    }
    let fraction = of_point.or(fraction).unwrap_or("0");
    if !(2..=3).contains(&parts.len()) || !fraction.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let number = |text: &str| text.parse::<u8>().ok().map(i64::from);
    let hours = number(parts[0])?;
    let hours = noon.map_or(hours, |noon| hours % 12 + noon);
    let seconds = if parts.len() == 3 { number(whole)? } else { 0 };
    let fraction_s = format!("0.{fraction}").parse::<f64>().ok()?;
    Some(Instant { seconds: hours * 3600 + number(parts[1])? * 60 + seconds, fraction_s })
}

/// A time of the day or of a calendar, as a cell of a table has it.
pub fn stamp(text: &str) -> Option<Instant> {
    if !text.contains(':') || !text.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    instant(text).or_else(|| time_of_day(text))
}

/// Times of the day in s that go over midnight go on.
pub fn over_midnight(times: &mut [f64]) {
    let mut days = 0.0;
    for k in 1..times.len() {
        times[k] += days;
        if times[k] < times[k - 1] - 43_200.0 {
            days += 86_400.0;
            times[k] += 86_400.0;
        }
    }
}

/// Days from 0001-01-01 to a date of the Gregorian calendar.
fn days(year: i64, month: i64, day: i64) -> i64 {
    const BEFORE_MONTH: [i64; 12] = [0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334];
    let leap_years = |year: i64| year / 4 - year / 100 + year / 400;
    let is_leap = leap_years(year) > leap_years(year - 1);
    let leap_day = i64::from(is_leap && month > 2);
    (year - 1) * 365 + leap_years(year - 1) + BEFORE_MONTH[month as usize - 1] + leap_day + day - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instants_differ_by_what_lies_between() {
        let between = |a: &str, b: &str| instant(b).unwrap().since(instant(a).unwrap());
        // 2024 has a 29th of February, 2100 has none.
        assert_eq!(between("2024-02-28T12:00:00Z", "2024-03-01T12:00:00Z"), 2.0 * 86_400.0);
        assert_eq!(between("2100-02-28T12:00:00", "2100-03-01T12:00:00"), 86_400.0);
        assert_eq!(between("2023-12-31T23:59:59.75", "2024-01-01 00:00"), 0.25);
        // The fractions are exact to 1e-16.
        assert!((between("2023-05-05T13:40:37.7466657", "2023-05-05T13:40:37.7467907+02:00") - 1.25e-4).abs() < 1e-15);
        for text in ["0000-01-01T00:00:00Z", "1904-01-01T00:00:00", "2023-13-01T00:00:00", "today", "2023-05-05T1:x"] {
            assert_eq!(instant(text), None, "{text}");
        }
        let of_day = |seconds, fraction_s| Some(Instant { seconds, fraction_s });
        assert_eq!(time_of_day("09:54:07,5"), of_day(35_647, 0.5));
        assert_eq!(time_of_day("13:40:37.7466657312496152783"), of_day(49_237, 0.746_665_731_249_615_3));
        assert_eq!(time_of_day("14:22:07:250"), of_day(51_727, 0.25));
        assert_eq!(time_of_day("1:40:37.5 PM"), of_day(49_237, 0.5));
        assert_eq!(time_of_day("40:37.5"), of_day(2437, 0.5));
        assert_eq!(instant("5.5.2023 13:40"), instant("2023-05-05T13:40:00"));
        assert_eq!(instant("5/13/2023 1:40 PM"), instant("2023-05-13 13:40"));
        let mut times = [86_399.5, 0.5, 1.5];
        over_midnight(&mut times);
        assert_eq!(times, [86_399.5, 86_400.5, 86_401.5]);
        for text in ["", "12", "a:b:c", "1:2:3:4:5", "-1:0:0"] {
            assert_eq!(time_of_day(text), None, "{text}");
        }
    }
}
