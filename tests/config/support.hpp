#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
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
