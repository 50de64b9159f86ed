//! How the cameras of two views stand.

/// What corresponding points show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// Different places of one scene with depth: the pair can be rectified.
    Parallax,
    /// Nothing: hardly any points agree with each other.
    Unrelated,
    /// The same picture twice, or two from one place in one direction.
    Still,
    /// No point shows depth, and nothing tells how the cameras stand: a plane, or a camera that turned on the spot.
    Flat,
    /// The same, and it is a plane: no usual camera sees this where it turns.
    Plane,
    /// The same, and it is a camera that turned, or turned and zoomed, on the spot.
    Turned,
    /// The camera moved along its line of sight, into the picture or out of it.
    Forward,
}
