// A file that grows by whole blocks: what does not fit any more is taken back, so that the file can
// be read at any time. Readable for its owner only; never over a file that exists.
//
// Owns the descriptor. One thread at a time. Errors are one line that begins with the path.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/bytes.hpp"

namespace fieldcast {

class CaptureFile {
 public:
  struct Fault {
    int error = 0;     // errno
    std::string text;  // "x.pcapng: File exists"
  };
  [[nodiscard]] static tl::expected<CaptureFile, Fault> make(const std::string& path);

  // All of it or nothing.
  [[nodiscard]] tl::expected<void, Fault> append(ByteView blocks);
  // Somebody deleted it: what is appended is lost.
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
