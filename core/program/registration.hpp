// Asks a module that dialled in for its device number. Pure: bytes and silence in, requests and the
// number out.
//
// Either the module sends a registration text of its own when it connects, or the number stands as
// text in DM words of the PLC behind it and is read with Host Link (`RD`), two characters in each
// word, the first in the high byte.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::program {

struct RegistrationRule {
  enum class Ask : std::uint8_t { kText, kWords };
  Ask ask = Ask::kText;
  std::string prefix;                          // of the text, taken away: "ID="
  std::uint16_t unit = 0;                      // kWords: Host Link unit 0..31
  std::uint32_t first = 0;                     // kWords: DM word
  std::uint16_t words = 8;                     // kWords: 1..8
  Duration timeout = std::chrono::seconds{5};  // from connecting to the number, all tries together
  std::string protocol = "omron-hostlink";     // kWords: reads the words
  std::string area = "DM";                     // kWords: where they stand, in its notation
  friend bool operator==(const RegistrationRule&, const RegistrationRule&) = default;
};

// What a module has to answer besides telling its number, by text only: "17 ANSWER".
struct Challenge {
  std::string text;  // sent at once, as a line "challenge TEXT"; empty: nothing is asked
  std::function<bool(std::string_view number, std::string_view answer)> fits;
};

class Registration {
 public:
  static constexpr std::size_t kMaxText = 128;  // prefix, number, answer and ends of line
  // A text without an end of line ends in silence.
  static constexpr Duration kTextEnds = std::chrono::milliseconds{300};
  static constexpr Duration kAnswerTimeout = std::chrono::milliseconds{1000};

  explicit Registration(const RegistrationRule& rule, Challenge challenge = {});

  struct Outcome {
    Bytes send;                         // to the module
    std::optional<std::string> number;  // valid; the registration is over
    std::optional<std::string> fault;   // one line for people; the registration is over
    Instant wake = kNever;              // call on_timer() then
  };
  [[nodiscard]] Outcome start(Instant now);
  [[nodiscard]] Outcome on_bytes(ByteView bytes, Instant now);
  [[nodiscard]] Outcome on_timer(Instant now);

 private:
  [[nodiscard]] Outcome ask(Instant now);
  [[nodiscard]] Outcome follow(const Step& step, Bytes out, Instant now);
  [[nodiscard]] static Outcome refused(Cause cause, std::uint16_t code);
  [[nodiscard]] Outcome number_or_fault(std::string_view text) const;

  [[nodiscard]] Outcome proven(std::string_view number, std::string_view answer) const;

  RegistrationRule rule_;
  Challenge challenge_;
  std::unique_ptr<Protocol> protocol_;  // kWords
  std::unique_ptr<Exchange> exchange_;
  Bytes received_;
  Instant deadline_ = kNever;  // of the whole
  Instant silence_ = kNever;
  std::uint16_t tries_ = 0;
};

}  // namespace fieldcast::program
