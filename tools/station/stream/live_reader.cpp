// The thread that reads present samples.
#include "bridge/base/clock.hpp"
#include "tools/station/stream/live_feed.hpp"
#include "tools/station/stream/stream_shared.hpp"

namespace fieldcast::web {

namespace {

constexpr Duration kLivePause = std::chrono::seconds{1};  // before a further attempt
constexpr std::int64_t kLiveNextMs = 250;

}  // namespace

void run_live(StreamShared& shared, DomainInbox& inbox, bool counts) {
  NatsSession session(shared.spec, "fieldcast-station " + shared.station + " live", false);
  MessageReader reader(shared, session, counts);
  LiveFeed feed(inbox);
  forward::NatsSubscription subscription;
  std::uint64_t generation = 0;
  while (!shared.is_ending()) {
    if (!session.is_ready(steady_now())) {
      (void)shared.wait(std::chrono::milliseconds{kLiveNextMs});
      continue;
    }
    if (subscription == nullptr || generation != session.generation()) {
      subscription.reset();
      // Otherwise the last message of each device would wait for its own request.
      if (generation == 0)
        session.each_entry(shared.spec.bucket, [&shared](const auto& key, const auto& value) {
          return shared.catalogues.add(key, value) && !shared.is_ending();
        });
      auto made = subscribe_in_order(session, shared.spec.sample_stream, "fieldcast.>",
                                     StartWith::kLastOfEachSubject);
      shared.set_fault(StreamPart::kLive, made ? "" : made.error());
      if (!made) {
        (void)shared.wait(kLivePause);
        continue;
      }
      subscription = *std::move(made);
      generation = session.generation();
    }
    natsMsg* received = nullptr;
    const natsStatus status = natsSubscription_NextMsg(&received, subscription.get(), kLiveNextMs);
    const forward::NatsMessage message(received);
    if (status == NATS_TIMEOUT || status == NATS_SLOW_CONSUMER) continue;
    if (status != NATS_OK) {  // for example a missing heartbeat: the server has restarted
      subscription.reset();
      (void)shared.wait(std::chrono::milliseconds{kLiveNextMs});
      continue;
    }
    if (const auto batch = reader.batch_of(received)) {
      ++shared.messages;
      feed.pass(*batch, read_clocks().utc);
    }
  }
}

}  // namespace fieldcast::web
