#include "config/document/document.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/document/limits.hpp"

namespace fieldcast::config {

namespace {

// 0 if invalid (RFC 3629, 4: no overlong forms, no surrogates).
std::size_t sequence_length(std::string_view text) {
  const auto at = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const auto tail = [&](std::size_t i) { return at(i) >= 0x80 && at(i) <= 0xBF; };
  const unsigned first = at(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return tail(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    const bool second =
        tail(1) && (first != 0xE0 || at(1) >= 0xA0) && (first != 0xED || at(1) <= 0x9F);
    return second && tail(2) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const bool second =
        tail(1) && (first != 0xF0 || at(1) >= 0x90) && (first != 0xF4 || at(1) <= 0x8F);
    return second && tail(2) && tail(3) ? 4 : 0;
  }
  return 0;
}

std::string hex_byte(unsigned char byte) {
  static constexpr std::string_view kDigits = "0123456789ABCDEF";
  return {'0', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
}

}  // namespace

unsigned column_of(const Position& position) {
  unsigned column = 1;
  for (const char c : position.source->line(position.line).substr(0, position.column))
    column += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return column;
}

bool check_text(Source& source, FaultList& faults) {
  if (source.text.starts_with("\xEF\xBB\xBF")) source.text.erase(0, 3);
  Position position{&source, 0, 0};
  const std::string_view text = source.text;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte < 0x20 && byte != '\n' && byte != '\r' && byte != '\t') || byte == 0x7F) {
      faults.add(position, "control character " + hex_byte(byte), "text in UTF-8");
      return false;
    }
    const auto length = sequence_length(text.substr(i));
    if (length == 0) {
      faults.add(position, fmt::format("byte {} is not UTF-8", hex_byte(byte)),
                 "text in UTF-8; an editor can save the file so");
      return false;
    }
    position.column += static_cast<std::uint32_t>(length);
    if (byte == '\n') ++position.line, position.column = 0;
    i += length;
  }
  return true;
}

std::string_view Source::line(std::uint32_t number) const {
  if (line_starts.empty()) {
    line_starts.push_back(0);
    for (auto end = text.find('\n'); end != std::string::npos; end = text.find('\n', end + 1))
      line_starts.push_back(end + 1);
  }
  if (number >= line_starts.size()) return {};
  const auto rest = std::string_view(text).substr(line_starts[number]);
  return number + 1 < line_starts.size()
             ? rest.substr(0, line_starts[number + 1] - 1 - line_starts[number])
             : rest;
}

std::string_view to_text(Kind kind) {
  switch (kind) {
    case Kind::kNull: return "nothing";
    case Kind::kScalar: return "a single value";
    case Kind::kList: return "a list";
    case Kind::kMap: return "a map";
  }
  return "?";
}

std::string_view directory_of(std::string_view path) { return path.substr(0, path.rfind('/') + 1); }

std::string resolve(const Source& from, std::string_view path) {
  if (path.starts_with('/')) return std::string(path);
  return std::string(directory_of(from.file)).append(path);
}

namespace {

constexpr std::size_t kLongestShown = 400;  // of a text quoted in a fault

// What a file says may hold line breaks and escape codes; a fault is one line for a terminal.
std::string presentable(std::string_view given) {
  std::string text(given);
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  if (text.size() <= kLongestShown) return text;
  std::size_t end = kLongestShown;
  // Whole characters only.
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  text.resize(end);
  return text + "...";
}

}  // namespace

std::string to_text(const Fault& fault) {
  std::string text = fmt::format("{}:{}:{}: {}", fault.file, fault.line, fault.column, fault.what);
  if (!fault.allowed.empty()) text += "; allowed: " + fault.allowed;
  if (!fault.suggestion.empty()) text += fmt::format("; did you mean {}?", fault.suggestion);
  return text;
}

std::string to_text(std::span<const Fault> faults) {
  std::string text;
  for (const auto& fault : faults) text += to_text(fault) + '\n';
  return text;
}

bool FaultList::full() const { return entries_.size() > kMaxFaults; }

void FaultList::add(const Position& position, std::string_view what, std::string_view allowed,
                    std::string_view suggestion) {
  if (full()) return;
  const Source& source = *position.source;
  Fault fault{source.file,       position.line + 1,    column_of(position),
              presentable(what), std::string(allowed), presentable(suggestion)};
  if (!known_.insert({source.order, position.line, position.column, fault.what}).second) return;
  if (entries_.size() == kMaxFaults) {
    fault.what = "more faults follow; they are shown when these are corrected";
    fault.allowed = fault.suggestion = {};
  }
  entries_.push_back({source.order, std::move(fault)});
}

std::vector<Fault> FaultList::take() {
  // The last entry of a full list reports the omitted faults and stays last.
  const auto end = full() ? entries_.end() - 1 : entries_.end();
  std::stable_sort(entries_.begin(), end, [](const Entry& a, const Entry& b) {
    return std::tie(a.order, a.fault.line, a.fault.column) <
           std::tie(b.order, b.fault.line, b.fault.column);
  });
  std::vector<Fault> faults;
  faults.reserve(entries_.size());
  for (auto& entry : entries_) faults.push_back(std::move(entry.fault));
  entries_.clear();
  known_.clear();
  return faults;
}

}  // namespace fieldcast::config
