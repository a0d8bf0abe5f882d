"""`solar-env play`: drive the array by hand, in a window."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from solar_env.commands.arguments import Assignments
from solar_env.environment.registration import DEPLOY
from solar_env.environment.showing.window import open_display
from solar_env.pictures.frame import CARD, INK
from solar_env.pictures.style import BLUE, FAINT

BAR = 64  # height below the frame [pixels], for the torque and a line of text
_MARGIN = 24
_STEPS = 20  # number of key strokes from zero torque to the limit


@dataclass
class Args:
    """Drive the array by hand in a window: land it softly.

    Keys: left and right turn the motor torque down and up, 0 sets it to nothing; space pauses, r begins anew, q ends.
    """

    env_id: str = DEPLOY
    """environment id"""
    model: str = "flexible-clearance"
    """rigid-ideal, rigid-clearance, flexible-ideal or flexible-clearance"""
    seed: int = 0
    """seed of the first episode"""
    env_kwargs: Assignments = field(default_factory=dict)
    """environment keywords, for example torque_limit=0.3"""


class Player:
    """An episode played in a window: `press` handles a key, `tick` advances a control period, `draw` shows the state.

    Attributes:
        torque: motor torque divided by the limit, -1 to 1.
        paused: whether `tick` does nothing.
        running: whether the window should stay open.
        score: sum of the rewards so far.
        ended: whether the episode has ended.
    """

    def __init__(self, env: Any, seed: int) -> None:
        # Start only display and fonts: pygame's sound, for example, prints long complaints without a sound device.
        self._game = pygame = open_display()
        pygame.font.init()
        self._env, self._seed, self.running = env, seed, True
        self._restart()
        height, width = self._frame.shape[:2]
        self._window = pygame.display.set_mode((width, height + BAR))
        pygame.display.set_caption("solar-env play")
        self._font = pygame.font.Font(None, 26)

    def _restart(self) -> None:
        self._env.reset(seed=self._seed)
        self.torque, self.score, self.ended, self.paused, self.peak = 0.0, 0.0, False, True, 0.0
        self._frame = self._env.render()

    def press(self, key: int) -> None:
        """Change the torque, or pause, restart or end the game, according to a pygame key code."""
        game = self._game
        if key in (game.K_LEFT, game.K_RIGHT):
            change = (1.0 if key == game.K_RIGHT else -1.0) / _STEPS
            self.torque = round(min(max(self.torque + change, -1.0), 1.0), 6)
        elif key == game.K_0:
            self.torque = 0.0
        elif key == game.K_SPACE:
            self.paused = not self.paused
        elif key == game.K_r:
            self._restart()
        elif key in (game.K_q, game.K_ESCAPE):
            self.running = False

    def tick(self) -> None:
        """Advance the episode by one control period, unless the episode is paused or has ended."""
        if self.paused or self.ended:
            return
        _, reward, self.ended, _, _ = self._env.step(np.array([self.torque], dtype=np.float32))
        self.score += float(reward)
        self.peak = max(self.peak, float(self._env.unwrapped.simulation.state.joints["postlock_peak_force"].max()))
        self._frame = self._env.render()

    def draw(self) -> None:
        """Draw the window with the array's present state, the motor torque and the score."""
        game, window, (height, width) = self._game, self._window, self._frame.shape[:2]
        window.fill(CARD)
        window.blit(game.surfarray.make_surface(self._frame.swapaxes(0, 1)), (0, 0))
        y, middle, reach = height + 18, width / 2, width / 2 - _MARGIN
        game.draw.line(window, FAINT, (middle - reach, y), (middle + reach, y), 4)
        game.draw.line(window, BLUE, (middle, y), (middle + self.torque * reach, y), 4)
        state = "ended, r: again" if self.ended else "paused, space: go on" if self.paused else "space: pause"
        text = (
            f"torque {self.torque * self._env.unwrapped.task.torque_limit:+.3f} N m     return {self.score:.3f}     "
            f"peak after latching {self.peak:.0f} N     {state}, q: quit"
        )
        window.blit(self._font.render(text, True, INK), (_MARGIN, y + 18))
        game.display.flip()


def run_command(args: Args) -> int:
    """Open the window, play until the window is closed, and print the score."""
    try:
        import pygame
    except ImportError as error:
        raise ValueError("the window needs pygame: pip install -e '.[play]'") from error
    import gymnasium

    import solar_env  # noqa: F401 (registers the environments)

    if args.env_id not in gymnasium.registry:
        raise ValueError(f"environment {args.env_id!r} is not registered; take {DEPLOY}")
    keywords: dict[str, Any] = {"model": args.model, **args.env_kwargs}
    try:
        env = gymnasium.make(args.env_id, render_mode="rgb_array", **keywords)
    except TypeError as error:
        raise ValueError(str(error)) from error
    player = Player(env, args.seed)
    clock, rate = pygame.time.Clock(), 1.0 / env.unwrapped.task.control_period  # type: ignore[attr-defined]
    try:
        while player.running:
            for event in pygame.event.get():
                if event.type == pygame.QUIT:
                    player.running = False
                elif event.type == pygame.KEYDOWN:
                    player.press(event.key)
            player.tick()
            player.draw()
            clock.tick(rate)
    finally:
        pygame.quit()
    print(f"return {player.score:.3f}, peak force after latching {player.peak:.0f} N")
    return 0
