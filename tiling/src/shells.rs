//! The closed shells that a mesh consists of, and whether each is oriented as its place asks.
//!
//! The outermost shell of a body faces outward, a void in it inward, a body that floats in the void outward, and so on: the
//! winding number of every point is then 0 outside and in voids and 1 in the material, so that volume integrals count
//! everything once. The sign of the total volume tells nothing about the single shells.

use crate::inside::Inside;
use crate::{Mesh, TilingError};

/// The closed shells of a mesh that bounds a body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shells {
    /// Of each facet, its shell; shells are counted in the order of their first facets.
    pub of_facet: Vec<usize>,
    /// Of each shell, how many others are around it: odd for voids.
    pub depth: Vec<usize>,
}

impl Shells {
    /// Shells that lie in no other one: more than one are bodies apart.
    pub fn outermost(&self) -> usize {
        self.depth.iter().filter(|depth| **depth == 0).count()
    }

    /// Voids in the material.
    pub fn voids(&self) -> usize {
        self.depth.iter().filter(|depth| **depth % 2 == 1).count()
    }
}

impl Mesh {
    /// Checks all that a body needs: [`Mesh::check_contact`] and a closed surface as [`Mesh::check`] does, but each shell
    /// judged on its own: oriented as its place among the others asks, and moments of inertia that are finite and positive.
    ///
    /// # Errors
    /// The fault, with its facets.
    ///
    /// # Examples
    /// ```
    /// let mesh = tiling::fibonacci::unit_sphere(100)?;
    /// assert_eq!(mesh.check_body()?.outermost(), 1);
    /// # Ok::<(), tiling::TilingError>(())
    /// ```
    pub fn check_body(&self) -> Result<Shells, TilingError> {
        self.check_surface()?;
        let (of_facet, count) = self.connected();
        if count == 1 {
            self.check()?;
        }
        // Before the nesting, which is judged by single points.
        self.check_contact()?;
        let depth = if count == 1 { vec![0] } else { self.nesting(&of_facet, count) };
        let volumes = self.shell_volumes(&of_facet, count);
        let wrong = |shell: &usize| {
            let should_be_positive = depth[*shell].is_multiple_of(2);
            !(volumes[*shell] != 0.0 && (volumes[*shell] > 0.0) == should_be_positive)
        };
        if let Some(shell) = (0..count).find(wrong) {
            let facets = (0..self.facets.len()).filter(|f| of_facet[*f] == shell).collect();
            return Err(TilingError::ShellOrientation { depth: depth[shell], facets });
        }
        self.check_inertia()?;
        Ok(Shells { of_facet, depth })
    }

    /// Volume and moments that overflow or vanish, in coordinates of a wrong unit for example, would go on as infinities.
    fn check_inertia(&self) -> Result<(), TilingError> {
        let solid = self.solid();
        let finite = solid.inertia.iter().chain(&solid.centre_of_mass).all(|v| v.is_finite());
        let moments = if finite { solid.principal_axes().moments } else { [f64::NAN; 3] };
        let normal = |v: f64| v.is_normal() && v > 0.0;
        if normal(solid.volume) && moments.into_iter().all(normal) {
            return Ok(());
        }
        Err(TilingError::NoInertia { volume_m3: solid.volume, moment_m5: solid.inertia.trace() })
    }

    /// Of each facet the shell that it is connected with over edges, and the number of shells.
    fn connected(&self) -> (Vec<usize>, usize) {
        let mut parent: Vec<u32> = (0..self.facets.len() as u32).collect();
        fn root(parent: &mut [u32], mut f: u32) -> u32 {
            while parent[f as usize] != f {
                parent[f as usize] = parent[parent[f as usize] as usize];
                f = parent[f as usize];
            }
            f
        }
        for (_, left, right) in self.edge_neighbours() {
            let (a, b) = (root(&mut parent, left as u32), root(&mut parent, right as u32));
            // The smaller number is the root, so that shells come in the order of their first facets.
            parent[a.max(b) as usize] = a.min(b);
        }
        let mut shells = vec![0; self.facets.len()];
        let mut count = 0;
        for f in 0..shells.len() {
            let first = root(&mut parent, f as u32) as usize;
            shells[f] = if first == f { count } else { shells[first] };
            count += usize::from(first == f);
        }
        (shells, count)
    }

    /// Signed volume of each shell, m^3, from a point of its own, so that one far away loses no digits.
    fn shell_volumes(&self, of_facet: &[usize], count: usize) -> Vec<f64> {
        let mut volumes = vec![0.0; count];
        let mut apexes = vec![None; count];
        for (f, shell) in of_facet.iter().enumerate() {
            let [a, b, c] = self.corners(f);
            let apex = *apexes[*shell].get_or_insert(a);
            volumes[*shell] += (a - apex).dot(&(b - apex).cross(&(c - apex))) / 6.0;
        }
        volumes
    }

    /// Of each shell of a mesh without contacts, how many others are around it.
    fn nesting(&self, of_facet: &[usize], count: usize) -> Vec<usize> {
        let grid = Inside::of_surface(self.clone());
        let mut depth = vec![0; count];
        let mut seen = 0;
        let mut around: Vec<(usize, i32)> = Vec::new();
        for (f, &shell) in of_facet.iter().enumerate() {
            // The first facet of each shell; shells do not touch, so that any point of one stands for it.
            if shell < seen {
                continue;
            }
            seen += 1;
            around.clear();
            let crossings = grid.crossings(self.vertices[self.facets[f][0] as usize]);
            around.extend(crossings.map(|(g, crossing)| (of_facet[g], crossing)).filter(|(other, _)| *other != shell));
            around.sort_unstable_by_key(|(other, _)| *other);
            depth[shell] = (around.chunk_by(|a, b| a.0 == b.0))
                .filter(|group| group.iter().map(|(_, crossing)| crossing).sum::<i32>() != 0)
                .count();
        }
        depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::cuboid;

    /// A cube of this side about `centre`, facing outward or inward.
    fn cube(side: f64, centre: [f64; 3], outward: bool) -> Mesh {
        let mut mesh = cuboid(side, side, side).translated(centre.map(|c| c - 0.5 * side));
        if !outward {
            mesh.facets.iter_mut().for_each(|f| f.swap(0, 1));
        }
        mesh
    }

    fn all(meshes: &[Mesh]) -> Mesh {
        meshes.iter().fold(Mesh::default(), |mut all, mesh| {
            let offset = all.vertices.len() as u32;
            all.vertices.extend(&mesh.vertices);
            all.facets.extend(mesh.facets.iter().map(|f| f.map(|v| v + offset)));
            all
        })
    }

    const O: [f64; 3] = [0.0; 3];
    const FAR: [f64; 3] = [20.0, 0.1, 0.2];

    #[test]
    fn shells_are_judged_by_their_nesting() {
        let (outer, void, core) = (cube(8.0, O, true), cube(4.0, O, false), cube(2.0, O, true));
        let one = outer.check_body().unwrap();
        assert_eq!((one.outermost(), one.voids()), (1, 0));
        let hollow = all(&[void.clone(), outer.clone(), core.clone()]);
        let shells = hollow.check_body().unwrap();
        assert_eq!((&shells.depth[..], shells.outermost(), shells.voids()), (&[1, 0, 2][..], 1, 1));
        assert_eq!((shells.of_facet[0], shells.of_facet[12], shells.of_facet[35]), (0, 1, 2));
        assert!((hollow.volume() - (512.0 - 64.0 + 8.0)).abs() < 1e-10);
        let apart = all(&[outer.clone(), cube(3.0, FAR, true)]).check_body().unwrap();
        assert_eq!((apart.outermost(), apart.voids()), (2, 0));
        // Two voids side by side, one of them with a body.
        let side = |x: f64, s: f64, out| cube(s, [x, 0.2, 0.1], out);
        let cheese = all(&[outer, side(-2.0, 2.5, false), side(2.0, 2.5, false), side(2.0, 1.0, true)]);
        assert_eq!(cheese.check_body().unwrap().depth, [0, 1, 1, 2]);
    }

    #[test]
    fn a_shell_that_faces_the_wrong_way_is_named_with_its_facets() {
        let first = |mesh: Mesh| match mesh.check_body().unwrap_err() {
            TilingError::ShellOrientation { depth, facets } => (depth, facets[0], facets.len()),
            other => panic!("{other:?}"),
        };
        let outer = cube(8.0, O, true);
        assert_eq!(first(all(&[outer.clone(), cube(3.0, FAR, false)])), (0, 12, 12));
        // The inverted one is the larger: the total volume is negative.
        assert_eq!(first(all(&[cube(3.0, FAR, true), cube(8.0, O, false)])), (0, 12, 12));
        assert_eq!(first(all(&[outer.clone(), cube(3.0, O, true)])), (1, 12, 12));
        assert_eq!(first(all(&[outer.clone(), cube(4.0, O, false), cube(2.0, O, false)])), (2, 24, 12));
        let fault = all(&[outer, cube(3.0, FAR, false)]).check_body().unwrap_err().to_string();
        assert!(fault.contains("facets 13, 14") && fault.contains("inward, but must be outward"), "{fault}");
    }

    #[test]
    fn shells_that_cross_are_a_contact_and_a_single_one_inside_out_is_called_so() {
        let crossing = all(&[cube(8.0, O, true), cube(8.0, [3.0, 2.0, 1.0], true)]);
        assert!(matches!(crossing.check_body(), Err(TilingError::SelfContact { .. })));
        assert!(matches!(cube(2.0, O, false).check_body(), Err(TilingError::InsideOut { .. })));
    }

    #[test]
    fn moments_that_overflow_or_vanish_are_refused() {
        for side in [1e62, 1e80, 1e-62, 1e-70] {
            let mesh = cube(1.0, O, true).scaled(side);
            let fault = mesh.check_body().unwrap_err();
            assert!(
                !(1e-65..1e70).contains(&side) || matches!(fault, TilingError::NoInertia { .. }),
                "{side}: {fault:?}"
            );
        }
        for side in [1e-50, 1e50] {
            assert!(cube(1.0, O, true).scaled(side).check_body().is_ok());
        }
    }
}
