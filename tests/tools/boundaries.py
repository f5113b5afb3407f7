"""The boundaries between folders, read from their READMEs and from the includes of the sources.

The README.md of each folder with sources names its face (the headers that other folders may include), the folders that it may use, and
the libraries of others that it includes. tools/folders.cmake links what it names.

usage: boundaries.py SOURCE_DIR           prints every fault and the figures; exit code 1 if there is a fault
       boundaries.py --write SOURCE_DIR   rewrites these lines of every README from the includes, for a change that is meant
"""

import collections
import os
import re
import sys

ROOTS = ("core", "config", "bridge", "tools")
FACE, USES, LIBRARIES = "Face: ", "May use: ", "Libraries: "
MARKS = (FACE, USES, LIBRARIES)
# The libraries of others by the beginnings of their headers. Headers alone (tl::expected), libc and the C++ library are not named.
HEADERS = {
    "boost/": "Boost", "CLI/": "CLI11", "fastcdr/": "Fast-DDS", "fastdds/": "Fast-DDS", "fastrtps/": "Fast-DDS", "fmt/": "fmt", "idl/topics": "idl",
    "curl/": "libcurl", "libpq-fe.h": "libpq", "librdkafka/": "librdkafka", "mosquitto.h": "libmosquitto", "mqtt_protocol.h": "libmosquitto", "nats/": "nats.c", "schema/": "forward-schema", "snappy.h": "snappy", "sodium.h": "libsodium", "zip.h": "libzip", "curses.h": "ncurses", "term.h": "ncurses", "nlohmann/": "nlohmann-json",
    "openssl/": "OpenSSL", "spdlog/": "spdlog", "sqlite3.h": "SQLite", "tinyxml2.h": "tinyxml2", "muParser.h": "muParser", "toml++/": "toml++", "yaml.h": "libyaml",
    "xlsxwriter.h": "libxlsxwriter", "zlib.h": "zlib", "zstd.h": "zstd",
}
# Folders whose files do not belong to the product's libraries.
OUTSIDE = {"tools/packaging", "tools/packaging/example"}
MOST_SOURCES = 25  # of a folder
MOST_LARGE_FOLDERS = 4
MOST_LINES = 500  # of a file
# Files above MOST_LINES. The list may shrink only.
LONG_FILES = {}
PER_LINE = 110  # columns of a README's line


def include_lines(text):
    return re.findall(r'^[ \t]*#[ \t]*include[ \t]*"([^"]+)"', text, re.MULTILINE)


def libraries_of(text):
    """The names of the libraries of others that a source includes."""
    included = re.findall(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"]+)[>"]', text, re.MULTILINE)
    return {name for header in included for start, name in HEADERS.items() if header.startswith(start)}


def read_tree(source_dir):
    """{path: text} of all C and C++ files of the product, paths from the root."""
    files = {}
    for root in ROOTS:
        for folder, _, names in os.walk(os.path.join(source_dir, root)):
            for name in names:
                if name.endswith((".hpp", ".cpp", ".h", ".c")):
                    path = os.path.relpath(os.path.join(folder, name), source_dir).replace(os.sep, "/")
                    if os.path.dirname(path) not in OUTSIDE:
                        with open(os.path.join(folder, name), encoding="utf-8") as file:
                            files[path] = file.read()
    return files


def crossings(files):
    """[(file that includes, included file)] of different folders."""
    found = []
    for path, text in sorted(files.items()):
        for include in include_lines(text):
            if include in files and os.path.dirname(include) != os.path.dirname(path):
                found.append((path, include))
    return found


def cycle_of(edges):
    """A cycle in {folder: {folders it uses}} as a list of folders, or an empty list."""
    state, way = {}, []

    def visit(folder):
        state[folder] = "open"
        way.append(folder)
        for used in sorted(edges.get(folder, ())):
            if state.get(used) == "open":
                return way[way.index(used):] + [used]
            if used not in state and (found := visit(used)):
                return found
        way.pop()
        state[folder] = "done"
        return []

    for folder in sorted(edges):
        if folder not in state and (found := visit(folder)):
            return found
    return []


def names_after(mark, text):
    """The names in backquotes of the paragraph that begins with `mark`, or None if there is no such paragraph."""
    for paragraph in re.split(r"\n\s*\n", text):
        for start in [match.start() for match in re.finditer(r"^" + re.escape(mark), paragraph, re.MULTILINE)]:
            part = paragraph[start:]
            end = min((part.find("\n" + other) for other in MARKS if part.find("\n" + other) > 0), default=len(part))
            return re.findall(r"`([^`]+)`", part[:end])
    return None


def wrapped(mark, names):
    line, lines = mark, []
    for index, name in enumerate(names):
        part = f"`{name}`" + ("." if index == len(names) - 1 else ", ")
        if len(line) + len(part.rstrip()) > PER_LINE:
            lines.append(line.rstrip())
            line = ""
        line += part
    return "\n".join(lines + [line if names else mark + "nothing."])


def wanted(files):
    """{folder: (face, folders it uses, libraries of others)} from the includes."""
    face, uses, libraries = (collections.defaultdict(set) for _ in MARKS)
    for path, text in files.items():
        libraries[os.path.dirname(path)] |= libraries_of(text)
    for path, include in crossings(files):
        face[os.path.dirname(include)].add(os.path.basename(include))
        uses[os.path.dirname(path)].add(os.path.dirname(include))
    return {folder: tuple(sorted(names[folder]) for names in (face, uses, libraries)) for folder in {os.path.dirname(path) for path in files}}


def boundary_faults(files, readmes):
    """Faults of `files` against {folder: text of its README.md}."""
    faults = []
    for folder, boundary in sorted(wanted(files).items()):
        text = readmes.get(folder)
        if text is None:
            faults.append(f"{folder} has no README.md; write what it is, and run boundaries.py --write")
            continue
        for mark, real in zip(MARKS, boundary):
            named = names_after(mark, text)
            if named is None and (real or mark != LIBRARIES):
                faults.append(f"{folder}/README.md has no line '{mark}'")
                continue
            named = named or []
            kind = "is included from other folders but is not in its face" if mark == FACE else "is used"
            faults += [f"{folder}/README.md: {name} {kind}; add it to '{mark}' if this is meant" for name in real if name not in named]
            faults += [f"{folder}/README.md: '{mark}' names {name}, which no include needs" for name in named if name not in real]
    return faults


def unknown_names(document, files):
    """The `Type` and `Type::function` of the ways in docs/architecture.md that no source declares."""
    ways = re.findall(r"^## The way of .*?(?=^## )", document, re.MULTILINE | re.DOTALL)
    sources = "\n".join(files.values())
    unknown = []
    for name in re.findall(r"`([A-Z]\w+(?:::\w+)?)`", "".join(ways)):
        kind, _, function = name.partition("::")
        declared = re.search(rf"\b(?:class|struct|enum class|using|concept) {kind}\b", sources)
        if not declared or function and not re.search(rf"\b{function}\(", sources):
            unknown.append(name)
    return unknown


def size_faults(files):
    faults = []
    sources = collections.Counter(os.path.dirname(path) for path in files)
    large = sorted(folder for folder, count in sources.items() if count > MOST_SOURCES)
    if len(large) > MOST_LARGE_FOLDERS:
        faults.append(f"{len(large)} folders have more than {MOST_SOURCES} sources ({', '.join(large)}); {MOST_LARGE_FOLDERS} may")
    for path, text in sorted(files.items()):
        lines = text.count("\n")
        if lines > LONG_FILES.get(path, MOST_LINES):
            faults.append(f"{path} has {lines} lines; at most {LONG_FILES.get(path, MOST_LINES)} are allowed")
    return faults


def figures(files):
    lines = sorted(text.count("\n") for text in files.values())
    edges = {folder: set(uses) for folder, (_, uses, _) in wanted(files).items()}
    sources = collections.Counter(os.path.dirname(path) for path in files)
    return (f"{len(edges)} folders, {sum(map(len, edges.values()))} arrows, {len(files)} files, {sum(lines)} lines; lines of a file: "
            f"median {lines[len(lines) // 2]}, 90th percentile {lines[len(lines) * 9 // 10]}, most {lines[-1]}; "
            f"folders with more than {MOST_SOURCES} sources: {sum(count > MOST_SOURCES for count in sources.values())}")


def read_readmes(source_dir, folders):
    texts = {}
    for folder in folders:
        try:
            with open(os.path.join(source_dir, folder, "README.md"), encoding="utf-8") as file:
                texts[folder] = file.read()
        except FileNotFoundError:
            pass
    return texts


def all_faults(source_dir):
    files = read_tree(source_dir)
    edges = {folder: set(uses) for folder, (_, uses, _) in wanted(files).items()}
    cycle = cycle_of(edges)
    faults = [f"the folders {' -> '.join(cycle)} form a cycle"] if cycle else []
    return faults + boundary_faults(files, read_readmes(source_dir, edges)) + size_faults(files)


def write(source_dir):
    files = read_tree(source_dir)
    boundaries = wanted(files)
    for folder, text in read_readmes(source_dir, boundaries).items():
        lines = "\n".join(wrapped(mark, names) for mark, names in zip(MARKS, boundaries[folder]) if names or mark != LIBRARIES)
        kept = [part for part in re.split(r"\n\s*\n", text.rstrip("\n"))]
        place = next((i for i, part in enumerate(kept) if part.startswith(FACE)), None)
        if place is None:
            kept.append(lines)
        else:
            kept[place] = lines
        with open(os.path.join(source_dir, folder, "README.md"), "w", encoding="utf-8") as file:
            file.write("\n\n".join(kept) + "\n")


if __name__ == "__main__":
    if sys.argv[1] == "--write":
        write(sys.argv[2])
    else:
        found = all_faults(sys.argv[1])
        print("\n".join(found + [figures(read_tree(sys.argv[1]))]))
        sys.exit(1 if found else 0)
