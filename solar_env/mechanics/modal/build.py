"""Compile a described mechanism of rigid bodies and modal panels into its arrays."""

import itertools
import math
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.bodies.beam_modes import EndModes, axial_modes, bending_modes
from solar_env.mechanics.bodies.description import GROUND, AnyBody, Body, ModalPanel, Point
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.equations.joint_rows import chord_sense
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.modal.arrays import RIGID_BODY, ModalModel, ModalState, attachment_type, body_type
from solar_env.mechanics.modal.panel.foreshortening import AXIAL_MODES, BENDING_MODES, quadratic_forms
from solar_env.mechanics.modal.panel.tables import (
    EVEN_ENDS,
    EVEN_FIRST,
    FORMS,
    GROUPS,
    LOW,
    ODD_ENDS,
    ODD_FIRST,
    VALUES,
    Panels,
    Tables,
    filled_tables,
    mode_type,
)

# Of pseudo-modes that stand for the modes that are left out, see `beam_modes`.
_BLOCKS = 2

_Design = tuple[float, float, float, float, float, int]


def design(panel: ModalPanel) -> _Design:
    """Parameters that two panels of one design have in common."""
    stiffness = (panel.axial_stiffness, panel.bending_stiffness)
    return (panel.length, panel.mass, *stiffness, panel.damping, panel.modes)


def axial_count(modes: int) -> int:
    """Number of axial modes that are kept beside so many bending modes."""
    return (modes + 1) // 2


class _PanelModes(NamedTuple):
    """Modes of one design by group, see `Panels`."""

    first: NDArray[np.int64]
    kept: NDArray[np.int64]
    coupled: NDArray[np.int64]
    frequency: NDArray[np.float64]
    rows: NDArray[np.float64]
    forms: NDArray[np.float64]


def _groups(modes: EndModes) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Numbers of the even modes and of the odd ones: as seen by the first value of both ends."""
    even = modes.rows[0] * modes.rows[len(modes.rows) // 2] > 0.0
    return np.flatnonzero(even), np.flatnonzero(~even)


def _packed_forms(project: NDArray[np.float64], ends: NDArray[np.float64], coupled: int) -> NDArray[np.float64]:
    """(2, LOW, LOW, FORMS) quadratic forms by bending groups; products of another parity vanish."""
    forms = np.zeros((2, LOW, LOW, FORMS))
    # The lowest bending modes are even and odd by turns; then comes the rest of the end values.
    rest = range(coupled, coupled + VALUES), range(coupled + VALUES, coupled + 2 * VALUES)
    groups = [[*range(group, coupled, 2), *rest[group]] for group in range(2)]
    odd, even = list(project[::2]), list(project[1::2])
    whole = {ODD_ENDS: 0.5 * (ends[0] - ends[1]), EVEN_ENDS: 0.5 * (ends[0] + ends[1])}
    whole |= {ODD_FIRST + k: form for k, form in enumerate(odd)} | {EVEN_FIRST + k: form for k, form in enumerate(even)}
    for number, form in whole.items():
        for group in range(2):
            partner = group if number < EVEN_FIRST else 1 - group
            block = form[np.ix_(groups[group], groups[partner])]
            forms[group, : block.shape[0], : block.shape[1], number] = block
    return forms


def _design_modes(chosen: _Design) -> _PanelModes:
    length, mass, axial_stiffness, bending_stiffness, _, modes = chosen
    axial, coupled, coupled_axial = axial_count(modes), min(BENDING_MODES, modes), min(AXIAL_MODES, axial_count(modes))
    frequencies, rows, sizes = [], [], []
    for family in (
        bending_modes(length, mass, bending_stiffness, modes, _BLOCKS),
        axial_modes(length, mass, axial_stiffness, axial, _BLOCKS),
    ):
        for group in _groups(family):
            values = family.rows[: len(family.rows) // 2, group].T
            rows.append(np.pad(values, ((0, 0), (0, VALUES - values.shape[1]))))
            frequencies.append(family.frequencies[group])
            sizes.append(group.size)
    return _PanelModes(
        np.cumsum([0, *sizes]),
        np.array([(modes + 1) // 2, modes // 2, axial // 2, (axial + 1) // 2]),
        np.array([(coupled + 1) // 2, coupled // 2, coupled_axial // 2, (coupled_axial + 1) // 2]),
        np.concatenate(frequencies),
        np.concatenate(rows),
        _packed_forms(*quadratic_forms(length, mass, coupled, coupled_axial), coupled),
    )


@lru_cache(maxsize=16)
def compile_panels(designs: tuple[_Design, ...]) -> tuple[Panels, Tables]:
    """Constants and tables of panels of some designs; they are read only and shared by all simulations."""
    parts = [_design_modes(chosen) for chosen in designs]
    panels = Panels(
        first=parts[0].first,
        kept=parts[0].kept,
        coupled=parts[0].coupled,
        damping=np.array([chosen[4] for chosen in designs]),
        modes=np.zeros((len(parts), parts[0].frequency.size), mode_type),
        forms=np.stack([part.forms for part in parts]),
    )
    panels.modes["frequency"] = np.stack([part.frequency for part in parts])
    panels.modes["row"] = np.stack([part.rows for part in parts])
    return panels, filled_tables(panels)


def rigid_stand_in(body: AnyBody) -> Body:
    """A rigid body of the same mass, place and motion.

    Raises:
        ValueError: if the body is neither rigid nor a modal panel.
    """
    if isinstance(body, Body):
        return body
    if isinstance(body, ModalPanel):
        rigid = Body(body.name, body.mass, body.inertia, body.length, body.centroid)
        return replace(rigid, position=body.position, angle=body.angle, velocity=body.velocity, spin=body.spin)
    raise ValueError(
        f"body {body.name!r} is a {type(body).__name__}, which does not go with ModalRadau; describe it as a "
        "ModalPanel or a Body, or choose another integrator"
    )


def compile_modal(mechanism: Mechanism) -> tuple[ModalModel, ModalState]:
    """Return the constant model and the initial state of a mechanism of rigid bodies and modal panels.

    Raises:
        ValueError: if a part is there that the modal method does not take, if a joint attaches to a panel elsewhere
            than at an end, or if panels differ in their number of modes.
    """
    for name in ("drives", "loads"):
        if getattr(mechanism, name):
            raise ValueError(f"mechanism.{name}: ModalRadau takes none; choose another integrator, and no ModalPanel")
    stand_in = replace(mechanism, bodies=tuple(rigid_stand_in(body) for body in mechanism.bodies))
    model, state = compile_mechanism(stand_in)
    bodies, coordinates, velocities = _bodies(mechanism)
    attachments = _attachments(mechanism, model.joints)
    designs = tuple(dict.fromkeys(design(body) for body in mechanism.bodies if isinstance(body, ModalPanel)))
    # Arrays need a design even where no body has one.
    panels, tables = compile_panels(designs or ((1.0, 1.0, 1.0, 1.0, 0.0, 0),))
    folded = np.array([_folded_angle(mechanism, k) for k in range(len(mechanism.joints))])
    compiled = ModalModel(
        bodies,
        attachments,
        model.joints,
        model.cables,
        folded,
        np.array(mechanism.gravity, dtype=np.float64),
        panels,
        tables,
        model.length_scale,
    )
    for cable in mechanism.cables:
        if cable.wheel_radius is not None:
            raise ValueError(
                f"CableLoop.wheel_radius = {cable.wheel_radius!r}: ModalRadau takes no loops that pull on bearings; "
                "choose another integrator, with flexible panels beams of cable elements (FlexibleBody)"
            )
    model.cables["chord_sense"] = [chord_sense(mechanism, cable) for cable in mechanism.cables]
    joints = len(mechanism.joints)
    initial = ModalState(
        q=coordinates,
        v=velocities,
        loads=np.zeros((joints, 3)),
        load_rates=np.zeros((joints, 3)),
        cable_loads=np.zeros((len(mechanism.cables), 2)),
        coupling=np.zeros((int((bodies["panel"] >= 0).sum()), GROUPS, LOW)),
        extremes=np.zeros(2),
        integrals=state.integrals,
        joints=state.joints,
        wear_journal=state.wear_journal,
        wear_bearing=state.wear_bearing,
        clock=state.clock,
    )
    return compiled, initial


def _bodies(mechanism: Mechanism) -> tuple[NDArray[np.void], NDArray[np.float64], NDArray[np.float64]]:
    described = list(mechanism.bodies)
    if any(GROUND in (joint.inboard, joint.outboard) for joint in mechanism.joints):
        described.append(Body("fixed frame", mass=1.0, inertia=1.0, length=1.0, centroid=(0.0, 0.0), fixed=True))
    panels = [body for body in described if isinstance(body, ModalPanel)]
    counts = [panel.modes for panel in panels]
    if len(set(counts)) > 1:
        raise ValueError(
            f"modes = {counts} of the panels differ, and ModalRadau keeps the amplitudes of all panels in arrays of "
            "one shape: give every ModalPanel the greatest of these numbers"
        )
    amplitudes = 0
    if panels:
        amplitudes = _design_modes(design(panels[0])).frequency.size
    designs = list(dict.fromkeys(design(panel) for panel in panels))
    sizes = [3 + amplitudes * isinstance(body, ModalPanel) for body in described]
    offsets = [0, *itertools.accumulate(sizes)]
    bodies = np.zeros(len(described), dtype=body_type)
    q, v = np.zeros(offsets[-1]), np.zeros(offsets[-1])
    for k, body in enumerate(described):
        record, rigid = bodies[k], rigid_stand_in(body)
        record["offset"], record["length"] = offsets[k], rigid.length
        record["panel"] = panels.index(body) if isinstance(body, ModalPanel) else RIGID_BODY
        record["design"] = designs.index(design(body)) if isinstance(body, ModalPanel) else 0
        record["mass"], record["inertia"] = rigid.mass, rigid.inertia
        record["centroid_x"], record["centroid_y"] = rigid.centroid
        c, s = math.cos(rigid.angle), math.sin(rigid.angle)
        x, y = rigid.centroid
        arm = (c * x - s * y, s * x + c * y)
        q[offsets[k] : offsets[k] + 3] = rigid.position[0] + arm[0], rigid.position[1] + arm[1], rigid.angle
        if not rigid.fixed:
            record["inverse_mass"], record["inverse_inertia"] = 1.0 / rigid.mass, 1.0 / rigid.inertia
            v[offsets[k] : offsets[k] + 3] = (
                rigid.velocity[0] - rigid.spin * arm[1],
                rigid.velocity[1] + rigid.spin * arm[0],
                rigid.spin,
            )
    return bodies, q, v


def _attachments(mechanism: Mechanism, joints: NDArray[np.void]) -> NDArray[np.void]:
    """Attachments of the joints, in whose rows they are entered."""
    index = {body.name: k for k, body in enumerate(mechanism.bodies)}
    index[GROUND] = len(mechanism.bodies)
    attachments = np.zeros(2 * len(mechanism.joints), dtype=attachment_type)
    for k, joint in enumerate(mechanism.joints):
        sides = ((joint.inboard, joint.inboard_point), (joint.outboard, joint.outboard_point))
        for side, (name, point) in enumerate(sides):
            body = None if name == GROUND else mechanism.bodies[index[name]]
            attachments[2 * k + side] = (index[name], *_place(body, point))
        joints[k]["inboard"], joints[k]["outboard"] = 2 * k, 2 * k + 1
    return attachments


def _place(body: AnyBody | None, point: Point) -> tuple[int, float, float]:
    """End, and place from the centre of mass, of a point of a body's frame; the ground is None."""
    if body is None:
        return 0, point[0], point[1]
    if isinstance(body, ModalPanel):
        end = body.end(point)
        return end, (end - 0.5) * body.length, 0.0
    rigid = rigid_stand_in(body)
    return 0, point[0] - rigid.centroid[0], point[1] - rigid.centroid[1]


def _folded_angle(mechanism: Mechanism, k: int) -> float:
    """Difference of the bodies' angles at joint angle 0, of which the initial one lies within pi of its middle."""
    joint = mechanism.joints[k]
    angles = {GROUND: 0.0, **{body.name: rigid_stand_in(body).angle for body in mechanism.bodies}}
    angle = joint.sign * (angles[joint.outboard] - angles[joint.inboard] - joint.folded_angle)
    turns = round((angle - joint.middle) / (2.0 * math.pi))
    return joint.folded_angle + joint.sign * 2.0 * math.pi * turns
