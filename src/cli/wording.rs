//! Library errors in the words of the program.
//!
//! The library names its own parameters, since embedding applications and the page in a browser show the same errors;
//! here the options of `hsad` take their place.

use hsad::Error;

/// The message of a library error, with the options that help.
pub fn in_options(error: &Error) -> String {
    match error {
        Error::NotRectified { diagnosis } => format!(
            "the pair is not rectified: {diagnosis}; rectify it first, or search along rows all the same with --force"
        ),
        Error::NoRange { reason } => {
            format!("the disparity range could not be found: {reason}; name it with --min-disparity and --disparities")
        }
        Error::WrongResults { device, what, command } => format!(
            "{device} computes wrong results ({what}): use another device (hsad devices) or --device cpu, and repeat \
             the failure with {command}"
        ),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_options_that_help() {
        let no_range = Error::NoRange { reason: "3 points".into() };
        let wrong = Error::WrongResults { device: "GPU".into(), what: "pad".into(), command: "hsad verify".into() };
        for (error, options) in [
            (Error::NotRectified { diagnosis: "turned".into() }, &["turned", "--force"][..]),
            (no_range, &["3 points", "--min-disparity", "--disparities"]),
            (wrong, &["GPU", "pad", "--device cpu", "hsad verify"]),
            (Error::NoAdapter, &[&Error::NoAdapter.to_string()]),
        ] {
            let text = in_options(&error);
            assert!(options.iter().all(|option| text.contains(option)), "{text}");
        }
    }
}
