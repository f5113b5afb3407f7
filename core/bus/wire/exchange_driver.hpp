// Drives one Exchange: its timers, its receive buffer, and the echo of the line. Owned by Wire, on
// the bus's thread; reused for each exchange.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/frame/line.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

enum class Echo : std::uint8_t { kUnknown, kAbsent, kPresent };

// Meaning of received bytes that equal the request, while it is unknown whether the line echoes.
enum class EqualBytes : std::uint8_t {
  kEcho,      // no response can equal the request
  kResponse,  // a write: the response
  kDoubtful,  // a read whose values can equal the request: an echo if other bytes follow
};

class ExchangeDriver {
 public:
  enum class Outcome : std::uint8_t { kWaiting, kSend, kDone, kFailed };

  // Limit of a response; more bytes fail the exchange with kOverlong.
  static constexpr std::size_t kMaxReceived = 8192;

  ExchangeDriver(const LineFormat& line, Duration gap_allowance, Echo echo)
      : line_(line), response_line_(line), gap_allowance_(gap_allowance), echo_(echo) {}

  // REQUIRES: !active().
  void begin(std::unique_ptr<Exchange> exchange, Duration timeout, EqualBytes equal, Instant now,
             Bytes& out);

  // With kSend, `out` is the next request; with kDone and kFailed it is a confirmation to send,
  // usually empty. After these two see exchange() and cause().
  Outcome on_bytes(ByteView bytes, Instant now, Bytes& out);
  // The same for a whole frame on a connection with several requests in flight. kWaiting: it
  // belongs to another request, and wait_on() must follow.
  Outcome on_frame(ByteView frame, Instant now, Bytes& out);
  Outcome on_timer(Instant now, Bytes& out);  // REQUIRES: now >= deadline()
  // The response counts only if no other bytes arrive until then: on_timer() returns `outcome`.
  // REQUIRES: `outcome`, the last one, is kDone or kFailed.
  void hold(Outcome outcome, Instant until) {
    held_ = outcome;
    deadline_ = until;
  }
  [[nodiscard]] bool holds() const { return active() && held_ != Outcome::kWaiting; }
  void abort() { exchange_.reset(); }
  void not_sent() {
    bytes_sent_ -= sent_.size();
    abort();
  }
  // The received bytes were not the response: waits with `again`, made for the same request.
  // REQUIRES: the last outcome was not kSend; `again` has not begun.
  void wait_on(std::unique_ptr<Exchange> again);
  // The same for the first `size` bytes. Returns the outcome of the other bytes.
  Outcome wait_on(std::unique_ptr<Exchange> again, std::size_t size, Instant now, Bytes& out);

  [[nodiscard]] bool active() const { return exchange_ != nullptr; }
  [[nodiscard]] Instant deadline() const { return deadline_; }
  [[nodiscard]] std::uint32_t missing() const { return active() ? missing_ : 0; }
  [[nodiscard]] const Exchange& exchange() const { return *exchange_; }
  std::unique_ptr<Exchange> finish() { return std::move(exchange_); }

  [[nodiscard]] Cause cause() const { return cause_; }
  // Whether the last outcome, `outcome`, is a response: values or a refusal.
  [[nodiscard]] bool got_response(Outcome outcome) const {
    const bool refused = cause_ == Cause::kDeviceError || cause_ == Cause::kDeviceBusy;
    return outcome == Outcome::kDone || (outcome == Outcome::kFailed && refused);
  }
  // The exchange failed because its frames ended, not because a byte contradicts the protocol.
  [[nodiscard]] bool ended_in_silence() const { return ended_in_silence_; }
  [[nodiscard]] std::uint16_t device_code() const { return device_code_; }
  [[nodiscard]] unsigned requests() const { return requests_; }
  // Whether no response is expected to the last request.
  [[nodiscard]] bool without_response() const { return without_response_; }
  // Rate of the response to the last request; 0: that of the line.
  [[nodiscard]] std::uint32_t response_baud() const {
    return response_line_.baud == line_.baud ? 0 : response_line_.baud;
  }
  // The line, with the rate of the response.
  [[nodiscard]] const LineFormat& response_line() const { return response_line_; }
  [[nodiscard]] Instant sent_from() const {
    return sent_until_ - line_.characters(static_cast<double>(sent_.size()));
  }
  // Latest time at which the last request left the wire.
  [[nodiscard]] Instant sent_until() const { return sent_until_; }
  // The same for the confirmation behind the response.
  [[nodiscard]] Instant confirmed_until() const { return std::max(sent_until_, confirmed_until_); }
  [[nodiscard]] Instant responded() const { return last_byte_; }
  // `raw_received` may contain an echo. Valid until the next begin().
  [[nodiscard]] ByteView sent() const { return sent_; }
  [[nodiscard]] ByteView raw_received() const { return received_; }
  // Computed from the last byte and the wire time, so that split responses do not affect it.
  [[nodiscard]] Duration response_time() const;
  // The same for a response after noise or foreign frames.
  [[nodiscard]] Duration response_began() const;
  // Bytes without the echo; empty while an echo may still arrive.
  [[nodiscard]] ByteView received() const { return echo_stripped_ ? received_ : ByteView{}; }
  // Characters of the whole response; 0 if unknown.
  [[nodiscard]] std::size_t expected() const { return expected_; }
  [[nodiscard]] bool enough_came() const { return expected_ > 0 && received().size() >= expected_; }
  // After kDone these bytes are unsolicited.
  [[nodiscard]] ByteView before_response() const {
    const ByteView all = received();
    return all.first(all.size() - std::min<std::size_t>(all.size(), expected_));
  }
  [[nodiscard]] Echo echo() const { return echo_; }
  [[nodiscard]] bool echo_alone() const {
    return echo_ == Echo::kPresent && echo_stripped_ && received_.empty();
  }
  [[nodiscard]] std::uint64_t bytes_sent() const { return bytes_sent_; }
  [[nodiscard]] std::uint64_t bytes_received() const { return bytes_received_; }
  void count_stray(std::size_t bytes) { bytes_received_ += bytes; }

 private:
  Outcome follow(const Step& step, Instant now, Bytes& out);
  void sending(const Step& step, Instant now, const Bytes& out);
  [[nodiscard]] bool strip_echo();  // returns false if the echo is incomplete

  LineFormat line_;
  LineFormat response_line_;  // line_, perhaps with the rate of the response
  Duration gap_allowance_;
  Echo echo_;
  EqualBytes equal_ = EqualBytes::kEcho;
  bool echo_stripped_ = false;
  std::unique_ptr<Exchange> exchange_;
  Duration timeout_{};
  unsigned requests_ = 0;
  bool without_response_ = false;
  bool ended_in_silence_ = false;
  Bytes sent_;
  Bytes received_;  // since the last send, without the echo
  Instant sent_until_{}, confirmed_until_ = kLongAgo;
  Instant response_deadline_{};  // for the first byte of the response
  Instant hard_deadline_{};      // for its last byte, even while other bytes arrive
  Instant deadline_ = kNever;
  Outcome held_ = Outcome::kWaiting;  // see hold()
  std::uint32_t missing_ = 0;
  std::uint32_t expected_ = 0;
  Instant last_byte_{};
  Cause cause_ = Cause::kNone;
  std::uint16_t device_code_ = 0;
  std::uint64_t bytes_sent_ = 0;
  std::uint64_t bytes_received_ = 0;
};

}  // namespace fieldcast
