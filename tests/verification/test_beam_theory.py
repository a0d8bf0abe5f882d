import math

import numpy as np
import pytest

from solar_env.mechanics.mechanism.beams import PANEL, PENDULUM_BEAM, SPIN_UP_BEAM, Beam
from solar_env.mechanics.mechanism.textbook import STANDARD_GRAVITY
from solar_env.verification.beams import theory
from solar_env.verification.beams.strain_theory import StrainBeam


@pytest.mark.parametrize(
    ("load", "deflection", "shortening", "angle"),
    [(0.5, 0.162144, 0.015919, 0.244534), (5.0, 0.713792, 0.387628, 1.215368)],
)
def test_elastica_has_the_published_figures(load, deflection, shortening, angle):
    assert theory.tip_load_elastica(load) == pytest.approx((deflection, shortening, angle), abs=5e-7)


@pytest.mark.parametrize("load", [0.5, 5.0, 10.0])
def test_boundary_value_problem_agrees_with_elliptic_integrals_without_stretch(load):
    deflection, shortening, angle = theory.tip_load_elastica(load)
    place, direction = theory.deflected_tip(Beam(2.0, 1.0, 1e13, 3.0), tip_force=1j * load * 3.0 / 4.0)
    assert place / 2.0 == pytest.approx(1.0 - shortening + 1j * deflection, abs=1e-9)
    assert direction == pytest.approx(angle, abs=1e-9)


def test_boundary_value_problem_pulls_and_rolls_up():
    assert theory.deflected_tip(Beam(2.0, 1.0, 100.0, 1.0), tip_force=5.0)[0] == pytest.approx(2.1, abs=1e-9)
    for turn in (0.5, math.pi, 2.0 * math.pi):
        place, angle = theory.deflected_tip(Beam(1.0, 1.0, 1e9, 3.0), tip_moment=3.0 * turn)
        assert place == pytest.approx((np.exp(1j * turn) - 1.0) / (1j * turn), abs=1e-9)
        assert angle == pytest.approx(turn, abs=1e-9)


def test_wave_numbers_and_frequencies_are_the_textbooks():
    assert theory.bending_wave_numbers("clamped-free", 3) == pytest.approx((1.875104, 4.694091, 7.854757), abs=1e-6)
    assert theory.bending_wave_numbers("pinned-free", 2) == pytest.approx((3.926602, 7.068583), abs=1e-6)
    assert theory.bending_wave_numbers("free-free", 2) == pytest.approx((4.730041, 7.853205), abs=1e-6)
    assert theory.bending_frequencies("clamped-free", PANEL, 3) == pytest.approx((1.6990, 10.647, 29.813), rel=5e-5)
    bar = Beam(2.0, 1.0, 64.0, 1.0)
    assert theory.axial_frequencies("clamped-free", bar, 2) == pytest.approx((1.0, 3.0))
    assert theory.axial_frequencies("free-free", bar, 2) == pytest.approx((2.0, 4.0))


def test_spin_up_angle_is_smooth_and_the_beam_stretches():
    assert theory.spinning_extension(SPIN_UP_BEAM, 6.0) == pytest.approx(5.143e-4, abs=5e-8)
    for time in (0.0, 4.0, 15.0, 17.0):
        angle, rate, acceleration = theory.spin_up_angle(time, 6.0, 15.0)
        step = 1e-4
        after = theory.spin_up_angle(time + step, 6.0, 15.0)
        assert (after[0] - angle) / step == pytest.approx(0.5 * (rate + after[1]), abs=1e-7)
        assert (after[1] - rate) / step == pytest.approx(0.5 * (acceleration + after[2]), abs=1e-7)
    assert theory.spin_up_angle(20.0, 6.0, 15.0)[0] == pytest.approx(6.0 * 20.0 - 45.0)


class TestStrainBeam:
    def test_rigid_limit_is_the_physical_pendulum(self):
        # Length 1.5 L / 1.5: a rod swings as a simple pendulum of two thirds of its length.
        beam = Beam(1.5, 1.0, 1e9, 1e9)
        rod = StrainBeam(beam, 1, 0, gravity=STANDARD_GRAVITY)
        quarter = 0.25 * 2.3678419  # period of the simple pendulum of 1 m released from the horizontal
        assert rod.tips([0.0, quarter], rtol=1e-10)[-1] == pytest.approx(-1.5j, abs=1e-6)

    @pytest.mark.parametrize(("clamped", "support"), [(True, "clamped-free"), (False, "pinned-free")])
    def test_small_vibrations_have_the_frequencies_of_beams_and_bars(self, clamped, support):
        turns, stretches = 8, 4
        root = (lambda t: (0.0, 0.0, 0.0)) if clamped else None
        reference = StrainBeam(PANEL, turns, stretches, root_angle=root)
        size = turns + stretches
        still, step = np.zeros(size), 1e-6
        stiffness = np.array([-reference.accelerations(0.0, step * row, still) / step for row in np.eye(size)]).T
        frequencies = np.sqrt(np.sort(np.abs(np.linalg.eigvals(stiffness)))) / (2.0 * math.pi)
        bending = theory.bending_frequencies(support, PANEL, 2)
        rigid = 0 if clamped else 1
        assert frequencies[rigid : rigid + 2] == pytest.approx(bending, rel=1e-4)
        axial = theory.axial_frequencies(support, PANEL, 1)[0]
        assert np.abs(frequencies / axial - 1.0).min() < 1e-5

    @pytest.mark.slow
    def test_falling_pendulum_has_the_published_places(self):
        beam = StrainBeam(PENDULUM_BEAM, 34, 24, gravity=STANDARD_GRAVITY)
        tips = beam.tips([0.0, *theory.FALLING_TIPS], rtol=1e-6)[1:]
        for place, (x, y, tolerance) in zip(tips, theory.FALLING_TIPS.values(), strict=True):
            assert place == pytest.approx(complex(x, y), abs=tolerance)
