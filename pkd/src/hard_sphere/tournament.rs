//! The spheres' next events as a tournament: a binary tree of winners whose root is the earliest one.
//!
//! Every sphere owns one leaf, so changing its event replays `log2 N` matches and nothing is ever inserted, deleted or
//! left behind. Equal times are won by the smaller index: the order of events is a function of their times alone.

/// A leaf and its key, as one number: positive floats sort like their bits, and equal ones by the leaf below them.
type Ticket = u128;

fn ticket(key: f64, leaf: usize) -> Ticket {
    Ticket::from(key.to_bits()) << 64 | leaf as Ticket
}

/// Smallest of `N` keys that are zero, positive, infinite or not a number (which lose against all others), updated in `O(log N)`.
#[derive(Debug, Clone, Default)]
pub(super) struct Tournament {
    /// A power of two, filled up with infinity.
    keys: Vec<f64>,
    /// Leaf that wins below a node; node `p` has the children `2p` and `2p + 1`, and `keys.len() + i` stands for leaf `i`.
    winners: Vec<u32>,
}

impl Tournament {
    /// Starts again with these keys, one per leaf.
    pub fn reset(&mut self, keys: impl ExactSizeIterator<Item = f64>) {
        let leaves = keys.len().next_power_of_two().max(2);
        self.keys.clear();
        self.keys.extend(keys);
        self.keys.resize(leaves, f64::INFINITY);
        self.winners.clear();
        self.winners.resize(leaves, 0);
        self.winners.extend(0..leaves as u32);
        for p in (1..leaves).rev() {
            self.winners[p] = self.at(2 * p).min(self.at(2 * p + 1)) as u32;
        }
    }

    /// The winner below node `p`.
    #[inline(always)]
    fn at(&self, p: usize) -> Ticket {
        let leaf = self.winners[p] as usize;
        ticket(self.keys[leaf], leaf)
    }

    /// The leaf with the smallest key, and the key.
    #[inline(always)]
    pub fn first(&self) -> (usize, f64) {
        let leaf = self.winners[1] as usize;
        (leaf, self.keys[leaf])
    }

    /// Gives leaf `i` another key.
    #[inline(always)]
    pub fn set(&mut self, i: usize, key: f64) {
        self.keys[i] = key;
        let mut p = self.keys.len() + i;
        let mut winner = ticket(key, i);
        // The opponents are known in advance and the matches have no branches: nothing here waits but for the last winner.
        while p > 1 {
            // SAFETY: there are 2 keys.len() nodes, of which p is one, so p ^ 1 is one too; every winner is a leaf.
            let opponent = unsafe {
                let leaf = *self.winners.get_unchecked(p ^ 1) as usize;
                ticket(*self.keys.get_unchecked(leaf), leaf)
            };
            winner = winner.min(opponent);
            p >>= 1;
            // SAFETY: as above.
            unsafe { *self.winners.get_unchecked_mut(p) = winner as u32 };
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
                let leaf = keys.iter().position(|k| *k == smallest).unwrap();
                prop_assert_eq!(tree.first(), (leaf, smallest));
            }
        }
    }
}
