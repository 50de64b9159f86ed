//! The number of workgroups of a keypoint list.

/// Workgroups along x, y and z, one per keypoint found but at most `capacity`, in rows of `width`.
pub fn workgroups(found: u32, capacity: u32, width: u32) -> [u32; 3] {
    let count = found.min(capacity);
    [count.min(width), count.div_ceil(width), 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_filled_before_the_next_begins() {
        assert_eq!(workgroups(0, 9, 4), [0, 0, 1]);
        assert_eq!(workgroups(3, 9, 4), [3, 1, 1]);
        assert_eq!(workgroups(5, 9, 4), [4, 2, 1]);
        assert_eq!(workgroups(99, 9, 4), [4, 3, 1]);
    }
}
