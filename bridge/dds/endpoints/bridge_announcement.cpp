#include "bridge/dds/endpoints/bridge_announcement.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <utility>

#include "bridge/dds/topics/block.hpp"
#include "bridge/security/subject.hpp"

namespace fieldcast {

namespace {

std::string text_of(const dds::InstanceHandle_t& writer) {
  std::array<char, 33> text{};
  for (std::size_t i = 0; i < 16; ++i)
    std::snprintf(&text[2 * i], 3, "%02x", static_cast<unsigned>(writer.value[i]));
  return text.data();
}

}  // namespace

BridgeAnnouncement::BridgeAnnouncement(Domain& domain, const RequestWriters& identities,
                                       const std::string& label, DdsLink::BridgeHandlers handlers,
                                       std::function<void(std::string)> on_problem)
    : domain_(domain),
      identities_(identities),
      handlers_(std::move(handlers)),
      on_problem_(std::move(on_problem)),
      writer_(domain.writer(kBridgeTopic, label)),
      reader_(domain.reader(kBridgeTopic, this,
                            dds::StatusMask::data_available()
                                << dds::StatusMask::subscription_matched()
                                << dds::StatusMask::liveliness_changed())) {}

std::string BridgeAnnouncement::id() const { return text_of(writer_->get_instance_handle()); }

void BridgeAnnouncement::announce(const BridgeClaims& claims) {
  to_idl(claims, announced_);
  writer_->write(&announced_);
}

void BridgeAnnouncement::close() {
  domain_.remove(reader_);
  domain_.remove(writer_);
}

bool BridgeAnnouncement::is_own(const Handle& writer) const {
  return writer == writer_->get_instance_handle();
}

void BridgeAnnouncement::on_data_available(dds::DataReader* reader) {
  idl::Bridge received;
  dds::SampleInfo info;
  while (reader->take_next_sample(&received, &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data || is_own(info.publication_handle)) continue;
    const BridgeClaims claims = from_idl(received);
    const std::string subject =
        identities_.subject_of(domain_, rtps::iHandle2GUID(info.publication_handle));
    const std::lock_guard lock(mutex_);
    if (!subject.empty() &&
        subject != security::Subject{security::MemberRole::kBridge, claims.bridge}.text()) {
      refuse(info.publication_handle, claims.bridge, subject);
      continue;
    }
    lost_.forget(info.publication_handle, info.publication_handle);
    known_[info.publication_handle] = claims;
    handlers_.received(text_of(info.publication_handle), claims);
  }
}

void BridgeAnnouncement::refuse(const Handle& writer, const std::string& bridge,
                                const std::string& subject) {
  known_.erase(writer);
  lost_.forget(writer, writer);
  handlers_.lost(text_of(writer));
  on_problem_("a claim on buses under the name of bridge '" + bridge +
              "' was ignored: its writer has the identity of " + subject);
}

void BridgeAnnouncement::on_subscription_matched(dds::DataReader*,
                                                 const dds::SubscriptionMatchedStatus& status) {
  if (is_own(status.last_publication_handle)) return;
  if (status.current_count_change > 0) matched(status.last_publication_handle);
  if (status.current_count_change < 0) unmatched(status.last_publication_handle);
}

// Restores the claims of a bridge that was lost because of the network, before its announcements.
void BridgeAnnouncement::matched(const Handle& writer) {
  const std::lock_guard lock(mutex_);
  handlers_.found(text_of(writer));
  for (auto& [instance, claims] : lost_.take(writer)) {
    if (known_.try_emplace(instance, claims).second) handlers_.received(text_of(writer), claims);
  }
}

void BridgeAnnouncement::unmatched(const Handle& writer) {
  const std::lock_guard lock(mutex_);
  if (auto node = known_.extract(writer)) lost_.keep(writer, writer, std::move(node.mapped()));
  handlers_.lost(text_of(writer));
}

void BridgeAnnouncement::on_liveliness_changed(dds::DataReader*,
                                               const dds::LivelinessChangedStatus& status) {
  if (is_own(status.last_publication_handle)) return;
  if (status.alive_count_change != 0)
    handlers_.alive(text_of(status.last_publication_handle), status.alive_count_change > 0);
}

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
