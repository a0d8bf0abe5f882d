"""`solar-env play`: drive the array by hand, in a window."""

import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from solar_env.commands.arguments import Assignments
from solar_env.environment.registration import DEPLOY

_INVISIBLE = ("offscreen", "dummy")  # drivers that SDL takes where there is no display


@dataclass
class Args:
    """Drive the array by hand in a window: land it softly.

    Keys: right and left drive the motor at its limit, to open and to close; up and down at a tenth of it. Without a key
    the motor rests. Escape ends. An episode that has ended begins anew.
    """

    env_id: str = DEPLOY
    """environment id"""
    model: str = "flexible-clearance"
    """rigid-ideal, rigid-clearance, flexible-ideal or flexible-clearance"""
    seed: int = 0
    """of the first episode"""
    env_kwargs: Assignments = field(default_factory=dict)
    """environment keywords, for example torque_limit=0.3"""


def run_command(args: Args) -> int:
    """Open the window and play until it is closed, printing the result of every episode."""
    pygame = _open_display()
    import gymnasium
    from gymnasium.utils.play import play

    import solar_env  # noqa: F401 (registers the environments)

    if args.env_id not in gymnasium.registry:
        raise ValueError(f"environment {args.env_id!r} is not registered; take {DEPLOY}")
    keywords: dict[str, Any] = {"model": args.model, **args.env_kwargs}
    try:
        env = gymnasium.make(args.env_id, render_mode="rgb_array", **keywords)
    except TypeError as error:
        raise ValueError(str(error)) from error
    score = 0.0

    def report(*step: Any) -> None:
        nonlocal score
        _, _, _, reward, terminated, _, info = step
        score += float(reward)
        if terminated:
            peak = max(info["deployment"]["peak_postlock_force_N"])
            print(f"return {score:.3f}, peak force after latching {peak:.0f} N", flush=True)
            score = 0.0

    torques = {pygame.K_RIGHT: 1.0, pygame.K_LEFT: -1.0, pygame.K_UP: 0.1, pygame.K_DOWN: -0.1}
    actions = {key: np.array([torque], dtype=np.float32) for key, torque in torques.items()}
    play(env, keys_to_action=actions, noop=np.zeros(1, dtype=np.float32), seed=args.seed, callback=report)
    return 0


def _open_display() -> Any:
    """Begin with pygame's display, where there is one or `SDL_VIDEODRIVER` asks for what SDL takes; returns pygame.

    Raises:
        ValueError: pygame is not installed.
        OSError: what is shown would be seen by nobody.
    """
    try:
        import pygame
    except ImportError as error:
        raise ValueError("the window needs pygame: pip install 'solar-env[play]'") from error
    why = ""
    try:
        pygame.display.init()
        driver = pygame.display.get_driver()
        if driver in _INVISIBLE and not os.environ.get("SDL_VIDEODRIVER"):
            why = f"SDL has its driver {driver!r} alone"
    except pygame.error as error:
        why = str(error)
    if why:
        advice = "run it where there is one, or show an episode on a page or film it (solar-env replay)"
        raise OSError(f"there is no display for a window ({why}); {advice}")
    return pygame
