// Reads only regular files, as a device or a pipe may have no end.
#include <array>
#include <filesystem>
#include <fstream>

#include "config/document/limits.hpp"
#include "config/files/file_reader.hpp"

namespace fieldcast::config {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxListed = 1'000;  // names of a directory, for suggestions

tl::expected<std::string, FileError> read_disk(const std::string& path) {
  std::error_code failure;
  const auto status = fs::status(path, failure);
  if (status.type() == fs::file_type::not_found) return tl::unexpected(FileError::kMissing);
  if (failure || status.type() != fs::file_type::regular)
    return tl::unexpected(FileError::kUnreadable);
  std::ifstream file(path, std::ios::binary);
  if (!file) return tl::unexpected(FileError::kUnreadable);
  // The reported size may be wrong (a growing file, or one of /proc).
  std::string text;
  std::array<char, 64 * 1024> part;
  while (file.read(part.data(), part.size()) || file.gcount() > 0) {
    text.append(part.data(), static_cast<std::size_t>(file.gcount()));
    if (text.size() > kMaxFileBytes) return tl::unexpected(FileError::kTooLarge);
  }
  if (file.bad()) return tl::unexpected(FileError::kUnreadable);
  return text;
}

std::vector<std::string> list_disk(const std::string& directory) {
  std::vector<std::string> names;
  std::error_code failure;
  for (fs::directory_iterator entry(directory.empty() ? "." : directory, failure), end;
       !failure && entry != end && names.size() < kMaxListed; entry.increment(failure)) {
    names.push_back(entry->path().filename().string());
  }
  return names;
}

// PREFIX/share/fieldcast of the program PREFIX/bin/NAME.
std::string data_folder() {
  std::error_code failure;
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  if (failure) return "/usr/share/fieldcast";
  return program.parent_path().parent_path() / "share" / "fieldcast";
}

}  // namespace

std::string_view to_text(FileError error) {
  switch (error) {
    case FileError::kMissing: return "does not exist";
    case FileError::kUnreadable: return "cannot be read";
    case FileError::kTooLarge: return "is too large";
  }
  return "?";
}

FileReader disk_reader() { return {read_disk, list_disk}; }

LoadOptions default_options() {
  const std::string data = data_folder();
  return {{data + "/devices"}, {data + "/protocols"}};
}

}  // namespace fieldcast::config
