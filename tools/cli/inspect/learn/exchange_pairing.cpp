#include "tools/cli/inspect/learn/exchange_pairing.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::learn {

void ExchangePairing::take(Direction direction, ByteView frame) {
  ++frames_;
  if (frame.empty() || frame.size() > kMaxFrame) {
    ++left_out_;
    return;
  }
  Bytes bytes(frame.begin(), frame.end());
  if (direction == Direction::kSent) {
    if (!request_.empty()) ++without_response_;
    request_ = std::move(bytes);
    return;
  }
  Exchange exchange{std::exchange(request_, {}), std::move(bytes)};
  if (exchanges_.size() == kMaxExchanges && !known_.contains(exchange))
    ++left_out_;
  else if (known_.insert(exchange).second)
    exchanges_.push_back(std::move(exchange));
}

std::vector<Exchange> ExchangePairing::finish() {
  if (!request_.empty()) ++without_response_;
  // What a device sends between its responses is not a response.
  const auto asked = [](const Exchange& each) { return !each.request.empty(); };
  if (std::ranges::any_of(exchanges_, asked)) {
    const auto before = exchanges_.size();
    std::erase_if(exchanges_, [&](const Exchange& each) { return !asked(each); });
    left_out_ += before - exchanges_.size();
  }
  drop_echoes();
  return std::move(exchanges_);
}

void ExchangePairing::drop_echoes() {
  constexpr std::size_t kLeast = 4;  // bytes of a request
  const auto is_echo = [](const Exchange& each) {
    return each.request.size() >= kLeast && each.response.size() > each.request.size() &&
           std::equal(each.request.begin(), each.request.end(), each.response.begin());
  };
  if (exchanges_.empty() || !std::ranges::all_of(exchanges_, is_echo)) return;
  echoes_ = true;
  for (Exchange& each : exchanges_)
    each.response.erase(each.response.begin(),
                        each.response.begin() + static_cast<std::ptrdiff_t>(each.request.size()));
}

}  // namespace fieldcast::learn
