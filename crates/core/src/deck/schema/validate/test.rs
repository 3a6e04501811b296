//! `[test]`: sizes and probes that its evaluation needs.

use super::Checks;
use crate::deck::keys;

impl Checks<'_> {
    pub(super) fn test(&mut self) {
        let Some(test) = &self.deck.test else {
            return;
        };
        for key in test.missing() {
            self.require(
                false,
                &format!("test.{key}"),
                || "the evaluation of this kind needs it".to_owned(),
                &keys::example(&format!("test.{key}")),
            );
        }
        let lengths = [
            ("length", test.length),
            ("thickness", test.thickness),
            ("height", test.height),
            ("lever", test.lever),
        ];
        for (key, length) in lengths {
            if let Some(length) = length {
                self.positive(&format!("test.{key}"), length);
            }
        }
        for name in test.probes() {
            let there = self.deck.probes.iter().any(|probe| probe.name == *name);
            self.require(
                there,
                "test.kind",
                || {
                    format!(
                        "the evaluation of this kind reads the probe `{name}`, which is not there"
                    )
                },
                &format!("add [[probes]] with name = \"{name}\", as `wythe new --test` writes it"),
            );
        }
    }
}
