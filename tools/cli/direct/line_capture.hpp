// Writes the frames of a command for Wireshark (--capture FILE) as `fieldcast capture` does. Owns
// the file, which is readable after each frame. Use it on one thread; the tap accepts records from
// the bus thread.
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "bridge/capture/bus_capture.hpp"
#include "bridge/capture/capture_file.hpp"
#include "tools/cli/text/exit_code.hpp"

namespace fieldcast::cli {

class LineCapture final : private CaptureSink {
 public:
  // Never replaces a file. `bus`: its devices select the dissectors. `command`: "fieldcast read".
  // The error is one line.
  [[nodiscard]] static tl::expected<std::unique_ptr<LineCapture>, std::string> make(
      const std::string& path, const BusSpec& bus, const std::string& command);
  // Removes the file if it has no frame.
  ~LineCapture() override;
  LineCapture(const LineCapture&) = delete;
  LineCapture& operator=(const LineCapture&) = delete;

  [[nodiscard]] const std::shared_ptr<CaptureTap>& tap() const { return tap_; }
  // Writes the records since the last call. Call it often, because the tap has a limit.
  void write();
  // Returns one line if the file is incomplete.
  [[nodiscard]] std::optional<std::string> end();

 private:
  LineCapture(CaptureFile file, const BusSpec& bus, const std::string& command);

  void packet(ByteView block, UtcTime at) override;
  void lost(std::uint64_t records) override { counts_.dropped += records; }
  void append(ByteView blocks);

  CaptureFile file_;
  const std::shared_ptr<CaptureTap> tap_ = std::make_shared<CaptureTap>();
  BusCapture capture_;
  CaptureCounts counts_;
  std::string fault_;  // the first fault; empty: none
  bool ended_ = false;
};

inline constexpr char kCaptureHelp[] =
    "Write what passes on the line into this new file, for Wireshark (x.pcapng)";

// `work` gets null if `path` is empty; it must destroy all users of the capture. Returns its exit
// code, or kTrouble if the file is incomplete.
[[nodiscard]] ExitCode on_line(const std::string& path, const BusSpec& bus,
                               const std::string& command, std::ostream& err,
                               const std::function<ExitCode(LineCapture* capture)>& work);

}  // namespace fieldcast::cli
