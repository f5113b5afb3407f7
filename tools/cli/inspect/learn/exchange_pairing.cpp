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
  return std::move(exchanges_);
}

}  // namespace fieldcast::learn
