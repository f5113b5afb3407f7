#include "bridge/dds/sample_writers.hpp"

#include <algorithm>
#include <tuple>

#include "bridge/check.hpp"

namespace fieldcast {

struct SampleWriters::Writer : dds::DataWriterListener {
  std::optional<Duration> refresh;
  dds::DataWriter* entity = nullptr;
  std::atomic<std::uint32_t> channels{0};
  std::optional<Instant> idle_since;  // without channels; known from the next tidy() on
  std::atomic<std::uint64_t> misses{0};
  std::atomic<std::uint32_t> readers{0};

  void on_offered_deadline_missed(dds::DataWriter*,
                                  const dds::OfferedDeadlineMissedStatus& status) override {
    if (channels > 0) misses.fetch_add(status.total_count_change, std::memory_order_relaxed);
  }
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    readers.store(static_cast<std::uint32_t>(status.current_count), std::memory_order_relaxed);
  }
};

SampleWriters::SampleWriters(Domain& domain, const std::string& bridge, const BusSpec& bus)
    : domain_(domain), label_("fieldcast-bridge " + bridge + ": " + bus.name) {
  for (const DeviceSpec& device : bus.devices) {
    for (const ChannelSpec& channel : device.channels) {
      Slot& slot = slots_.emplace_back();
      slot.key = SampleKey(bus.name, device.name, channel.name);
      if (channel.access != Access::kWriteOnly) attach(slot, promised_gap(channel));
    }
  }
}

SampleWriters::~SampleWriters() { dispose(Duration::zero()); }

SampleWriters::Writer& SampleWriters::writer_for(std::optional<Duration> refresh) {
  for (const auto& writer : writers_) {
    if (writer->refresh == refresh &&
        writer->channels < static_cast<std::uint32_t>(kChannelsPerWriter))
      return *writer;
  }
  auto made = std::make_unique<Writer>();
  made->refresh = refresh;
  const std::string label = label_ + (refresh ? ", refresh " + to_text(*refresh) : ", no refresh");
  made->entity = domain_.writer<idl::SamplePubSubType, SampleType>(
      kSampleTopic, sample_writer_qos(refresh), label, made.get(),
      dds::StatusMask::offered_deadline_missed() << dds::StatusMask::publication_matched());
  const std::lock_guard lock(writers_mutex_);
  return *writers_.emplace_back(std::move(made));
}

void SampleWriters::attach(Slot& slot, std::optional<Duration> refresh) {
  slot.writer = &writer_for(refresh);
  ++slot.writer->channels;
}

bool SampleWriters::write(std::span<const Sample> samples, const UtcMapping& mapping) {
  tidy(mapping.instant);
  bool taken = true;
  for (const auto& [slot, sample] : in_order(samples)) {
    to_last_value(*sample, mapping, slot->value);
    slot->order = ++writes_;
    OutgoingSample outgoing = slot->outgoing();
    taken &= slot->writer->entity->write(&outgoing);
  }
  return taken;
}

// DEADLINE keeps a timer for the instance of a writer that is due first; writing that one makes the
// library look for the next among all, and wakes its timer thread. So the instance that was written
// least recently comes last: one such scan a block instead of one a sample. The others come in the
// order in which they were last written, which takes the oldest from the library's history first.
std::vector<SampleWriters::Write>& SampleWriters::in_order(std::span<const Sample> samples) {
  order_.clear();
  for (const Sample& sample : samples) {
    FIELDCAST_CHECK(sample.channel < slots_.size());
    Slot& slot = slots_[sample.channel];
    if (slot.writer == nullptr)
      attach(slot, std::nullopt);  // somebody acquired a write-only channel
    order_.push_back({&slot, &sample});
  }
  std::stable_sort(order_.begin(), order_.end(), [](const Write& a, const Write& b) {
    return std::tie(a.slot->writer, a.slot->order, a.slot) <
           std::tie(b.slot->writer, b.slot->order, b.slot);
  });
  for (auto begin = order_.begin(); begin != order_.end();) {
    const auto end = std::find_if(begin, order_.end(), [&](const Write& one) {
      return one.slot->writer != begin->slot->writer;
    });
    const auto oldest_end =
        std::find_if(begin, end, [&](const Write& one) { return one.slot != begin->slot; });
    std::rotate(begin, oldest_end, end);
    begin = end;
  }
  return order_;
}

void SampleWriters::tidy(Instant now) {
  if (!leaving_.empty()) let_go(now);
  if (any_idle_) remove_idle_writers(now);
}

bool SampleWriters::move(ChannelIndex channel, std::optional<Duration> refresh) {
  FIELDCAST_CHECK(channel < slots_.size());
  Slot& slot = slots_[channel];
  Writer* const old = slot.writer;
  if (old != nullptr && old->refresh == refresh) return false;
  attach(slot, refresh);
  if (old == nullptr) return true;
  --old->channels;
  if (slot.written()) {
    OutgoingSample outgoing = slot.outgoing();
    slot.writer->entity->write(&outgoing);
    leaving_.push_back({channel, old, std::nullopt});
  }
  if (old->channels == 0) {
    old->idle_since.reset();
    any_idle_ = true;
  }
  return true;
}

void SampleWriters::let_go(Instant now) {
  std::erase_if(leaving_, [&](Leaving& one) {
    if (!one.since) one.since = now;
    if (now - *one.since < kIdle) return false;
    Slot& slot = slots_[one.channel];
    // Never the last one: Fast DDS 2.9.1 looks for the next deadline of a writer without instances,
    // and finds nothing to look at.
    OutgoingSample outgoing = slot.outgoing();
    if (slot.writer != one.old && one.old->channels > 0)
      one.old->entity->unregister_instance(&outgoing, dds::HANDLE_NIL);
    return true;
  });
}

void SampleWriters::remove_idle_writers(Instant now) {
  any_idle_ = false;
  for (auto writer = writers_.begin(); writer != writers_.end();) {
    Writer& one = **writer;
    if (one.channels > 0) {
      ++writer;
      continue;
    }
    if (!one.idle_since) one.idle_since = now;
    if (now - *one.idle_since < kIdle) {
      any_idle_ = true;
      ++writer;
      continue;
    }
    domain_.remove(one.entity);
    const std::lock_guard lock(writers_mutex_);
    retired_misses_ += one.misses.load(std::memory_order_relaxed);
    writer = writers_.erase(writer);
  }
}

std::optional<Duration> SampleWriters::refresh_of(ChannelIndex channel) const {
  FIELDCAST_CHECK(channel < slots_.size());
  const Writer* writer = slots_[channel].writer;
  return writer == nullptr ? std::nullopt : writer->refresh;
}

void SampleWriters::dispose(Duration linger, Duration limit) {
  leaving_.clear();
  const auto begun = std::chrono::steady_clock::now();
  for (Slot& slot : slots_) {
    OutgoingSample outgoing = slot.outgoing();
    if (slot.written() && std::chrono::steady_clock::now() - begun < limit)
      slot.writer->entity->dispose(&outgoing, dds::HANDLE_NIL);
    slot.value.sequence = 0;
    slot.writer = nullptr;
  }
  const auto end = std::chrono::steady_clock::now() + linger;
  for (const auto& writer : writers_) {
    const Duration left = end - std::chrono::steady_clock::now();
    if (left > Duration::zero()) writer->entity->wait_for_acknowledgments(to_dds(left));
    domain_.remove(writer->entity);
  }
  const std::lock_guard lock(writers_mutex_);
  writers_.clear();
}

DdsLink::BusCounters SampleWriters::counters() const {
  const std::lock_guard lock(writers_mutex_);
  DdsLink::BusCounters counters{.deadline_misses = retired_misses_};
  for (const auto& writer : writers_) {
    counters.deadline_misses += writer->misses.load(std::memory_order_relaxed);
    counters.sample_readers =
        std::max(counters.sample_readers, writer->readers.load(std::memory_order_relaxed));
    counters.sample_writers += writer->channels > 0;
  }
  return counters;
}

}  // namespace fieldcast
