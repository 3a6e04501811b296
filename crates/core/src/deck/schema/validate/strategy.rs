//! Ranges of `[simplified]`.

use super::Checks;

impl Checks<'_> {
    pub(super) fn simplified(&mut self) {
        let Some(said) = &self.deck.simplified else {
            return;
        };
        let key = |name: &str| format!("simplified.{name}");
        self.positive(&key("f_m"), said.f_m);
        self.positive(&key("G_fc"), said.G_fc);
        self.positive(&key("kappa_p"), said.kappa_p);
        self.positive(&key("C_ss"), said.C_ss);
        let sound = said
            .mesh
            .is_none_or(|m| m.length > 0 && m.height > 0 && m.thickness > 0);
        self.require(
            sound,
            &key("mesh"),
            || "an expanded unit has at least one element each way".to_owned(),
            "mesh = [2, 1, 1]",
        );
    }
}
