"""Type stubs of the stages' modules, from the same headers as their bindings."""
import re

from generate.bindings import NUMBERS, Types, arguments_of, without_reference
from generate.headers import python_name

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
FLOAT = {"double", "float"}


class Stubs:
    def __init__(self, library, not_bound):
        self.library = library
        self.missing = {name for name, _ in not_bound}
        self.types = Types(library)
        self.structs = {one.qualified: one for one in library.structs}
        self.enums = {one.qualified for one in library.enums}

    def stage_of(self, owner):
        while owner in self.structs:
            owner = self.structs[owner].owner
        return owner.split("::")[1] if "::" in owner else ""

    def name_of(self, qualified, stage):
        """As it is written in the stage's stub."""
        parts = qualified.split("::")[1:]
        other = self.stage_of(qualified.rsplit("::", 1)[0])
        if not other:
            return ("robomill." if stage else "") + ".".join(parts)
        return ".".join(parts[1:]) if other == stage else "robomill." + ".".join(parts)

    def type(self, name, stage, given):
        """@param given  whether a caller gives it: then more is taken than is returned."""
        name = without_reference(name).removeprefix("const ")
        if name in ("void",):
            return "None"
        if name == "bool":
            return "bool"
        if name in FLOAT:
            return "float"
        if re.fullmatch(NUMBERS, name) or name == "std::byte":
            return "int"
        if name in ("std::string", "std::string_view", "char *"):
            return "str"
        if name == "std::filesystem::path":
            return "str | os.PathLike[str]" if given else "pathlib.Path"
        if name.startswith("std::complex"):
            return "complex"
        if name == "robomill::io::TomlSource":
            return "str | os.PathLike[str] | robomill.io.TomlSource" if given else self.name_of(name, stage)
        if name in self.enums:
            text = self.name_of(name, stage)
            return f"{text} | str" if given else text
        if name in self.structs:
            return self.name_of(name, stage)
        if name.endswith(" *"):
            return f"{self.type(name[:-2], stage, given)} | None"
        if name.startswith("Eigen::"):
            return "npt.ArrayLike" if given else f"npt.NDArray[np.{'complex128' if 'complex' in name else 'float64'}]"
        template, inner = arguments_of(name)
        if template in ("std::vector", "std::array", "std::span", "std::set"):
            if re.fullmatch(NUMBERS, inner[0].removeprefix("const ")) or "std::complex" in inner[0]:
                return "npt.ArrayLike" if given else "npt.NDArray[Any]"
            kind = "Sequence" if given else "set" if template == "std::set" else "list"
            return f"{kind}[{self.type(inner[0], stage, given)}]"
        if template == "std::optional":
            return f"{self.type(inner[0], stage, given)} | None"
        if template == "std::shared_ptr":
            return f"{self.type(inner[0], stage, given)} | None"
        if template == "std::unique_ptr":
            return self.type(inner[0], stage, given)
        if template in ("std::pair", "std::tuple"):
            return f"tuple[{', '.join(self.type(one, stage, given) for one in inner)}]"
        if template == "std::variant":
            return " | ".join(self.type(one, stage, given) for one in inner)
        if template == "std::map":
            return f"{'Mapping' if given else 'dict'}[{self.type(inner[0], stage, given)}, {self.type(inner[1], stage, given)}]"
        if template == "std::function":
            found = re.match(r"(.*?)\s*\((.*)\)$", ", ".join(inner))
            taken = ", ".join(self.type(one, stage, False) for one in arguments_of(f"x<{found.group(2)}>")[1] if one)
            return f"Callable[[{taken}], {self.type(found.group(1), stage, True)}]"
        return "Any"

    def signature(self, function, stage, is_method):
        given, returned = [], []
        for parameter in function.parameters:
            plain = without_reference(parameter.type)
            if plain == "robomill::Progress" or parameter.default == "nullptr" and not self.types.is_parameter(parameter.type):
                continue
            if parameter.type.endswith("&") and not parameter.type.startswith("const ") and plain.startswith("std::vector<"):
                returned.append(self.type(plain, stage, False))
                continue
            default = " = ..." if parameter.default is not None else ""
            given.append(f"{python_name(parameter.name)}: {self.type(parameter.type, stage, True)}{default}")
        if any(without_reference(one.type) == "robomill::Progress" for one in function.parameters):
            given.append("progress: Callable[[str, float], object] | None = ...")
        result = self.type(function.result, stage, False)
        if returned:
            parts = ([] if function.result == "void" else [result]) + returned
            result = f"tuple[{', '.join(parts)}]"
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
            lines.append(self.documented(function.doc, indent))
        return lines

    def enum(self, enum, indent):
        lines = [f"{indent}class {enum.name}(metaclass=_Type):", self.documented(enum.doc, indent)]
        for name, _ in enum.values:
            lines.append(f"{indent}    {python_name(name)}: {enum.name}")
        lines += [f"{indent}    __members__: dict[str, {enum.name}]", f"{indent}    def __init__(self, value: int | str) -> None: ...",
                  f"{indent}    @property", f"{indent}    def name(self) -> str: ...", f"{indent}    @property", f"{indent}    def value(self) -> int: ..."]
        name = ".".join(enum.qualified.split("::")[2 if self.stage_of(enum.owner) else 1:])
        return [line.replace(f": {enum.name}", f": {name}").replace(f"[str, {enum.name}]", f"[str, {name}]") for line in lines]

    def struct(self, struct, stage, indent):
        bases = ", ".join(self.name_of(one, stage) for one in struct.bases if one in self.structs)
        lines = [f"{indent}class {struct.name}({bases or 'metaclass=_Type'}):", self.documented(struct.doc, indent)]
        inner = indent + "    "
        for enum in self.library.enums:
            if enum.owner == struct.qualified:
                lines += self.enum(enum, inner)
        for other in self.library.structs:
            if other.owner == struct.qualified:
                lines += self.struct(other, stage, inner)
        inherited = [field for base in struct.bases if base in self.structs for field in self.structs[base].fields]
        fields = [one for one in [*inherited, *struct.fields] if f"{struct.qualified}::{one.name}" not in self.missing]
        constructed = [one for one in struct.constructors if f"{struct.qualified}::{struct.name}" not in self.missing] if struct.is_class and not struct.is_abstract else []
        if struct.qualified == "robomill::io::TomlSource":
            lines.append(f"{inner}def __init__(self, path: str | os.PathLike[str], *, text: str | None = ..., settings: Sequence[TomlSetting] = ...) -> None: ...")
        elif not constructed and (struct.is_class or any(one.type.endswith("&") or "unique_ptr" in one.type for one in struct.fields)):
            lines.append(f"{inner}def __init__(self, *args: Any, **kwargs: Any) -> None: ...")  # the library makes them
        elif not struct.is_class:
            given = "".join(f", {python_name(one.name)}: {self.type(one.type, stage, True)} = ..." for one in fields)
            star = ", *" if fields else ""
            lines += [f"{inner}def __init__(self{star}{given}) -> None: ...", f"{inner}def replace(self{star}{given}) -> {self.name_of(struct.qualified, stage)}: ..."]
        for one in constructed:
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
