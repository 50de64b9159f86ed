//! `hsad completions`.

use predicates::str::contains;

use crate::common::hsad;

const SHELLS: [&str; 5] = ["bash", "elvish", "fish", "powershell", "zsh"];

fn script(shell: &str) -> String {
    let output = hsad().args(["completions", shell]).assert().success().stderr("").get_output().stdout.clone();
    String::from_utf8(output).unwrap()
}

#[test]
fn scripts_know_commands_options_and_values() {
    for shell in SHELLS {
        let script = script(shell);
        for name in ["hsad", "match", "completions", "self-test", "balanced", "kamencay"] {
            // Elvish and PowerShell complete no values of options.
            let is_value = ["balanced", "kamencay"].contains(&name);
            let expected = !(is_value && ["elvish", "powershell"].contains(&shell));
            assert!(!expected || script.contains(name), "{shell}: {name}");
        }
    }
}

/// The script as its shell runs it.
#[cfg(unix)]
#[test]
fn bash_completes_a_subcommand() {
    use std::process::Command;

    let script = script("bash") + "COMP_WORDS=(hsad ver); COMP_CWORD=1; _hsad hsad ver hsad; echo \"${COMPREPLY[*]}\"";
    let output = Command::new("bash").args(["--norc", "-c", &script]).output().expect("bash, which runs test.sh too");
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "verify\n", "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn an_unknown_shell_is_named_with_those_that_are_known() {
    hsad().args(["completions", "dos"]).assert().code(2).stderr(contains("'dos'")).stderr(contains("bash"));
}

#[test]
fn a_shell_has_to_be_named() {
    hsad().arg("completions").assert().code(2);
    let mut too_many = hsad();
    too_many.args(["completions", "bash", "zsh"]);
    too_many.assert().code(2).stdout("");
}
