"""SciPy's integrators solve the project's equations, events included, as the project's own integrator does."""

import numpy as np
import pytest

from solar_env.array import ArrayParameters
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.running.simulation import simulate
from solar_env.studies.common.measures import angle_error, latch_error
from solar_env.studies.common.motion import Scene, run_own
from solar_env.studies.peers.scipy_methods import run_scipy

FAST = ArrayParameters(spring_stiffness=(2.5, 1.875), cable_preload_force=1250.0)


@pytest.mark.parametrize(("name", "rtol", "tolerance"), [("DOP853", 1e-11, 1e-9), ("Radau", 1e-6, 1e-5)])
def test_a_deployment_with_ideal_joints_latches_alike(name, rtol, tolerance):
    scene = Scene("rigid-ideal", FAST, duration=2.6, sample_step=0.1)
    own, other = run_own(scene, RungeKutta(rtol=1e-12)), run_scipy(scene, name, rtol)
    assert angle_error(other, own, until=2.6) < 10.0 * tolerance
    assert latch_error(other, own) < tolerance
    assert other.evaluations > 100
    assert (other.factorizations > 0) == (name == "Radau")


def test_the_first_impacts_of_clearance_joints_are_alike():
    """A contact that starts late, ends late or has another force turns the joints differently from there on."""
    scene = Scene("rigid-clearance", FAST, duration=0.06, sample_step=0.002)
    run = simulate(scene.mechanism(), scene.duration, integrator=RungeKutta(rtol=1e-12))
    assert min(np.bincount(run.contacts["joint"])) >= 2
    own, other = run_own(scene, RungeKutta(rtol=1e-12)), run_scipy(scene, "DOP853", 1e-11)
    turned = np.abs(own.angles[-1] - own.angles[0]).min()
    assert angle_error(other, own, until=scene.duration) < 1e-6 * turned
