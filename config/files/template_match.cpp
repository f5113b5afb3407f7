#include "config/files/template_match.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace fieldcast::config {

namespace {

constexpr std::size_t kShortestWord = 3;
constexpr std::size_t kShortestBegin = 4;  // for a prefix of a longer model number

bool is_letter(char c) { return c >= 'a' && c <= 'z'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Lowercase words without punctuation: "carlo", "gavazzi", "em24dinav93x".
std::set<std::string> words_of(std::string_view text) {
  std::set<std::string> words;
  std::string word;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    char c = i < text.size() ? text[i] : ' ';
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (is_letter(c) || is_digit(c)) {
      word += c;
      continue;
    }
    if (word.size() >= kShortestWord) words.insert(word);
    word.clear();
  }
  return words;
}

bool names_model(const std::string& word) {
  return std::ranges::any_of(word, is_letter) && std::ranges::any_of(word, is_digit);
}

// Excludes models after "; not ", which the template does not support ("; not the DTSU666-H").
std::set<std::string> device_words(const TemplateHead& head) {
  const std::string& text = head.device.empty() ? head.description : head.device;
  return words_of(text.substr(0, text.find("; not ")));
}

// Length of the template's longest model number in the identity; 0 if there is none, or if the
// manufacturer differs.
std::size_t match_length(const std::set<std::string>& identity, const TemplateHead& head) {
  std::size_t longest = 0;
  bool maker = false;
  for (const std::string& word : device_words(head)) {
    if (!names_model(word)) {
      maker = maker || (std::ranges::all_of(word, is_letter) && identity.contains(word));
      continue;
    }
    const bool fits = std::ranges::any_of(identity, [&](const std::string& said) {
      return said == word || (word.size() >= kShortestBegin && said.starts_with(word));
    });
    if (fits) longest = std::max(longest, word.size());
  }
  return maker ? longest : 0;
}

// The rest of the first line that starts with `begin`.
std::string_view line_with(std::string_view text, std::string_view begin) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    at = end + 1;
    if (!line.starts_with(begin)) continue;
    line.remove_prefix(begin.size());
    while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.remove_suffix(1);
    return line;
  }
  return {};
}

}  // namespace

TemplateHead template_head(std::string name, std::string_view text) {
  TemplateHead head{.name = std::move(name),
                    .description = std::string(line_with(text, "description:")),
                    .device = std::string(line_with(text, "# Device:")),
                    .protocols = {}};
  std::string protocol;
  const std::string_view list = line_with(text, "protocols:");
  for (const char c : list.empty() ? line_with(text, "protocol:") : list) {
    if (is_letter(c) || is_digit(c) || c == '-')
      protocol += c;
    else if (!protocol.empty())
      head.protocols.push_back(std::exchange(protocol, {}));
  }
  if (!protocol.empty()) head.protocols.push_back(protocol);
  return head;
}

std::vector<TemplateHead> template_heads(const FileReader& reader, const LoadOptions& options) {
  constexpr std::string_view kSuffix = ".yaml";
  std::vector<TemplateHead> heads;
  for (const std::string& directory : options.template_directories) {
    for (const std::string& file : reader.list(directory)) {
      if (!file.ends_with(kSuffix)) continue;
      if (const auto text = reader.read(directory + '/' + file))
        heads.push_back(template_head(file.substr(0, file.size() - kSuffix.size()), *text));
    }
  }
  std::ranges::sort(heads, {}, &TemplateHead::name);
  return heads;
}

std::vector<std::string> matching_templates(std::string_view identity, std::string_view protocol,
                                            const std::vector<TemplateHead>& heads) {
  const std::set<std::string> words = words_of(identity);
  std::vector<std::string> names;
  std::size_t longest = 1;
  for (const TemplateHead& head : heads) {
    const auto& allowed = head.protocols;
    if (!allowed.empty() && std::ranges::find(allowed, protocol) == allowed.end()) continue;
    const std::size_t length = match_length(words, head);
    if (length < longest) continue;
    if (length > longest) names.clear();
    longest = length;
    names.push_back(head.name);
  }
  return names;
}

}  // namespace fieldcast::config
