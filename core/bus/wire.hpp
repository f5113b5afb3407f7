// The wire of one bus: the one exchange that is on it, when it is free again, and how busy it is.
//
// Owns the exchange driver, the flight, and the counters of exchanges and wire time. Owned by the
// bus engine, on the bus's thread. Invariants: at most one flight; bytes are sent only through it;
// after an exchange the wire stays silent for the line's silence. Nothing can fail here: what fails
// is the exchange, and its cause is in Ended.
#pragma once

#include <memory>
#include <optional>

#include "core/bus/bus_setup.hpp"
#include "core/bus/exchange_driver.hpp"
#include "core/bus/owed_answers.hpp"
#include "core/bus/wire_load.hpp"

namespace fieldcast {

// An exchange from its first request to its last try.
struct Flight {
  enum class Kind : std::uint8_t { kRead, kCommand, kProbe };
  Kind kind = Kind::kRead;
  Asked asked;              // its context and sent_until are those of the last try
  Block block;              // kRead: what the request brings
  bool longer = false;      // kRead: the request asks for more than the block
  std::size_t batch = 1;    // kCommand: how many commands the request carries
  Duration timeout{};       // kProbe: what can be spared
  Instant started{};        // the first try
  Duration idle{};          // since then: between tries, and while this process stood still
  unsigned tries = 0;       // that failed
  bool unanswered = false;  // a try got no answer: what comes now may be it
  Duration rest{};          // between the device's last answer and the last try

  [[nodiscard]] bool is_command() const { return kind == Kind::kCommand; }
};

class Wire {
 public:
  // Bytes that nobody asked for keep the wire from being free, but for no longer than this.
  static constexpr Duration kLongestStray = std::chrono::milliseconds{300};
  // After a request that could not leave.
  static constexpr Duration kNotSentRest = std::chrono::milliseconds{20};

  // How a try ended.
  struct Ended {
    bool done = false;
    bool answered = false;  // by the values or by a refusal
    Cause cause = Cause::kNone;
    std::uint16_t device_code = 0;
    std::unique_ptr<Exchange> exchange;  // its reply, when done
    Duration spent{};                    // wire time of all tries, with silences
  };
  struct Send {
    ExchangeContext context;
    Duration timeout{};
    Duration rest{};  // between the device's last answer and now
  };

  explicit Wire(const BusSetup& setup);  // setup outlives the wire

  // REQUIRES: no flight. The flight waits to be sent.
  void launch(Flight flight);
  // Sends the flight that waits: returns the bytes.
  [[nodiscard]] Bytes send(const Send& with, Instant now);
  // As the driver's. REQUIRES: exchanging().
  ExchangeDriver::Outcome on_bytes(ByteView bytes, Instant now, Bytes& out);
  ExchangeDriver::Outcome on_timer(Instant now, Bytes& out);
  // What came was not the answer: the wait goes on. REQUIRES: the last outcome was kDone.
  void wait_on();
  // The last outcome was kDone or kFailed. The flight is kept until repeat() or take().
  [[nodiscard]] Ended conclude(bool done, Instant now);
  void repeat();
  [[nodiscard]] Flight take();
  // Ends the exchange from outside, if there is one.
  std::optional<Flight> abort();
  // Ends the exchange whose only request did not leave: nobody owes an answer. The wire rests for a
  // moment, so that who cannot send does not try all the time. REQUIRES: first_request().
  [[nodiscard]] Flight not_sent(Instant now);
  // An exchange is under way, and its first request is the last thing that was sent.
  [[nodiscard]] bool first_request() const {
    return exchanging() && flight_->tries == 0 && driver_.requests() == 1;
  }
  // The flight waits to be sent again, and that is not needed any more.
  void drop() { flight_.reset(); }

  // Bytes came while nobody was asked. The line must fall silent before it is used.
  void count_stray(std::size_t bytes) { driver_.count_stray(bytes); }
  void stray(Instant now);
  // The port was opened.
  void opened(Instant now) { free_at_ = now + setup_.silence(); }

  // An answer may be on its way.
  [[nodiscard]] bool exchanging() const { return driver_.active(); }
  // A flight is to be sent, for the first time or again.
  [[nodiscard]] bool waiting() const { return flight_.has_value() && !driver_.active(); }
  // REQUIRES: exchanging() or waiting().
  [[nodiscard]] const Flight& flight() const { return *flight_; }
  [[nodiscard]] const ExchangeDriver& driver() const { return driver_; }
  // The wire must be silent until then.
  [[nodiscard]] Instant free_at() const { return free_at_; }

  [[nodiscard]] std::uint64_t exchanges() const { return exchanges_; }
  // For a report, once a second.
  [[nodiscard]] WireLoad::Shares shares(Instant now);

 private:
  void look(Instant now);

  const BusSetup& setup_;
  ExchangeDriver driver_;
  std::optional<Flight> flight_;
  Instant free_at_ = kLongAgo;
  Instant strays_since_ = kNever;  // while they keep the wire from being free
  std::uint64_t exchanges_ = 0;
  WireLoad load_;
  Duration spent_{};         // since the first try, when the last one ended
  Instant looked_ = kNever;  // the last event of the exchange
};

}  // namespace fieldcast
