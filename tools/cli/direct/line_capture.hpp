// Writes the frames of a command to a file for Wireshark (--capture FILE), in the same format as
// `fieldcast capture`.
//
// Owns the file, which is readable after each frame, however the command ends. Use it on one
// thread; the tap accepts records from the bus thread.
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "bridge/capture/bus_capture.hpp"
#include "bridge/capture/capture_file.hpp"
#include "tools/cli/exit_code.hpp"

namespace fieldcast::cli {

class LineCapture final : private CaptureSink {
 public:
  // Creates a new file; never replaces one. `bus`: its devices select the dissectors. `command`:
  // "fieldcast read". The error is one line.
  [[nodiscard]] static tl::expected<std::unique_ptr<LineCapture>, std::string> make(
      const std::string& path, const BusSpec& bus, const std::string& command);
  // Removes the file if it has no frame.
  ~LineCapture() override;
  LineCapture(const LineCapture&) = delete;
  LineCapture& operator=(const LineCapture&) = delete;

  [[nodiscard]] const std::shared_ptr<CaptureTap>& tap() const { return tap_; }
  // Writes the records since the last call. Call it often, because the tap has a limit.
  void write();
  // Writes the rest and the end. Returns one line if the file is incomplete; else empty.
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

// Runs `work` of a command ("read") with a capture to `path`, or with null if that is empty. `work`
// must destroy all users of the capture. Returns its exit code, or kTrouble if the file cannot be
// written completely.
[[nodiscard]] ExitCode on_line(const std::string& path, const BusSpec& bus,
                               const std::string& command, std::ostream& err,
                               const std::function<ExitCode(LineCapture* capture)>& work);

}  // namespace fieldcast::cli
