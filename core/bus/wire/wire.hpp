// Load of one bus: totals and a mark for each report of the last ten seconds. Owned by the bus
// engine, on the bus's thread.
#pragma once

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>

#include "core/base/time.hpp"
#include "core/bus/setup/bus_setup.hpp"
#include "core/bus/wire/exchange_driver.hpp"
#include "core/bus/wire/pending_responses.hpp"
#include "core/bus/wire/silence_learning.hpp"

namespace fieldcast {

class WireLoad {
 public:
  static constexpr Duration kWindow = std::chrono::seconds{10};  // for the share of reads
  // Reports at state changes are closer together and set no mark.
  static constexpr Duration kMarkGap = std::chrono::milliseconds{900};

  // Shares of time, 0..1.
  struct Shares {
    double busy = 0;     // since the last mark: exchanges with their silences
    double reading = 0;  // over the window: reads of the plan
  };

  void ended(Duration spent, bool read) {
    busy_ += spent;
    if (read) reading_ += spent;
  }
  // `running`: time of the exchange in flight so far; zero if none.
  [[nodiscard]] Shares report(Duration running, bool read, Instant now) {
    const Mark mark{now, busy_ + running, reading_ + (read ? running : Duration::zero())};
    Shares shares;
    if (!marks_.empty()) {
      shares.busy = share(mark.busy - marks_.back().busy, now - marks_.back().at);
      shares.reading = share(mark.reading - marks_.front().reading, now - marks_.front().at);
    }
    if (marks_.empty() || now - marks_.back().at >= kMarkGap) marks_.push_back(mark);
    while (now - marks_.front().at > kWindow) marks_.pop_front();
    return shares;
  }

 private:
  struct Mark {
    Instant at{};
    Duration busy{}, reading{};
  };
  static double share(Duration part, Duration whole) {
    return whole > Duration::zero() ? std::min(1.0, to_seconds(part) / to_seconds(whole)) : 0.0;
  }

  Duration busy_{}, reading_{};
  std::deque<Mark> marks_;
};

// One exchange in flight, the time when the next one may follow, and the load. A bus has one wire,
// or several on a connection with requests in flight (BusSpec::in_flight). At most one flight;
// bytes are sent only through it. After an exchange the wire stays silent for the line's silence.
// Owned by the bus engine, on the bus's thread.

// An exchange from its first request to its last try.
struct Flight {
  enum class Kind : std::uint8_t { kRead, kCommand, kProbe };
  Kind kind = Kind::kRead;
  Asked asked;               // context and sent_until are those of the last try
  Block block;               // for kRead: the values requested
  bool longer = false;       // for kRead: requests more than the block
  std::size_t batch = 1;     // for kCommand: number of commands in the request
  bool spare_time = false;   // for kCommand: see Command::in_spare_time()
  Duration timeout{};        // for kProbe: time that can be spared
  Instant started{};         // first try
  Duration idle{};           // time since then between tries, and while this process was suspended
  unsigned tries = 0;        // failed tries
  bool no_response = false;  // a try got no response: the next bytes may be it
  Duration rest{};           // between the device's last response and the last try

  [[nodiscard]] bool is_command() const { return kind == Kind::kCommand; }
};

class Wire {
 public:
  // Limit of the time for which unsolicited bytes block the wire.
  static constexpr Duration kLongestStray = std::chrono::milliseconds{300};
  static constexpr Duration kNotSentRest = std::chrono::milliseconds{20};

  struct Ended {
    bool done = false;
    bool responded = false;         // with values or with a refusal
    bool without_response = false;  // `done`, and no response was expected
    Cause cause = Cause::kNone;
    std::uint16_t device_code = 0;
    std::unique_ptr<Exchange> exchange;  // contains the reply if `done`
    Duration spent{};                    // wire time of all tries, with silences
  };
  struct Send {
    ExchangeContext context;
    Duration timeout{};
    Duration rest{};  // between the device's last response and now
  };

  // Both must outlive the wire. `session`: of the connection, see ExchangeContext.
  Wire(const BusSetup& setup, Bytes& session);

  // REQUIRES: no flight.
  void launch(Flight flight);
  [[nodiscard]] Bytes send(const Send& with, Instant now);
  // REQUIRES: exchanging().
  ExchangeDriver::Outcome on_bytes(ByteView bytes, Instant now, Bytes& out);
  // kWaiting: the frame belongs to another request.
  ExchangeDriver::Outcome on_frame(ByteView frame, Instant now, Bytes& out);
  ExchangeDriver::Outcome on_timer(Instant now, Bytes& out);
  // The bytes were not the response: the wait continues without them. REQUIRES: the last outcome
  // was not kSend.
  void wait_on();
  // The same for the first `size` bytes. Returns the outcome of the other bytes.
  ExchangeDriver::Outcome wait_on(std::size_t size, Instant now, Bytes& out);
  // See ExchangeDriver::hold().
  void hold(ExchangeDriver::Outcome outcome, Instant until) { driver_.hold(outcome, until); }
  // Call after kDone or kFailed. The flight is kept until repeat() or take().
  [[nodiscard]] Ended conclude(bool done, Instant now);
  void repeat();
  [[nodiscard]] Flight take();
  std::optional<Flight> abort();
  // No response is pending; the wire rests for a moment. REQUIRES: first_request().
  [[nodiscard]] Flight not_sent(Instant now);
  [[nodiscard]] bool first_request() const {
    return exchanging() && flight_->tries == 0 && driver_.requests() == 1;
  }
  // Discards the flight that waits to be repeated.
  void drop() { flight_.reset(); }

  // The line must become silent before it is used.
  void count_stray(std::size_t bytes) { driver_.count_stray(bytes); }
  void stray(Instant now);
  void opened(Instant now) { free_at_ = now + setup_.silence(); }
  void rest_until(Instant until) { free_at_ = std::max(free_at_, until); }
  // Between a response and the next request: configured, or learned.
  [[nodiscard]] Duration silence() const {
    return learning_ ? learning_->silence() : setup_.silence();
  }

  // By which the learned silence is shorter than that of the plan.
  [[nodiscard]] Duration saved_silence() const { return setup_.silence() - silence(); }

  [[nodiscard]] bool exchanging() const { return driver_.active(); }
  [[nodiscard]] bool waiting() const { return flight_.has_value() && !driver_.active(); }
  // REQUIRES: exchanging() or waiting().
  [[nodiscard]] const Flight& flight() const { return *flight_; }
  [[nodiscard]] const ExchangeDriver& driver() const { return driver_; }
  [[nodiscard]] Instant free_at() const { return free_at_; }

  [[nodiscard]] std::uint64_t exchanges() const { return exchanges_; }
  [[nodiscard]] WireLoad::Shares shares(Instant now);

 private:
  void look(Instant now);

  const BusSetup& setup_;
  ExchangeDriver driver_;
  Bytes& session_;
  std::optional<Flight> flight_;
  Instant free_at_ = kLongAgo;
  std::optional<SilenceLearning> learning_;
  Instant ended_ = kLongAgo;       // the last exchange, without its silence
  Duration rest_{};                // between it and the request
  Instant strays_since_ = kNever;  // while they keep the wire from being free
  std::uint64_t exchanges_ = 0;
  WireLoad load_;
  Duration spent_{};         // since the first try, when the last one ended
  Instant looked_ = kNever;  // last event of the exchange
};

}  // namespace fieldcast
