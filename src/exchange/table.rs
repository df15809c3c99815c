//! Columns of numbers as CSV text: one header line, one line a row, units in the column names.
//!
//! Numbers are written as the shortest decimals that read back as the same `f64`.

use std::fmt::Write as _;
use std::path::Path;

use super::output::{UnknownFormat, WriteError, ending, write_whole};

/// Refuses a file name that does not end in `.csv`.
///
/// # Errors
/// [`UnknownFormat`] with the name.
pub fn check_table_name(file: &Path) -> Result<(), UnknownFormat> {
    if ending(file) == "csv" { Ok(()) } else { Err(UnknownFormat { file: file.to_owned(), allowed: &[".csv"] }) }
}

/// Writes named columns of equal length; rows beyond the shortest are left out.
///
/// # Errors
/// [`WriteError`]; a file that was there before is unchanged then.
pub fn write_table(columns: &[(&str, Vec<f64>)], file: &Path) -> Result<(), WriteError> {
    write_whole(file, table_csv(columns).as_bytes())
}

fn table_csv(columns: &[(&str, Vec<f64>)]) -> String {
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    let rows = columns.iter().map(|(_, values)| values.len()).min().unwrap_or(0);
    let mut text = names.join(",");
    text.push('\n');
    for row in 0..rows {
        for (k, (_, values)) in columns.iter().enumerate() {
            let comma = if k == 0 { "" } else { "," };
            write!(text, "{comma}{:?}", values[row]).expect("writing to a string cannot fail");
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_as_they_were() {
        let text = table_csv(&[("t_myr", vec![0.0, 0.1 + 0.2]), ("period_h", vec![6.0, 1e-300])]);
        assert_eq!(text, "t_myr,period_h\n0.0,6.0\n0.30000000000000004,1e-300\n");
        assert_eq!(text.lines().nth(2).unwrap().split(',').next().unwrap().parse::<f64>().unwrap(), 0.1 + 0.2);
    }

    #[test]
    fn other_endings_are_refused() {
        assert!(check_table_name(Path::new("a/B.CSV")).is_ok());
        let refused = check_table_name(Path::new("curve.txt")).unwrap_err();
        assert_eq!(refused.to_string(), "curve.txt: the name must end in one of .csv");
    }
}
