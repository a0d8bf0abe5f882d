"""The study of residual blocks varies their number alone, and tells errors and means by modes and blocks."""

from solar_env.mechanics.bodies.description import ModalPanel
from solar_env.studies.common.plans import QUICK
from solar_env.studies.common.tables import Table
from solar_env.studies.precision import residual_blocks
from solar_env.studies.precision.levels_plot import ERRORS, MEANS


def blocks_of(mechanism):
    return [body.residual_blocks for body in mechanism.bodies if isinstance(body, ModalPanel)]


def test_panels_of_a_scene_have_its_number_of_blocks_and_are_otherwise_the_same():
    scenes = {
        key: job.solve.args[0] for key, job in residual_blocks.block_jobs(QUICK).items()
    }  # fmt: skip
    assert {(own.modes, own.blocks) for own, _ in scenes} == {(8, blocks) for blocks in residual_blocks.BLOCKS}
    assert {member for _, member in scenes} == {None, 0, 1}
    for (own, _), scene in scenes.items():
        assert blocks_of(scene.mechanism()) == [own.blocks] * 2
        assert scene.panels.count == own.modes


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
