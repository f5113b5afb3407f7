// Listen before talk: whether this bridge may send on a wire at which another bridge of its standby
// group, or any other master, may stand (`fence: listen`).
//
// Two states. While listening nothing is sent; after FenceTimes::listen of silence the wire may be
// taken. While holding, requests are sent, and at least one in each FenceTimes::hold, so that who
// listens hears it. The wire is lost, and listened to again,
//   - when a request of another master is heard,
//   - when this bridge was silent for longer than FenceTimes::claim (it was stopped, or leased),
//   - when nothing at all was heard for a while: the cable may be cut, with another one behind it,
//   - when bytes break the first exchanges: another one began at the same instant. Both let go, and
//     begin again after delays of their own.
//
// With `fence: lock` and `one-client` a bridge that has opened the port waits until the device that
// another bridge asked last has answered: its answer is not ours. Without a fence everything is
// allowed.
//
// Owned by the bus engine, on the bus's thread. Nothing can fail.
#pragma once

#include <cstdint>
#include <string>

#include "core/bus/fence_times.hpp"
#include "core/bus/request_finder.hpp"

namespace fieldcast {

class WireFence {
 public:
  static constexpr unsigned kRanks = 8;
  // Bytes in which no frame can be found delay a beginning by this many FenceTimes::listen at most:
  // a line without bias is never silent.
  static constexpr int kMostNoise = 10;
  // Nothing was heard for this many FenceTimes::listen: this end may be cut off.
  static constexpr int kDeaf = 2;
  static constexpr std::size_t kKept = 512;  // of the bytes that nobody asked for
  // Requests that could be answers, within kDoubtFor, until they are believed.
  static constexpr unsigned kEnoughDoubtful = 3;
  static constexpr Duration kDoubtFor = std::chrono::seconds{1};

  explicit WireFence(const BusSpec& bus);

  // Who goes first of bridges that would begin at the same instant: the lowest rank. `seed` differs
  // between them: what they do after a collision follows from it.
  void set_order(unsigned rank, std::uint64_t seed);

  [[nodiscard]] bool on() const { return on_; }
  [[nodiscard]] bool listening() const { return on_ && !holding_; }
  [[nodiscard]] const FenceTimes& times() const { return times_; }

  // The port was opened, or is given back after a lease.
  void opened(Instant now);

  // ---- before a request

  [[nodiscard]] bool may_send(Instant now);
  // When may_send() can become true. REQUIRES: it was false.
  [[nodiscard]] Instant look_again(Instant now) const;
  // An exchange that is under way may send its next request.
  [[nodiscard]] bool keeps(Instant now) const;
  // A request leaves the wire by `until`. True: the wire was another master's before.
  bool sending(ByteView request, Instant until);
  // It did not leave after all.
  void not_sent(Instant now);
  // From when on, and by when, the bridge should make itself heard. REQUIRES: may_send().
  [[nodiscard]] Instant sign_from() const;
  [[nodiscard]] Instant sign_due() const;
  // There was nothing to make itself heard with.
  void no_sign(Instant now) { no_sign_before_ = now + times_.hold / 4; }

  // ---- after it

  // Bytes came. `echo`: perhaps only what this bridge sent.
  void bytes_came(bool echo, Instant now);
  // They came while nobody was asked, and are no late answer. True: another master speaks. That is
  // told once for each time that it takes the wire.
  [[nodiscard]] bool stray(ByteView bytes, Instant now);
  // The first answer since the wire was taken; `began`: after the end of its request. True: that is
  // below zero, as if another one had taken the wire at the same instant and was answered. The wait
  // goes on. Once for each time that the wire is taken: a line may not keep to its baud rate.
  [[nodiscard]] bool doubts_first(Duration began, Duration character);
  // An answer came, and these bytes between the request and the answer. True as above: another
  // master has asked meanwhile, and the answer may be for that one.
  [[nodiscard]] bool came_between(ByteView bytes, Instant now);
  // An exchange ended. `received`: what came, of which nothing belongs to an echo. True as above.
  [[nodiscard]] bool ended(bool answered, ByteView received, Instant now);

  [[nodiscard]] std::uint64_t foreign_masters() const { return foreign_masters_; }
  // "another master speaks on the wire: 01 03 00 64 00 02 85 D4"
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
  const bool waits_;  // after the opening alone
  const FenceTimes times_;
  const RequestFinder finder_;
  unsigned rank_ = 0;
  std::uint64_t random_ = 1;

  bool holding_ = false;
  // While listening.
  Instant silent_since_ = kLongAgo;
  Instant noise_since_ = kLongAgo;  // no whole frame came since then
  Bytes burst_;                     // bytes without a longer pause between them
  bool told_ = false;               // the other master
  // While holding.
  bool cut_off_ = false;           // perhaps: nobody was heard for long
  bool confirmed_ = false;         // an exchange was answered
  bool doubted_ = false;           // the first answer was
  Instant busy_until_ = kLongAgo;  // others could hear something until then
  Instant heard_ = kLongAgo;       // of somebody else
  Bytes sent_, answer_;            // the last ones
  unsigned doubtful_ = 0;          // requests that could be answers
  Instant doubtful_since_ = kLongAgo;
  // Always.
  Instant not_before_ = kLongAgo;  // the next request
  Instant last_byte_ = kLongAgo;
  Bytes strays_;
  Instant last_stray_ = kLongAgo;
  Instant no_sign_before_ = kLongAgo;
  std::uint64_t foreign_masters_ = 0;
  std::string text_;
};

}  // namespace fieldcast
