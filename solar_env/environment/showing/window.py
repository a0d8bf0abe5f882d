"""The window of the render mode "human"."""

import importlib.util
from typing import Any

import gymnasium
from numpy.typing import NDArray


class Window:
    """A window that shows frames at their pace. It opens with the first one; a copy of it begins closed.

    Args:
        rate: frames in a second [Hz].

    Raises:
        gymnasium.error.DependencyNotInstalled: on construction, without pygame.
    """

    def __init__(self, rate: float) -> None:
        if importlib.util.find_spec("pygame") is None:
            raise gymnasium.error.DependencyNotInstalled("the window needs pygame: pip install 'solar-env[play]'")
        self._rate = rate
        self._surface: Any = None
        self._clock: Any = None

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "_surface": None, "_clock": None}

    def show(self, frame: NDArray[Any] | None) -> None:
        """Show a frame, (height, width, 3) uint8, once its time has come."""
        import pygame

        assert frame is not None
        image = pygame.surfarray.make_surface(frame.swapaxes(0, 1))
        if self._surface is None:
            pygame.display.init()
            self._surface, self._clock = pygame.display.set_mode(image.get_size()), pygame.time.Clock()
            pygame.display.set_caption("solar_env")
        self._surface.blit(image, (0, 0))
        pygame.event.pump()  # else the system takes the window for hung
        self._clock.tick(self._rate)
        pygame.display.flip()

    def close(self) -> None:
        """Close the window; the next frame opens it again."""
        if self._surface is not None:
            import pygame

            pygame.display.quit()
            self._surface = None
