// Runs single exchanges on a port, one after the other, in the caller's thread: what a scan needs,
// where the engine would plan, learn and probe. Timeouts, echo and frames are those of the engine's
// own ExchangeDriver.
//
// Used on one thread.
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

// What a capture says of an exchange.
struct LineNote {
  std::size_t device = 0;  // of the bus that is captured
  std::string text;        // what is asked
};

class LineTalk {
 public:
  // What came of an exchange. `device_code` with Cause::kDeviceError.
  struct Answer {
    Cause cause = Cause::kNone;  // kNone: `reply` holds
    std::uint16_t device_code = 0;
    Reply reply;
    Duration took{};                          // the device's own time before its answer
    std::size_t bytes = 0;                    // that came
    bool echo_alone = false;                  // they are exactly those that were sent
    bool heard = false;                       // see listen_again()
    AnswerShape shape = AnswerShape::kOther;  // of bytes that are not a valid answer
  };

  // What passes goes into the tap, where there is one; null: nobody captures.
  explicit LineTalk(const Interrupt& interrupt, std::shared_ptr<CaptureTap> tap = nullptr);
  ~LineTalk();  // close()
  LineTalk(const LineTalk&) = delete;
  LineTalk& operator=(const LineTalk&) = delete;

  // Closes what was open. The error says why the port does not open, a text line for people; it is
  // empty when the interrupt was raised.
  [[nodiscard]] tl::expected<void, std::string> open(const PortSpec& port);
  // Waits for silence on the line before it sends, and for the answer, at most `timeout` to its
  // first byte. The error as of open(): the port is gone. REQUIRES: open() was successful.
  [[nodiscard]] tl::expected<Answer, std::string> ask(std::unique_ptr<Exchange> exchange,
                                                      Duration timeout, const LineNote& note = {});
  // From here on Answer::heard says whether bytes were received, at any time, that are not the echo
  // of what was sent.
  void listen_again();
  // Called several times a second while it waits: for the progress.
  void while_waiting(std::function<void()> meanwhile);
  // Leaves the line alone for so long; less when the interrupt is raised. REQUIRES: as ask().
  void rest(Duration time);
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::cli
