"""Type stubs of the stages' modules, from the same headers as their bindings."""
from generate.docs import Docs
from generate.headers import Function, python_name
from generate.kinds import Names, Types, python_call

HEAD = '''"""{doc}"""
import enum
import os
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

class _Type(type): ...

'''


class Stubs(Names):
    def __init__(self, library, not_bound):
        super().__init__(library)
        self.library = library
        self.docs = Docs(library)
        self.missing = {name for name, _ in not_bound}
        self.types = Types(library)

    def signature(self, function, stage, is_method):
        call, given = python_call(function, self.types), []
        for parameter in call.given:
            default = " = ..." if parameter.default is not None else ""
            given.append(f"{python_name(parameter.name)}: {self.type(parameter.type, stage, True)}{default}")
        if call.progress:
            given.append("progress: Callable[[str, float], object] | None = ...")
        parts = ([] if call.result == "void" else [self.type(call.result, stage, False)]) + [self.type(one.type, stage, False) for one in call.returned]
        result = f"tuple[{', '.join(parts)}]" if call.returned and not self.types.is_listing(function) else parts[0] if parts else "None"
        head = (["self"] if is_method else []) + (["*", *given] if given else [])
        return f"({', '.join(head)}) -> {result}"

    def documented(self, doc, indent):
        if not doc:
            return f"{indent}    ..."
        text = doc.replace("\\", "\\\\").replace('"', '\\"')
        return f'{indent}    """{text}"""'.replace("\n", f"\n{indent}    ")

    def functions(self, functions, stage, indent, is_method):
        lines, names = [], [one.name for one in functions]
        # What has one name stands together.
        for function in sorted(functions, key=lambda one: names.index(one.name)):
            if f"{function.owner}::{function.name}" in self.missing:
                continue
            overloaded = sum(1 for one in functions if one.name == function.name and f"{one.owner}::{one.name}" not in self.missing) > 1
            if overloaded:
                lines.append(f"{indent}@overload")
            static = function.is_static and is_method
            if static:
                lines.append(f"{indent}@staticmethod")
            ignore = "  # type: ignore[override]" if is_method and self.structs[function.owner].bases else ""
            lines.append(f"{indent}def {python_name(function.name)}{self.signature(function, stage, is_method and not static)}:{ignore}")
            lines.append(self.documented(self.docs.function(function), indent))
        return lines

    def enum(self, enum, indent):
        lines = [f"{indent}class {enum.name}(metaclass=_Type):", self.documented(enum.doc, indent)]
        for name, doc in enum.values:
            lines += [f"{indent}    {python_name(name)}: {enum.name}", *([self.documented(doc, indent)] if doc else [])]
        lines += [f"{indent}    __members__: dict[str, {enum.name}]", f"{indent}    def __init__(self, value: int | str) -> None: ...",
                  f"{indent}    @property", f"{indent}    def name(self) -> str: ...", f"{indent}    @property", f"{indent}    def value(self) -> int: ..."]
        name = ".".join(enum.qualified.split("::")[2 if self.stage_of(enum.owner) else 1:])
        return [line.replace(f": {enum.name}", f": {name}").replace(f"[str, {enum.name}]", f"[str, {name}]") for line in lines]

    def constructed(self, struct):
        """Constructors of a class that Python has."""
        if not struct.is_class or struct.is_abstract or f"{struct.qualified}::{struct.name}" in self.missing:
            return []
        return struct.constructors if struct.has_constructor else [Function(struct.name, struct.qualified, "", [], "")]

    def struct(self, struct, stage, indent):
        bases = ", ".join(self.name_of(one, stage) for one in struct.bases if one in self.structs)
        inherited = [field for base in struct.bases if base in self.structs for field in self.structs[base].fields]
        fields = [one for one in [*inherited, *struct.fields] if f"{struct.qualified}::{one.name}" not in self.missing]
        constructed = self.constructed(struct)
        doc = self.docs.klass(struct, constructed) if struct.is_class else self.docs.struct(struct, fields)
        lines = [f"{indent}class {struct.name}({bases or 'metaclass=_Type'}):", self.documented(doc, indent)]
        inner = indent + "    "
        for enum in self.library.enums:
            if enum.owner == struct.qualified:
                lines += self.enum(enum, inner)
        for other in self.library.structs:
            if other.owner == struct.qualified:
                lines += self.struct(other, stage, inner)
        if struct.qualified == "robomill::io::TomlSource":
            lines.append(f"{inner}def __init__(self, path: str | os.PathLike[str], *, text: str | None = ..., settings: Sequence[TomlSetting] = ...) -> None: ...")
        elif self.types.refers(struct):
            given = "".join(f", {python_name(one.name)}: {self.type(one.type, stage, True)}{'' if one.type.endswith('&') else ' = ...'}" for one in fields)
            lines.append(f"{inner}def __init__(self, *{given}) -> None: ...")
        elif not constructed and (struct.is_class or self.docs.made_by_library(struct)):
            lines.append(f"{inner}def __init__(self, *args: Any, **kwargs: Any) -> None: ...")  # the library makes them
        elif not struct.is_class:
            given = "".join(f", {python_name(one.name)}: {self.type(one.type, stage, True)} = ..." for one in fields)
            star = ", *" if fields else ""
            lines += [f"{inner}def __init__(self{star}{given}) -> None: ...", f"{inner}def replace(self{star}{given}) -> {self.name_of(struct.qualified, stage)}: ..."]
        for one in constructed:
            if len(constructed) > 1:
                lines.append(f"{inner}@overload")
            lines.append(f"{inner}def __init__{self.signature(one, stage, True).rsplit(' -> ', 1)[0]} -> None: ...")
        for one in fields:
            lines += [f"{inner}@property", f"{inner}def {python_name(one.name)}(self) -> {self.type(one.type, stage, False)}:", self.documented(one.doc, inner)]
        return lines + self.functions(struct.methods, stage, inner, True)

    def write(self):
        """{stage: stub}; the stage "" is what stands in the package itself."""
        out = {}
        for stage in dict.fromkeys(self.stage_of(one.owner) for one in [*self.library.constants, *self.library.enums, *self.library.structs, *self.library.functions]):
            owner = f"robomill::{stage}" if stage else "robomill"
            lines = []
            for one in self.library.constants:
                if one.owner == owner:
                    lines += [f"{python_name(one.name)}: float", *([f'"""{one.doc}"""'] if one.doc else [])]
            for enum in self.library.enums:
                if enum.owner == owner:
                    lines += self.enum(enum, "")
            for struct in self.library.structs:
                if struct.owner == owner:
                    lines += self.struct(struct, stage, "")
            lines += self.functions([one for one in self.library.functions if one.owner == owner], stage, "", False)
            text = HEAD.format(doc=f"robomill.{stage}" if stage else "robomill") + ("import robomill\n\n" if stage else "") + "\n".join(lines) + "\n"
            if "@overload" in text:
                text = text.replace("from typing import Any\n", "from typing import Any, overload\n")
            out[stage] = text
        return out


def write_stubs(library, not_bound):
    return Stubs(library, not_bound).write()
