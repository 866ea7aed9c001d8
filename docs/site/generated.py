"""Pages that are derived: the command line from the program, the schemas from docs/schema, C++ from the public headers."""
import json
import re
import subprocess
from xml.etree import ElementTree

from sources import ROOT


def command_line(program):
    """Every verb with its options, as the program prints them."""
    def printed(*arguments):
        return subprocess.run([program, *arguments], capture_output=True, text=True, check=True).stdout

    table = printed("man", "markdown")
    verbs = []
    for words in re.findall(r"^\| `robomill (\w+)(?: (\w+)(?=[ `]))?", table, re.M):
        # "cell check" is a verb of two words, "init job" a verb and its argument.
        verb = " ".join(words) if words[1] and "Subcommands:" in printed(words[0], "--help") else words[0]
        if verb not in verbs:
            verbs.append(verb)
    parts = ["# Command line\n",
             "The program prints all of this itself: `robomill VERB --help`, `man robomill`. Exit codes: [README](../../../README.md#output-and-exit-codes).\n", table]
    for verb in verbs:
        parts.append(f"## robomill {verb}\n\n```text\n{printed(*verb.split(), '--help').strip()}\n```\n")
    return "\n".join(parts)


def schemas():
    lines = ["# Schemas of documents\n", "JSON Schemas (draft 2020-12) of the documents in [Files](../../formats.md#schemas), which has the same keys in tables. `robomill schema NAME` prints one.\n",
             "| document | what it is |", "|---|---|"]
    for file in sorted((ROOT / "docs/schema").glob("*.schema.json")):
        schema = json.loads(file.read_text(encoding="utf-8"))
        lines.append(f"| [{file.name.removesuffix('.schema.json')}](../../schema/{file.name}) | {schema['description']} |")
    return "\n".join(lines) + "\n"


def missing_requests():
    """Requests that serve's api.cpp answers and its README does not list."""
    served = re.findall(r'\{"(\w+)", "(/api/[^"]*)", ', (ROOT / "robomill/serve/api.cpp").read_text(encoding="utf-8"))
    listed = (ROOT / "robomill/serve/README.md").read_text(encoding="utf-8")
    return [f"robomill/serve/README.md does not list {method} {path}" for method, path in served if f"`{method} {path}" not in listed]


class Declared:
    """What each public header declares, by Doxygen's XML: its classes, then its functions, enumerations and constants."""

    def __init__(self, xml):
        self.classes, self.members = {}, {}
        for file in sorted(xml.glob("*.xml")):
            if file.name.startswith(("class", "struct")):
                self.take_class(ElementTree.parse(file).find("compounddef"))
            elif file.name.startswith("namespacerobomill"):
                self.take_members(ElementTree.parse(file).find("compounddef"))

    def take_class(self, definition):
        place = definition.find("location")
        item = (int(place.get("line")), definition.get("kind"), definition.findtext("compoundname"))
        self.classes.setdefault(place.get("file"), []).append(item)

    def take_members(self, namespace):
        members = list(namespace.iter("memberdef"))
        names = [member.findtext("name") for member in members]
        for member, name in zip(members, names):
            place = member.find("location")
            signature = member.findtext("argsstring") if names.count(name) > 1 else ""
            item = (int(place.get("line")), member.get("kind"), f"{namespace.findtext('compoundname')}::{name}{signature}")
            self.members.setdefault(place.get("file"), []).append(item)

    def of(self, header):
        """Kinds and names. Classes within another are shown there."""
        classes = sorted(self.classes.get(header, []))
        names = {name for _, _, name in classes}
        outer = [item for item in classes if item[2].rpartition("::")[0] not in names]
        return [item[1:] for item in outer + sorted(self.members.get(header, []))]


def stage_page(stage, headers, declared):
    parts = [f"# {stage}\n", f"Public headers of [robomill/{stage}](../../../../robomill/{stage}/README.md): its README has the methods, their accuracy and their cost.\n"]
    for header in headers:
        parts.append(f"## {header.removeprefix(f'robomill/{stage}/')}\n\n`#include \"{header}\"`\n")
        for kind, name in declared.of(header):
            options = ":members:\n" if kind in ("class", "struct") else ""
            parts.append(f"```{{doxygen{kind}}} {name}\n{options}```\n")
    return "\n".join(parts)


def doxyfile(headers, folder):
    return f"""PROJECT_NAME = robomill
INPUT = {' '.join(headers)}
STRIP_FROM_PATH = {ROOT}
FULL_PATH_NAMES = YES
OUTPUT_DIRECTORY = {folder}
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
EXTRACT_ALL = YES
JAVADOC_AUTOBRIEF = YES
MACRO_EXPANSION = YES
EXPAND_ONLY_PREDEF = YES
PREDEFINED = ROBOMILL_API=
MAX_INITIALIZER_LINES = 0
SORT_MEMBER_DOCS = NO
AUTOLINK_SUPPORT = NO
SHOW_INCLUDE_FILES = NO
INCLUDE_GRAPH = NO
INCLUDED_BY_GRAPH = NO
QUIET = YES
WARN_IF_UNDOCUMENTED = NO
WARN_IF_INCOMPLETE_DOC = NO
WARN_AS_ERROR = FAIL_ON_WARNINGS
"""
