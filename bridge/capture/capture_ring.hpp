// Files of a bus with a permanent capture (`capture:` in the configuration). When a file is full,
// the next one begins and the oldest one is deleted. Names: BUS-20261122T142421Z.pcapng.
//
// If the disk is nearly full or the folder is missing, the capture stops, logs that once, and
// resumes by itself. Owned by the capture service, on its thread.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "bridge/capture/bus_capture.hpp"
#include "bridge/capture/capture_file.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast {

class CaptureRing final : public CaptureSink {
 public:
  // Nothing is written if less space would remain. The capture resumes when twice as much is free.
  static constexpr std::uint64_t kLeastFree = 16 << 20;  // bytes
  static constexpr Duration kLook = std::chrono::seconds{1};

  // `head` returns the first blocks of a file, with a remark.
  CaptureRing(std::string bus, CaptureSpec spec, std::function<Bytes(const std::string&)> head);
  ~CaptureRing() override;

  void packet(ByteView block, UtcTime at) override;
  void lost(std::uint64_t records) override;
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
