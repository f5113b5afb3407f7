#include "config/document/fault_list.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/document/limits.hpp"

namespace fieldcast::config {
namespace {

constexpr std::size_t kLongestShown = 400;  // of a text quoted in a fault

// What a file says may hold line breaks and escape codes; a fault is one line for a terminal.
void make_presentable(std::string& text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  if (text.size() <= kLongestShown) return;
  std::size_t end = kLongestShown;
  // Whole characters only.
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  text.resize(end);
  text += "...";
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

void FaultList::add(const Position& position, std::string what, std::string allowed,
                    std::string suggestion) {
  if (full()) return;
  make_presentable(what);
  make_presentable(suggestion);
  if (!known_.insert({position.source->order, position.line, position.column, what}).second) return;
  if (entries_.size() == kMaxFaults)
    what = "more faults follow; they are shown when these are corrected", allowed = suggestion = {};
  entries_.push_back(
      {position.source->order, Fault{position.source->file, position.line + 1, column_of(position),
                                     std::move(what), std::move(allowed), std::move(suggestion)}});
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
