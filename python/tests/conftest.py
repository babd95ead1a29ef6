"""Paths of the tests: shipped files, and the program that has to say the same."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def shipped():
    """The folder of shipped scenarios."""
    return ROOT / "scenarios"


@pytest.fixture
def program():
    """The command line, run in a folder: `TOOLROOM` names it, or it is on the PATH."""
    command = os.environ.get("TOOLROOM") or shutil.which("toolroom")
    if command is None:
        pytest.skip("the program is not there: set TOOLROOM")

    def run(*words, cwd):
        return subprocess.run([command, *map(str, words)], cwd=cwd, check=True, capture_output=True, text=True).stdout

    return run
