"""The study of residual blocks varies their number alone, and tells errors and means by modes and blocks."""

from dataclasses import replace

import pytest

from solar_env.array import build
from solar_env.mechanics.bodies.description import ModalPanel
from solar_env.studies.common.plans import FULL, QUICK
from solar_env.studies.common.tables import Table
from solar_env.studies.precision import residual_blocks
from solar_env.studies.precision.levels_plot import ERRORS, MEANS


@pytest.mark.parametrize("blocks", residual_blocks.BLOCKS)
def test_panels_of_a_scene_have_its_number_of_blocks_and_are_otherwise_the_same(blocks):
    scene = residual_blocks.scene_of(QUICK, residual_blocks.BlockLevel(8, blocks), "flexible-ideal")
    panels = [body for body in scene.mechanism().bodies if isinstance(body, ModalPanel)]
    assert [(panel.modes, panel.residual_blocks) for panel in panels] == [(8, blocks)] * 2
    default = build(QUICK.parameters, "flexible-ideal", modes=8)
    assert [replace(panel, residual_blocks=2) for panel in panels] == list(default.bodies[1:])


def test_every_number_of_modes_and_blocks_has_a_run_with_ideal_joints_and_its_ensemble():
    keys = set(residual_blocks.block_jobs(FULL))
    assert {member for _, member in keys} == {None, *range(16)}
    assert {(own.modes, own.blocks) for own, _ in keys} == {(m, b) for m in (8, 16, 32, 48) for b in (0, 1, 2)}
    assert len(keys) == 12 * 17


def test_the_page_has_errors_with_ideal_joints_and_means_with_clearance():
    chosen = {"modes": 8, "residual_blocks": 1}
    ideal = {**chosen, "reference": "48 modes, rtol / 10", **dict.fromkeys(ERRORS, 1e-3)}
    runs = [
        {**chosen, "member": member, "joint": joint, **dict.fromkeys(MEANS, 1.0), "peak_force_N": force}
        for member, force in enumerate((9.0, 11.0))
        for joint in (1, 2)
    ]
    lines = residual_blocks.page(Table((ideal,), {}), Table(tuple(runs), {})).splitlines()
    assert "errors against 48 modes, rtol / 10" in lines[0]
    assert "| 8 | 1 | 1.0e-03 | 1.0e-03 | 1.0e-03 | 2 | 10.0 ± 1.0 / 10.0 ± 1.0 | 1 / 1 |" in lines[-1]
