"""Motion of the ends of the panels over a step: free, and under the loads at its stages, by groups of modes."""

from solar_env.mechanics.modal.panel.oscillators import FROM_LOAD, FROM_RATE
from solar_env.mechanics.modal.panel.tables import GROUPS, values_of
from solar_env.mechanics.numerics.jit import kernel


@kernel(inner=True)
def sum_free(modes, answers, q, v, low, sums):
    """Add up the free motion of one group's ends over its modes.

    Args:
        modes: (modes,) rows of `mode_type`.
        answers: (modes,) rows of `answer_type`.
        q, v: (modes,) amplitudes and rates.
        low: (coupled, 4) takes the free motion of the lowest modes.
        sums: (VALUES, 4) takes value and rate at the first stage, then at the second.

    Returns:
        Defect of the rate of the first value at the end of the step.
    """
    w0 = w1 = w2 = w3 = s0 = s1 = s2 = s3 = defect = 0.0
    for k in range(q.size):
        a, b, answer = q[k], v[k], answers[k].coefficient
        y0 = answer[0] * a + answer[FROM_RATE] * b
        y1 = answer[1] * a + answer[FROM_RATE + 1] * b
        y2 = answer[2] * a + answer[FROM_RATE + 2] * b
        y3 = answer[3] * a + answer[FROM_RATE + 3] * b
        if k < low.shape[0]:
            low[k, 0], low[k, 1], low[k, 2], low[k, 3] = y0, y1, y2, y3
        first, second = modes[k].row[0], modes[k].row[1]
        w0 += first * y0
        w1 += first * y1
        w2 += first * y2
        w3 += first * y3
        s0 += second * y0
        s1 += second * y1
        s2 += second * y2
        s3 += second * y3
        defect += first * (answers[k].defect[0] * a + answers[k].defect[1] * b)
    sums[0, 0], sums[0, 1], sums[0, 2], sums[0, 3] = w0, w1, w2, w3
    sums[1, 0], sums[1, 1], sums[1, 2], sums[1, 3] = s0, s1, s2, s3
    return defect


@kernel(inlined=True)
def free_ends(panels, panel, answers, d, q, v):
    """Free motion over a step of the ends and of the coupled modes of a panel.

    Args:
        panels: see `Panels`.
        panel: scratch of the panel.
        answers: (modes,) of the panel's design `d` to the step.
        q, v: (modes,) amplitudes and rates.
    """
    for group in range(GROUPS):
        begin, end = panels.first[group], panels.first[group + 1]
        panel.defect[group] = sum_free(
            panels.modes[d, begin:end],
            answers[begin:end],
            q[begin:end],
            v[begin:end],
            panel.low_free[group, : panels.coupled[group]],
            panel.free[group],
        )


@kernel(inlined=True)
def forced_ends(panel, response, groups):
    """Motion of the ends of a panel at both stages in the first `groups` groups, free and by the loads there."""
    for group in range(groups):
        for i in range(values_of(group)):
            for c in range(4):
                total = panel.free[group, i, c]
                for j in range(values_of(group)):
                    total += response[group, i, j, c] * panel.load[0, group, j]
                    total += response[group, i, j, 4 + c] * panel.load[1, group, j]
                panel.ends[group, i, c] = total


@kernel(inlined=True)
def add_modal_forces(panels, panel, answers, d):
    """Add what the modal forces of foreshortening do to the ends of a panel."""
    for group in range(GROUPS):
        for r in range(panels.coupled[group]):
            k = panels.first[group] + r
            first, second = panel.coupling[0, group, r], panel.coupling[1, group, r]
            mode, answer = panels.modes[d, k], answers[k].coefficient
            for c in range(4):
                gain = answer[FROM_LOAD + c] * first + answer[FROM_LOAD + 4 + c] * second
                for i in range(values_of(group)):
                    panel.ends[group, i, c] += mode.row[i] * gain
