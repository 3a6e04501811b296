//! Text of commands that are shown to be typed.

use std::borrow::Cow;
use std::path::Path;

/// A path as an argument of a command, in quotes where a shell would split or expand it.
pub fn argument(path: &Path) -> String {
    let text = path.to_string_lossy();
    if cfg!(windows) {
        // Names on Windows contain no `"`, and cmd does not know `'`. Both of its shells accept `"`, but expand some
        // characters within it.
        let parts = |c: char| c.is_whitespace() || "&()^%;,='`{}@#".contains(c);
        if text.contains(parts) {
            // A backslash before the last `"` would escape it.
            format!("\"{}\"", text.trim_end_matches('\\'))
        } else {
            text.into_owned()
        }
    } else {
        // Only NUL cannot be quoted, and no path contains it.
        shlex::try_quote(&text)
            .unwrap_or(Cow::Borrowed(&text))
            .into_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_that_a_shell_would_split_are_quoted() {
        let told = |path: &str| argument(Path::new(path));
        assert_eq!(told("walls/j7d.toml"), "walls/j7d.toml");
        for path in ["my walls/j7d.toml", "j7d (2).toml", "it's (a) wall.toml"] {
            if cfg!(not(windows)) {
                assert_eq!(shlex::split(&told(path)).unwrap(), [path]);
            }
            assert_ne!(told(path), path);
        }
    }
}
