// Negotiation of Telnet options without loops (RFC 1143). Each option is requested at most once and
// never withdrawn, so the queue of RFC 1143 is not needed. Pure.
#pragma once

#include <array>

#include "core/telnet/telnet.hpp"

namespace fieldcast::telnet {

inline constexpr std::uint8_t kBinary = 0, kEcho = 1, kSuppressGoAhead = 3, kComPort = 44;

enum class End : std::uint8_t { kHere, kThere };  // the end that performs the option

class Options {
 public:
  // Further requests of the peer get no response, so that no loop lasts.
  static constexpr unsigned kMaxResponses = 256;

  // `echo`: the end that may echo. The other options may be enabled at both ends.
  explicit Options(End echo) : echo_(echo) {}

  void request(std::uint8_t option, End end, Bytes& out);
  void on_request(const OptionRequest& received, Bytes& out);

  [[nodiscard]] bool enabled(std::uint8_t option, End end) const;
  // The peer has refused the option, or disabled it.
  [[nodiscard]] bool refused(std::uint8_t option, End end) const;

 private:
  enum class State : std::uint8_t { kOff, kRequested, kOn, kRefused };
  static constexpr std::array kKnown{kBinary, kEcho, kSuppressGoAhead, kComPort};
  // Null if the option is unknown, or not allowed at this end.
  [[nodiscard]] const State* find(std::uint8_t option, End end) const;
  void respond(const OptionRequest& response, Bytes& out);

  End echo_;
  std::array<std::array<State, kKnown.size()>, 2> states_{};
  unsigned responses_ = 0;
};

}  // namespace fieldcast::telnet
