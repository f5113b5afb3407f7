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
#include "bridge/capture/capture_ring.hpp"
#include "core/bus/health/garbage.hpp"
#include "core/bus/wire/exchange_driver.hpp"
#include "core/model/port_spec.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

class LineCapture final : private CaptureSink {
 public:
  // Never replaces a file. `bus`: its devices select the dissectors. `command`: "fieldcast read".
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

  void packet(ByteView block, UtcTime at, bool session) override;
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

struct LineEvent {
  std::size_t device = 0;  // index on the captured bus
  std::string text;        // what is requested
};

// Runs single exchanges on a port in the caller's thread, for a scan, with the engine's
// ExchangeDriver. Use it on one thread.
class LineExchange {
 public:
  // Result of an exchange; `device_code` is set with Cause::kDeviceError.
  struct Response {
    Cause cause = Cause::kNone;  // kNone: `reply` is valid
    std::uint16_t device_code = 0;
    Reply reply;
    Duration took{};                              // response time of the device
    std::size_t bytes = 0;                        // received
    bool echo_alone = false;                      // the received bytes equal the sent ones
    bool heard = false;                           // see listen_again()
    ResponseShape shape = ResponseShape::kOther;  // if the bytes are not a valid response
  };

  // Records all bytes in `tap`, which may be null.
  explicit LineExchange(const Interrupt& interrupt, std::shared_ptr<CaptureTap> tap = nullptr);
  ~LineExchange();  // calls close()
  LineExchange(const LineExchange&) = delete;
  LineExchange& operator=(const LineExchange&) = delete;

  // Closes the previous port first. The error is one human-readable line; empty if interrupted.
  [[nodiscard]] tl::expected<void, std::string> open(const PortSpec& port);
  // Waits for silence, sends, and waits for the response, whose first byte must arrive within
  // `timeout`. Fails like open() if the port is lost. REQUIRES: open() was successful.
  [[nodiscard]] tl::expected<Response, std::string> ask(std::unique_ptr<Exchange> exchange,
                                                        Duration timeout,
                                                        const LineEvent& note = {});
  // Restarts the detection for Response::heard: bytes received since this call, without an echo.
  void listen_again();
  // Calls `meanwhile` several times a second during waits, for the progress.
  void while_waiting(std::function<void()> meanwhile);
  // Keeps the line idle for this time, or until an interrupt. REQUIRES: open() was successful.
  void rest(Duration time);
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::cli
