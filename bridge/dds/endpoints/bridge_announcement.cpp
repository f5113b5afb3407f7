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
  for (; written_ < end; ++written_) (void)write_channel(written_, message);
  return end == channels_.size();
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
