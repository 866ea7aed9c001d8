"""Writes the extension module's sources, its stubs and the list of what is not bound: python3 -m generate ROOT OUT INCLUDE…"""
import csv
import io
import pathlib
import sys

from generate.bindings import write_bindings
from generate.headers import read_library
from generate.stubs import write_stubs


def write(path, text):
    """Only where it changes: what depends on it is not built anew."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def stages_header(stages):
    lines = ["// Made by python/generate. Not to be edited.", "#pragma once", "#include <pybind11/pybind11.h>", "", "namespace robomill::python {", ""]
    for stage in stages:
        lines += [f"void declare_{stage}(pybind11::module_& root);", f"void fill_{stage}();", f"void bind_{stage}(pybind11::module_& root);"]
    lines += ["", "inline void declare_all(pybind11::module_& root) {", *(f"  declare_{stage}(root);" for stage in stages), "}",
              "inline void fill_all() {", *(f"  fill_{stage}();" for stage in stages), "}",
              "inline void bind_all(pybind11::module_& root) {", *(f"  bind_{stage}(root);" for stage in stages), "}", "",
              "}  // namespace robomill::python", ""]
    return "\n".join(lines)


def main():
    root, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    out.mkdir(parents=True, exist_ok=True)
    library = read_library(root, sys.argv[3:])
    sources, not_bound = write_bindings(library)
    for stage, text in sources.items():
        write(out / f"{stage}.cpp", text)
    folder = out / "python/bindings"
    folder.mkdir(parents=True, exist_ok=True)
    write(folder / "stages.hpp", stages_header(list(sources)))
    stubs = out / "robomill"
    stubs.mkdir(exist_ok=True)
    for stage, text in write_stubs(library, not_bound).items():
        write(stubs / f"{stage or 'package'}.pyi", text)
    table = io.StringIO()
    rows = csv.writer(table, lineterminator="\n")
    rows.writerow(["name", "type that Python has nothing for"])
    rows.writerows(sorted(set(not_bound)))
    write(out / "not_bound.csv", table.getvalue())
    known = root / "python/not_bound.csv"
    if not known.exists() or known.read_text() != table.getvalue():
        sys.exit(f"python/not_bound.csv is not what is not bound: compare it with {out}/not_bound.csv, and bind what can be")


main()
