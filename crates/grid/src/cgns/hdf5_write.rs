//! Writes a tree of nodes as an HDF5 file.
//!
//! The CGNS library walks a node's children by the order in which they were made, which HDF5 keeps only in groups that were
//! made to track it, and the HDF5 crates that write do not make those. What CGNS needs of the format is little: version 2
//! superblock and object headers with links, attributes and unpacked data. Section numbers below are those of the HDF5
//! File Format Specification, version 3.0 (The HDF Group).

use super::node::{Data, Node, Precision};

/// An address that is none.
const UNDEFINED: u64 = u64::MAX;
/// Bytes of the superblock (II.A, version 2).
const SUPERBLOCK: usize = 48;
/// Data up to this size stand in the object header.
const COMPACT: usize = 2048;

/// The bytes of a file whose root group is `root`.
pub(super) fn encode(root: &Node) -> Vec<u8> {
    let mut file = vec![0; SUPERBLOCK];
    let texts = [
        (" format", "IEEE_LITTLE_32", 15),
        (" hdf5version", "HDF5 Version 1.8.0", 33),
    ];
    let own: Vec<(&str, u64)> = texts
        .iter()
        .map(|&(name, text, size)| {
            let mut bytes = text.as_bytes().to_vec();
            bytes.resize(size, 0);
            (name, dataset(&mut file, &[size], &Number::I8.message(), bytes))
        })
        .collect();
    let address = group(&mut file, root, &own, false);
    let mut head = b"\x89HDF\r\n\x1a\n".to_vec();
    head.extend([2, 8, 8, 0]);
    for value in [0, UNDEFINED, file.len() as u64, address] {
        head.extend(value.to_le_bytes());
    }
    let sum = lookup3(&head);
    head.extend(sum.to_le_bytes());
    file[..SUPERBLOCK].copy_from_slice(&head);
    file
}

/// Appends a node's group, everything below it first; its address. `own` are links that the group has besides.
fn group(file: &mut Vec<u8>, node: &Node, own: &[(&str, u64)], flags: bool) -> u64 {
    let mut links: Vec<(&str, u64)> = own.to_vec();
    let kind = match &node.data {
        Data::None => "MT",
        Data::Text(text) => {
            links.push((
                " data",
                dataset(file, &[text.len()], &Number::I8.message(), text.as_bytes().to_vec()),
            ));
            "C1"
        }
        Data::Integers(shape, values) => {
            let small: Option<Vec<i32>> = values.iter().map(|&v| i32::try_from(v).ok()).collect();
            let (number, bytes) = match small {
                Some(small) => (Number::I32, small.into_iter().flat_map(i32::to_le_bytes).collect()),
                None => (Number::I64, values.iter().flat_map(|v| v.to_le_bytes()).collect()),
            };
            let kind = if number == Number::I32 { "I4" } else { "I8" };
            links.push((" data", dataset(file, shape, &number.message(), bytes)));
            kind
        }
        Data::Reals(shape, values, Precision::Double) => {
            let bytes = values.iter().flat_map(|v| v.to_le_bytes()).collect();
            links.push((" data", dataset(file, shape, &Number::F64.message(), bytes)));
            "R8"
        }
        Data::Reals(shape, values, Precision::Single) => {
            let bytes = values.iter().flat_map(|&v| (v as f32).to_le_bytes()).collect();
            links.push((" data", dataset(file, shape, &Number::F32.message(), bytes)));
            "R4"
        }
    };
    for child in &node.children {
        let at = group(file, child, &[], true);
        links.push((&child.name, at));
    }
    let mut messages = Vec::new();
    // Link info (IV.A.2.c): the order of creation is tracked and indexed; the links stand in this header.
    let mut info = vec![0, 3];
    for value in [links.len() as u64, UNDEFINED, UNDEFINED, UNDEFINED] {
        info.extend(value.to_le_bytes());
    }
    push(&mut messages, 0x02, &info);
    // Group info (IV.A.2.k).
    push(&mut messages, 0x0A, &[0, 0]);
    for (name, text, size) in [
        ("name", node.name.as_str(), 33),
        ("label", &node.label, 33),
        ("type", kind, 3),
    ] {
        push(&mut messages, 0x0C, &text_attribute(name, text, size));
    }
    if flags {
        let value = 1i32.to_le_bytes();
        push(
            &mut messages,
            0x0C,
            &attribute("flags", &Number::I32.message(), &dataspace(&[1]), &value),
        );
    }
    for (order, (name, at)) in links.iter().enumerate() {
        // Link (IV.A.2.g): hard, with its order; the length of the name in one byte.
        let mut link = vec![1, 0x04];
        link.extend((order as u64).to_le_bytes());
        link.push(name.len() as u8);
        link.extend(name.as_bytes());
        link.extend(at.to_le_bytes());
        push(&mut messages, 0x06, &link);
    }
    header(file, &messages)
}

/// Appends a dataset of `bytes`; its address. The shape is Fortran's: HDF5's runs the other way round.
fn dataset(file: &mut Vec<u8>, shape: &[usize], datatype: &[u8], bytes: Vec<u8>) -> u64 {
    let reversed: Vec<usize> = shape.iter().rev().copied().collect();
    // Data layout (IV.A.2.i, version 3): in the header, or in one piece elsewhere.
    let layout = if bytes.len() <= COMPACT {
        let mut layout = vec![3, 0];
        layout.extend((bytes.len() as u16).to_le_bytes());
        layout.extend(bytes);
        layout
    } else {
        align(file);
        let mut layout = vec![3, 1];
        layout.extend((file.len() as u64).to_le_bytes());
        layout.extend((bytes.len() as u64).to_le_bytes());
        file.extend(bytes);
        layout
    };
    let mut messages = Vec::new();
    push(&mut messages, 0x01, &dataspace(&reversed));
    push(&mut messages, 0x03, datatype);
    // Fill value (IV.A.2.f, version 3): none given, space taken at once, never filled.
    push(&mut messages, 0x05, &[3, 0x05]);
    push(&mut messages, 0x08, &layout);
    header(file, &messages)
}

/// Appends an object header (IV.A.1.b, version 2); its address.
fn header(file: &mut Vec<u8>, messages: &[u8]) -> u64 {
    align(file);
    let at = file.len();
    // The size of the messages takes four bytes; nothing else is kept.
    file.extend(b"OHDR\x02\x02");
    file.extend((messages.len() as u32).to_le_bytes());
    file.extend(messages);
    let sum = lookup3(&file[at..]);
    file.extend(sum.to_le_bytes());
    at as u64
}

fn align(file: &mut Vec<u8>) {
    file.resize(file.len().next_multiple_of(8), 0);
}

/// A message of an object header.
fn push(messages: &mut Vec<u8>, kind: u8, body: &[u8]) {
    messages.push(kind);
    messages.extend((body.len() as u16).to_le_bytes());
    messages.push(0);
    messages.extend(body);
}

/// Dataspace (IV.A.2.b, version 2): simple, or scalar without dimensions.
fn dataspace(shape: &[usize]) -> Vec<u8> {
    let mut out = vec![2, shape.len() as u8, 0, u8::from(!shape.is_empty())];
    for &n in shape {
        out.extend((n as u64).to_le_bytes());
    }
    out
}

/// Attribute (IV.A.2.m, version 3).
fn attribute(name: &str, datatype: &[u8], dataspace: &[u8], value: &[u8]) -> Vec<u8> {
    let mut out = vec![3, 0];
    for size in [name.len() + 1, datatype.len(), dataspace.len()] {
        out.extend((size as u16).to_le_bytes());
    }
    out.push(0);
    out.extend(name.as_bytes());
    out.push(0);
    out.extend(datatype);
    out.extend(dataspace);
    out.extend(value);
    out
}

/// An attribute of text, ended and filled with zeros.
fn text_attribute(name: &str, text: &str, size: usize) -> Vec<u8> {
    // Datatype (IV.A.2.d): class 3, a string of fixed size that a zero ends, ASCII.
    let mut datatype = vec![0x13, 0, 0, 0];
    datatype.extend((size as u32).to_le_bytes());
    let mut value = text.as_bytes().to_vec();
    value.truncate(size - 1);
    value.resize(size, 0);
    attribute(name, &datatype, &dataspace(&[]), &value)
}

/// Numbers that nodes have.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Number {
    I8,
    I32,
    I64,
    F32,
    F64,
}

impl Number {
    /// Datatype (IV.A.2.d, version 1), little-endian: class 0 for whole numbers with a sign, class 1 for IEEE reals.
    fn message(self) -> Vec<u8> {
        let whole = |size: u8| vec![0x10, 0x08, 0, 0, size, 0, 0, 0, 0, 0, 8 * size, 0];
        match self {
            Self::I8 => whole(1),
            Self::I32 => whole(4),
            Self::I64 => whole(8),
            Self::F32 => vec![0x11, 0x20, 31, 0, 4, 0, 0, 0, 0, 0, 32, 0, 23, 8, 0, 23, 127, 0, 0, 0],
            Self::F64 => vec![0x11, 0x20, 63, 0, 8, 0, 0, 0, 0, 0, 64, 0, 52, 11, 0, 52, 0xFF, 3, 0, 0],
        }
    }
}

/// The checksum of HDF5's metadata: B. Jenkins, lookup3.c (2006), `hashlittle` from 0.
fn lookup3(bytes: &[u8]) -> u32 {
    let start = 0xdead_beef_u32.wrapping_add(bytes.len() as u32);
    let (mut a, mut b, mut c) = (start, start, start);
    let word = |part: &[u8], n: usize| {
        (0..4).fold(0u32, |sum, m| {
            sum | u32::from(part.get(4 * n + m).copied().unwrap_or(0)) << (8 * m)
        })
    };
    let mut rest = bytes;
    while rest.len() > 12 {
        a = a.wrapping_add(word(rest, 0));
        b = b.wrapping_add(word(rest, 1));
        c = c.wrapping_add(word(rest, 2));
        for (turn, step) in [4, 6, 8, 16, 19, 4].into_iter().enumerate() {
            let (x, y, z) = match turn % 3 {
                0 => (&mut a, &mut c, &mut b),
                1 => (&mut b, &mut a, &mut c),
                _ => (&mut c, &mut b, &mut a),
            };
            *x = x.wrapping_sub(*y) ^ y.rotate_left(step);
            *y = y.wrapping_add(*z);
        }
        rest = &rest[12..];
    }
    if rest.is_empty() {
        return c;
    }
    a = a.wrapping_add(word(rest, 0));
    b = b.wrapping_add(word(rest, 1));
    c = c.wrapping_add(word(rest, 2));
    for (turn, step) in [14, 11, 25, 16, 4, 14, 24].into_iter().enumerate() {
        let (x, y) = match turn % 3 {
            0 => (&mut c, b),
            1 => (&mut a, c),
            _ => (&mut b, a),
        };
        *x = (*x ^ y).wrapping_sub(y.rotate_left(step));
    }
    c
}

#[cfg(test)]
mod tests {
    use super::lookup3;

    /// The values that lookup3.c's own driver prints (driver5): the empty key, and this sentence.
    #[test]
    fn checksums_are_those_of_lookup3() {
        assert_eq!(lookup3(b""), 0xdead_beef);
        assert_eq!(lookup3(b"Four score and seven years ago"), 0x1777_0551);
    }
}
