//! Library errors in the words of the program.
//!
//! The library names its own parameters, since embedding applications and the page in a browser show the same errors;
//! here the options of `hsad` take their place.

use hsad::{Error, Options};

/// The message of a library error, with the options that help.
pub fn in_options(error: &Error) -> String {
    match error {
        Error::NotRectified { diagnosis } => {
            let diagnosis = in_words_of_options(diagnosis);
            format!("the pair is not rectified: {diagnosis}; --force searches along rows all the same")
        }
        Error::NoRange { reason } => {
            format!("the disparity range could not be found: {reason}; name it with --min-disparity and --disparities")
        }
        Error::WrongResults { device, what, command } => format!(
            "{device} computes wrong results ({what}): use another device (hsad devices) or --device cpu, and repeat \
             the failure with {command}"
        ),
        Error::Parameter { name, value, expected } => {
            let expected = in_words_of_options(expected);
            match OPTIONS.iter().find(|(parameter, _)| parameter == name) {
                Some((_, option)) => format!("{option} is {value}, but {expected}"),
                None if Options::described(name).is_ok() => format!("{} is {value}, but {expected}", spelled(name)),
                None => format!("{name} is {value}, but {expected}"),
            }
        }
        Error::Format { .. } => {
            let text =
                error.to_string().replace("name the unit of length", "name the unit of length with --calib-unit");
            text.replace("name the scale of the truth", "name the scale of the truth with --truth-scale")
        }
        _ => error.to_string(),
    }
}

/// The spelling of an option on the command line.
fn spelled(name: &str) -> String {
    format!("--{}", name.replace('_', "-"))
}

/// A sentence in which the library names options between backticks, with their spelling on the command line.
pub fn in_words_of_options(sentence: &str) -> String {
    let parts = sentence.split('`').enumerate();
    parts.map(|(i, part)| if i % 2 == 0 { part.into() } else { spelled(part) }).collect()
}

/// Parameters that are no options of the library by name, and the options that set them.
const OPTIONS: [(&str, &str); 7] = [
    ("condition", "--condition"),
    ("nodata", "--nodata"),
    ("only", "--only"),
    ("size", "--size"),
    ("strongest", "--strongest"),
    ("the number of disparities", "--disparities"),
    ("the window of costs", "--cost-window"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_options_that_help() {
        let no_range = Error::NoRange { reason: "3 points".into() };
        let wrong = Error::WrongResults { device: "GPU".into(), what: "pad".into(), command: "hsad verify".into() };
        let even = |name| Error::Parameter { name, value: "8".into(), expected: "it must be odd".into() };
        for (error, options) in [
            (Error::NotRectified { diagnosis: "turned".into() }, &["turned", "--force"][..]),
            (no_range, &["3 points", "--min-disparity", "--disparities"]),
            (wrong, &["GPU", "pad", "--device cpu", "hsad verify"]),
            (even("the window of costs"), &["--cost-window is 8, but it must be odd"]),
            (
                Error::Format { path: "rig.yml".into(), reason: "a baseline of 3: name the unit of length".into() },
                &["rig.yml: a baseline of 3: name the unit of length with --calib-unit"],
            ),
            (even("another"), &["another is 8, but it must be odd"]),
            (even("max_features"), &["--max-features is 8, but it must be odd"]),
            (
                Error::Parameter {
                    name: "preset",
                    value: "fast".into(),
                    expected: "`cost_window` needs balanced".into(),
                },
                &["--preset is fast, but --cost-window needs balanced"],
            ),
            (Error::NoAdapter, &[&Error::NoAdapter.to_string()]),
        ] {
            let text = in_options(&error);
            assert!(options.iter().all(|option| text.contains(option)), "{text}");
        }
    }
}
