#include "bridge/dds/bus_catalogue.hpp"

#include <algorithm>
#include <utility>

#include "bridge/dds/topics/block.hpp"

namespace fieldcast {

namespace {

constexpr auto kPerBlock = static_cast<std::size_t>(kEntriesPerBlock);

}  // namespace

BusCatalogue::BusCatalogue(const Writers& writers, const std::string& bridge,
                           const std::string& bus, std::uint64_t epoch)
    : writers_(writers), bridge_(bridge), bus_(bus), epoch_(epoch) {}

void BusCatalogue::add(const DeviceSpec& device, const ChannelSpec& channel,
                       std::optional<Duration> refresh) {
  to_idl(bridge_, bus_, device, channel, refresh, channels_.emplace_back());
}

bool BusCatalogue::publish() {
  const std::lock_guard lock(mutex_);
  bool taken = true;
  // Blocks first: stations that know them have all names with a few messages.
  for (std::size_t first = 0; first < channels_.size(); first += kPerBlock)
    taken &= write_block(first);
  changed_.clear();
  for (idl::Channel& channel : channels_) taken &= is_taken(writers_.channels->write(&channel));
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
  return is_taken(writers_.blocks->write(&block_));
}

void BusCatalogue::set_refresh(ChannelIndex channel, std::optional<Duration> refresh) {
  const std::lock_guard lock(mutex_);
  idl::Channel& entry = channels_.at(channel);
  entry.refresh(refresh.value_or(Duration::zero()).count());
  writers_.channels->write(&entry);
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
    writers_.blocks->unregister_instance(&block_, dds::HANDLE_NIL);
  }
}

void BusCatalogue::dispose_channels() {
  const std::lock_guard lock(mutex_);
  for (idl::Channel& channel : channels_)
    writers_.channels->unregister_instance(&channel, dds::HANDLE_NIL);
}

}  // namespace fieldcast
