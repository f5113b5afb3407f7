#include "bridge/http/http_guard.hpp"

#include <algorithm>
#include <utility>

#include "bridge/base/check.hpp"

namespace fieldcast::web {

template <typename Rule>
std::size_t ConnectionTable::count(Rule rule) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(rows_, [&](const auto& each) { return rule(each.second); }));
}

template <typename Rule>
std::optional<ConnectionTable::Id> ConnectionTable::oldest(Phase phase, Rule rule) const {
  auto oldest = rows_.end();
  for (auto at = rows_.begin(); at != rows_.end(); ++at) {
    if (at->second.phase != phase || !rule(at->first, at->second)) continue;
    if (oldest == rows_.end() || at->second.since < oldest->second.since) oldest = at;
  }
  return oldest == rows_.end() ? std::nullopt : std::optional(oldest->first);
}

bool ConnectionTable::may_work(const Peer& peer) const {
  if (peer.logged_in) return true;
  const auto works = [](const Row& row) {
    return row.phase == Phase::kWorking && !row.peer.logged_in;
  };
  const auto works_there = [&](const Row& row) {
    return works(row) && row.peer.group == peer.group;
  };
  return count(works) + limits_.reserved < limits_.total &&
         count(works_there) < limits_.working_of_one;
}

// `self`: the connection to admit, if it is in the table already.
ConnectionTable::Admission ConnectionTable::place_at_address(const Peer& peer,
                                                             std::optional<Id> self) const {
  const auto is_alike = [&](const Row& row) {
    return row.peer.group == peer.group && row.peer.logged_in == peer.logged_in;
  };
  if (count(is_alike) < limits_.of_one) return {true, std::nullopt};
  const auto may_leave = [&](Id id, const Row& row) { return id != self && is_alike(row); };
  auto evicted = oldest(Phase::kWaiting, may_leave);
  if (!evicted && limits_.evicts_working) evicted = oldest(Phase::kWorking, may_leave);
  return {evicted.has_value(), evicted};
}

ConnectionTable::Admission ConnectionTable::admission(const Peer& peer, Phase phase) const {
  if (phase == Phase::kWorking && !may_work(peer)) return {};
  Admission room = place_at_address(peer, std::nullopt);
  if (!room.admitted || room.evicted || rows_.size() < limits_.total) return room;
  room.evicted = oldest(Phase::kWaiting, [](Id, const Row& row) { return !row.peer.logged_in; });
  const auto every = [](Id, const Row&) { return true; };
  if (!room.evicted) room.evicted = oldest(Phase::kWaiting, every);
  if (!room.evicted && limits_.evicts_working) room.evicted = oldest(Phase::kWorking, every);
  room.admitted = room.evicted.has_value();
  return room;
}

ConnectionTable::Admission ConnectionTable::open(Id id, Peer peer, Phase phase, Instant now) {
  const Admission room = admission(peer, phase);
  if (room.evicted) rows_.erase(*room.evicted);
  if (room.admitted) rows_.emplace(id, Row{std::move(peer), phase, now});
  return room;
}

ConnectionTable::Admission ConnectionTable::work(Id id, bool logged_in) {
  const auto at = rows_.find(id);
  FIELDCAST_CHECK(at != rows_.end());
  Row& row = at->second;
  const Peer peer{row.peer.group, logged_in};
  if (!may_work(peer)) return {};
  Admission room{true, std::nullopt};
  if (row.peer.logged_in != logged_in) room = place_at_address(peer, id);
  if (!room.admitted) return room;
  if (room.evicted) rows_.erase(*room.evicted);
  row.peer.logged_in = logged_in;
  row.phase = Phase::kWorking;
  return room;
}

void ConnectionTable::wait(Id id, Instant now) {
  const auto at = rows_.find(id);
  if (at == rows_.end()) return;
  at->second.phase = Phase::kWaiting;
  at->second.since = now;
}

void ConnectionTable::close(Id id) { rows_.erase(id); }

namespace {

constexpr HeadFault kLineEnd{400, "a line does not end with CR LF", "send HTTP/1.1"};
constexpr HeadFault kControl{400, "a control character in the header", "remove it"};
constexpr HeadFault kFolding{400, "a header line begins with a space",
                             "send each header in one line"};
constexpr HeadFault kName{400, "a header without a valid name",
                          "send NAME: VALUE without a space before the colon"};
constexpr HeadFault kLength{400, "the Content-Length is not a number", "send digits only"};
constexpr HeadFault kTwoLengths{400, "the length of the body is given more than once",
                                "send Content-Length once, or Transfer-Encoding: chunked"};
constexpr HeadFault kOldCoding{400, "Transfer-Encoding needs HTTP/1.1", "send Content-Length"};
constexpr HeadFault kCoding{501, "unknown Transfer-Encoding",
                            "send Content-Length, or Transfer-Encoding: chunked"};

char head_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, head_lower, head_lower);
}

bool is_token_char(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
         std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

std::string_view without_spaces(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

std::optional<HeadFault> HeadCheck::put(std::string_view all) {
  for (; size_ == 0 && next_ < all.size(); ++next_) {
    const char c = all[next_];
    const bool after_cr = next_ > line_ && all[next_ - 1] == '\r';
    if (after_cr != (c == '\n')) return kLineEnd;
    if (c == '\n') {
      const std::string_view line = all.substr(line_, next_ - 1 - line_);
      line_ = next_ + 1;
      if (line.empty() && !first_) size_ = line_;
      if (auto fault = size_ > 0 ? std::nullopt : on_line(line)) return fault;
    } else if (c != '\r' && c != '\t' && (static_cast<unsigned char>(c) < ' ' || c == 0x7F)) {
      return kControl;
    }
  }
  return std::nullopt;
}

std::optional<HeadFault> HeadCheck::on_line(std::string_view line) {
  if (std::exchange(first_, false)) {
    old_ = !line.ends_with(" HTTP/1.1");  // the parser checks the rest of the line
    return std::nullopt;
  }
  if (line.front() == ' ' || line.front() == '\t') return kFolding;
  const std::string_view name = line.substr(0, line.find(':'));
  if (name.empty() || name.size() == line.size() || !std::ranges::all_of(name, is_token_char))
    return kName;
  const std::string_view value = without_spaces(line.substr(name.size() + 1));
  if (same_word(name, "content-length")) return on_length(value);
  if (same_word(name, "transfer-encoding")) return on_coding(value);
  return std::nullopt;
}

std::optional<HeadFault> HeadCheck::on_length(std::string_view value) {
  if (std::exchange(has_length_, true) || has_coding_) return kTwoLengths;
  const bool digits = !value.empty() && value.find_first_not_of("0123456789") == value.npos;
  return digits ? std::nullopt : std::optional(kLength);
}

std::optional<HeadFault> HeadCheck::on_coding(std::string_view value) {
  if (std::exchange(has_coding_, true) || has_length_) return kTwoLengths;
  if (old_) return kOldCoding;
  return same_word(value, "chunked") ? std::nullopt : std::optional(kCoding);
}

}  // namespace fieldcast::web
