#include "bridge/dds/endpoints/bridge_announcement.hpp"

#include <array>
#include <cstdio>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <utility>

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

}  // namespace fieldcast
