#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <ostream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "config/loader/loader.hpp"

namespace fieldcast::config {

inline std::filesystem::path source_dir() { return FIELDCAST_SOURCE_DIR; }

inline std::string slurp(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder,
                                                   const std::string& extension) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// A file with faults; its comments list the expected messages.
struct BadCase {
  std::string name;
  std::string text;

  [[nodiscard]] std::string file() const { return name + ".yaml"; }
  // For the name of a test.
  [[nodiscard]] std::string identifier() const {
    auto words = name;
    std::replace(words.begin(), words.end(), '-', '_');
    return words;
  }
  // The expected messages, one per line.
  [[nodiscard]] std::string expected() const {
    static constexpr std::string_view kExpect = "# expect: ";
    std::string messages;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with(kExpect)) messages += line.substr(kExpect.size()) + '\n';
    }
    return messages;
  }
};

inline void PrintTo(const BadCase& bad, std::ostream* out) { *out << bad.name; }

// Returns the cases of a folder. In a .txt file a line "=== NAME" begins a case, and its lines are
// counted from there; a .yaml file is one case.
inline std::vector<BadCase> bad_cases(const std::filesystem::path& folder) {
  static constexpr std::string_view kCase = "=== ";
  std::vector<BadCase> cases;
  for (const auto& path : files_of(folder, ".yaml"))
    cases.push_back({path.stem().string(), slurp(path)});
  for (const auto& path : files_of(folder, ".txt")) {
    std::istringstream lines(slurp(path));
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with(kCase))
        cases.push_back({line.substr(kCase.size()), ""});
      else
        cases.back().text += line + '\n';
    }
  }
  return cases;
}

inline FileReader texts(std::map<std::string, std::string> files) {
  return {[files](const std::string& path) -> tl::expected<std::string, FileError> {
            const auto found = files.find(path);
            if (found == files.end()) return tl::unexpected(FileError::kMissing);
            return found->second;
          },
          {}};
}

// Reads files relative to `folder`, so that faults name them as the files themselves do.
inline FileReader within(const std::filesystem::path& folder) {
  const auto disk = disk_reader();
  return {[=](const std::string& path) { return disk.read((folder / path).string()); },
          [=](const std::string& directory) { return disk.list((folder / directory).string()); }};
}

inline std::string faults_of(const Loaded& loaded) {
  return loaded ? "" : to_text(std::span(loaded.error()));
}

inline std::string plant(const std::string& channels) {
  return "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0 }\n    protocol: "
         "modbus-rtu\n    devices:\n"
         "      - name: d\n        address: 1\n        channels:\n" +
         channels;
}

}  // namespace fieldcast::config
