"""Checks the links of a built site: each page, file and anchor that one names is there. Without network: links to elsewhere are not followed."""
import html
import os
import pathlib
import re
import urllib.parse

ATTRIBUTE = re.compile(r'<(?:a|img|script|link|object|source)\b[^>]*?\s(?:href|src|data)="([^"]*)"')
ANCHOR = re.compile(r'\s(?:id|name)="([^"]*)"')


def faults_of(folder):
    """Links that lead nowhere, and the number of those that were checked."""
    texts = {path: path.read_text(encoding="utf-8") for path in pathlib.Path(folder).rglob("*.html") if "_static" not in path.parts}
    anchors = {path: set(map(html.unescape, ANCHOR.findall(text))) for path, text in texts.items()}
    faults, count = [], 0
    for page, text in texts.items():
        for link in set(map(html.unescape, ATTRIBUTE.findall(text))):
            path, _, anchor = link.partition("#")
            if re.match(r"[a-z]+:|//", link) or not link:
                continue
            count += 1
            path = urllib.parse.unquote(path.partition("?")[0])
            target = pathlib.Path(os.path.normpath(page.parent / path)) if path else page
            if not target.exists():
                faults.append(f"{page}: there is no {link}")
            elif anchor and target in anchors and urllib.parse.unquote(anchor) not in anchors[target]:
                faults.append(f"{page}: {path or page.name} has no anchor #{anchor}")
    return faults, count
