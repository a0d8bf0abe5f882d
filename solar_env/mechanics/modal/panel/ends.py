"""Motion of the ends of the panels over a step: free, and under the loads at its stages, by groups of modes."""

from solar_env.mechanics.modal.panel.oscillators import FROM_LOAD, FROM_RATE
from solar_env.mechanics.modal.panel.tables import GROUPS, values_of
from solar_env.mechanics.numerics.jit import kernel


@kernel(inner=True)
def sum_free(rows, answers, defects, q, v, low, sums):
    """Add up the free motion of one group's ends over its modes.

    Args:
        rows: (modes, VALUES).
        answers: (modes, COEFFICIENTS).
        defects: (modes, 2).
        q, v: (modes,) amplitudes and rates.
        low: (coupled, 4) takes the free motion of the lowest modes.
        sums: (VALUES, 4) takes value and rate at the first stage, then at the second.

    Returns:
        Defect of the rate of the first value at the end of the step.
    """
    w0 = w1 = w2 = w3 = s0 = s1 = s2 = s3 = defect = 0.0
    for k in range(q.size):
        a, b = q[k], v[k]
        y0 = answers[k, 0] * a + answers[k, FROM_RATE] * b
        y1 = answers[k, 1] * a + answers[k, FROM_RATE + 1] * b
        y2 = answers[k, 2] * a + answers[k, FROM_RATE + 2] * b
        y3 = answers[k, 3] * a + answers[k, FROM_RATE + 3] * b
        if k < low.shape[0]:
            low[k, 0], low[k, 1], low[k, 2], low[k, 3] = y0, y1, y2, y3
        first, second = rows[k, 0], rows[k, 1]
        w0 += first * y0
        w1 += first * y1
        w2 += first * y2
        w3 += first * y3
        s0 += second * y0
        s1 += second * y1
        s2 += second * y2
        s3 += second * y3
        defect += first * (defects[k, 0] * a + defects[k, 1] * b)
    sums[0, 0], sums[0, 1], sums[0, 2], sums[0, 3] = w0, w1, w2, w3
    sums[1, 0], sums[1, 1], sums[1, 2], sums[1, 3] = s0, s1, s2, s3
    return defect


@kernel(inlined=True)
def free_ends(panels, state, work, tables, level, p, d, offset):
    """Free motion over a step of the ends and of the coupled modes of panel `p`, whose amplitudes begin at `offset`."""
    for group in range(GROUPS):
        begin, end = panels.first[group], panels.first[group + 1]
        work.defect[p, group] = sum_free(
            panels.rows[d, begin:end],
            tables.answers[d, level, begin:end],
            tables.defects[d, level, begin:end],
            state.q[offset + begin : offset + end],
            state.v[offset + begin : offset + end],
            work.low_free[p, group, : panels.coupled[group]],
            work.free[p, group],
        )


@kernel(inlined=True)
def forced_ends(work, response, p, d, level):
    """Motion of the ends of panel `p` at both stages, free and by the loads there."""
    for group in range(GROUPS):
        for i in range(values_of(group)):
            for c in range(4):
                total = work.free[p, group, i, c]
                for j in range(values_of(group)):
                    total += response[d, level, group, i, j, c] * work.group_load[p, 0, group, j]
                    total += response[d, level, group, i, j, 4 + c] * work.group_load[p, 1, group, j]
                work.ends[p, group, i, c] = total


@kernel(inlined=True)
def add_modal_forces(panels, work, tables, level, p, d):
    """Add what the modal forces of foreshortening do to the ends of panel `p`."""
    for group in range(GROUPS):
        for r in range(panels.coupled[group]):
            k = panels.first[group] + r
            first, second = work.coupling[p, 0, k], work.coupling[p, 1, k]
            for c in range(4):
                gain = tables.answers[d, level, k, FROM_LOAD + c] * first
                gain += tables.answers[d, level, k, FROM_LOAD + 4 + c] * second
                for i in range(values_of(group)):
                    work.ends[p, group, i, c] += panels.rows[d, k, i] * gain
