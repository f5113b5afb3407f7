"""The words that the comments, messages and documents of this tree avoid (CONTRIBUTING.md, "Language").

usage: language.py SOURCE_DIR [PATH_PREFIX]    prints each place and a count for each word; exit code 1 if a word is found
"""

import collections
import os
import re
import sys

# {pattern: the word to use}
WORDS = {
    r"anew|newly": "again, reopens, restarts",
    r"is no (?=[a-z]+[.,;:]?(?: |$))": "is not a",
    r"gone": "closed, removed, disconnected",
    r"let(?:s)? go": "released",
    r"told|tells?(?! apart)": "reported, returns, requests",
    r"whoever|whichever": "the client, the caller, the user",
    r"answer(?:s|ed|ing)?|unanswered": "response, respond",
    r"under way": "in flight, pending",
    r"besides": "also",
    r"all the same": "anyway",
    r"for good": "permanently",
    r"wish(?:es|ed)?": "interest, request",
    r"desks?|books?|rooms?|houses?": "controller, registry, directory",
    r"another one|the other one": "name it",
    r"thereof|therein|hereby": "name it",
    r"sick|mend(?:s|ed|ing)?|strangers?|troubles?": "unhealthy, fix, outsider, fault",
    r"at once": "immediately, in one transaction",
    r"stands? in|lies in": "is in, is written in",
    r"people": "the user, human-readable",
}
PATTERNS = {word: re.compile(r"(?<![\w-])(?:" + word + r")(?![\w-])", re.IGNORECASE) for word in WORDS}
# These list the words.
UNCHECKED = {"tests/docs/language.py", "tests/docs/language_test.py"}
SUFFIXES = {".cpp": "//", ".hpp": "//", ".c": "//", ".h": "//", ".idl": "//", ".ts": "//", ".js": "//", ".py": "#", ".sh": "#", ".txt": "#",
            ".cmake": "#", ".yaml": "#"}
STRING = re.compile(r'"((?:[^"\\\n]|\\.)*)"')


def prose_of(path, text):
    """[(line, prose)]: comments and strings of a source, all lines of a document but code."""
    lines, fenced, raw = [], False, False
    suffix = os.path.splitext(path)[1]
    for number, line in enumerate(text.splitlines(), 1):
        if suffix == ".md":
            if line.lstrip().startswith("```"):
                fenced = not fenced
            elif not fenced:
                lines.append((number, re.sub(r"`[^`]*`|\]\([^)]*\)", " ", line)))
            continue
        mark = SUFFIXES.get(suffix)
        if not mark or line.lstrip().startswith("#include"):
            continue
        # Texts of tests are data: what a program printed, a name, an input.
        strings = "" if path.startswith("tests/") else " ".join(STRING.findall(line))
        rest = STRING.sub('""', line)
        comment = rest.split(mark, 1)[1] if mark in rest else ""
        prose = strings + " " + re.sub(r"`[^`]*`|\b\w+_\w+\b|\b\w+\(\)", " ", comment)
        if prose.strip():
            lines.append((number, prose))
    return lines


# Right uses: names of interfaces, and words in another sense.
RIGHT_USES = [
    r"\bGONE\b", r"^gone$", r"high gone", r"\b17 ANSWER\b", r"REQUIRES:.*answer", r"answer_time", r"\broom(?:s)? (?:for|thermostats|again|is free)",
    r"mak(?:es|e) room", r"no room", r"count request answer", r"^answers?$", r"'answer'", r"answer value", r"Answer::", r"(?:Replays |rounds, )answers", r"trouble alert",
]


def is_right_use(path, number, word, prose):
    listed = path == "CONTRIBUTING.md" and prose.startswith("|")  # the table of these words
    return listed or any(re.search(use, prose) for use in RIGHT_USES)


def places(path, text):
    return [(path, number, word, prose.strip()) for number, prose in prose_of(path, text) for word, pattern in PATTERNS.items()
            if pattern.search(prose)]


def all_places(source_dir, prefix=""):
    found = []
    for folder, names, files in os.walk(source_dir):
        names[:] = sorted(name for name in names if not name.startswith((".", "build", "node_modules", "corpus")))
        for name in sorted(files):
            path = os.path.relpath(os.path.join(folder, name), source_dir)
            if path.startswith(prefix) and path not in UNCHECKED and (name.endswith(".md") or os.path.splitext(name)[1] in SUFFIXES):
                try:
                    with open(os.path.join(folder, name), encoding="utf-8") as file:
                        found += places(path, file.read())
                except UnicodeDecodeError:
                    pass
    return found


if __name__ == "__main__":
    found = [place for place in all_places(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "") if not is_right_use(*place)]
    if len(sys.argv) > 2:
        print("\n".join(f"{path}:{number}: {prose}" for path, number, _, prose in found))
    for word, count in collections.Counter(word for _, _, word, _ in found).most_common():
        print(f"{count:6} {word}")
    by = collections.Counter("/".join(path.split("/")[:2]) for path, *_ in found)
    print(len(found), dict(by.most_common(30)))
    sys.exit(1 if found else 0)
