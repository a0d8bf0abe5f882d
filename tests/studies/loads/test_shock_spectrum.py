"""Shock response spectra against closed forms and against the exact response to straight pieces."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import lfilter, lsim

from solar_env.studies.loads.shock_spectrum import ShockSpectrum, ramp_invariant_filter

RATE = 20_000.0


def spectrum(history, frequencies, quality=10.0):
    watched = ShockSpectrum(np.array(frequencies), RATE, history.shape[1], quality)
    watched.add(history)
    return watched.finish()


def along_x(signal):
    return np.stack([signal, np.zeros_like(signal)], axis=-1)[:, None]


@pytest.mark.parametrize("quality", [5.0, 10.0, 50.0])
def test_a_step_overshoots_as_its_closed_form_says(quality):
    # a(t) = 1 - exp(-zeta w t) (cos w_d t - zeta / root sin w_d t) is greatest where its rate vanishes:
    # tan w_d t = 2 zeta root / (2 zeta^2 - 1), with root = sqrt(1 - zeta^2).
    zeta = 0.5 / quality
    root = math.sqrt(1.0 - zeta**2)
    turn = math.atan2(2.0 * zeta * root, 2.0 * zeta**2 - 1.0) % math.pi
    closed = 1.0 - math.exp(-zeta * turn / root) * (math.cos(turn) - zeta / root * math.sin(turn))
    history = along_x(np.concatenate([[0.0], np.ones(4000)]))
    found = spectrum(history, [20.0, 50.0, 200.0], quality)[:, 0]
    np.testing.assert_allclose(found, closed, rtol=1e-3)


def test_a_short_pulse_gives_its_impulse_times_the_angular_frequency():
    history = along_x(np.concatenate([[0.0], 300.0 * np.ones(2), np.zeros(3)]))
    impulse = 600.0 / RATE
    frequencies = np.array([5.0, 10.0, 20.0])
    found = spectrum(history, frequencies, quality=1e6)[:, 0]
    np.testing.assert_allclose(found, impulse * 2.0 * math.pi * frequencies, rtol=1e-3)


def test_the_filter_is_exact_for_histories_that_are_straight_between_samples():
    history = np.random.default_rng(0).normal(size=300)
    history[0] = 0.0
    for frequency in (10.0, 300.0, 2000.0):
        w, zeta = 2.0 * math.pi * frequency, 0.05
        system = ([2.0 * zeta * w, w * w], [1.0, 2.0 * zeta * w, w * w])
        _, expected, _ = lsim(system, history, np.arange(300) / RATE, interp=True)
        found = lfilter(*ramp_invariant_filter(frequency, RATE), history)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-8 * np.abs(expected).max())


def test_directions_in_the_plane_and_cuts_between_pieces_do_not_matter():
    history = np.random.default_rng(1).normal(size=(500, 2, 2))
    turned = history @ np.array([[0.6, 0.8], [-0.8, 0.6]])
    frequencies = [30.0, 500.0]
    whole = spectrum(history, frequencies)
    np.testing.assert_allclose(spectrum(turned, frequencies), whole, rtol=1e-12)
    pieces = ShockSpectrum(np.array(frequencies), RATE, 2)
    for piece in (history[:100], history[100:]):
        pieces.add(piece)
    np.testing.assert_allclose(pieces.finish(), whole, rtol=1e-12)
