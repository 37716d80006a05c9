"""What the README shows is what works: its Python and its scenario files."""

import re
from pathlib import Path

import pytest

from mala_drake import LoadScenario

README = Path(__file__).parents[1] / "README.md"


def blocks(language):
    found = re.findall(rf"^```{language}\n(.*?)^```$", README.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert found, f"the README has no {language}"
    return found


@pytest.mark.parametrize("code", blocks("python"))
def test_python_runs_as_it_stands(code, capsys):
    exec(compile(code, README.name, "exec"), {"__name__": "readme"})
    assert capsys.readouterr().out.strip()


@pytest.mark.parametrize("text", blocks("yaml"))
def test_a_scenario_is_one(text, tmp_path):
    (tmp_path / "scenario.yaml").write_text(text)
    assert LoadScenario(tmp_path / "scenario.yaml") != LoadScenario()
