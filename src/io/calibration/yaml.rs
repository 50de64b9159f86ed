//! YAML and JSON.

use std::path::Path;

use saphyr_parser::{Event, Parser};

use super::tree::{MAX_DEPTH, MAX_NODES, Node};
use crate::{error::Result, io::malformed};

/// A list or a mapping that is being read.
enum Open {
    List(Vec<Node>),
    Map(Vec<(String, Node)>, Option<String>),
}

/// Parses the first document of a file, YAML as ROS, Kalibr and OpenCV write it, or JSON. Aliases are refused, tags are ignored.
pub(super) fn parse(text: &str, path: &Path) -> Result<Node> {
    // OpenCV's first line, '%YAML:1.0', is not YAML.
    let text = text.strip_prefix("%YAML").and_then(|rest| rest.split_once('\n')).map_or(text, |(_, rest)| rest);
    let refused = |what: String| malformed(path, format!("{what}: this is not the YAML or JSON of a calibration"));
    let mut open: Vec<Open> = Vec::new();
    let mut count = 0;
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| refused(error.to_string()))?;
        let line = span.start.line();
        let node = match event {
            Event::Scalar(value, ..) => Node::Text(value.into_owned()),
            Event::SequenceStart(..) | Event::MappingStart(..) if open.len() == MAX_DEPTH => {
                return Err(refused(format!("line {line} is nested more than {MAX_DEPTH} deep")));
            }
            Event::SequenceStart(..) => {
                open.push(Open::List(Vec::new()));
                continue;
            }
            Event::MappingStart(..) => {
                open.push(Open::Map(Vec::new(), None));
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some(Open::List(items)) => Node::List(items),
                Some(Open::Map(entries, _)) => Node::Map(entries),
                None => continue,
            },
            Event::Alias(_) => return Err(refused(format!("line {line} has an alias"))),
            Event::DocumentEnd | Event::StreamEnd => break,
            Event::Nothing | Event::StreamStart | Event::DocumentStart(_) => continue,
        };
        count += 1;
        if count > MAX_NODES {
            return Err(refused(format!("there are more than {MAX_NODES} values")));
        }
        match open.last_mut() {
            None => return Ok(node),
            Some(Open::List(items)) => items.push(node),
            Some(Open::Map(entries, key)) => match (key.take(), node) {
                (Some(key), node) => {
                    if entries.iter().any(|(name, _)| *name == key) {
                        return Err(refused(format!("{key} is there twice")));
                    }
                    entries.push((key, node));
                }
                (None, Node::Text(name)) => *key = Some(name),
                (None, _) => return Err(refused(format!("line {line} has a list as a name"))),
            },
        }
    }
    Err(refused("there is no value".into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(value: &str) -> Node {
        Node::Text(value.into())
    }

    #[test]
    fn opencvs_yaml_and_json_are_read() {
        let node =
            parse("%YAML:1.0\n---\nM: !!opencv-matrix\n   rows: 1\n   data: [ 1., -2e3,\n      3 ]\n", Path::new("a"));
        let matrix =
            vec![("rows".into(), text("1")), ("data".into(), Node::List(vec![text("1."), text("-2e3"), text("3")]))];
        assert_eq!(node.unwrap(), Node::Map(vec![("M".into(), Node::Map(matrix))]));
        let json = parse("{\"a\": {\"b\": [[1, 2], [3]]},\n\t\"c\": \"d\"}", Path::new("a")).unwrap();
        let lists = Node::List(vec![Node::List(vec![text("1"), text("2")]), Node::List(vec![text("3")])]);
        assert_eq!(json, Node::Map(vec![("a".into(), Node::Map(vec![("b".into(), lists)])), ("c".into(), text("d"))]));
    }

    #[test]
    fn what_is_hostile_is_refused() {
        let lines = "a: &x [1]\nb: *x\n";
        for (text, expected) in [
            (lines, "line 2 has an alias"),
            (&"[".repeat(40), "nested more than 16 deep"),
            (&"- ".repeat(100_000), "nested more than 16 deep"),
            (&format!("[{}]", "1,".repeat(70_000)), "more than 65536 values"),
            ("a: 1\na: 2\n", "a is there twice"),
            ("? [1]\n: 2\n", "line 1 has a list as a name"),
            ("a: [1, 2", "line"),
            ("a: 'x", "line"),
            ("", "there is no value"),
        ] {
            let error = parse(text, Path::new("a.yaml")).unwrap_err().to_string();
            assert!(error.starts_with("a.yaml: ") && error.contains(expected), "{error}");
        }
    }
}
