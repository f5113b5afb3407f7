#include "bridge/dds/filter/joined_sending.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "bridge/base/check.hpp"

namespace fieldcast {

namespace {

thread_local JoinedSending* of_thread = nullptr;

// Messages are not joined if statistics are on, because the library counts its own messages.
bool wants_statistics() {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets the environment
  static const bool wanted = std::getenv("FASTDDS_STATISTICS") != nullptr;
  return wanted;
}

}  // namespace

JoinedSending::JoinedSending(std::size_t most_bytes) : most_bytes_(most_bytes) {
  FIELDCAST_CHECK(of_thread == nullptr);
  if (!wants_statistics()) of_thread = this;
}

JoinedSending::~JoinedSending() {
  of_thread = nullptr;
  for (Kept& kept : kept_) let_go(kept);
}

JoinedSending* JoinedSending::of_this_thread() { return of_thread; }

bool JoinedSending::send(PassingTransport& transport, const OutgoingMessage& message) {
  to_.clear();
  for (auto& at = *message.begin; at != *message.end; ++at) to_.push_back(*at);
  auto kept = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& one) {
    return one.below == message.below && one.to == to_;
  });
  if (kept == kept_.end()) {
    kept_.push_back({&transport, message.below, to_, message.deadline, JoinedMessage(most_bytes_)});
    kept = std::prev(kept_.end());
  }
  kept->deadline = message.deadline;
  if (kept->message.append(message.bytes)) return true;
  let_go(*kept);
  if (kept->message.append(message.bytes)) return true;
  rtps_transport::Locators begin(to_.begin()), end(to_.end());
  return transport.send_whole({message.below, message.bytes, &begin, &end, message.deadline});
}

void JoinedSending::let_go(Kept& kept) {
  if (kept.message.empty()) return;
  rtps_transport::Locators begin(kept.to.begin()), end(kept.to.end());
  // A failure cannot be reported here; the writers repeat unacknowledged messages.
  (void)kept.transport->send_whole({kept.below, kept.message.whole(), &begin, &end, kept.deadline});
  kept.message.clear();
}

}  // namespace fieldcast
