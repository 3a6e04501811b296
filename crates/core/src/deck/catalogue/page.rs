//! Tables of the catalogue for docs/reference/materials.md.

use std::fmt::Write as _;

use super::fill::rounded;
use super::{Fact, MATERIALS, Strengths, joints};

/// Tables of the materials, of their sources, and of the joints, in Markdown.
pub fn tables() -> [String; 3] {
    [values(), sources(), bonds()]
}

fn values() -> String {
    let mut text =
        "| `name` | f_c (f_b) | E | ν | density, kg/m³ | f_t | G_ft | G_fc | scatter of f_c |\n"
            .to_owned();
    text += "|---|---|---|---|---|---|---|---|---|\n";
    for material in MATERIALS {
        let mut of = Strengths {
            compression: material.strength.rule.value(Strengths::default()),
            ..Strengths::default()
        };
        of.tension = material.f_t.rule.value(of);
        let of_fact = |fact: Fact| rounded(fact.rule.value(of));
        let cells = [
            material.strength,
            material.modulus,
            material.nu,
            material.density,
            material.f_t,
            material.g_ft,
            material.g_fc,
            material.scatter,
        ];
        let cells: Vec<String> = cells
            .iter()
            .map(|fact| of_fact(*fact).to_string())
            .collect();
        // Writing to a string does not fail.
        let _ = writeln!(text, "| `{}` | {} |", material.name, cells.join(" | "));
    }
    text
}

fn sources() -> String {
    let mut text = "| Value | Rule | Source | Of |\n|---|---|---|---|\n".to_owned();
    let mut lines: Vec<(String, Vec<&str>)> = Vec::new();
    for material in MATERIALS {
        for (key, fact) in material
            .facts()
            .into_iter()
            .chain([("scatter", material.scatter)])
        {
            let rule = fact.rule.words().unwrap_or_else(|| "a value".to_owned());
            let line = format!("| `{key}` | {rule} | {} |", fact.source);
            match lines.iter_mut().find(|(known, _)| *known == line) {
                Some((_, names)) => names.push(material.name),
                None => lines.push((line, vec![material.name])),
            }
        }
    }
    lines.sort();
    for (line, names) in lines {
        let _ = writeln!(text, "{line} {} |", names.join("; "));
    }
    text
}

fn bonds() -> String {
    let mut text = "| `name` | c | f_t | G_I | G_II |\n|---|---|---|---|---|\n".to_owned();
    for joint in joints() {
        let of = Strengths {
            cohesion: joint.c.rule.value(Strengths::default()),
            ..Strengths::default()
        };
        let facts = joint.facts();
        let value = |key: &str| {
            let fact = facts.iter().find(|(own, _)| *own == key);
            fact.map_or(0.0, |(_, fact)| rounded(fact.rule.value(of)))
        };
        let cells = ["c", "f_t", "G_I", "G_II"].map(|key| value(key).to_string());
        let _ = writeln!(text, "| `{}` | {} |", joint.name, cells.join(" | "));
    }
    text
}
