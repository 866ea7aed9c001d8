"""The public headers, as the CMakeLists.txt of each stage names them."""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parent.parent


def public_headers():
    """Of each stage its public headers: paths from the root."""
    stages = {}
    for file in sorted((ROOT / "robomill").glob("*/CMakeLists.txt")):
        text = re.sub(r"#.*", "", file.read_text(encoding="utf-8"))
        names = re.search(r"PUBLIC_HEADERS\s+(.*?)\s+(?:[A-Z_]{4,}\b|\))", text, re.S)
        if names:
            stages[file.parent.name] = [f"robomill/{file.parent.name}/{name}" for name in names[1].split()]
    return stages
