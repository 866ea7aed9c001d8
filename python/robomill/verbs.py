"""The verbs as functions, made of the library's records of them: names, options, texts."""
import inspect
import json
import keyword
import os

from . import _robomill
from .results import Result

_KINDS = {"flag": bool, "whole": int, "number": float, "numbers": "sequence of float", "text": str, "texts": "sequence of str", "word": str,
          "file": "path", "files": "sequence of paths", "new_file": "path", "new_folder": "path", "point": "(rpm, mm)",
          "points": "sequence of (rpm, mm)"}


def _python_name(name):
    name = name.replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


def _split(verb):
    """"couple --tools" is couple with the option tools; "cell check" is cell_check."""
    words = verb["name"].split()
    flags = [word[2:].replace("-", "_") for word in words if word.startswith("--")]
    return "_".join(word for word in words if not word.startswith("--")), flags


def _request(verb, options):
    """The options as a request has them: by their names, one value alone as a list of one where a list is taken."""
    known = {_python_name(option["name"]): option for option in verb["options"]}
    request = {}
    for name, value in options.items():
        value = _plain(value)
        if known[name]["takes"] in ("files", "texts") and isinstance(value, str):
            value = [value]
        request[known[name]["name"]] = value
    return request


def _plain(value):
    """As JSON has it: paths as text, arrays as lists."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    return value


def _progress(show):
    """None, a function, or True: a bar of tqdm where it is installed."""
    if show is not True:
        return show or None
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    bar = tqdm(total=100, unit="%", leave=False)

    def report(task, fraction):
        bar.set_description(task)
        bar.update(round(100 * fraction) - bar.n)

    return report


def _choose(verbs, options):
    """The verb that has an option for each that is given, the one that needs most of them first."""
    fitting = [verb for verb in verbs if all(flag in options for flag in _split(verb)[1])]
    return max(fitting, key=lambda verb: len(_split(verb)[1])) if fitting else verbs[0]


def _run(verbs, inputs, output, progress, options):
    options = {name: value for name, value in options.items() if value is not None}
    verb = _choose(verbs, options)
    known = {_python_name(option["name"]) for option in verb["options"]}
    own = _python_name(verb["input"]["name"])
    unknown = [name for name in options if name not in known and name != own]
    if unknown:
        raise TypeError(f"robomill {verb['name']} has no option {unknown[0]}; it has {', '.join(sorted(known))}")
    if own in options and not inputs:
        inputs = options.pop(own)
    given = [inputs] if isinstance(inputs, (str, os.PathLike)) else list(inputs)
    request = _request(verb, options)
    document, summary, shortfall, page = _robomill._run(verb["name"], [os.fspath(one) for one in given], os.fspath(output or ""),
                                                        json.dumps(request), _progress(progress))
    return Result(json.loads(document) if document else {}, summary, shortfall, page)


def _entry(option, required):
    kind = _KINDS[option["takes"]]
    kind = kind if isinstance(kind, str) else kind.__name__
    words = f", one of {', '.join(option['words'])}" if option["words"] else ""
    needs = f"; needs `{_python_name(option['needs'])}`" if option["needs"] else ""
    excludes = f"; not with `{_python_name(option['excludes'])}`" if option["excludes"] else ""
    return [f"{_python_name(option['name'])} : {kind}{words}{'' if required else ', optional'}", f"    {option['meaning']}{needs}{excludes}"]


def _section(title, lines):
    return ["", title, "-" * len(title), *lines]


def _documentation(verbs):
    lines = []
    for verb in verbs:
        lines += [f"{verb['purpose'][:1].upper()}{verb['purpose'][1:]}.", *(["", verb["more"]] if verb["more"] else []), ""]
    first = verbs[0]["input"]
    given = ["*inputs : path", f"    {first['meaning']}"]
    own = {first["name"]: first}
    for verb in verbs:
        for option in [*verb["options"], verb["input"]]:
            if option["name"] and own.setdefault(option["name"], option) is option and option is not first:
                given += _entry(option, option["required"] and verb is verbs[0])
    given += ["output : path, optional", "    a file or folder that is written too, its format by its ending", "progress : callable(str, float) or True, optional",
              "    called with a task and the share that is done; True: a bar of tqdm"]
    lines = lines[:-1] + _section("Parameters", given)
    lines += _section("Returns", ["Result", "    the verb's JSON document; docs/formats.md has its keys"])
    lines += _section("Raises", ["InvalidInput", "    naming file, line or field, value, unit and rule", "KeyboardInterrupt", "    when Ctrl-C is pressed"])
    lines += _section("Notes", ["On the command line:", "", *(f"    robomill {verb['example']}" for verb in verbs if verb["example"])])
    return "\n".join(lines)


def _function(name, verbs, module):
    options = {}
    for verb in verbs:
        for option in [*verb["options"], *([verb["input"]] if verb is not verbs[0] else [])]:
            if option["name"]:
                options.setdefault(_python_name(option["name"]), option)
    first = _python_name(verbs[0]["input"]["name"]) or "inputs"
    options.pop(first, None)

    def run(*inputs, output=None, progress=None, **given):
        return _run(verbs, inputs[0] if len(inputs) == 1 else inputs, output, progress, given)

    parameters = [inspect.Parameter("inputs", inspect.Parameter.VAR_POSITIONAL)]
    parameters += [inspect.Parameter(one, inspect.Parameter.KEYWORD_ONLY, default=None) for one in [*options, "output", "progress"]]
    run.__signature__ = inspect.Signature(parameters)
    run.__name__ = run.__qualname__ = name
    run.__module__ = module
    run.__doc__ = _documentation(verbs)
    return run


def define(scope, module):
    """Puts a function for each verb into a module that has none of its own; @returns their names."""
    groups = {}
    for verb in _robomill._verbs():
        name, flags = _split(verb)
        if callable(scope.get(name)):
            continue
        # A stage has that name: "monitor --learn" is monitor_learn.
        groups.setdefault("_".join([name, *flags]) if name in scope else name, []).append(verb)
    for name, verbs in groups.items():
        scope[name] = _function(name, verbs, module)
    return list(groups)
