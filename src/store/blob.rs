//! Arrays as little-endian blobs, readable with `numpy.frombuffer`.

/// Bytes of an `f64` array.
pub fn f64_to_blob(values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    values.into_iter().flat_map(f64::to_le_bytes).collect()
}

/// The array behind [`f64_to_blob`]; `None` when the length is not a multiple of eight bytes.
pub fn blob_to_f64(blob: &[u8]) -> Option<Vec<f64>> {
    let (chunks, rest) = blob.as_chunks::<8>();
    rest.is_empty().then(|| chunks.iter().map(|c| f64::from_le_bytes(*c)).collect())
}

/// Bytes of an `N x 3` array.
pub fn points_to_blob(points: &[[f64; 3]]) -> Vec<u8> {
    f64_to_blob(points.iter().flatten().copied())
}

/// The array behind [`points_to_blob`].
pub fn blob_to_points(blob: &[u8]) -> Option<Vec<[f64; 3]>> {
    let flat = blob_to_f64(blob)?;
    let (points, rest) = flat.as_chunks::<3>();
    rest.is_empty().then(|| points.to_vec())
}

/// Bytes of a `u32` array.
pub fn u32_to_blob(values: impl IntoIterator<Item = u32>) -> Vec<u8> {
    values.into_iter().flat_map(u32::to_le_bytes).collect()
}

/// The array behind [`u32_to_blob`].
pub fn blob_to_u32(blob: &[u8]) -> Option<Vec<u32>> {
    let (chunks, rest) = blob.as_chunks::<4>();
    rest.is_empty().then(|| chunks.iter().map(|c| u32::from_le_bytes(*c)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_survive_the_round_trip_bit_for_bit() {
        let values = [0.1, -0.0, f64::MIN_POSITIVE, 1e300];
        let back = blob_to_f64(&f64_to_blob(values)).unwrap();
        assert!(values.iter().zip(&back).all(|(a, b)| a.to_bits() == b.to_bits()));
        let points = vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
        assert_eq!(blob_to_points(&points_to_blob(&points)).unwrap(), points);
        assert_eq!(blob_to_u32(&u32_to_blob([7, 8])).unwrap(), [7, 8]);
    }

    #[test]
    fn a_blob_of_the_wrong_length_is_refused() {
        assert_eq!(blob_to_f64(&[0; 7]), None);
        assert_eq!(blob_to_points(&[0; 16]), None);
        assert_eq!(blob_to_u32(&[0; 5]), None);
    }
}
