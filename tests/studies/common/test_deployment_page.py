"""Lines of pages: what stands for many samples is the greatest of them."""

import numpy as np

from solar_env.studies.common.deployment_page import greatest_in_windows


def test_a_window_shows_its_greatest_value_at_any_joint_and_no_peak_is_lost():
    time = np.arange(0.0, 2.0, 1e-3)
    values = np.zeros((len(time), 2))
    values[[0, 399, 400, 1999], [0, 1, 0, 1]] = 1.0, 2.0, 3.0, 4.0
    begins, greatest = greatest_in_windows(time, values)
    np.testing.assert_allclose(begins, 0.2 * np.arange(10), atol=1e-12)
    np.testing.assert_array_equal(greatest[:, 0], [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0])
