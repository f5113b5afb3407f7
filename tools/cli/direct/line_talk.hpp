// Runs single exchanges on a port in the caller's thread, for a scan, with the engine's
// ExchangeDriver. Use it on one thread.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "bridge/capture/capture_tap.hpp"
#include "core/bus/exchange_driver.hpp"
#include "core/bus/garbage.hpp"
#include "core/model/port_spec.hpp"
#include "tools/cli/interrupt.hpp"

namespace fieldcast::cli {

struct LineNote {
  std::size_t device = 0;  // index on the captured bus
  std::string text;        // what is requested
};

class LineTalk {
 public:
  // Result of an exchange; `device_code` is set with Cause::kDeviceError.
  struct Answer {
    Cause cause = Cause::kNone;  // kNone: `reply` is valid
    std::uint16_t device_code = 0;
    Reply reply;
    Duration took{};                          // the device's own time before its answer
    std::size_t bytes = 0;                    // that came
    bool echo_alone = false;                  // they are exactly those that were sent
    bool heard = false;                       // see listen_again()
    AnswerShape shape = AnswerShape::kOther;  // of bytes that are not a valid answer
  };

  // Records all bytes in `tap`, which may be null.
  explicit LineTalk(const Interrupt& interrupt, std::shared_ptr<CaptureTap> tap = nullptr);
  ~LineTalk();  // calls close()
  LineTalk(const LineTalk&) = delete;
  LineTalk& operator=(const LineTalk&) = delete;

  // Closes the previous port first. The error is one human-readable line; empty if interrupted.
  [[nodiscard]] tl::expected<void, std::string> open(const PortSpec& port);
  // Waits for silence, sends, and waits for the response, whose first byte must arrive within
  // `timeout`. Fails like open() if the port is lost. REQUIRES: open() was successful.
  [[nodiscard]] tl::expected<Answer, std::string> ask(std::unique_ptr<Exchange> exchange,
                                                      Duration timeout, const LineNote& note = {});
  // From here on Answer::heard says whether bytes were received, at any time, that are not the echo
  // of what was sent.
  void listen_again();
  // Called several times a second while it waits: for the progress.
  void while_waiting(std::function<void()> meanwhile);
  // Keeps the line idle for this time, or until an interrupt. REQUIRES: open() was successful.
  void rest(Duration time);
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::cli
