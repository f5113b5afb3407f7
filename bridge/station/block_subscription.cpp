#include "bridge/station/block_subscription.hpp"

#include <pthread.h>

#include <algorithm>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <utility>

#include "bridge/dds/library/library.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

namespace {

// Two bridges may write the same bus for a moment, and either may remain.
dds::DataReaderQos catalogue_qos() {
  constexpr std::int32_t kWriters = 4;
  dds::DataReaderQos qos = reader_qos(kCatalogueBlockTopic);
  qos.history().depth = kWriters;
  auto& limits = qos.resource_limits();
  limits.max_samples_per_instance = kWriters;
  limits.max_samples = kWriters * limits.max_instances;
  return qos;
}

Instant now_steady() { return Instant{std::chrono::steady_clock::now().time_since_epoch()}; }

}  // namespace

BlockSubscription::BlockSubscription(Domain& domain, std::string station)
    : domain_(domain), station_(std::move(station)) {
  handlers_.gone = [this](const StationSample& last) {
    if (sample_gone_) sample_gone_(last.bus, last.device, last.channel);
    if (channel_gone_) channel_gone_(last.bus, last.device, last.channel);
  };
  catalogue_ =
      domain_.reader(kCatalogueBlockTopic, catalogue_qos(), this,
                     dds::StatusMask::data_available() << dds::StatusMask::subscription_matched());
  thread_ = std::thread([this] { run(); });
}

BlockSubscription::~BlockSubscription() {
  {
    const std::lock_guard lock(news_mutex_);
    ending_ = true;
  }
  news_.notify_one();
  thread_.join();
  additions_.push_back({.blocks = blocks_, .requests = requests_});
  for (const Addition& each : additions_) {
    if (each.blocks != nullptr) domain_.remove(each.blocks);
    if (each.requests != nullptr) domain_.remove(each.requests);
  }
  domain_.remove(catalogue_);
}

void BlockSubscription::subscribe_channels(std::function<void(const StationChannel&)> on_channel,
                                           OnGone gone) {
  add({.on_channel = std::move(on_channel), .gone = std::move(gone)});
}

void BlockSubscription::subscribe_samples(std::function<void(const StationSample&)> on_sample,
                                          OnGone gone) {
  dds::DataWriter* const requests = domain_.writer(kSnapshotRequestTopic, station_);
  dds::DataReader* blocks = nullptr;
  try {
    blocks = domain_.reader(kSampleBlockTopic, this, dds::StatusMask::data_available());
  } catch (const DdsError&) {
    domain_.remove(requests);
    throw;
  }
  add({.on_sample = std::move(on_sample),
       .gone = std::move(gone),
       .blocks = blocks,
       .requests = requests});
}

void BlockSubscription::add(Addition addition) {
  {
    const std::lock_guard lock(news_mutex_);
    additions_.push_back(std::move(addition));
  }
  wake();
}

void BlockSubscription::install(Addition addition) {
  if (addition.blocks == nullptr) {
    handlers_.channel = std::move(addition.on_channel);
    channel_gone_ = std::move(addition.gone);
    for (const auto& [name, bus] : buses_) bus.table.replay({.channel = handlers_.channel});
    return;
  }
  handlers_.sample = std::move(addition.on_sample);
  sample_gone_ = std::move(addition.gone);
  requests_ = addition.requests;
  blocks_ = addition.blocks;
}

BlockSubscription::Counters BlockSubscription::counters() const {
  const std::lock_guard lock(news_mutex_);
  return counters_;
}

void BlockSubscription::count() {
  Counters counters{.blocks = taken_, .requests = requested_};
  for (const auto& [name, bus] : buses_) counters.missing += bus.table.missing();
  const std::lock_guard lock(news_mutex_);
  counters_ = counters;
}

void BlockSubscription::on_data_available(dds::DataReader*) { wake(); }

void BlockSubscription::on_subscription_matched(dds::DataReader*,
                                                const dds::SubscriptionMatchedStatus& status) {
  if (status.current_count_change == 0) return;
  {
    const std::lock_guard lock(news_mutex_);
    matches_.push_back({status.last_publication_handle, status.current_count_change > 0});
  }
  wake();
}

void BlockSubscription::wake() {
  {
    const std::lock_guard lock(news_mutex_);
    if (std::exchange(fresh_, true)) return;
  }
  news_.notify_one();
}

void BlockSubscription::run() {
  pthread_setname_np(pthread_self(), "station");
  std::optional<Instant> due;
  while (true) {
    std::vector<Match> matches;
    std::vector<Addition> additions;
    {
      std::unique_lock lock(news_mutex_);
      const auto ready = [this] { return fresh_ || ending_; };
      if (due) {
        news_.wait_for(lock, *due - now_steady(), ready);
      } else {
        news_.wait(lock, ready);
      }
      if (ending_) return;
      fresh_ = false;
      matches.swap(matches_);
      additions.swap(additions_);
    }
    for (Addition& addition : additions) install(std::move(addition));
    const std::vector<Known> ended = take_catalogue();
    take_blocks();  // before the ends: a bus that stops writes its last block before its end
    for (const Known& known : ended) gone(known);
    for (const Match& match : matches) match.came ? return_of(match.writer) : end_of(match.writer);
    ask_for_snapshots(now_steady());
    due = next_request();
    count();
  }
}

BlockSubscription::Bus& BlockSubscription::bus_of(const std::string& name) { return buses_[name]; }

std::vector<BlockSubscription::Known> BlockSubscription::take_catalogue() {
  std::vector<Known> ended;
  dds::SampleInfo info;
  while (catalogue_->take_next_sample(&catalogue_block_, &info) == ReturnCode_t::RETCODE_OK) {
    if (info.valid_data) {
      const std::string name = catalogue_block_.bus().c_str();
      lost_.forget(info.publication_handle, info.instance_handle);
      known_[{info.publication_handle, info.instance_handle}] = {
          name, catalogue_block_.epoch(), catalogue_block_.first(), catalogue_block_};
      bus_of(name).table.on_catalogue(catalogue_block_, handlers_);
    } else if (info.instance_state != dds::ALIVE_INSTANCE_STATE) {
      lost_.forget(info.publication_handle, info.instance_handle);
      if (const auto node = known_.extract({info.publication_handle, info.instance_handle}))
        ended.push_back(std::move(node.mapped()));
    }
  }
  return ended;
}

void BlockSubscription::take_blocks() {
  if (blocks_ == nullptr) return;
  dds::SampleInfo info;
  while (blocks_->take_next_sample(&block_, &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    ++taken_;
    bus_of(block_.bus().c_str()).table.on_samples(block_, handlers_);
  }
}

// A writer crashed or left without disposing: the library delivers no message for its instances.
void BlockSubscription::end_of(const dds::InstanceHandle_t& writer) {
  for (auto known = known_.begin(); known != known_.end();) {
    if (known->first.first != writer) {
      ++known;
      continue;
    }
    auto node = known_.extract(known++);
    gone(node.mapped());
    lost_.keep(writer, node.key().second, std::move(node.mapped()));
  }
}

// Restores the instances of the same writer after a network interruption.
void BlockSubscription::return_of(const dds::InstanceHandle_t& writer) {
  for (auto& [instance, lost] : lost_.take(writer)) {
    const auto [known, is_new] = known_.try_emplace({writer, instance}, std::move(lost));
    if (is_new) bus_of(known->second.bus).table.on_catalogue(known->second.block, handlers_);
  }
}

void BlockSubscription::gone(const Known& known) {
  // The bridge that took the bus over continues with the same epoch: its channels remain.
  for (const auto& [written, other] : known_) {
    if (other.bus == known.bus && other.epoch == known.epoch && other.first == known.first) return;
  }
  BusTable& table = bus_of(known.bus).table;
  table.on_catalogue_gone(known.epoch, known.first, handlers_);
  if (table.is_known()) return;
  // The epoch has ended: the catalogue that another bridge wrote of this bus is used now, even with
  // a smaller epoch.
  for (const auto& [written, other] : known_) {
    if (other.bus == known.bus) table.on_catalogue(other.block, handlers_);
  }
}

void BlockSubscription::ask_for_snapshots(Instant now) {
  if (blocks_ == nullptr) return;
  for (auto& [name, bus] : buses_) {
    const bool missing = is_missing_one(bus, now), behind = is_behind(bus, now);
    if (!missing && !behind) continue;
    idl::SnapshotRequest request;
    request.bus() = cut_text(name, kMaxNameLength);
    request.station() = cut_text(station_, 128);
    requests_->write(&request);
    ++requested_;
  }
}

// Returns true if a snapshot must be requested now because blocks are missing.
bool BlockSubscription::is_missing_one(Bus& bus, Instant now) {
  if (!bus.table.wants_snapshot() || !bus.table.is_known()) {
    bus.wanted = false;
    return false;
  }
  if (!bus.wanted) {
    bus.wanted = true;
    // A new bus sends a snapshot by itself.
    bus.due = bus.table.missing() == 0 ? now + kPatience : now;
  }
  if (bus.due > now) return false;
  bus.due = now + kPatience;
  return true;
}

// Returns true if a snapshot must be requested now because samples are ignored.
bool BlockSubscription::is_behind(Bus& bus, Instant now) {
  if (!bus.table.is_behind()) {
    bus.rest_behind = {};
    return false;
  }
  if (bus.rest_behind == Duration::zero()) {
    bus.rest_behind = kBehind;
    bus.due_behind = now + bus.rest_behind;
  }
  if (bus.due_behind > now) return false;
  bus.rest_behind = std::min(2 * bus.rest_behind, Duration{kMostBehind});
  bus.due_behind = now + bus.rest_behind;
  return true;
}

std::optional<Instant> BlockSubscription::next_request() const {
  std::optional<Instant> next;
  if (blocks_ == nullptr) return next;
  for (const auto& [name, bus] : buses_) {
    if (bus.wanted) next = std::min(next.value_or(bus.due), bus.due);
    if (bus.rest_behind > Duration::zero())
      next = std::min(next.value_or(bus.due_behind), bus.due_behind);
  }
  return next;
}

}  // namespace fieldcast
