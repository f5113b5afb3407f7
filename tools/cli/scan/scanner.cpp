#include "tools/cli/scan/scanner.hpp"

#include <algorithm>
#include <set>

namespace fieldcast::cli {

Scanner::Scanner(std::vector<ScanLine> lines) : lines_(std::move(lines)) {
  if (lines_.empty()) pass_ = kPasses;
  quick_ = probing_ = !lines_.empty() && !lines_.front().probes.empty();
}

std::optional<ScanAsk> Scanner::next() const {
  if (over()) return std::nullopt;
  const ScanLine& line = lines_[line_];
  const bool first = quick_ && index_ == 0 && pass_ == 0;
  if (!probing_) return ScanAsk{line_, line.addresses[index_], pass_, {}, first};
  const bool last = index_ + 1 == line.probes.size();
  return ScanAsk{line_, line.probes[index_], 0, last ? line.last_probe_wait : line.probe_wait,
                 first};
}

void Scanner::on_response(const ScanResponse& response) {
  ++asked_;
  if (probing_) return probed(response);
  if (response.device) {
    settled_ = line_;
    found_.push_back({line_, lines_[line_].addresses[index_], pass_, response, {}});
    babble_ = 0;
    return advance();
  }
  echoed_ = echoed_ || response.echo_alone;
  const bool noise = response.bytes > 0 && !response.echo_alone;
  babble_ = noise ? babble_ + 1 : 0;
  noise_ = noise_ || noise;
  if (response.shape != ResponseShape::kOther) {
    // The second request may match by chance: a response with a different parity can start
    // correctly.
    if (pass_ == 0) settled_ = line_;
    broken_.push_back({line_, lines_[line_].addresses[index_], response.shape});
  }
  if (noise && std::find(noisy_.begin(), noisy_.end(), line_) == noisy_.end())
    noisy_.push_back(line_);
  if (!settled_ && babbles()) {
    if (pass_ == 0) babbling_.push_back(line_);
    return next_line();
  }
  advance();
}

void Scanner::probed(const ScanResponse& response) {
  echoed_ = echoed_ || response.echo_alone;
  const bool heard = response.heard || response.device;
  if (heard && (heard_once_ || response.device)) {
    heard_any_ = true;
    probing_ = heard_once_ = false;
    index_ = 0;
  } else if (heard) {
    heard_once_ = true;
    index_ = 0;
  } else if (++index_ == lines_[line_].probes.size()) {
    next_line();
  }
}

std::vector<ScanBroken> Scanner::broken() const {
  std::vector<ScanBroken> broken;
  for (const ScanBroken& each : broken_) {
    const auto same = [&](const auto& other) {
      return other.line == each.line && other.address == each.address;
    };
    if (std::none_of(found_.begin(), found_.end(), same) &&
        std::none_of(broken.begin(), broken.end(), same))
      broken.push_back(each);
  }
  return broken;
}

bool Scanner::babbles() const {
  const bool before = std::find(babbling_.begin(), babbling_.end(), line_) != babbling_.end();
  return babble_ >= (before ? 1 : kBabble);
}

void Scanner::skip_line() { next_line(); }

void Scanner::advance() {
  const auto known = [&] {
    return std::any_of(found_.begin(), found_.end(), [&](const ScanFound& found) {
      return found.line == line_ && found.address == lines_[line_].addresses[index_];
    });
  };
  do {
    if (++index_ == lines_[line_].addresses.size()) return end_line();
  } while (known());
}

void Scanner::end_line() {
  if (settled_ || !noise_ || repeated_) return next_line();
  noise_ = false;
  repeated_ = true;
  index_ = 0;
}

void Scanner::next_line() {
  babble_ = 0;
  noise_ = repeated_ = false;
  index_ = 0;
  if (settled_) {
    line_ = *settled_;
    ++pass_;
  } else if (quick_) {
    return search_or_probe_next();
  } else if (++line_ == lines_.size()) {
    line_ = 0;
    ++pass_;
  }
  if (over() || !settled_) return;
  // Skips devices that responded in the first pass.
  const auto& addresses = lines_[line_].addresses;
  const auto silent = [&](std::uint16_t address) {
    return std::none_of(found_.begin(), found_.end(), [&](const ScanFound& found) {
      return found.line == line_ && found.address == address;
    });
  };
  const auto first = std::find_if(addresses.begin(), addresses.end(), silent);
  if (first == addresses.end()) pass_ = kPasses;
  index_ = static_cast<std::size_t>(first - addresses.begin());
}

// REQUIRES: no device has responded on this line.
void Scanner::search_or_probe_next() {
  const bool left = std::find(babbling_.begin(), babbling_.end(), line_) != babbling_.end();
  if (!probing_ && pass_ == 0 && !left) {
    ++pass_;
    return;
  }
  probing_ = true;
  heard_once_ = false;
  pass_ = ++line_ == lines_.size() ? kPasses : 0;
}

std::size_t Scanner::left() const {
  if (over()) return 0;
  if (quick_) {
    const ScanLine& now = lines_[line_];
    std::size_t left =
        probing_ ? now.probes.size() - index_ : (kPasses - pass_) * now.addresses.size() - index_;
    for (std::size_t line = line_ + 1; line < lines_.size() && !settled_; ++line)
      left += lines_[line].probes.size();
    return left;
  }
  std::size_t left = lines_[line_].addresses.size() - index_;
  if (settled_) return left + (pass_ + 1 < kPasses ? lines_[line_].addresses.size() : 0);
  std::size_t all = 0;
  for (std::size_t line = 0; line < lines_.size(); ++line) {
    all += lines_[line].addresses.size();
    if (line > line_) left += lines_[line].addresses.size();
  }
  return left + (kPasses - 1 - pass_) * all;
}

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
  for (const char c : line_with(text, "protocols:")) {
    if (is_letter(c) || is_digit(c) || c == '-')
      protocol += c;
    else if (!protocol.empty())
      head.protocols.push_back(std::exchange(protocol, {}));
  }
  if (!protocol.empty()) head.protocols.push_back(protocol);
  return head;
}

std::vector<TemplateHead> template_heads(const config::FileReader& reader,
                                         const config::LoadOptions& options) {
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

}  // namespace fieldcast::cli
