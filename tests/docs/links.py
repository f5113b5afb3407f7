"""Finds dead relative links of documents, in the source tree and in an installation."""

import os
import re


def read(root, path):
    with open(os.path.join(root, path), encoding="utf-8") as file:
        return re.sub(r"```.*?```", "", file.read(), flags=re.DOTALL)


def anchors(text):
    """Returns the anchors that GitHub generates from the headings."""
    headings = re.findall(r"^#+ (.+)$", re.sub(r"```.*?```", "", text, flags=re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def links(root, path):
    return [link for link in re.findall(r"\]\(([^)\s]+)\)", read(root, path)) if "://" not in link]


def dead_links(root, path):
    """Returns one message for each dead link of the document `path` below `root`."""
    found = []
    for link in links(root, path):
        file, _, anchor = link.partition("#")
        target = os.path.normpath(os.path.join(os.path.dirname(path), file)) if file else path
        if target.startswith("..") or not os.path.exists(os.path.join(root, target)):
            found.append(f"{path}: {link}: there is no {target}")
        elif anchor and target.endswith(".md") and anchor not in anchors(read(root, target)):
            found.append(f"{path}: {link}: {target} has no such heading")
    return found
