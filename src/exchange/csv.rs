//! Aggregates as CSV text: one header line, one line a sphere, SI units in the column names.
//!
//! The columns may stand in any order. Velocities and spins may be left out, each as a whole: they are zero then. Numbers
//! are written as the shortest decimals that read back as the same `f64`.

use pkd::Spheres;
use std::fmt::Write as _;

/// Column names, in the order of [`Spheres::columns`].
pub const COLUMNS: [&str; 11] =
    ["x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s", "mass_kg", "radius_m"];

/// Columns that are there together or not at all, by their place in [`COLUMNS`].
const OPTIONAL: [std::ops::Range<usize>; 2] = [3..6, 6..9];

/// Most spheres in a file, as in a scene.
pub const MAX_SPHERES: usize = 1_000_000;

/// What is wrong with the text of an aggregate; lines and spheres are counted from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CsvFault {
    /// Not even a header.
    #[error("the file is empty; expected a header line such as {}", COLUMNS.join(","))]
    NoHeader,
    /// A header line and nothing else.
    #[error("the file has a header but no sphere")]
    NoSphere,
    /// A column that is not one of [`COLUMNS`].
    #[error("line 1, column {column}: unknown column `{found}`; allowed: {}", COLUMNS.join(", "))]
    UnknownColumn {
        /// The column, from 1.
        column: usize,
        /// Its name, cut to 40 characters.
        found: String,
    },
    /// A column that is there twice.
    #[error("line 1: column {name} is there twice")]
    RepeatedColumn {
        /// The column.
        name: &'static str,
    },
    /// A column that is not there.
    #[error("line 1: column {name} is missing{}", if OPTIONAL.iter().any(|g| COLUMNS[g.clone()].contains(name)) { ", which the other two of its vector need" } else { "" })]
    MissingColumn {
        /// The column.
        name: &'static str,
    },
    /// A line with more or fewer fields than the header.
    #[error("line {line}: {found} fields instead of the header's {expected}")]
    FieldCount {
        /// The line.
        line: usize,
        /// Fields in it.
        found: usize,
        /// Fields of the header.
        expected: usize,
    },
    /// A field that is not a number, not finite, or a mass or radius that is not positive.
    #[error("line {line} (sphere {sphere}), column {name}: `{found}` must be a finite{} number", if matches!(*name, "mass_kg" | "radius_m") { " positive" } else { "" })]
    BadNumber {
        /// The line.
        line: usize,
        /// The sphere.
        sphere: usize,
        /// The column.
        name: &'static str,
        /// The text in its place, cut to 40 characters.
        found: String,
    },
    /// More than [`MAX_SPHERES`] lines.
    #[error("more than {MAX_SPHERES} spheres")]
    TooManySpheres,
}

/// Reads the text of an aggregate file. Blank lines are skipped.
///
/// # Errors
/// The first fault, with its line and column.
pub fn parse_aggregate(text: &[u8]) -> Result<Spheres, CsvFault> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let mut lines = text.split(|b| *b == b'\n').zip(1..);
    let columns = match lines.next() {
        Some((header, _)) if !header.trim_ascii().is_empty() => header_columns(header)?,
        _ => return Err(CsvFault::NoHeader),
    };
    let mut spheres = Spheres::default();
    let mut row = [0.0; 11];
    for (line, number) in lines.filter(|(line, _)| !line.trim_ascii().is_empty()) {
        let found = line.split(|b| *b == b',').count();
        if found != columns.len() {
            return Err(CsvFault::FieldCount { line: number, found, expected: columns.len() });
        }
        if spheres.len() == MAX_SPHERES {
            return Err(CsvFault::TooManySpheres);
        }
        for (field, column) in line.split(|b| *b == b',').zip(&columns) {
            row[*column] = number_in(field, *column).ok_or_else(|| CsvFault::BadNumber {
                line: number,
                sphere: spheres.len() + 1,
                name: COLUMNS[*column],
                found: shown(field),
            })?;
        }
        let [x, y, z, vx, vy, vz, wx, wy, wz, mass, radius] = row;
        spheres.push([x, y, z], [vx, vy, vz], [wx, wy, wz], mass, radius);
    }
    if spheres.is_empty() {
        return Err(CsvFault::NoSphere);
    }
    Ok(spheres)
}

/// The text of an aggregate file, with all columns.
pub fn aggregate_csv(spheres: &Spheres) -> String {
    let columns = spheres.columns();
    let mut text = COLUMNS.join(",");
    text.push('\n');
    for i in 0..spheres.len() {
        for (k, column) in columns.iter().enumerate() {
            let comma = if k == 0 { "" } else { "," };
            write!(text, "{comma}{:?}", column[i]).expect("writing to a string cannot fail");
        }
        text.push('\n');
    }
    text
}

/// For each field of the header, its place in [`COLUMNS`].
fn header_columns(header: &[u8]) -> Result<Vec<usize>, CsvFault> {
    let mut columns = Vec::new();
    for (field, column) in header.split(|b| *b == b',').zip(1..) {
        let known = COLUMNS.iter().position(|name| name.as_bytes() == field.trim_ascii());
        let place = known.ok_or_else(|| CsvFault::UnknownColumn { column, found: shown(field) })?;
        if columns.contains(&place) {
            return Err(CsvFault::RepeatedColumn { name: COLUMNS[place] });
        }
        columns.push(place);
    }
    let left_out = |place: &usize| {
        let group = OPTIONAL.iter().find(|group| group.contains(place));
        group.is_some_and(|group| group.clone().all(|other| !columns.contains(&other)))
    };
    match (0..COLUMNS.len()).find(|place| !columns.contains(place) && !left_out(place)) {
        Some(place) => Err(CsvFault::MissingColumn { name: COLUMNS[place] }),
        None => Ok(columns),
    }
}

fn number_in(field: &[u8], column: usize) -> Option<f64> {
    let value: f64 = std::str::from_utf8(field.trim_ascii()).ok()?.parse().ok()?;
    let positive = matches!(COLUMNS[column], "mass_kg" | "radius_m");
    (value.is_finite() && (!positive || value > 0.0)).then_some(value)
}

fn shown(field: &[u8]) -> String {
    const LONGEST: usize = 40;
    let head = &field[..field.len().min(4 * LONGEST)];
    String::from_utf8_lossy(head).trim().chars().take(LONGEST).flat_map(char::escape_debug).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fault_of(text: &str) -> CsvFault {
        parse_aggregate(text.as_bytes()).unwrap_err()
    }

    #[test]
    fn columns_may_stand_in_any_order_and_motion_may_be_left_out() {
        let spheres =
            parse_aggregate(b"\xef\xbb\xbfradius_m, mass_kg,z_m,y_m,x_m\r\n1,2,3,4,5\r\n\r\n10,20,30,40,5e1\n")
                .unwrap();
        assert_eq!((spheres.position(0), spheres.position(1)), ([5.0, 4.0, 3.0], [50.0, 40.0, 30.0]));
        assert_eq!((&spheres.mass[..], &spheres.radius[..]), (&[2.0, 20.0][..], &[1.0, 10.0][..]));
        assert_eq!((spheres.velocity(1), spheres.spin(1)), ([0.0; 3], [0.0; 3]));
    }

    #[test]
    fn faults_name_line_sphere_and_column() {
        let header = "x_m,y_m,z_m,mass_kg,radius_m\n";
        let with = |rows: &str| fault_of(&format!("{header}{rows}"));
        assert_eq!(fault_of(""), CsvFault::NoHeader);
        assert_eq!(fault_of(header), CsvFault::NoSphere);
        assert_eq!(fault_of("x_m,why\n"), CsvFault::UnknownColumn { column: 2, found: "why".into() });
        assert_eq!(fault_of("x_m,x_m\n"), CsvFault::RepeatedColumn { name: "x_m" });
        assert_eq!(fault_of("x_m,y_m,z_m,mass_kg\n"), CsvFault::MissingColumn { name: "radius_m" });
        assert_eq!(fault_of("x_m,y_m,z_m,mass_kg,radius_m,vy_m_s\n"), CsvFault::MissingColumn { name: "vx_m_s" });
        assert_eq!(with("1,2,3,4\n"), CsvFault::FieldCount { line: 2, found: 4, expected: 5 });
        let bad = |line, sphere, name, found: &str| CsvFault::BadNumber { line, sphere, name, found: found.into() };
        assert_eq!(with("1,2,3,4,5\n\n1,NaN,3,4,5\n"), bad(4, 2, "y_m", "NaN"));
        assert_eq!(with("1,2,3,4,-5\n"), bad(2, 1, "radius_m", "-5"));
        assert_eq!(with("1,2,3,0,5\n"), bad(2, 1, "mass_kg", "0"));
        assert_eq!(with("1,2,1e999,4,5\n"), bad(2, 1, "z_m", "1e999"));
        assert_eq!(with("one,2,3,4,5\n"), bad(2, 1, "x_m", "one"));
        let message = with("1,2,3,-4,5\n").to_string();
        assert_eq!(message, "line 2 (sphere 1), column mass_kg: `-4` must be a finite positive number");
    }

    proptest! {
        #[test]
        fn prop_any_bytes_are_read_or_refused(text in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = parse_aggregate(&text);
        }

        #[test]
        fn prop_any_rows_are_read_or_refused(rows in "([0-9.,eE+-]|nan|inf|\n){0,200}") {
            let _ = parse_aggregate(format!("x_m,y_m,z_m,mass_kg,radius_m\n{rows}").as_bytes());
        }

        #[test]
        fn prop_written_aggregates_read_back_bit_for_bit(
            rows in prop::collection::vec(prop::array::uniform9(prop::num::f64::NORMAL | prop::num::f64::ZERO), 1..10),
            sizes in prop::array::uniform2(1e-300f64..1e300),
        ) {
            let mut spheres = Spheres::default();
            for [x, y, z, vx, vy, vz, wx, wy, wz] in rows {
                spheres.push([x, y, z], [vx, vy, vz], [wx, wy, wz], sizes[0], sizes[1]);
            }
            let back = parse_aggregate(aggregate_csv(&spheres).as_bytes()).unwrap();
            for (got, want) in back.columns().iter().zip(spheres.columns()) {
                prop_assert!(got.iter().map(|v| v.to_bits()).eq(want.iter().map(|v| v.to_bits())));
            }
        }
    }
}
