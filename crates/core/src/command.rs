//! Commands that are shown, to be typed.

use std::borrow::Cow;
use std::path::Path;

/// A path as an argument of a command: in quotes where a shell would take it apart.
pub fn argument(path: &Path) -> String {
    let text = path.to_string_lossy();
    if cfg!(windows) {
        // Names have no `"` there, and cmd does not know `'`: both of its shells take `"`, but for what they expand within.
        let parts = |c: char| c.is_whitespace() || "&()^%;,='`{}@#".contains(c);
        if text.contains(parts) {
            // A backslash before the last `"` would make it one of the name.
            format!("\"{}\"", text.trim_end_matches('\\'))
        } else {
            text.into_owned()
        }
    } else {
        // No path has a NUL, which is all that cannot be quoted.
        shlex::try_quote(&text)
            .unwrap_or(Cow::Borrowed(&text))
            .into_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_shell_would_take_apart_is_quoted() {
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
