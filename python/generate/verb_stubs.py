"""Writes robomill/__init__.pyi: the verbs, from the records that the built module has, and what stands in the package itself.

    PYTHONPATH=BUILD/python python3 verb_stubs.py PACKAGE_STUB FOLDER"""
import inspect
import pathlib
import sys
import types

import robomill

KINDS = {"flag": "bool", "whole": "int", "number": "float", "numbers": "Sequence[float]", "text": "str", "texts": "str | Sequence[str]", "word": "str",
         "file": "str | os.PathLike[str]", "files": "str | os.PathLike[str] | Sequence[str | os.PathLike[str]]", "new_file": "str | os.PathLike[str]",
         "new_folder": "str | os.PathLike[str]", "point": "tuple[float, float]", "points": "Sequence[tuple[float, float]]"}


def kinds():
    """What each option of any verb takes, by Python's name."""
    out = {}
    for verb in robomill._robomill._verbs():
        for option in [*verb["options"], verb["input"]]:
            kind = KINDS[option["takes"]]
            if option["words"]:
                kind = f"Literal[{', '.join(repr(word) for word in option['words'])}]"
            out.setdefault(robomill.verbs._python_name(option["name"]), []).append(kind)
    return {name: " | ".join(dict.fromkeys(all_kinds)) for name, all_kinds in out.items()}


def documented(thing):
    doc = thing.__doc__.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\n    ")
    return f'    """{doc}"""\n'


def verb_stub(name, known):
    parts = ["*inputs: str | os.PathLike[str]"]
    for parameter in list(inspect.signature(getattr(robomill, name)).parameters.values())[1:]:
        kind = {"output": "str | os.PathLike[str]", "progress": "Callable[[str, float], object] | bool"}.get(parameter.name) or known[parameter.name]
        parts.append(f"{parameter.name}: {kind} | None = ...")
    return f'def {name}({", ".join(parts)}) -> Result:\n{documented(getattr(robomill, name))}'


def main():
    stub, folder = pathlib.Path(sys.argv[1]).read_text(), pathlib.Path(sys.argv[2])
    known = kinds()
    modules = sorted(name for name in robomill.__all__ if isinstance(getattr(robomill, name), types.ModuleType))
    head = "".join(f"from . import {name} as {name}\n" for name in modules) + "from .results import Result as Result\n" + \
        "from .commands import Served as Served, init as init, monitor_input as monitor_input, serve_folder as serve_folder\n" + \
        "from .study import sweep as sweep\n"
    errors = "".join(f"    {name}: {kind}\n" for name, kind in
                     {"where": "str", "field": "str", "number": "float | None", "value": "str", "unit": "str", "rule": "str", "hint": "str"}.items())
    text = stub.replace("from typing import Any", "from typing import Any, Literal") + head + f"\n__version__: str\n\nclass InvalidInput(ValueError):\n{documented(robomill.InvalidInput)}{errors}\n" + \
        "\n".join(verb_stub(name, known) for name in robomill._verbs)
    path = folder / "__init__.pyi"
    path.write_text(text)


main()
