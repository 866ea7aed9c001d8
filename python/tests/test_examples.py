"""Every example runs, and draws with a back end that needs no screen."""
import os
import pathlib
import subprocess
import sys

import pytest

EXAMPLES = sorted((pathlib.Path(__file__).resolve().parents[1] / "examples").glob("*.py"))


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_runs(script, tmp_path):
    done = subprocess.run([sys.executable, str(script)], cwd=tmp_path, env={**os.environ, "MPLBACKEND": "Agg"}, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr


def test_readme_runs(capsys):
    readme = (EXAMPLES[0].parents[2] / "README.md").read_text(encoding="utf-8")
    exec(readme.split("```python\n")[1].split("```")[0], {})
    assert capsys.readouterr().out.startswith("[(4000.0")


def test_tutorial_shows_an_example():
    """The tutorial's Python is that of the example, line by line."""
    root = EXAMPLES[0].parents[2]
    tutorial = (root / "docs/site/tutorials/researcher.md").read_text(encoding="utf-8")
    script = (root / "python/examples/09_own_method.py").read_text(encoding="utf-8")
    blocks = [part.split("```")[0] for part in tutorial.split("```python\n")[1:]]
    assert len(blocks) >= 4
    for block in blocks:
        assert block in script, block


def test_there_are_nine():
    assert len(EXAMPLES) == 9
