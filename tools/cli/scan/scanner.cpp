#include "tools/cli/scan/scanner.hpp"

#include <algorithm>

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

}  // namespace fieldcast::cli
