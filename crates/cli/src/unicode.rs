//! Capabilities of the terminal: characters, colours, width.

use std::ffi::OsString;

/// Whether UTF-8 may be written: by the locale, or always on Windows.
pub fn is_on() -> bool {
    cfg!(windows) || says_utf8(|name| std::env::var_os(name))
}

/// Decides by the first of these variables that is set and not empty, as POSIX requires.
fn says_utf8(variable: impl Fn(&str) -> Option<OsString>) -> bool {
    let set = ["LC_ALL", "LC_CTYPE", "LANG"]
        .into_iter()
        .filter_map(variable);
    let locale = set
        .map(|value| value.to_string_lossy().to_lowercase())
        .find(|v| !v.is_empty());
    locale.is_some_and(|locale| locale.contains("utf-8") || locale.contains("utf8"))
}

/// Whether colours are wanted: a non-empty NO_COLOR turns them off (no-color.org).
pub fn colours() -> bool {
    std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Width of the terminal on standard error in columns; 80 if unknown.
pub fn width() -> usize {
    let size = terminal_size::terminal_size_of(std::io::stderr());
    size.map_or(80, |(width, _)| usize::from(width.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_variable_that_says_something_decides() {
        let on = |set: &[(&str, &str)]| {
            says_utf8(|name| {
                set.iter()
                    .find(|(n, _)| *n == name)
                    .map(|(_, v)| (*v).into())
            })
        };
        assert!(on(&[("LANG", "en_GB.UTF-8")]));
        assert!(on(&[("LC_ALL", ""), ("LC_CTYPE", "C.utf8")]));
        assert!(!on(&[("LC_ALL", "C"), ("LANG", "en_GB.UTF-8")]));
        assert!(!on(&[]));
    }
}
