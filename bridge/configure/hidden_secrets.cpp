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

// The YAML scalar at a position: the quote that it began with, or 0, and the open braces. Both
// count within their line.
struct Context {
  void pass(std::string_view text, std::size_t at) {
    constexpr std::string_view kBefore = " \t\n:,{['";
    const char c = text[at], before = at == 0 ? '\n' : text[at - 1];
    const bool begins = kBefore.find(before) != std::string_view::npos;
    if (c == '\n') *this = {};
    if (c == '"' || c == '\'') {
      if (quote == 0 && begins)
        quote = c;
      else if (quote == c && (c == '\'' || before != '\\'))
        quote = '\0';
    }
    if (quote == 0 && begins && (c == '{' || c == '[')) ++braces;
    if (quote == 0 && braces > 0 && (c == '}' || c == ']')) --braces;
  }

  // Returns the end of the scalar that `at` is in. In doubt a later one, which hides more.
  [[nodiscard]] std::size_t end(std::string_view text, std::size_t at) const {
    for (std::size_t i = at; quote != 0 && i < text.size(); ++i) {
      if (quote == '"' ? text[i] == '\\' : text.substr(i, 2) == "''")
        ++i;
      else if (text[i] == quote)
        return i;
    }
    std::string_view plain = text.substr(at, text.find_first_of("\r\n", at) - at);
    if (quote == 0) plain = plain.substr(0, plain.find(" #"));
    if (braces > 0) plain = plain.substr(0, plain.find_first_of(",]}"));
    return at + plain.find_last_not_of(" ,]}") + 1;
  }

  char quote = '\0';
  unsigned braces = 0;
};

// The password in "scheme://user:PASSWORD@", of an URL that begins at `at`.
std::optional<Part> password_of_url(std::string_view text, std::size_t at, const Context& in) {
  const std::size_t begin = at + 3;
  const std::string_view url = text.substr(begin, in.end(text, begin) - begin);
  // A password may contain '@', '/', '?' and blanks.
  const std::size_t last = url.rfind('@');
  if (last == std::string_view::npos) return std::nullopt;
  const std::size_t colon = url.find(':');
  if (colon == std::string_view::npos || colon > last) return std::nullopt;
  return Part{begin + colon + 1, begin + last};
}

// The value after "password" or "passphrase", with '=' in an URL, with ':' in YAML.
std::optional<Part> value_of_key(std::string_view text, std::size_t after, Context in) {
  const auto skip = [&](std::size_t at) {
    for (; at < text.size() && (text[at] == ' ' || text[at] == '"' || text[at] == '\''); ++at) {
      if (text[at] != ' ') in.quote = in.quote == text[at] ? '\0' : text[at];
    }
    return at;
  };
  std::size_t at = skip(after);
  if (at >= text.size() || (text[at] != '=' && text[at] != ':')) return std::nullopt;
  const bool in_url = text[at] == '=';
  at = skip(at + 1);
  std::size_t end = in.end(text, at);
  if (in_url) end = std::min(end, text.find('&', at));
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

std::optional<Part> secret_at(std::string_view text, std::size_t at, const Context& in) {
  if (text.substr(at).starts_with("://")) return password_of_url(text, at, in);
  for (const std::string_view word : {"password", "passphrase"}) {
    if (is_same_word(text, at, word)) return value_of_key(text, at + word.size(), in);
  }
  return std::nullopt;
}

std::vector<Part> secrets_in(std::string_view text) {
  std::vector<Part> parts;
  Context in;
  for (std::size_t at = 0; at < text.size(); in.pass(text, at++)) {
    const auto part = secret_at(text, at, in);
    if (!part) continue;
    if (parts.empty() || part->begin >= parts.back().end)
      parts.push_back(*part);
    else
      parts.back().end = std::max(parts.back().end, part->end);
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
  if (used != 0 && without_secrets(out) != without_secrets(draft))
    return tl::unexpected(std::string(kMovedSecret));
  return out;
}

}  // namespace fieldcast::configure
