import math
from dataclasses import replace

import numpy as np
import pytest

from solar_env.array import MODELS, ArrayParameters
from solar_env.studies.common.motion import Scene, perturbed, with_panels
from solar_env.studies.common.plans import FULL
from solar_env.studies.precision import methods

ONE = "1 element"


def test_names_are_unique_and_found():
    names = [method.name for method in methods.METHODS]
    assert len(set(names)) == len(names)
    assert all(methods.find_method(name).name == name for name in names)
    with pytest.raises(ValueError, match=r"'euler' is unknown; .*runge-kutta"):
        methods.find_method("euler")


def test_settings_run_from_the_coarsest_to_the_finest():
    for method in methods.METHODS:
        for settings in (*method.settings.values(), *method.dear.values()):
            assert list(settings) == sorted(settings, reverse=True), method.name


@pytest.mark.parametrize("pairs", [methods.REFERENCES, methods.SHORT_REFERENCES])
def test_every_reference_comes_from_two_different_methods(pairs):
    for (first, finest), (second, _) in pairs.values():
        assert methods.find_method(first) is not methods.find_method(second)
        assert list(finest) == sorted(finest), "the first is right"
    assert set(pairs) == set(MODELS)


@pytest.mark.parametrize("pairs", [methods.REFERENCES, methods.MODAL_REFERENCES])
def test_no_setting_is_finer_than_the_reference_that_it_is_compared_with(pairs):
    for model, ((name, values), *_) in pairs.items():
        assert min(methods.find_method(name).settings.get(model, values)) >= values[0]


def test_a_method_with_panels_of_its_own_takes_them_whatever_the_scene_says():
    modal = methods.find_method("modal-radau")
    scene = Scene("flexible-ideal:1 element", FULL.parameters, 1.0, 1.0)
    assert modal.size(scene) == "32 modes"
    assert methods.find_method("rosenbrock").size(scene) == "1 element"
    assert modal.size(replace(scene, model="rigid-clearance")) == "rigid"
    taken = replace(modal, program=lambda own, setting: own).solve(scene, 1e-3)
    assert taken == replace(scene, model="flexible-ideal:32 modes")


@pytest.mark.parametrize("method", [m for m in methods.METHODS if m.needs is None], ids=lambda m: m.name)
def test_every_own_and_scipy_method_moves_every_model_that_it_is_listed_for(method):
    ends = {}
    for model in (*method.settings, *method.dear):
        scene = Scene(with_panels(model, ONE), FULL.parameters, duration=2e-3, sample_step=1e-3)
        motion = method.solve(scene, 1e-4)
        assert motion.time.tolist() == [0.0, 1e-3, 2e-3]
        assert motion.angles.shape == (3, 2)
        assert motion.evaluations > 0
        assert motion.wall_time > 0.0
        ends[model] = motion.angles[-1, 0]
    # The panels start to open as one; bent or not, hinged with or without clearance.
    if "rigid-ideal" in ends:
        assert ends["rigid-ideal"] == pytest.approx(1.15e-8, rel=0.1)


def test_without_the_peer_its_methods_are_not_available(monkeypatch):
    monkeypatch.setattr(methods.importlib.util, "find_spec", lambda name: None)
    assert methods.peer_is_missing()
    assert {m.name for m in methods.METHODS if not m.available} == {"Exudyn generalized-alpha", "Exudyn explicit"}
    assert "pip install" in methods.MISSING_PEER


@pytest.mark.skipif(methods.peer_is_missing(), reason="needs the extra 'peers'")
@pytest.mark.parametrize(("solver", "model"), [
    ("generalized-alpha", "rigid-ideal"), ("explicit", "rigid-ideal"), ("explicit", "rigid-clearance"),
    ("generalized-alpha", "flexible-ideal"),
])  # fmt: skip
def test_the_peer_moves_as_the_projects_own_simulator_does(solver, model):
    released = perturbed(replace(FULL.parameters, initial_rate=0.02), 1)
    scene = Scene(with_panels(model, ONE), released, duration=0.1, sample_step=0.05)
    peer = methods.exudyn(solver)(scene, 1e-4 if model.endswith("ideal") else 1e-5)
    own = methods.find_method("runge-kutta").solve(scene, 1e-10)
    assert peer.time.tolist() == own.time.tolist()
    tolerance = {"rigid-ideal": 1e-9, "rigid-clearance": 1e-4, "flexible-ideal": 1e-4}[model]
    assert np.abs(peer.angles - own.angles).max() < tolerance
    assert math.isnan(peer.energy_residual)


@pytest.mark.skipif(methods.peer_is_missing(), reason="needs the extra 'peers'")
def test_what_the_peer_cannot_express_is_refused():
    scene = Scene("rigid-ideal", FULL.parameters, duration=0.1, sample_step=0.1)
    for changed, named in (
        (replace(scene, parameters=ArrayParameters(panel_count=1, friction_speed_zero=0.0)), "panel_count = 1"),
        (replace(scene, parameters=replace(FULL.parameters, initial_spin=0.1)), "initial_spin = 0.1"),
        (replace(scene, model="flexible-ideal:32 modes"), "model = 'flexible-ideal:32 modes'"),
    ):
        with pytest.raises(ValueError, match=named):
            methods.exudyn("generalized-alpha")(changed, 1e-2)
