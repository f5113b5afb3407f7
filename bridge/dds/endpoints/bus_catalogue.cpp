#include "bridge/dds/endpoints/bus_catalogue.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "bridge/dds/topics/block.hpp"

namespace fieldcast {

namespace {

constexpr auto kPerBlock = static_cast<std::size_t>(kEntriesPerBlock);

}  // namespace

BusCatalogue::BusCatalogue(Domain& domain, dds::DataWriter* blocks, const std::string& bridge,
                           const std::string& bus, std::uint64_t epoch,
                           std::function<void()> matched)
    : domain_(domain),
      blocks_(blocks),
      bridge_(bridge),
      bus_(bus),
      matched_(std::move(matched)),
      epoch_(epoch) {}

BusCatalogue::~BusCatalogue() {
  for (dds::DataWriter* writer : writers_) domain_.remove(writer);
}

dds::DataWriter* BusCatalogue::writer_of(std::size_t channel) const {
  return writers_.at(channel / static_cast<std::size_t>(kChannelsPerCatalogueWriter));
}

void BusCatalogue::add(const DeviceSpec& device, const ChannelSpec& channel,
                       std::optional<Duration> refresh) {
  if (channels_.size() % static_cast<std::size_t>(kChannelsPerCatalogueWriter) == 0)
    writers_.push_back(domain_.writer(kChannelTopic, "fieldcast-bridge " + bridge_ + ": " + bus_,
                                      this, dds::StatusMask::publication_matched()));
  channels_.push_back({&device, &channel, refresh});
}

void BusCatalogue::make(std::size_t channel, idl::Channel& out) const {
  const Entry& entry = channels_.at(channel);
  to_idl(bridge_, bus_, *entry.device, *entry.channel, entry.refresh, out);
}

bool BusCatalogue::write_channel(std::size_t channel, idl::Channel& scratch) {
  make(channel, scratch);
  return is_taken(writer_of(channel)->write(&scratch));
}

void BusCatalogue::on_publication_matched(dds::DataWriter*,
                                          const dds::PublicationMatchedStatus& status) {
  if (status.current_count_change > 0 && !wanted_.exchange(true)) matched_();
}

bool BusCatalogue::wake(std::size_t most) {
  if (!wanted_) return true;
  const std::lock_guard lock(mutex_);
  idl::Channel message;
  const std::size_t end = std::min(channels_.size(), written_ + most);
  while (written_ < end && write_channel(written_, message)) ++written_;
  return written_ == channels_.size();
}

idl::Channel BusCatalogue::message(ChannelIndex channel) const {
  const std::lock_guard lock(mutex_);
  idl::Channel made;
  make(channel, made);
  return made;
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
  idl::Channel message;
  for (std::size_t i = 0; i < written_; ++i) taken &= write_channel(i, message);
  return taken;
}

bool BusCatalogue::write_block(std::size_t first) {
  idl::CatalogueBlock block;
  block.bus() = cut_text(bus_, kMaxNameLength);
  block.bridge() = cut_text(bridge_, kMaxNameLength);
  block.epoch(epoch_);
  block.first(static_cast<std::uint32_t>(first));
  block.channels(static_cast<std::uint32_t>(channels_.size()));
  // The library keeps the first message of an instance as its key: this one has no entries.
  (void)blocks_->register_instance(&block);
  block.entries().resize(std::min(kPerBlock, channels_.size() - first));
  idl::Channel message;
  for (std::size_t i = 0; i < block.entries().size(); ++i) {
    make(first + i, message);
    to_idl(message, block.entries()[i]);
  }
  return is_taken(blocks_->write(&block));
}

void BusCatalogue::set_refresh(ChannelIndex channel, std::optional<Duration> refresh) {
  const std::lock_guard lock(mutex_);
  channels_.at(channel).refresh = refresh;
  idl::Channel message;
  if (channel < written_) (void)write_channel(channel, message);
  changed_.insert(channel / kPerBlock * kPerBlock);
}

void BusCatalogue::flush() {
  const std::lock_guard lock(mutex_);
  for (const std::size_t first : std::exchange(changed_, {})) (void)write_block(first);
}

void BusCatalogue::dispose_blocks() {
  const std::lock_guard lock(mutex_);
  idl::CatalogueBlock block;
  block.bus() = cut_text(bus_, kMaxNameLength);
  for (std::size_t first = 0; first < channels_.size(); first += kPerBlock) {
    block.first(static_cast<std::uint32_t>(first));
    blocks_->unregister_instance(&block, dds::HANDLE_NIL);
  }
}

void BusCatalogue::dispose_channels() {
  const std::lock_guard lock(mutex_);
  idl::Channel message;
  for (std::size_t i = 0; i < written_; ++i) {
    make(i, message);
    writer_of(i)->unregister_instance(&message, dds::HANDLE_NIL);
  }
}

void BusCatalogue::wait_for_readers(Duration limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  for (dds::DataWriter* writer : writers_) {
    const Duration left = end - std::chrono::steady_clock::now();
    if (left > Duration::zero()) writer->wait_for_acknowledgments(to_dds(left));
  }
}

}  // namespace fieldcast
