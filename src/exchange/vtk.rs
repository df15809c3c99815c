//! Aggregates and meshes as VTK PolyData (`.vtp`), for ParaView and its kin.
//!
//! XML with the arrays appended raw, little-endian, each after its length in bytes as a 64-bit integer. Units are SI and
//! stand in the array names.

use pkd::Spheres;
use std::fmt::Write as _;
use tiling::Mesh;

/// An aggregate: one point (and vertex cell) a sphere, with radius, mass, velocity, spin and number as point data.
///
/// In ParaView, a sphere glyph scaled by `radius_m` with factor 2 shows it.
pub fn spheres_vtp(spheres: &Spheres) -> Vec<u8> {
    let count = spheres.len();
    let vectors = |of: fn(&Spheres, usize) -> [f64; 3]| (0..count).map(|i| of(spheres, i)).collect::<Vec<_>>();
    let arrays = [
        PointArray::Numbers("radius_m", spheres.radius.clone()),
        PointArray::Numbers("mass_kg", spheres.mass.clone()),
        PointArray::Vectors("velocity_m_s", vectors(Spheres::velocity)),
        PointArray::Vectors("spin_rad_s", vectors(Spheres::spin)),
        PointArray::Whole("sphere", (0..count as i64).collect()),
    ];
    points_vtp(&vectors(Spheres::position), &arrays)
}

/// Data of points: a name with its unit, and a value for each point.
#[derive(Debug, Clone, PartialEq)]
pub enum PointArray {
    /// Numbers.
    Numbers(&'static str, Vec<f64>),
    /// Vectors.
    Vectors(&'static str, Vec<[f64; 3]>),
    /// Whole numbers.
    Whole(&'static str, Vec<i64>),
}

/// Points (and vertex cells) with data; the first array is the one shown at first.
///
/// # Panics
/// If an array is not as long as the points.
pub fn points_vtp(points: &[[f64; 3]], data: &[PointArray]) -> Vec<u8> {
    let count = points.len();
    let mut arrays = Arrays::default();
    let point_data: Vec<String> = data
        .iter()
        .map(|array| match array {
            PointArray::Numbers(name, values) => {
                assert_eq!(values.len(), count, "{name}");
                arrays.floats(name, 1, values.iter().copied())
            }
            PointArray::Vectors(name, values) => {
                assert_eq!(values.len(), count, "{name}");
                arrays.floats(name, 3, values.iter().flatten().copied())
            }
            PointArray::Whole(name, values) => {
                assert_eq!(values.len(), count, "{name}");
                arrays.integers(name, values.iter().copied())
            }
        })
        .collect();
    let shown = match data.first() {
        Some(PointArray::Numbers(name, _) | PointArray::Whole(name, _)) => format!(" Scalars=\"{name}\""),
        _ => String::new(),
    };
    let points = arrays.floats("points_m", 3, points.iter().flatten().copied());
    let cells = [arrays.integers("connectivity", 0..count as i64), arrays.integers("offsets", 1..=count as i64)];
    let piece = format!(
        "<Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n\
         <PointData{shown}>\n{}</PointData>\n<Points>\n{points}</Points>\n<Verts>\n{}</Verts>\n</Piece>",
        point_data.concat(),
        cells.concat()
    );
    arrays.file(&piece)
}

/// A mesh: one polygon a facet, with the facet's number as cell data.
pub fn mesh_vtp(mesh: &Mesh) -> Vec<u8> {
    let mut arrays = Arrays::default();
    let facets = mesh.facets.len();
    let numbers = arrays.integers("facet", 0..facets as i64);
    let points = arrays.floats("points_m", 3, mesh.vertices.iter().flatten().copied());
    let cells = [
        arrays.integers("connectivity", mesh.facets.iter().flatten().map(|v| i64::from(*v))),
        arrays.integers("offsets", (1..=facets as i64).map(|f| 3 * f)),
    ];
    let piece = format!(
        "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{facets}\">\n\
         <CellData>\n{numbers}</CellData>\n<Points>\n{points}</Points>\n<Polys>\n{}</Polys>\n</Piece>",
        mesh.vertices.len(),
        cells.concat()
    );
    arrays.file(&piece)
}

/// The appended block.
#[derive(Default)]
struct Arrays {
    bytes: Vec<u8>,
}

impl Arrays {
    /// Appends `f64`s; the element that refers to them.
    fn floats(&mut self, name: &str, components: usize, values: impl Iterator<Item = f64>) -> String {
        self.append("Float64", name, components, values.map(f64::to_le_bytes))
    }

    /// Appends `i64`s; the element that refers to them.
    fn integers(&mut self, name: &str, values: impl Iterator<Item = i64>) -> String {
        self.append("Int64", name, 1, values.map(i64::to_le_bytes))
    }

    fn append(&mut self, kind: &str, name: &str, components: usize, values: impl Iterator<Item = [u8; 8]>) -> String {
        let offset = self.bytes.len();
        self.bytes.extend([0; 8]);
        self.bytes.extend(values.flatten());
        let length = (self.bytes.len() - offset - 8) as u64;
        self.bytes[offset..offset + 8].copy_from_slice(&length.to_le_bytes());
        let mut element = format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" ");
        writeln!(element, "format=\"appended\" offset=\"{offset}\"/>").expect("writing to a string cannot fail");
        element
    }

    fn file(self, piece: &str) -> Vec<u8> {
        let head = format!(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
             <PolyData>\n{piece}\n</PolyData>\n<AppendedData encoding=\"raw\">\n_"
        );
        let mut file = head.into_bytes();
        file.extend(self.bytes);
        file.extend(b"\n</AppendedData>\n</VTKFile>\n");
        file
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair() -> Spheres {
        let mut spheres = Spheres::default();
        spheres.push([1.0, 2.0, 3.0], [0.1, 0.2, 0.3], [0.4, 0.5, 0.6], 7.0, 0.5);
        spheres.push([4.0, 5.0, 6.0], [1.1, 1.2, 1.3], [1.4, 1.5, 1.6], 8.0, 0.25);
        spheres
    }

    fn tetrahedron() -> Mesh {
        tiling::fibonacci::unit_sphere(4).unwrap()
    }

    /// The words (8 bytes) of a named array, found as a reader finds them.
    fn words(file: &[u8], name: &str) -> Vec<[u8; 8]> {
        let text = String::from_utf8_lossy(file);
        let element = text.split("<DataArray").find(|e| e.contains(&format!("Name=\"{name}\""))).unwrap();
        let offset: usize = element.split("offset=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
        let marker = b"<AppendedData encoding=\"raw\">\n_";
        let block = &file[file.windows(marker.len()).position(|w| w == marker).unwrap() + marker.len()..];
        let word = |at: usize| <[u8; 8]>::try_from(&block[at..at + 8]).unwrap();
        let length = u64::from_le_bytes(word(offset)) as usize;
        (0..length / 8).map(|k| word(offset + 8 + 8 * k)).collect()
    }

    fn floats(file: &[u8], name: &str) -> Vec<f64> {
        words(file, name).into_iter().map(f64::from_le_bytes).collect()
    }

    fn integers(file: &[u8], name: &str) -> Vec<i64> {
        words(file, name).into_iter().map(i64::from_le_bytes).collect()
    }

    #[test]
    fn arrays_of_an_aggregate_are_where_their_offsets_say() {
        let file = spheres_vtp(&pair());
        assert_eq!(floats(&file, "points_m"), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(floats(&file, "velocity_m_s"), [0.1, 0.2, 0.3, 1.1, 1.2, 1.3]);
        assert_eq!(floats(&file, "spin_rad_s"), [0.4, 0.5, 0.6, 1.4, 1.5, 1.6]);
        assert_eq!((floats(&file, "mass_kg"), floats(&file, "radius_m")), (vec![7.0, 8.0], vec![0.5, 0.25]));
        assert_eq!((integers(&file, "connectivity"), integers(&file, "offsets")), (vec![0, 1], vec![1, 2]));
    }

    #[test]
    fn arrays_of_a_mesh_are_where_their_offsets_say() {
        let mesh = tetrahedron();
        let file = mesh_vtp(&mesh);
        assert_eq!(floats(&file, "points_m"), mesh.vertices.concat());
        let corners: Vec<i64> = mesh.facets.iter().flatten().map(|v| i64::from(*v)).collect();
        assert_eq!((integers(&file, "connectivity"), integers(&file, "offsets")), (corners, vec![3, 6, 9, 12]));
    }

    /// Read back by VTK itself, where Python has it.
    #[test]
    fn ref_vtk_reads_both_files() {
        const SCRIPT: &str = "
import sys
try:
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError:
    print('skipped: Python without vtk'); sys.exit()
def load(path):
    reader = vtkXMLPolyDataReader(); reader.SetFileName(path); reader.Update()
    return reader.GetOutput()
spheres, mesh = load(sys.argv[1]), load(sys.argv[2])
data = spheres.GetPointData()
assert (spheres.GetNumberOfPoints(), spheres.GetNumberOfVerts()) == (2, 2)
assert spheres.GetPoint(1) == (4.0, 5.0, 6.0)
assert data.GetArray('velocity_m_s').GetTuple(1) == (1.1, 1.2, 1.3)
assert data.GetArray('spin_rad_s').GetTuple(0) == (0.4, 0.5, 0.6)
assert data.GetArray('radius_m').GetValue(1) == 0.25 and data.GetArray('mass_kg').GetValue(0) == 7.0
assert (mesh.GetNumberOfPoints(), mesh.GetNumberOfPolys()) == (4, 4)
assert mesh.GetCellData().GetArray('facet').GetValue(3) == 3
print('read back')
";
        let folder = tempfile::tempdir().unwrap();
        let paths = ["spheres.vtp", "mesh.vtp"].map(|name| folder.path().join(name));
        std::fs::write(&paths[0], spheres_vtp(&pair())).unwrap();
        std::fs::write(&paths[1], mesh_vtp(&tetrahedron())).unwrap();
        match std::process::Command::new("python3").arg("-c").arg(SCRIPT).args(&paths).output() {
            Ok(run) => {
                println!("{}", String::from_utf8_lossy(&run.stdout));
                assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
            }
            Err(_) => println!("skipped: no python3"),
        }
    }
}
