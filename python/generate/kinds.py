"""Types of C++: which of them can be bound, and what Python calls them."""
import dataclasses
import re

from generate.headers import Parameter

INVALID_INPUT = "robomill::InvalidInput"  # an exception of Python's
NUMBERS = r"(?:double|float|int|unsigned int|long|unsigned long|long long|unsigned long long|short|unsigned short|unsigned char|signed char)"
#: Types that a value of Python becomes, or that become one, beside the library's own structs and enums.
PLAIN = re.compile(rf"(?:bool|void|{NUMBERS}|std::string|std::string_view|const char \*|std::filesystem::path|std::complex<(?:double|float)>|std::byte)$")
EIGEN = re.compile(r"Eigen::(?:Matrix|Transform|Ref|Quaternion|Array|Map)<")


def without_reference(name):
    return re.sub(r"^const (?!char \*)|\s*&&?$", "", name).strip()


def arguments_of(name):
    """The template's name and its arguments: "std::map", ["std::string", "int"]."""
    found = re.match(r"([\w:]+)<(.*)>$", name)
    if not found:
        return name, []
    parts, depth, part = [], 0, ""
    for letter in found.group(2):
        depth += letter in "<(" 
        depth -= letter in ">)"
        if letter == "," and depth == 0:
            parts.append(part.strip())
            part = ""
        else:
            part += letter
    return found.group(1), [*parts, part.strip()]


class Types:
    """Which types can be bound."""

    def __init__(self, library):
        self.enums = {one.qualified for one in library.enums}
        self.structs = {one.qualified: one for one in library.structs}

    def is_known(self, name):
        name = without_reference(name)
        if PLAIN.match(name) or name == INVALID_INPUT or name in self.enums or name in self.structs or EIGEN.match(name):
            return True
        template, inner = arguments_of(name)
        if template in ("std::vector", "std::optional", "std::array", "std::span", "std::pair", "std::tuple", "std::map", "std::set", "std::variant",
                        "std::unique_ptr"):
            return all(self.is_known(one) or re.fullmatch(r"\d+(?:UL)?|std::less<.*>|std::default_delete<.*>", one) for one in inner)
        if template == "std::shared_ptr":
            return without_reference(inner[0]) in self.structs
        if template == "std::function":
            found = re.match(r"(.*?)\s*\((.*)\)$", inner[0]) if len(inner) == 1 else re.match(r"(.*?)\s*\((.*)\)$", ", ".join(inner))
            return bool(found) and self.is_known(found.group(1)) and all(self.is_known(one) for one in arguments_of(f"x<{found.group(2)}>")[1] if one)
        return False

    def is_struct(self, name):
        return without_reference(name) in self.structs

    def is_parameter(self, name):
        """A pointer to a struct that is only read is one too: None is null."""
        return self.is_known(name[6:-2]) if self.is_optional(name) else self.is_known(name) and not ("*" in name and "char" not in name)

    def is_optional(self, name):
        return name.startswith("const ") and name.endswith(" *") and name[6:-2] in self.structs

    def is_result(self, name):
        """A pointer to a struct is one or None."""
        return self.is_parameter(name) or name.endswith(" *") and without_reference(name)[:-2].strip() in self.structs

    def refers(self, struct):
        """Members that are references to structs which a caller holds: Python's object keeps these alive. None: what they refer to has
        no owner in Python, or the rest has no plain defaults."""
        references = [one for one in struct.fields if one.type.endswith("&")]
        known = all(one.type.startswith("const ") and self.is_struct(one.type) for one in references)
        rest = all(one.default == "{ }" for one in struct.fields if one not in references)
        return references if known and rest else []

    def is_listing(self, function):
        """int all(…, T* out, int room): what is written there is a list."""
        return function.result == "int" and len(function.parameters) >= 2 and function.parameters[-2].name == "out" and \
            function.parameters[-2].type.startswith("Eigen::Matrix<") and function.parameters[-1].name == "room"


def is_output(parameter):
    """What a function fills, and Python has no reference to: it is returned."""
    plain = without_reference(parameter.type)
    return parameter.type.endswith("&") and not parameter.type.startswith("const ") and \
        (plain.startswith(("std::vector<", "Eigen::Matrix<")) or plain == "std::string")


@dataclasses.dataclass
class Call:
    """A function as Python calls it."""
    given: list  # Parameters
    returned: list  # Parameters that the function fills: they are returned
    progress: bool
    result: str  # its type; "void" where it is only how many were written


def python_call(function, types):
    call = Call([], [], False, function.result)
    for parameter in function.parameters:
        plain = without_reference(parameter.type)
        if plain == "robomill::Progress":
            call.progress = True
        elif parameter.default == "nullptr" and not types.is_parameter(parameter.type):
            continue  # nothing that Python has
        elif is_output(parameter):
            call.returned.append(Parameter(parameter.name, plain))
        elif types.is_listing(function) and parameter.name == "out":
            call.returned.append(Parameter("out", f"std::vector<{parameter.type.removesuffix(' *')}>"))
            call.result = "void"
        else:
            call.given.append(parameter)
    return call


FLOAT = {"double", "float"}


class Names:
    """What Python calls types."""

    def __init__(self, library):
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
        if name == "void":
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
        if name == INVALID_INPUT:
            return self.name_of(name, stage)
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
