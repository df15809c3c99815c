//! Arrays as one NPZ file: a ZIP archive, uncompressed, of NPY files, which `numpy.load` reads by name.
//!
//! Source: NumPy's NEP 1 (format 1.0) and PKWARE's APPNOTE, sections 4.3.7, 4.3.12 and 4.3.16. Uncompressed because torques
//! and positions are noise to a compressor, and because numpy then maps them straight into memory.

use super::table::{Column, Table};
use crate::report::RunData;

/// An archive, or the names and offsets of one, that passes what 32 bits can count.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the arrays hold {bytes} bytes, more than the 4 GB of an NPZ file; --format csv has no such limit")]
pub struct TooLarge {
    /// Bytes so far.
    bytes: usize,
}

/// One array of the file.
struct Array {
    name: String,
    /// NumPy's name of the type.
    kind: String,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

/// Every table as `table/column`, and the shapes of the body as arrays:
/// `spheres/mass_kg` and `spheres/radius_m` (of the body as constructed; a sphere's number is its place),
/// `positions/configuration`, `positions/sphere` and `positions/position_m` (one row for each sphere of each configuration),
/// `tiling/facets` (F x 3), `tiling/vertices_m` (configurations x V x 3), `tiling/body_axes` (configurations x 3 x 3) and
/// `tiling/centre_of_mass_m` (configurations x 3), all in the original frame.
///
/// # Errors
/// [`TooLarge`].
pub fn npz(run: &RunData, tables: &[Table]) -> Result<Vec<u8>, TooLarge> {
    let mut arrays: Vec<Array> = tables
        .iter()
        .flat_map(|table| table.columns.iter().map(move |(name, column)| (table.name, name, column)))
        .map(|(table, name, column)| Array::column(format!("{table}/{name}"), column))
        .collect();
    let shapes = &run.configurations;
    let count = shapes.len();
    let vertices = shapes.first().map_or(0, |c| c.vertices.len());
    let spheres = || shapes.iter().flat_map(|c| c.sphere_ids.iter().map(|s| (c.configuration, *s)));
    let points = || shapes.iter().flat_map(|c| &c.positions).flatten().copied();
    let facets = || run.tiling.iter().flat_map(|t| &t.facets).flatten().map(|v| i64::from(*v));
    arrays.extend([
        Array::numbers("spheres/mass_kg", vec![run.sphere_mass_kg.len()], run.sphere_mass_kg.iter().copied()),
        Array::numbers("spheres/radius_m", vec![run.sphere_radius_m.len()], run.sphere_radius_m.iter().copied()),
        Array::whole("positions/configuration", vec![spheres().count()], spheres().map(|(c, _)| c.into())),
        Array::whole("positions/sphere", vec![spheres().count()], spheres().map(|(_, s)| s.into())),
        Array::numbers("positions/position_m", vec![spheres().count(), 3], points()),
        Array::whole("tiling/facets", vec![facets().count() / 3, 3], facets()),
        Array::numbers(
            "tiling/vertices_m",
            vec![count, vertices, 3],
            shapes.iter().flat_map(|c| &c.vertices).flatten().copied(),
        ),
        Array::numbers("tiling/body_axes", vec![count, 3, 3], shapes.iter().flat_map(|c| c.body_axes).flatten()),
        Array::numbers("tiling/centre_of_mass_m", vec![count, 3], shapes.iter().flat_map(|c| c.centre_of_mass)),
    ]);
    archive(arrays)
}

impl Array {
    fn numbers(name: &str, shape: Vec<usize>, values: impl Iterator<Item = f64>) -> Self {
        Self { name: name.into(), kind: "<f8".into(), shape, bytes: values.flat_map(f64::to_le_bytes).collect() }
    }

    fn whole(name: &str, shape: Vec<usize>, values: impl Iterator<Item = i64>) -> Self {
        Self { name: name.into(), kind: "<i8".into(), shape, bytes: values.flat_map(i64::to_le_bytes).collect() }
    }

    fn column(name: String, column: &Column) -> Self {
        match column {
            Column::Number(values) => Self::numbers(&name, vec![values.len()], values.iter().copied()),
            Column::Whole(values) => Self::whole(&name, vec![values.len()], values.iter().copied()),
            Column::Text(values) => Self::words(name, values),
        }
    }

    /// Words of the length of the longest, four bytes a character.
    fn words(name: String, values: &[String]) -> Self {
        let longest = values.iter().map(|v| v.chars().count()).max().unwrap_or(0).max(1);
        let word = |word: &String| {
            let codes: Vec<u32> = word.chars().map(u32::from).chain(std::iter::repeat(0)).take(longest).collect();
            codes.into_iter().flat_map(u32::to_le_bytes)
        };
        let bytes = values.iter().flat_map(word).collect();
        Self { name, kind: format!("<U{longest}"), shape: vec![values.len()], bytes }
    }

    /// Magic string, version, length of the header, header, data.
    fn npy(&self) -> Vec<u8> {
        let shape: String = self.shape.iter().map(|n| format!("{n}, ")).collect();
        let mut header = format!("{{'descr': '{}', 'fortran_order': False, 'shape': ({shape}), }}", self.kind);
        // Data begin at a multiple of 64 bytes.
        while (10 + header.len() + 1) % 64 != 0 {
            header.push(' ');
        }
        header.push('\n');
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend((header.len() as u16).to_le_bytes());
        file.extend(header.as_bytes());
        file.extend(&self.bytes);
        file
    }
}

/// Local headers with data, then the directory, then its end.
fn archive(arrays: Vec<Array>) -> Result<Vec<u8>, TooLarge> {
    let bytes = arrays.iter().map(|a| a.bytes.len() + 1024).sum();
    if bytes > u32::MAX as usize {
        return Err(TooLarge { bytes });
    }
    let (mut file, mut directory) = (Vec::with_capacity(bytes), Vec::new());
    let count = arrays.len() as u16;
    for array in arrays {
        let (name, data) = (format!("{}.npy", array.name), array.npy());
        let offset = file.len() as u32;
        // Version 2.0, no flags, stored, 1980-01-01 00:00 (equal runs give equal files), checksum, sizes, name.
        let mut common = Vec::new();
        common.extend([20, 0, 0, 0, 0, 0, 0, 0, 0x21, 0]);
        common.extend(crc32(&data).to_le_bytes());
        common.extend((data.len() as u32).to_le_bytes());
        common.extend((data.len() as u32).to_le_bytes());
        common.extend((name.len() as u16).to_le_bytes());
        common.extend([0, 0]);
        file.extend(b"PK\x03\x04");
        file.extend(&common);
        file.extend(name.as_bytes());
        file.extend(&data);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&common);
        // No comment, first disk, no attributes.
        directory.extend([0; 10]);
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let start = file.len() as u32;
    file.extend(&directory);
    file.extend(b"PK\x05\x06\x00\x00\x00\x00");
    file.extend(count.to_le_bytes());
    file.extend(count.to_le_bytes());
    file.extend((directory.len() as u32).to_le_bytes());
    file.extend(start.to_le_bytes());
    file.extend([0, 0]);
    Ok(file)
}

/// The checksum of ZIP: polynomial 0xEDB88320, reflected.
fn crc32(bytes: &[u8]) -> u32 {
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let mut i = 0;
        while i < 256 {
            let (mut value, mut bit) = (i as u32, 0);
            while bit < 8 {
                value = if value & 1 == 1 { (value >> 1) ^ 0xEDB8_8320 } else { value >> 1 };
                bit += 1;
            }
            table[i] = value;
            i += 1;
        }
        table
    };
    !bytes.iter().fold(!0, |crc, byte| TABLE[((crc ^ u32::from(*byte)) & 0xff) as usize] ^ (crc >> 8))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of this checksum in the catalogue of parametrised CRC algorithms (CRC-32/ISO-HDLC).
    #[test]
    fn ref_checksum_of_the_nine_digits() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn data_begin_at_a_multiple_of_64_bytes() {
        let array = Array::column("a".into(), &Column::text(["quiet", "é"]));
        let file = array.npy();
        assert_eq!((file.len() - array.bytes.len()) % 64, 0);
        assert_eq!((array.kind.as_str(), array.bytes.len()), ("<U5", 40));
    }
}
