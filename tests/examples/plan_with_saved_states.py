"""Planning with saved states: try torques from where the array is, to the end of the episode, take the best, go on.

python tests/examples/plan_with_saved_states.py
"""

import gymnasium
import numpy as np

import solar_env  # noqa: F401 (registers the environments)

CANDIDATES = np.linspace(-1.0, 1.0, 17)[:, np.newaxis]  # (candidates, motors) torques, in units of the limit
HOLD = 10  # control periods for which a torque is held, before the springs are left alone


def plan(env: gymnasium.Env) -> float:
    """Deploy by looking ahead; returns the sum of the rewards."""
    total, ended = 0.0, False
    while not ended:
        futures, periods = env.unwrapped.futures(len(CANDIDATES)), 0
        returns = np.zeros(len(CANDIDATES))
        while not futures.terminated.all():
            lanes = np.flatnonzero(~futures.terminated)
            futures.step(lanes, CANDIDATES if periods < HOLD else 0.0 * CANDIDATES)
            returns[lanes] += futures.rewards[lanes]
            periods += 1
        for _ in range(HOLD):
            if not ended:
                _, reward, ended, _, _ = env.step(CANDIDATES[returns.argmax()].astype(np.float32))
                total += float(reward)
    return total


if __name__ == "__main__":
    environment = gymnasium.make("solar_env/Deploy-v1")
    environment.reset(seed=0)
    print(f"return {plan(environment):.3f}")
