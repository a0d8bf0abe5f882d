"""Every method moves the models that it is listed for; the peer moves as the project's own simulator does."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solar_env.array import MODELS, ArrayParameters
from solar_env.studies.common.motion import Scene, perturbed, with_panels
from solar_env.studies.common.plans import FULL
from solar_env.studies.precision.methods import METHODS, REFERENCES, exudyn, importlib, peer_is_missing

ONE = "1 element"


def test_settings_run_from_the_coarsest_to_the_finest_and_none_is_finer_than_the_reference():
    for name, method in METHODS.items():
        for settings in method.settings.values():
            assert list(settings) == sorted(settings, reverse=True), name
    assert set(REFERENCES) == set(MODELS)
    for model, references in REFERENCES.items():
        for name, (finest, next_finest) in references:
            assert finest < next_finest
            assert min(METHODS[name].settings[model]) == finest


def test_a_method_with_panels_of_its_own_takes_them_whatever_the_scene_says():
    modal = METHODS["modal-radau"]
    scene = Scene("flexible-ideal:1 element", FULL.parameters, 1.0, 1.0)
    assert modal.size(scene) == "32 modes"
    assert METHODS["rosenbrock"].size(scene) == "1 element"
    assert modal.size(replace(scene, model="rigid-clearance")) == "rigid"
    taken = replace(modal, program=lambda own, setting: own).solve(scene, 1e-3)
    assert taken == replace(scene, model="flexible-ideal:32 modes")


@pytest.mark.parametrize("name", [name for name, method in METHODS.items() if not method.peer])
def test_every_own_method_moves_every_model_that_it_is_listed_for(name):
    ends = {}
    for model in METHODS[name].settings:
        scene = Scene(with_panels(model, ONE), FULL.parameters, duration=2e-3, sample_step=1e-3)
        motion = METHODS[name].solve(scene, 1e-4)
        assert motion.time.tolist() == [0.0, 1e-3, 2e-3]
        assert motion.angles.shape == (3, 2)
        assert motion.evaluations > 0
        assert motion.wall_time > 0.0
        ends[model] = motion.angles[-1, 0]
    if "rigid-ideal" in ends:
        assert ends["rigid-ideal"] == pytest.approx(1.15e-8, rel=0.1)


def test_without_the_peer_its_methods_are_not_available(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert peer_is_missing()
    assert [name for name, m in METHODS.items() if not m.available] == ["Exudyn generalized-alpha", "Exudyn explicit"]


@pytest.mark.skipif(peer_is_missing(), reason="needs the extra 'peers'")
@pytest.mark.parametrize(
    ("solver", "model", "tolerance"),
    [
        ("generalized-alpha", "rigid-ideal", 1e-9),
        ("explicit", "rigid-ideal", 1e-9),
        ("explicit", "rigid-clearance", 1e-4),
        ("generalized-alpha", "flexible-ideal", 1e-4),
    ],
)
def test_the_peer_moves_as_the_projects_own_simulator_does(solver, model, tolerance):
    released = perturbed(replace(FULL.parameters, initial_rate=0.02), 1)
    scene = Scene(with_panels(model, ONE), released, duration=0.1, sample_step=0.05)
    peer = exudyn(solver)(scene, 1e-4 if model.endswith("ideal") else 1e-5)
    own = METHODS["runge-kutta"].solve(scene, 1e-10)
    assert peer.time.tolist() == own.time.tolist()
    assert np.abs(peer.angles - own.angles).max() < tolerance
    assert math.isnan(peer.energy_residual)


@pytest.mark.skipif(peer_is_missing(), reason="needs the extra 'peers'")
def test_what_the_peer_cannot_express_is_refused():
    scene = Scene("rigid-ideal", FULL.parameters, duration=0.1, sample_step=0.1)
    for changed, named in (
        (replace(scene, parameters=ArrayParameters(panel_count=1, friction_speed_zero=0.0)), "express two panels"),
        (replace(scene, parameters=replace(FULL.parameters, friction_speed_zero=1e-4)), "sets in at rest"),
        (replace(scene, model="flexible-ideal:32 modes"), "model = 'flexible-ideal:32 modes'"),
    ):
        with pytest.raises(ValueError, match=named):
            exudyn("generalized-alpha")(changed, 1e-2)
