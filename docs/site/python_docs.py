#!/usr/bin/python3
"""The reference of Python, of the built module's stubs and sources: python_docs.py FOLDER prints {path: text} of its pages as JSON.

Docstrings are plain text in numpydoc's sections, which numpydoc makes into lists. Before that their marks are escaped, their types and
sources become links, and their equations stand as they are. By Debian's Python, for its numpydoc and the module's NumPy."""
import ast
import importlib
import inspect
import json
import pathlib
import re
import sys
import textwrap

from numpydoc.docscrape_sphinx import SphinxDocString

from sources import ROOT

SECTIONS = {"Parameters", "Attributes", "Returns", "Raises", "Notes"}
NAME = re.compile(r"[A-Za-z_][\w.]*")
KEYS = set(re.findall(r"^- \[(\w+)\]", (ROOT / "docs/bibliography.md").read_text(encoding="utf-8"), re.M))
PLACE = "docs/site/reference/python"


def escaped(text):
    """Marks of reStructuredText are letters; code and the keys of sources are not."""
    out = []
    for part in re.split(r"(`[^`]+`)", text):
        if re.fullmatch(r"`[^`]+`", part):
            out.append(f"`{part}`")
            continue
        part = re.sub(r"([\\*|`])", r"\\\1", part)
        part = re.sub(r"_(?!\w)", r"\\_", part)
        part = re.sub(r"(?<=[A-Za-z]):(?=[A-Za-z])", r"\\:", part)  # no address
        part = re.sub(r"^(\w{1,3}[.)] |[+•] )", r"\\\1", part)
        out.append(re.sub(r"\[(\w+)\]", lambda key: f"`[{key[1]}] <../../docs/bibliography.html#{key[1]}>`__" if key[1] in KEYS else key[0], part))
    return "".join(out)


def body(lines):
    """What is indented stands as it is, but in a list, where it goes on with its item."""
    out, item, literal = [], False, False
    for i, line in enumerate(lines):
        if item and line and not line.startswith("- ") and (line.startswith("  ") or lines[i - 1]):
            out[-1] += " " + escaped(line.strip())
        elif item and not line and i + 1 < len(lines) and lines[i + 1].startswith("  "):
            continue
        elif line.startswith("  "):
            out += ["    " + line] if literal else ["", "::", "", "    " + line]
            literal = True
        else:
            literal, item = literal and not line, line.startswith("- ") or item and not line
            out.append(escaped(line))
    return out


def sections(lines):
    """[title or "", its lines]."""
    parts = [["", []]]
    for i, line in enumerate(lines):
        if line in SECTIONS and i + 1 < len(lines) and set(lines[i + 1]) == {"-"}:
            parts.append([line, []])
        elif parts[-1][0] == "" or parts[-1][1] or set(line) != {"-"}:
            parts[-1][1].append(line)
    return parts


def is_property(node):
    return any(isinstance(one, ast.Name) and one.id == "property" for one in node.decorator_list)


def classes_in(nodes):
    return [one for one in nodes if isinstance(one, ast.ClassDef) and not one.name.startswith("_")]


def functions_in(nodes):
    return [one for one in nodes if isinstance(one, ast.FunctionDef) and not one.name.startswith("_") and not is_property(one)]


class Pages:
    def __init__(self, folder):
        self.folder = folder
        self.trees = {path.stem: ast.parse(path.read_text(encoding="utf-8")) for path in sorted((folder / "robomill").glob("*.pyi"))}
        self.trees.pop("_robomill")
        self.classes = {"robomill.Result", "robomill.Served"}
        for stage, tree in self.trees.items():
            self.collect(tree.body, "robomill" if stage == "__init__" else f"robomill.{stage}")

    def collect(self, nodes, prefix):
        for one in classes_in(nodes):
            self.classes.add(f"{prefix}.{one.name}")
            self.collect(one.body, f"{prefix}.{one.name}")

    def linked(self, text, module):
        """A type with links to classes of the library."""
        def link(found):
            for full in (f"{module}.{found[0]}", found[0], f"robomill.{found[0]}"):
                if full in self.classes:
                    return f":py:class:`{found[0].rpartition('.')[2]} <{full}>`"
            return re.sub(r"_(?!\w)", r"\\_", found[0])

        kind, mark, default = text.partition(", default: ")
        return NAME.sub(link, kind) + mark + escaped(default)

    def rendered(self, text, module):
        """A docstring as reStructuredText."""
        out, members = [], False
        for title, lines in sections(inspect.cleandoc(text).split("\n")):
            if title:
                members |= title == "Attributes"
                shown = "Parameters" if title == "Attributes" else title  # numpydoc would look these up
                out += ["", shown, "-" * len(shown)]
            if title in ("", "Notes"):
                out += body(lines)
                continue
            for line in lines:
                head, colon, kind = line.partition(" : ")
                out.append("    " + escaped(line.strip()) if line.startswith(" ") or not line else
                           f"{head} : {self.linked(kind, module)}" if colon else self.linked(line, module))
        made = re.sub(r"\n +\.\.$", "", str(SphinxDocString("\n".join(out))), flags=re.M)
        made = re.sub(r"\n{3,}", "\n\n", made).strip()
        return made.replace(":Parameters:", ":Members:") if members else made

    def described(self, directive, name, module, text, options=()):
        lines = [f".. py:{directive}:: {name}", f"   :module: {module}", *(f"   :{one}:" for one in options), "",
                 textwrap.indent(self.rendered(text, module), "   ") if text else "", "", ""]
        return "\n".join(lines)

    @staticmethod
    def signature(node, first=0):
        """Its parameters by name, with defaults that are no "..."."""
        given, parts = node.args, []
        positional = [one.arg for one in given.args[first:]]
        defaults = [None] * (len(positional) - len(given.defaults)) + given.defaults
        parts += [name if default is None else f"{name}={ast.unparse(default)}" for name, default in zip(positional, defaults)]
        if given.vararg or given.kwonlyargs:
            parts.append(f"*{given.vararg.arg if given.vararg else ''}")
        for one, default in zip(given.kwonlyargs, given.kw_defaults):
            text = "" if default is None else "=…" if ast.unparse(default) == "..." else f"={ast.unparse(default)}"
            parts.append(one.arg + text)
        return f"({', '.join(parts)})"

    def functions(self, nodes, module, owner=""):
        """One after another; of one name the first can be linked to."""
        seen, out = set(), []
        for one in functions_in(nodes):
            if owner and one.name == "replace":
                continue
            static = any(isinstance(mark, ast.Name) and mark.id == "staticmethod" for mark in one.decorator_list)
            options = ["noindex"] * (one.name in seen) + ["staticmethod"] * static
            seen.add(one.name)
            signature = self.signature(one, 1 if owner and not static else 0)
            out.append(self.described("method" if owner else "function", f"{owner}{one.name}{signature}", module, ast.get_docstring(one) or "", options))
        return out

    def kind(self, node):
        names = {one.name for one in node.body if isinstance(one, ast.FunctionDef)}
        if any(isinstance(one, ast.AnnAssign) and one.target.id == "__members__" for one in node.body):
            return "Enums"
        return "Structs" if "replace" in names or not functions_in(node.body) else "Classes"

    def klass(self, node, module, prefix=""):
        """(kind, text) of a class with its methods, and of those within it."""
        kind, name = self.kind(node), f"{prefix}{node.name}"
        made = next((one for one in node.body if isinstance(one, ast.FunctionDef) and one.name == "__init__"), None)
        signature = self.signature(made, 1) if kind == "Classes" and made and not made.args.vararg else ""
        text = ast.get_docstring(node) or ""
        if kind == "Enums":
            lines = [line for value, said in self.values(node) for line in (value, *(f"    {part}" for part in said.splitlines()))]
            text += "\n\nAttributes\n----------\n" + "\n".join(lines)
        bases = [ast.unparse(one) for one in node.bases]
        text = (f"A {', '.join(f'`{one}`' for one in bases)}. " if bases and kind != "Enums" else "") + text
        block = self.described("class", name + signature, module, text)
        if kind != "Enums":
            block += "".join(textwrap.indent(one, "   ") for one in self.functions(node.body, module, f"{name}."))
        yield kind, block
        for one in classes_in(node.body):
            yield from self.klass(one, module, f"{name}.")

    @staticmethod
    def values(node):
        """Annotated names, with the text below each."""
        for one, after in zip(node.body, [*node.body[1:], None]):
            if isinstance(one, ast.AnnAssign) and not one.target.id.startswith("__"):
                said = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant) and after.value.value
                yield one.target.id, inspect.cleandoc(said) if isinstance(said, str) else ""

    def groups(self, nodes, module):
        groups = {"Functions": self.functions(nodes, module), "Classes": [], "Structs": [], "Enums": []}
        for node in classes_in(nodes):
            for kind, text in self.klass(node, module):
                groups[kind].append(text)
        return "\n".join(f"## {title}\n\n{block(*texts)}" for title, texts in groups.items() if texts)

    def stage(self, stage):
        tree, module = self.trees[stage], f"robomill.{stage}"
        readme = "base" if stage == "units" else stage
        parts = [f"# {module}\n", f"`from robomill import {stage}`. Methods, accuracy and cost: [robomill/{readme}](../../../../robomill/{readme}/README.md).\n"]
        constants = list(self.values(tree))
        if constants:
            there = importlib.import_module("robomill")
            parts += ["## Constants\n", "| name | value | |\n|---|---|---|"]
            parts += [f"| `{name}` | {getattr(getattr(there, stage), name)!r} | {said} |" for name, said in constants]
            parts.append("")
        return "\n".join([*parts, self.groups(tree.body, module)])

    def source(self, name):
        return ast.parse((self.folder / f"robomill/{name}.py").read_text(encoding="utf-8"))

    def written(self, title, module, text, parts):
        """A page of a module that is written in Python."""
        tree = self.source(parts)
        return f"# {title}\n\n{text}\n\n" + block(*self.functions(tree.body, module))

    def results(self):
        result = next(one for one in classes_in(self.source("results").body) if one.name == "Result")
        part = next(one for one in classes_in(self.source("results").body) if one.name == "Part")
        served = next(one for one in classes_in(self.source("commands").body) if one.name == "Served")
        wrong = next(one for one in classes_in(self.trees["__init__"].body) if one.name == "InvalidInput")
        properties = [one for one in result.body if isinstance(one, ast.FunctionDef) and is_property(one)]
        members = [self.described("attribute", f"Result.{one.name}", "robomill", ast.get_docstring(one)) for one in properties]
        members += self.functions([*result.body, *part.body], "robomill", "Result.")
        return {"result": self.described("class", "Result", "robomill", ast.get_docstring(result)) + textwrap.indent("".join(members), "   "),
                "served": self.described("class", "Served", "robomill", ast.get_docstring(served)) +
                textwrap.indent("".join(self.functions(served.body, "robomill", "Served.")), "   "),
                "error": self.described("exception", "InvalidInput", "robomill", ast.get_docstring(wrong))}

    def all(self):
        package = self.trees["__init__"].body
        is_verb = lambda one: isinstance(one, ast.FunctionDef) and isinstance(one.returns, ast.Name) and one.returns.id == "Result"  # noqa: E731
        verbs = [*filter(is_verb, package), *functions_in(self.source("commands").body), *functions_in(self.source("study").body)]
        out = {f"{stage}.md": self.stage(stage) for stage in self.trees if stage != "__init__"}
        out["verbs.md"] = "# Verbs\n\nThe verbs of the command line as functions: files in, a [Result](results.md) out. All options are keywords, in the " \
            "units of their names. What the files hold: [Files](../../../formats.md).\n\n" + block(*self.functions(verbs, "robomill"))
        out["package.md"] = "# robomill\n\nWhat stands in the package itself, beside the [verbs](verbs.md).\n\n" + \
            self.groups([one for one in package if not is_verb(one) and getattr(one, "name", "") != "InvalidInput"], "robomill")
        out["plot.md"] = self.written("robomill.plot", "robomill.plot", "Figures of results, with matplotlib: each function takes a verb's result or its "
                                      "document.", "plot")
        out["exchange.md"] = self.written("robomill.exchange", "robomill.exchange", "FRFs from and to arrays and other packages. FRFs are receptances in "
                                          "m/N; what was measured as velocity or acceleration is divided by iω or (iω)².", "exchange")
        results = (ROOT / PLACE / "results.md").read_text(encoding="utf-8")
        for name, text in self.results().items():
            results = results.replace(f"<!-- {name} -->", block(text))
        out["results.md"] = results
        return {f"{PLACE}/{name}": text for name, text in out.items()}


def block(*texts):
    return "```{eval-rst}\n" + "\n".join(texts) + "\n```\n"


if __name__ == "__main__":
    sys.path.insert(0, sys.argv[1])
    json.dump(Pages(pathlib.Path(sys.argv[1])).all(), sys.stdout)
