//! What contacts remember: the springs of sliding, rolling and twisting, as a list that can be stored and given back.

use nalgebra::{Matrix3, Vector3};

use crate::PkdError;

/// The memory of one contact. Vectors are in the frame of the spheres and as seen from the first: rates are those of the
/// second relative to it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Contact {
    /// Row of one sphere.
    pub first: u32,
    /// Row of the other, more than `first`.
    pub second: u32,
    /// Sliding spring S, m.
    pub sliding_m: [f64; 3],
    /// Rolling spring delta_R, rad; zero in models without.
    pub rolling_rad: [f64; 3],
    /// Twisting spring delta_T about the line of centres, rad; zero in models without.
    pub twisting_rad: f64,
    /// Time since first touch, s; zero in models that do not ask for it.
    pub age_s: f64,
}

impl Contact {
    /// The same contact seen from the other sphere: the springs, but not the sense of the twist, change sign.
    pub(super) fn reversed(self) -> Self {
        Self {
            first: self.second,
            second: self.first,
            sliding_m: self.sliding_m.map(|v| -v),
            rolling_rad: self.rolling_rad.map(|v| -v),
            ..self
        }
    }

    /// The contact of two rows that remembers this, see [`Self::memory`].
    pub fn from_memory([first, second]: [u32; 2], [a, b, c, d, e, f, twisting_rad, age_s]: [f64; 8]) -> Self {
        Self { first, second, sliding_m: [a, b, c], rolling_rad: [d, e, f], twisting_rad, age_s }
    }

    pub(super) fn is_blank(&self) -> bool {
        self.memory().iter().all(|v| *v == 0.0)
    }

    /// All that is remembered, in the order of the fields.
    pub fn memory(&self) -> [f64; 8] {
        let ([a, b, c], [d, e, f]) = (self.sliding_m, self.rolling_rad);
        [a, b, c, d, e, f, self.twisting_rad, self.age_s]
    }
}

/// The memory of all contacts of a body: with the spheres, the whole state of a soft-sphere run.
///
/// Springs are perpendicular to the line of centres, so a list is only good for the spheres at the places they had when it
/// was taken; [`Self::rotate`] and [`Self::filtered`] follow changes of frame and number.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactHistory {
    contacts: Vec<Contact>,
}

impl ContactHistory {
    /// The history made of these contacts, in any order.
    ///
    /// # Errors
    /// [`PkdError::BadContact`] for a pair that is listed twice, a sphere in contact with itself or rows out of order, and
    /// a spring or age that is not finite.
    pub fn new(mut contacts: Vec<Contact>) -> Result<Self, PkdError> {
        contacts.sort_unstable_by_key(|c| (c.first, c.second));
        let bad = |c: &Contact, reason| {
            Err(PkdError::BadContact { first: c.first as usize, second: c.second as usize, reason })
        };
        for (k, contact) in contacts.iter().enumerate() {
            if contact.first >= contact.second {
                return bad(contact, "the second row must be the larger");
            }
            if contact.memory().iter().any(|v| !v.is_finite()) {
                return bad(contact, "a spring is not finite");
            }
            if contacts.get(k + 1).is_some_and(|next| (next.first, next.second) == (contact.first, contact.second)) {
                return bad(contact, "it is listed twice");
            }
        }
        Ok(Self { contacts })
    }

    /// The contacts by first and then second row.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Whether nothing is remembered.
    pub fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// Turns all springs with the spheres: to be called when their positions are multiplied by `rotation`.
    pub fn rotate(&mut self, rotation: &Matrix3<f64>) {
        for contact in &mut self.contacts {
            contact.sliding_m = (rotation * Vector3::from(contact.sliding_m)).into();
            contact.rolling_rad = (rotation * Vector3::from(contact.rolling_rad)).into();
        }
    }

    /// The history of the spheres that are left by [`Spheres::filtered`](crate::Spheres::filtered) with the same flags.
    pub fn filtered(&self, keep: &[bool]) -> Self {
        let mut row = 0;
        let rows: Vec<Option<u32>> = keep
            .iter()
            .map(|kept| {
                row += u32::from(*kept);
                kept.then(|| row - 1)
            })
            .collect();
        let new_row = |old: u32| rows.get(old as usize).copied().flatten();
        let contacts = self
            .contacts
            .iter()
            .filter_map(|c| Some(Contact { first: new_row(c.first)?, second: new_row(c.second)?, ..*c }))
            .collect();
        Self { contacts }
    }

    /// The history of the same spheres in other rows, among others or not: `row` gives the new row of each old one, and
    /// keeps their order.
    pub fn renumbered(&self, row: impl Fn(u32) -> u32) -> Self {
        let contacts = self.contacts.iter().map(|c| Contact { first: row(c.first), second: row(c.second), ..*c });
        Self { contacts: contacts.collect() }
    }

    /// # Errors
    /// [`PkdError::BadContact`] for a row that is not among `spheres` rows.
    pub(super) fn fits(&self, spheres: usize) -> Result<(), PkdError> {
        match self.contacts.iter().find(|c| c.second as usize >= spheres) {
            Some(c) => Err(PkdError::BadContact {
                first: c.first as usize,
                second: c.second as usize,
                reason: "there are not as many spheres: the history is that of another body",
            }),
            None => Ok(()),
        }
    }

    /// Of contacts known to be valid, in any order.
    pub(super) fn sorted(mut contacts: Vec<Contact>) -> Self {
        contacts.sort_unstable_by_key(|c| (c.first, c.second));
        Self { contacts }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(first: u32, second: u32) -> Contact {
        Contact { first, second, sliding_m: [1.0, 0.0, 0.0], ..Contact::default() }
    }

    #[test]
    fn lists_are_sorted_and_impossible_ones_refused() {
        let history = ContactHistory::new(vec![contact(2, 3), contact(0, 4), contact(0, 1)]).unwrap();
        let rows: Vec<_> = history.contacts().iter().map(|c| (c.first, c.second)).collect();
        assert_eq!(rows, [(0, 1), (0, 4), (2, 3)]);
        assert!(history.fits(5).is_ok() && history.fits(4).is_err());
        let nan = Contact { twisting_rad: f64::NAN, ..contact(0, 1) };
        for bad in [vec![contact(1, 1)], vec![contact(2, 1)], vec![contact(0, 1), contact(0, 1)], vec![nan]] {
            assert!(matches!(ContactHistory::new(bad), Err(PkdError::BadContact { .. })));
        }
    }

    #[test]
    fn history_follows_rotations_and_removals() {
        let mut history = ContactHistory::new(vec![contact(0, 2), contact(1, 2), contact(2, 3)]).unwrap();
        history.rotate(&Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0));
        assert_eq!(history.contacts()[0].sliding_m, [0.0, 1.0, 0.0]);
        let left = history.filtered(&[true, false, true, true]);
        let rows: Vec<_> = left.contacts().iter().map(|c| (c.first, c.second)).collect();
        assert_eq!(rows, [(0, 1), (1, 2)]);
        let back = left.renumbered(|row| [0, 2, 3][row as usize]);
        assert_eq!(back.contacts(), [history.contacts()[0], history.contacts()[2]]);
    }
}
