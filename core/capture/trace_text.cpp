#include "core/capture/trace_text.hpp"

#include <array>
#include <utility>

namespace fieldcast {
namespace {

using Mark = TraceText::Mark;
constexpr std::array<std::pair<std::string_view, Mark>, 3> kMarks{
    {{">>", Mark::kSent}, {"<<", Mark::kReceived}, {"--", Mark::kRemark}}};

constexpr std::string_view kBlank = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kBlank);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::string_view take_last_word(std::string_view& text) {
  text = trimmed(text);
  const auto blank = text.find_last_of(kBlank);
  const std::string_view word = blank == text.npos ? text : text.substr(blank + 1);
  text = blank == text.npos ? std::string_view{} : text.substr(0, blank);
  return word;
}

// "2026-11-22T14:24:21.126358Z".
bool is_time(std::string_view word) {
  return word.size() >= 20 && word[4] == '-' && word[10] == 'T' && word.back() == 'Z' &&
         word.find_first_not_of("0123456789-T:.Z") == word.npos;
}

std::size_t find_word(std::string_view text, std::string_view word) {
  for (auto at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
    const bool begins = at == 0 || kBlank.find(text[at - 1]) != kBlank.npos;
    const auto end = at + word.size();
    if (begins && (end == text.size() || kBlank.find(text[end]) != kBlank.npos)) return at;
  }
  return text.npos;
}

}  // namespace

std::optional<TraceText> parse_trace_text(std::string_view line) {
  std::size_t at = line.npos;
  TraceText parsed;
  for (const auto& [word, mark] : kMarks) {
    const auto found = find_word(line, word);
    if (found >= at) continue;
    at = found;
    parsed.mark = mark;
  }
  if (at == line.npos) return std::nullopt;
  std::string_view before = line.substr(0, at);
  parsed.text = trimmed(line.substr(at + 2));
  parsed.bus = take_last_word(before);
  if (is_time(parsed.bus)) {
    parsed.time = std::exchange(parsed.bus, {});
  } else if (const auto word = take_last_word(before); is_time(word)) {
    parsed.time = word;
  }
  if (parsed.mark == Mark::kRemark) {
    // Two hyphens occur in many texts.
    if (parsed.time.empty()) return std::nullopt;
    return parsed;
  }
  auto bytes = from_hex(parsed.text);
  if (!bytes || bytes->empty()) return std::nullopt;
  parsed.bytes = std::move(*bytes);
  parsed.text = {};
  return parsed;
}

}  // namespace fieldcast
