//! Dates as DIAdem prints them.

use crate::formats::waveform::channel::Instant;

/// Dates before this year stand for none: DIAdem writes the year 0 or 1.
const FIRST_YEAR: i64 = 1910;

/// The instant of `2023-05-05T13:40:37.7466657`, with a blank in place of the T, a `Z` or an offset behind it or not;
/// in seconds since the start of the year 1 of the Gregorian calendar. The offset is not looked at: the channels of a
/// file have one. `None`: another text, or a year before 1910.
pub fn instant(text: &str) -> Option<Instant> {
    let (date, time) = text.trim().split_once(['T', ' '])?;
    let mut date = date.splitn(3, '-').map(|part| part.parse::<i64>().ok());
    let (year, month, day) = (date.next()??, date.next()??, date.next()??);
    if !((FIRST_YEAR..10_000).contains(&year) && (1..=12).contains(&month) && (1..=31).contains(&day)) {
        return None;
    }
    let of_day = time_of_day(time.split(['Z', '+', '-']).next()?)?;
    Some(Instant { seconds: days(year, month, day) * 86_400 + of_day.seconds, ..of_day })
}

/// The instant of `13:40:37.7466657`, `09:54:07,483999` or `13:40`, in seconds since the day began.
pub fn time_of_day(text: &str) -> Option<Instant> {
    let text = text.replace(',', ".");
    let mut parts = text.trim().splitn(3, ':');
    let (hours, minutes) = (parts.next()?.parse::<u8>().ok()?, parts.next()?.parse::<u8>().ok()?);
    let seconds = parts.next().unwrap_or("0");
    let (whole, fraction) = seconds.split_once('.').unwrap_or((seconds, "0"));
    let fraction_s = format!("0.{fraction}").parse::<f64>().ok()?;
    let seconds = i64::from(hours) * 3600 + i64::from(minutes) * 60 + i64::from(whole.parse::<u8>().ok()?);
    Some(Instant { seconds, fraction_s })
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
        for text in ["", "12", "a:b:c", "1:2:3:4", "-1:0:0"] {
            assert_eq!(time_of_day(text), None, "{text}");
        }
    }
}
