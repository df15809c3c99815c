//! `~` in paths: a shell puts the home folder there before a program sees it, but not in files, nor after `--out=`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The path with a leading `~` replaced by the home folder; as it is where there is none.
///
/// A file that is really called `~` is `./~`.
pub fn expand_home(path: &Path) -> PathBuf {
    match (path.strip_prefix("~"), std::env::home_dir()) {
        (Ok(below), Some(home)) => home.join(below),
        _ => path.to_owned(),
    }
}

/// An argument of the command line with a leading `~`, also after `--name=`, replaced likewise.
pub fn expand_argument(argument: OsString) -> OsString {
    let Some(text) = argument.to_str() else { return argument };
    let (name, value) = match text.split_once('=') {
        Some((name, value)) if name.starts_with("--") => (format!("{name}="), value),
        _ => (String::new(), text),
    };
    if !value.starts_with('~') {
        return argument;
    }
    let mut expanded = OsString::from(name);
    expanded.push(expand_home(Path::new(value)));
    expanded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_tilde_that_stands_for_the_home_folder_is_replaced() {
        let home = std::env::home_dir().unwrap();
        let expanded = |argument: &str| expand_argument(argument.into()).into_string().unwrap();
        let below = home.join("runs/a").into_os_string().into_string().unwrap();
        assert_eq!(expanded("~/runs/a"), below);
        assert_eq!(expanded("--out=~/runs/a"), format!("--out={below}"));
        for kept in ["./~/a", "a~", "~bob/a", "--out=a~", "a=~/b", "--json", "-1"] {
            assert_eq!(expanded(kept), kept);
        }
    }
}
