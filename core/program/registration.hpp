// Gets the device number of a dialled-in module: from a text that the module sends when it
// connects, or from DM words of its PLC, read with Host Link (`RD`), two characters per word, the
// first in the high byte. Pure: bytes and silence in, requests and the number out.
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
  std::string prefix;       // removed from the text: "ID="
  std::uint16_t unit = 0;   // for kWords: Host Link unit 0..31
  std::uint32_t first = 0;  // for kWords: DM word
  std::uint16_t words = 8;  // for kWords: 1..8
  // Limit from the connection to the number, including all tries.
  Duration timeout = std::chrono::seconds{5};
  std::string protocol = "omron-hostlink";  // for kWords: protocol of the read
  std::string area = "DM";                  // for kWords: area, in the notation of the protocol
  friend bool operator==(const RegistrationRule&, const RegistrationRule&) = default;
};

// The proof that a module must send with its number, by text only: "17 ANSWER".
struct Challenge {
  std::string text;  // sent immediately, as a line "challenge TEXT"; empty: no proof is required
  std::function<bool(std::string_view number, std::string_view response)> fits;
};

class Registration {
 public:
  static constexpr std::size_t kMaxText = 128;  // prefix, number, response and ends of line
  // A text without an end of line ends after this silence.
  static constexpr Duration kTextEnds = std::chrono::milliseconds{300};
  static constexpr Duration kResponseTimeout = std::chrono::milliseconds{1000};

  explicit Registration(const RegistrationRule& rule, Challenge challenge = {});

  struct Outcome {
    Bytes send;                         // to the module
    std::optional<std::string> number;  // valid; the registration has ended
    std::optional<std::string> fault;   // one human-readable line; the registration has ended
    Instant wake = kNever;              // when to call on_timer()
  };
  [[nodiscard]] Outcome start(Instant now);
  [[nodiscard]] Outcome on_bytes(ByteView bytes, Instant now);
  [[nodiscard]] Outcome on_timer(Instant now);

 private:
  [[nodiscard]] Outcome ask(Instant now);
  [[nodiscard]] Outcome follow(const Step& step, Bytes out, Instant now);
  [[nodiscard]] static Outcome refused(Cause cause, std::uint16_t code);
  [[nodiscard]] Outcome number_or_fault(std::string_view text) const;

  [[nodiscard]] Outcome proven(std::string_view number, std::string_view response) const;

  RegistrationRule rule_;
  Challenge challenge_;
  std::unique_ptr<Protocol> protocol_;  // for kWords
  std::unique_ptr<Exchange> exchange_;
  Bytes received_;
  Instant deadline_ = kNever;  // for all tries
  Instant silence_ = kNever;
  std::uint16_t tries_ = 0;
};

}  // namespace fieldcast::program
