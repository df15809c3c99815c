//! What becomes of spheres that left the body, where the scene asks for it: followed with REBOUND from the moment at which
//! they are found to have left.

use nalgebra::{Rotation3, Vector3};
use pkd::Spheres;
use pkd::frame::{add_angular_momentum, recentre};
use pkd::mass_properties::mass_properties;
use pkd::soft_sphere::ContactHistory;

use super::EvolveError;
use super::block::Aggregate;
use super::engine::ContactLaw;
use super::shedding::{Breakup, Departure, Departures};
use crate::scene::{Rebound, Scene, Track};
use crate::shed::{Elements, Fate, PairFate, Primary, ShedBody, TrackOptions, follow, follow_pair};
use crate::store::{FateRecord, FissionRecord, LossRecord, Shedding};

/// Books what left `body` at the end of a block, and follows it if the scene asks for it.
///
/// Spheres that fall back are put back into `body` if the scene asks for that; they are no losses then. What does not come back
/// takes its angular momentum along, all else stays with the body: what shed spheres exert on it in flight, too.
/// `t_s` and `omega` are the evolution time and the spin rate at which it left.
///
/// # Errors
/// The orbits cannot be followed.
pub fn shed(
    scene: &Scene,
    body: &mut Aggregate,
    departures: &Departures,
    [t_s, omega, obliquity]: [f64; 3],
) -> Result<Shedding, EvolveError> {
    let mut shedding = Shedding { angular_momentum_change: -departures.angular_momentum, ..Shedding::default() };
    if let Track::Rebound(rebound) = &scene.shed.track
        && !departures.spheres.is_empty()
    {
        let options = rebound.to_shed(&scene.orbit, obliquity);
        match departures.breakup {
            None => {
                let whole = mass_properties(&body.spheres)?.angular_momentum + departures.angular_momentum;
                shedding.fates = fates(scene, rebound, &options, body, &departures.spheres)?;
                let taken =
                    shedding.fates.iter().filter_map(|f| f.angular_momentum).map(Vector3::from).sum::<Vector3<f64>>();
                shedding.angular_momentum_change = -taken;
                // The integration of the orbits makes an error, and the body was taken as rigid and unmoved meanwhile: what is
                // left over is the torque that it felt.
                let now = mass_properties(&body.spheres)?.angular_momentum;
                add_angular_momentum(&mut body.spheres, whole - taken - now)?;
            }
            Some(Breakup::Fission) => shedding.fission = Some(fission(&options, body, &departures.spheres)?),
            // What is left of the body is no primary any more.
            Some(Breakup::Disrupted) => {}
        }
    }
    let returned = |d: &&Departure| shedding.fates.iter().any(|f| f.returned && f.sphere == d.sphere);
    let lost = departures.spheres.iter().filter(|d| !returned(d));
    shedding.losses = lost.map(|d| loss(d, t_s, omega)).collect();
    Ok(shedding)
}

fn loss(d: &Departure, t_s: f64, omega: f64) -> LossRecord {
    let Departure { sphere, position, velocity, spin, energy_j, .. } = *d;
    LossRecord { sphere, t_s, omega, position, velocity, spin, energy_j }
}

/// Follows each sphere that left, and puts back those that return.
fn fates(
    scene: &Scene,
    rebound: &Rebound,
    options: &TrackOptions,
    body: &mut Aggregate,
    departures: &[Departure],
) -> Result<Vec<FateRecord>, EvolveError> {
    let omega = mass_properties(&body.spheres)?.angular_velocity();
    let to_equator = to_equator(omega);
    let turned = |v: [f64; 3]| -> [f64; 3] { (to_equator * Vector3::from(v)).into() };
    let back = |v: [f64; 3]| -> [f64; 3] { (to_equator.inverse() * Vector3::from(v)).into() };
    let mut spheres = body.spheres.clone();
    for i in 0..spheres.len() {
        let position = turned(spheres.position(i));
        spheres.set(i, position, [0.0; 3], [0.0; 3]);
    }
    let shed: Vec<ShedBody> = departures
        .iter()
        .map(|d| ShedBody {
            position: turned(d.position),
            velocity: turned(d.velocity),
            spin: turned(d.spin),
            mass: d.mass,
            radius: d.radius,
        })
        .collect();
    let tracks = follow(&Primary { spheres, spin_rate: omega.norm() }, &shed, options)?;
    let merged_into: Vec<Option<usize>> = tracks
        .fates
        .iter()
        .map(|f| match f {
            Fate::Merged { into, .. } => Some(*into),
            _ => None,
        })
        .collect();
    let mut returning: Vec<(&Departure, [f64; 3], [f64; 3])> = Vec::new();
    let mut records = Vec::new();
    for (k, (departure, fate)) in departures.iter().zip(&tracks.fates).enumerate() {
        let mut record = FateRecord {
            sphere: departure.sphere,
            fate: fate.name().into(),
            t_s: 0.0,
            speed_m_s: None,
            position: None,
            orbit: None,
            within_3_radii: None,
            into: None,
            returned: false,
            angular_momentum: None,
        };
        let end = survivor(&merged_into, k);
        record.returned = rebound.return_reimpacts && matches!(tracks.fates[end], Fate::Reimpact { .. });
        if !record.returned {
            record.angular_momentum = tracks.angular_momentum[k].map(back);
        }
        match *fate {
            Fate::Reimpact { t_s, speed_m_s, position_m, velocity_m_s, .. } => {
                (record.t_s, record.speed_m_s) = (t_s, Some(speed_m_s));
                let position = back(position_m);
                record.position = Some(position);
                if record.returned {
                    let velocity = Vector3::from(back(velocity_m_s)) + omega.cross(&Vector3::from(position));
                    let members = (0..departures.len()).filter(|m| survivor(&merged_into, *m) == k);
                    let members: Vec<&Departure> = members.map(|m| &departures[m]).collect();
                    returning
                        .extend(pile(&members, position).into_iter().map(|(member, at)| (member, at, velocity.into())));
                }
            }
            Fate::Escape { t_s, speed_m_s } => (record.t_s, record.speed_m_s) = (t_s, Some(speed_m_s)),
            Fate::Bound { t_s, mean, within_3_radii } => {
                (record.t_s, record.within_3_radii) = (t_s, Some(within_3_radii));
                record.orbit = mean.map(orbit);
            }
            Fate::Merged { t_s, speed_m_s, into } => {
                (record.t_s, record.speed_m_s) = (t_s, Some(speed_m_s));
                record.into = departures.get(into).map(|d| d.sphere);
            }
        }
        records.push(record);
    }
    if !returning.is_empty() {
        put_back(scene, body, &returning)?;
    }
    Ok(records)
}

/// Whom a body went on in after all mergers.
fn survivor(merged_into: &[Option<usize>], mut k: usize) -> usize {
    while let Some(into) = merged_into[k] {
        k = into;
    }
    k
}

/// The places of the spheres of a body that fell back with its centre at `position`: the heaviest there, the others outwards on
/// top of each other, in the order of their masses. They settle by themselves.
fn pile<'a>(members: &[&'a Departure], position: [f64; 3]) -> Vec<(&'a Departure, [f64; 3])> {
    let mut sorted = members.to_vec();
    sorted.sort_by(|a, b| b.mass.total_cmp(&a.mass).then(a.sphere.cmp(&b.sphere)));
    let position = Vector3::from(position);
    let outwards = position.try_normalize(0.0).unwrap_or_else(Vector3::z);
    let (mut height, mut below) = (0.0, 0.0);
    let mut placed = Vec::with_capacity(sorted.len());
    for member in sorted {
        height += if placed.is_empty() { 0.0 } else { below + member.radius };
        below = member.radius;
        placed.push((member, (position + outwards * height).into()));
    }
    placed
}

/// Puts spheres back into the body, in the order of their identities.
fn put_back(
    scene: &Scene,
    body: &mut Aggregate,
    returning: &[(&Departure, [f64; 3], [f64; 3])],
) -> Result<(), EvolveError> {
    let (old, ids) = (std::mem::take(&mut body.spheres), std::mem::take(&mut body.ids));
    let mut rows: Vec<_> = ids
        .iter()
        .enumerate()
        .map(|(i, id)| (*id, old.position(i), old.velocity(i), old.spin(i), old.mass[i], old.radius[i]))
        .chain(
            returning.iter().map(|(d, position, velocity)| (d.sphere, *position, *velocity, d.spin, d.mass, d.radius)),
        )
        .collect();
    rows.sort_by_key(|row| row.0);
    for (id, position, velocity, spin, mass, radius) in rows {
        body.ids.push(id);
        body.spheres.push(position, velocity, spin, mass, radius);
    }
    body.contacts =
        body.contacts.renumbered(|row| body.ids.binary_search(&ids[row as usize]).expect("still there") as u32);
    // Two that fall onto the same place at different times would overlap.
    if ContactLaw::of(scene).part_overlaps(&mut body.spheres)?.is_some() {
        body.contacts = ContactHistory::default();
    }
    recentre(&mut body.spheres)?;
    Ok(())
}

/// Follows the heaviest piece that left and the body as two rigid aggregates.
fn fission(options: &TrackOptions, body: &Aggregate, departures: &[Departure]) -> Result<FissionRecord, EvolveError> {
    let mut piece = Spheres::default();
    let mut ids = Vec::new();
    for d in departures.iter().filter(|d| d.cluster == 1) {
        piece.push(d.position, d.velocity, d.spin, d.mass, d.radius);
        ids.push(d.sphere);
    }
    let track = follow_pair(&body.spheres, &piece, options)?;
    let (speed_m_s, orbit) = match track.fate {
        PairFate::Collided { speed_m_s } | PairFate::Separated { speed_m_s } => (Some(speed_m_s), None),
        PairFate::Bound { mean } => (None, mean.map(orbit)),
    };
    Ok(FissionRecord {
        mass_kg: [body.spheres.total_mass(), piece.total_mass()],
        spheres: ids,
        fate: track.fate.name().into(),
        t_s: track.t_s,
        speed_m_s,
        orbit,
        spin_rate: track.spin_rate,
    })
}

fn orbit(mean: Elements) -> [f64; 3] {
    [mean.semimajor_axis_m, mean.eccentricity, mean.inclination]
}

/// The rotation that takes the spin to +z.
fn to_equator(omega: Vector3<f64>) -> Rotation3<f64> {
    let upside_down = || Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    Rotation3::rotation_between(&omega, &Vector3::z()).unwrap_or_else(upside_down)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evolve::shedding::{Parting, departures};
    use crate::scene::{Body, FileBody};
    use pkd::frame::set_rigid_rotation;

    /// A block of 64 touching spheres that turns about y, and one more thrown straight up from its top.
    fn thrown(speed: f64) -> (Aggregate, Departures) {
        let mut spheres = Spheres::default();
        let at = |n: i32| 20.0 * f64::from(n) - 30.0;
        for k in 0..64 {
            spheres.push([at(k % 4), at(k / 4 % 4), at(k / 16)], [0.0; 3], [0.0; 3], 1e9, 10.0);
        }
        set_rigid_rotation(&mut spheres, Vector3::new(0.0, 2e-4, 0.0)).unwrap();
        spheres.push([3.0, 80.0, 1.0], [0.0, speed, 0.0], [0.0; 3], 1e7, 10.0);
        let mut body = Aggregate { spheres, ids: (0..65).collect(), contacts: ContactHistory::default() };
        let found = departures(&body.spheres.clone(), &body, &Parting::default()).unwrap();
        assert_eq!(found.spheres.len(), 1);
        found.remove_from(&mut body).unwrap();
        (body, found)
    }

    fn scene(rebound: Rebound) -> Scene {
        let mut scene = Scene::from_body(Body::File(FileBody { path: "a.csv".into() }));
        scene.shed.track = Track::Rebound(rebound);
        scene
    }

    #[test]
    fn what_falls_back_returns_where_it_struck_if_the_scene_wants_it() {
        for return_reimpacts in [false, true] {
            let (mut body, found) = thrown(0.1);
            let scene = scene(Rebound { return_reimpacts, ..Rebound::default() });
            let shedding = shed(&scene, &mut body, &found, [5.0, 2e-4, 0.1]).unwrap();
            assert_eq!((shedding.fates[0].fate.as_ref(), shedding.fates[0].returned), ("reimpact", return_reimpacts));
            assert_eq!(shedding.losses.len(), usize::from(!return_reimpacts));
            assert_eq!(body.ids.len(), 64 + usize::from(return_reimpacts));
            if return_reimpacts {
                // Thrown along the spin axis: it comes down where it started, on the top layer.
                let [x, y, z] = body.spheres.position(64);
                assert!((40.0..60.0).contains(&y), "{y}");
                assert!(x.hypot(z) < 20.0 && body.spheres.velocity(64)[1] < -0.05);
                assert_eq!(pkd::clusters::clusters(&body.spheres, 0.05).len(), 1);
            }
        }
    }

    /// Thrown straight up one after the other, they meet in the air and come down together.
    #[test]
    fn spheres_that_merged_and_fell_back_together_return_all_with_mass_and_angular_momentum() {
        let (mut body, _) = thrown(0.1);
        let mut spheres = body.spheres.clone();
        for (y, speed) in [(75.0, 0.2), (97.0, 0.12)] {
            spheres.push([3.0, y, 1.0], [0.01, speed, 0.0], [1e-4, 0.0, 2e-4], 1e7, 10.0);
        }
        body = Aggregate { spheres, ids: (0..66).collect(), contacts: ContactHistory::default() };
        let (mass, before) = (body.spheres.total_mass(), mass_properties(&body.spheres).unwrap().angular_momentum);
        let found = departures(&body.spheres.clone(), &body, &Parting::default()).unwrap();
        assert_eq!(found.spheres.len(), 2);
        found.remove_from(&mut body).unwrap();
        let scene = scene(Rebound { return_reimpacts: true, ..Rebound::default() });
        let shedding = shed(&scene, &mut body, &found, [0.0, 2e-4, 0.1]).unwrap();
        let fates: Vec<&str> = shedding.fates.iter().map(|f| f.fate.as_ref()).collect();
        assert!(fates.contains(&"merged") && fates.contains(&"reimpact"), "{fates:?}");
        assert!(shedding.fates.iter().all(|f| f.returned) && shedding.losses.is_empty());
        assert_eq!((body.ids.len(), body.spheres.total_mass()), (66, mass));
        let after = mass_properties(&body.spheres).unwrap().angular_momentum;
        assert!((after - before).norm() < 1e-14 * before.norm(), "{:e}", (after - before).norm() / before.norm());
    }

    /// What escapes takes mu r x v and its spin along; the rest stays.
    #[test]
    fn what_escapes_takes_the_angular_momentum_that_its_record_says() {
        let (mut body, found) = thrown(2.0);
        let whole = mass_properties(&body.spheres).unwrap().angular_momentum + found.angular_momentum;
        let shedding = shed(&scene(Rebound::default()), &mut body, &found, [0.0; 3]).unwrap();
        let taken = Vector3::from(shedding.fates[0].angular_momentum.unwrap());
        let after = mass_properties(&body.spheres).unwrap().angular_momentum;
        assert!((whole - taken - after).norm() < 1e-14 * whole.norm());
        assert_eq!(shedding.angular_momentum_change, -taken);
        // The torque on the body on the way is what a tenth of a percent of the mass exerts within minutes.
        assert!((taken - found.angular_momentum).norm() < 1e-3 * whole.norm());
    }

    #[test]
    fn what_is_too_fast_escapes_and_nothing_is_followed_unless_asked_for() {
        let (mut body, found) = thrown(2.0);
        let shedding = shed(&scene(Rebound::default()), &mut body, &found, [0.0; 3]).unwrap();
        assert_eq!((shedding.fates[0].fate.as_ref(), shedding.losses.len()), ("escape", 1));
        let (mut body, found) = thrown(2.0);
        let plain = Scene::from_body(Body::File(FileBody { path: "a.csv".into() }));
        let shedding = shed(&plain, &mut body, &found, [0.0; 3]).unwrap();
        assert!(shedding.fates.is_empty() && shedding.losses.len() == 1);
    }

    #[test]
    fn pieces_of_a_fission_are_followed_as_rigid_bodies() {
        let mut spheres = Spheres::default();
        for (piece, side) in [(0.0, 1.0), (150.0, -1.0)] {
            for k in 0..27 {
                let at = |n: i32| 20.0 * f64::from(n - 1);
                spheres.push([piece + at(k % 3), at(k / 3 % 3), at(k / 9)], [0.0, side, 0.0], [0.0; 3], 1e9, 10.0);
            }
        }
        spheres.push([0.0, 0.0, 40.0], [0.0, 1.0, 0.0], [0.0; 3], 1e9, 10.0);
        let mut body = Aggregate { spheres, ids: (0..55).collect(), contacts: ContactHistory::default() };
        let found = departures(&body.spheres.clone(), &body, &Parting::default()).unwrap();
        assert_eq!(found.breakup, Some(Breakup::Fission));
        found.remove_from(&mut body).unwrap();
        let shedding = shed(&scene(Rebound::default()), &mut body, &found, [0.0; 3]).unwrap();
        let fission = shedding.fission.unwrap();
        assert_eq!((fission.fate.as_ref(), fission.spheres.len(), shedding.losses.len()), ("separated", 27, 27));
        assert_eq!(fission.mass_kg, [28e9, 27e9]);
    }
}
