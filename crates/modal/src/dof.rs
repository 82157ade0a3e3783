//! The six degrees of freedom of a node, and sets of them.

use std::fmt;

/// Number of degrees of freedom of a grid node: three displacements and three rotations.
pub const DOFS_PER_NODE: usize = 6;

/// One degree of freedom of a node, counted from zero: 0, 1, 2 = displacement along and
/// 3, 4, 5 = rotation about axis 1, 2, 3 of the node's displacement frame. Decks write 1 to 6.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Dof(u8);

impl Dof {
    /// Displacement along axis 1.
    pub const T1: Self = Self(0);
    /// Displacement along axis 2.
    pub const T2: Self = Self(1);
    /// Displacement along axis 3.
    pub const T3: Self = Self(2);
    /// Rotation about axis 1.
    pub const R1: Self = Self(3);
    /// Rotation about axis 2.
    pub const R2: Self = Self(4);
    /// Rotation about axis 3.
    pub const R3: Self = Self(5);

    /// The degree of freedom with zero-based `index`, if there is one.
    pub fn from_index(index: usize) -> Option<Self> {
        (index < DOFS_PER_NODE).then_some(Self(index as u8))
    }

    /// From a deck's component number: 1 to 6, and 0 (a scalar point) which is the first.
    pub fn from_component(component: u32) -> Option<Self> {
        match component {
            0 => Some(Self(0)),
            1..=6 => Some(Self(component as u8 - 1)),
            _ => None,
        }
    }

    /// Zero-based index, 0 to 5.
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

impl fmt::Display for Dof {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = ["T1", "T2", "T3", "R1", "R2", "R3"][self.index()];
        f.write_str(name)
    }
}

/// A set of degrees of freedom of one node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct DofSet(u8);

impl DofSet {
    /// No degree of freedom.
    pub const NONE: Self = Self(0);
    /// The three displacements ("123").
    pub const TRANSLATIONS: Self = Self(0b00_0111);
    /// The three rotations ("456").
    pub const ROTATIONS: Self = Self(0b11_1000);
    /// All six ("123456").
    pub const ALL: Self = Self(0b11_1111);

    /// From the digits of a deck's component list: `"345"`, `"123456"`, `"0"` or `""` (a scalar point).
    /// `None` when a character is no digit from 0 to 6.
    pub fn parse(digits: &str) -> Option<Self> {
        let digits = digits.trim();
        if digits.is_empty() {
            return Some(Self(1));
        }
        digits
            .chars()
            .map(|c| c.to_digit(10).and_then(Dof::from_component))
            .try_fold(Self::NONE, |set, dof| Some(set.with(dof?)))
    }

    /// From a deck's integer component list, such as `345`.
    pub fn from_components(components: u32) -> Option<Self> {
        Self::parse(&components.to_string())
    }

    /// This set with one more member.
    #[must_use]
    pub fn with(self, dof: Dof) -> Self {
        Self(self.0 | 1 << dof.0)
    }

    /// Whether `dof` is a member.
    pub fn contains(self, dof: Dof) -> bool {
        self.0 & (1 << dof.0) != 0
    }

    /// Members in order.
    pub fn iter(self) -> impl Iterator<Item = Dof> {
        (0..DOFS_PER_NODE as u8).map(Dof).filter(move |&d| self.contains(d))
    }

    /// Number of members.
    pub fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Whether the set has no member.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

impl From<Dof> for DofSet {
    fn from(dof: Dof) -> Self {
        Self::NONE.with(dof)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn component_lists_read_as_decks_write_them() {
        let set = DofSet::parse("345").unwrap();
        assert_eq!(set.iter().map(Dof::index).collect::<Vec<_>>(), [2, 3, 4]);
        assert_eq!(DofSet::parse("0"), Some(DofSet::from(Dof::T1)));
        assert_eq!(DofSet::from_components(123_456), Some(DofSet::ALL));
        assert_eq!(DofSet::parse("37"), None);
        assert_eq!(DofSet::parse("x"), None);
        assert_eq!(DofSet::TRANSLATIONS.len(), 3);
    }
}
