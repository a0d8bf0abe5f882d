"""README pages of the studies: where they lie, and the sections of them that commands write."""

from dataclasses import dataclass
from pathlib import Path

from solar_env.support.files import write_text

PACKAGE = Path(__file__).resolve().parent.parent
STUDIES = PACKAGE / "studies"


@dataclass(frozen=True)
class Section:
    """Part of a page between two lines of comment, which one command writes.

    Attributes:
        page: the README.md file.
        name: of the section, unique in its page.
        command: the command that writes it.
    """

    page: Path
    name: str
    command: str

    @property
    def begin(self) -> str:
        """Line before the section."""
        return f"<!-- {self.name}: written by `{self.command}` -->"

    @property
    def end(self) -> str:
        """Line after the section."""
        return f"<!-- end of {self.name} -->"

    def _split(self) -> tuple[str, str, str]:
        """The page before, within and after the section."""
        text = self.page.read_text(encoding="utf-8")
        if text.count(self.begin) != 1 or text.count(self.end) != 1 or text.index(self.begin) > text.index(self.end):
            raise ValueError(
                f"{self.page} has no place for the result: add the lines {self.begin} and {self.end} once each"
            )
        before, rest = text.split(self.begin)
        within, after = rest.split(self.end)
        return before, within, after

    def read(self) -> str:
        """The section's text, without the lines of comment.

        Raises:
            ValueError: the page does not have each line of comment once, the first before the second.
            OSError: the page cannot be read.
        """
        return self._split()[1].strip()

    def write(self, text: str) -> None:
        """Replace the section's text.

        Raises:
            ValueError, OSError: as `read`, or the page cannot be written.
        """
        before, _, after = self._split()
        write_text(self.page, f"{before}{self.begin}\n\n{text}\n\n{self.end}{after}")
