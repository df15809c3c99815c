//! What the 3-D view of the page is given: the shapes of a run, thinned out if they would make the page too large.
//!
//! Positions stay in the original frame, in which unmoved spheres keep their place exactly, so that a shape costs only
//! what moved; each comes with its turn into its own body frame.

use nalgebra::Vector3;
use pkd::gravity::Gravity;
use rayon::prelude::*;
use serde::Serialize;

use super::path::two_body_path;
use super::points::{Point, Steps, base64, encode};
use crate::evolve::driver::MYR_S;
use crate::report::RunData;
use crate::store::{ConfigurationRecord, LossRecord};

/// Bytes that the shapes may take in the page.
const BUDGET_BYTES: usize = 12_000_000;
/// Pairs of spheres that may be summed for the effective potentials; about ten CPU seconds.
const BUDGET_PAIRS: f64 = 1e10;
/// The tree of a large body does as much for each sphere as a sum over so many others.
const TREE_PAIRS: f64 = 4000.0;
/// How far the path of a shed sphere is drawn, in radii of the body.
const PATH_RADII: f64 = 6.0;

/// Everything that the scripts of the page read; field names are theirs.
#[derive(Debug, Serialize)]
pub struct View {
    /// Radius of a sphere around the body in all its shapes, m.
    reach: f64,
    /// Step of all coordinates, m.
    unit: f64,
    /// Whether numbers of spheres and vertices take 32 bits.
    wide: bool,
    /// Radii of all spheres, f32.
    radius: String,
    /// Vertices of each tiling.
    vertices: usize,
    /// Facets, u32, three vertices each.
    facets: String,
    /// Effective potentials that stand for 0 and 255.
    potential_m2_s2: [f64; 2],
    largest_step_m: f64,
    largest_since_first_m: f64,
    /// Number of the last configuration.
    last: i64,
    frames: Vec<Frame>,
    /// Every how many configurations one is shown.
    #[serde(skip)]
    pub stride: usize,
}

/// One shape.
#[derive(Debug, Serialize)]
struct Frame {
    /// Its number, -1 before there is one.
    configuration: i64,
    /// Name of a shape without number.
    #[serde(skip_serializing_if = "str::is_empty")]
    title: &'static str,
    t_myr: f64,
    period_h: Option<f64>,
    obliquity_deg: f64,
    /// Original to body frame, rows.
    axes: [f32; 9],
    centre: [f32; 3],
    /// Spheres whose place differs from the shape before, and their places.
    spheres: String,
    /// Spheres that moved since the shape before, by the limit of the scene.
    moved: Vec<u32>,
    /// Spheres that the shape before had.
    gone: Vec<u32>,
    vertices: String,
    /// One byte for each sphere of the body.
    potential: String,
    lost: Vec<Lost>,
}

/// A sphere that left on the way to a shape.
#[derive(Debug, Serialize)]
struct Lost {
    sphere: u32,
    speed_m_s: f64,
    /// Name of its fate; empty if it was not followed.
    fate: String,
    position: [f32; 3],
    path: Vec<[f32; 3]>,
}

/// A shape with its spin, before it is put into few bytes.
struct Shape<'a> {
    number: i64,
    title: &'static str,
    t_s: f64,
    omega: f64,
    obliquity: f64,
    ids: &'a [u32],
    positions: Vec<[f64; 3]>,
    axes: [[f64; 3]; 3],
    centre: [f64; 3],
    vertices: &'a [[f64; 3]],
    losses: Vec<(LossRecord, &'a str)>,
}

impl View {
    /// The view of `run`; `None` before there is a body.
    pub fn of(run: &RunData) -> Option<Self> {
        Self::within(run, BUDGET_BYTES)
    }

    /// The same in at most `budget` bytes, as far as two shapes fit into them.
    fn within(run: &RunData, budget: usize) -> Option<Self> {
        let shapes = shapes(run)?;
        let n = run.sphere_radius_m.len() as f64;
        let pairs = shapes.len() as f64 * n * n.min(TREE_PAIRS);
        let mut stride = ((pairs / BUDGET_PAIRS).ceil() as usize).clamp(1, shapes.len().max(2) - 1);
        loop {
            let view = Self::every(run, &shapes, stride);
            if view.bytes() <= budget || stride + 1 >= shapes.len() {
                return Some(view);
            }
            let too_much = view.bytes() as f64 / budget as f64;
            stride = ((stride as f64 * too_much).ceil() as usize).max(stride + 1).min(shapes.len() - 1);
        }
    }

    /// The view with every `stride`-th shape and the last one.
    fn every(run: &RunData, shapes: &[Shape], stride: usize) -> Self {
        let last = shapes.len() - 1;
        let shown: Vec<usize> = (0..=last).filter(|i| i % stride == 0 || *i == last).collect();
        let all_points = || shapes.iter().flat_map(|s| s.positions.iter().chain(s.vertices));
        let steps = Steps::for_points(all_points());
        let wide = run.sphere_radius_m.len().max(shapes[last].vertices.len()) > usize::from(u16::MAX);
        let potentials: Vec<Vec<f64>> = shown.par_iter().map(|i| effective_potentials(run, &shapes[*i])).collect();
        let (low, high) = (potentials.iter().flatten())
            .filter(|p| p.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
        let range = if low < high { [low, high] } else { [low.min(0.0), low.min(0.0) + 1.0] };
        let mut before = Before::new(run.sphere_radius_m.len());
        let mut frames = Vec::with_capacity(shown.len());
        let mut next = 0;
        for (i, potential) in shown.iter().zip(&potentials) {
            let lost = shapes[next..=*i].iter().flat_map(|shape| lost(run, shape)).collect();
            let mut moved: Vec<u32> =
                (next..=*i).flat_map(|k| run.movements.get(k).into_iter().flatten()).map(|m| m.sphere).collect();
            moved.sort_unstable();
            moved.dedup();
            next = i + 1;
            let level = |p: &f64| ((p - range[0]) / (range[1] - range[0]) * 255.0).round() as u8;
            let potential = base64(&potential.iter().map(level).collect::<Vec<_>>());
            frames.push(Frame { moved, ..before.advance(&shapes[*i], steps, wide, potential, lost) });
        }
        let radius = |point: &[f64; 3], shape: &Shape| (Vector3::from(*point) - Vector3::from(shape.centre)).norm();
        let largest = run.sphere_radius_m.iter().fold(0.0_f64, |a, r| a.max(*r));
        let reach = (shapes.iter())
            .flat_map(|s| {
                s.positions.iter().map(|p| radius(p, s) + largest).chain(s.vertices.iter().map(|p| radius(p, s)))
            })
            .fold(0.0, f64::max);
        Self {
            reach: if reach > 0.0 { reach } else { 1.0 },
            unit: steps.unit,
            wide,
            radius: base64(&run.sphere_radius_m.iter().flat_map(|r| (*r as f32).to_le_bytes()).collect::<Vec<_>>()),
            vertices: shapes[last].vertices.len(),
            facets: facets(run),
            potential_m2_s2: range,
            // Never zero: a logarithmic scale ends there.
            largest_step_m: before.largest_step.max(1e-3),
            largest_since_first_m: before.largest_since_first.max(1e-3),
            last: shapes[last].number,
            frames,
            stride,
        }
    }

    /// Bytes of the shapes in the page.
    fn bytes(&self) -> usize {
        let of = |f: &Frame| {
            let lost: usize = f.lost.iter().map(|l| 120 + 36 * l.path.len()).sum();
            300 + f.spheres.len() + f.vertices.len() + f.potential.len() + 6 * f.gone.len() + lost
        };
        self.radius.len() + self.facets.len() + self.frames.iter().map(of).sum::<usize>()
    }

    /// Number of shapes shown.
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    /// Whether it has tilings.
    pub fn is_tiled(&self) -> bool {
        self.vertices > 0
    }

    /// Whether spheres left.
    pub fn has_losses(&self) -> bool {
        self.frames.iter().any(|f| !f.lost.is_empty())
    }
}

fn facets(run: &RunData) -> String {
    let facets = run.tiling.iter().flat_map(|t| t.facets.iter().flatten());
    base64(&facets.flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>())
}

/// All configurations; before there is one, the aggregate as it stands.
fn shapes(run: &RunData) -> Option<Vec<Shape<'_>>> {
    if run.configurations.is_empty() {
        let state = run.state.as_ref()?;
        let s = &state.spheres;
        let total: f64 = s.mass.iter().sum();
        let mean = |x: &[f64]| x.iter().zip(&s.mass).map(|(x, m)| x * m).sum::<f64>() / total;
        return Some(vec![Shape {
            number: -1,
            title: match state.blocks {
                0 => "as constructed, not settled yet",
                _ => "settling",
            },
            t_s: 0.0,
            omega: state.omega,
            obliquity: state.obliquity,
            ids: &state.sphere_ids,
            positions: (0..s.mass.len()).map(|i| [s.x[i], s.y[i], s.z[i]]).collect(),
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            centre: [mean(&s.x), mean(&s.y), mean(&s.z)],
            vertices: &[],
            losses: losses(run, |_| true),
        }]);
    }
    let last = run.configurations.len() - 1;
    let shape = |(i, c): (usize, &'_ ConfigurationRecord)| (i, c.after_leg);
    // Legs after which a shape is there: a loss belongs to the first shape that lacks it.
    let after: Vec<(usize, Option<u32>)> = run.configurations.iter().enumerate().map(shape).collect();
    let all = run.configurations.iter().enumerate().map(|(i, c)| {
        let [omega, obliquity] = spin(run, i);
        let earlier = i.checked_sub(1).and_then(|i| after[i].1);
        let belongs = |leg: Option<u32>| match (leg, i) {
            (None, _) => i == 0,
            (Some(leg), _) => {
                earlier.is_none_or(|e| leg > e) && i > 0 && (i == last || after[i].1.is_some_and(|a| leg <= a))
            }
        };
        Shape {
            number: i as i64,
            title: "",
            t_s: c.t_s,
            omega,
            obliquity,
            ids: &c.sphere_ids,
            positions: c.positions.clone(),
            axes: c.body_axes,
            centre: c.centre_of_mass,
            vertices: &c.vertices,
            losses: losses(run, belongs),
        }
    });
    Some(all.collect())
}

/// Spin rate and obliquity with which a configuration begins.
fn spin(run: &RunData, configuration: usize) -> [f64; 2] {
    let first = run.legs.partition_point(|leg| (leg.configuration as usize) < configuration);
    match (run.legs.get(first), &run.state) {
        (Some(leg), _) if leg.configuration as usize == configuration => [leg.omega[0], leg.obliquity[0]],
        (_, Some(state)) => [state.omega, state.obliquity],
        (_, None) => [0.0; 2],
    }
}

/// The losses of the legs that `belong`, each with the name of its fate.
fn losses(run: &RunData, belongs: impl Fn(Option<u32>) -> bool) -> Vec<(LossRecord, &str)> {
    let fate = |leg: Option<u32>, sphere: u32| {
        let found = run.fates.iter().find(|(of, f)| *of == leg && f.sphere == sphere);
        found.map_or("", |(_, f)| f.fate.as_ref())
    };
    run.losses.iter().filter(|(leg, _)| belongs(*leg)).map(|(leg, l)| (*l, fate(*leg, l.sphere))).collect()
}

fn lost(run: &RunData, shape: &Shape) -> Vec<Lost> {
    let radius = |p: &[f64; 3]| (Vector3::from(*p) - Vector3::from(shape.centre)).norm();
    let (inner, outer) =
        (shape.positions.iter().map(radius)).fold((0.0_f64, 0.0_f64), |(sum, max), r| (sum + r, max.max(r)));
    let inner = inner / shape.positions.len().max(1) as f64;
    let mass: f64 = shape.ids.iter().map(|s| run.sphere_mass_kg[*s as usize]).sum();
    let single = |p: [f64; 3]| p.map(|c| (c * 10.0).round() as f32 / 10.0);
    let path = |l: &LossRecord| {
        let path = two_body_path(pkd::constants::G * mass, [l.position, l.velocity], [inner, PATH_RADII * outer]);
        path.into_iter().map(single).collect()
    };
    let one = |(l, fate): &(LossRecord, &str)| Lost {
        sphere: l.sphere,
        speed_m_s: Vector3::from(l.velocity).norm(),
        fate: (*fate).to_owned(),
        position: single(l.position),
        path: path(l),
    };
    shape.losses.iter().map(one).collect()
}

/// Effective potential of each sphere of a shape, m^2/s^2, in the frame that turns with it.
fn effective_potentials(run: &RunData, shape: &Shape) -> Vec<f64> {
    let column = |k: usize| shape.positions.iter().map(|p| p[k]).collect::<Vec<_>>();
    let mass: Vec<f64> = shape.ids.iter().map(|s| run.sphere_mass_kg[*s as usize]).collect();
    let mut potential = Vec::new();
    // The default error of a thousandth is far below a step of the colours.
    Gravity::default().potentials(&column(0), &column(1), &column(2), &mass, &mut potential);
    let omega = Vector3::from(shape.axes[2]) * shape.omega;
    for (phi, p) in potential.iter_mut().zip(&shape.positions) {
        *phi -= 0.5 * omega.cross(&(Vector3::from(*p) - Vector3::from(shape.centre))).norm_squared();
    }
    potential
}

/// The shape before, as the page has decoded it.
struct Before {
    spheres: Vec<Option<Point>>,
    first: Option<Vec<Option<Point>>>,
    vertices: Vec<Point>,
    largest_step: f64,
    largest_since_first: f64,
}

impl Before {
    fn new(spheres: usize) -> Self {
        let spheres = vec![None; spheres];
        Self { spheres, first: None, vertices: Vec::new(), largest_step: 0.0, largest_since_first: 0.0 }
    }

    fn advance(&mut self, shape: &Shape, steps: Steps, wide: bool, potential: String, lost: Vec<Lost>) -> Frame {
        let distance = |a: Point, b: Point| {
            let squares = a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(b)).powi(2));
            squares.sum::<f64>().sqrt() * steps.unit
        };
        let mut now = vec![None; self.spheres.len()];
        let mut changed = Vec::new();
        for (id, position) in shape.ids.iter().zip(&shape.positions) {
            let (sphere, point) = (*id as usize, steps.of(position));
            now[sphere] = Some(point);
            if self.spheres[sphere] != Some(point) {
                changed.push((*id, point));
            }
            if let Some(earlier) = self.spheres[sphere] {
                self.largest_step = self.largest_step.max(distance(point, earlier));
            }
            if let Some(first) = self.first.as_ref().and_then(|f| f[sphere]) {
                self.largest_since_first = self.largest_since_first.max(distance(point, first));
            }
        }
        let gone = (0..now.len() as u32).filter(|s| self.spheres[*s as usize].is_some() && now[*s as usize].is_none());
        let gone = gone.collect();
        let vertices: Vec<Point> = shape.vertices.iter().map(|v| steps.of(v)).collect();
        let moved = |(i, v): &(usize, &Point)| self.vertices.get(*i) != Some(*v);
        let changed_vertices: Vec<_> = vertices.iter().enumerate().filter(moved).map(|(i, v)| (i as u32, *v)).collect();
        self.vertices = vertices;
        self.spheres = now;
        self.first.get_or_insert_with(|| self.spheres.clone());
        Frame {
            configuration: shape.number,
            title: shape.title,
            t_myr: shape.t_s / MYR_S,
            period_h: RunData::period_h(shape.omega),
            obliquity_deg: shape.obliquity.to_degrees(),
            axes: std::array::from_fn(|i| shape.axes[i / 3][i % 3] as f32),
            centre: shape.centre.map(|c| c as f32),
            spheres: encode(&changed, wide),
            moved: Vec::new(),
            gone,
            vertices: encode(&changed_vertices, wide),
            potential,
            lost,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::RunStore;

    /// Three spheres of which the last one moves in configuration 1 and leaves before configuration 2, and so on again.
    fn run(configurations: u32) -> RunData {
        let folder = tempfile::tempdir().unwrap();
        let body = crate::scene::Body::File(crate::scene::FileBody { path: "a.csv".into() });
        drop(RunStore::open(folder.path(), &crate::scene::Scene::from_body(body), false).unwrap());
        let mut run = RunData::read(folder.path()).unwrap();
        run.sphere_radius_m = vec![10.0; 4];
        run.sphere_mass_kg = vec![1e9; 4];
        run.configurations = (0..configurations).map(configuration).collect();
        run.movements = vec![Vec::new(); configurations as usize];
        run
    }

    fn configuration(number: u32) -> ConfigurationRecord {
        let n = f64::from(number);
        let all = [[-30.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, 40.0, 0.0], [0.0, 0.0, 20.0 + n]];
        let spheres = if number < 2 { 4 } else { 3 };
        ConfigurationRecord {
            configuration: number,
            after_leg: number.checked_sub(1),
            t_s: n * MYR_S,
            mass_kg: 1e9 * spheres as f64,
            sphere_ids: (0..spheres as u32).collect(),
            positions: all[..spheres].to_vec(),
            body_axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            centre_of_mass: [0.0; 3],
            moments_kg_m2: [1.0; 3],
            b1_axes_m: [1.0; 3],
            b2_axes_m: [1.0; 3],
            densities_kg_m3: [1.0; 4],
            vertices: vec![[50.0, 0.0, n], [0.0, 50.0, 0.0]],
            vertices_kept: 1,
            vertices_flagged: 0,
            facets_folded: 0,
            torque: crate::store::TorqueRecord {
                obliquity: vec![],
                spin_rate: vec![],
                spin_torque: vec![],
                obliquity_torque: vec![],
                spin_torque_error: 0.0,
                obliquity_torque_error: 0.0,
            },
        }
    }

    /// Bytes of numbered points in base64.
    fn coded(points: usize) -> usize {
        (points * 8).div_ceil(3) * 4
    }

    #[test]
    fn a_shape_costs_what_differs_from_the_one_before() {
        let view = View::of(&run(3)).unwrap();
        let sizes: Vec<_> = view.frames.iter().map(|f| (f.spheres.len(), f.vertices.len(), f.gone.clone())).collect();
        assert_eq!(sizes[0], (coded(4), coded(2), vec![]));
        assert_eq!(sizes[1], (coded(1), coded(1), vec![]));
        assert_eq!(sizes[2], (coded(0), coded(1), vec![3]));
        assert!((view.largest_step_m - 1.0).abs() < view.unit);
        assert!(view.reach >= 50.0 && view.reach < 51.0);
        assert!(!view.wide && view.stride == 1);
    }

    #[test]
    fn too_many_shapes_are_thinned_out_and_the_last_one_stays() {
        let run = run(100);
        let whole = View::of(&run).unwrap();
        let thinned = View::within(&run, whole.bytes() / 3).unwrap();
        assert!(thinned.bytes() <= whole.bytes() / 3 && thinned.stride >= 3);
        let shown: Vec<_> = thinned.frames.iter().map(|f| f.configuration).collect();
        assert_eq!((shown[0], shown[1], *shown.last().unwrap()), (0, thinned.stride as i64, 99));
        // Never fewer than the first and the last one.
        assert_eq!(View::within(&run, 1).unwrap().frames.len(), 2);
    }

    /// -G m (1/60 + 1/50 + ...) less half the squared speed of turning: highest where the body is least bound.
    #[test]
    fn potentials_span_the_colours() {
        let view = View::of(&run(1)).unwrap();
        let [low, high] = view.potential_m2_s2;
        let pair = |d: f64| 1e9 * pkd::constants::G / d;
        let of_first = -(pair(60.0) + pair(50.0) + pair(1300.0_f64.sqrt()));
        assert!(low < high && low <= of_first && of_first <= high);
    }

    #[test]
    fn a_loss_belongs_to_the_first_shape_without_it() {
        let mut run = run(3);
        let loss = LossRecord {
            sphere: 3,
            t_s: 2.0 * MYR_S,
            omega: 3e-4,
            position: [100.0, 0.0, 0.0],
            velocity: [0.0, 0.1, 0.0],
            spin: [0.0; 3],
            energy_j: 1.0,
        };
        run.losses = vec![(Some(1), loss)];
        let view = View::of(&run).unwrap();
        assert_eq!(view.frames.iter().map(|f| f.lost.len()).collect::<Vec<_>>(), [0, 0, 1]);
        run.losses = vec![(None, loss)];
        assert_eq!(View::of(&run).unwrap().frames[0].lost.len(), 1);
    }
}
