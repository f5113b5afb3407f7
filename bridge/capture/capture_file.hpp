// A file that grows by complete blocks. A block that was written only in part is removed, so that
// the file is always readable. Only its owner may read it; an existing file is never overwritten.
//
// Owns the descriptor. One thread at a time. An error is one line that begins with the path.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/bytes.hpp"

namespace fieldcast {

class CaptureFile {
 public:
  struct Fault {
    int error = 0;
    std::string text;  // "x.pcapng: File exists"
  };
  [[nodiscard]] static tl::expected<CaptureFile, Fault> make(const std::string& path);

  // Writes all blocks or none.
  [[nodiscard]] tl::expected<void, Fault> append(ByteView blocks);
  // Returns true if the file was deleted; appended data is then lost.
  [[nodiscard]] bool removed() const;
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  CaptureFile(std::string path, FileDescriptor file)
      : path_(std::move(path)), file_(std::move(file)) {}

  std::string path_;
  FileDescriptor file_;
  std::uint64_t size_ = 0;
};

}  // namespace fieldcast
