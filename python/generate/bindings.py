"""The sources of the extension module: every public enum, struct, class and function, a source a stage.

What cannot be bound is listed with its reason; python/not_bound.csv holds the list, and the build fails where it differs."""
import re

from generate.headers import Function, python_name

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
        if PLAIN.match(name) or name in self.enums or name in self.structs or EIGEN.match(name):
            return True
        template, inner = arguments_of(name)
        if template in ("std::vector", "std::optional", "std::array", "std::span", "std::pair", "std::tuple", "std::map", "std::set", "std::variant",
                        "std::unique_ptr"):
            return all(self.is_known(one) or re.fullmatch(r"\d+(?:UL)?|std::less<.*>|std::default_delete<.*>", one) for one in inner)
        if template == "std::shared_ptr":  # of what does not change
            return inner[0].startswith("const ") and self.is_known(inner[0])
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


def literal(text):
    """A C++ string, whole whatever it holds."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def variable(qualified):
    return re.sub(r"\W+", "_", qualified)


def stage_of(namespace):
    """The stage of a namespace; that of units, and of what stands in robomill itself, is base."""
    parts = namespace.split("::")
    return "base" if len(parts) < 2 or parts[1] == "units" else parts[1]


class Writer:
    def __init__(self, library):
        self.library = library
        self.types = Types(library)
        self.not_bound = []  # (what, reason)
        self.sources = {}  # stage -> {"types": [...], "members": [...]}

    def source(self, owner):
        namespace = owner
        while namespace in self.types.structs:
            namespace = self.types.structs[namespace].owner
        stage = stage_of(namespace)
        return self.sources.setdefault(stage, {"declare": [], "fields": [], "functions": []})

    def scope(self, owner):
        return f"type_of<{owner}>()" if owner in self.types.structs else f'module_of(root, "{"::".join(owner.split("::")[1:])}")'

    def skip(self, what, reason):
        self.not_bound.append((what, reason))

    def write(self):
        for one in self.library.constants:
            self.source(one.owner)["functions"].append(f'  {self.scope(one.owner)}.attr("{python_name(one.name)}") = {one.owner}::{one.name};')
        for enum in self.library.enums:
            self.enum(enum)
        for struct in self.ordered():
            self.struct(struct)
        for function in self.library.functions:
            self.function(function)
        return {stage: self.text(stage, parts) for stage, parts in self.sources.items()}

    def ordered(self):
        """Bases and scopes before what stands on them."""
        done, out = set(), []

        def add(struct):
            if struct.qualified in done:
                return
            done.add(struct.qualified)
            for other in (struct.owner, *struct.bases):
                if other in self.types.structs:
                    add(self.types.structs[other])
            out.append(struct)

        for struct in self.library.structs:
            add(struct)
        return out

    def enum(self, enum):
        lines = [f'  py::enum_<{enum.qualified}> {variable(enum.qualified)}({self.scope(enum.owner)}, "{enum.name}", {literal(enum.doc)});']
        for name, doc in enum.values:
            lines.append(f'  {variable(enum.qualified)}.value("{python_name(name)}", {enum.qualified}::{name}, {literal(doc)});')
        words = f"words_of({enum.words})" if enum.words else "{}"
        lines.append(f"  take_words({variable(enum.qualified)}, {words});")
        self.source(enum.owner)["declare"].append((enum.owner in self.types.structs, "\n".join(lines)))

    def struct(self, struct):
        source = self.source(struct.owner)
        bases = "".join(f", {one}" for one in struct.bases if one in self.types.structs)
        if struct.bases and not bases:
            self.skip(struct.qualified, f"its base {struct.bases[0]} is none of the library's")
        name = variable(struct.qualified)
        if struct.is_class:
            source["declare"].append((False, f'  declare<{struct.qualified}{bases}>({self.scope(struct.owner)}, "{struct.name}", {literal(struct.doc)});'))
            lines = [f"  auto {name} = class_of<{struct.qualified}{bases}>();"]
            lines += self.constructors(struct, name)
        else:
            source["declare"].append((False, f'  declare_record<{struct.qualified}{bases}>({self.scope(struct.owner)}, "{struct.name}", {literal(struct.doc)});'))
            lines = [f"  Record<{struct.qualified}{bases}>& {name}_record = record_of<{struct.qualified}{bases}>();", f"  auto& {name} = {name}_record.type();"]
            inherited = [field for base in struct.bases if base in self.types.structs for field in self.types.structs[base].fields]
            for field in [*inherited, *struct.fields]:
                if not self.types.is_known(field.type) or field.type.endswith(("&", "*")) and "char" not in field.type or re.match(r"std::(unique_ptr|span)<", field.type):
                    self.skip(f"{struct.qualified}::{field.name}", field.type)
                    continue
                lines.append(f'  {name}_record.field("{python_name(field.name)}", &{struct.qualified}::{field.name}, {literal(field.doc)});')
            lines.append(f"  {name}_record.done();")
        for method in struct.methods:
            text = self.call(method, struct)
            if text:
                kind = "def_static" if method.is_static else "def"
                lines.append(f'  {name}.{kind}("{python_name(method.name)}", {text});')
        source["fields"].append("\n".join(["  {", *lines, "  }"]))

    def constructors(self, struct, name):
        lines = []
        for one in struct.constructors if not struct.is_abstract else []:
            if any(without_reference(parameter.type) == "robomill::Progress" for parameter in one.parameters):
                text = self.call(Function(struct.name, struct.owner, struct.qualified, one.parameters, one.doc))
                if text:
                    lines.append(f"  {name}.def(py::init({self.made(text, struct)});")
                continue
            if not all(self.types.is_parameter(parameter.type) for parameter in one.parameters):
                bad = next(parameter for parameter in one.parameters if not self.types.is_parameter(parameter.type))
                self.skip(f"{struct.qualified}::{struct.name}", bad.type)
                continue
            types = ", ".join(parameter.type for parameter in one.parameters)
            keep = "".join(f", py::keep_alive<1, {i + 2}>()" for i, parameter in enumerate(one.parameters) if self.types.is_struct(parameter.type))
            lines.append(f"  {name}.def(py::init<{types}>(){self.names(one, one.parameters)}{keep}, {literal(one.doc)});")
        return lines

    @staticmethod
    def made(text, struct):
        """The lambda of a constructor that reports progress: what it makes, in the place of Python's object of it."""
        head, rest = text.split("return result_of(", 1)
        body, names = rest.split(")); }", 1)
        return f"{head}return std::make_unique<{struct.qualified}>({body})); }}){names}"

    def names(self, function, parameters):
        """Python's names of parameters and their defaults, keywords all."""
        if not parameters:
            return ""
        out = ", py::kw_only()"
        for parameter in parameters:
            name = python_name(parameter.name)
            if parameter.default is None:
                out += f', py::arg("{name}")'
                continue
            plain = without_reference(parameter.type)
            value = f"{plain}{{}}" if parameter.default == "{ }" else parameter.default
            value = "py::none()" if self.types.is_optional(parameter.type) else self.qualified_default(value, plain)
            out += f', py::arg_v("{name}", {value}, "...")'
        return out

    def qualified_default(self, value, plain):
        enum = re.fullmatch(r"(?:\w+ :: )*(\w+) :: (\w+)", value)
        if enum and plain in self.types.enums:
            return f"{plain}::{enum.group(2)}"
        if value.startswith("{"):
            return f"{plain}{value}"
        return value

    def call(self, function, struct=None):
        """The lambda that calls a function, its names and its documentation; None where it cannot be bound."""
        what = f"{function.owner}::{function.name}"
        given, passed, returned, progress = [], [], [], None
        for i, parameter in enumerate(function.parameters):
            plain = without_reference(parameter.type)
            if plain == "robomill::Progress":
                progress = parameter
                passed.append("progress_")
            elif parameter.default == "nullptr" and not self.types.is_parameter(parameter.type):
                passed.append("nullptr")
            elif parameter.type.endswith("&") and not parameter.type.startswith("const ") and plain.startswith("std::vector<"):
                returned.append((parameter.name, plain))
                passed.append(f"{parameter.name}_")
            elif not self.types.is_parameter(parameter.type):
                self.skip(what, parameter.type)
                return None
            else:
                given.append(parameter)
                passed.append(f"std::move({parameter.name})" if not parameter.type.endswith("&") else parameter.name)
        if not self.types.is_parameter(function.result):
            self.skip(what, function.result)
            return None
        is_method = struct is not None and not function.is_static
        head = [f"{'const ' if function.is_const else ''}{struct.qualified}& self"] if is_method else []
        for parameter in given:
            head.append(f"{self.taken(parameter.type)} {parameter.name}")
        if progress:
            head.append("const py::object& progress")
        spans = {parameter.name for parameter in given if without_reference(parameter.type).startswith("std::span<")}
        passed = [f"span_of<{self.span_of(function.parameters[i].type)}>({function.parameters[i].name})" if function.parameters[i].name in spans else one
                  for i, one in enumerate(passed)]
        callee = f"self.{function.name}" if is_method else f"{function.owner}::{function.name}"
        call = f"{callee}({', '.join(passed)})"
        outputs = "".join(f" {kind} {name}_;" for name, kind in returned)
        reference = function.result.endswith("&") or self.types.is_optional(function.result)
        if returned:
            names = ", ".join(f"result_of(std::move({name}_))" for name, _ in returned)
            run = f"auto done = WORK{{ return {call}; }}); return py::make_tuple(result_of(std::move(done)), {names});" if function.result != "void" else \
                f"WORK{{ {call}; }}); return py::make_tuple({names});"
        elif function.result == "void":
            run = f"WORK{{ {call}; }});"
        else:
            run = f"return result_of(WORK{{ return {call}; }}));"
        work = "with_progress(progress, [&]([[maybe_unused]] Progress& progress_) " if progress else "without_lock([&]() "
        if reference:
            run = f"return {'&' if function.result.endswith('&') else ''}{call};"
            policy = ", py::return_value_policy::reference_internal"
        else:
            run, policy = run.replace("WORK", work), ""
        text = f"[]({', '.join(head)}) {{{outputs} {run} }}"
        names = self.names(function, given)
        if progress:
            names = (names or ", py::kw_only()") + ', py::arg("progress") = py::none()'
        return f"{text}{policy}{names}, {literal(function.doc)}"

    @staticmethod
    def span_of(name):
        return arguments_of(without_reference(name))[1][0]

    def taken(self, name):
        """The type of a lambda's parameter. A span is an array where it has numbers, one that is written to as it is; else a list."""
        if not without_reference(name).startswith("std::span<"):
            return name
        inner = self.span_of(name)
        plain = inner.removeprefix("const ")
        if not re.fullmatch(NUMBERS, plain):
            return f"const std::vector<{plain}>&"
        return f"const Numbers<{plain}>&" if inner.startswith("const ") else f"Written<{plain}>&"

    def function(self, function):
        text = self.call(function)
        if text:
            self.source(function.owner)["functions"].append(
                f'  {self.scope(function.owner)}.def("{python_name(function.name)}", {text});')

    def text(self, stage, parts):
        body = [one for _, one in sorted(parts["declare"], key=lambda pair: pair[0])]
        # In functions: sources that are compiled together have several.
        using = "  using namespace robomill;\n" if stage == "base" else f"  using namespace robomill::{stage};\n"
        head = '// Made by python/generate. Not to be edited.\n#include "python/bindings/stage.hpp"\n#include "robomill/robomill.hpp"\n\n'
        return (head + f"namespace robomill::python {{\n\nvoid declare_{stage}([[maybe_unused]] py::module_& root) {{\n{using}" + "\n".join(body) +
                f"\n}}\n\nvoid fill_{stage}() {{\n{using}" + "\n".join(parts["fields"]) +
                f"\n}}\n\nvoid bind_{stage}([[maybe_unused]] py::module_& root) {{\n{using}" + "\n".join(parts["functions"]) +
                "\n}\n\n}  // namespace robomill::python\n")


def write_bindings(library):
    """{stage: source}, [(what is not bound, why)]."""
    writer = Writer(library)
    return writer.write(), writer.not_bound

