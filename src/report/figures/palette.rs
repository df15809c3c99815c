//! Colours of the figures: safe for colour-blind readers, readable in print.

/// Red, green, blue, 0 to 255.
pub type Colour = [u8; 3];

/// Text, axes and the rigid curve.
pub const BLACK: Colour = [0, 0, 0];
/// Grid lines.
pub const GRID: Colour = [224, 224, 224];
/// What stands behind the data.
pub const GREY: Colour = [130, 130, 130];
/// First colour of two.
pub const BLUE: Colour = [0, 114, 178];
/// Second colour of two.
pub const ORANGE: Colour = [213, 94, 0];

/// Viridis (Smith and van der Walt, matplotlib 2015) at nine even steps, without its lightest tenth, which is lost on
/// white paper.
const VIRIDIS: [Colour; 9] = [
    [68, 1, 84],
    [71, 39, 119],
    [62, 73, 137],
    [48, 103, 141],
    [37, 130, 142],
    [30, 157, 136],
    [53, 183, 120],
    [109, 204, 88],
    [181, 222, 43],
];

/// Okabe and Ito (2008), without black and the yellow that is lost on white paper.
const DISTINCT: [Colour; 6] = [BLUE, ORANGE, [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0]];

/// Colour of the `fraction` (0 to 1) of a sequence.
pub fn sequential(fraction: f64) -> Colour {
    let along = fraction.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let step = (along as usize).min(VIRIDIS.len() - 2);
    let share = along - step as f64;
    let (from, to) = (VIRIDIS[step], VIRIDIS[step + 1]);
    std::array::from_fn(|k| (f64::from(from[k]) * (1.0 - share) + f64::from(to[k]) * share).round() as u8)
}

/// Colour of the `index`th of things without order; it comes again after six.
pub fn distinct(index: usize) -> Colour {
    DISTINCT[index % DISTINCT.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance by the formula of the sRGB standard's gamma-free approximation.
    fn lightness(colour: Colour) -> f64 {
        colour.iter().zip([0.2126, 0.7152, 0.0722]).map(|(c, weight)| weight * (f64::from(*c) / 255.0).powf(2.2)).sum()
    }

    #[test]
    fn the_sequence_grows_lighter_all_along_and_stays_visible_on_white() {
        let steps: Vec<f64> = (0..=50).map(|i| lightness(sequential(f64::from(i) / 50.0))).collect();
        assert!(steps.windows(2).all(|w| w[1] > w[0]));
        assert!(*steps.last().unwrap() < 0.65);
    }
}
