//! Points of successive shapes in few bytes: those that differ from the shape before, in 16-bit steps, as base64.

/// Coordinates in steps; see [`Steps`].
pub type Point = [i16; 3];

/// The step in which coordinates are given: none is farther off than half a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steps {
    /// m.
    pub unit: f64,
}

impl Steps {
    /// Steps in which every one of `points` (m) can be given.
    pub fn for_points<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> Self {
        let largest = points.into_iter().flatten().fold(0.0_f64, |largest, c| largest.max(c.abs()));
        Self { unit: if largest > 0.0 { largest / f64::from(i16::MAX) } else { 1.0 } }
    }

    /// The steps nearest to `point` (m).
    pub fn of(self, point: &[f64; 3]) -> Point {
        // `as` saturates, so nothing wraps around.
        point.map(|c| (c / self.unit).round() as i16)
    }
}

/// Numbered points as the page decodes them: all numbers (16 bits, or 32 if `wide`), then all coordinates, little-endian.
pub fn encode(points: &[(u32, Point)], wide: bool) -> String {
    let mut bytes = Vec::with_capacity(points.len() * 10);
    for (number, _) in points {
        let number = number.to_le_bytes();
        bytes.extend_from_slice(if wide { &number } else { &number[..2] });
    }
    bytes.extend(points.iter().flat_map(|(_, point)| point.iter().flat_map(|c| c.to_le_bytes())));
    base64(&bytes)
}

/// Standard base64 with padding (RFC 4648), as the browser's `atob` reads it.
pub fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().enumerate().fold(0_u32, |word, (i, byte)| word | u32::from(*byte) << (16 - 8 * i));
        for digit in 0..4 {
            let known = digit <= chunk.len();
            let value = (word >> (18 - 6 * digit)) as usize & 63;
            text.push(if known { char::from(DIGITS[value]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test vectors of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_standard() {
        let cases =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")];
        for (plain, coded) in cases {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
        assert_eq!(base64(&[0xfb, 0xff, 0xfe]), "+//+");
    }

    #[test]
    fn steps_are_fine_and_never_wrap() {
        let points = [[-500.0, 3.0, 0.1], [12.0, 499.0, 0.0]];
        let steps = Steps::for_points(&points);
        for point in &points {
            let back = steps.of(point).map(|c| f64::from(c) * steps.unit);
            assert!(point.iter().zip(back).all(|(a, b)| (a - b).abs() <= 0.5001 * steps.unit));
        }
        assert_eq!(steps.of(&[1e9, -1e9, f64::NAN]), [i16::MAX, i16::MIN, 0]);
        assert_eq!(Steps::for_points(&[[0.0; 3]]).of(&[0.0; 3]), [0; 3]);
    }

    #[test]
    fn numbers_come_first_then_coordinates() {
        let points = [(1, [1, 2, -1]), (258, [0, 0, 256])];
        assert_eq!(encode(&points, false), base64(&[1, 0, 2, 1, 1, 0, 2, 0, 255, 255, 0, 0, 0, 0, 0, 1]));
        assert_eq!(encode(&points[..1], true), base64(&[1, 0, 0, 0, 1, 0, 2, 0, 255, 255]));
    }
}
