#include "bridge/configure/hidden_secrets.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <vector>

namespace fieldcast::configure {

namespace {

struct Part {
  std::size_t begin = 0, end = 0;
};

constexpr std::string_view kEndOfUrl = " \t\r\n'\"";

// The password in "scheme://user:PASSWORD@", of an URL that begins at `at`.
std::optional<Part> password_of_url(std::string_view text, std::size_t at) {
  const std::size_t begin = at + 3;
  const std::size_t end = std::min(text.find_first_of(kEndOfUrl, begin), text.size());
  const std::string_view url = text.substr(begin, end - begin);
  // A password may contain '@', '/' and '?'.
  const std::size_t last = url.rfind('@');
  if (last == std::string_view::npos) return std::nullopt;
  const std::size_t colon = url.find(':');
  if (colon == std::string_view::npos || colon > last) return std::nullopt;
  return Part{begin + colon + 1, begin + last};
}

// The value after "password" or "passphrase", with '=' in an URL, with ':' in YAML.
std::optional<Part> value_of_key(std::string_view text, std::size_t after) {
  std::size_t at = after;
  while (at < text.size() && (text[at] == ' ' || text[at] == '"' || text[at] == '\'')) ++at;
  if (at >= text.size() || (text[at] != '=' && text[at] != ':')) return std::nullopt;
  const bool in_url = text[at] == '=';
  ++at;
  while (at < text.size() && (text[at] == ' ' || text[at] == '"' || text[at] == '\'')) ++at;
  const std::size_t end =
      std::min(text.find_first_of(in_url ? " \t\r\n'\"#&" : "\r\n'\"#,}", at), text.size());
  if (end == at) return std::nullopt;
  return Part{at, end};
}

bool is_same_word(std::string_view text, std::size_t at, std::string_view word) {
  return text.size() - at >= word.size() &&
         std::equal(word.begin(), word.end(), text.begin() + static_cast<std::ptrdiff_t>(at),
                    [](char wanted, char found) {
                      return wanted == std::tolower(static_cast<unsigned char>(found));
                    });
}

std::optional<Part> secret_at(std::string_view text, std::size_t at) {
  if (text.substr(at).starts_with("://")) return password_of_url(text, at);
  for (const std::string_view word : {"password", "passphrase"}) {
    if (is_same_word(text, at, word)) return value_of_key(text, at + word.size());
  }
  return std::nullopt;
}

std::vector<Part> secrets_in(std::string_view text) {
  std::vector<Part> parts;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const auto part = secret_at(text, at);
    if (!part || (!parts.empty() && part->begin < parts.back().end)) continue;
    parts.push_back(*part);
  }
  return parts;
}

}  // namespace

std::string without_secrets(std::string_view text) {
  std::string out;
  std::size_t at = 0;
  for (const Part& part : secrets_in(text)) {
    out.append(text.substr(at, part.begin - at)).append(kHidden);
    at = part.end;
  }
  return out.append(text.substr(at));
}

tl::expected<std::string, std::string> with_secrets(std::string_view draft,
                                                    std::string_view present) {
  const std::vector<Part> secrets = secrets_in(present);
  std::string out;
  std::size_t at = 0, used = 0;
  for (std::size_t found = draft.find(kHidden); found != std::string_view::npos;
       found = draft.find(kHidden, at), ++used) {
    out.append(draft.substr(at, found - at));
    if (used < secrets.size())
      out.append(present.substr(secrets[used].begin, secrets[used].end - secrets[used].begin));
    at = found + kHidden.size();
  }
  out.append(draft.substr(at));
  if (used != 0 && used != secrets.size())
    return tl::unexpected<std::string>(
        "the text has another number of hidden passwords than the file; leave every " +
        std::string(kHidden) + " where it is");
  return out;
}

}  // namespace fieldcast::configure
