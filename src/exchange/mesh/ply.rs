//! PLY files, text or binary: the elements `vertex` (x, y, z) and `face` (a list of vertex indices).

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};
use tiling::Mesh;

use super::assemble::{Assembly, AssemblyFault};

/// An element of any kind: whatever of a vertex or a facet it has.
struct Element {
    point: [f64; 3],
    corners: Vec<i64>,
}

impl PropertyAccess for Element {
    fn new() -> Self {
        // A coordinate that the file does not have stays NaN, which is refused.
        Self { point: [f64::NAN; 3], corners: Vec::new() }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == name);
        match (axis, name) {
            (Some(axis), _) => match scalar(&property) {
                Some(value) => self.point[axis] = value,
                None => return PropertyAccessResult::Ignored,
            },
            (None, "vertex_indices" | "vertex_index") => self.corners = indices(&property),
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

fn scalar(property: &Property) -> Option<f64> {
    Some(match property {
        Property::Char(v) => (*v).into(),
        Property::UChar(v) => (*v).into(),
        Property::Short(v) => (*v).into(),
        Property::UShort(v) => (*v).into(),
        Property::Int(v) => (*v).into(),
        Property::UInt(v) => (*v).into(),
        Property::Float(v) => (*v).into(),
        Property::Double(v) => *v,
        _ => return None,
    })
}

fn indices(property: &Property) -> Vec<i64> {
    match property {
        Property::ListChar(v) => v.iter().map(|i| (*i).into()).collect(),
        Property::ListUChar(v) => v.iter().map(|i| (*i).into()).collect(),
        Property::ListShort(v) => v.iter().map(|i| (*i).into()).collect(),
        Property::ListUShort(v) => v.iter().map(|i| (*i).into()).collect(),
        Property::ListInt(v) => v.iter().map(|i| (*i).into()).collect(),
        Property::ListUInt(v) => v.iter().map(|i| (*i).into()).collect(),
        _ => Vec::new(),
    }
}

/// Reads a PLY file.
///
/// # Errors
/// What the header or the data lack.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, AssemblyFault> {
    let fault = |error: ply_rs_bw::parser::ParseError| AssemblyFault::Ply(error.to_string());
    let mut reader = Reader::new(bytes);
    let parser = Parser::<Element>::new();
    let header = parser.read_header(&mut reader).map_err(fault)?;
    // Elements without properties take no bytes, so that their number is bounded by nothing but the header.
    if header.elements.iter().any(|(_, element)| element.count > bytes.len()) {
        return Err(AssemblyFault::Short { expected: "the elements that the header announces" });
    }
    if header.elements.contains_key("tristrips") {
        return Err(AssemblyFault::Variant("a PLY file of triangle strips"));
    }
    let mut payload = parser.read_payload(&mut reader, &header).map_err(fault)?;
    let mut elements = |name| payload.shift_remove(name).unwrap_or_default();
    let (vertices, faces) = (elements("vertex"), elements("face"));
    let mut mesh = Assembly::new(vertices.iter().map(|v| v.point).collect())?;
    for face in faces {
        mesh.polygon(&face.corners, 0)?;
    }
    Ok(mesh.finish())
}
