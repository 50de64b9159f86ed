//! Random samples in a fixed sequence.

/// An endless sequence of samples of `N` different indices below a number; it is empty for a number below `N`.
pub(super) struct Samples<const N: usize> {
    count: usize,
    state: u64,
}

impl<const N: usize> Samples<N> {
    pub fn of(count: usize) -> Self {
        Self { count, state: 1 }
    }

    /// Knuth's MMIX generator; only its upper bits are random enough.
    fn pick(&mut self) -> usize {
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 33) as usize % self.count
    }
}

impl<const N: usize> Iterator for Samples<N> {
    type Item = [usize; N];

    fn next(&mut self) -> Option<[usize; N]> {
        if self.count < N {
            return None;
        }
        let mut sample = [0; N];
        for i in 0..N {
            sample[i] = loop {
                let index = self.pick();
                if !sample[..i].contains(&index) {
                    break index;
                }
            };
        }
        Some(sample)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_different_indices_and_repeat() {
        let drawn: Vec<[usize; 4]> = Samples::of(6).take(200).collect();
        for sample in &drawn {
            assert!((0..4).all(|i| sample[i] < 6 && !sample[..i].contains(&sample[i])), "{sample:?}");
        }
        assert!((0..6).all(|index| drawn.iter().any(|sample| sample[0] == index)));
        assert_eq!(drawn, Samples::of(6).take(200).collect::<Vec<_>>());
        assert_eq!(Samples::<4>::of(3).next(), None);
    }
}
