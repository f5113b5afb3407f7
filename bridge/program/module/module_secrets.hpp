// The secrets of modules, and the proof that a module has one: the bridge sends a new random
// challenge, and the module responds with the HMAC-SHA-256 of the challenge and its number. The
// secret itself is never sent. Any thread, one at a time.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "bridge/base/secret.hpp"

namespace fieldcast::program {

class ModuleSecrets {
 public:
  // bytes: an eavesdropper could try all shorter ones
  static constexpr std::size_t kMinSecret = 16;

  // Reads a text file: each line has a number and its secret, or '*' and the secret of all numbers
  // without their own line; '#' begins a comment. The error is one line and contains no word of the
  // file.
  [[nodiscard]] static tl::expected<ModuleSecrets, std::string> read(const std::string& path);

  // Also returns false for a number without a secret. Its duration does not depend on the response.
  [[nodiscard]] bool fits(std::string_view number, std::string_view challenge,
                          std::string_view answer) const;

 private:
  std::map<std::string, Secret, std::less<>> secrets_;
};

// 64 random hexadecimal digits.
[[nodiscard]] std::string new_challenge();
// The response of a module: 64 hexadecimal digits.
[[nodiscard]] std::string answer_to(std::string_view challenge, std::string_view number,
                                    const Secret& secret);

}  // namespace fieldcast::program
