"""The sources of the extension module: every public enum, struct, class and function, a source a stage.

What cannot be bound is listed with its reason; python/not_bound.csv holds the list, and the build fails where it differs."""
import re

from generate.docs import Docs
from generate.headers import Function, python_name
from generate.kinds import NUMBERS, Types, arguments_of, is_output, without_reference


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
        self.docs = Docs(library)
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
            lines = [f"  auto {name} = class_of<{struct.qualified}{bases}>();"]
            made = self.constructors(struct, name)
            doc = self.docs.klass(struct, self.constructed(struct))
            source["declare"].append((False, f'  declare<{struct.qualified}{bases}>({self.scope(struct.owner)}, "{struct.name}", {literal(doc)});'))
            lines += made
        else:
            lines = [f"  Record<{struct.qualified}{bases}>& {name}_record = record_of<{struct.qualified}{bases}>();", f"  auto& {name} = {name}_record.type();"]
            fields = self.fields(struct)
            for field in fields:
                lines.append(self.member(struct, name, field))
            lines += self.referring(struct, name)
            lines.append(f"  {name}_record.done();")
            doc = self.docs.struct_signature(struct, fields) if not self.docs.made_by_library(struct) and struct.qualified != "robomill::io::TomlSource" else ""
            doc += self.docs.struct(struct, fields)
            source["declare"].append((False, f'  declare_record<{struct.qualified}{bases}>({self.scope(struct.owner)}, "{struct.name}", {literal(doc)});'))
        for method in struct.methods:
            text = self.call(method, struct)
            if text:
                kind = "def_static" if method.is_static else "def"
                lines.append(f'  {name}.{kind}("{python_name(method.name)}", {text});')
        source["fields"].append("\n".join(["  {", *lines, "  }"]))

    def fields(self, struct):
        """The members that Python has, those of bases first."""
        inherited = [field for base in struct.bases if base in self.types.structs for field in self.types.structs[base].fields]
        references, out = self.types.refers(struct), []
        for field in [*inherited, *struct.fields]:
            if field not in references and (not self.types.is_known(field.type) or field.type.endswith(("&", "*")) and "char" not in field.type or
                                            field.type.startswith("std::span<")):
                self.skip(f"{struct.qualified}::{field.name}", field.type)
            else:
                out.append(field)
        return out

    @staticmethod
    def member(struct, name, field):
        if field.type.endswith("&"):
            return f'  {name}.def_property_readonly("{field.name}", [](const {struct.qualified}& self) -> {field.type} {{ return self.{field.name}; }}, ' \
                f'{literal(field.doc)});'
        return f'  {name}_record.field("{python_name(field.name)}", &{struct.qualified}::{field.name}, {literal(field.doc)});'

    def referring(self, struct, name):
        """The constructor of a struct that refers to others, which it keeps alive."""
        references = self.types.refers(struct)
        if not references:
            return []
        head = ", ".join(f"{one.type} {one.name}" for one in struct.fields)
        values = ", ".join(one.name if one in references else f"std::move({one.name})" for one in struct.fields)
        names = "".join(f', py::arg("{python_name(one.name)}")' if one in references else f', py::arg_v("{python_name(one.name)}", {one.type}{{}}, "...")'
                        for one in struct.fields)
        keep = "".join(f", py::keep_alive<1, {i + 2}>()" for i, one in enumerate(struct.fields) if one in references)
        return [f"  {name}.def(py::init([]({head}) {{ return std::unique_ptr<{struct.qualified}>(new {struct.qualified}{{{values}}}); }}), "
                f"py::kw_only(){names}{keep});"]

    def constructed(self, struct):
        """Its constructors that Python has."""
        if struct.is_abstract or f"{struct.qualified}::{struct.name}" in {name for name, _ in self.not_bound}:
            return []
        return struct.constructors if struct.has_constructor else [Function(struct.name, struct.qualified, "", [], "")]

    def constructors(self, struct, name):
        lines = []
        if not struct.has_constructor and not struct.is_abstract:
            lines.append(f"  {name}.def(py::init<>());")
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
            lines.append(f"  {name}.def(py::init<{types}>(){self.names(one, one.parameters)}{keep}, {literal(self.docs.constructor_signature(struct, one))});")
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

    def listing(self, function, struct):
        """Of a function that writes into room of the caller: a list of what it wrote."""
        given, inner = function.parameters[:-2], function.parameters[-2].type.removesuffix(" *")
        head = ", ".join([f"{'const ' if function.is_const else ''}{struct.qualified}& self", *(f"{one.type} {one.name}" for one in given), "int room"])
        passed = ", ".join([*(one.name for one in given), "out.data()", "room"])
        return f"[]({head}) {{ std::vector<{inner}> out(static_cast<std::size_t>(std::max(room, 0))); " \
            f"out.resize(static_cast<std::size_t>(without_lock([&]() {{ return self.{function.name}({passed}); }}))); return py::cast(out); }}" \
            f"{self.names(function, [*given, function.parameters[-1]])}, {literal(self.documentation(function, struct))}"

    def documentation(self, function, struct=None):
        """With a signature for inspect.signature in front where a name means one function, else with how it is called."""
        group = struct.methods if struct is not None else self.library.functions
        alone = sum(1 for one in group if one.name == function.name and one.owner == function.owner) == 1
        is_method = struct is not None and not function.is_static
        if not alone:
            return self.docs.overload(function, is_method)
        return self.docs.function_signature(function, is_method) + self.docs.function(function)

    def call(self, function, struct=None):
        """The lambda that calls a function, its names and its documentation; None where it cannot be bound."""
        what = f"{function.owner}::{function.name}"
        if self.types.is_listing(function):
            return self.listing(function, struct)
        given, passed, returned, progress = [], [], [], None
        for i, parameter in enumerate(function.parameters):
            plain = without_reference(parameter.type)
            if plain == "robomill::Progress":
                progress = parameter
                passed.append("progress_")
            elif parameter.default == "nullptr" and not self.types.is_parameter(parameter.type):
                passed.append("nullptr")
            elif is_output(parameter):
                returned.append((parameter.name, plain))
                passed.append(f"{parameter.name}_")
            elif not self.types.is_parameter(parameter.type):
                self.skip(what, parameter.type)
                return None
            else:
                given.append(parameter)
                passed.append(f"std::move({parameter.name})" if not parameter.type.endswith("&") else parameter.name)
        if not self.types.is_result(function.result):
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
        nothing = {True: "{0}::Constant(std::numeric_limits<double>::quiet_NaN())", False: "{0}()"}
        outputs = "".join(f" {kind} {name}_ = {nothing[kind.startswith('Eigen::')].format(kind)};" for name, kind in returned)
        reference = function.result.endswith(("&", "*")) and "char" not in function.result
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
        if without_reference(function.result) in self.types.structs and self.types.refers(self.types.structs[without_reference(function.result)]):
            policy += "".join(f", py::keep_alive<0, {i + 1 + is_method}>()" for i, one in enumerate(given) if self.types.is_struct(one.type))
        if progress:
            names = (names or ", py::kw_only()") + ', py::arg("progress") = py::none()'
        return f"{text}{policy}{names}, {literal(self.documentation(function, struct))}"

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

