"""Compilation of a mechanism of rigid bodies and modal panels into arrays."""

import itertools
import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import IDEAL
from solar_env.mechanics.bodies.beam_modes import axial_modes, bending_modes
from solar_env.mechanics.bodies.description import GROUND, AnyBody, Body, ModalPanel
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.equations.formulation import JointView
from solar_env.mechanics.equations.joint_rows import chord_sense, enter_chord
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.modal.arrays import (
    CABLE_COLUMNS,
    CABLE_LOADS,
    JOINT_LOADS,
    MOTION_COLUMNS,
    RIGID_BODY,
    ModalModel,
    ModalState,
    attachment_type,
    body_type,
    placement_type,
)
from solar_env.mechanics.modal.foreshortening import AXIAL_MODES, BENDING_MODES, quadratic_forms
from solar_env.mechanics.modal.tables import (
    EVEN_ENDS,
    EVEN_FIRST,
    FORMS,
    GROUPS,
    LANES,
    LOW,
    ODD_ENDS,
    ODD_FIRST,
    RESOLVED,
    VALUES,
    Panels,
    Tables,
    filled_tables,
)

_BLOCKS = 2  # number of blocks of pseudo-modes, which stand for the modes that are left out, see `beam_modes`
# Greatest frequency times step of damped modes with exact response. Reactions of ideal joints follow modes at once, and
# grow unstable where modes pass at arbitrary phases.
_EXACT, _EXACT_BESIDE_REACTIONS = 16.0, 4.0

_Design = tuple[float, float, float, float, float, int]


def design(panel: ModalPanel) -> _Design:
    """Return a panel's design: (length [m], mass [kg], E A [N], E I [N m2], retardation time [s], number of modes)."""
    stiffness = (panel.axial_stiffness, panel.bending_stiffness)
    return (panel.length, panel.mass, *stiffness, panel.damping, panel.modes)


def _packed_forms(project: NDArray[np.float64], ends: NDArray[np.float64], coupled: int) -> NDArray[np.float64]:
    """Rearrange the quadratic forms of a panel's shortening by bending as an array (2, 4, 4, 5), filled up with zeros.

    The shortening has the amplitude b^T K b / 2 in an axial mode, and the remainder b^T S b / 2 at an end of the panel.
    `project` has a matrix K for each axial mode, `ends` a matrix S for each end. The coordinates b are the amplitudes
    of the `coupled` lowest bending modes, then the first end's deflection and slope due to higher even modes, and the
    same due to higher odd modes. Element [g, i, k, f] of the result belongs to form f, coordinate i of group g (0 even,
    1 odd bending), and coordinate k of the same group (f = 0 to 2) or of the other group (f = 3, 4). Forms 0 and 1 are
    K of the odd axial modes, form 3 is K of the even one. Form 2 is half the difference of both S, form 4 half the sum.
    """
    forms = np.zeros((2, LOW, LOW, FORMS))
    # The lowest bending modes are even and odd by turns; then come the end values of the other modes.
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


def _halves(number: int) -> tuple[int, int]:
    """Return how many of `number` modes have odd numbers (first, third, ...), and how many have even numbers."""
    return (number + 1) // 2, number // 2


def _panel_constants(chosen: _Design) -> Panels:
    """Return the `Panels` constants of one panel design."""
    length, mass, axial_stiffness, bending_stiffness, damping, modes = chosen
    axial = (modes + 1) // 2  # number of axial modes beside the bending `modes`
    coupled, coupled_axial = min(BENDING_MODES, modes), min(AXIAL_MODES, axial)
    frequencies, rows = [], []
    for family in (
        bending_modes(length, mass, bending_stiffness, modes, _BLOCKS),
        axial_modes(length, mass, axial_stiffness, axial, _BLOCKS),
    ):
        values = len(family.rows) // 2
        even = family.rows[0] * family.rows[values] > 0.0
        for group in (even, ~even):
            rows.append(np.pad(family.rows[:values, group], ((0, VALUES - values), (0, 0))))
            frequencies.append(family.frequencies[group])
    return Panels(
        first=np.cumsum([0, *map(len, frequencies)]),
        kept=np.array(_halves(modes)),
        # The lowest bending mode is even, the lowest axial mode odd.
        coupled=np.array([*_halves(coupled), *reversed(_halves(coupled_axial))]),
        damping=np.array([damping]),
        exact=RESOLVED,
        frequency=np.concatenate(frequencies)[None],
        forms=_packed_forms(*quadratic_forms(length, mass, coupled, coupled_axial), coupled)[None],
        shapes=np.concatenate(rows, axis=1)[None],
    )


@lru_cache(maxsize=16)
def compile_panels(designs: tuple[_Design, ...], exact: float) -> tuple[Panels, Tables]:
    """Return constants and response tables of panel `designs`, which all simulations share and only read.

    The tables hold the motion of modes and ends under loads, for many step sizes h. They are exact for modes of angular
    frequency omega with omega h < 2. If the damping ratio exceeds 0.02, the limit is `exact`, which is greater than 2.
    The motion of other modes, and of any with a damping rate of 1 / h or more, is computed by the Radau method.
    """
    parts = [_panel_constants(chosen) for chosen in designs]
    joined = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in ("damping", "frequency", "forms", "shapes")
    }
    panels = parts[0]._replace(exact=exact, **joined)
    return panels, filled_tables(panels)


def rigid_stand_in(body: AnyBody) -> Body:
    """Return a rigid body with the mass and motion of a rigid body or modal panel; other kinds raise a ValueError."""
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
    """Compile a mechanism of rigid bodies and modal panels into its constant model and its initial state.

    Raises:
        ValueError: if the mechanism has a part that the modal method does not take, if a joint attaches to a panel
            elsewhere than at an end, or if panels differ in their number of modes.
    """
    for name in ("drives", "loads"):
        if getattr(mechanism, name):
            raise ValueError(f"mechanism.{name}: ModalRadau takes none; choose another integrator, and no ModalPanel")
    stand_in = replace(mechanism, bodies=tuple(rigid_stand_in(body) for body in mechanism.bodies))
    rigid, rigid_state = compile_mechanism(stand_in)
    described = list(mechanism.bodies)
    if any(GROUND in (joint.inboard, joint.outboard) for joint in mechanism.joints):
        described.append(Body("fixed frame", mass=1.0, inertia=1.0, length=1.0, centroid=(0.0, 0.0), fixed=True))
    flexible = [body for body in described if isinstance(body, ModalPanel)]
    counts = [panel.modes for panel in flexible]
    if len(set(counts)) > 1:
        raise ValueError(
            f"modes = {counts} of the panels differ, and ModalRadau keeps the amplitudes of all panels in arrays of "
            "one shape: give every ModalPanel the greatest of these numbers"
        )
    designs = tuple(dict.fromkeys(design(panel) for panel in flexible))
    # Arrays have as many designs as panels, even if panels are alike: mechanisms of one batch may differ in that.
    designs += designs[:1] * (len(flexible) - len(designs))
    # Arrays need a design even without any panel.
    exact = _EXACT_BESIDE_REACTIONS if (rigid.joints["kind"] == IDEAL).any() else _EXACT
    panels, tables = compile_panels(designs or ((1.0, 1.0, 1.0, 1.0, 0.0, 0),), exact)
    bodies, q, v = _bodies(described, designs, panels.frequency.shape[1])
    joints, cables = len(mechanism.joints), len(mechanism.cables)
    attachments = _attachments(mechanism, rigid.joints)
    for row, cable in zip(rigid.cables, mechanism.cables, strict=True):
        row["chord_sense"] = chord_sense(mechanism, cable)
        enter_chord(row, rigid.joints)
    model = ModalModel(
        bodies=bodies,
        attachments=attachments,
        joints=rigid.joints,
        cables=rigid.cables,
        folded_angle=np.array([_folded_angle(stand_in, k) for k in range(joints)]),
        gravity=np.array(mechanism.gravity, dtype=np.float64),
        panels=panels,
        tables=tables,
        length_scale=rigid.length_scale,
    )
    shared = ("integrals", "joints", "wear_journal", "wear_bearing", "clock")
    state = ModalState(
        q=q,
        v=v,
        course=np.zeros((JOINT_LOADS * joints + CABLE_LOADS * cables, LANES)),
        coupling=np.zeros((len(flexible), GROUPS, LOW, LANES)),
        damping_power=np.zeros(len(flexible)),
        turns=np.zeros((len(bodies), 2)),
        placements=np.zeros(2 * joints, placement_type),
        motion=np.zeros((joints, MOTION_COLUMNS)),
        cable_motion=np.zeros((cables, CABLE_COLUMNS)),
        views=np.zeros((joints, len(JointView._fields))),
        extremes=np.zeros(2),
        **{name: getattr(rigid_state, name) for name in shared},
    )
    return model, state


def _bodies(
    described: list[AnyBody], designs: tuple[_Design, ...], amplitudes: int
) -> tuple[NDArray[np.void], NDArray[np.float64], NDArray[np.float64]]:
    """Return the records (`body_type`), initial coordinates and initial velocities of the `described` bodies.

    Records refer by index to `designs`, the panels' data such as length and mass. A panel has `amplitudes` modes.
    """
    offsets = [0, *itertools.accumulate(3 + amplitudes * isinstance(body, ModalPanel) for body in described)]
    bodies = np.zeros(len(described), dtype=body_type)
    q, v = np.zeros(offsets[-1]), np.zeros(offsets[-1])
    panels = 0
    for record, body, first in zip(bodies, described, offsets, strict=False):
        rigid = rigid_stand_in(body)
        record["offset"], record["length"], record["panel"] = first, rigid.length, RIGID_BODY
        if isinstance(body, ModalPanel):
            record["panel"], record["design"] = panels, designs.index(design(body))
            panels += 1
        record["mass"], record["inertia"] = rigid.mass, rigid.inertia
        record["centroid_x"], record["centroid_y"] = rigid.centroid
        c, s = math.cos(rigid.angle), math.sin(rigid.angle)
        x, y = rigid.centroid
        arm = (c * x - s * y, s * x + c * y)
        q[first : first + 3] = rigid.position[0] + arm[0], rigid.position[1] + arm[1], rigid.angle
        if not rigid.fixed:
            record["inverse_mass"], record["inverse_inertia"] = 1.0 / rigid.mass, 1.0 / rigid.inertia
            u, w = rigid.velocity
            v[first : first + 3] = u - rigid.spin * arm[1], w + rigid.spin * arm[0], rigid.spin
    return bodies, q, v


def _attachments(mechanism: Mechanism, joints: NDArray[np.void]) -> NDArray[np.void]:
    """Return the joints' attachments (`attachment_type`), two for each joint, and write their indices to `joints`."""
    attachments = np.zeros(2 * len(mechanism.joints), dtype=attachment_type)
    names = [*(body.name for body in mechanism.bodies), GROUND]
    for k, joint in enumerate(mechanism.joints):
        sides = ((joint.inboard, joint.inboard_point), (joint.outboard, joint.outboard_point))
        for side, (name, (x, y)) in enumerate(sides):
            end, index = 0, names.index(name)
            if name != GROUND:
                body = mechanism.bodies[index]
                if isinstance(body, ModalPanel):
                    end = body.end((x, y))
                    x, y = end * body.length, 0.0
                centroid = rigid_stand_in(body).centroid
                x, y = x - centroid[0], y - centroid[1]
            attachments[2 * k + side] = (index, end, x, y)
        joints[k]["inboard"], joints[k]["outboard"] = 2 * k, 2 * k + 1
    return attachments


def _folded_angle(mechanism: Mechanism, k: int) -> float:
    """Return the difference [rad] between the angles of joint `k`'s outboard and inboard bodies at joint angle 0.

    Full turns are added so that the initial joint angle lies within pi of `Joint.middle`, the middle of its range.
    """
    joint = mechanism.joints[k]
    angles = {GROUND: 0.0, **{body.name: body.angle for body in mechanism.bodies}}
    angle = joint.sign * (angles[joint.outboard] - angles[joint.inboard] - joint.folded_angle)
    turns = round((angle - joint.middle) / (2.0 * math.pi))
    return joint.folded_angle + joint.sign * 2.0 * math.pi * turns
