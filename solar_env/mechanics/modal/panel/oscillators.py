"""Response of one mode to its start values and to a load through the two stages of a Radau IIA step.

y'' + 2 delta y' + omega^2 y = f. The stages are at a third of the step and at its end (E. Hairer and G. Wanner, Solving
Ordinary Differential Equations II, 2nd ed., Springer 1996, section IV.5, doi:10.1007/978-3-642-05221-7). A mode that
the step resolves answers the load's collocation polynomial exactly. The others answer as the method makes them, which
dampens what it cannot follow; exact values there, at arbitrary phases, would be unstable with ideal joints.
"""

import math

from solar_env.mechanics.numerics.jit import kernel

# Stage s, load k: velocities gain h A[s][k] f_k, positions h^2 B[s][k] f_k, with B = A A.
A = ((5.0 / 12.0, -1.0 / 12.0), (3.0 / 4.0, 1.0 / 4.0))
B = ((1.0 / 9.0, -1.0 / 18.0), (1.0 / 2.0, 0.0))
NODES = (1.0 / 3.0, 1.0)
# Weights of the stages in an integral over the step.
WEIGHT_A, WEIGHT_B = 0.75, 0.25

# Rows of the coefficients of a mode: from its start value, from its start rate, and from the loads of the two stages.
FROM_VALUE, FROM_RATE, FROM_LOAD = 0, 4, 8
# Each has four: value and rate at the first stage, then at the second, see `column`.
COEFFICIENTS = 16
# A step resolves a mode whose omega h is below this.
RESOLVED = 2.0
_TERMS = 26
_NEGLIGIBLE = 1e-20  # part of what a term is added to


@kernel(inlined=True)
def resolved(frequency, damping_rate, h):
    """Whether a step `h` [s] resolves a mode."""
    return frequency * h < RESOLVED and 2.0 * damping_rate * h < RESOLVED


@kernel(inner=True)
def exact_coefficients(frequency, damping_rate, h, coefficients):
    """Fill (COEFFICIENTS,) for a mode that the step resolves: by its Taylor series, whose terms fall as 1/n!."""
    square, damping = (frequency * h) ** 2, 2.0 * damping_rate * h
    for case in range(4):
        # Start value, start rate, then the loads 1.5 - 1.5 t and -0.5 + 1.5 t, which are one at their own stage.
        c = 1.0 if case == 0 else 0.0
        following = h if case == 1 else 0.0
        load0, load1 = 0.0, 0.0
        if case == 2:
            load0, load1 = 1.5 * h * h, -1.5 * h * h
        elif case == 3:
            load0, load1 = -0.5 * h * h, 1.5 * h * h
        y1, r1, y2, r2 = c, following, c, following
        third = 1.0
        scale = 1.0 if case == 0 else (h if case == 1 else h * h)
        for n in range(_TERMS):
            load = load0 if n == 0 else (load1 if n == 1 else 0.0)
            # First the term in t^(n + 1), whose coefficient is known; then the coefficient of t^(n + 2).
            y2 += following
            y1 += following * third / 3.0
            third /= 3.0
            c, following = following, (load - damping * (n + 1) * following - square * c) / ((n + 2) * (n + 1))
            r2 += (n + 2) * following
            r1 += (n + 2) * following * third
            if n > 1 and abs(c) + abs(following) < _NEGLIGIBLE * scale:
                break
        coefficients[4 * case] = y1
        coefficients[4 * case + 1] = r1 / h
        coefficients[4 * case + 2] = y2
        coefficients[4 * case + 3] = r2 / h


@kernel
def rational_coefficients(frequency, damping_rate, h, coefficients):
    """Fill (COEFFICIENTS,) as the Radau IIA method answers."""
    square, damping = frequency * frequency, 2.0 * damping_rate
    m11 = 1.0 + h * (damping * A[0][0] + square * h * B[0][0])
    m12 = h * (damping * A[0][1] + square * h * B[0][1])
    m21 = h * (damping * A[1][0] + square * h * B[1][0])
    m22 = 1.0 + h * (damping * A[1][1] + square * h * B[1][1])
    inverse = 1.0 / (m11 * m22 - m12 * m21)
    for case in range(4):
        y0 = 1.0 if case == 0 else 0.0
        v0 = 1.0 if case == 1 else 0.0
        f1 = 1.0 if case == 2 else 0.0
        f2 = 1.0 if case == 3 else 0.0
        f1 -= damping * v0 + square * (y0 + h * v0 * NODES[0])
        f2 -= damping * v0 + square * (y0 + h * v0)
        a1 = (m22 * f1 - m12 * f2) * inverse
        a2 = (m11 * f2 - m21 * f1) * inverse
        coefficients[4 * case] = y0 + h * (v0 * NODES[0] + h * (B[0][0] * a1 + B[0][1] * a2))
        coefficients[4 * case + 1] = v0 + h * (A[0][0] * a1 + A[0][1] * a2)
        coefficients[4 * case + 2] = y0 + h * (v0 + h * (B[1][0] * a1 + B[1][1] * a2))
        coefficients[4 * case + 3] = v0 + h * (A[1][0] * a1 + A[1][1] * a2)


@kernel
def free_rate_defects(frequency, damping_rate, h, coefficients):
    """Rate at the step's end of the exact free motion less that of the method, by start value and by start rate."""
    underdamped = frequency * frequency - damping_rate * damping_rate
    if resolved(frequency, damping_rate, h) or underdamped <= 0.0:
        return 0.0, 0.0
    damped = math.sqrt(underdamped)
    decay = math.exp(-damping_rate * h)
    sine, cosine = decay * math.sin(damped * h) / damped, decay * math.cos(damped * h)
    by_value = -frequency * frequency * sine
    by_rate = cosine - damping_rate * sine
    return by_value - coefficients[FROM_VALUE + 3], by_rate - coefficients[FROM_RATE + 3]


@kernel
def mode_coefficients(frequency, damping_rate, h, coefficients):
    """Fill (COEFFICIENTS,) of a mode for a step `h` [s]."""
    if resolved(frequency, damping_rate, h):
        exact_coefficients(frequency, damping_rate, h, coefficients)
    else:
        rational_coefficients(frequency, damping_rate, h, coefficients)
