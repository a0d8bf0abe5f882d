"""README pages of the studies: the folder of the studies, and the page sections that commands write."""

from dataclasses import dataclass
from pathlib import Path

from solar_env.support.files import write_text

PACKAGE = Path(__file__).resolve().parent.parent
STUDIES = PACKAGE / "studies"


@dataclass(frozen=True)
class Section:
    """A section of a page, between two comment lines, that one command writes.

    Attributes:
        page: the README.md file.
        name: name of the section, unique in the page.
        command: command that writes the section.
    """

    page: Path
    name: str
    command: str

    def _split(self) -> tuple[str, str, str]:
        """Return the page up to the section, the section, and the rest of the page."""
        begin, end = f"<!-- {self.name}: written by `{self.command}` -->", f"<!-- end of {self.name} -->"
        before, begins, rest = self.page.read_text(encoding="utf-8").partition(begin)
        within, ends, after = rest.partition(end)
        if not (begins and ends):
            raise ValueError(f"{self.page} has no place for the result: add the lines {begin} and {end}")
        return before + begin, within.strip(), end + after

    def read(self) -> str:
        """Return the section's text, which lies between two comment lines of the page.

        Raises:
            ValueError: the page lacks one of the two comment lines.
            OSError: the page cannot be read.
        """
        return self._split()[1]

    def write(self, text: str) -> None:
        """Replace the section's text in the page.

        Raises:
            ValueError, OSError: as `read`, or the page cannot be written.
        """
        before, _, after = self._split()
        write_text(self.page, f"{before}\n\n{text}\n\n{after}")
