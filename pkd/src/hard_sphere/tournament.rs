//! The spheres' next events as a tournament: a binary tree of winners whose root is the earliest one.
//!
//! Every sphere owns one leaf, so changing its event replays `log2 N` matches and nothing is ever inserted, deleted or
//! left behind.

/// Smallest of `N` keys that are zero, positive, infinite or not a number (which lose against all others), updated in
/// `O(log N)`. Which of equal keys comes first depends on the order in which they were set.
#[derive(Debug, Clone, Default)]
pub(super) struct Tournament {
    /// The bits of the keys, which sort like positive floats; a power of two of them, filled up with infinity.
    keys: Vec<u64>,
    /// Leaf that wins below a node; node `p` has the children `2p` and `2p + 1`, and `keys.len() + i` stands for leaf `i`.
    winners: Vec<u32>,
}

impl Tournament {
    /// Starts again with these keys, one per leaf.
    pub fn reset(&mut self, keys: impl ExactSizeIterator<Item = f64>) {
        let leaves = keys.len().next_power_of_two().max(2);
        self.keys.clear();
        self.keys.extend(keys.map(f64::to_bits));
        self.keys.resize(leaves, f64::INFINITY.to_bits());
        self.winners.clear();
        self.winners.resize(leaves, 0);
        self.winners.extend(0..leaves as u32);
        for p in (1..leaves).rev() {
            let [one, two] = [self.winners[2 * p], self.winners[2 * p + 1]];
            self.winners[p] = if self.keys[two as usize] < self.keys[one as usize] { two } else { one };
        }
    }

    /// The leaf with the smallest key, and the key.
    #[inline(always)]
    pub fn first(&self) -> (usize, f64) {
        let leaf = self.winners[1] as usize;
        (leaf, f64::from_bits(self.keys[leaf]))
    }

    /// Gives leaf `i` another key.
    #[inline(always)]
    pub fn set(&mut self, i: usize, key: f64) {
        let mut key = key.to_bits();
        let mut winner = i as u32;
        let mut p = self.keys.len() + i;
        self.keys[i] = key;
        // The opponents are known in advance and the matches have no branches: nothing here waits but for the last winner.
        while p > 1 {
            // SAFETY: there are 2 keys.len() nodes, of which p is one, so p ^ 1 is one too; every winner is a leaf.
            let (opponent, its_key) = unsafe {
                let opponent = *self.winners.get_unchecked(p ^ 1);
                (opponent, *self.keys.get_unchecked(opponent as usize))
            };
            winner = if its_key < key { opponent } else { winner };
            key = its_key.min(key);
            p >>= 1;
            // SAFETY: as above.
            unsafe { *self.winners.get_unchecked_mut(p) = winner };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn prop_root_is_the_smallest_key(
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
                let (leaf, key) = tree.first();
                prop_assert_eq!((key, keys[leaf]), (smallest, smallest));
            }
        }
    }
}
