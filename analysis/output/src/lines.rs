//! Lines that fit a terminal.

/// Least columns into which the continuation of a line is set.
const LEAST: usize = 20;

/// A text whose lines are at most `width` characters long where their words allow it. What goes on stands under the last column
/// that begins in the left half, else two columns further in than its line. Lines with colours stay as they are.
///
/// ```
/// let text = toolroom_output::fitted("note     the constant is off by more than was thought of", 40);
/// assert_eq!(text, "note     the constant is off by more\n         than was thought of");
/// ```
pub fn fitted(text: &str, width: usize) -> String {
    let mut out = String::with_capacity(text.len());
    for (number, line) in text.split('\n').enumerate() {
        if number > 0 {
            out.push('\n');
        }
        if line.chars().count() <= width || width < 2 * LEAST || line.contains('\u{1b}') {
            out.push_str(line);
        } else {
            wrap(line, width, &mut out);
        }
    }
    out
}

fn wrap(line: &str, width: usize, text: &mut String) {
    let hang = hanging(line, width);
    let mut column = 0;
    // Gaps within a line stand for columns: they are kept.
    let mut gap = 0;
    for piece in line.split(' ') {
        if piece.is_empty() {
            gap += 1;
            continue;
        }
        let length = piece.chars().count();
        if column > 0 && column + gap + length > width {
            text.push('\n');
            text.extend(std::iter::repeat_n(' ', hang));
            column = hang;
        } else {
            text.extend(std::iter::repeat_n(' ', gap));
            column += gap;
        }
        text.push_str(piece);
        column += length;
        gap = 1;
    }
}

/// Where the continuation of a line begins.
fn hanging(line: &str, width: usize) -> usize {
    let indent = line.chars().take_while(|c| *c == ' ').count();
    let (mut place, mut blanks) = (indent + 2, 0);
    for (column, c) in line.chars().enumerate().skip(indent).take_while(|(column, _)| *column <= width / 2) {
        if c == ' ' {
            blanks += 1;
        } else {
            if blanks > 1 {
                place = column;
            }
            blanks = 0;
        }
    }
    place.min(width.saturating_sub(LEAST))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stay_whole_and_nothing_is_lost() {
        let text = "  sound    a line of many words that goes on and on, and a-word-that-is-longer-than-any-line-could-ever-be-here end\n\nshort";
        let wrapped = fitted(text, 44);
        let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(words(text), words(&wrapped));
        for line in wrapped.lines() {
            assert!(line.chars().count() <= 44 || line.split_whitespace().count() == 1, "{line}");
        }
        assert!(wrapped.lines().nth(1).is_some_and(|line| line.starts_with("           ")), "{wrapped}");
        assert!(wrapped.ends_with("\n\nshort"));
    }

    #[test]
    fn what_fits_and_what_has_colours_stays() {
        let coloured = format!("\u{1b}[32m{}\u{1b}[0m", "a ".repeat(60));
        assert_eq!(fitted(&coloured, 50), coloured);
        assert_eq!(fitted("a  b", 80), "a  b");
        let narrow = "a ".repeat(60);
        assert_eq!(fitted(&narrow, 10), narrow, "no terminal is that narrow");
    }
}
