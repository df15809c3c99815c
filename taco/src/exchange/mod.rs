//! Self-heating: light that a facet scatters or emits and that meets another facet is followed until it leaves the body.
//!
//! Whatever meets a facet is absorbed and emitted again or scattered, both isotropically (Lambert); only direct sunlight
//! follows the photometric model. A facet that stores no heat emits what it absorbs at once. Then the fate of light is a
//! walk from facet to facet that does not depend on its wavelength, on albedo, emissivity or time, and what a facet's light
//! does to the body in the end is one vector ([`Wrench`]) a facet, the same for all positions of the Sun: self-heating costs
//! the view factors and one sparse linear system. Where the ground stores heat, what it conducts leaves from the facet
//! later and then walks likewise; only how much is conducted has to be found with all facets coupled ([`Coupled`]). Pairs of
//! facets exert no net force on each other, so only light that escapes counts; energy is conserved photon by photon, whatever
//! the accuracy of the view factors.
//!
//! View factors are those of the facets' centroids, whatever the number of points from which shadows are seen.

mod body;
mod coupling;
mod harmonics;
mod scattering;
mod views;
mod warmth;
mod wrench;

use crate::facets::Facet;
use crate::horizon::{Horizon, HorizonMap};
use crate::scanner::Scanner;
use crate::sky::sky_view;
use crate::surface::SelfHeating;
pub(crate) use body::Coupled;
use coupling::Members;
pub(crate) use scattering::Scattering;
use views::Views;
pub(crate) use wrench::Wrench;

/// What the exchange of light between the facets of a body does to it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Exchange {
    views: Views,
    members: Members,
    /// By facet: with all azimuths of the horizon map, and with every other one.
    wrenches: [Vec<Wrench>; 2],
}

/// Which azimuths of the horizon map are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Azimuths {
    All = 0,
    EveryOther = 1,
}

impl Exchange {
    /// `None` if the surface asks for none or no facet sees another.
    pub fn new(facets: &[Facet], scanner: &Scanner, map: &HorizonMap, mode: SelfHeating) -> Option<Self> {
        if mode == SelfHeating::None || map.shaded_facets() == 0 {
            return None;
        }
        let views = Views::new(facets, scanner, map);
        let escaping = |azimuths| {
            let sky = |f: usize| match azimuths {
                Azimuths::All => map.horizon(f).map(sky_view),
                Azimuths::EveryOther => map.horizon(f).map(Horizon::every_other).as_ref().map(sky_view),
            };
            wrench::followed(facets, sky, &views, azimuths, mode)
        };
        let wrenches = [escaping(Azimuths::All), escaping(Azimuths::EveryOther)];
        let members = Members::new(&views);
        Some(Self { views, members, wrenches })
    }

    /// What the light of a facet does to the body, if part of it meets other facets.
    pub fn wrench(&self, facet: usize, azimuths: Azimuths) -> Option<&Wrench> {
        (!self.views.rows[facet].is_empty()).then(|| &self.wrenches[azimuths as usize][facet])
    }
}
