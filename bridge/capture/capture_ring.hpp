// The files of a bus that is always captured (`capture:` in the configuration): when one is full
// the next begins, and the oldest goes. Names: BUS-20261122T142421Z.pcapng.
//
// It stops when the disk is nearly full, or when the folder is missing, says so once in the log,
// and goes on by itself. Owned by the capture service, on its thread.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "bridge/capture/bus_capture.hpp"
#include "bridge/capture/capture_file.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class CaptureRing final : public CaptureSink {
 public:
  // It writes nothing that leaves less, and goes on when there is twice as much.
  static constexpr std::uint64_t kLeastFree = 16 << 20;  // bytes
  static constexpr Duration kLook = std::chrono::seconds{1};

  // `head`: what a file begins with, with a remark.
  CaptureRing(std::string bus, CaptureSpec spec, std::function<Bytes(const std::string&)> head);
  ~CaptureRing() override;  // ends the file

  void packet(ByteView block, UtcTime at) override;
  void lost(std::uint64_t records) override;
  // Looks now and then whether there is room; asked often.
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
  CaptureCounts counts_;      // of the file
  std::uint64_t missed_ = 0;  // frames since it stopped
  bool stopped_ = false;
  std::string told_;  // why it stopped, as the log says; empty: it goes on
  UtcTime looked_;
  std::int64_t second_ = 0;  // in which the last file began
  int number_ = 0;           // of the last file in it
};

}  // namespace fieldcast
