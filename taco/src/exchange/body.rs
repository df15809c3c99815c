//! Heat that the facets of a body conduct while they light and warm one another, for each thermal parameter.

use super::Exchange;
use super::coupling::Optics;
use super::warmth::{Conducted, Sunlight, Warmth};
use crate::body::Body;
use crate::day::Day;
use crate::declination::Declinations;
use crate::heat::insolation::{CellFlux, Cells};
use crate::recoil::{RecoilKernel, RecoilTable};
use crate::surface::{Reflectance, Surface};

/// What the members of an exchange conduct, one set a thermal parameter.
pub(crate) struct Coupled<'a> {
    exchange: &'a Exchange,
    conducted: Vec<Conducted>,
}

/// Sunlight on a body, averaged over the parts of each facet.
struct Shone<'a, K> {
    body: &'a Body<'a, K>,
    declinations: &'a Declinations,
    cells: Cells,
}

impl<'a> Coupled<'a> {
    /// `None` for a body that exchanges no light. Each balance is solved to `tolerance` of its mean flux.
    pub fn new<K: RecoilKernel>(
        body: &'a Body<'a, K>,
        declinations: &Declinations,
        thetas: &[f64],
        cells: usize,
        tolerance: f64,
    ) -> Option<Self> {
        let exchange = body.shading?.exchange.as_ref()?;
        let sunlight = Shone { body, declinations, cells: Cells::new(cells) };
        let optics = Optics {
            diffuse_albedo: diffuse_albedo(body.surface),
            emissivity: body.surface.emissivity,
            mode: body.surface.self_heating,
        };
        let mut warmth = Warmth::new(exchange, body.facets, &sunlight, [declinations.len(), cells], optics);
        let conducted = thetas.iter().map(|theta| warmth.conducted(*theta, tolerance)).collect();
        Some(Self { exchange, conducted })
    }

    /// Means of what a facet conducts times the cosine and the sine of the Sun's hour angle, `[declination]` for each
    /// thermal parameter; `None` for a facet that neither sees another nor is seen by one.
    pub fn of(&self, facet: usize) -> Option<impl Iterator<Item = &[[f32; 2]]>> {
        let member = self.exchange.members.place(facet)?;
        Some(self.conducted.iter().map(move |conducted| conducted.of(member)))
    }
}

impl<'a, K: RecoilKernel> Sunlight for Shone<'a, K> {
    type State = (Day<'a, K>, CellFlux);

    fn state(&self) -> Self::State {
        (Day::new(self.body.kernel, self.declinations), CellFlux::default())
    }

    fn look(&self, (day, of_part): &mut Self::State, facet: usize, out: &mut CellFlux) {
        out.reset(self.declinations.len(), self.cells.count());
        self.body.for_each_part(facet, |part, horizon, share| {
            day.cell_means(part, self.body.view(horizon).0, &self.cells, of_part);
            for (sum, more) in [(&mut out.absorbed, &of_part.absorbed), (&mut out.reflected, &of_part.reflected)] {
                sum.iter_mut().zip(more).for_each(|(s, m)| *s += share * m);
            }
        });
    }
}

/// Fraction of diffuse visible light that the surface scatters: its Bond albedo.
fn diffuse_albedo(surface: &Surface) -> f64 {
    match surface.reflectance {
        Reflectance::None => 0.0,
        Reflectance::Lambert { bond_albedo } => bond_albedo,
        Reflectance::Hapke(hapke) => RecoilTable::cached(&hapke).bond_albedo(),
    }
}
