//! Matches of interest points as CSV.

use hsad::{features::Feature, io::figure::PointPair, matching::Match, rectify::RowModel};

/// The matches of the interest points of two views.
pub struct MatchTable<'a> {
    pub features: [&'a [Feature]; 2],
    pub matches: &'a [Match],
    /// The rows along which the views correspond.
    pub rows: RowModel,
    /// Largest row difference of a match that agrees with `rows`, in pixels.
    pub max_dy: f64,
}

impl MatchTable<'_> {
    /// One line per match. The columns `x1`, `y1`, `x2`, `y2` and `confidence` are those that `hsad eval features --matches` reads.
    pub fn csv(&self) -> String {
        let mut text =
            String::from("x1,y1,scale1,orientation1,x2,y2,scale2,orientation2,distance,ratio,confidence,agrees\n");
        for found in self.matches {
            for Feature { x, y, scale, orientation, .. } in self.points(found) {
                text += &format!("{x},{y},{scale},{orientation},");
            }
            let Match { distance, confidence, .. } = found;
            let ratio = 1.0 - confidence;
            text += &format!("{distance},{ratio:.6},{confidence},{}\n", u8::from(self.agrees(found)));
        }
        text
    }

    /// Number of matches that agree with the rows.
    pub fn agreeing(&self) -> usize {
        self.matches.iter().filter(|found| self.agrees(found)).count()
    }

    /// Positions of the matched points in both views, in pixels.
    pub fn positions(&self) -> Vec<PointPair> {
        let position = |feature: &Feature| [feature.x, feature.y];
        self.matches.iter().map(|found| self.points(found)).map(|[l, r]| (position(l), position(r))).collect()
    }

    fn points(&self, found: &Match) -> [&Feature; 2] {
        [&self.features[0][found.left], &self.features[1][found.right]]
    }

    fn agrees(&self, found: &Match) -> bool {
        let [left, right] = self.points(found);
        (self.rows.left_row(right.x.into(), right.y.into()) - f64::from(left.y)).abs() <= self.max_dy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_by_hand() {
        let feature = |x: f32, y: f32| Feature {
            x,
            y,
            scale: 1.25,
            response: 0.001,
            dark: true,
            orientation: 0.5,
            descriptor: [0.0; 64],
        };
        let (left, right) = ([feature(9.0, 5.0)], [feature(1.0, 8.0), feature(4.5, 6.5)]);
        let found = |right, distance, confidence| Match { left: 0, right, distance, confidence };
        let table = MatchTable {
            features: [&left, &right],
            matches: &[found(1, 0.25, 0.75), found(0, 0.5, 0.125)],
            rows: RowModel::AS_IS,
            max_dy: 1.5,
        };
        assert_eq!(
            table.csv(),
            "x1,y1,scale1,orientation1,x2,y2,scale2,orientation2,distance,ratio,confidence,agrees\n\
             9,5,1.25,0.5,4.5,6.5,1.25,0.5,0.25,0.250000,0.75,1\n\
             9,5,1.25,0.5,1,8,1.25,0.5,0.5,0.875000,0.125,0\n"
        );
        assert_eq!(table.agreeing(), 1);
        // The second view lies 3 px lower.
        let rows = RowModel::new((20, 20), [0.0, 1.0, -3.0, 0.0, 0.0]);
        assert_eq!(
            MatchTable { rows, ..table }.csv().lines().map(|line| line.ends_with(",1")).collect::<Vec<_>>(),
            [false, true, true]
        );
    }
}
