//! Starting what a person could have typed.

use std::ffi::OsString;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::process::Command;

use super::words::plain_words;

/// The process of a shell command with arguments behind it, and more flags as one would type them.
///
/// A command that names a program by its path, and in which a shell has nothing to put in place of anything, starts
/// that program itself: a run is ten processes, and a shell before each costs as much as the start of the program.
pub fn shell_command(command: &str, arguments: &[OsString], flags: &str) -> Command {
    if let (Some(words), Some(flags)) = (plain_words(command), plain_words(flags))
        && let Some((program, own)) = words.split_first()
        && program.contains('/')
        && is_machine_code(Path::new(program))
    {
        let mut process = Command::new(program);
        process.args(own).args(arguments).args(flags);
        return process;
    }
    // A shell that has nothing else to do becomes the program: no process is between.
    let line = format!("{command} \"$@\" {flags}");
    let mut process = Command::new("sh");
    process.args(["-c", line.trim_end(), "crumple-run"]).args(arguments);
    process
}

/// Whether the system starts it without reading a line of it: a script may need a shell.
fn is_machine_code(program: &Path) -> bool {
    let mut start = [0; 4];
    File::open(program).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == *b"\x7fELF"
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    fn said(command: &str, flags: &str) -> String {
        let output = shell_command(command, &["a  b".into()], flags).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    }

    #[test]
    fn with_a_shell_and_without_the_program_gets_the_same_words() {
        let echo = |command: &str| said(command, "-q 'c  d' \"e\"");
        let expected = "x  y a  b -q c  d e\n";
        for (command, is_direct) in
            [("/bin/echo 'x  y'", true), ("echo \"x  y\"", false), ("X=1; /bin/echo x\\ \\ y", false)]
        {
            assert_eq!(echo(command), expected, "{command}");
            let program = shell_command(command, &[], "").get_program().to_owned();
            assert_eq!(program == "/bin/echo", is_direct, "{command}");
        }
        assert_eq!(said("/bin/echo", "$((1 + 2))"), "a  b 3\n");
    }

    #[test]
    fn a_script_without_a_first_line_is_run_by_the_shell() {
        let folder = tempfile::tempdir().unwrap();
        let script = folder.path().join("script");
        std::fs::write(&script, "echo \"$1\"\n").unwrap();
        std::fs::set_permissions(&script, std::fs::Permissions::from_mode(0o755)).unwrap();
        assert_eq!(said(&script.display().to_string(), ""), "a  b\n");
    }
}
