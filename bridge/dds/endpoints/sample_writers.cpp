#include "bridge/dds/endpoints/sample_writers.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "bridge/base/check.hpp"
#include "bridge/dds/filter/sent_message.hpp"

namespace fieldcast {

struct SampleWriters::Writer : dds::DataWriterListener {
  Writer(const SampleWriters& owner, std::optional<Duration> promise)
      : all(owner), refresh(promise) {}

  const SampleWriters& all;
  const std::optional<Duration> refresh;
  dds::DataWriter* entity = nullptr;
  std::atomic<std::uint32_t> channels{0};
  std::uint64_t written = 0;
  std::optional<Instant> full_since;  // when its successor was made
  std::optional<Instant> idle_since;  // no channels since; set by the next tidy()
  std::atomic<std::uint64_t> misses{0};
  std::atomic<std::uint32_t> readers{0};

  void on_offered_deadline_missed(dds::DataWriter*,
                                  const dds::OfferedDeadlineMissedStatus& status) override {
    if (channels > 0) misses.fetch_add(status.total_count_change, std::memory_order_relaxed);
  }
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    readers = static_cast<std::uint32_t>(status.current_count);
    if (status.current_count_change <= 0) return;
    all.snapshots_.matched(all.bus_, !all.awake_);
  }
};

SampleWriters::SampleWriters(Domain& domain, const std::string& bridge, const BusSpec& bus,
                             std::size_t most_bytes, const BlockWriter& blocks,
                             SnapshotSender& snapshots)
    : domain_(domain),
      label_("fieldcast-bridge " + bridge + ": " + bus.name),
      most_bytes_(most_bytes),
      bus_(bus.name),
      blocks_(blocks),
      snapshots_(snapshots) {
  const std::lock_guard lock(mutex_);
  for (const DeviceSpec& device : bus.devices) {
    for (const ChannelSpec& channel : device.channels) {
      Slot& slot = slots_.emplace_back();
      slot.key = SampleKey(bus.name, device.name, channel.name);
      if (channel.access != Access::kWriteOnly) attach(slot, promised_gap(channel));
    }
  }
  slots_.shrink_to_fit();
}

SampleWriters::~SampleWriters() { dispose(Duration::zero()); }

SampleWriters::Writer& SampleWriters::writer_for(std::optional<Duration> refresh) {
  for (const auto& writer : writers_) {
    if (writer->refresh == refresh && writer->written < RenewedWriter::kMostMessages &&
        writer->channels < static_cast<std::uint32_t>(kChannelsPerWriter))
      return *writer;
  }
  auto made = std::make_unique<Writer>(*this, refresh);
  made->entity = entity_for(*made);
  return *writers_.emplace_back(std::move(made));
}

dds::DataWriter* SampleWriters::entity_for(Writer& writer) {
  const std::string label =
      label_ + (writer.refresh ? ", refresh " + to_text(*writer.refresh) : ", no refresh");
  return domain_.writer<idl::SamplePubSubType, SampleType>(
      kSampleTopic, sample_writer_qos(writer.refresh), label, &writer,
      dds::StatusMask::offered_deadline_missed() << dds::StatusMask::publication_matched());
}

void SampleWriters::attach(Slot& slot, std::optional<Duration> refresh) {
  slot.writer = &writer_for(refresh);
  ++slot.writer->channels;
}

bool SampleWriters::has_writer(Slot& slot) {
  if (slot.writer != nullptr) return true;
  try {
    attach(slot, std::nullopt);
  } catch (const DdsError&) { return false; }
  return true;
}

bool SampleWriters::has_readers() const {
  return std::any_of(writers_.begin(), writers_.end(),
                     [](const auto& writer) { return writer->readers > 0; });
}

SampleWriters::Woken SampleWriters::wake(std::size_t most) {
  {
    const std::lock_guard lock(mutex_);
    if (!awake_) {
      if (!has_readers()) return {};
      unwoken_ = 0;
      awake_ = true;  // before values are read: other threads write here too from now on
    }
  }
  Woken woken;
  while (woken.written < most) {
    const std::lock_guard lock(mutex_);
    const JoinedSending joined(most_bytes_);
    const std::size_t end = std::min(unwoken_ + kWakeChunk, slots_.size());
    for (; unwoken_ < end; ++unwoken_) {
      Slot& slot = slots_[unwoken_];
      if (slot.written()) continue;
      LastValue last;
      if (!blocks_.last_value(static_cast<ChannelIndex>(unwoken_), last)) continue;
      if (!has_writer(slot)) continue;
      slot.value = std::move(last);
      (void)write(slot);
      ++woken.written;
    }
    if (end == slots_.size()) return woken;
  }
  woken.all = false;
  return woken;
}

bool SampleWriters::write(std::span<const Sample> samples, const UtcMapping& mapping) {
  const std::lock_guard lock(mutex_);
  tidy_up(mapping.instant);
  if (!awake_) return true;
  const std::vector<Write>& ordered = in_order(samples);
  bool taken = ordered.size() == samples.size();
  const JoinedSending joined(most_bytes_);
  for (const auto& [slot, sample] : ordered) {
    // wake() has already written this value or a later one.
    if (sample->sequence <= slot->value.sequence) continue;
    to_last_value(*sample, mapping, slot->value);
    taken &= write(*slot);
  }
  return taken;
}

bool SampleWriters::write(Slot& slot) {
  slot.order = ++writes_;
  ++slot.writer->written;
  OutgoingSample outgoing = slot.outgoing();
  return is_taken(slot.writer->entity->write(&outgoing));
}

// Orders the writes of a block. DEADLINE keeps a timer for the instance that is due first; a write
// of that instance makes the library search all instances for the next one and wake its timer
// thread. So the least recently written instance is written last: one search per block instead of
// per sample. The others follow their last write.
std::vector<SampleWriters::Write>& SampleWriters::in_order(std::span<const Sample> samples) {
  order_.clear();
  for (const Sample& sample : samples) {
    FIELDCAST_CHECK(sample.channel < slots_.size());
    Slot& slot = slots_[sample.channel];
    if (has_writer(slot)) order_.push_back({&slot, &sample});
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
  const std::lock_guard lock(mutex_);
  tidy_up(now);
  rest_if_unread(now);
  renew(now);
}

void SampleWriters::tidy_up(Instant now) {
  if (!leaving_.empty()) let_go(now);
  if (any_idle_) remove_idle_writers(now);
}

// Replaces the writers by new ones, because the library continues to count the deadlines of each
// instance that was written.
void SampleWriters::rest_if_unread(Instant now) {
  const bool read = has_readers();
  if (read && !awake_)
    snapshots_.request(bus_);  // again: the bus may not have been found the first time
  if (read || !awake_) {
    unread_since_.reset();
    return;
  }
  if (!unread_since_) unread_since_ = now;
  if (now - *unread_since_ < kRestAfter) return;
  unread_since_.reset();  // after a failure, retry after the same time
  if (!make_anew()) return;
  awake_ = false;
  if (has_readers()) snapshots_.request(bus_);  // it matched while the writers were awake
}

bool SampleWriters::make_anew() {
  std::map<Writer*, std::unique_ptr<Writer>> anew;
  try {
    for (const auto& old : writers_) {
      if (old->channels == 0) continue;
      auto& made = anew[old.get()] = std::make_unique<Writer>(*this, old->refresh);
      made->entity = entity_for(*made);
      made->channels = old->channels.load();
    }
  } catch (const DdsError&) {
    for (const auto& [old, made] : anew) {
      if (made->entity != nullptr) domain_.remove(made->entity);
    }
    return false;
  }
  for (Slot& slot : slots_) {
    slot.value.sequence = 0;
    if (slot.writer != nullptr) slot.writer = anew.at(slot.writer).get();
  }
  for (const auto& old : writers_) {
    domain_.remove(old->entity);
    retired_misses_ += old->misses.load(std::memory_order_relaxed);
  }
  leaving_.clear();
  writers_.clear();
  for (auto& [old, made] : anew) writers_.push_back(std::move(made));
  any_idle_ = false;
  return true;
}

bool SampleWriters::move(ChannelIndex channel, std::optional<Duration> refresh) {
  const std::lock_guard lock(mutex_);
  FIELDCAST_CHECK(channel < slots_.size());
  Slot& slot = slots_[channel];
  Writer* const old = slot.writer;
  if (old != nullptr && old->refresh == refresh) return false;
  try {
    attach_anew(channel, refresh);
  } catch (const DdsError&) { return false; }
  return true;
}

// Moves the channels of writers that have written many messages, see renewed_writer.hpp. The next
// writer has matched its readers before.
void SampleWriters::renew(Instant now) {
  for (ChannelIndex channel = 0; channel < slots_.size(); ++channel) {
    Writer* const writer = slots_[channel].writer;
    if (writer == nullptr || writer->written < RenewedWriter::kMostMessages) continue;
    try {
      if (!writer->full_since) {
        (void)writer_for(writer->refresh);
        writer->full_since = now;
      } else if (now - *writer->full_since >= kIdle) {
        attach_anew(channel, writer->refresh);
      }
    } catch (const DdsError&) { return; }
  }
}

void SampleWriters::attach_anew(ChannelIndex channel, std::optional<Duration> refresh) {
  Slot& slot = slots_[channel];
  Writer* const old = slot.writer;
  attach(slot, refresh);
  if (old == nullptr) return;
  --old->channels;
  if (slot.written()) {
    (void)write(slot);
    leaving_.push_back({channel, old, std::nullopt});
  }
  if (old->channels == 0) {
    old->idle_since.reset();
    any_idle_ = true;
  }
}

void SampleWriters::let_go(Instant now) {
  std::erase_if(leaving_, [&](Leaving& one) {
    if (!one.since) one.since = now;
    if (now - *one.since < kIdle) return false;
    Slot& slot = slots_[one.channel];
    // Never unregister the last instance: Fast DDS 2.9.1 then searches for the next deadline of a
    // writer without instances, and finds none.
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
    retired_misses_ += one.misses.load(std::memory_order_relaxed);
    writer = writers_.erase(writer);
  }
}

std::optional<Duration> SampleWriters::refresh_of(ChannelIndex channel) const {
  const std::lock_guard lock(mutex_);
  FIELDCAST_CHECK(channel < slots_.size());
  const Writer* writer = slots_[channel].writer;
  return writer == nullptr ? std::nullopt : writer->refresh;
}

Duration SampleWriters::shortest_refresh() const {
  const std::lock_guard lock(mutex_);
  Duration shortest = kInfinite;
  for (const auto& writer : writers_) {
    if (writer->channels > 0) shortest = std::min(shortest, writer->refresh.value_or(kInfinite));
  }
  return shortest;
}

void SampleWriters::dispose(Duration linger, Duration limit) {
  const std::lock_guard lock(mutex_);
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
  writers_.clear();
}

DdsLink::BusCounters SampleWriters::counters() const {
  const std::lock_guard lock(mutex_);
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
