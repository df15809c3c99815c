//! The spheres' next events as a tournament: a binary tree of winners whose root is the earliest one.
//!
//! Every sphere owns one leaf, so changing its event replays `log2 N` matches and nothing is ever inserted, deleted or
//! left behind. Equal times are won by the smaller index: the order of events is a function of their times alone.

/// A leaf's key and owner, or the winner of a match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    /// The time of the event, s, or any key of which the smallest wins; infinite when there is none.
    pub key: f64,
    /// The leaf it belongs to.
    pub index: u32,
}

impl Entry {
    /// The winner of two; neither key may be NaN.
    fn winner(self, other: Self) -> Self {
        let other_wins = other.key < self.key || (other.key == self.key && other.index < self.index);
        if other_wins { other } else { self }
    }
}

/// Smallest of `N` keys, updated in `O(log N)`.
#[derive(Debug, Clone, Default)]
pub(super) struct Tournament {
    /// A complete tree: node `p` has the children `2p` and `2p + 1`, leaf `i` is node `leaves + i`.
    nodes: Vec<Entry>,
    leaves: usize,
}

impl Tournament {
    /// Starts again with these keys, one per leaf.
    pub fn reset(&mut self, keys: impl ExactSizeIterator<Item = f64>) {
        self.leaves = keys.len().next_power_of_two().max(2);
        self.nodes.clear();
        self.nodes.resize(self.leaves, Entry { key: f64::INFINITY, index: u32::MAX });
        self.nodes.extend(keys.zip(0..).map(|(key, index)| Entry { key, index }));
        self.nodes.resize(2 * self.leaves, Entry { key: f64::INFINITY, index: u32::MAX });
        for p in (1..self.leaves).rev() {
            self.nodes[p] = self.nodes[2 * p].winner(self.nodes[2 * p + 1]);
        }
    }

    /// The leaf with the smallest key.
    #[inline]
    pub fn first(&self) -> Entry {
        self.nodes[1]
    }

    /// Gives leaf `index` another key.
    #[inline]
    pub fn set(&mut self, index: usize, key: f64) {
        let mut p = self.leaves + index;
        let mut winner = Entry { key, index: index as u32 };
        self.nodes[p] = winner;
        while p > 1 {
            winner = winner.winner(self.nodes[p ^ 1]);
            p >>= 1;
            self.nodes[p] = winner;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn prop_root_is_the_smallest_key_and_ties_go_to_the_smaller_index(
            keys in prop::collection::vec(0u8..20, 1..40),
            changes in prop::collection::vec((0usize..40, 0u8..20), 0..60),
        ) {
            let mut keys: Vec<f64> = keys.into_iter().map(f64::from).collect();
            let mut tree = Tournament::default();
            tree.reset(keys.iter().copied());
            for (i, key) in changes {
                let i = i % keys.len();
                keys[i] = f64::from(key);
                tree.set(i, keys[i]);
                let smallest = keys.iter().copied().fold(f64::INFINITY, f64::min);
                let index = keys.iter().position(|k| *k == smallest).unwrap() as u32;
                prop_assert_eq!(tree.first(), Entry { key: smallest, index });
            }
        }
    }
}
