//! Where in a JSON text the value at a path stands, so that a range error can point at it.
//!
//! A parser throws positions away; this walks the text once more along one path. It never fails on broken text, it only
//! finds nothing. Nesting costs no stack: skipped values are matched by counting brackets.

/// Byte offsets of a value and of the key before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Found {
    /// Of the key's opening quote; the value itself where there is no key.
    pub key: usize,
    /// Of the value's first byte.
    pub value: usize,
}

/// Finds the value at `path` in `text`; `None` if the text has no such value or breaks off before it.
pub(super) fn find(text: &str, path: &[String]) -> Option<Found> {
    let mut cursor = Cursor { bytes: text.as_bytes(), at: 0 };
    cursor.skip_space();
    let mut found = Found { key: cursor.at, value: cursor.at };
    for key in path {
        found = cursor.enter_key(text, key)?;
    }
    Some(found)
}

/// Line and column (characters, both from 1) of a byte offset.
pub(super) fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..character_start(text, offset)];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

/// Byte offset of a line and column (bytes, both from 1), as `serde_json` counts them.
pub(super) fn offset(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    character_start(text, start + column.saturating_sub(1))
}

/// The largest offset not above `offset` at which a character of `text` begins or the text ends.
fn character_start(text: &str, offset: usize) -> usize {
    (0..=offset.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0)
}

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Cursor<'_> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn skip_space(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    fn expect(&mut self, byte: u8) -> Option<()> {
        self.skip_space();
        (self.peek()? == byte).then(|| self.at += 1)
    }

    /// From an object's opening brace to the value of `wanted`.
    fn enter_key(&mut self, text: &str, wanted: &str) -> Option<Found> {
        self.expect(b'{')?;
        loop {
            self.skip_space();
            let key = self.at;
            self.skip_string()?;
            let name: String = serde_json::from_str(&text[key..self.at]).ok()?;
            self.expect(b':')?;
            self.skip_space();
            if name == wanted {
                return Some(Found { key, value: self.at });
            }
            self.skip_value()?;
            self.expect(b',')?;
        }
    }

    /// Past a string that begins here.
    fn skip_string(&mut self) -> Option<()> {
        self.expect(b'"')?;
        loop {
            match self.peek()? {
                b'"' => {
                    self.at += 1;
                    return Some(());
                }
                b'\\' => self.at += 2,
                _ => self.at += 1,
            }
        }
    }

    /// Past the value that begins here, whatever it is.
    fn skip_value(&mut self) -> Option<()> {
        let mut depth = 0_usize;
        loop {
            self.skip_space();
            match self.peek()? {
                b'"' => self.skip_string()?,
                b'{' | b'[' => {
                    depth += 1;
                    self.at += 1;
                }
                b'}' | b']' => {
                    depth = depth.checked_sub(1)?;
                    self.at += 1;
                }
                b',' | b':' => self.at += 1,
                _ => {
                    while !matches!(
                        self.peek(),
                        None | Some(b',' | b':' | b'{' | b'}' | b'[' | b']' | b'"' | b' ' | b'\t' | b'\n' | b'\r')
                    ) {
                        self.at += 1;
                    }
                }
            }
            if depth == 0 {
                return Some(());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn path(keys: &[&str]) -> Vec<String> {
        keys.iter().map(|key| key.to_string()).collect()
    }

    #[test]
    fn a_nested_value_is_found_behind_siblings_of_every_kind() {
        let text = r#"{"a": [1, {"x": "}"}], "b\"": "\\", "c": {"e": [true], "d": -3.5e1}}"#;
        let found = find(text, &path(&["c", "d"])).unwrap();
        assert!(text[found.value..].starts_with("-3.5e1"));
        let found = find(text, &path(&["b\""])).unwrap();
        assert!(text[found.key..].starts_with(r#""b\"""#) && text[found.value..].starts_with(r#""\\""#));
    }

    #[test]
    fn what_is_not_there_is_not_found() {
        assert_eq!(find(r#"{"a": 1}"#, &path(&["b"])), None);
        assert_eq!(find(r#"{"a": "#, &path(&["a", "b"])), None);
        assert_eq!(find("[1]", &path(&["a"])), None);
    }

    #[test]
    fn lines_and_columns_count_characters_from_one() {
        let text = "{\n  \"é\": 1}";
        let value = text.find('1').unwrap();
        assert_eq!(line_column(text, value), (2, 8));
        assert_eq!(line_column(text, 0), (1, 1));
        assert_eq!(offset(text, 2, 3), 4);
    }

    proptest! {
        #[test]
        fn prop_arbitrary_text_never_panics(
            text in ".{0,200}", keys in prop::collection::vec("[a-c\"]{0,2}", 0..4), at in 0_usize..300
        ) {
            let _ = find(&text, &keys);
            let _ = line_column(&text, at.min(text.len()));
            let _ = offset(&text, at, at);
        }
    }
}
