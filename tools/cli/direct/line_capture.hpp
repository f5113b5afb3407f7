// What a command says on a line, in a file for Wireshark (--capture FILE): the same file as
// `fieldcast capture` makes of a bus of a bridge.
//
// Owns the file, which grows by whole frames: whatever ends the command, it can be read. Used on
// one thread; the tap takes from the thread of the bus.
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
  // A new file; one that is there is left alone. `bus`: its devices say which dissector takes their
  // frames. `command`: "fieldcast read". The error is one line.
  [[nodiscard]] static tl::expected<std::unique_ptr<LineCapture>, std::string> make(
      const std::string& path, const BusSpec& bus, const std::string& command);
  // The file is removed when no frame came.
  ~LineCapture() override;
  LineCapture(const LineCapture&) = delete;
  LineCapture& operator=(const LineCapture&) = delete;

  [[nodiscard]] const std::shared_ptr<CaptureTap>& tap() const { return tap_; }
  // Writes what came since the last call; often, as the tap has a limit.
  void write();
  // Writes the rest and the end. Why not all of it is in the file, on one line; nothing: it is.
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
  std::string fault_;  // the first; empty: none
  bool ended_ = false;
};

inline constexpr char kCaptureHelp[] =
    "Write what passes on the line into this new file, for Wireshark (x.pcapng)";

// Runs `work` of a command ("read") with a capture in the file `path`; with null where that is
// empty. `work` ends everything that uses the capture. The exit code of `work`; kTrouble when the
// file cannot be made, or not be written whole.
[[nodiscard]] ExitCode on_line(const std::string& path, const BusSpec& bus,
                               const std::string& command, std::ostream& err,
                               const std::function<ExitCode(LineCapture* capture)>& work);

}  // namespace fieldcast::cli
