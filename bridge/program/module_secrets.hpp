// The secrets that modules prove to know, and the proof: the bridge sends a challenge that it never
// sent before, and the module answers with the HMAC-SHA-256 of it and of its number. The secret
// itself never crosses the line. Any thread, one at a time.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "bridge/base/secret.hpp"

namespace fieldcast::program {

class ModuleSecrets {
 public:
  static constexpr std::size_t kMinSecret = 16;  // bytes: who listens on the line may try them all

  // A text file: in each line a number and its secret, or '*' and the secret of all numbers that
  // have no line of their own; '#' begins a comment. The error is one line, without a word of the
  // file.
  [[nodiscard]] static tl::expected<ModuleSecrets, std::string> read(const std::string& path);

  // False also for a number without a secret. In a time that does not depend on the answer.
  [[nodiscard]] bool fits(std::string_view number, std::string_view challenge,
                          std::string_view answer) const;

 private:
  std::map<std::string, Secret, std::less<>> secrets_;
};

// 64 hexadecimal digits by chance.
[[nodiscard]] std::string new_challenge();
// The answer of a module: 64 hexadecimal digits.
[[nodiscard]] std::string answer_to(std::string_view challenge, std::string_view number,
                                    const Secret& secret);

}  // namespace fieldcast::program
