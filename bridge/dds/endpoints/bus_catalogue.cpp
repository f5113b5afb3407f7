#include "bridge/dds/endpoints/bus_catalogue.hpp"

#include <algorithm>
#include <utility>

#include "bridge/dds/topics/block.hpp"

namespace fieldcast {

namespace {

constexpr auto kPerBlock = static_cast<std::size_t>(kEntriesPerBlock);

}  // namespace

BusCatalogue::BusCatalogue(Domain& domain, dds::DataWriter* blocks, const std::string& bridge,
                           const std::string& bus, std::uint64_t epoch)
    : domain_(domain), blocks_(blocks), bridge_(bridge), bus_(bus), epoch_(epoch) {}

BusCatalogue::~BusCatalogue() {
  for (dds::DataWriter* writer : writers_) domain_.remove(writer);
}

dds::DataWriter* BusCatalogue::writer_of(std::size_t channel) const {
  return writers_.at(channel / static_cast<std::size_t>(kChannelsPerCatalogueWriter));
}

void BusCatalogue::add(const DeviceSpec& device, const ChannelSpec& channel,
                       std::optional<Duration> refresh) {
  if (channels_.size() % static_cast<std::size_t>(kChannelsPerCatalogueWriter) == 0)
    writers_.push_back(domain_.writer(kChannelTopic, "fieldcast-bridge " + bridge_ + ": " + bus_));
  to_idl(bridge_, bus_, device, channel, refresh, channels_.emplace_back());
}

void BusCatalogue::go_on_with(std::uint64_t epoch) {
  const std::lock_guard lock(mutex_);
  epoch_ = epoch;
}

std::uint64_t BusCatalogue::epoch() const {
  const std::lock_guard lock(mutex_);
  return epoch_;
}

bool BusCatalogue::publish() {
  const std::lock_guard lock(mutex_);
  bool taken = true;
  // Blocks are written first: stations that support blocks then get all names in a few messages.
  for (std::size_t first = 0; first < channels_.size(); first += kPerBlock)
    taken &= write_block(first);
  changed_.clear();
  for (std::size_t i = 0; i < channels_.size(); ++i)
    taken &= is_taken(writer_of(i)->write(&channels_[i]));
  return taken;
}

bool BusCatalogue::write_block(std::size_t first) {
  block_.bus() = cut_text(bus_, kMaxNameLength);
  block_.bridge() = cut_text(bridge_, kMaxNameLength);
  block_.epoch(epoch_);
  block_.first(static_cast<std::uint32_t>(first));
  block_.channels(static_cast<std::uint32_t>(channels_.size()));
  block_.entries().resize(std::min(kPerBlock, channels_.size() - first));
  for (std::size_t i = 0; i < block_.entries().size(); ++i)
    to_idl(channels_[first + i], block_.entries()[i]);
  return is_taken(blocks_->write(&block_));
}

void BusCatalogue::set_refresh(ChannelIndex channel, std::optional<Duration> refresh) {
  const std::lock_guard lock(mutex_);
  idl::Channel& entry = channels_.at(channel);
  entry.refresh(refresh.value_or(Duration::zero()).count());
  writer_of(channel)->write(&entry);
  changed_.insert(channel / kPerBlock * kPerBlock);
}

void BusCatalogue::flush() {
  const std::lock_guard lock(mutex_);
  for (const std::size_t first : std::exchange(changed_, {})) (void)write_block(first);
}

void BusCatalogue::dispose_blocks() {
  const std::lock_guard lock(mutex_);
  block_.entries().clear();
  block_.bus() = cut_text(bus_, kMaxNameLength);
  for (std::size_t first = 0; first < channels_.size(); first += kPerBlock) {
    block_.first(static_cast<std::uint32_t>(first));
    blocks_->unregister_instance(&block_, dds::HANDLE_NIL);
  }
}

void BusCatalogue::dispose_channels() {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < channels_.size(); ++i)
    writer_of(i)->unregister_instance(&channels_[i], dds::HANDLE_NIL);
}

void BusCatalogue::wait_for_readers(Duration limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  for (dds::DataWriter* writer : writers_) {
    const Duration left = end - std::chrono::steady_clock::now();
    if (left > Duration::zero()) writer->wait_for_acknowledgments(to_dds(left));
  }
}

}  // namespace fieldcast
