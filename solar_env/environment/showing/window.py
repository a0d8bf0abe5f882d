"""The window that shows frames in the render mode "human"."""

import importlib.util
import os
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

_INVISIBLE = ("offscreen", "dummy")  # SDL's video drivers without a visible display


def open_display() -> Any:
    """Open pygame's display and return the pygame module; `SDL_VIDEODRIVER` may choose an invisible display.

    Raises:
        OSError: no display opens, or only an invisible one that `SDL_VIDEODRIVER` did not choose.
    """
    import pygame

    advice = (
        "run it where there is one, set SDL_VIDEODRIVER=dummy where nobody is to see it (for an environment checker), "
        "or film an episode (solar-env replay)"
    )
    try:
        pygame.display.init()
    except pygame.error as error:
        raise OSError(f"there is no display for a window ({error}); {advice}") from error
    driver = pygame.display.get_driver()
    if driver in _INVISIBLE and not os.environ.get("SDL_VIDEODRIVER"):
        pygame.display.quit()
        raise OSError(f"there is no display for a window (SDL has its driver {driver!r} alone); {advice}")
    return pygame


class Window:
    """A window that shows frames at a given rate [Hz]. The window opens with the first frame; a copy starts closed.

    Construction raises DependencyNotInstalled without pygame, and OSError without a display.
    """

    def __init__(self, rate: float) -> None:
        if importlib.util.find_spec("pygame") is None:
            remedy = "pip install -e '.[play]', or give check_env skip_render_check=True"
            raise gymnasium.error.DependencyNotInstalled(f"the window needs pygame: {remedy}")
        open_display()  # raises its error before kernels are compiled
        self._rate = rate
        self._surface: Any = None
        self._clock: Any = None

    def __getstate__(self) -> dict[str, object]:
        return {**vars(self), "_surface": None, "_clock": None}

    def show(self, frame: NDArray[np.uint8] | None) -> None:
        """Show a frame (height, width, 3) uint8, after a wait that keeps the frame rate; None fails an assertion."""
        assert frame is not None
        pygame = open_display()
        image = pygame.surfarray.make_surface(frame.swapaxes(0, 1))
        if self._surface is None:
            self._surface, self._clock = pygame.display.set_mode(image.get_size()), pygame.time.Clock()
            pygame.display.set_caption("solar_env")
        self._surface.blit(image, (0, 0))
        pygame.event.pump()  # otherwise the system reports that the window hangs
        self._clock.tick(self._rate)
        pygame.display.flip()

    def close(self) -> None:
        """Close the window; the next frame opens it again."""
        if self._surface is not None:
            import pygame

            pygame.display.quit()
            self._surface = None
