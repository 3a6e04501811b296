//! Template decks with comments, ready to run.

/// A template deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Template {
    /// Name.
    pub name: &'static str,
    /// Description in one line.
    pub about: &'static str,
    /// The deck: TOML, whose first line names the schema ([`SCHEMA`]).
    pub text: &'static str,
}

/// File name of the schema ([`text`](crate::deck::json_schema::text)) in the templates; it must lie in the same
/// folder.
pub const SCHEMA: &str = "deck.schema.json";

/// All templates.
pub const TEMPLATES: [Template; 6] = [
    Template {
        name: "couplet",
        about: "two bricks and the joint between them, pulled apart",
        text: include_str!("templates/couplet.toml"),
    },
    Template {
        name: "shear-wall",
        about: "a wall pressed and pushed in its plane until it has cracked and crushed",
        text: include_str!("templates/shear-wall.toml"),
    },
    Template {
        name: "out-of-plane",
        about: "a strip of wall pushed out of its plane under its load",
        text: include_str!("templates/out-of-plane.toml"),
    },
    Template {
        name: "arch",
        about: "a semicircle of dry voussoirs under its weight, tilted",
        text: include_str!("templates/arch.toml"),
    },
    Template {
        name: "dry-wall",
        about: "dry blocks in running bond on a tilting table",
        text: include_str!("templates/dry-wall.toml"),
    },
    Template {
        name: "column",
        about: "a column of loose blocks, struck: sliding and rocking in time",
        text: include_str!("templates/column.toml"),
    },
];

/// Names of the templates.
pub const NAMES: [&str; TEMPLATES.len()] = {
    let mut names = [""; TEMPLATES.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = TEMPLATES[i].name;
        i += 1;
    }
    names
};

/// The template of this name, if there is one.
pub fn find(name: &str) -> Option<Template> {
    TEMPLATES.into_iter().find(|template| template.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_template_is_found_by_its_name_only() {
        for (name, template) in NAMES.into_iter().zip(TEMPLATES) {
            assert_eq!(find(name), Some(template));
        }
        assert_eq!(find("cathedral"), None);
    }

    #[test]
    fn templates_name_the_schema_and_are_ascii_but_for_their_drawings() {
        for template in TEMPLATES {
            let first = format!("#:schema ./{SCHEMA}\n");
            assert!(template.text.starts_with(&first), "{}", template.name);
            let keys = template.text.lines().filter(|line| !line.starts_with('#'));
            assert!(keys.into_iter().all(str::is_ascii), "{}", template.name);
        }
    }
}
