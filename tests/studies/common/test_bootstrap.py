import math

import numpy as np
import pytest

from solar_env.studies.common.bootstrap import mean_band


def test_the_band_of_a_mean_is_that_of_the_normal_law_for_many_values():
    values = np.random.default_rng(1).normal(3.0, 0.5, size=400)
    mean, low, high = mean_band(values)
    assert mean == pytest.approx(values.mean())
    assert high - low == pytest.approx(2 * 1.96 * values.std() / math.sqrt(400), rel=0.1)
    assert low < mean < high


def test_what_is_unknown_has_no_band():
    for values in ([], [1.0, math.nan]):
        assert all(math.isnan(x) for x in mean_band(np.array(values)))
