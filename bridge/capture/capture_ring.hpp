// A file that grows by complete blocks; a partly written one is removed, so that the file is always
// readable. Only its owner may read it; an existing file is never overwritten. One thread at a
// time. An error is one line that begins with the path.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/capture/bus_capture.hpp"
#include "core/base/bytes.hpp"
#include "core/model/bus_spec.hpp"

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

// Files of a bus with a permanent capture (`capture:`), BUS-20261122T142421Z.pcapng. When one is
// full, the next begins and the oldest is deleted. If the disk is nearly full or the folder is
// missing, the capture stops, logs that once, and resumes by itself. On the service's thread.
class CaptureRing final : public CaptureSink {
 public:
  // Nothing is written if less space would remain. The capture resumes when twice as much is free.
  static constexpr std::uint64_t kLeastFree = 16 << 20;  // bytes
  static constexpr Duration kLook = std::chrono::seconds{1};

  // `head` returns the first blocks of a file, with a remark.
  CaptureRing(std::string bus, CaptureSpec spec, std::function<Bytes(const std::string&)> head);
  ~CaptureRing() override;

  void packet(ByteView block, UtcTime at, bool session) override;
  void lost(std::uint64_t records) override;
  [[nodiscard]] bool only_sessions() const override { return spec_.only_sessions; }
  // Checks the free space at most every kLook; may be called more often.
  void look(UtcTime now);
  [[nodiscard]] const CaptureSpec& spec() const { return spec_; }

 private:
  [[nodiscard]] bool begin(UtcTime at);
  void end(const std::string& why);
  void stop(const std::string& why);
  void remove_oldest() const;

  const std::string bus_;
  const CaptureSpec spec_;
  const std::function<Bytes(const std::string&)> head_;
  std::optional<CaptureFile> file_;
  CaptureCounts counts_;
  std::uint64_t missed_ = 0;  // frames since the capture stopped
  bool stopped_ = false;
  std::string told_;  // the reason in the log; empty while it captures
  UtcTime looked_;
  std::int64_t second_ = 0;  // start of the last file
  int number_ = 0;           // of the last file in that second
};

}  // namespace fieldcast
