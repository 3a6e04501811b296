//! Materials and interfaces of walls of bricks.

/// Elastic brick, mortar and steel, a mortar joint and a dry one: the head of a deck.
pub const MATERIALS: &str = "format = 1
[materials.brick]
E = 16700
nu = 0.15
density = \"1900 kg/m^3\"
[materials.mortar]
E = 850
nu = 0.15
density = \"1800 kg/m^3\"
[materials.steel]
E = 210000
nu = 0.3
density = \"7850 kg/m^3\"
[interfaces.joint]
f_t = 0.2
c = 0.22
tan_phi = 0.75
mu = 0.75
zeta = 4.38
xi = 1.1
u_k = 0.36
delta_k = 0.4
[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.6
mu = 0.6
";
