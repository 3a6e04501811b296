"""Materials and joints, exported by :mod:`wythe.build`."""

from __future__ import annotations

from collections.abc import Mapping

from wythe._model import Value
from wythe._parts import Part, Quantity, Rows, _part


def elastic(E: Quantity, nu: float, *, density: Quantity | None = None) -> Part:
    """A linear elastic material: Young's modulus [MPa], Poisson's ratio, density [tonne/mm^3]."""
    return _part(E=E, nu=nu, density=density)


def damage_plasticity(
    E: Quantity,
    nu: float,
    tension: Rows | None = None,
    compression: Rows | None = None,
    *,
    f_t: Quantity | None = None,
    G_ft: Quantity | None = None,
    f_c: Quantity | None = None,
    G_fc: Quantity | None = None,
    reference_length: Quantity | None = None,
    dilation_angle: Quantity | None = None,
    eccentricity: float | None = None,
    fb0_fc0: float | None = None,
    K_c: float | None = None,
    tension_recovery: float | None = None,
    compression_recovery: float | None = None,
    viscosity: Quantity | None = None,
    crack_band: str | None = None,
    interpolation: str | None = None,
    density: Quantity | None = None,
) -> Part:
    """A material that cracks and crushes, by damage plasticity (concrete damaged plasticity).

    Parameters
    ----------
    E, nu
        Young's modulus [MPa], Poisson's ratio.
    tension, compression
        Rows of stress [MPa] (positive), inelastic strain and damage. Shape (rows, 3).
    f_t, G_ft
        Tensile strength [MPa] and its fracture energy [N/mm], instead of ``tension``.
    f_c, G_fc
        Compressive strength [MPa] and its energy beyond the peak [N/mm], instead of ``compression``.
    reference_length
        Size of the elements for which the tables hold [mm].
    crack_band
        Element length compared with it: "projected" (the default), the length of the element across the crack, or
        "volume", the cube root of its volume.
    """
    return _part(
        E=E,
        nu=nu,
        tension=tension,
        compression=compression,
        f_t=f_t,
        G_ft=G_ft,
        f_c=f_c,
        G_fc=G_fc,
        reference_length=reference_length,
        dilation_angle=dilation_angle,
        eccentricity=eccentricity,
        fb0_fc0=fb0_fc0,
        K_c=K_c,
        tension_recovery=tension_recovery,
        compression_recovery=compression_recovery,
        viscosity=viscosity,
        crack_band=crack_band,
        interpolation=interpolation,
        density=density,
    )


def drucker_prager(
    E: Quantity,
    nu: float,
    c: Quantity,
    phi: Quantity,
    f_t: Quantity,
    *,
    psi: Quantity | None = None,
    G_I: Quantity | None = None,
    G_c: Quantity | None = None,
    reference_length: Quantity | None = None,
    density: Quantity | None = None,
) -> Part:
    """A material with a smooth cone of Drucker and Prager and a tensile strength, for stone and soil.

    Parameters
    ----------
    E, nu
        Young's modulus [MPa], Poisson's ratio.
    c, phi, psi
        Cohesion [MPa], friction angle and dilation angle [degrees]; ``psi`` is ``phi`` if not given.
    f_t
        Tensile strength [MPa].
    G_I, G_c
        Fracture energies in tension and compression [N/mm]; without them the material does not soften.
    """
    return _part(
        kind="drucker-prager",
        E=E,
        nu=nu,
        c=c,
        phi=phi,
        psi=psi,
        f_t=f_t,
        G_I=G_I,
        G_c=G_c,
        reference_length=reference_length,
        density=density,
    )


def by_name(name: str, **keys: Value) -> Part:
    """A material or a joint of the catalogue (docs/reference/materials.md), such as "M5" or "M5 on clay".

    ``keys`` are those of the deck, such as ``f_b="20 MPa"``; they come before the values of the catalogue.
    """
    return _part(name=name, **keys)


def joint(
    f_t: Quantity,
    c: Quantity,
    tan_phi: float,
    mu: float,
    *,
    zeta: float,
    xi: float,
    u_k: Quantity | None = None,
    G_I: Quantity | None = None,
    delta_k: Quantity | None = None,
    G_II: Quantity | None = None,
    penalty_factor: float | None = None,
    normal_stiffness: Quantity | None = None,
    shear_stiffness: Quantity | None = None,
    coupling: str | None = None,
    scatter: Mapping[str, float] | None = None,
) -> Part:
    """A bonded joint that opens under tension, slides under shear, softens, and has friction.

    Parameters
    ----------
    f_t, c
        Tensile strength and cohesion [MPa].
    tan_phi, mu
        Friction coefficients of the bond and of the broken joint.
    zeta, xi
        Brittleness in tension and shear.
    u_k, G_I
        Ultimate opening [mm] or fracture energy [N/mm]; one of the two.
    delta_k, G_II
        Ultimate slip [mm] or fracture energy [N/mm]; one of the two.
    penalty_factor, normal_stiffness, shear_stiffness
        Numerical stiffness: a factor of the stiffness of the elements, or both values explicitly [N/mm^3].
    scatter
        Lognormal bond strength for each unit, such as ``{"cv": 0.3, "seed": 1}``.
    """
    return _part(
        f_t=f_t,
        c=c,
        tan_phi=tan_phi,
        mu=mu,
        zeta=zeta,
        xi=xi,
        u_k=u_k,
        G_I=G_I,
        delta_k=delta_k,
        G_II=G_II,
        penalty_factor=penalty_factor,
        normal_stiffness=normal_stiffness,
        shear_stiffness=shear_stiffness,
        coupling=coupling,
        scatter=scatter,
    )


def dry_joint(
    mu: float,
    *,
    penalty_factor: float | None = None,
    normal_stiffness: Quantity | None = None,
    shear_stiffness: Quantity | None = None,
) -> Part:
    """A joint without bond, with friction only."""
    return _part(
        f_t=0,
        c=0,
        tan_phi=mu,
        mu=mu,
        penalty_factor=penalty_factor,
        normal_stiffness=normal_stiffness,
        shear_stiffness=shear_stiffness,
    )


def cap_joint(
    f_t: Quantity,
    c: Quantity,
    tan_phi: float,
    mu: float,
    *,
    f_m: Quantity,
    kappa_p: Quantity,
    G_fc: Quantity,
    G_I: Quantity | None = None,
    G_II: Quantity | None = None,
    C_nn: float | None = None,
    C_ss: float | None = None,
    closes: bool | None = None,
    tan_psi: float | None = None,
    sigma_u: Quantity | None = None,
    delta: Quantity | None = None,
    penalty_factor: float | None = None,
    normal_stiffness: Quantity | None = None,
    shear_stiffness: Quantity | None = None,
    scatter: Mapping[str, float] | None = None,
) -> Part:
    """A joint with tension cut-off, Coulomb friction and a compression cap, for units that are expanded by half a joint.

    Parameters
    ----------
    f_t, c
        Tensile strength and cohesion [MPa].
    tan_phi, mu
        Friction coefficients of the bond and of the broken joint.
    f_m, kappa_p, G_fc
        Compressive strength [MPa], plastic closing at it [mm], energy of crushing [N/mm].
    G_I, G_II
        Fracture energies in tension and shear [N/mm].
    C_nn, C_ss
        Weights of normal and shear stress in the cap.
    closes
        Whether an opened joint closes without traction until its faces meet.
    tan_psi, sigma_u, delta
        Dilatancy at the start of slip, the pressure without dilatancy [MPa], its decay with slip [1/mm].
    penalty_factor, normal_stiffness, shear_stiffness, scatter
        See :func:`joint`.
    """
    return _part(
        kind="cap",
        f_t=f_t,
        c=c,
        tan_phi=tan_phi,
        mu=mu,
        f_m=f_m,
        kappa_p=kappa_p,
        G_fc=G_fc,
        G_I=G_I,
        G_II=G_II,
        C_nn=C_nn,
        C_ss=C_ss,
        closes=closes,
        tan_psi=tan_psi,
        sigma_u=sigma_u,
        delta=delta,
        penalty_factor=penalty_factor,
        normal_stiffness=normal_stiffness,
        shear_stiffness=shear_stiffness,
        scatter=scatter,
    )
