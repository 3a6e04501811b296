//! Units, stones and mortars by name.

use super::{Fact, Rule, plain};
use Rule::{Crushing, ModelCode, OfStrength, OfTension, Value};

/// What a material is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// A unit or a stone; `f_b` is its strength by test.
    Unit,
    /// A mortar; `f_c` is its strength by test.
    Mortar,
}

impl Sort {
    /// What the material of this name is, if the catalogue has it.
    pub fn of(name: &str) -> Option<Self> {
        let mut all = MATERIALS.iter();
        let found = all.find(|material| plain(material.name) == plain(name));
        found.map(|material| material.sort)
    }
}

/// A material by name, as damage plasticity reads it.
#[derive(Clone, Copy, Debug)]
pub struct NamedMaterial {
    /// Name in a deck.
    pub name: &'static str,
    /// What it is.
    pub sort: Sort,
    /// Compressive strength f_c [MPa], which `f_b` of a unit or `f_c` in the deck replaces.
    pub strength: Fact,
    /// Young's modulus [MPa].
    pub modulus: Fact,
    /// Poisson's ratio [-].
    pub nu: Fact,
    /// Density [kg/m³].
    pub density: Fact,
    /// Tensile strength [MPa].
    pub f_t: Fact,
    /// Fracture energy in tension [N/mm].
    pub g_ft: Fact,
    /// Fracture energy in compression [N/mm].
    pub g_fc: Fact,
    /// Coefficient of variation of the strength [-]; for the reader, no key takes it.
    pub scatter: Fact,
}

impl NamedMaterial {
    /// Keys of a deck with their values, in the order in which they follow from each other.
    pub fn facts(&self) -> [(&'static str, Fact); 7] {
        [
            ("f_c", self.strength),
            ("E", self.modulus),
            ("nu", self.nu),
            ("density", self.density),
            ("f_t", self.f_t),
            ("G_ft", self.g_ft),
            ("G_fc", self.g_fc),
        ]
    }
}

const fn fact(rule: Rule, source: &'static str) -> Fact {
    Fact { rule, source }
}

const KAUSHIK: &str = "Kaushik, Rai and Jain (2007)";
const EN_998_2: &str = "class of EN 998-2: mean strength at 28 days";
const EN_459_1: &str = "class of EN 459-1, the standard mortar of this lime at 28 days; St Astier's data sheet of NHL 3.5 \
     has 1.5 MPa at 28 days and 5.9 MPa after a year for 1 : 2.5 by volume";
const RATIO: Fact = fact(
    OfStrength(0.05),
    "within the 3 to 10 % of Schubert (1988), after Lourenço (1996)",
);
const MORTAR_TENSION: Fact = fact(
    OfStrength(0.1),
    "assumed: the upper end of the 3 to 10 % of units; in a wall the bond opens before",
);
const DUCTILITY: Fact = fact(
    OfTension(0.029),
    "ductility index of 0.029 mm, Lourenço (2004)",
);
const DUCTILITY_ASSUMED: Fact = fact(
    OfTension(0.029),
    "assumed: the ductility index of 0.029 mm of clay bricks, Lourenço (2004)",
);
const STONE_ENERGY: Fact = fact(
    ModelCode,
    "assumed: concrete with an aggregate of 8 mm, CEB-FIP Model Code 1990",
);
const CRUSHED: Fact = fact(
    Crushing,
    "Lourenço (2004) after CEB-FIP Model Code 1990, made for f_c of 12 to 80 MPa",
);
const BRICK_NU: Fact = fact(Value(0.15), "shear walls of Lourenço (1996)");
const STONE_NU: Fact = fact(Value(0.2), "assumed: as concrete");
const MORTAR_NU: Fact = fact(Value(0.15), "D'Altri et al. (2018)");
const MORTAR_E: Fact = fact(OfStrength(200.0), KAUSHIK);
const STONE_E: Fact = fact(
    OfStrength(273.0),
    "assumed: the ratio of the sandstone of Lourenço et al. (2005), 15,500 over 56.8 MPa",
);
const UNIT_SCATTER: Fact = fact(Value(0.2), "assumed: no general figure has a source here");
const STONE_SCATTER: Fact = fact(Value(0.25), "assumed: more than bricks, of one quarry");

/// A mortar of strength `strength` [MPa] and `density` [kg/m³].
const fn mortar(name: &'static str, strength: Fact, density: Fact) -> NamedMaterial {
    NamedMaterial {
        name,
        sort: Sort::Mortar,
        strength,
        modulus: MORTAR_E,
        nu: MORTAR_NU,
        density,
        f_t: MORTAR_TENSION,
        g_ft: DUCTILITY,
        g_fc: CRUSHED,
        scatter: UNIT_SCATTER,
    }
}

const CEMENT_DENSITY: Fact = fact(
    Value(1900.0),
    "EN 1991-1-1, table A.1: lime-cement mortar 18 to 20 kN/m3",
);
const LIME_DENSITY: Fact = fact(
    Value(1600.0),
    "EN 1991-1-1, table A.1: lime mortar 12 to 18 kN/m3",
);

/// A mortar of a class of EN 998-2.
const fn class(name: &'static str, strength: f64) -> NamedMaterial {
    mortar(name, fact(Value(strength), EN_998_2), CEMENT_DENSITY)
}

/// A mortar of natural hydraulic lime.
const fn hydraulic(name: &'static str, strength: f64) -> NamedMaterial {
    mortar(name, fact(Value(strength), EN_459_1), LIME_DENSITY)
}

const CLAY: NamedMaterial = NamedMaterial {
    name: "clay brick, solid",
    sort: Sort::Unit,
    strength: fact(
        Value(20.8),
        "mean of the bricks of Kaushik, Rai and Jain (2007)",
    ),
    modulus: fact(OfStrength(300.0), KAUSHIK),
    nu: BRICK_NU,
    density: fact(Value(1800.0), "assumed: makers declare it by EN 771-1"),
    f_t: RATIO,
    g_ft: DUCTILITY,
    g_fc: CRUSHED,
    scatter: UNIT_SCATTER,
};

/// Units, stones and mortars by name.
pub const MATERIALS: &[NamedMaterial] = &[
    CLAY,
    NamedMaterial {
        name: "clay brick, hollow",
        strength: fact(Value(10.0), "assumed, over the gross area: give f_b"),
        modulus: fact(
            OfStrength(300.0),
            "assumed: as solid bricks, Kaushik, Rai and Jain (2007)",
        ),
        density: fact(
            Value(900.0),
            "assumed, gross: LD units of EN 771-1 have at most 1,000",
        ),
        f_t: fact(
            OfStrength(0.03),
            "the lower end of the 3 to 10 % of Schubert (1988), after Lourenço (1996), for webs and gross area",
        ),
        g_ft: DUCTILITY_ASSUMED,
        ..CLAY
    },
    NamedMaterial {
        name: "calcium silicate brick",
        strength: fact(
            Value(15.0),
            "the lowest of the classes 15, 20, 25 of Garbalińska, Strzałkowski and Stolarska (2020)",
        ),
        modulus: fact(
            OfStrength(300.0),
            "assumed: as clay bricks, Kaushik, Rai and Jain (2007)",
        ),
        density: fact(Value(1800.0), "assumed: makers declare it by EN 771-2"),
        g_ft: DUCTILITY_ASSUMED,
        ..CLAY
    },
    NamedMaterial {
        name: "AAC block",
        strength: fact(
            Value(2.5),
            "mean strength of blocks of 500 kg/m3 by EN 771-4, Solbet's data sheet",
        ),
        modulus: fact(
            OfStrength(700.0),
            "EN 12602: 5 (density - 150), 1,750 MPa at 500 kg/m3",
        ),
        nu: fact(Value(0.2), "EN 12602"),
        density: fact(
            Value(500.0),
            "blocks of 500 kg/m3 by EN 771-4, Solbet's data sheet",
        ),
        f_t: fact(OfStrength(0.1), "EN 12602, lower characteristic value"),
        g_ft: DUCTILITY_ASSUMED,
        ..CLAY
    },
    NamedMaterial {
        name: "granite",
        strength: fact(
            Value(70.0),
            "assumed: granites differ by their weathering; give f_b",
        ),
        modulus: fact(
            OfStrength(290.0),
            "20,200 MPa of Vasconcelos and Lourenço (2009) over the assumed 70 MPa",
        ),
        nu: STONE_NU,
        density: fact(Value(2750.0), "EN 1991-1-1, table A.2: 27 to 30 kN/m3"),
        g_ft: STONE_ENERGY,
        scatter: STONE_SCATTER,
        ..CLAY
    },
    NamedMaterial {
        name: "sandstone",
        strength: fact(
            Value(56.8),
            "prisms of Lourenço et al. (2005), by the Stone Masonry Database (Vanin et al. 2017)",
        ),
        modulus: fact(
            OfStrength(273.0),
            "15,500 MPa of Lourenço et al. (2005) over 56.8 MPa",
        ),
        nu: STONE_NU,
        density: fact(Value(2400.0), "EN 1991-1-1, table A.2: 21 to 27 kN/m3"),
        g_ft: STONE_ENERGY,
        scatter: STONE_SCATTER,
        ..CLAY
    },
    NamedMaterial {
        name: "limestone",
        strength: fact(Value(20.0), "assumed: limestones differ widely; give f_b"),
        modulus: STONE_E,
        nu: STONE_NU,
        density: fact(
            Value(2000.0),
            "EN 1991-1-1, table A.2: 20 kN/m3, dense limestone 20 to 29",
        ),
        g_ft: STONE_ENERGY,
        scatter: STONE_SCATTER,
        ..CLAY
    },
    NamedMaterial {
        name: "tuff",
        strength: fact(
            Value(7.4),
            "75.5 kgf/cm2, blocks of Fiorditufo (Cave Riunite, data sheet)",
        ),
        modulus: STONE_E,
        nu: STONE_NU,
        density: fact(
            Value(2000.0),
            "EN 1991-1-1, table A.2: volcanic tuff 20 kN/m3; Neapolitan tuff is much lighter",
        ),
        g_ft: STONE_ENERGY,
        scatter: STONE_SCATTER,
        ..CLAY
    },
    class("M1", 1.0),
    class("M2.5", 2.5),
    class("M5", 5.0),
    class("M10", 10.0),
    class("M15", 15.0),
    class("M20", 20.0),
    hydraulic("NHL 2", 2.0),
    hydraulic("NHL 3.5", 3.5),
    hydraulic("NHL 5", 5.0),
    mortar(
        "lime",
        fact(
            Value(1.0),
            "assumed: the lowest class of EN 998-2; air lime hardens for years",
        ),
        LIME_DENSITY,
    ),
];
