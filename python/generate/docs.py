"""Docstrings of Python from the comments of the headers: numpydoc's sections in the place of Doxygen's commands."""
import dataclasses
import re

from generate.headers import python_name
from generate.kinds import Names, Types, python_call

COMMAND = re.compile(r"\s*@(param|throws|returns?)\s+(.*)")
SOURCE = re.compile(r"Sources?: ")
WRAPPED = 100  # a line that ends before this column, and could have held the next word, ends a sentence of its own
PROGRESS = "called with a task and the share of it that is done; an exception of it stops the work"


@dataclasses.dataclass
class Comment:
    text: list = dataclasses.field(default_factory=list)  # lines
    parameters: dict = dataclasses.field(default_factory=dict)  # name: text
    result: str = ""
    errors: list = dataclasses.field(default_factory=list)  # (name, text)
    sources: list = dataclasses.field(default_factory=list)


def parse(comment):
    out, paragraph, previous = Comment(), None, ""
    for line in [part for one in comment.splitlines() for part in re.split(r"(?<=\S) (?=@throws )", one)]:
        command = COMMAND.match(line)
        if command:
            paragraph = [command[1], command[2]]
            add(out, paragraph)
        elif SOURCE.match(line):
            paragraph = ["source", line]
            add(out, paragraph)
        elif paragraph and line.strip() and (line.startswith(" ") or len(previous) + len(line.split()[0]) >= WRAPPED):
            paragraph[1] += " " + line.strip()
            put(out, paragraph)
        else:
            paragraph = None
            out.text.append(line)
        previous = line
    return out


def add(out, paragraph):
    kind, text = paragraph
    if kind == "param":
        names, _, text = re.match(r"(\w+(?:, \w+)*)(\s*)(.*)", text).groups()
        paragraph[:] = [kind, text, names.split(", ")]
    elif kind == "throws":
        name, _, text = text.partition(" ")
        paragraph[:] = [kind, text.strip(), len(out.errors), name]
        out.errors.append(None)
    elif kind == "source":
        paragraph.append(len(out.sources))
        out.sources.append(None)
    put(out, paragraph)


def put(out, paragraph):
    if paragraph[0] == "param":
        out.parameters.update({name: paragraph[1] for name in paragraph[2]})
    elif paragraph[0] == "throws":
        out.errors[paragraph[2]] = (paragraph[3], paragraph[1])
    elif paragraph[0] == "source":
        out.sources[paragraph[2]] = paragraph[1]
    else:
        out.result = paragraph[1]


def body(lines):
    """Equations, tables and lists apart from the text around them."""
    out, item = [], False
    for line in lines:
        before = out[-1] if out else ""
        indented, was_indented = line.startswith("  "), before.startswith("  ")
        begins = line.startswith("- ") and (before.endswith(":") or was_indented)
        if before and line and not item and (indented != was_indented or begins):
            out.append("")
        item = line.startswith("- ") or item and line != ""
        out.append(line)
    return "\n".join(out).strip()


def words(kind):
    """A type of a stub in words: "sequence of Frf"."""
    kind = kind.replace("npt.ArrayLike", "array_like").replace("str | os.PathLike[str]", "path")
    kind = re.sub(r"npt\.NDArray\[(.*?)\]", lambda found: {"np.complex128": "ndarray of complex", "np.float64": "ndarray of float"}.get(found[1], "ndarray"), kind)
    for _ in range(8):
        kind = re.sub(r"Callable\[\[([^\[\]]*)\], ([^\[\]]*)\]", r"callable(\1) returning \2", kind)
        kind = re.sub(r"(?:Mapping|dict)\[([^\[\],]*), ([^\[\]]*)\]", r"dict of \1 to \2", kind)
        kind = re.sub(r"(Sequence|list|set)\[([^\[\]]*)\]", lambda found: f"{found[1].lower()} of {found[2]}", kind)
        kind = re.sub(r"tuple\[([^\[\]]*)\]", r"tuple(\1)", kind)
    return kind.replace(" | ", " or ")


def value(default, kind):
    """What a member is where nobody gives it, as Python would write it; empty: it goes without saying."""
    if default is None:
        return ""
    text = re.sub(r"\s*(::|[(){}<>])\s*", r"\1", default).replace(" ,", ",")
    text = re.sub(r"(?<=\d)F\b", "", re.sub(r"(?<=\d)'(?=\d)", "", text)).replace("- ", "-")
    simple = {"true": "True", "false": "False", "nullptr": "None", "HUGE_VAL": "inf", "NAN": "nan"}
    if text in simple:
        return simple[text]
    if text == "{}":
        if kind in ("str", "path"):
            return '""'
        if kind.endswith(" or None") or kind.startswith("callable"):
            return "None"
        return "empty" if kind.startswith(("array_like", "sequence", "dict", "set")) else ""
    text = re.sub(r"std::numeric_limits<\w+>::(quiet_NaN|infinity|max)\(\)", lambda found: {"quiet_NaN": "nan", "infinity": "inf", "max": "max"}[found[1]], text)
    matrix = re.search(r"::(Zero|Identity|Unit[XYZ]|Constant)\((.*)\)$", text)
    if matrix:
        return {"Zero": "zeros", "Identity": "identity", "Constant": f"each {matrix[2]}"}.get(matrix[1], f"unit vector of {matrix[1][-1].lower()}")
    if re.fullmatch(r"\{[^{}.=]*(?:\.\d[^{}.=]*)*\}", text):
        text = f"[{text[1:-1]}]"
    if "{" in text:
        return ""
    return re.sub(r"^(?:[a-z]\w*::)+(?=[A-Z])", "", text).replace("::", ".")


class Docs:
    def __init__(self, library):
        self.names = Names(library)
        self.types = Types(library)
        self.given = self.all_given(library)

    def all_given(self, library):
        """Structs that a caller gives, by themselves or within another; the rest are results."""
        methods = [one for struct in library.structs for one in [*struct.methods, *struct.constructors]]
        texts = [parameter.type for function in [*library.functions, *methods] for parameter in function.parameters]
        found, names = set(), {one.qualified: one for one in library.structs}
        while texts:
            for name in set(re.findall(r"robomill::[\w:]+", texts.pop())) & names.keys() - found:
                found.add(name)
                texts += [field.type for field in names[name].fields] + names[name].bases
        return found

    def kind(self, name, stage, given):
        return words(self.names.type(name, stage, given))

    def entry(self, name, kind, default, text):
        given = f", default: {default}" if default else ""
        return [f"{python_name(name)} : {kind}{given}", *([f"    {text}"] if text else [])]

    def sections(self, comment, parts):
        text = body(comment.text)
        for title, lines in parts:
            if lines:
                text += f"\n\n{title}\n{'-' * len(title)}\n" + "\n".join(lines)
        return text.strip()

    def function(self, function):
        stage = self.names.stage_of(function.owner)
        comment, call = parse(function.doc), python_call(function, self.types)
        given = []
        for one in call.given:
            kind = self.kind(one.type, stage, True)
            given += self.entry(one.name, kind, value(one.default, kind), comment.parameters.get(one.name, ""))
        if call.progress:
            given += self.entry("progress", "callable(str, float)", "None", PROGRESS)
        returned = [] if call.result == "void" else [self.kind(call.result, stage, False)]
        returned += [self.kind(one.type, stage, False) for one in call.returned]
        texts = [comment.result, *(comment.parameters.get(one.name, "") for one in call.returned)]
        text = "; ".join(one for one in texts if one)
        result = []
        if returned:
            alone = not call.returned or self.types.is_listing(function)
            result = [returned[0] if alone else f"tuple({', '.join(returned)})", *([f"    {text}"] if text else [])]
        return self.sections(comment, [("Parameters", given), ("Returns", result), ("Raises", self.errors(comment)), ("Notes", comment.sources)])

    @staticmethod
    def errors(comment):
        lines = []
        for name, text in comment.errors:
            text = re.sub(r"; Interrupted$", "", text)
            lines += ["KeyboardInterrupt", "    when Ctrl-C is pressed"] if name == "Interrupted" else [name, f"    {text}"]
        return lines

    def members(self, fields, stage, given):
        lines = []
        for one in fields:
            kind = self.kind(one.type, stage, given)
            lines += self.entry(one.name, kind, value(one.default, kind) if given else "", "\n    ".join(line.strip() for line in one.doc.splitlines() if line))
        return lines

    def struct(self, struct, fields):
        """@param fields  that Python has"""
        given = struct.qualified in self.given and not self.made_by_library(struct)
        members = self.members(fields, self.names.stage_of(struct.owner), given)
        return self.sections(parse(struct.doc), [("Parameters" if given else "Attributes", members)])

    def klass(self, struct, constructors):
        """A class whose constructor is documented with it, as Python has it."""
        text = self.sections(parse(struct.doc), [])
        if len(constructors) != 1 or not constructors[0].parameters:
            return text
        return f"{text}\n\n{self.function(dataclasses.replace(constructors[0], result='void'))}".strip()

    def made_by_library(self, struct):
        # A document's source has no default, so that a struct with one has none either.
        return not self.types.refers(struct) and any(one.type.endswith(("&", "io::TomlSource")) or "unique_ptr" in one.type for one in struct.fields)

    def head(self, name, parameters, is_method=False):
        """How it is called."""
        parts = ["self"] if is_method else []
        if parameters:
            parts += ["*", *(python_name(one) + (f"={default}" if default is not None else "") for one, default in parameters)]
        return f"{name}({', '.join(parts)})\n"

    def signature(self, name, parameters, is_method=False):
        """What inspect.signature reads from the head of a docstring."""
        return self.head(name, parameters, is_method) + "--\n\n"

    @staticmethod
    def literal(default):
        """A default that Python can read; else that there is one."""
        if default is None:
            return None
        text = value(default, "")
        return text if re.fullmatch(r"-?[\d.]+(?:e-?\d+)?|True|False|None|\"[^\"]*\"", text) else "..."

    def parameters(self, function):
        call = python_call(function, self.types)
        return [(one.name, self.literal(one.default)) for one in call.given] + ([("progress", "None")] if call.progress else [])

    def function_signature(self, function, is_method):
        return self.signature(python_name(function.name), self.parameters(function), is_method)

    def overload(self, function, is_method):
        """One of several functions of a name, whose docstrings stand one after the other."""
        return f"{self.head(python_name(function.name), self.parameters(function), is_method)}\n{self.function(function)}\n"

    def constructor_signature(self, struct, one):
        if len(struct.constructors) != 1:
            return ""
        return self.function_signature(dataclasses.replace(one, name="__init__"), True)

    def struct_signature(self, struct, fields):
        return self.signature(struct.name, [(one.name, self.literal(one.default) or "...") for one in fields])
