"""The loads on the hub, played back in Basilisk: `pip install bsk && pytest -m basilisk`."""

from __future__ import annotations

import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from solar_env.studies.common.motion import Level
from solar_env.studies.common.plans import FAST_PARAMETERS
from solar_env.studies.loads.hub import write_hub_loads
from solar_env.studies.loads.runs import deploy

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "basilisk_playback.py"


@pytest.mark.basilisk
@pytest.mark.filterwarnings("ignore")
def test_basilisks_spacecraft_has_the_hubs_attitude_to_a_microradian(tmp_path):
    pytest.importorskip("Basilisk")
    parameters = replace(FAST_PARAMETERS, body_mass=900.0, body_inertia=170.0)
    run = deploy(Level("rigid-clearance"), parameters, 0, 2.0, 60.0)
    write_hub_loads(parameters, run.trajectory.time, run.hub_loads, tmp_path / "hub.csv")
    table = np.genfromtxt(tmp_path / "hub.csv", delimiter=",", names=True)
    played = runpy.run_path(str(EXAMPLE))["attitude_history"](table)
    angle, rate = played.T
    turned = run.place[1:, 2] - run.place[0, 2]
    assert np.abs(turned).max() > 0.05
    np.testing.assert_allclose(rate, run.velocity[1:, 2], rtol=0.0, atol=1e-12)
    assert np.abs(angle - turned).max() < 1e-6
