"""What pyproject.toml cannot say: the records of `configs/` go into the wheel, and the README
without its links.

The records stay at the top of the tree, where people look for them. Mapping that folder to a
package instead would make setuptools put an import hook into every editable install, which costs
each start of the program some milliseconds.
"""

import re
import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent
RECORDS = "configs"


class BuildWithRecords(build_py):
    """Puts the records into the package, as `ptmcad.question.shipped` looks for them."""

    def run(self) -> None:
        super().run()
        if not self.editable_mode:
            shutil.copytree(
                ROOT / RECORDS, Path(self.build_lib) / "ptmcad" / RECORDS, dirs_exist_ok=True
            )

    def get_outputs(self, include_bytecode: bool = True) -> list[str]:
        records = [] if self.editable_mode else sorted((ROOT / RECORDS).rglob("*.yaml"))
        made = [
            str(Path(self.build_lib) / "ptmcad" / record.relative_to(ROOT)) for record in records
        ]
        return [*super().get_outputs(include_bytecode), *made]


def description() -> str:
    """The README as it can be read anywhere: no picture, and no link, that leads to another file of
    the repository.
    """
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    without_pictures = re.sub(r"^!\[[^\]]*\]\((?!https?:)[^)]*\)\n\n", "", text, flags=re.MULTILINE)
    return re.sub(r"\[([^\]]+)\]\((?!https?:)[^)]*\)", r"\1", without_pictures)


setup(
    cmdclass={"build_py": BuildWithRecords},
    long_description=description(),
    long_description_content_type="text/markdown",
)
