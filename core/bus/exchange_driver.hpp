// Drives one Exchange: its timers, its receive buffer, and the echo of the line. Knows nothing of
// devices, blocks or commands.
//
// Owns the exchange under way, its bytes, and what is known of the line's echo. Owned by the Wire
// of a bus engine, on the bus's thread; reused for one exchange after the other. What can fail is
// the exchange: see cause().
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/frame/line.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

// Whether the line gives back what is sent.
enum class Echo : std::uint8_t { kUnknown, kAbsent, kPresent };

class ExchangeDriver {
 public:
  enum class Outcome : std::uint8_t { kWaiting, kSend, kDone, kFailed };

  // No answer is longer than this; what comes beyond fails the exchange with kOverlong.
  static constexpr std::size_t kMaxReceived = 8192;

  ExchangeDriver(const LineFormat& line, Duration gap_allowance, Echo echo)
      : line_(line), gap_allowance_(gap_allowance), echo_(echo) {}

  // REQUIRES: !active(). Fills out with the first request. echo_is_distinct: no answer of this
  // exchange can equal its request, so that an echo may be learned from it.
  void begin(std::unique_ptr<Exchange> exchange, Duration timeout, bool echo_is_distinct,
             Instant now, Bytes& out);

  // With kSend, out is the next request. After kDone or kFailed the driver is over: see exchange(),
  // cause().
  Outcome on_bytes(ByteView bytes, Instant now, Bytes& out);
  Outcome on_timer(Instant now, Bytes& out);  // REQUIRES: now >= deadline()
  void abort() { exchange_.reset(); }
  // The last request did not leave: the exchange is over.
  void not_sent() {
    bytes_sent_ -= sent_.size();
    abort();
  }
  // What has come was not the answer: the wait goes on with an exchange that has received nothing.
  // REQUIRES: the last outcome was kDone; `again` was made for the same request and has not begun.
  void wait_on(std::unique_ptr<Exchange> again);

  [[nodiscard]] bool active() const { return exchange_ != nullptr; }
  [[nodiscard]] Instant deadline() const { return deadline_; }
  // Characters that the answer under way lacks, at least; 0 when that is not known.
  [[nodiscard]] std::uint32_t missing() const { return active() ? missing_ : 0; }
  [[nodiscard]] const Exchange& exchange() const { return *exchange_; }
  std::unique_ptr<Exchange> finish() { return std::move(exchange_); }

  [[nodiscard]] Cause cause() const { return cause_; }
  [[nodiscard]] std::uint16_t device_code() const { return device_code_; }
  // Of the exchange, sent so far.
  [[nodiscard]] unsigned requests() const { return requests_; }
  // The last request has left the wire by then.
  [[nodiscard]] Instant sent_until() const { return sent_until_; }
  // Arrival of the last byte.
  [[nodiscard]] Instant answered() const { return last_byte_; }
  // What was sent last, and what came since, with what may still be an echo. Valid until the next
  // begin().
  [[nodiscard]] ByteView sent() const { return sent_; }
  [[nodiscard]] ByteView raw_received() const { return received_; }
  // The device's own time before its answer: arrival of the last byte less the wire time of request
  // and answer. Does not depend on how adapters cut the answer into pieces.
  [[nodiscard]] Duration answer_time() const;
  // The same for an answer that comes after noise or foreign frames.
  [[nodiscard]] Duration answer_began() const;
  // Since the last send, echo taken away; empty while an echo may still be on its way.
  [[nodiscard]] ByteView received() const { return echo_stripped_ ? received_ : ByteView{}; }
  // Characters of the whole answer; 0: not known.
  [[nodiscard]] std::size_t expected() const { return expected_; }
  // As many characters as the answer has, at least.
  [[nodiscard]] bool enough_came() const { return expected_ > 0 && received().size() >= expected_; }
  // What came before an answer of the expected length. After kDone: nothing that was asked for.
  [[nodiscard]] ByteView before_answer() const {
    const ByteView all = received();
    return all.first(all.size() - std::min<std::size_t>(all.size(), expected_));
  }
  [[nodiscard]] Echo echo() const { return echo_; }
  // What came since the last send is exactly what was sent.
  [[nodiscard]] bool echo_alone() const {
    return echo_ == Echo::kPresent && echo_stripped_ && received_.empty();
  }
  [[nodiscard]] std::uint64_t bytes_sent() const { return bytes_sent_; }
  [[nodiscard]] std::uint64_t bytes_received() const { return bytes_received_; }
  void count_stray(std::size_t bytes) { bytes_received_ += bytes; }

 private:
  Outcome follow(const Step& step, Instant now, Bytes& out);
  void sending(const Step& step, Instant now, const Bytes& out);
  [[nodiscard]] bool strip_echo();  // false: the echo is still on its way

  LineFormat line_;
  Duration gap_allowance_;
  Echo echo_;
  bool echo_is_distinct_ = true;
  bool echo_stripped_ = false;
  std::unique_ptr<Exchange> exchange_;
  Duration timeout_{};
  unsigned requests_ = 0;
  Bytes sent_;
  Bytes received_;  // since the last send, echo taken away
  Instant sent_until_{};
  Instant answer_deadline_{};  // for the first byte of the answer
  Instant hard_deadline_{};    // for its last byte, even while others keep coming
  Instant deadline_ = kNever;
  std::uint32_t missing_ = 0;
  std::uint32_t expected_ = 0;  // characters of the whole answer
  Instant last_byte_{};
  Cause cause_ = Cause::kNone;
  std::uint16_t device_code_ = 0;
  std::uint64_t bytes_sent_ = 0;
  std::uint64_t bytes_received_ = 0;
};

}  // namespace fieldcast
