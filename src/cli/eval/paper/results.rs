//! The results of one scene, by condition and as means.

use super::{
    curve::{Figure, Sample},
    method::Method,
    record::Record,
};

/// A method's records under one condition, or under several conditions for their mean.
pub struct Group<'r> {
    pub name: String,
    pub method: Method,
    pub records: Vec<&'r Record>,
}

impl Group<'_> {
    /// The curve of a single record, or the mean of the curves.
    pub fn curve(&self, figure: Figure) -> Vec<Sample> {
        match self.records[..] {
            [record] => figure.curve(record),
            _ => figure.mean(&self.records.iter().map(|record| figure.curve(record)).collect::<Vec<_>>()),
        }
    }
}

/// One group per condition and method, then the means: first over the conditions under which all methods have a result,
/// so that methods can be compared; then, for methods with more results, over all of their conditions.
pub fn groups(records: &[Record]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group> = records
        .iter()
        .map(|record| Group { name: record.condition.clone(), method: record.method, records: vec![record] })
        .collect();
    let of = |method| records.iter().filter(move |record| record.method == method);
    let has = |method, condition: &str| of(method).any(|record| record.condition == condition);
    let is_common = |record: &&Record| Method::ALL.into_iter().all(|method| has(method, &record.condition));
    let mut mean = |method, records: Vec<_>| {
        let name = format!("mean of {}", records.len());
        groups.extend((records.len() > 1).then_some(Group { name, method, records }));
    };
    for method in Method::ALL {
        mean(method, of(method).filter(is_common).collect());
    }
    for method in Method::ALL {
        if of(method).any(|record| !is_common(&record)) {
            mean(method, of(method).collect());
        }
    }
    groups
}

#[cfg(test)]
pub mod tests {
    use super::{super::record::tests::record, *};

    /// Results of all methods under two conditions, and of the sparse method alone under a third, where the others failed.
    pub fn records() -> Vec<Record> {
        let done = |condition, method, right| record(condition, method, 8, right);
        vec![
            done("none", Method::Sparse, "1111"),
            done("none", Method::Kamencay, "111001"),
            done("none", Method::Balanced, "111110"),
            done("blur=2", Method::Sparse, "10"),
            done("blur=2", Method::Kamencay, ""),
            done("blur=2", Method::Balanced, "11"),
            done("rotation=90", Method::Sparse, "1"),
        ]
    }

    #[test]
    fn means_compare_like_with_like() {
        let records = records();
        let groups = groups(&records);
        let names: Vec<_> = groups[7..].iter().map(|group| (&*group.name, group.method, group.records.len())).collect();
        let expected = [
            ("mean of 2", Method::Sparse, 2),
            ("mean of 2", Method::Kamencay, 2),
            ("mean of 2", Method::Balanced, 2),
            ("mean of 3", Method::Sparse, 3),
        ];
        assert_eq!(names, expected);
        let precision = |group: &Group| group.curve(Figure::RecallPrecision).iter().map(|s| s.y).collect::<Vec<_>>();
        assert_eq!((precision(&groups[3]), precision(&groups[4])), (vec![1.0, 0.5], vec![]));
        assert_eq!(precision(&groups[7]), [1.0, 0.75, 0.75, 0.75]);
        assert_eq!(super::groups(&records[..3]).len(), 3, "one condition has no mean");
    }
}
