// Hides the passwords of a configuration's text from clients: those of URLs, `USER:PASSWORD@` and
// `password=`, and the values of keys named `password` or `passphrase`. Works on any text, also on
// one that the loader rejects. Pure.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace fieldcast::configure {

inline constexpr std::string_view kHidden = "__HIDDEN__";
// Without the fault of the loader, which may have the password.
inline constexpr std::string_view kMovedSecret =
    "a hidden password is not valid at this place; leave every __HIDDEN__ where it is";

[[nodiscard]] std::string without_secrets(std::string_view text);

// Puts the passwords of `present` back where `draft` has kHidden, in their order. Fails with the
// reason if their numbers differ, as it is unknown then which password belongs where, or if
// without_secrets() would show a password at its new place. Do not show what a loader says of the
// result: the draft may have a password at another key.
[[nodiscard]] tl::expected<std::string, std::string> with_secrets(std::string_view draft,
                                                                  std::string_view present);

}  // namespace fieldcast::configure
