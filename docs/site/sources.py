"""The pages' sources: the Markdown files of the repository where they stand, and those of docs/site, in one folder for Sphinx.

Links stay as they are on GitHub. Here a link to a file that is a page leads to the page, one to a folder to its README, and any
other file goes along and is opened from the site."""
import os
import pathlib
import re
import shutil

SITE = pathlib.Path(__file__).resolve().parent
ROOT = SITE.parent.parent
PAGES = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "docs/*.md", "docs/theory/*.md", "robomill/*/README.md",
         "examples/**/README.md", "data/README.md", "bench/README.md", "testing/*/README.md", "web/README.md", "packaging/README.md", "python/README.md", "python/examples/README.md", "docs/site/**/*.md"]
# What a link to a folder without a README leads to.
FOLDERS = {"docs/theory": "docs/site/theory/index.md", "docs/schema": "docs/site/reference/schemas.md"}
GENERATED = {"docs/site/reference/schemas.md", "docs/site/reference/command-line.md"}
LINK = re.compile(r"(`+)(?:(?!\1).)+\1|\]\(([^)\s]+)\)|\[([A-Z]\w+)\](?![(\[:])")
INCLUDE = re.compile(r"<!-- include (\S+)#(\S+) -->")


def pages():
    """Paths of all pages from the root, without the generated ones."""
    found = {p.relative_to(ROOT).as_posix() for pattern in PAGES for p in ROOT.glob(pattern)}
    return sorted(found - GENERATED)


def staged(path):
    """Where a file of the repository stands among the sources: docs/site/ is their top."""
    return path.removeprefix("docs/site/")


def slug(title):
    """The anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-")


def section(text, anchor):
    """What stands below a heading, up to the next one of its level; its own headings as far below the page's title."""
    level, lines = 0, []
    for line in without_code(text):
        heading = re.match(r"(#+) (.*)", line)
        if level and heading and len(heading[1]) <= level:
            break
        if level:
            lines.append(line[level - 1:] if heading else line.lstrip("\0"))
        elif heading and slug(heading[2]) == anchor:
            level = len(heading[1])
    return "\n".join(lines) if level else None


def without_code(text):
    """Lines, those of fenced blocks behind a zero byte, so that no # in them reads as a heading."""
    inside = False
    for line in text.splitlines():
        fence = line.startswith("```")
        yield ("\0" + line) if inside or fence else line
        inside ^= fence


class Sources:
    """Writes the sources into a folder. faults: links and includes that lead nowhere."""

    def __init__(self, folder):
        self.folder = folder
        self.pages = set(pages()) | GENERATED
        self.keys = set(re.findall(r"^- \[(\w+)\]", (ROOT / "docs/bibliography.md").read_text(encoding="utf-8"), re.M))
        self.faults, self.written = [], set()

    def write(self, path, text):
        """Only where it changed, so that Sphinx reads no page twice."""
        self.written.add(staged(path))
        target = self.folder / staged(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")

    def page(self, path):
        text = (ROOT / path).read_text(encoding="utf-8")
        self.write(path, self.linked(path, path, text))

    def linked(self, page, origin, text):
        """text, which stands in the file `origin`, for `page`: its links rewritten, its includes replaced."""
        lines, fenced = [], False
        for line in text.splitlines():
            fenced ^= line.startswith("```")
            include = INCLUDE.fullmatch(line.strip())
            if include and not fenced:
                line = self.included(page, origin, *include.groups())
            elif not fenced and not line.startswith("    "):
                line = LINK.sub(lambda match: self.rewritten(page, origin, match), line)
            lines.append(line)
        if origin == "docs/bibliography.md":  # a place to link to for each key
            lines = [re.sub(r'^- <a href="[^"]*#(\w+)">', r'- <a id="\1"></a><a href="#\1">', line) for line in lines]
        return "\n".join(lines) + "\n"

    def included(self, page, origin, target, anchor):
        path = joined(origin, target)
        text = section((ROOT / path).read_text(encoding="utf-8"), anchor) if (ROOT / path).is_file() else None
        if text is None:
            self.faults.append(f"{origin}: there is no {target}#{anchor} to include")
            return ""
        return self.linked(page, path, text)

    def rewritten(self, page, origin, match):
        code, target, key = match.groups()
        heading = match.string.startswith("#")  # it is repeated in the navigation of every page
        if code or (key and (key not in self.keys or heading)):
            return match[0]
        if key:
            place = relative("docs/bibliography.html", page)
            return f'<a href="{place}#{key}">[{key}]</a>'
        if re.match(r"[a-z]+:", target) or (target.startswith("#") and page == origin):
            return match[0]
        path, mark, anchor = target.partition("#")
        path = joined(origin, path) if path else origin
        if (ROOT / path).is_dir():
            path = FOLDERS.get(path.rstrip("/"), f"{path.rstrip('/')}/README.md")
        if path not in self.pages and not (ROOT / path).is_file():
            self.faults.append(f"{origin}: there is no {target}")
            return match[0]
        if path not in self.pages:
            self.along(path)
        return f"]({relative(staged(path), page)}{mark}{anchor})"

    def along(self, path):
        """A file that is no page, as it is: a picture, a source, a document."""
        target = self.folder / staged(path)
        self.written.add(staged(path))
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.stat().st_mtime_ns != (ROOT / path).stat().st_mtime_ns:
            shutil.copy2(ROOT / path, target)

    def remove_others(self):
        """Files of an earlier build that belong to no page any more."""
        for file in self.folder.rglob("*"):
            if file.is_file() and file.relative_to(self.folder).as_posix() not in self.written:
                file.unlink()


def joined(origin, target):
    return os.path.normpath(os.path.join(os.path.dirname(origin), target))


def relative(target, page):
    return os.path.relpath(target, os.path.dirname(staged(page)) or ".")
