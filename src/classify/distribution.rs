//! A set of numbers in a few: quartiles, mean, ends.

/// How numbers are spread; all `None` of an empty set.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Distribution {
    /// How many there are.
    pub count: usize,
    /// Smallest.
    pub smallest: Option<f64>,
    /// A quarter is below.
    pub lower_quartile: Option<f64>,
    /// Half is below.
    pub median: Option<f64>,
    /// Three quarters are below.
    pub upper_quartile: Option<f64>,
    /// Largest.
    pub largest: Option<f64>,
    /// Arithmetic mean.
    pub mean: Option<f64>,
}

impl Distribution {
    /// Of these numbers, none of which is NaN; quantiles lie on straight lines between the sorted numbers.
    ///
    /// # Examples
    /// ```
    /// use yorp::classify::Distribution;
    /// let found = Distribution::of([4.0, 1.0, 3.0, 2.0]);
    /// assert_eq!((found.smallest, found.median, found.mean), (Some(1.0), Some(2.5), Some(2.5)));
    /// ```
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let count = sorted.len();
        let quantile = |share: f64| {
            let place = share * count.checked_sub(1)? as f64;
            let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
            Some(below + (above - below) * place.fract())
        };
        Self {
            count,
            smallest: sorted.first().copied(),
            lower_quartile: quantile(0.25),
            median: quantile(0.5),
            upper_quartile: quantile(0.75),
            largest: sorted.last().copied(),
            mean: (count > 0).then(|| sorted.iter().sum::<f64>() / count as f64),
        }
    }
}

/// The median; `None` of nothing.
pub(super) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    Distribution::of(values).median
}
