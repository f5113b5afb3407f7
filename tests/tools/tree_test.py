"""Checks the rules of the tree that no compiler checks: the includes and symbols that core may
use, and the files at the top level.

usage: tree_test.py SOURCE_DIR NM CORE_LIBRARY..

Each rule is a function of its input and is also tested with planted faults, so that a rule without
effect is detected.
"""

import os
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE_DIR, NM, CORE_LIBRARIES = "", "nm", []

# A directory may include those of earlier entries, never later ones or others of its own entry.
LAYERS = [{"base"}, {"access", "capture", "frame", "codec"}, {"protocol", "telnet"}, {"program"}, {"model"}, {"alarm", "calculate", "gateway", "plan"}, {"dispatch"}, {"schedule"}, {"bus"}]
RANK = {folder: rank for rank, folders in enumerate(LAYERS) for folder in folders}

THIRD_PARTY = {"tl/expected.hpp"}
# Standard headers with a clock, a thread or a file. <chrono> is allowed: durations are values.
IMPURE_STD = {
    "atomic", "barrier", "condition_variable", "csignal", "ctime", "filesystem", "fstream", "future", "iostream", "latch",
    "mutex", "random", "semaphore", "shared_mutex", "stop_token", "syncstream", "thread",
}

TOP_LEVEL = {
    "CHANGELOG.md", "CMakeLists.txt", "CMakePresets.json", "CONTRIBUTING.md", "LICENSE", "README.md", "SECURITY.md",
    "bridge", "config", "core", "docs", "idl", "tests", "tools",
}


# Symbols, as `nm -C` prints them, that core must not use.
FORBIDDEN_SYMBOLS = [
    ("clock", r"std::chrono::_V2::\w+::now\(|clock(_\w+)?|gettimeofday|time|timespec_get|localtime(_r)?|gmtime(_r)?|u?sleep|nanosleep"),
    ("thread", r"pthread_\w+|thrd_\w+|std::thread::|std::condition_variable|std::this_thread|sem_\w+|fork|vfork|system|exec\w+"),
    ("file", r"(f|fd|fre)?open(64|at)?|fread|fwrite|fclose|read|write|close|ioctl|v?f?printf|(f|put)?puts|putchar|__v?f?printf_chk|"
             r"std::basic_(i|o)?fstream|std::basic_filebuf|std::(cout|cerr|clog|cin)|std::filesystem|stdout|stderr|getenv"),
    ("socket", r"socket|connect|bind|listen|accept4?|send(to|msg)?|recv(from|msg)?|poll|p?select|epoll_\w+|getaddrinfo"),
]


def include_fault(folder, include):
    """Returns the fault of an include in a file of core/folder, None if it is allowed."""
    if include in THIRD_PARTY:
        return None
    if include.startswith("core/"):
        target = include.split("/")[1]
        if target not in RANK:
            return f"core/{target} is no layer of core"
        if target != folder and RANK[target] >= RANK[folder]:
            return f"the arrow runs back: {folder} must not include {target}"
        return None
    if "/" in include or "." in include:
        return "core includes the standard library, tl/expected.hpp and core/... only"
    if include in IMPURE_STD:
        return "core has no clock, thread, file or chance"
    return None


def station_fault(path, include):
    """Returns the fault of an include: the daemon must not use the station's DDS code."""
    if include.startswith("bridge/station/") and path.startswith("bridge/") \
            and not path.startswith(("bridge/station/", "bridge/client/")):
        return "the daemon must not need the station's library"
    if path.startswith("bridge/station/") and include.startswith("bridge/") \
            and not include.startswith(("bridge/station/", "bridge/dds/", "bridge/base/check.hpp")):
        return "the station's library needs the core, the topics and Fast DDS only"
    return None


def includes_of(text):
    return re.findall(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"]+)[>"]', text, re.MULTILINE)


def symbol_fault(symbol):
    """Returns the kind of the forbidden symbol ("clock", "file", ...), or None."""
    bare = symbol.split("@")[0].strip()
    for kind, pattern in FORBIDDEN_SYMBOLS:
        # C symbols must match whole, C++ library names from their beginning.
        if re.fullmatch(pattern, bare) or bare.startswith("std::") and re.match(pattern, bare):
            return kind
    return None


def undefined_symbols(library):
    listing = subprocess.run([NM, "-C", "-u", library], check=True, capture_output=True, text=True).stdout
    return {line.split(None, 1)[1] for line in listing.splitlines() if re.match(r"\s+[UwV] ", line)}


def core_files():
    for path, _, names in os.walk(os.path.join(SOURCE_DIR, "core")):
        for name in names:
            if name.endswith((".hpp", ".cpp")):
                yield os.path.join(path, name)


def sources():
    for folder in ["bridge", "config", "core", "idl", "tests", "tools"]:
        for path, _, names in os.walk(os.path.join(SOURCE_DIR, folder)):
            yield from (os.path.join(path, name) for name in names if name.endswith((".cpp", ".hpp", ".c", ".h")))


# Parts of GCC 12's library that clang 14, used for fuzzing, cannot compile.
NOT_BY_CLANG = re.compile(r"std::(views\b|ranges::(views\b|(search|search_n|find_end|equal_range|unique|remove|remove_if|partition|rotate|subrange)\b))")


# All JSON is written by core/base/json.hpp and json_text.hpp, which escape data from the network. These look like JSON made by hand:
# a literal that begins an object or ends a name, and the output of nlohmann's library, which is for reading only.
JSON_BY_HAND = re.compile(r"""\{\\+"|\\":[^ ]|R"\w*\(\s*\{\s*"|\bdump\(""")
# Constant texts: JSON schemas, and hints that show a client the correct request.
JSON_BY_HAND_IN = {
    "tools/station/settings/configuration.cpp", "tools/station/api/commands.cpp",
    "tools/station/settings/text_list.hpp", "tools/station/live/client_message.cpp", "tools/station/web/logins.cpp",
}


def json_by_hand(path, text):
    """Returns the lines of the file `path` (from the root) that make JSON without the writer."""
    if path in JSON_BY_HAND_IN or path.startswith("tools/bench/") or not path.startswith(("bridge/", "core/", "tools/")):
        return []
    return [number for number, line in enumerate(text.splitlines(), 1) if JSON_BY_HAND.search(line.split("//")[0])]


def too_long(text):
    """Returns the numbers of C++ lines with more than 100 columns; SQL in raw strings is exempt."""
    faults, raw = [], False
    for number, line in enumerate(text.splitlines(), 1):
        if not raw and len(line) > 100:
            faults.append(number)
        raw = (raw or 'R"(' in line) and ')"' not in line
    return faults


def formats_as_the_tree():
    """Returns true if clang-format is version 14: others format some lines in another way."""
    return " version 14." in subprocess.run(["clang-format", "--version"], capture_output=True, text=True).stdout


def format_faults(files):
    """Returns what clang-format would change, as its messages."""
    style = "--style=file:" + os.path.join(SOURCE_DIR, ".clang-format")
    return subprocess.run(["clang-format", style, "--dry-run", *files], capture_output=True, text=True).stderr


class Rules(unittest.TestCase):
    """Each rule finds a planted fault."""

    def test_an_arrow_that_runs_back_is_found(self):
        self.assertIsNone(include_fault("bus", "core/model/spec.hpp"))
        self.assertIsNone(include_fault("codec", "core/codec/value_codec.hpp"))
        self.assertIsNotNone(include_fault("base", "core/frame/line.hpp"))
        self.assertIsNotNone(include_fault("model", "core/schedule/scheduler.hpp"))
        self.assertIsNotNone(include_fault("frame", "core/codec/value_codec.hpp"))
        self.assertIsNotNone(include_fault("bus", "core/elsewhere/x.hpp"))

    def test_a_foreign_header_is_found(self):
        self.assertIsNone(include_fault("base", "tl/expected.hpp"))
        self.assertIsNone(include_fault("base", "vector"))
        for header in ["boost/asio.hpp", "unistd.h", "sys/socket.h", "config/loader/loader.hpp", "thread", "fstream"]:
            self.assertIsNotNone(include_fault("base", header), header)

    def test_an_include_between_the_daemon_and_the_station_is_found(self):
        self.assertIsNone(station_fault("tools/cli/session.hpp", "bridge/station/station.hpp"))
        self.assertIsNone(station_fault("bridge/station/station.cpp", "bridge/dds/transport/domain.hpp"))
        self.assertIsNotNone(station_fault("bridge/bridge.cpp", "bridge/station/station.hpp"))
        self.assertIsNotNone(station_fault("bridge/dds/topics/conversion.hpp", "bridge/station/station.hpp"))
        self.assertIsNotNone(station_fault("bridge/station/station.cpp", "bridge/log/log.hpp"))

    def test_json_that_is_made_by_hand_is_found(self):
        for line in ['out = "{\\"kind\\":" + text;', 'text += "\\"id\\":" + id;', 'R"({"kind":"result",)"', 'R"x( { "a": 1})x"',
                     "line.dump()", 'fmt::format("{{\\"a\\": {}}}", a)']:
            self.assertEqual(json_by_hand("tools/cli/x.cpp", line), [1], line)
            self.assertEqual(json_by_hand("tools/bench/x.cpp", line), [])
        for line in ['Json{{"a", 1}}', '// sends {"a": 1}', 'fmt::format("{}=\\"{}\\"", a, b)', 'json.add("id", id);']:
            self.assertEqual(json_by_hand("bridge/x.cpp", line), [], line)

    def test_includes_are_seen_in_every_spelling(self):
        self.assertEqual(includes_of('#include <a>\n  # include "b/c.hpp"\n// #include <d>\n'), ["a", "b/c.hpp"])

    def test_a_line_that_is_too_long_is_found(self):
        self.assertEqual(too_long("x" * 100 + "\n" + "y" * 101 + "\n"), [2])
        self.assertEqual(too_long('R"(\n' + "z" * 101 + '\n)"\n' + "y" * 101), [4])

    def test_what_clang_does_not_compile_is_found(self):
        self.assertTrue(NOT_BY_CLANG.search("if (std::ranges::search(a, b).empty())"))
        self.assertTrue(NOT_BY_CLANG.search("for (const int i : std::views::reverse(a))"))
        self.assertFalse(NOT_BY_CLANG.search("std::ranges::find(a, b); std::search(a, b, c, d);"))

    def test_a_file_that_is_not_formatted_is_found(self):
        with tempfile.NamedTemporaryFile("w", suffix=".cpp") as file:
            file.write("int  f( ){return 1 ;}\n")
            file.flush()
            self.assertIn("clang-format-violations", format_faults([file.name]))

    def test_a_clock_thread_file_or_socket_symbol_is_found(self):
        for symbol, kind in [("std::chrono::_V2::steady_clock::now()", "clock"), ("clock_gettime@GLIBC_2.17", "clock"),
                             ("pthread_create@GLIBC_2.34", "thread"), ("std::thread::join()", "thread"), ("fopen", "file"),
                             ("std::cout", "file"), ("std::basic_ofstream<char, std::char_traits<char> >::open(char const*)", "file"),
                             ("printf", "file"), ("socket", "socket"), ("recv", "socket")]:
            self.assertEqual(symbol_fault(symbol), kind, symbol)
        for symbol in ["memcpy", "std::__throw_length_error(char const*)", "operator new(unsigned long)", "strtod", "abort",
                       "fieldcast::read(int)", "__assert_fail", "std::to_chars(char*, char*, double)"]:
            self.assertIsNone(symbol_fault(symbol), symbol)


class Tree(unittest.TestCase):
    def test_core_includes_only_what_its_layer_may(self):
        faults, seen = [], 0
        for path in core_files():
            folder = os.path.relpath(path, os.path.join(SOURCE_DIR, "core")).split(os.sep)[0]
            self.assertIn(folder, RANK, f"{path}: core/{folder} is no layer of core")
            with open(path, encoding="utf-8") as file:
                for include in includes_of(file.read()):
                    seen += 1
                    if fault := include_fault(folder, include):
                        faults.append(f"{path}: {include}: {fault}")
        self.assertGreater(seen, 0, "no include found under core/")
        self.assertEqual(faults, [], "\n" + "\n".join(faults))

    def test_the_daemon_and_the_station_share_the_topics_only(self):
        faults, seen = [], 0
        for file_path in sources():
            path = os.path.relpath(file_path, SOURCE_DIR)
            with open(file_path, encoding="utf-8") as file:
                for include in includes_of(file.read()):
                    seen += include.startswith("bridge/station/")
                    if fault := station_fault(path, include):
                        faults.append(f"{path}: {include}: {fault}")
        self.assertGreater(seen, 0, "nobody includes the station's library")
        self.assertEqual(faults, [], "\n" + "\n".join(faults))

    def test_the_built_core_needs_no_clock_thread_file_or_socket(self):
        symbols = {symbol for library in CORE_LIBRARIES for symbol in undefined_symbols(library)}
        self.assertGreater(len(symbols), 100, f"{CORE_LIBRARIES} name hardly a symbol")
        faults = [f"{symbol}: {kind}" for symbol in sorted(symbols) if (kind := symbol_fault(symbol))]
        self.assertEqual(faults, [], "\n" + "\n".join(faults))

    @unittest.skipIf(not formats_as_the_tree(), "the sources are formatted by clang-format 14 (Debian 12)")
    def test_every_source_is_formatted(self):
        files = sorted(sources())
        self.assertGreater(len(files), 0, "no source found")
        faults = format_faults(files)
        self.assertEqual(faults, "", "run clang-format -i on these:\n" + faults[:4000])

    def test_no_line_has_more_than_100_columns(self):
        faults = []
        for path in sorted(sources()):
            with open(path, encoding="utf-8") as file:
                faults += [f"{path}:{number}" for number in too_long(file.read())]
        self.assertEqual(faults, [], "\n" + "\n".join(faults))

    def test_no_json_is_made_by_hand(self):
        faults = []
        for path in sorted(sources()):
            with open(path, encoding="utf-8") as file:
                name = os.path.relpath(path, SOURCE_DIR)
                faults += [f"{name}:{number}" for number in json_by_hand(name, file.read())]
        self.assertEqual(faults, [], "use core/base/json.hpp\n" + "\n".join(faults))

    def test_clang_compiles_what_is_fuzzed(self):
        faults = []
        for path in sorted(sources()):
            if os.path.relpath(path, SOURCE_DIR).startswith("tests") and "/fuzz/" not in path:
                continue
            with open(path, encoding="utf-8") as file:
                for number, line in enumerate(file.read().splitlines(), 1):
                    if NOT_BY_CLANG.search(line.split("//")[0]):
                        faults.append(f"{path}:{number}: clang 14 does not compile this: use the algorithm of <algorithm> with iterators")
        self.assertEqual(faults, [], "\n" + "\n".join(faults))

    def test_the_top_level_holds_nothing_else(self):
        names = {name for name in os.listdir(SOURCE_DIR) if not name.startswith(".") and not name.startswith("build")}
        self.assertEqual(names - TOP_LEVEL, set())


if __name__ == "__main__":
    SOURCE_DIR, NM, CORE_LIBRARIES = sys.argv[1], sys.argv[2], sys.argv[3:]
    unittest.main(argv=sys.argv[:1], verbosity=2)
