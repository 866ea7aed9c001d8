"""The public headers of the library as data: enums, structs, classes and functions with what is said of them.

libclang reads robomill/robomill.hpp, which includes them all. Types are canonical, so that they can be named from anywhere."""
import dataclasses
import keyword
import os
import pathlib
import re

import clang.cindex as clang

Kind = clang.CursorKind
PUBLIC = clang.AccessSpecifier.PUBLIC


#: What Python has in their place: exceptions, and a function that progress is reported to.
IN_PYTHON = {"robomill::InvalidInput", "robomill::Interrupted", "robomill::Progress"}


@dataclasses.dataclass
class Parameter:
    name: str
    type: str
    default: str = None


@dataclasses.dataclass
class Function:
    name: str
    owner: str  # namespace or class, qualified
    result: str
    parameters: list
    doc: str
    is_static: bool = False
    is_const: bool = False


@dataclasses.dataclass
class Field:
    name: str
    type: str
    doc: str
    default: str = None


@dataclasses.dataclass
class Enum:
    name: str
    owner: str
    values: list  # (name, doc)
    doc: str
    words: str = None  # its table of names, qualified

    @property
    def qualified(self):
        return f"{self.owner}::{self.name}"


@dataclasses.dataclass
class Struct:
    name: str
    owner: str
    doc: str
    bases: list
    fields: list = dataclasses.field(default_factory=list)
    methods: list = dataclasses.field(default_factory=list)
    constructors: list = dataclasses.field(default_factory=list)
    is_class: bool = False
    is_abstract: bool = False
    has_constructor: bool = False  # a declared one, whoever may call it

    @property
    def qualified(self):
        return f"{self.owner}::{self.name}"


@dataclasses.dataclass
class Constant:
    name: str
    owner: str
    doc: str


@dataclasses.dataclass
class Library:
    constants: list = dataclasses.field(default_factory=list)
    enums: list = dataclasses.field(default_factory=list)
    structs: list = dataclasses.field(default_factory=list)
    functions: list = dataclasses.field(default_factory=list)

    def struct(self, qualified):
        return next((one for one in self.structs if one.qualified == qualified), None)


def python_name(name):
    """A name that is no keyword of Python."""
    return name + "_" if keyword.iskeyword(name) else name


def plain(comment):
    """The text of a comment without its marks; a line that begins with a comment's mark, joined by paragraphs."""
    if not comment:
        return ""
    lines = [re.sub(r"^\s*(///?<?|\*)\s?", "", line).rstrip() for line in comment.splitlines()]
    return "\n".join(lines).strip()


def type_of(clang_type):
    # Without the allocators that nobody writes.
    text = clang_type.get_canonical().spelling
    text = re.sub(r", std::allocator<(?:[^<>]|<(?:[^<>]|<[^<>]*>)*>)*>", "", text)
    return text.replace("std::filesystem::__cxx11::path", "std::filesystem::path").replace("std::__cxx11::basic_string<char>", "std::string") \
        .replace("std::basic_string<char>", "std::string").replace("std::basic_string_view<char>", "std::string_view")


def default_of(cursor):
    tokens = [token.spelling for token in cursor.get_tokens()]
    depth = 0
    for i in reversed(range(len(tokens))):  # of several declarators the last is meant
        depth += {")": 1, "}": 1, ">": 1, ">>": 2, "(": -1, "{": -1, "<": -1}.get(tokens[i], 0)
        if tokens[i] == "=" and depth == 0:
            return " ".join(tokens[i + 1:])
        if tokens[i] == "," and depth == 0:
            return None
    return None


def parameters_of(cursor):
    return [Parameter(one.spelling or f"argument_{i}", type_of(one.type), default_of(one)) for i, one in enumerate(cursor.get_arguments())]


class Reader:
    def __init__(self, root):
        self.root = pathlib.Path(root)
        self.library = Library()
        self.tables = {}  # of names: enum -> table
        self.seen = set()

    def is_ours(self, cursor):
        file = cursor.location.file
        return file is not None and os.path.abspath(file.name).startswith(str(self.root / "robomill"))

    def read(self, arguments):
        unit = clang.Index.create().parse(str(self.root / "robomill/robomill.hpp"), args=arguments,
                                          options=clang.TranslationUnit.PARSE_SKIP_FUNCTION_BODIES)
        faults = [str(one) for one in unit.diagnostics if one.severity >= 3 and "builtin function" not in one.spelling]
        if faults:
            raise SystemExit("generate: " + "\n".join(faults))
        self.namespace(unit.cursor, "")
        for enum in self.library.enums:
            enum.words = self.tables.get(enum.qualified)
        for struct in self.library.structs:
            for method in struct.methods:
                method.doc = method.doc or self.inherited(struct, method)
        return self.library

    def inherited(self, struct, method):
        """What a base says of a method that overrides its own."""
        for base in filter(None, map(self.library.struct, struct.bases)):
            for one in base.methods:
                if one.name == method.name and [p.type for p in one.parameters] == [p.type for p in method.parameters]:
                    return one.doc or self.inherited(base, one)
        return ""

    def namespace(self, cursor, name):
        for child in cursor.get_children():
            if child.kind == Kind.NAMESPACE:
                inner = f"{name}::{child.spelling}" if name else child.spelling
                if inner.split("::")[0] == "robomill" and "detail" not in inner and child.spelling:
                    self.namespace(child, inner)
            elif name and self.is_ours(child):
                self.declaration(child, name)

    def declaration(self, cursor, owner):
        if cursor.kind == Kind.ENUM_DECL and cursor.is_definition():
            self.enum(cursor, owner)
        elif cursor.kind in (Kind.STRUCT_DECL, Kind.CLASS_DECL) and cursor.is_definition() and cursor.spelling:
            self.struct(cursor, owner)
        elif cursor.kind == Kind.FUNCTION_DECL and not cursor.spelling.startswith("operator"):
            self.library.functions.append(Function(cursor.spelling, owner, type_of(cursor.result_type), parameters_of(cursor),
                                                   plain(cursor.raw_comment)))
        elif cursor.kind == Kind.VAR_DECL:
            table = re.match(r"const std::pair<std::string_view, (robomill::[\w:]+)>\s?\[\d+\]$", type_of(cursor.type))
            if type_of(cursor.type) == "const double":
                self.library.constants.append(Constant(cursor.spelling, owner, plain(cursor.raw_comment)))
            if table:
                self.tables.setdefault(table.group(1), f"{owner}::{cursor.spelling}")

    def enum(self, cursor, owner):
        one = Enum(cursor.spelling, owner, [(value.spelling, plain(value.raw_comment)) for value in cursor.get_children()
                                            if value.kind == Kind.ENUM_CONSTANT_DECL], plain(cursor.raw_comment))
        if one.qualified not in self.seen:
            self.seen.add(one.qualified)
            self.library.enums.append(one)

    def struct(self, cursor, owner):
        is_class = cursor.kind == Kind.CLASS_DECL
        one = Struct(cursor.spelling, owner, plain(cursor.raw_comment), [], is_class=is_class, is_abstract=cursor.is_abstract_record())
        if one.qualified in self.seen or one.qualified in IN_PYTHON:
            return
        self.seen.add(one.qualified)
        self.library.structs.append(one)
        for child in cursor.get_children():
            if child.kind == Kind.CXX_BASE_SPECIFIER and child.access_specifier == PUBLIC:
                one.bases.append(type_of(child.type))
            one.has_constructor |= child.kind == Kind.CONSTRUCTOR
            if child.access_specifier != PUBLIC:
                continue
            if child.kind in (Kind.ENUM_DECL, Kind.STRUCT_DECL, Kind.CLASS_DECL):
                self.declaration(child, one.qualified)
            elif child.kind == Kind.FIELD_DECL:
                one.fields.append(Field(child.spelling, type_of(child.type), plain(child.raw_comment), default_of(child)))
            elif child.kind == Kind.CONSTRUCTOR and not (child.is_copy_constructor() or child.is_move_constructor()):
                one.constructors.append(Function(one.name, one.qualified, "", parameters_of(child), plain(child.raw_comment)))
            elif child.kind == Kind.CXX_METHOD and not child.spelling.startswith("operator"):
                one.methods.append(Function(child.spelling, one.qualified, type_of(child.result_type), parameters_of(child),
                                            plain(child.raw_comment), child.is_static_method(), child.is_const_method()))


def read_library(root, includes):
    debian = "/usr/lib/llvm-14/lib/libclang.so.1"  # elsewhere the package libclang brings its own
    if os.path.exists(debian):
        clang.Config.set_library_file(debian)
    arguments = ["-x", "c++", "-std=c++20", f"-I{root}", *[f"-isystem{one}" for one in includes]]
    return Reader(os.path.abspath(root)).read(arguments)
