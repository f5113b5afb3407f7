// Identity of a file's content, to detect that it has changed. A value; any thread.
#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <string>

namespace fieldcast {

// Device, number, size and change time.
struct FileStamp {
  dev_t device = 0;
  ino_t inode = 0;
  off_t size = -1;  // -1 if the file does not exist
  std::int64_t changed_ns = 0;
  friend bool operator==(const FileStamp&, const FileStamp&) = default;

  [[nodiscard]] static FileStamp of(const std::string& path) {
    struct stat found {};
    if (path.empty() || ::stat(path.c_str(), &found) != 0) return {};
    return {found.st_dev, found.st_ino, found.st_size,
            found.st_ctim.tv_sec * std::int64_t{1'000'000'000} + found.st_ctim.tv_nsec};
  }
};

}  // namespace fieldcast
