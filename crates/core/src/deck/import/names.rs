//! Names of sets: as written, with other capitals, or without their instance.

/// Finds the name that `wanted` denotes among those of a file: an equal one; else the only one that differs in
/// capitals alone; else the only `INSTANCE.SET` that ends in it.
pub fn find<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let names: Vec<&str> = names.into_iter().collect();
    let only = |fits: &dyn Fn(&str) -> bool| {
        let mut found = names.iter().copied().filter(|name| fits(name));
        match (found.next(), found.next()) {
            (Some(name), None) => Some(name),
            _ => None,
        }
    };
    let ends = |name: &str| {
        name.split_once('.')
            .is_some_and(|(_, set)| set.eq_ignore_ascii_case(wanted))
    };
    only(&|name| name == wanted)
        .or_else(|| only(&|name| name.eq_ignore_ascii_case(wanted)))
        .or_else(|| only(&ends))
}

#[cfg(test)]
mod tests {
    use super::find;

    #[test]
    fn a_name_is_found_without_case_or_prefix_if_unique() {
        let names = ["Brick-1.Top", "Brick-2.Base", "bricks", "Bricks"];
        let find = |wanted| find(wanted, names);
        assert_eq!(find("Bricks"), Some("Bricks"));
        assert_eq!(find("BRICKS"), None, "two of them");
        assert_eq!(find("brick-1.top"), Some("Brick-1.Top"));
        assert_eq!(find("TOP"), Some("Brick-1.Top"));
        assert_eq!(find("Brick-1"), None);
    }
}
