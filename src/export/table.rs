//! A table as named columns, and how it reads as CSV.

use std::fmt::Write as _;

/// A table of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Its name.
    pub name: &'static str,
    /// Names with units, and values; all of one length.
    pub columns: Vec<(&'static str, Column)>,
}

/// One column.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    /// Numbers; NaN where there is none.
    Number(Vec<f64>),
    /// Whole numbers; -1 where there is none.
    Whole(Vec<i64>),
    /// Words.
    Text(Vec<String>),
}

impl Table {
    /// Rows of the table.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, column)| column.len())
    }

    /// Header and rows; numbers are the shortest decimals that read back as the same, a number that is not there is
    /// empty.
    pub fn csv(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|(name, _)| *name).collect();
        let mut text = names.join(",") + "\n";
        for row in 0..self.rows() {
            for (k, (_, column)) in self.columns.iter().enumerate() {
                text.push_str(if k == 0 { "" } else { "," });
                column.field(row, &mut text);
            }
            text.push('\n');
        }
        text
    }
}

impl Column {
    /// A column of numbers.
    pub fn number(values: impl IntoIterator<Item = f64>) -> Self {
        Self::Number(values.into_iter().collect())
    }

    /// A column of whole numbers.
    pub fn whole<T: Into<i64>>(values: impl IntoIterator<Item = T>) -> Self {
        Self::Whole(values.into_iter().map(Into::into).collect())
    }

    /// A column of numbers of which some are not there.
    pub fn optional(values: impl IntoIterator<Item = Option<f64>>) -> Self {
        Self::Number(values.into_iter().map(|v| v.unwrap_or(f64::NAN)).collect())
    }

    /// A column of whole numbers of which some are not there.
    pub fn optional_whole(values: impl IntoIterator<Item = Option<u32>>) -> Self {
        Self::Whole(values.into_iter().map(|v| v.map_or(-1, i64::from)).collect())
    }

    /// A column of words.
    pub fn text<T: AsRef<str>>(values: impl IntoIterator<Item = T>) -> Self {
        Self::Text(values.into_iter().map(|v| v.as_ref().to_owned()).collect())
    }

    fn len(&self) -> usize {
        match self {
            Self::Number(values) => values.len(),
            Self::Whole(values) => values.len(),
            Self::Text(values) => values.len(),
        }
    }

    fn field(&self, row: usize, text: &mut String) {
        match self {
            Self::Number(values) if values[row].is_nan() => {}
            Self::Number(values) => write!(text, "{:?}", values[row]).expect("writing to a string cannot fail"),
            Self::Whole(values) => write!(text, "{}", values[row]).expect("writing to a string cannot fail"),
            Self::Text(values) if values[row].contains([',', '"', '\n', '\r']) => {
                text.push('"');
                text.push_str(&values[row].replace('"', "\"\""));
                text.push('"');
            }
            Self::Text(values) => text.push_str(&values[row]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_read_back_and_what_is_not_there_is_empty() {
        let table = Table {
            name: "t",
            columns: vec![
                ("x_m", Column::optional([Some(0.1 + 0.2), None])),
                ("n", Column::optional_whole([None, Some(7)])),
                ("why", Column::text(["a, \"b\"", "c"])),
            ],
        };
        assert_eq!(table.csv(), "x_m,n,why\n0.30000000000000004,-1,\"a, \"\"b\"\"\"\n,7,c\n");
    }
}
