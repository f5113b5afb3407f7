// Listen before talk: whether this bridge may send on a wire that it shares with another bridge of
// its standby group, or with any other master (`fence: listen`).
//
// There are two states. While listening, the bridge sends no request; after FenceTimes::listen of
// silence it may take the wire. While holding, it sends at least one request in each
// FenceTimes::hold, so that listeners hear it. It loses the wire and listens again,
//   - when it hears a request of another master,
//   - when it was silent for longer than FenceTimes::claim (suspended, or leased),
//   - when it heard no byte for a while: the cable may be cut, with another master behind it,
//   - when bytes break the first exchanges: another bridge started at the same time. Both stop and
//     start again after different delays.
//
// With `fence: lock` and `one-client`, a bridge that has opened the port waits until the last
// device polled by another bridge has responded. Without a fence, may_send() always allows. Owned
// by the bus engine, on the bus's thread.
#pragma once

#include <cstdint>
#include <string>

#include "core/bus/wire/fence_setup.hpp"

namespace fieldcast {

class WireFence {
 public:
  static constexpr unsigned kRanks = 8;
  // Limit of the delay by noise, in FenceTimes::listen: a line without bias is never silent.
  static constexpr int kMostNoise = 10;
  // After this many FenceTimes::listen without a byte, this end may be cut off.
  static constexpr int kDeaf = 2;
  static constexpr std::size_t kKept = 512;  // unsolicited bytes kept
  // A request that could be a response counts only if repeated this often within kDoubtFor.
  static constexpr unsigned kEnoughDoubtful = 3;
  static constexpr Duration kDoubtFor = std::chrono::seconds{1};

  explicit WireFence(const BusSpec& bus);

  // The lowest rank starts first. `seed` must differ between bridges: it varies the delays.
  void set_order(unsigned rank, std::uint64_t seed);

  [[nodiscard]] bool on() const { return on_; }
  [[nodiscard]] bool listening() const { return on_ && !holding_; }
  [[nodiscard]] const FenceTimes& times() const { return times_; }

  // The port was opened, or returned after a lease.
  void opened(Instant now);

  // Before a request:
  [[nodiscard]] bool may_send(Instant now);
  // REQUIRES: may_send() was false.
  [[nodiscard]] Instant look_again(Instant now) const;
  [[nodiscard]] bool keeps(Instant now) const;
  // Returns true if another master had the wire before.
  bool sending(ByteView request, Instant until);
  void not_sent(Instant now);
  // Earliest and latest time of a read that lets others hear this bridge. REQUIRES: may_send().
  [[nodiscard]] Instant sign_from() const;
  [[nodiscard]] Instant sign_due() const;
  void no_sign(Instant now) { no_sign_before_ = now + times_.hold / 4; }

  // After a request:

  // `echo`: the bytes may be only the echo.
  void bytes_came(bool echo, Instant now);
  // Returns true if another master sends; once for each time that it uses the wire.
  [[nodiscard]] bool stray(ByteView bytes, Instant now);
  // First response since the wire was taken. `began`: after the end of the request. Returns true if
  // it is negative: another master may have taken the wire at the same time and got the response.
  // Then the wait continues. Returns true once per takeover, as a line may not keep its baud rate.
  [[nodiscard]] bool doubts_first(Duration began, Duration character);
  // `bytes`: before the response. Returns true, as stray(), if another master sent a request.
  [[nodiscard]] bool came_between(ByteView bytes, Instant now);
  // `received`: the bytes of the exchange without an echo. Returns true as stray().
  [[nodiscard]] bool ended(bool responded, ByteView received, Instant now);

  [[nodiscard]] std::uint64_t foreign_masters() const { return foreign_masters_; }
  // Describes the other master's frame.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void listen_from(Instant silent_since, Instant now);
  void lapse(Instant now);
  void heard(Instant now);
  [[nodiscard]] Instant slot_from(Instant now) const;
  [[nodiscard]] bool believe(const RequestFinder::Found& found, Instant now);
  [[nodiscard]] bool own(ByteView frame) const;
  [[nodiscard]] bool find_foreign(ByteView bytes, Instant now);
  [[nodiscard]] bool take_foreign(ByteView frame, Instant now);

  const bool on_;
  const bool waits_;  // only after opening
  const FenceTimes times_;
  const RequestFinder finder_;
  unsigned rank_ = 0;
  std::uint64_t random_ = 1;

  bool holding_ = false;
  // While listening:
  Instant silent_since_ = kLongAgo;
  Instant noise_since_ = kLongAgo;  // no whole frame since then
  Bytes burst_;                     // bytes without a longer pause
  bool told_ = false;               // the other master was reported
  // While holding:
  bool cut_off_ = false;           // no byte was heard for long
  bool confirmed_ = false;         // an exchange got a response
  bool doubted_ = false;           // the first response was doubted
  Instant busy_until_ = kLongAgo;  // others could hear bytes until then
  Instant heard_ = kLongAgo;       // from others
  Bytes sent_, response_;          // last ones
  unsigned doubtful_ = 0;          // requests that could be responses
  Instant doubtful_since_ = kLongAgo;
  // Always:
  Instant not_before_ = kLongAgo;  // for the next request
  Instant last_byte_ = kLongAgo;
  Bytes strays_;
  Instant last_stray_ = kLongAgo;
  Instant no_sign_before_ = kLongAgo;
  std::uint64_t foreign_masters_ = 0;
  std::string text_;
};

}  // namespace fieldcast
