"""Running integrals and force maxima, to which an accepted step adds, and the energies that are stored."""

import math

from solar_env.mechanics.arrays.columns import ANGLE, RATE
from solar_env.mechanics.arrays.model import (
    CABLE,
    CLEARANCE,
    CONTACT,
    ELASTIC,
    FRICTION_DISSIPATION,
    GRAVITY,
    IDEAL,
    IMPULSE,
    INTEGRALS_PER_JOINT,
    KINETIC,
    NORMAL_DISSIPATION,
    SLIDING_WORK,
)
from solar_env.mechanics.joints.cable_loop import cable_torque
from solar_env.mechanics.joints.contact import contact_energy, normal_force
from solar_env.mechanics.joints.torques import (
    add_cable_power,
    add_torque_energies,
    add_torque_powers,
    hinge_torques,
)
from solar_env.mechanics.modal.arrays import DEPTH, DEPTH_RATE, RIGID_BODY, SLIDING_SPEED, SLIP, STRETCH, WHEEL_RATE
from solar_env.mechanics.modal.panel.coupling import axial_form, foreshorten_pose
from solar_env.mechanics.modal.panel.oscillators import WEIGHT_A, WEIGHT_B
from solar_env.mechanics.modal.panel.tables import AXIAL_EVEN, GROUPS
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.records.history import note_force


@kernel(inlined=True)
def add_integrals(model, state, work, h):
    """Add a step's part of the joints' integrals in the workspace, from loads and motion at its stages."""
    integrals = work.integrals
    for j in range(model.joints.size):
        joint, own, first = model.joints[j], state.joints[j], INTEGRALS_PER_JOINT * j
        for s in range(2):
            weight = h * (WEIGHT_A if s == 0 else WEIGHT_B)
            motion, load = work.joints[j].motion[s], work.joints[j].load[s]
            torques = hinge_torques(joint, own, motion[ANGLE], motion[RATE])
            add_torque_powers(torques, motion[RATE], weight, j, integrals)
            if joint.kind == IDEAL:
                integrals[first + IMPULSE] += weight * math.sqrt(load[0] * load[0] + load[1] * load[1])
            elif own.in_contact:
                normal = max(load[0], 0.0)
                _, elastic, _, _ = normal_force(joint, motion[DEPTH], motion[DEPTH_RATE], own.impact_speed)
                integrals[first + NORMAL_DISSIPATION] += weight * (normal - elastic) * motion[DEPTH_RATE]
                integrals[first + FRICTION_DISSIPATION] -= weight * load[1] * motion[SLIP]
                integrals[first + IMPULSE] += weight * normal
                integrals[first + SLIDING_WORK] += weight * normal * abs(motion[SLIDING_SPEED])
    for c in range(model.cables.size):
        cable = model.cables[c]
        for s in range(2):
            weight = h * (WEIGHT_A if s == 0 else WEIGHT_B)
            motion = work.cables[c].motion[s]
            torque, _, _ = cable_torque(cable, motion[STRETCH])
            add_cable_power(cable, torque, motion[WHEEL_RATE], weight, integrals)


@kernel(inlined=True)
def note_peaks(model, state, work, h, share):
    """Raise the force maxima to those of the step: of its stages, and of the parabola through them and its start."""
    postlock = state.clock[0].latched_joints > 0
    for j in range(model.joints.size):
        own, load = state.joints[j], work.joints[j].load
        if own.in_contact:
            start, first, second = state.loads[j, 0], load[0, 0], load[1, 0]
            peak = max(first, second)
            if first > start and first > second:
                curvature = 1.5 * (second - start - 3.0 * (first - start))
                slope = second - start - curvature
                peak = max(peak, start - 0.25 * slope * slope / curvature)
            note_force(own, peak, postlock)


@kernel(inlined=True)
def panel_energies(model, body, q, v, work, energies):
    """Add the energies of a panel's amplitudes: kinetic, and of its strain."""
    panels, d, first, own = model.panels, body.design, body.offset + 3, work.panels[body.panel]
    foreshorten_pose(panels, own, d, q[first:], v[first:])
    for group in range(GROUPS):
        for k in range(panels.first[group], panels.first[group + 1]):
            stretch, r = q[first + k], k - panels.first[group]
            if group >= AXIAL_EVEN and r < panels.coupled[group]:
                stretch -= own.shortening[0, 0, axial_form(group, r)]
            energies[ELASTIC] += 0.5 * (panels.modes[d, k].frequency * stretch) ** 2
            energies[KINETIC] += 0.5 * v[first + k] ** 2


@kernel
def stored_energies(model, state, q, v, work, slot, energies):
    """Fill the stored energies [J] of a configuration that a slot has been filled for."""
    energies[:] = 0.0
    for b in range(model.bodies.size):
        body = model.bodies[b]
        k = body.offset
        if body.inverse_mass > 0.0:
            energies[KINETIC] += 0.5 * body.mass * (v[k] * v[k] + v[k + 1] * v[k + 1])
            energies[KINETIC] += 0.5 * body.inertia * v[k + 2] * v[k + 2]
            energies[GRAVITY] -= body.mass * (model.gravity[0] * q[k] + model.gravity[1] * q[k + 1])
        if body.panel != RIGID_BODY:
            panel_energies(model, body, q, v, work, energies)
    for j in range(model.joints.size):
        joint, own, motion = model.joints[j], state.joints[j], work.joints[j].motion[slot]
        add_torque_energies(joint, own, motion[ANGLE], energies)
        if joint.kind == CLEARANCE:
            energies[CONTACT] += contact_energy(joint, motion[DEPTH])
    for c in range(model.cables.size):
        _, _, energy = cable_torque(model.cables[c], work.cables[c].motion[slot, STRETCH])
        energies[CABLE] += energy
